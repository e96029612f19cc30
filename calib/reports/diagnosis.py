"""The report of a diagnosis: one HTML file that can be read without the program."""

from calib.diagnosis import words
from calib.diagnosis.diagnose import Diagnosis, Named
from calib.diagnosis.gap import UNITS
from calib.diagnosis.unexplained import UnexplainedTerm
from calib.physics.effects.empirical import DRIVERS
from calib.physics.own_effects.own_effect import definition
from calib.plots import diagnosis
from calib.plots.sheet import Sheet
from calib.reports.html import drawn, page

BASE = {
    "pad_friction_f": "pad friction, front",
    "pad_friction_r": "pad friction, rear",
    "tyre_stiffness": "slip stiffness of the tyres, over load",
    "tyre_peak": "peak of the tyres, over load",
}

KINDS = {
    "no_gap": "No gap",
    "named": "Named",
    "ambiguous": "Ambiguous",
    "unknown": "Unknown cause",
}


def report_html(found: Diagnosis, title: str) -> str:
    """Return the report of a diagnosis as one HTML document with the heading ``title``."""
    sheet = diagnosis.sheet(found, title)
    beside = found.unexplained is not None and found.effects != ()
    when = ("before",) if found.verdict == "no_gap" else ("before", "after")
    return page(
        "diagnosis",
        title=f"{title}: {diagnosis.heading(found)}",
        name=title,
        verdict=found.verdict,
        verdict_text=words.verdict(found),
        gap=found.gap,
        gap_text=words.gap(found),
        holdouts=[log.name for log in found.measured],
        speed=drawn(sheet, ("speed",)),
        speed_ends=_speed_ends(found, when),
        effects=[_effect(effect, found) for effect in found.effects],
        unexplained=found.unexplained and _unexplained(found.unexplained, sheet),
        kind=KINDS[found.verdict] + (" and something else" if beside else ""),
        colour="ambiguous" if beside else found.verdict,
        something_else=words.something_else(found),
        withdrawn=words.withdrawn(found),
        noise=words.noise(found),
        steps=_steps(found),
        not_resolved=words.not_resolved(found),
        evidence=drawn(sheet, ("evidence",)),
        tried=[f"{label} leaves {left:.2f}" for label, left, _ in diagnosis.explanations(found)],
        largest=drawn(sheet, ("acceleration", "split"), ("gap", "gap")),
        by_channel=[
            (f"{name} [{UNITS[name]}]", *(f"{getattr(c, key):.4f}" for key in (*when, "noise")))
            for name, c in found.gap.by_channel.items()
        ],
        by_log=[
            (name, *(f"{value:.2f}" for value in pair[: len(when)]))
            for name, pair in found.gap.by_log.items()
        ],
        early_ends=words.early_ends(found),
        base=_base(found),
    )


def _steps(found: Diagnosis) -> list[tuple[str, ...]]:
    """What was added, step by step, and what it left."""
    return [
        (
            words.listed(step.names) if step.names else "none",
            f"{step.innovation:.3f}",
            f"{step.left:.2f}",
        )
        for step in found.steps
    ]


def _speed_ends(found: Diagnosis, when: tuple[str, ...]) -> list[str]:
    """Difference of replayed and measured speed at the end of each replay."""
    ends = []
    for replay in diagnosis.replays_of(found):
        (_, _, before), (_, _, after) = replay.curves({"v": 1.0})
        both = f"{before[-1]:+.2f} m/s before, {after[-1]:+.2f} m/s after"
        ends.append(f"{replay.measured.name} {both if len(when) > 1 else f'{after[-1]:+.2f} m/s'}")
    return ends


def _effect(effect: Named, found: Diagnosis) -> dict[str, object]:
    """One named effect: its card, its parameters, where it acts, its rivals."""
    return {
        "name": words.plain(effect.name).capitalize(),
        "card": definition(found.model_before.vehicle.effects, effect.name).card,
        "parameters": [
            (words.plain(name), words.value_of(value), words.interval_of(value))
            for name, value in effect.parameters.items()
        ],
        "where": words.where(effect),
        "evidence": words.evidence(effect, found),
        "gain_holdout": effect.gain_holdout,
        "rivals": words.rivals(effect),
    }


def _unexplained(found: UnexplainedTerm, sheet: Sheet) -> dict[str, object]:
    """The empirical term point by point, and other terms that explain a part of the gap."""
    term, unit = found.term, DRIVERS[found.term.driver]
    return {
        "text": words.unexplained(found),
        "picture": drawn(sheet, ("term",)),
        "place": words.plain(term.place),
        "driver": term.driver,
        "unit": words.unit_shown(unit) or "1",
        "on": "brake torque" if term.on_brakes else "force over weight",
        "points": [
            (f"{words.in_shown(knot, unit):.3g}", f"{100.0 * value:+.2f} %")
            for knot, value in zip(term.knots, term.values, strict=True)
        ],
        "runners_up": [
            (words.plain(place), driver, f"{100.0 * share:.0f} %")
            for place, driver, share in found.runners_up
        ],
    }


def _base(found: Diagnosis) -> list[tuple[str, ...]]:
    """The re-identified base parameters, beside those of the vehicle file."""
    car = found.model_before.vehicle
    nominal = {"pad_friction_f": car.front.pad_friction, "pad_friction_r": car.rear.pad_friction}
    return [
        (
            BASE.get(name, name),
            words.value_of(value),
            words.interval_of(value),
            f"{nominal[name]:g}" if name in nominal else "",
        )
        for name, value in found.base.items()
    ]
