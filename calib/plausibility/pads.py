"""What the pads of a calibration or of a stop say against vehicle file, sensors and tyres."""

import math
from collections.abc import Iterator

from calib.base.errors import LogError
from calib.base.warning import Measured, relative
from calib.car.vehicle import Vehicle
from calib.table.table import Calibration, TyrePosterior, Value

POSSIBLE = (0.05, 1.0)
"""Pad friction [1] that a brake can have: soaked pads have 0.1, racing pads 0.7."""
LOADED = 0.25
"""Change of the brakes past which no load and no sensor that works is the cause (logarithm): all
seats and the boot are a quarter of a car's mass. Pads that are soaked lose half."""


def require_possible_pads(vehicle: Vehicle, calibration: Calibration, where: str) -> None:
    """Raise LogError for a pad friction that no pad has."""
    low, high = POSSIBLE
    for side, axle, found in (
        ("front", vehicle.front, calibration.pad_friction_f),
        ("rear", vehicle.rear, calibration.pad_friction_r),
    ):
        if not low <= found.value <= high:
            raise LogError(
                f"the {side} pads come out with a friction of {found.value:.3g}, which no pad has",
                where=where,
                expected=f"{low:g} to {high:g}; {vehicle.name} has {axle.pad_friction:g} by its "
                "file",
                do="check the unit and the scale of p_mc, piston areas, friction_faces, radii and "
                "mass of the vehicle file, and a_x",
            )


def of_calibration(
    vehicle: Vehicle,
    calibration: Calibration,
    posterior: TyrePosterior,
    stated: Value | None = None,
) -> Iterator[Measured]:
    """Pads against the file's, their ratio, the stiffness of the tyres.

    ``stated`` what the user says of the logarithm of the ratio: it is to be near that.
    """
    for code, axle, found in (
        ("pads_off_file_f", vehicle.front, calibration.pad_friction_f),
        ("pads_off_file_r", vehicle.rear, calibration.pad_friction_r),
    ):
        yield relative(code, found.value, axle.pad_friction)
    rho, known = calibration.pad_log_ratio, stated.value if stated else 0.0
    yield Measured("pad_ratio", rho.value - known, rho.sigma, lambda x: math.expm1(known + x))
    yield Measured("tyre_stiffness", math.exp(-posterior.value("log_compliance")))


def of_changes(level: tuple[float, float], apart: tuple[float, float]) -> Iterator[Measured]:
    """How the brakes of a stop differ from those of the ramp; logarithms, each with its sigma.

    ``level`` of the brake force over that of the ramp's pads, ``apart`` of the front pads' change
    over that of the rear ones: what eta and slip cannot tell from tyres, a load or a motor.
    """
    yield Measured("pads_changed_apart", *apart, math.expm1)
    if abs(level[0]) < LOADED:
        yield Measured("level_changed", *level, math.expm1)
