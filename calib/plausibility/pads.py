"""Figures of the pads and tyres of a calibration, and of the change of the pads in a stop."""

import math
from collections.abc import Iterator

from calib.base.errors import VehicleError
from calib.base.intervals import Z95
from calib.base.warning import Measured, PlausibilityWarning, bounds_of, relative
from calib.car.vehicle import Vehicle
from calib.table.budget import grade_sigma, level_and_ratio
from calib.table.table import Calibration, Value

_POSSIBLE = (0.05, 1.0)  # range of pad friction [1]: soaked pads have 0.1, racing pads 0.7
_GRADES = 0.26
"""Largest ratio of front to rear pads over that of the file (logarithm): two grades differ by 30 %.
If the whole 95 % interval is beyond, the file is of another car."""
_LOADED = 0.25  # largest change (logarithm) that may be one of load or sensor: wet pads change more


def require_possible_pads(
    vehicle: Vehicle,
    fitted: Calibration,
    warnings: tuple[PlausibilityWarning, ...],
    motor: str = "",
) -> None:
    """Raise VehicleError, with the ``warnings`` and a ``motor`` as cause, for impossible pads."""
    pads = (fitted.pad_friction_f.value, fitted.pad_friction_r.value)
    (low, high), rho = _POSSIBLE, fitted.pad_log_ratio
    are_apart = abs(rho.value) - Z95 * rho.sigma > _GRADES
    if not are_apart and low <= min(pads) and max(pads) <= high:
        return
    cause = "the unit or the scale of p_mc or a_x, areas, faces, radii or mass in the file"
    if are_apart:
        cause = "area, radius or faces of one axle in the file, or [front] and [rear] exchanged"
    causes = f"{motor}; or {cause}" if motor else cause
    raise VehicleError(
        f"the pads come out at {pads[0]:.3g} in front and {pads[1]:.3g} behind, and the file has "
        f"{vehicle.front.pad_friction:g} and {vehicle.rear.pad_friction:g}: it is not that of the "
        f"car of these logs; most likely {causes}",
        where=vehicle.name,
        expected=f"pads of {low:g} to {high:g}, whose ratio differs from the file's by less than "
        f"{100 * math.expm1(_GRADES):.0f} %",
        do="if the file is right, look for a motor that brakes one axle, or columns and units of "
        "the logs that are wrong",
        lines=tuple(map(str, warnings)),
    )


def calibration_figures(
    vehicle: Vehicle, fitted: Calibration, user_specified: Value | None = None
) -> Iterator[Measured]:
    """Pads over those of the file, their ratio over a ``user_specified`` one, tyre stiffness."""
    axles = [
        relative("pads_off_file_f", fitted.pad_friction_f.value, vehicle.front.pad_friction),
        relative("pads_off_file_r", fitted.pad_friction_r.value, vehicle.rear.pad_friction),
    ]
    yield from axles
    low, high = bounds_of("pads_off_file_f")
    if all(low <= axle.value <= high for axle in axles):
        scale = fitted.pad_scale
        sigma = math.hypot(grade_sigma(vehicle), scale.sigma / scale.value)
        yield Measured("pads_off_file", level_and_ratio(vehicle, fitted).level, sigma, math.expm1)
    rho, expected = fitted.pad_log_ratio, user_specified.value if user_specified else 0.0
    # judged against the expected ratio, shown against that of the file
    yield Measured("pad_ratio", rho.value - expected, rho.sigma, lambda x: math.expm1(expected + x))
    yield Measured("tyre_stiffness", fitted.slip_stiffness.value)


def change_figures(level: tuple[float, float], ratio: tuple[float, float]) -> Iterator[Measured]:
    """Change of the brakes from ramp to stop: ln of ``level`` and ``ratio``, each with its sigma.

    In eta and slip, tyres, a load or a motor look like a change of the ratio.
    """
    yield Measured("pads_changed_apart", *ratio, math.expm1)
    if abs(level[0]) < _LOADED:
        yield Measured("level_changed", *level, math.expm1)
