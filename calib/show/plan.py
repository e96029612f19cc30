"""Facts of a plan of runs: how well the torque is known after each step, and cards for the driver.

A width is the 95 % half width of the brake torque, over the torque [1]. A fit has the widths that
were achieved beside the planned ones.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from calib.base.plain import NBSP
from calib.base.units import BAR
from calib.plan.achieved import Achieved
from calib.show.facts import DIR, FAILED, PASSED, UNJUDGED, Facts, Table

if TYPE_CHECKING:  # a fit needs nothing that makes a plan
    from calib.plan.search import Plan, Step


def plan_facts(plan: "Plan") -> Facts:
    """Return the steps with the widths after them, and the smallest widths that can be reached."""
    widths_after = plan.after._asdict().items()
    widths = ", ".join(f"{part} ±{100.0 * width:.1f}{NBSP}%" for part, width in widths_after)
    is_wanted = any(plan.want.widths)
    verdict, word = UNJUDGED, "Planned"
    if is_wanted:
        is_met = plan.want.met_by(plan.after)
        verdict, word = (PASSED, "Enough") if is_met else (FAILED, "Not enough")
    rows = [
        ("before", plan.start),
        *((f"{i}. {step.measure.text}", step.widths) for i, step in enumerate(plan.steps, 1)),
        ("the same, with the speed v logged", plan.with_speed or ()),
        ("wanted", plan.want.widths if is_wanted else ()),
        ("all runs that can be driven here", plan.floor_of_runs),
        ("and all measurements of a workshop", plan.floor),
    ]
    return Facts(
        title=f"Plan for {plan.prior.vehicle.name}",
        verdict=verdict,
        word=word,
        headline=f"{widths} after {plan.seconds:.0f}{NBSP}s",
        tables=[_widths([row for row in rows if row[1]])],
        notes=_notes(plan),
        next=f"brake-cal fit LOG... --vehicle V.toml --plan {DIR}/plan.json",
        parts=[_card(plan, step, i) for i, step in enumerate(plan.steps, 1)],
    )


def _notes(plan: "Plan") -> list[str]:
    texts = ", ".join(measure.text for measure in plan.not_worth)
    notes = [f"Not worth driving in addition: {texts}."] if texts else []
    reasons = "; ".join(dict.fromkeys(plan.impossible.values()))
    return [*notes, f"Not possible here: {reasons}."] if reasons else notes


def _card(plan: "Plan", step: "Step", number: int) -> Facts:
    from calib.plan.measure import pressure_trace

    measure = step.measure
    rows = [("time", f"{step.seconds:.0f}{NBSP}s")]
    if measure.driven:
        rows.insert(0, ("from", f"{3.6 * plan.prior.track.speed:.0f}{NBSP}km/h"))
    if measure.kind == "ramp":
        top = float(pressure_trace(plan.prior.vehicle, measure)[1].max()) / BAR
        rows.append(("pressure at the end", f"{top:.0f}{NBSP}bar"))
    return Facts(f"{number}. {measure.text}", headline=measure.driver, rows=rows)


def achieved_facts(result: Achieved) -> Facts:
    """Return the part of a fit's facts that compares the planned widths with those achieved."""
    word = "as planned" if result.reached else "wider than planned"
    table = _widths([("planned", result.planned), ("achieved", result.achieved)])
    return Facts("Planned and achieved", word, tables=[table], notes=result.reasons)


def _widths(rows: Sequence[tuple[str, Sequence[float]]]) -> Table:
    """Return a table of widths in per cent; "-" for 0 (not wanted) and above 1,000 (not known)."""
    cells = [
        (name, *(f"{100.0 * width:.1f}" if 0.0 < width < 10.0 else "-" for width in widths))
        for name, widths in rows
    ]
    heads = ("after", "front ± [%]", "rear ± [%]", "total ± [%]")
    return Table(heads, cells, "Brake torque is known to so many per cent (95 %).")
