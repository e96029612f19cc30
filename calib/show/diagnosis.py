"""Facts of a diagnosis: the verdict, the named effects, the gap on the hold-outs.

The gap is the difference between open-loop replays of the hold-outs and the measurement, before
the effects were added and after. An empirical term fits what no named effect explains, over its
driver, the quantity that it depends on.
"""

from calib.base.plain import counted
from calib.base.units import BAR
from calib.car.effects.catalogue import definition
from calib.diagnosis.diagnosis import Diagnosis, Named
from calib.diagnosis.replays import CHANNELS, UNITS
from calib.diagnosis.verdict import FREQUENCY, SLIP, WHEEL_ANGLE
from calib.show.diagnosis_figure import diagnosis_sheet, has_changed, worst
from calib.show.facts import FAILED, PASSED, WARNING, Facts, Picture, Row, Table
from calib.show.numbers import estimate, listed, spaced, span

KINDS = {
    "no_gap": ("No gap", PASSED),
    "named": ("Named", PASSED),
    "rest": ("Named and something else", WARNING),
    "worse": ("Named, and the hold-outs are no better", FAILED),
    "ambiguous": ("Ambiguous", WARNING),
    "ambiguous_rest": ("Ambiguous and something else", WARNING),
    "unknown": ("Unknown cause", FAILED),
    "within_noise": ("Within the noise", PASSED),
}
"""Words and verdict of each `outcome`."""
_DRIVERS = {
    "temperature": "the temperature of the disc",
    "time": "the time since the brake bit",
    "elapsed": "the time since the run began",
    "distance": "the distance since the run began",
    "constant": "nothing: it is always there",
    WHEEL_ANGLE: "the angle of the wheels, turn by turn",
    FREQUENCY: "nothing but time: it swings",
    SLIP: "the slip, as brake control does",
}
"""Drivers of empirical terms in words; any other driver is its own word."""
_SPEED = "Speed of the open-loop replays of the hold-outs less the measured one."
_LARGEST = "Replay less measurement of {}, the log with the largest gap; the band is the noise."
_GAP = "By log and channel, over the noise of the sensors, after the noise was subtracted."
_BASE = (
    "Base parameters from all calibration logs. The intervals of the pads include the mass, the "
    "form of the tyres and what differs from log to log. Those of `brake-cal fit` are wider, most "
    "at the rear: it has the ramps alone, and includes axle loads and unlike tyres, too."
)
_TERM = "An empirical term: what it adds, by what it depends on."
_FIT = "brake-cal fit RAMP COAST --vehicle V.toml --model DIR/model.toml"
_INNOVATION = "mean squared innovation (1 = noise)"


def diagnosis_facts(diagnosis: Diagnosis) -> Facts:
    """Return the verdict, a part for each named effect, the gap and the base parameters."""
    word, verdict = KINDS[outcome(diagnosis)]
    rows = (
        ("gap", _gap_in_words(diagnosis)),
        *((spaced(effect.name), _parameters(effect)) for effect in diagnosis.effects),
        ("Left over", _something_else(diagnosis)),
        ("Not named", _withdrawn(diagnosis)),
        ("Unexplained", unexplained(diagnosis)),
    )
    next_step = _FIT if diagnosis.verdict == "named" else ""
    separating = [effect.separate_by for effect in diagnosis.effects if effect.separate_by]
    if diagnosis.verdict == "ambiguous" and separating:
        next_step = separating[0]
    term = [_picture(diagnosis, _TERM, "term")] if diagnosis.unexplained else []
    return Facts(
        diagnosis.model_before.vehicle.name,
        headline=_headline(diagnosis),
        verdict=verdict,
        word=word,
        rows=[row for row in rows if row[1]],
        next=next_step,
        warnings=diagnosis.warnings,
        pictures=[_picture(diagnosis, _SPEED, "speed")],
        parts=[
            *(_effect(effect, diagnosis) for effect in diagnosis.effects),
            Facts("What no effect explains", pictures=term),
            _gap(diagnosis),
            Facts("What it rests on", tables=[_base(diagnosis)]),
        ],
    )


