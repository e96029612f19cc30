"""A valve of the rear pressure that the vehicle file does not have is named by the fit."""

from dataclasses import replace

import numpy as np

from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.fitting.fit import fit
from tests.support.plant import Plant, as_log, drive, magic
from tests.support.reference_car import CAR, noisy, without

FRONT_BIASED = replace(
    CAR, rear=replace(CAR.rear, piston_area=0.75 * CAR.rear.piston_area), effects=Effects()
)
KNEE = 25e5


def ramp(valve: float | None, seed: int):
    """A ramp to 45 bar; rear torque falls as behind a valve: the plant has no pressure by axle."""

    def pressure(t: float) -> float:
        return 5e5 * max(t - 1.5, 0.0)

    def pads(t: float) -> tuple[float, float]:
        p = pressure(t)
        rear = 1.0 if valve is None or p <= KNEE else (KNEE + valve * (p - KNEE)) / p
        return 0.38, 0.38 * rear

    plant = Plant(FRONT_BIASED, tyre=magic(25.0, 0.95), pads=pads)
    run = drive(plant, pressure, 33.0, duration=10.5, stop_speed=8.0)
    return noisy(as_log(run, "ramp"), seed)


def codes(vehicle: Vehicle, log) -> list[str]:
    return [warning.code for warning in fit(vehicle, [log]).warnings]


def test_a_valve_is_named_with_its_pressure():
    warnings = fit(FRONT_BIASED, [ramp(0.5, 1)]).warnings
    (warning,) = [x for x in warnings if x.code == "rear_pressure_limited"]
    assert "20 bar" in warning.causes[0] or "25 bar" in warning.causes[0]
    assert warning.measured > 2.0 * warning.expected[1]


def test_a_car_without_one_is_right_without_v():
    assert "rear_pressure_limited" not in codes(FRONT_BIASED, without(ramp(None, 4), "v"))


def test_a_declared_valve_is_known():
    valve = Effects({"rear_proportioning": {"knee_slope": 0.4, "knee": KNEE}})
    table = fit(replace(FRONT_BIASED, effects=valve), [ramp(0.4, 2)])
    assert "rear_pressure_limited" not in [warning.code for warning in table.warnings]
    low, high = table.calibration.pad_friction_r.ci95
    assert low < 0.38 < high


def test_a_logged_rear_pressure_is_not_asked():
    log = ramp(0.4, 3)
    p = log["p_mc"]
    behind = np.where(p > KNEE, KNEE + 0.4 * (p - KNEE), p)
    measured = {"p_fl": p, "p_fr": p, "p_rl": behind, "p_rr": behind}
    logged = replace(log, channels={**log.channels, **measured})
    assert "rear_pressure_limited" not in codes(FRONT_BIASED, logged)
