"""The diagnosis in words, for the screen and the head of the report."""

from dataclasses import asdict

from calib.base.names import AXLE_NAMES
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.diagnose import Diagnosis, Named
from calib.diagnosis.explanation.base import Ground
from calib.diagnosis.explanation.offsets import GRADE
from calib.diagnosis.gates import GATES
from calib.diagnosis.proof.unexplained import (
    FREQUENCY,
    SLIP,
    WHEEL_ANGLE,
    UnexplainedTerm,
    held_from,
)
from calib.diagnosis.runs.sides import USUAL
from calib.diagnosis.search.groups import LogGroup
from calib.diagnosis.undecided.drives import ShowingDrive
from calib.diagnosis.written.printed import in_shown, percent, span, with_unit

SEEN_IN = {
    "a_x": "the deceleration",
    "v": "the speed, as it drifts from the deceleration",
    "rim": "the mean slip of the wheels",
    "front_rear": "the difference between front and rear wheel speeds",
    "front_sides": "the difference between left and right, front wheels",
    "rear_sides": "the difference between left and right, rear wheels",
}
"""Channels of evidence, in words."""

UNEXPLAINED = "unexplained error (1 = noise)"
"""The mean squared innovation of the calibration logs, in words."""

AXLES = {
    "front": "at the front axle",
    "rear": "at the rear axle",
    "both": "at both axles",
    "body": "on the body",
}
"""Where on the car, in words."""


def plain(name: str) -> str:
    """A name with spaces for underscores; `effect_a + effect_b` becomes `effect a + effect b`."""
    return name.replace("_", " ")


def listed(names: list[str] | tuple[str, ...], last: str = "and") -> str:
    """Names as a list in words: `a, b and c`."""
    words = [plain(name) for name in names]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}"


def verdict(found: Diagnosis) -> str:
    """The verdict in one sentence."""
    names = [effect.name for effect in found.effects]
    if found.verdict == "no_gap":
        return "These logs show nothing that is missing from the model."
    more = ", and something else" if found.unexplained is not None else ""
    if found.verdict == "named":
        return f"{_found(found, names)}{more}."
    if found.verdict == "ambiguous":
        others = [n for effect in found.effects for n in effect.indistinguishable_from]
        rivals = sorted(set(others) - set(names))
        return (
            f"{_found(found, names)}, or else {listed(rivals, 'or')}; "
            f"these logs cannot tell which{more}."
        )
    if found.unexplained is None:
        return "The model lacks something that is not in the catalogue."
    left = found.unexplained
    if left.explained < GATES.trifle and left.driver not in (WHEEL_ANGLE, FREQUENCY):
        return (
            "The model lacks something that is not in the catalogue, and these logs do not show "
            "where it acts."
        )
    place = f"{left.axle} wheels" if left.driver == WHEEL_ANGLE else plain(left.place)
    text = f"The model lacks something that is not in the catalogue: it acts on the {place}"
    text += (
        " and is always there."
        if left.driver == "constant"
        else f" and depends on {_driver(left.driver)}."
    )
    if left.wheel is not None:
        text += f" The {plain(left.wheel)} wheel is slower than the other one of its axle."
    return text


def not_excluded(found: Diagnosis) -> str:
    """What an unknown cause may be although no explanation with it holds; else empty."""
    if found.verdict != "unknown":
        return ""
    told = []
    if found.gap.before < GATES.within:
        told.append(
            "That is within the noise: it is quick, and small over a whole run. Look at the "
            "sensors first: one that filters, such as a_x, or channels that are not simultaneous."
        )
    if not all(f"T_disc_{axle}" in log for log in found.measured for axle in AXLE_NAMES):
        told.append(
            "No disc temperature is logged: pads that fade are not excluded, where front and rear "
            "discs began with unlike heat."
        )
    return " ".join(told)


def _found(found: Diagnosis, names: list[str]) -> str:
    """The named effects: those that are missing, then those of which the file has another size."""
    of_file = [name for name in names if name in found.model_before.effects]
    missing = [name for name in names if name not in of_file]
    parts = []
    if missing:
        parts.append(f"Missing from the model: {listed(missing)}")
    if of_file:
        parts.append(f"Of another size than in the vehicle file: {listed(of_file)}")
    return ". ".join(parts)


