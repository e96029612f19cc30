"""Warnings about a vehicle file with values that no usual car has.

`keys.csv` has the usual ranges of the values in the file, `figures.csv` those of figures that
follow from them, such as the pressure per g. The ranges include cars from a microcar to a laden
van, so a mass that is 10 % wrong gives no warning (tests/studies/results/vehicle_mistakes.md).
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from calib.base.plain import finite_or_none, limit_of, rows, texts_of
from calib.base.units import from_si
from calib.base.warning import PlausibilityWarning
from calib.car.balance import front_biased_up_to, front_share, lock_efficiency, pressure_per_g
from calib.car.keys import CHASSIS, KEYS, VehicleKey
from calib.car.vehicle import Vehicle

_GOOD_ROAD = 0.8  # friction [1] that dry asphalt always has, for `lock_efficiency`

LEAST_FRONT_BIASED = limit_of("front_biased_up_to", "low")
"""Deceleration [g] up to which the front axle must lock first.

Cars that control the rear pressure (EBD) have 0.4 or more by design. Pads that scatter by 3 %
between the axles lower this deceleration by as much as 0.1 g in one car of a thousand."""

_FIGURE_OF: dict[str, Callable[[Vehicle], float]] = {
    "wheelbase": lambda car: car.wheelbase,
    "static_load_f": lambda car: car.static_loads[0] / car.weight,
    "cg_height_ratio": lambda car: car.cg_height / car.wheelbase,
    "track_ratio": lambda car: car.track_width / car.wheelbase,
    "wheel_mass_f": lambda car: car.front.wheel_mass,
    "wheel_mass_r": lambda car: car.rear.wheel_mass,
    "rotating_share": lambda car: 2.0 * (car.front.wheel_mass + car.rear.wheel_mass) / car.mass,
    "radius_ratio": lambda car: car.front.rolling_radius / car.rear.rolling_radius,
    "disc_ratio_f": lambda car: car.front.effective_radius / car.front.rolling_radius,
    "disc_ratio_r": lambda car: car.rear.effective_radius / car.rear.rolling_radius,
    "pressure_per_g": lambda car: from_si(pressure_per_g(car), "bar", "Pa"),
    "brake_share_f": lambda car: front_share(car, 0.0),
    "front_biased_up_to": front_biased_up_to,
    "lock_efficiency": lambda car: lock_efficiency(car, _GOOD_ROAD),
}
"""Functions for the figures of `figures.csv` by code, in the units of `calib.base.warning`."""


class _Figure(NamedTuple):
    """A figure of a car with its usual range."""

    code: str  # of the warning
    value_of: Callable[[Vehicle], float]
    low: float  # usual range, in the unit of the figure
    high: float
    too_low: tuple[str, ...]  # likely causes of a value outside the range
    too_high: tuple[str, ...]
    do: str  # remedy


def _figure_of_key(key: VehicleKey) -> _Figure:
    code = key.name if key.section == CHASSIS else f"{key.name}_{key.section[0]}"
    causes = key.too_low, key.too_high
    return _Figure(code, key.value_of, key.low, key.high, *causes, f"look at {key.path}")


def _figure_of_row(row: dict[str, str]) -> _Figure:
    code, causes = row["code"], (texts_of(row["too_low"]), texts_of(row["too_high"]))
    # a row without a lower bound has that of the station
    low = float(row["low"] or limit_of(code, "low"))
    high = float(row["high"] or math.inf)
    return _Figure(code, _FIGURE_OF[code], low, high, *causes, row["do"])


_FIGURES = (
    *(_figure_of_key(key) for key in KEYS if key.too_low),  # keys with causes are judged
    *map(_figure_of_row, rows("figures.csv", "calib.car")),
)


def vehicle_warnings(vehicle: Vehicle) -> tuple[PlausibilityWarning, ...]:
    """Return a warning for each figure outside its usual range, the values of the file first."""
    warnings = []
    for code, value_of, low, high, too_low, too_high, do in _FIGURES:
        value = value_of(vehicle)
        if not low <= value <= high:
            expected = (low, finite_or_none(high))
            causes = too_low if value < low else too_high
            warnings.append(PlausibilityWarning(code, vehicle.name, value, expected, causes, do))
    return tuple(warnings)
