"""A vehicle file that a run contradicts, and the entry of it that is most likely wrong.

With the file a run gives pads, e^a of the file's in front and e^b behind. Their sum is known well,
so the axle whose pads are as filed is right, and the other one is off by a factor in one entry; or
[front] and [rear] are exchanged: then the sum is right, and a - b = 2 ln((1 - s)/s), s the front
share by the file.
"""

import math

from calib.base.errors import VehicleError
from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning
from calib.car.bias import front_share
from calib.car.keys import FRONT, KEYS, REAR
from calib.car.vehicle import Vehicle
from calib.table.table import Calibration

POSSIBLE = 0.26
"""Departure of the pads' ratio from the file's (logarithm) past which, with its interval, the file
is not that of the car: pads of two grades differ by 30 %."""


def require_file_of_run(
    vehicle: Vehicle,
    calibration: Calibration,
    warnings: tuple[PlausibilityWarning, ...],
) -> None:
    """Raise VehicleError for a ratio of the pads that no two pads have, with what explains it.

    The interval of the ratio counts. ``warnings`` on the file and the logs are told beside it.
    """
    rho = calibration.pad_log_ratio
    if abs(rho.value) - Z95 * rho.sigma <= POSSIBLE:
        return
    raise VehicleError(
        f"the pads come out at {calibration.pad_friction_f.value:.3g} in front and "
        f"{calibration.pad_friction_r.value:.3g} behind, and the file has "
        f"{vehicle.front.pad_friction:g} and {vehicle.rear.pad_friction:g}: it is not that of the "
        f"car of these logs; most likely {explanation(vehicle, calibration)}",
        where=vehicle.name,
        expected="pads of one car, whose ratio differs from the file's by less than "
        f"{100 * math.expm1(POSSIBLE):.0f} %",
        do="if the file is right, look for a motor that brakes one axle, or wheel speeds in the "
        "wrong columns",
        lines=tuple(map(str, warnings)),
    )


def explanation(vehicle: Vehicle, calibration: Calibration) -> str:
    """What in the file may be wrong, in words."""
    share = front_share(vehicle, 0.0)
    a = math.log(calibration.pad_friction_f.value / vehicle.front.pad_friction)
    b = math.log(calibration.pad_friction_r.value / vehicle.rear.pad_friction)
    swap = 2.0 * math.log((1.0 - share) / share)
    summed = math.log(share * math.exp(a) + (1.0 - share) * math.exp(b))
    if math.hypot(summed, a - b - swap) < min(abs(a), abs(b)):
        return "[front] and [rear] are exchanged"
    section, factor = (FRONT, a) if abs(a) > abs(b) else (REAR, b)
    key = next(key for key in KEYS if key.section == section and key.name == "piston_area")
    written = key.value_of(vehicle)
    return (
        f"{key.path}: {written * math.exp(factor):.4g} {key.unit} instead of {written:.4g} "
        f"{key.unit}, or another entry of the {section} brakes by the same factor"
    )