def _driver(driver: str) -> str:
    return {
        "temperature": "the temperature of the disc",
        "time": "the time since the brake bit",
        "elapsed": "the time since the run began",
        "constant": "nothing",
        WHEEL_ANGLE: "the angle of the wheels, turn by turn",
        FREQUENCY: "nothing but time: it swings",
        SLIP: "the slip, as brake control does",
    }.get(driver, f"the {driver}")


def _over(driver: str) -> str:
    return "at all times" if driver == "constant" else f"over {_driver(driver)}"


def where(effect: Named) -> str:
    """Where an effect acts, in one sentence."""
    at = [span(effect.where.pressure, "Pa"), span(effect.where.speed, "m/s")]
    text = (
        f"Acts {AXLES[effect.where.axle]}; strongest in {SEEN_IN[effect.where.channel]}, "
        f"at {' and '.join(at)}"
    )
    if effect.where.temperature is not None:
        text += f", with discs of {span(effect.where.temperature, 'degC')}"
    return text + "."


def evidence(effect: Named, found: Diagnosis) -> str:
    """The evidence for an effect, and the runner-up."""
    text = (
        f"With it the {UNEXPLAINED} falls from {found.reduced_before:.3f} to "
        f"{found.reduced_after:.3f}"
    )
    if len(found.effects) > 1:
        text = (
            f"Without it the {UNEXPLAINED} would be {found.reduced_after + effect.gain:.3f}; with "
            f"it, it is {found.reduced_after:.3f}"
        )
    if effect.runner_up is None:
        return f"{text}. No other effect came near."
    name, gained = effect.runner_up
    left = found.reduced_before - gained
    return f"{text}. Runner-up: {plain(name)}, which leaves {left:.3f}."


def rivals(effect: Named) -> str:
    """Effects that fit these logs as well, and the test that separates them; empty if none."""
    if not effect.indistinguishable_from:
        return ""
    text = f"These logs cannot tell it from {listed(effect.indistinguishable_from, 'or')}."
    return f"{text} What would: {effect.separate_by}." if effect.separate_by else text


def something_else(found: Diagnosis) -> str:
    """What is left beside the effects that are named, in two sentences; empty if nothing is."""
    if found.unexplained is None or not found.effects:
        return ""
    left = found.left
    text = f"Something else is left: an {UNEXPLAINED} of {found.reduced_after:.2f}"
    lasting = f"lasting errors of {left.size:.1f} times the sensors' noise"
    if not left.significant:
        return (
            f"{text} in the calibration logs. The replays of the hold-outs do not show it: they "
            f"have {lasting}, which noise alone can make."
        )
    sure = f"{min(left.sigma, 99.0):.0f} standard deviations or more from noise alone"
    text += f", and in the replays {lasting}, {sure}"
    at = f"{span(left.pressure, 'Pa')} and {span(left.speed, 'm/s')}"
    return (
        f"{text}. It is largest in {left.channel} of {left.log} ({left.largest:.1f} times the "
        f"noise), at {at}, {span(left.time, 's')} after the start."
    )


def own_effects(found: Diagnosis) -> str:
    """Which own effects were tried besides the catalogue, in a sentence; empty without any."""
    named = {effect.name for effect in found.effects}
    told = [
        f"{plain(name)} of {one.file} ({'named' if name in named else 'not named'})"
        for name, one in found.model_after.effects.own.items()
    ]
    return f"Own effects that were tried as well: {', '.join(told)}." if told else ""


def withdrawn(found: Diagnosis) -> str:
    """What fits the calibration logs and not the hold-outs; empty if there is nothing."""
    lines = []
    for one in found.withdrawn:
        several = len(one.names) > 1
        fit = "fit the calibration logs and are" if several else "fits the calibration logs and is"
        they, them = ("they close", "them") if several else ("it closes", "it")
        text = f"{listed(one.names).capitalize()} {fit} not named: "
        if one.closed is None:
            text += f"the hold-outs cannot be replayed with {them}."
        elif one.closed < 0.0:
            grown = f"{-100.0 * one.closed:.0f} %"
            text += f"the lasting errors of the hold-outs grow by {grown} with {them}."
        else:
            share = f"{100.0 * one.closed:.0f} %"
            text += f"{they} {share} of the lasting errors of the hold-outs."
        lines.append(text)
    return " ".join(lines)