def _picture(diagnosis: Diagnosis, caption: str, *panels: str) -> Picture:
    return Picture(caption, lambda: diagnosis_sheet(diagnosis), panels)


def _gap_in_words(diagnosis: Diagnosis) -> str:
    gap, hold_outs = diagnosis.gap, counted(len(diagnosis.measured), "hold-out")
    if diagnosis.verdict == "no_gap":
        return f"{gap.rms_before:.1f} times the noise, on {hold_outs}"
    ends = f"{gap.rms_before:.1f} to {gap.rms_after:.1f}"
    return f"{ends} times the noise, {100.0 * gap.closed:.1f} % closed, on {hold_outs}"


def _parameters(effect: Named) -> str:
    texts = []
    for name, parameter in effect.parameters.items():
        value, interval = estimate(parameter)
        texts.append(f"{spaced(name)} {value} (95 %: {interval})")
    return "; ".join(texts)


def outcome(diagnosis: Diagnosis) -> str:
    """Return the verdict after a look at the gap on the hold-outs, a key of `KINDS`.

    "worse": the named effects do not make it smaller. "rest", "ambiguous_rest": something remains
    that no effect explains. "within_noise": there is no gap that an unknown cause could explain.
    """
    if diagnosis.verdict == "unknown" and diagnosis.gap.rms_before < 1.0:  # times the noise
        return "within_noise"
    if diagnosis.verdict not in ("named", "ambiguous"):
        return diagnosis.verdict
    if diagnosis.gap.closed <= 0.0:
        return "worse"
    if diagnosis.unexplained is None:
        return diagnosis.verdict
    return "rest" if diagnosis.verdict == "named" else "ambiguous_rest"


