"""Whether the wheel speeds of front and rear axle are swapped, in some logs or in all.

Where the rear wheels slip more than the front ones, the wheel speeds are swapped, or a motor brakes
the rear wheels, which is an effect with a name. Both are tried on all logs together, and the more
probable one is believed:

    the logs as given, with a motor      against      the logs with their axles exchanged

One more effect, whichever helps most, is allowed to both: what is hidden must not decide.
"""

from collections.abc import Sequence
from dataclasses import replace

from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.hypothesis import Hypothesis, start_of
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.runs.judged import JudgedLog
from calib.diagnosis.search.rank import further_columns, promises
from calib.diagnosis.search.search import left_over
from calib.logs.log import Log
from calib.run.gates import require_right_slip, wrong_slip

MOTOR = "regenerative_torque"
"""The effect that makes the rear wheels slip more."""


def require_axles(vehicle: Vehicle, logs: Sequence[Log], judged: Sequence[JudgedLog]) -> None:
    """Raise LogError if the logs are better explained with front and rear wheels exchanged.

    ``judged`` are the same ``logs``, in their order. Nothing is tried unless eta goes the wrong
    way in one of them.
    """
    wrong = [wrong_slip(one.vehicle, one.blocks) is not None for one in judged]
    if not any(wrong):
        return
    motor = _with_best(_fitted(vehicle, logs), MOTOR)
    if not left_over(motor):
        return  # nothing is left for exchanged axles to explain
    motor = _with_best(motor)
    tried = (wrong, [True] * len(logs))
    swapped = [
        _with_best(_fitted(vehicle, [_exchanged(log) if other else log for log, other in pairs]))
        for pairs in (list(zip(logs, which, strict=True)) for which in tried)
    ]
    if min(one.reduced for one in swapped) < motor.reduced:
        first = judged[wrong.index(True)]
        sources = ", ".join(log.source for log, other in zip(logs, wrong, strict=True) if other)
        require_right_slip(first.vehicle, replace(first.log, source=sources), first.blocks)


def _with_best(at: Explanation, name: str = "") -> Explanation:
    """The explanation with the effect that brings most, or with one by its name."""
    found = [
        p for p in promises(at, further_columns(at), 1) if name in ("", p.hypothesis.names[-1])
    ]
    if not found:
        return at
    other = fit(at.problem, found[0].hypothesis, found[0].state, at.columns)
    return min(at, other, key=lambda one: one.reduced)


def _fitted(vehicle: Vehicle, logs: Sequence[Log]) -> Explanation:
    problem = problem_of(vehicle, [run_of(log) for log in logs])
    return fit(problem, Hypothesis(), start_of(problem))


def _exchanged(log: Log) -> Log:
    """The log with the wheel speeds of the other axle."""
    other = {f"omega_{a}{side}": log[f"omega_{b}{side}"] for a, b in ("fr", "rf") for side in "lr"}
    return replace(log, channels=log.channels | other)
