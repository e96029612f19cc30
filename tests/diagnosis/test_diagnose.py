"""The diagnosis on cases of the hidden plant, which shares nothing with the program.

A handful here; tests/studies/naming.py scores hundreds.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.diagnosis.diagnose import Diagnosis, diagnose
from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.search.decide import decide
from calib.diagnosis.written.document import to_dict
from calib.logs.log import Log
from tests.support.hidden.cases import HiddenCase, draw


def answer(case: HiddenCase) -> Diagnosis:
    return diagnose(case.vehicle, list(case.calibration), list(case.holdout))


def verdict(logs: list[Log], case: HiddenCase) -> tuple[str, tuple[str, ...]]:
    problem = problem_of(case.vehicle, [run_of(log) for log in logs])
    decision = decide(fit(problem, (), np.zeros(BASE)))
    return decision.verdict, decision.best.names


class Unread(dict[str, Array]):
    """Truth channels that nobody may read."""

    def __getitem__(self, name: str) -> Array:
        raise AssertionError(f"{name} was read")

    get = items = values = __iter__ = __contains__ = __getitem__  # type: ignore[assignment]


@pytest.fixture(scope="module")
def drag() -> HiddenCase:
    """Drag; every log with a digest of its own, as a file has, and a truth that nobody may read."""
    case = draw("single", 11, names=("aerodynamic_drag",), severity=1)
    named = [
        [replace(log, digest=log.name, truth=Unread()) for log in part]
        for part in (case.calibration, case.holdout)
    ]
    return replace(case, calibration=tuple(named[0]), holdout=tuple(named[1]))


Told = list[tuple[str, int, int]]


@pytest.fixture(scope="module")
def told(drag) -> tuple[Diagnosis, Told]:
    """The diagnosis of the drag, and what was told of its progress."""
    stages: Told = []
    found = diagnose(
        drag.vehicle, list(drag.calibration), list(drag.holdout), lambda *one: stages.append(one)
    )
    return found, stages


def test_a_single_effect_is_named_with_an_interval_that_holds_it():
    case = draw("single", 12, names=("rolling_radius_mismatch",), severity=1)
    found = answer(case)
    assert found.verdict == "named"
    assert [effect.name for effect in found.effects] == ["rolling_radius_mismatch"]
    low, high = found.effects[0].parameters["radius_mismatch"].ci95
    assert low <= case.hidden.radius_mismatch <= high
    assert found.gap.closed > 0.8
    assert found.gap.after < 1.5  # in units of the noise


def test_progress_is_told_stage_by_stage(told):
    _, steps = told
    assert all(0 <= done < total for _, done, total in steps)
    assert len({stage for stage, _, _ in steps}) > 4


def test_a_drag_is_named_and_the_truth_is_not_read(told):
    assert [effect.name for effect in told[0].effects] == ["aerodynamic_drag"]


def test_two_effects_at_once():
    case = draw("double", 13, names=("rolling_resistance", "hydraulic_delay"), severity=1)
    found = answer(case)
    assert {effect.name for effect in found.effects} == {"rolling_resistance", "hydraulic_delay"}


def test_nothing_hidden_is_no_gap_and_leaves_the_model_alone():
    found = answer(draw("none", 14))
    assert found.verdict == "no_gap"
    assert found.effects == ()
    assert found.model_after == found.model_before


def test_what_the_catalogue_does_not_know_is_unknown_on_the_right_axle():
    case = draw("outside", 15, names=("seized_wheel",), severity=2)
    found = answer(case)
    assert found.verdict == "unknown"
    assert found.unexplained is not None
    assert found.unexplained.axle == "rear"
    assert len(found.model_after.effects.terms) == 1


@pytest.mark.slow
def test_the_order_of_the_logs_does_not_matter(drag, told):
    other = diagnose(drag.vehicle, list(drag.calibration)[::-1], list(drag.holdout))
    assert to_dict(told[0]) == to_dict(other)


@pytest.mark.slow
def test_half_the_sample_rate_gives_the_same_verdict(drag):
    half = [
        replace(log, channels={k: v[::2] for k, v in log.channels.items()})
        for log in drag.calibration
    ]
    assert verdict(half, drag) == verdict(list(drag.calibration), drag)


def test_logs_that_cannot_give_an_answer_are_refused(drag):
    logs, held = list(drag.calibration), list(drag.holdout)
    with pytest.raises(LogError, match="no hold-out"):
        diagnose(drag.vehicle, logs, [])
    with pytest.raises(LogError, match="among the calibration logs"):
        diagnose(drag.vehicle, logs, [logs[0]])
    with pytest.raises(LogError, match="given twice"):
        diagnose(drag.vehicle, [*logs, logs[0]], held)
    larger = replace(drag.vehicle.front, rolling_radius=1.1 * drag.vehicle.front.rolling_radius)
    with pytest.raises(LogError, match="the front wheels roll with a radius"):
        diagnose(replace(drag.vehicle, front=larger), logs, held)
    with pytest.raises(LogError, match="two or more"):
        diagnose(drag.vehicle, logs[:1], held)
    coasts = [log for log in logs if np.max(log["p_mc"]) < 1e5]
    with pytest.raises(LogError, match="nothing is braked"):
        diagnose(drag.vehicle, coasts, held)
    blind = [
        replace(log, channels={k: v for k, v in log.channels.items() if k != "v"}) for log in logs
    ]
    with pytest.raises(LogError, match="no reference speed"):
        diagnose(drag.vehicle, blind, held)