def noise(found: Diagnosis) -> str:
    """Where the noise of the evidence comes from, where that is not the usual place."""
    text = ""
    if found.noise.source != "unbraked parts":
        text = (
            "No log has an unbraked part that is long enough to show the noise; it was taken from "
            f"{found.noise.source}. "
        )
    if found.noise.at_floor:
        channels = listed(found.noise.at_floor)
        text += f"The noise of {channels} is below what the model resolves; that was taken instead."
    return text.strip()


def unexplained(found: UnexplainedTerm) -> str:
    """The location of a cause that is not in the catalogue."""
    told = _placed(found)
    if not found.on_hold_outs:
        return told
    return f"{told} The calibration logs do not show it: it was placed with the hold-outs."


def _placed(found: UnexplainedTerm) -> str:
    text = (
        f"An empirical term on the {plain(found.term.place)} {_over(found.term.driver)} "
        f"explains {percent(found.explained)} of the remaining gap."
    )
    if found.explained < GATES.trifle:
        text = (
            "No empirical term on brakes, wheels or body, over pressure, speed, temperature or "
            "time, explains 1 % of the remaining gap."
        )
    if found.driver == WHEEL_ANGLE:
        text = (
            f"{percent(found.turning)} of the remaining gap goes with the angle of the "
            f"{found.axle} wheels: something turns with them. {text}"
        )
    if found.driver == FREQUENCY:
        return (
            f"{percent(found.oscillation.share)} of the remaining gap swings at "
            f"{found.oscillation.frequency:.1f} Hz, as liquid in a tank, a loose load or a body on "
            f"its springs does. Empirical terms explain {percent(found.explained)} of it at most."
        )
    held = held_from(found.term)
    if held is not None:
        text += f" Above {held / 1e5:.0f} bar the brake torque hardly rises with the pressure: " + (
            "brake control holds it."
            if found.driver == SLIP
            else "brake control or a valve may hold it."
        )
    if found.runners_up and found.explained >= GATES.trifle:
        place, driver, share = found.runners_up[0]
        text += (
            f" Next: {plain(place)} {_over(driver)}, {percent(share)}. "
            "The term describes the gap; its physical cause is not known."
        )
    return text


def groups(found: Diagnosis) -> str:
    """Logs that differ in pads or road from the reference ones, in sentences; empty if none do."""
    return " ".join(
        f"Other pads or another road in {listed(group.logs)}: {factors_of(group)}."
        for group in found.groups[1:]
    )


def own_pads(found: Diagnosis) -> str:
    """Pads and tyres that each log has of its own; empty where common ones serve."""
    if not found.own_pads:
        return ""
    told = "; ".join(f"{log} {_against_mean(own)}" for log, own in found.own_pads.items())
    return (
        "Each log has pads and tyres of its own, within what they repeat to from run to run. "
        f"Front pads, rear pads and tyre stiffness against the mean [%]: {told}."
    )


def _against_mean(own: Ground) -> str:
    factors = (own.pad_friction_f, own.pad_friction_r, own.stiffness)
    return ", ".join(f"{100.0 * (x - 1.0):+.1f}" for x in factors)


def start_heats(found: Diagnosis) -> str:
    """How hot the discs of the logs were at first; empty where that was not asked."""
    if not found.start_heats:
        return ""
    told = (f"{log} {front:.0f} and {rear:.0f}" for log, (front, rear) in found.start_heats.items())
    return (
        f"No disc temperature is logged. At the start [degC], front and rear, on discs of assumed "
        f"heat capacity: {', '.join(told)}."
    )


def offsets(found: Diagnosis) -> str:
    """The slope or the zero that each log has of its own; empty where they have none."""
    if found.offsets is None:
        return ""
    if found.offsets.effect == GRADE:
        told = ", ".join(f"{log} {100.0 * x:+.1f} %" for log, x in found.offsets.values.items())
        return (
            f"Each log has a road slope of its own, uphill positive: {told}. Before anything "
            "brakes, dv/dt and a_x differ by that. A slope that all logs have in common is in it."
        )
    told = ", ".join(f"{log} {x:+.2f}" for log, x in found.offsets.values.items())
    return (
        f"The accelerometer has a zero of its own in each log [m/s^2]: {told}. Before anything "
        "brakes, dv/dt and a_x differ by that. A bias that all logs have in common is in it."
    )