def _headline(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == "no_gap":
        return "These logs show nothing that is missing from the model."
    if diagnosis.verdict in ("named", "ambiguous"):
        names = [effect.name for effect in diagnosis.effects]
        in_file = [name for name in names if name in diagnosis.model_before.effects]
        missing = [name for name in names if name not in in_file]
        sentences = [f"Missing from the model: {listed(missing)}"] if missing else []
        sentences += [f"Of another size than in the file: {listed(in_file)}"] if in_file else []
        text = ". ".join(sentences)
        if diagnosis.verdict == "ambiguous":
            alike = {name for x in diagnosis.effects for name in x.indistinguishable_from}
            rivals = listed(sorted(name for name in alike if name not in names), "or")
            text += f", or else {rivals}; these logs cannot tell which"
        return f"{text}, and something else." if diagnosis.unexplained else f"{text}."
    if outcome(diagnosis) == "within_noise":
        return (
            "The hold-outs show no gap. What is left in the innovations changes fast, and no "
            "effect of the catalogue explains it. Look at the sensors first: one may filter, often "
            "a_x, or channels are not simultaneous."
        )
    return "The model lacks something that is not in the catalogue."


def _effect(effect: Named, diagnosis: Diagnosis) -> Facts:
    """Return the part of a named effect: its cause, where it acts, and the evidence for it."""
    card = definition(diagnosis.model_before.vehicle.effects, effect.name).card
    region, runner_up = effect.where, effect.runner_up
    ranges = [span(region.pressure, "Pa"), span(region.speed, "m/s")]
    if region.temperature is not None:
        ranges.append(f"discs of {span(region.temperature, 'degC')}")
    with_all = diagnosis.reduced_after
    without_this = with_all + effect.evidence.innovation_gain
    evidence = f"without it the {_INNOVATION} is {without_this:.3f} instead of {with_all:.3f}"
    evidence += f", on the hold-outs {effect.evidence.innovation_gain_holdout:.2f} more"
    if runner_up is not None:
        with_runner_up = diagnosis.reduced_before - runner_up.innovation_gain
        evidence += f"; next best: {spaced(runner_up.name)}, {with_runner_up:.3f}"
    rows: list[Row] = [
        ("Cause", card.cause),
        ("Acts", f"{region.axle}; strongest in {region.channel}, at {', '.join(ranges)}"),
        ("Evidence", evidence),
    ]
    if effect.indistinguishable_from:
        rows.append(("Cannot be told from", listed(effect.indistinguishable_from, "or")))
    if effect.separate_by:
        rows.append(("To tell them apart", effect.separate_by))
    return Facts(spaced(effect.name).capitalize(), rows=rows)


def _something_else(diagnosis: Diagnosis) -> str:
    """Return the gap that the named effects leave; "" for none."""
    if diagnosis.unexplained is None or not diagnosis.effects:
        return ""
    text = f"a {_INNOVATION} of {diagnosis.reduced_after:.2f}; in the replays "
    return f"{text}errors of {diagnosis.unexplained.size:.1f} times the sensors' noise"


def _withdrawn(diagnosis: Diagnosis) -> str:
    """Return the effects that were rejected, with the reasons; "" without any."""
    withdrawn = "; ".join(listed(names) for names in diagnosis.withdrawn)
    reasons = [f"{withdrawn}: worse on the hold-outs"] if withdrawn else []
    last_search = diagnosis.steps[-1]
    if diagnosis.verdict == "unknown" and last_search:
        reasons.append(f"{listed(last_search)}: explains less than an empirical term alone")
    return "; ".join(reasons)


def unexplained(diagnosis: Diagnosis) -> str:
    """Return where an unknown cause acts and on what it depends; "" without such a cause."""
    cause = diagnosis.unexplained
    if cause is None:
        return ""
    explained, term = 100.0 * cause.explained, cause.term
    driver = _DRIVERS.get(term.driver, f"the {term.driver}")  # may differ from cause.driver
    sentences = [
        f"an empirical term on the {spaced(term.place)} over {driver} explains "
        f"{explained:.0f} % of the remaining gap: it describes the gap, not its cause"
    ]
    if cause.driver == FREQUENCY:
        swing = cause.oscillation
        sentences.append(f"{100.0 * swing.share:.0f} % of it swings at {swing.frequency:.1f} Hz")
    if cause.driver == WHEEL_ANGLE:
        sentences.append(f"{100.0 * cause.turning:.0f} % of it turns with the {cause.axle} wheels")
    if cause.wheel is not None:
        sentences.append(f"the {spaced(cause.wheel)} wheel is slower than the other of its axle")
    if cause.held_from is not None and cause.driver != FREQUENCY:
        limit = f"above {cause.held_from / BAR:.0f} bar"
        sentences.append(f"{limit} the brake torque hardly rises: brake control or a valve")
    return "; ".join(sentences)


def _gap(diagnosis: Diagnosis) -> Facts:
    """Return the part with the gap by hold-out and channel, over the noise of each channel."""
    gap, rows, changed = diagnosis.gap, list[tuple[str, ...]](), has_changed(diagnosis)
    for i, log in enumerate(gap.logs, 1):
        ends = [gap.rms(log, channel) for channel in (None, *CHANNELS)]  # None: all together
        cells = [f"{before:.1f}" for before, _ in ends]
        if changed:
            cells = [f"{before:.1f} to {after:.1f}" for before, after in ends]
        rows.append((f"{i} {log}", *cells))
    noises = (f"{x:.4f} {UNITS[name]}" for name, x in zip(CHANNELS, gap.noise, strict=True))
    rows.append(("noise", "1", *noises))
    caption = _LARGEST.format(diagnosis.measured[worst(diagnosis)].name)
    return Facts(
        f"The gap on the hold-outs{', before to after' if changed else ''}",
        tables=[Table(("log", "all", *CHANNELS), rows, _GAP)],
        pictures=[_picture(diagnosis, caption, "acceleration", "split")],
    )


def _base(diagnosis: Diagnosis) -> Table:
    """Return a table of the re-identified base parameters beside those of the vehicle file."""
    car = diagnosis.model_before.vehicle
    nominal = {"pad_friction_f": car.front.pad_friction, "pad_friction_r": car.rear.pad_friction}
    rows = [
        (spaced(name), *estimate(x), f"{nominal[name]:g}" if name in nominal else "")
        for name, x in diagnosis.base.items()
    ]
    return Table(("parameter", "value", "95 % interval", "vehicle file"), rows, _BASE)
