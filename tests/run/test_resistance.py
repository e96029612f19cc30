"""Drag and rolling resistance found again in the coasting of a plant that has them."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.body import AERODYNAMIC_DRAG
from calib.car.effects.effects import Effects
from calib.car.effects.wheels import ROLLING_RESISTANCE
from calib.run.axle_signals import signals
from calib.run.blocks import blocks
from calib.run.noise import sensor_noise
from calib.run.resistance import identify
from tests.support.plant import Plant, as_log, drive
from tests.support.tables import VEHICLE

CAR = replace(VEHICLE, effects=Effects())
TRUE = (0.80, 0.015)
PRIOR = tuple(effect.card.parameters[0] for effect in (AERODYNAMIC_DRAG, ROLLING_RESISTANCE))


def coasted(v0, duration, pressure=lambda t: 0.0):
    plant = Plant(VEHICLE, drag_area=TRUE[0], rolling_resistance=TRUE[1])
    return drive(plant, pressure, v0, duration=duration)


@pytest.fixture(scope="module")
def coast():
    return coasted(38.0, 60.0)


@pytest.fixture(scope="module")
def ramp():
    return coasted(30.0, 5.0, lambda t: 6e5 * max(t - 2.0, 0.0))


def measured(run, seed=0):
    """Blocks and noise density of z, with sensor noise: 0.05 m/s^2 and 0.02 rad/s, white."""
    rng = np.random.default_rng(seed)
    sd = {"a_x": 0.05, "v": 0.02, **dict.fromkeys([k for k in run if k.startswith("omega")], 0.02)}
    noisy = {k: x + sd.get(k, 0.0) * rng.normal(size=x.size) for k, x in run.items()}
    log = as_log(noisy)
    b = blocks(signals(log, CAR.rear.rolling_radius))
    return b, sensor_noise(log, b).z


def deceleration(resistance, v):
    """Deceleration [1] by drag area and rolling coefficient at ``v`` [m/s], written out here."""
    return 0.6 * resistance[0] * v**2 / (1744.0 * 9.80665) + resistance[1]


def test_a_coast_separates_the_two_within_their_sigma(coast):
    estimate = [identify(CAR, [measured(coast, seed)]) for seed in range(20)]
    error = [(np.array(f.mean) - TRUE) / np.sqrt(np.diag(f.covariance)) for f in estimate]
    # sigma counts what a real coast is off by besides noise, so noise alone scatters less
    assert np.max(np.abs(error)) < 2.0
    for i in (0, 1):
        assert np.sqrt(estimate[0].covariance[i][i]) < 0.2 * PRIOR[i].spread
    assert estimate[0].mean == pytest.approx(TRUE, rel=0.03)  # what is usual is 19 and 27 % away


def test_an_engine_that_drags_and_is_logged_is_no_resistance(coast):
    """150 N m at the front wheels, as an engine in gear: as much as half of the rolling."""
    plant = Plant(VEHICLE, drag_area=TRUE[0], rolling_resistance=TRUE[1])
    engine = replace(plant, motor=lambda t: (-150.0, 0.0))
    run = drive(engine, lambda t: 0.0, 38.0, duration=60.0)
    logged = identify(CAR, [measured(run)]).mean
    assert logged == pytest.approx(TRUE, rel=0.03)
    assert logged == pytest.approx(identify(CAR, [measured(coast)]).mean, rel=0.03)
    silent = {k: x for k, x in run.items() if k != "T_drive_f"}
    assert identify(CAR, [measured(silent)]).mean[1] > 1.3 * TRUE[1]


def test_a_lead_in_gives_the_sum_and_leaves_the_parts(ramp):
    b, density = measured(ramp)
    estimate = identify(CAR, [(b, density)])
    v = np.array([30.0])
    error = deceleration(estimate.mean, 30.0) - deceleration(TRUE, 30.0)
    assert abs(error) < 3.0 * estimate.sigma_z(CAR, v)[0]
    alone = identify(CAR, [])
    assert alone.mean == pytest.approx([p.typical for p in PRIOR], rel=1e-9)
    assert np.asarray(alone.covariance) == pytest.approx(np.diag([p.spread**2 for p in PRIOR]))
    assert not alone.specified
    assert estimate.sigma_z(CAR, v)[0] < 0.3 * alone.sigma_z(CAR, v)[0]
    for i in (0, 1):
        assert estimate.covariance[i][i] > 0.2 * PRIOR[i].spread ** 2
    (drag, cross), (_, rolling) = estimate.covariance
    correlation = cross / np.sqrt(drag * rolling)
    assert correlation < -0.8


@pytest.mark.parametrize("runs", [1, 4])
def test_a_long_quiet_coast_is_still_off_by_what_is_not_modelled(coast, runs):
    """Wind and crown last a whole run: only other runs average them, however long this one is."""
    b, _ = measured(coast)
    estimate = identify(CAR, [(b, 1e-6)] * runs)
    speeds = np.linspace(15.0, 40.0, 101)
    assert np.min(estimate.sigma_z(CAR, speeds)) == pytest.approx(3e-4 / runs**0.5, rel=0.02)


def test_known_effects_are_kept(coast):
    drag, rolling = {"drag_area": 0.66, "load_share": 0.2}, {"coefficient": 0.011}
    effects = Effects({"aerodynamic_drag": drag, "rolling_resistance": rolling})
    car = replace(CAR, effects=effects)
    estimate = identify(car, [measured(coast)])
    assert estimate.specified
    assert estimate.mean == (0.66, 0.011)  # though the coast says 0.80 and 0.015
    assert estimate.effects.parameters == car.effects.parameters
    assert estimate.effects.sigma["aerodynamic_drag"]["load_share"] == 0.0


def test_one_known_effect_gives_the_other_from_a_lead_in(ramp):
    car = replace(CAR, effects=Effects({"aerodynamic_drag": {"drag_area": TRUE[0]}}))
    estimate = identify(car, [measured(ramp)])
    assert not estimate.specified
    assert estimate.mean[0] == TRUE[0]
    assert abs(estimate.mean[1] - TRUE[1]) < 3.0 * np.sqrt(estimate.covariance[1][1])
    assert np.sqrt(estimate.covariance[1][1]) < 0.2 * PRIOR[1].spread


def test_drag_and_rolling_are_never_negative(coast):
    b, density = measured(coast)
    pushed = replace(b, z=b.z - 0.05)  # a driven car
    assert min(identify(CAR, [(pushed, density)]).mean) == 0.0


def test_sigma_of_the_deceleration_is_that_of_draws(coast):
    estimate = identify(CAR, [measured(coast)])
    rng = np.random.default_rng(1)
    draws = rng.multivariate_normal(estimate.mean, estimate.covariance, 20_000).T
    speeds = np.array([3.0, 20.0, 40.0])
    spread = [np.std(deceleration(draws, v)) for v in speeds]
    assert estimate.sigma_z(CAR, speeds) == pytest.approx(spread, rel=0.03)
