"""A diagnosis does not hang on the last digits of its inputs, nor of a matrix product."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.diagnosis import Diagnosis
from tests.support.explained import diagnosed, left_in
from tests.support.hidden.cases import HiddenCase, draw
from tests.support.rounding import jittered


def moved(case: HiddenCase, seed: int) -> HiddenCase:
    """The case in one of the ways in which rounding may have it."""
    parts = (
        [jittered(log, seed + 10 * i) for i, log in enumerate(part)]
        for part in (case.calibration, case.holdout)
    )
    calibration, holdout = map(tuple, parts)
    return replace(case, calibration=calibration, holdout=holdout)


def told(found: Diagnosis) -> tuple[object, ...]:
    """What a diagnosis says in words."""
    rest = found.unexplained
    return (
        found.verdict,
        [(one.name, one.where.channel, one.where.axle) for one in found.effects],
        rest and (rest.place, rest.driver, rest.axle, rest.wheel),
        [(one.effect, one.drive) for one in found.drives],
        [one.code for one in found.warnings],
    )


def numbers(found: Diagnosis) -> dict[str, tuple[float, float, float]]:
    """Every parameter with its interval."""
    every = {f"{e.name} {p}": x for e in found.effects for p, x in e.parameters.items()}
    return {name: (x.value, *x.ci95) for name, x in (every | found.base).items()}


def test_a_diagnosis_does_not_hang_on_the_last_digits():
    case = draw("single", 11, ("aerodynamic_drag",), severity=1, only=("coast", "ramp", "stop_a"))
    found, other = diagnosed(case), diagnosed(moved(case, 1))
    assert told(other) == told(found)
    for name, (value, low, high) in numbers(found).items():
        assert np.abs(numbers(other)[name] - np.array([value, low, high])).max() <= 1e-4 * (
            high - low
        ), name


@pytest.mark.parametrize("seed", [1, 2])
def test_the_driver_of_an_unknown_cause_does_not_hang_on_the_last_digits(seed):
    """With secant updates two of five said pressure instead of constant."""
    case = draw("outside", 32, names=("seized_wheel",), severity=2, only=("ramp", "coast"))
    found = left_in(moved(case, seed))
    assert (found.place, found.driver) == ("rear_wheels", "constant")
