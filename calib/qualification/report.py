"""The page of a qualification: one HTML file that fetches nothing."""

from calib.program import PROGRAM
from calib.qualification.check import Outcome
from calib.qualification.document import Surroundings, digest, verdict
from calib.qualification.suite import Qualification
from calib.qualification.use_cases import USE_CASES, Malfunction
from calib.reports.html import page
from calib.units import behind


def headline(found: Qualification) -> str:
    """The result in one sentence."""
    failed = [o.check.name for o in found.outcomes if not o.held]
    number = len(found.outcomes)
    if not failed:
        return f"All {number} checks hold.{_left_out(found)}"
    return f"{len(failed)} of {number} checks {'do' if len(failed) > 1 else 'does'} not hold: " + (
        ", ".join(failed) + f".{_left_out(found)}"
    )


def _left_out(found: Qualification) -> str:
    """A sentence on the checks that were not made, if there are any."""
    if not found.left_out:
        return ""
    missing = sorted({name for check in found.left_out for name in check.missing})
    names = ", ".join(check.name for check in found.left_out)
    return f" Not made, because {', '.join(missing)} is not installed: {names}."


def report_html(found: Qualification, at: Surroundings) -> str:
    """Return the page."""
    held = {o.check.name: o.held for o in found.outcomes}
    return page(
        "qualification",
        title=f"{PROGRAM}: qualification",
        tool=PROGRAM,
        verdict=verdict(found),
        headline=headline(found),
        identity=[
            ("Date", at.date),
            ("Results, SHA-256", digest(found.outcomes)),
            *((name.capitalize(), text or "not told") for name, text in at.environment.items()),
        ],
        failures=[_failure(outcome) for outcome in found.outcomes if not outcome.held],
        use_cases=[
            (case.name, case.about, [_malfunction(m, held) for m in case.malfunctions])
            for case in USE_CASES
        ],
        checks=[_row(outcome) for outcome in found.outcomes],
        kinds=["passed" if outcome.held else "failed" for outcome in found.outcomes],
        truths=[
            (o.check.name, f"{o.check.quantity} [{o.check.unit}]. Truth: {o.check.truth}.")
            for o in found.outcomes
        ],
        packages=list(at.packages.items()),
        files=list(found.files.items()),
    )


def _malfunction(one: Malfunction, held: dict[str, bool]) -> tuple[str, ...]:
    made = [f"{name} {'holds' if held[name] else 'fails'}" for name in one.checks if name in held]
    return one.what, one.effect, one.measure, ", ".join(made) or "none in this run"


def _failure(outcome: Outcome) -> tuple[str, ...]:
    check = outcome.check
    wanted = f"{check.expected:.6g} +- {check.tolerance:.3g}{behind(check.unit)}"
    came = outcome.error if outcome.value is None else f"{outcome.value:.6g}{behind(check.unit)}"
    return check.name, check.quantity, wanted, came


def _row(outcome: Outcome) -> tuple[str, ...]:
    check = outcome.check
    value = "none" if outcome.value is None else f"{outcome.value:.6g}"
    result = "holds" if outcome.held else "fails"
    return check.name, f"{check.expected:.6g}", result, value, f"{check.tolerance:.3g}", check.unit
