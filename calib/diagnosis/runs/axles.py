"""Whether the wheel speeds of front and rear axle are swapped, in some logs or in all.

Where the rear wheels slip more than the front ones, the wheel speeds are swapped, or something
brakes the rear wheels, such as a motor, which is an effect with a name. The more probable one is
believed: the logs as given, by what a search found, or with their axles exchanged, by the best of a
few effects of the first ranking, or of none.
"""

from collections.abc import Sequence
from dataclasses import replace

from calib.base.errors import LogError
from calib.base.warning import PlausibilityWarning
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, turned
from calib.diagnosis.search.fits import Fits
from calib.diagnosis.search.rank import promises, trials
from calib.diagnosis.search.search import Search
from calib.logs.log import Log

SWAPPED = "axles_swapped"  # code of the warning of eta that goes the wrong way
_FITTED = 3  # explanations of exchanged logs


def require_right_axles(
    search: Search, logs: Sequence[Log], warnings: Sequence[PlausibilityWarning]
) -> None:
    """Raise LogError if the ``logs`` of a search, hold-outs too, are swapped, some or all.

    Some are those whose eta goes the wrong way by the ``warnings``; without any, nothing is tried.
    """
    told = {one.log: one for one in warnings if one.code == SWAPPED}
    if not told:
        return
    every = [_exchanged(log) for log in logs]
    some = [b if b.name in told else a for a, b in zip(logs, every, strict=True)]
    found = search.fits.value(search.best)
    if any(_log_evidence(search.problem, others) > found for others in (some, every)):
        sources = [log.source for log in logs if log.name in told]
        raise LogError(next(iter(told.values())).text, where=", ".join(sources))


def _log_evidence(given: Problem, logs: Sequence[Log]) -> float:
    """ln of the evidence of other logs with the same noise, by the best of a few explanations."""
    runs = turned(given.vehicle, [run_of(log) for log in logs], given.noise)
    problem = replace(given, runs=runs)
    fits = Fits(problem, problem)
    fits.best_of(promises(fits.base, trials(fits.base))[:_FITTED], fits.base)
    return max(one.log_evidence for one in fits.fitted.values())


def _exchanged(log: Log) -> Log:
    """The log with the wheel speeds of the other axle."""
    other = {f"omega_{a}{side}": log[f"omega_{b}{side}"] for a, b in ("fr", "rf") for side in "lr"}
    return replace(log, channels=log.channels | other)
