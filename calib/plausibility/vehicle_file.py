"""A vehicle file that a run contradicts, and the entry of it that is most likely wrong.

A run gives the torque of each axle over its pressure: the sum well, how it is split faintly. With
the file it makes pads, a in front and b behind (logarithms, over the file's). An entry that is
wrong moves the sum S = ln(s e^a + (1 - s) e^b), s the front share by the file, and the ratio a - b:

    what is wrong                      S                          a - b
    a brake entry of the front axle    ln(1 + s (e^t - 1))         t
    a brake entry of the rear axle     ln(1 + (1 - s) (e^t - 1))  -t
    mass, or both axles alike          t                           0
    [front] and [rear] exchanged       0                           2 ln((1 - s)/s)

The one that leaves least of both, in the scatter of pads and of the fit, explains it best.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import VehicleError
from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning
from calib.car.keys import CHASSIS, FRONT, KEYS, REAR, VehicleKey
from calib.car.vehicle import Axle, Vehicle
from calib.plausibility.limits import PLAUSIBLE
from calib.table.table import Calibration

Array = NDArray[np.float64]

PARTS = ("piston_area", "effective_radius", "friction_faces", "pad_friction")
"""Entries of an axle that its torque over the pressure is proportional to; the likeliest first."""

FACTORS = np.linspace(-2.5, 2.5, 501)
"""Logarithms of the factors by which an entry may be wrong [1]: from a twelfth to twelve."""

NEAR = 9.0
"""Chi-square that an explanation may leave over the best one, and still be told: three sigma."""


@dataclass(frozen=True)
class Explanation:
    """What may be wrong in the file, in words; ``left`` [1]: chi-square that it does not explain.

    ``usual`` whether cars have the value that would be right.
    """

    what: str
    left: float
    usual: bool


def require_file_of_run(
    vehicle: Vehicle,
    calibration: Calibration,
    warnings: tuple[PlausibilityWarning, ...],
) -> None:
    """Raise VehicleError for a ratio of the pads that no two pads have, with what explains it.

    The interval of the ratio counts. ``warnings`` on the file and the logs are told beside it.
    """
    rho = calibration.pad_log_ratio
    if abs(rho.value) - Z95 * rho.sigma <= PLAUSIBLE.ratio_possible:
        return
    best, *others = explanations(vehicle, calibration)
    near = [one.what for one in others if one.usual and one.left < best.left + NEAR][:3]
    following = f"next {', or '.join(near)}; " if near else ""
    raise VehicleError(
        f"the pads come out at {calibration.pad_friction_f.value:.3g} in front and "
        f"{calibration.pad_friction_r.value:.3g} behind, and the file has "
        f"{vehicle.front.pad_friction:g} and {vehicle.rear.pad_friction:g}: it is not that of the "
        f"car of these logs; most likely {best.what}",
        where=vehicle.name,
        expected="pads of one car, whose ratio differs from the file's by less than "
        f"{100 * math.expm1(PLAUSIBLE.ratio_possible):.0f} %",
        do=f"{following}if the file is right, look for a motor that brakes one axle, or wheel "
        "speeds in the wrong columns",
        lines=tuple(map(str, warnings)),
    )


def explanations(vehicle: Vehicle, calibration: Calibration) -> list[Explanation]:
    """What alone may be wrong, the likeliest first."""
    rho = calibration.pad_log_ratio
    share = _torque(vehicle.front) / (_torque(vehicle.front) + _torque(vehicle.rear))
    strong_f = calibration.pad_friction_f.value / vehicle.front.pad_friction
    strong_r = calibration.pad_friction_r.value / vehicle.rear.pad_friction
    found = (math.log(share * strong_f + (1.0 - share) * strong_r), rho.value)
    sigma = (PLAUSIBLE.pads_scatter, math.hypot(rho.sigma, PLAUSIBLE.ratio_drawn * rho.value))

    def left(summed: Array | float, apart: Array | float) -> Array:
        return np.asarray(
            ((found[0] - summed) / sigma[0]) ** 2 + ((found[1] - apart) / sigma[1]) ** 2
        )

    exchanged = float(left(0.0, 2.0 * math.log((1.0 - share) / share)))
    told = [Explanation("[front] and [rear] are exchanged", exchanged, True)]
    alone = {
        FRONT: left(np.log1p(share * np.expm1(FACTORS)), FACTORS),
        REAR: left(np.log1p((1.0 - share) * np.expm1(FACTORS)), -FACTORS),
        CHASSIS: left(FACTORS, 0.0),
    }
    for section, missed in alone.items():
        best = int(np.argmin(missed))
        told += [
            Explanation(what, float(missed[best]), usual)
            for what, usual in _entries(vehicle, section, float(FACTORS[best]))
        ]
    return sorted(told, key=lambda one: (not one.usual, one.left))


def _torque(axle: Axle) -> float:
    """Brake force of an axle over its pressure [m^2], by the file."""
    return axle.torque_gain * axle.pad_friction / axle.rolling_radius


def _entries(vehicle: Vehicle, section: str, t: float) -> Iterator[tuple[str, bool]]:
    """The entries of a section with the value that would explain ``t``, and whether it is usual."""
    names = ("mass",) if section == CHASSIS else PARTS
    keys = {key.name: key for key in KEYS if key.section == section}
    for key in (keys[name] for name in names):
        written = key.value_of(vehicle)
        # too much mass makes strong pads, too much area weak ones
        right = written * math.exp(-t if key.name == "mass" else t)
        whole = key.name != "friction_faces" or abs(right - round(right)) < 0.1
        what = f"{key.path}: {_with_unit(right, key)} instead of {_with_unit(written, key)}"
        yield what, key.low <= right <= key.high and whole


def _with_unit(value: float, key: VehicleKey) -> str:
    return f"{value:.4g}" + ("" if key.unit == "1" else f" {key.unit}")
