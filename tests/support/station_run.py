"""A car that failed at the station, from the sample logs."""

from dataclasses import replace
from functools import cache
from pathlib import Path

from calib.car.vehicle_file import read_vehicle
from calib.line.station.limits_file import LIMITS
from calib.line.station.station import StationOutcome, judged_car
from calib.logs.read import read_log

SEDAN = Path(__file__).parents[2] / "sample_logs" / "sedan"
MARKUP = "<img src=x onerror=alert(1)>&\"'$"
"""A name that would do harm where it is not escaped, and a dollar that would start a formula."""


@cache
def failed_car() -> StationOutcome:
    """A car with a log and a serial number named in markup, whose pads are past their limits."""
    car = replace(read_vehicle(SEDAN / "vehicle.toml"), name="sedan")
    ramp, coast = (read_log(SEDAN / f"{n}.csv") for n in ("ramp_wet_asphalt", "coast"))
    stops = [read_log(SEDAN / f"{n}.csv") for n in ("dry_asphalt_stop", "basalt_wet_pads")]
    stops[0] = replace(stops[0], name=MARKUP, notes=(f"channel {MARKUP} was not taken",))
    identity = {"serial": MARKUP, "vin": "WVWZZZ1JZXW000001"}
    limits = tuple(
        replace(one, high=0.9) if one.figure in ("pad_scale", "pad_ratio") else one
        for one in LIMITS
    )
    return judged_car(car, [ramp], [coast], stops, limits, identity)
