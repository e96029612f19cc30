"""Ramps of the independent plant with the brakes of one axle only, wheel pressures logged."""

from calib.logs.log import Log
from tests.support.plant import WHEELS, Plant, as_log, drive

SLOPE = {"f": 5e5, "r": 8e5}
"""Rise of the pressure [Pa/s]: to 0.43 g with the front axle, to 0.19 g with the rear one."""


def one_axle(plant: Plant, axle: str, faster: float = 1.0, held: float = 0.0) -> Log:
    """A ramp of 8 s after 1.5 s of rolling, from 33 m/s; the other axle is ``held`` [Pa].

    ``faster`` factor on the slope [1].
    """

    def pressure(t: float) -> float:
        return faster * SLOPE[axle] * max(t - 1.5, 0.0)

    own = {w: pressure if w[0] == axle else lambda t: held for w in WHEELS}
    run = drive(plant, pressure, 33.0, duration=9.5, stop_speed=8.0, wheel_pressure=own)
    return as_log(run, f"ramp_{axle}")
