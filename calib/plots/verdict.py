"""The verdict of a validation in the few words of a title, and its warnings for the note."""

from calib.names import AXLE_NAMES
from calib.validation.limits import Judgement
from calib.validation.validate import CALIBRATION, Validation


def verdict_of(result: Validation) -> str:
    """The verdict in words, with what failed: `failed: interval front 0.15, at most 0.14`."""
    if result.role == CALIBRATION:
        return "no verdict: the table was fitted on this log"
    count = len(result.all_warnings)
    more = f", {count} warning{'s' * (count > 1)}" if count else ""
    broken = [j for j in result.judgements if j.passed is False]
    why = "; ".join(f"{_spoken(j.figure)} {_against(j)}" for j in broken)
    return result.verdict + (f": {why}" if why else "") + more


def warned(result: Validation) -> tuple[str, ...]:
    """The warnings in a sentence, for the note."""
    names = ", ".join(_spoken(warning.code) for warning in result.all_warnings)
    return (f"Warnings, which `brake-cal validate` explains: {names}.",) if names else ()


def _spoken(figure: str) -> str:
    """The name of a metric in words."""
    stem, _, side = figure.rpartition("_")
    axle = AXLE_NAMES.get(side)
    return (f"{stem}_{axle}" if axle else figure).replace("_", " ")


def _against(judgement: Judgement) -> str:
    value, low, high = judgement.value, judgement.low, judgement.high
    if value is None:
        return "is not known"
    below = low is not None and value < low
    return f"{value:.3g}, at least {low:g}" if below else f"{value:.3g}, at most {high:g}"
