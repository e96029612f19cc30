"""What a fit says of a car that is braked in all runs."""

from dataclasses import replace

from calib.car.effects.effects import Effects
from calib.fitting.fit import fit
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp

DRAGS = replace(REAL, motor=lambda t: (-240.0, 0.0))
"""An engine brakes the front wheels by 240 N m in all: 0.05 of the weight by their radius."""


def runs(plant):
    """Ramp and coast log, without v."""
    coast = as_log(drive(plant, lambda t: 0.0, 32.0, duration=12.0), "coast")
    logs = [noisy(log, seed) for seed, log in enumerate((ramp(plant), coast))]
    left_out = ("v", "T_drive_f", "T_drive_r")
    return [
        replace(log, channels={k: x for k, x in log.channels.items() if k not in left_out})
        for log in logs
    ]


def codes(car, plant):
    return [warning.code for warning in fit(car, runs(plant)).warnings]


def test_an_engine_that_brakes_in_all_runs_is_named():
    assert "rolling_resistance" in codes(CAR, DRAGS)
    assert "rolling_resistance" not in codes(CAR, REAL)


def test_a_resistance_that_the_vehicle_file_gives_is_not_doubted():
    effects = Effects({"rolling_resistance": {"coefficient": 0.045}})
    assert "rolling_resistance" not in codes(replace(CAR, effects=effects), DRAGS)
