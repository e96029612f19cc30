"""A plan as facts: a card for the driver on one page, and what each step brings."""

from collections.abc import Sequence

from calib.base.plain import NBSP
from calib.plan.achieved import Achieved
from calib.plan.measure import pressure_trace
from calib.plan.search import Plan, Step
from calib.show.facts import DIR, FAILED, PASSED, UNJUDGED, Facts, Table

_HEADS = ("torque known to (95 %)", "front [%]", "rear [%]", "total [%]")


def plan_facts(plan: Plan) -> Facts:
    """What to do, what it brings, and what it cannot bring."""
    named = plan.after._asdict().items()
    widths = ", ".join(f"{axles} ±{100.0 * width:.1f}{NBSP}%" for axles, width in named)
    wanted, met = any(plan.want.widths), plan.want.met_by(plan.after)
    rows = [
        ("before", *_cells(plan.start)),
        *((f"{i}. {s.measure.text}", *_cells(s.widths)) for i, s in enumerate(plan.steps, 1)),
        ("the same, with the speed v logged", *_cells(plan.with_speed or ())),
        ("wanted", *_cells(plan.want.widths if wanted else (), none="-")),
        ("all runs that can be driven here", *_cells(plan.floor_of_runs)),
        ("and all measurements of a workshop", *_cells(plan.floor)),
    ]
    return Facts(
        title=f"Plan for {plan.prior.vehicle.name}",
        verdict=(PASSED if met else FAILED) if wanted else UNJUDGED,
        word=("Enough" if met else "Not enough") if wanted else "Planned",
        headline=f"{widths} after {plan.seconds:.0f}{NBSP}s",
        tables=[Table(_HEADS, [row for row in rows if row[1:]])],
        notes=_notes(plan),
        next=f"brake-cal fit LOG... --vehicle V.toml --plan {DIR}/plan.json",
        parts=[_card(plan, step, i) for i, step in enumerate(plan.steps, 1)],
    )


def _cells(widths: Sequence[float], none: str = "not known") -> tuple[str, ...]:
    return tuple(f"{100.0 * w:.1f}" if 0.0 < w < 10.0 else none for w in widths)


def _notes(plan: Plan) -> list[str]:
    texts = ", ".join(measure.text for measure in plan.not_worth)
    notes = [f"Not worth driving in addition: {texts}."] if texts else []
    return notes + [f"Not possible here: {x}." for x in dict.fromkeys(plan.impossible.values())]


def _card(plan: Plan, step: Step, number: int) -> Facts:
    measure = step.measure
    rows = [("time", f"{step.seconds:.0f}{NBSP}s")]
    if measure.driven:
        rows.insert(0, ("from", f"{3.6 * plan.prior.track.speed:.0f}{NBSP}km/h"))
    if measure.kind == "ramp":
        top = float(pressure_trace(plan.prior.vehicle, measure)[1].max()) / 1e5
        rows.append(("pressure at the end", f"{top:.0f}{NBSP}bar"))
    return Facts(f"{number}. {measure.text}", headline=measure.driver, rows=rows)


def achieved_facts(result: Achieved) -> Facts:
    """Planned against achieved."""
    rows = [("planned", *_cells(result.planned)), ("achieved", *_cells(result.achieved))]
    word = "as planned" if result.reached else "wider than planned"
    return Facts("Planned and achieved", word, tables=[Table(_HEADS, rows)], notes=result.reasons)
