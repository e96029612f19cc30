"""A plan as facts: a card for the driver on one page, and what each step brings."""

from calib.base.plain import NBSP
from calib.base.units import BAR
from calib.plan.measure import pressure_trace
from calib.plan.search import Plan, Step
from calib.show.facts import DIR, FAILED, PASSED, UNJUDGED, Facts, Table
from calib.show.half_widths import WIDTH_HEADS, WIDTHS, width_cells


def plan_facts(plan: Plan) -> Facts:
    """What to do, what it brings, and what it cannot bring."""
    named = plan.after._asdict().items()
    widths = ", ".join(f"{axles} ±{100.0 * width:.1f}{NBSP}%" for axles, width in named)
    wanted, met = any(plan.want.widths), plan.want.met_by(plan.after)
    rows = [
        ("before", *width_cells(plan.start)),
        *((f"{i}. {s.measure.text}", *width_cells(s.widths)) for i, s in enumerate(plan.steps, 1)),
        ("the same, with the speed v logged", *width_cells(plan.with_speed or ())),
        ("wanted", *width_cells(plan.want.widths if wanted else (), none="-")),
        ("all runs that can be driven here", *width_cells(plan.floor_of_runs)),
        ("and all measurements of a workshop", *width_cells(plan.floor)),
    ]
    return Facts(
        title=f"Plan for {plan.prior.vehicle.name}",
        verdict=(PASSED if met else FAILED) if wanted else UNJUDGED,
        word=("Enough" if met else "Not enough") if wanted else "Planned",
        headline=f"{widths} after {plan.seconds:.0f}{NBSP}s",
        tables=[Table(WIDTH_HEADS, [row for row in rows if row[1:]], WIDTHS)],
        notes=_notes(plan),
        next=f"brake-cal fit LOG... --vehicle V.toml --plan {DIR}/plan.json",
        parts=[_card(plan, step, i) for i, step in enumerate(plan.steps, 1)],
    )


def _notes(plan: Plan) -> list[str]:
    texts = ", ".join(measure.text for measure in plan.not_worth)
    notes = [f"Not worth driving in addition: {texts}."] if texts else []
    reasons = "; ".join(dict.fromkeys(plan.impossible.values()))
    return notes + [f"Not possible here: {reasons}."] * bool(reasons)


def _card(plan: Plan, step: Step, number: int) -> Facts:
    measure = step.measure
    rows = [("time", f"{step.seconds:.0f}{NBSP}s")]
    if measure.driven:
        rows.insert(0, ("from", f"{3.6 * plan.prior.track.speed:.0f}{NBSP}km/h"))
    if measure.kind == "ramp":
        top = float(pressure_trace(plan.prior.vehicle, measure)[1].max()) / BAR
        rows.append(("pressure at the end", f"{top:.0f}{NBSP}bar"))
    return Facts(f"{number}. {measure.text}", headline=measure.driver, rows=rows)
