"""What the pads of a calibration or of a stop say against vehicle file, sensors and tyres."""

import math
from collections.abc import Iterator

from calib.base.errors import LogError
from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning, warning
from calib.car.vehicle import Vehicle
from calib.plausibility.limits import PLAUSIBLE
from calib.table.table import Calibration, TyrePosterior, Value

_LEVEL_CAUSES = (
    "the unit or the scale of p_mc",
    "the scale of a_x",
    "mass, piston areas, friction_faces or radii of the vehicle file",
    "pads of another grade",
)


def require_possible_pads(vehicle: Vehicle, calibration: Calibration, where: str) -> None:
    """Raise LogError for a pad friction that no pad has."""
    low, high = PLAUSIBLE.pads_possible
    for side, value in (
        ("front", calibration.pad_friction_f.value),
        ("rear", calibration.pad_friction_r.value),
    ):
        if not low <= value <= high:
            raise LogError(
                f"the {side} pads come out with a friction of {value:.3g}, which no pad has",
                where=where,
                expected=f"{low:g} to {high:g}; {vehicle.name} has {_of_file(vehicle, side):g} by "
                "its file",
                do="check the unit and the scale of p_mc, piston areas, friction_faces, radii and "
                "mass of the vehicle file, and a_x",
            )


def _of_file(vehicle: Vehicle, side: str) -> float:
    return (vehicle.front if side == "front" else vehicle.rear).pad_friction


def calibration_warnings(
    vehicle: Vehicle,
    calibration: Calibration,
    posterior: TyrePosterior,
    stated: Value | None = None,
) -> Iterator[PlausibilityWarning]:
    """Pads far from the file's, their ratio, and a tyre that no road car has.

    ``stated`` what the user says of the logarithm of the ratio: it is to be near that.
    """
    for axle, side, value in (
        ("f", "front", calibration.pad_friction_f.value),
        ("r", "rear", calibration.pad_friction_r.value),
    ):
        low, high = (bound * _of_file(vehicle, side) for bound in PLAUSIBLE.pads_of_file)
        if not low <= value <= high:
            yield PlausibilityWarning(
                f"pads_off_file_{axle}",
                vehicle.name,
                value,
                (low, high),
                _LEVEL_CAUSES,
                "correct what is wrong, or write the friction of these pads into the vehicle file",
            )
    rho = calibration.pad_log_ratio
    usual, known = max(PLAUSIBLE.pad_ratio, Z95 * rho.sigma), stated.value if stated else 0.0
    if abs(rho.value - known) > usual:
        yield warning(
            "pad_ratio",
            vehicle.name,
            math.expm1(rho.value),
            (math.expm1(known - usual), math.expm1(known + usual)),
        )
    stiffness = math.exp(-posterior.value("log_compliance"))
    margin = math.exp(posterior.sigma("log_compliance"))
    if not PLAUSIBLE.stiffness[0] / margin <= stiffness <= PLAUSIBLE.stiffness[1] * margin:
        yield warning("tyre_stiffness", vehicle.name, stiffness, PLAUSIBLE.stiffness)


def level_warnings(log: str, level: float, sigma: float) -> Iterator[PlausibilityWarning]:
    """Brakes that are not those of the ramp, as another load or a wrong sensor makes them seem.

    ``level`` ln of the brake force over that of the ramp's pads, with its ``sigma``.
    """
    usual = max(PLAUSIBLE.pad_level, Z95 * sigma)
    if usual < abs(level) < PLAUSIBLE.loaded:
        yield PlausibilityWarning(
            "level_changed",
            log,
            math.expm1(level),
            (math.expm1(-usual), math.expm1(usual)),
            (
                "more load than on the ramp" if level < 0.0 else "less load than on the ramp",
                "the scale or the zero of p_mc or a_x, in one of the runs",
                *(
                    ("a motor that brakes along and was not there on the ramp",)
                    if level > 0.0
                    else ()
                ),
                "pads that were wet or hot in one of the runs",
            ),
            "weigh the car and state its mass with --mass; check p_mc and a_x; if all of this is "
            "right and the pads were warm and dry in both runs, they have changed",
        )


def change_warnings(
    log: str, apart: float, sigma: float, *, like_a_load: bool = False
) -> Iterator[PlausibilityWarning]:
    """Pads that changed unlike: what eta and slip cannot tell from tyres or a motor.

    ``apart`` ln of the front pads' change over that of the rear ones, with its ``sigma``;
    ``like_a_load`` whether front and rear changed as a load makes them seem.
    """
    load = ("another load of the car than on the ramp",)
    if abs(apart) > PLAUSIBLE.pads_apart and abs(apart) > Z95 * sigma:
        yield PlausibilityWarning(
            "pads_changed_apart",
            log,
            math.expm1(apart),
            (-PLAUSIBLE.pads_apart, PLAUSIBLE.pads_apart),
            (
                *(load if like_a_load else ()),
                "the pads or the tyres of one axle (wet, hot, new or changed since the ramp)",
                "rear brakes that do not get all of the pressure"
                if apart > 0.0
                else "a motor or an engine that brakes the rear axle",
                *(("a motor that brakes the front axle",) if apart > 0.0 else ()),
                *(() if like_a_load else load),
                *(() if apart > 0.0 else ("front and rear wheel speeds that are swapped",)),
            ),
            "state another load with --mass; drive a new ramp if tyres or brakes were changed; log "
            "wheel pressures and T_drive",
        )
