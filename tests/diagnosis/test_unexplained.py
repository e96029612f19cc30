"""Where an unknown cause is put: on the plant of tests/hidden, with causes of no catalogue."""

import numpy as np
import pytest

from calib.car.effects.effects import EmpiricalTerm
from calib.diagnosis.explanation.channels import CHANNELS, STEP
from calib.diagnosis.terms import ranked_terms, with_terms
from calib.diagnosis.verdict import (
    WHEEL_ANGLE,
    Oscillation,
    Unexplained,
    held_from,
    oscillation_of,
    plainest_first,
    unexplained_of,
)
from tests.support.explained import based
from tests.support.hidden.cases import HiddenCase, draw

FEW = ("ramp", "release", "coast", "step_high")


def hiding(name: str, seed: int, severity: int = 2, only: tuple[str, ...] = FEW) -> HiddenCase:
    return draw("outside", seed, names=(name,), severity=severity, only=only)


def placed(case: HiddenCase) -> Unexplained:
    at = based(case)
    return unexplained_of(at, plainest_first(at, with_terms(at, ranked_terms(at))))


def test_what_turns_with_the_front_wheels_is_told_by_their_angle():
    found = placed(hiding("tone_ring_runout", 31))
    assert found.driver == WHEEL_ANGLE
    assert found.axle == "front"
    assert 0.5 < found.turning <= 1.0


def test_a_wheel_that_always_drags_is_named_and_depends_on_nothing():
    found = placed(hiding("seized_wheel", 32))
    assert (found.axle, found.driver) == ("rear", "constant")
    assert found.wheel is not None
    assert found.wheel.startswith("rear_")
    assert found.turning < 0.05


def test_liquid_that_swings_in_a_tank_is_told_by_its_frequency():
    found = placed(case := hiding("tank_slosh", 35))
    assert (found.axle, found.driver) == ("body", "frequency")
    # a mass on a spring, beside a car that it moves with
    mass, own = case.hidden.slosh_mass, case.hidden.slosh_frequency
    assert found.oscillation.frequency == pytest.approx(own / np.sqrt(1.0 - mass), rel=0.1)
    assert found.oscillation.share > 0.5


def test_brakes_that_a_control_releases_go_with_the_slip():
    found = placed(hiding("abs_modulation", 36, severity=1, only=("ramp", "coast", "step_high")))
    assert (found.axle, found.driver) == ("front", "slip")


def test_brakes_that_weaken_go_with_the_time_of_the_run():
    """Beside a run that begins hot, for discs heat with every application."""
    found = placed(hiding("weaker_applications", 33, only=(*FEW, "hot")))
    assert (found.axle, found.wheel) == ("both", None)
    assert found.driver in ("elapsed", "distance")  # a run goes on over both
    assert 0.5 < found.explained <= 1.0


@pytest.mark.parametrize(("limit", "told"), [(14e5, 15e5), (30e5, None)])
def test_a_torque_that_is_held_from_a_pressure_on_is_told(limit, told):
    p = np.array([0.0, 1.5e5, 8e5, 15e5, 22e5, 29e5])
    factor = np.minimum(p, limit) / np.maximum(p, 1.0)
    values = tuple(np.where(p > 0.0, factor - 1.0, 0.0).tolist())
    assert held_from(EmpiricalTerm("front_brakes", "pressure", tuple(p.tolist()), values)) == told
    assert held_from(EmpiricalTerm("body", "pressure", tuple(p.tolist()), values)) is None


TIME = np.arange(0.0, 120.0, STEP)


def swing_of(signal: np.ndarray, seed: int) -> Oscillation:
    """A signal in a_x beside noise of variance one in every channel."""
    noise = np.random.default_rng(seed).standard_normal((len(CHANNELS), TIME.size))
    noise[CHANNELS.index("a_x")] += signal
    return oscillation_of([noise], float(signal @ signal))


@pytest.mark.parametrize("frequency", [0.55, 0.6, 0.8, 1.1, 2.3])
def test_a_swing_is_found_with_its_frequency(frequency):
    """A swing that an application starts every 10 s, with a hundredth of critical damping."""
    since = TIME % 10.0
    swing = 5.0 * np.exp(-0.06 * frequency * since) * np.sin(2.0 * np.pi * frequency * since)
    result = swing_of(swing, 1)
    assert result.frequency == pytest.approx(frequency, abs=0.06)
    assert result.share > 0.7
    assert result.body


@pytest.mark.parametrize("time_constant", [0.1, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("apart", [3.0, 4.3, 6.1, 9.7])
def test_an_error_that_every_application_leaves_is_no_swing(time_constant, apart):
    """The answer to a lag: a step at the bite that dies away, and its opposite at the release."""
    since = TIME % apart
    half = 0.5 * apart
    error = np.exp(-since / time_constant) - np.where(
        since > half, np.exp(-(since - half) / time_constant), 0.0
    )
    assert swing_of(10.0 * error, 2).share == 0.0