def sides(found: Diagnosis) -> str:
    """Where left and right wheel speeds were made even; empty where they nearly were."""
    told = [
        f"{100.0 * abs(off):.2f} % on the {AXLE_NAMES[axle]} axle, the "
        f"{'left' if off > 0.0 else 'right'} one slower"
        for axle, off in found.sides.items()
        if abs(off) > GATES.sides_told
    ]
    if not told:
        return ""
    even = (
        f"While nothing brakes, the wheel speeds of one axle differ by {'; '.join(told)}. They "
        "were made even: "
    )
    if any(abs(off) > USUAL for off in found.sides.values()):
        return (
            f"{even}tyres of one age differ by up to 0.1 %, and nothing that slows the car, as a "
            "brake that drags would, is missing. Compare the tyres and their pressures."
        )
    return (
        f"{even}tyres of one axle differ by as much. A brake that drags on the slower wheel looks "
        "the same, and its drag is then named as something else: feel whether a disc is hot."
    )


def factors_of(group: LogGroup) -> str:
    """By how much pads and road of a group differ from the reference, in per cent."""
    changes = {plain(name): 100.0 * (x - 1.0) for name, x in asdict(group.ground).items()}
    return ", ".join(f"{name} {change:+.0f} %" for name, change in changes.items())


def radii(found: Diagnosis) -> str:
    """By how much the rolling radii differ from those of the vehicle file; empty if not free."""
    if (factor := found.base.get("rolling_radius")) is None:
        return ""
    off, low, high = (100.0 * (x - 1.0) for x in (factor.value, *factor.ci95))
    car = found.model_after.vehicle
    return (
        f"The rolling radii differ from those of the vehicle file by {off:+.3f} % "
        f"(95 % {low:+.3f} to {high:+.3f}), both axles alike: rolling_radius "
        f"{1e3 * car.front.rolling_radius:.1f} mm in front, {1e3 * car.rear.rolling_radius:.1f} mm "
        "in the rear."
    )


def known(found: Diagnosis) -> str:
    """Effects of the vehicle file, which every explanation has; empty if it has none."""
    named = {effect.name for effect in found.effects}
    told = []
    effects = found.model_before.vehicle.effects
    for name, values in effects.parameters.items():
        units = {p.name: p.unit for p in definition(effects, name).card.parameters}
        numbers = (
            f"{plain(key)} {with_unit(f'{in_shown(x, units[key]):.4g}', units[key])}"
            for key, x in values.items()
        )
        differs = ", from which this answer differs" if name in named else ""
        told.append(f"{plain(name)} ({', '.join(numbers)}{differs})")
    return f"Known from the vehicle file: {'; '.join(told)}." if told else ""


def not_resolved(found: Diagnosis) -> str:
    """Effects that these logs could not have shown, in a sentence; empty if there are none."""
    if not found.not_resolved:
        return ""
    return (
        f"At their usual size these logs could not have shown: {listed(found.not_resolved)}. "
        "They may still be present."
    )


def would_show(drive: ShowingDrive) -> str:
    """The manoeuvre that would show an effect, in words."""
    if drive.clear:
        return drive.name
    return f"none that was tried; most of all {drive.name}" if drive.sigma > 1.0 else "none"


def usual_size(drive: ShowingDrive) -> str:
    """The usual size of an effect: its strength with the unit."""
    strength = drive.card.parameters[0]
    value = in_shown(drive.card.usual[strength.name], strength.unit)
    return f"{plain(strength.name)} {with_unit(f'{value:.3g}', strength.unit)}"


def drives(found: Diagnosis) -> list[str]:
    """The drives that would show what these logs could not have shown, each with its effects."""
    by_drive: dict[str, list[str]] = {}
    for drive in found.drives:
        if drive.clear:
            by_drive.setdefault(drive.name, []).append(drive.effect)
    return [f"Would show {listed(names)}: {drive}." for drive, names in by_drive.items()]


def early_ends(found: Diagnosis) -> list[str]:
    """Replays that could not follow their log to its end, with the reason."""
    lines = []
    for when, sims in (("before", found.before), ("after", found.after)):
        for sim, log in zip(sims, found.measured, strict=True):
            if sim.time.size < log.time.size and sim.notes and "slower than" not in sim.notes[-1]:
                lines.append(f"{log.name}, {when}: {sim.notes[-1]}")
    return lines
