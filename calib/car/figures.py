"""Figures that follow from a vehicle file, and warnings where no usual car has them.

A figure outside its range is a warning with the likely causes. The ranges of `figures.csv` and
`keys.csv` hold cars from a microcar to a laden van, with some margin
(tests/studies/results/vehicle_mistakes.md), so a mass that is 10 % wrong goes unseen.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from calib.base.names import G
from calib.base.plain import bound, finite, listed, rows
from calib.base.units import BAR, from_si
from calib.base.warning import PlausibilityWarning
from calib.car.balance import (
    force_per_pressure,
    friction_used,
    front_biased_up_to,
    front_share,
    ideal_front_share,
    lock_efficiency,
    pressure_per_g,
)
from calib.car.forces import axle_loads
from calib.car.keys import CHASSIS, KEYS, VehicleKey
from calib.car.vehicle import Axle, Vehicle

_GOOD_ROAD = 0.8
"""Friction [1] at which the efficiency of the brakes is judged: surely available on dry asphalt."""

LEAST_FRONT_BIASED = bound("front_biased_up_to", "low")
"""Deceleration [g] up to which the front axle must lock first, by the file or by a station's pads.

Cars that control the rear pressure (EBD) have 0.4 or more by design. Pads that scatter by 3 %
between the axles take up to 0.1 of it in one car of a thousand."""

_UNCONTROLLED = bound("front_biased_up_to", "warn_low")
"""Least value of cars without that control [g]."""

_FRONT_ENGINE = 0.46
"""Front share of the load at rest [1], below which the engine or a load is at the rear."""

_OF: dict[str, Callable[[Vehicle], float]] = {
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
"""The figures of `figures.csv`, each in the unit of its code."""


_Figure = tuple[
    str, Callable[[Vehicle], float], float, float, tuple[str, ...], tuple[str, ...], str
]
"""Code of a figure, its value in the unit of the code, usual range, likely causes below and above
it, and what to do."""


def _of_key(key: VehicleKey) -> _Figure:
    code = key.name if key.section == CHASSIS else f"{key.name}_{key.section[0]}"
    do = f"look at {key.path}"
    return code, key.value_of, key.low, key.high, key.too_low, key.too_high, do


def _of_row(row: dict[str, str]) -> _Figure:
    """An empty lowest value takes the station's limit, an empty highest one is none."""
    low, high = float(row["low"] or bound(row["code"], "low")), float(row["high"] or math.inf)
    code, too_low, too_high = row["code"], listed(row["too_low"]), listed(row["too_high"])
    return code, _OF[code], low, high, too_low, too_high, row["do"]


_FIGURES = (
    *(_of_key(key) for key in KEYS if key.too_low),
    *map(_of_row, rows("figures.csv", "calib.car")),
)


def plausible(vehicle: Vehicle) -> tuple[PlausibilityWarning, ...]:
    """Warnings of figures that no usual car or van has; the values of the file first."""
    warnings = []
    for code, figure, low, high, too_low, too_high, do in _FIGURES:
        measured, ends = figure(vehicle), (low, high if high < math.inf else None)
        if not low <= measured <= high:
            causes = too_low if measured < low else too_high
            warnings.append(PlausibilityWarning(code, vehicle.name, measured, ends, causes, do))
    return tuple(warnings)


def to_confirm(vehicle: Vehicle) -> tuple[str, ...]:
    """Sentences about figures that are right for some cars only."""
    share, biased = vehicle.static_loads[0] / vehicle.weight, front_biased_up_to(vehicle)
    sentences = []
    if share < _FRONT_ENGINE:
        sentences.append(
            f"{100 * share:.0f} % of the load is on the front axle, as with the engine at the rear "
            "or in a laden van; in any other car cg_to_front_axle and cg_to_rear_axle are swapped"
        )
    if LEAST_FRONT_BIASED <= biased < _UNCONTROLLED:
        sentences.append(
            f"the rear axle locks first beyond {biased:.2f} g, as in cars that control the rear "
            "pressure (EBD); in any other car the brakes or the load are not those of the file. "
            f"`brake-cal station` fails a car below {LEAST_FRONT_BIASED:g} g"
        )
    return tuple(sentences)


_DECELERATIONS = tuple(k / 10.0 for k in range(1, 11))
"""Rows of the distribution [g]."""


@dataclass(frozen=True)
class _AxleFacts:
    """One axle; loads of the axle in kg of mass that it carries.

    ``torque_per_bar_wheel``, ``torque_per_bar_axle`` [N m/bar] with nominal pads;
    ``static_load`` at rest and ``load_at_half_g`` at 0.5 g [kg]; ``wheel_mass`` mass at the rolling
    radius that has the wheel's moment of inertia [kg].
    """

    torque_per_bar_wheel: float
    torque_per_bar_axle: float
    static_load: float
    load_at_half_g: float
    wheel_mass: float


@dataclass(frozen=True)
class _Braking:
    """One deceleration.

    ``deceleration`` [g]; ``pressure`` [bar]; ``front_share`` of the brake force and
    ``ideal_front_share``, at which both axles use the same friction [1]; ``friction_f``,
    ``friction_r`` used by the axles [1], null where the axle has no load; ``torque_f``,
    ``torque_r`` of the axles [N m].
    """

    deceleration: float
    pressure: float
    front_share: float
    ideal_front_share: float
    friction_f: float | None
    friction_r: float | None
    torque_f: float
    torque_r: float


@dataclass(frozen=True)
class _VehicleFacts:
    """What follows from a vehicle file with its nominal pads, without drag.

    ``wheelbase`` [m]; ``pressure_per_g`` [bar]; ``front_share`` of the brake force [1];
    ``front_biased_up_to`` deceleration up to which the front axle locks first [g], null if at all;
    ``rear_lifts_at`` deceleration [g] at which the rear axle has no load.
    """

    wheelbase: float
    pressure_per_g: float
    front_share: float
    front_biased_up_to: float | None
    rear_lifts_at: float
    front: _AxleFacts
    rear: _AxleFacts
    distribution: tuple[_Braking, ...]


def what_follows(vehicle: Vehicle) -> _VehicleFacts:
    """Return the facts of a vehicle; the inertia of the wheels is neglected, as in (9).

    >>> import calib
    >>> facts = what_follows(calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml"))
    >>> round(facts.pressure_per_g, 1), round(facts.front_share, 3)  # bar, 1
    (69.9, 0.729)
    """
    z = np.array(_DECELERATIONS)
    pressure, share = z * pressure_per_g(vehicle), front_share(vehicle, 0.0)
    axles = (vehicle.front, vehicle.rear)
    torques = (
        force * axle.rolling_radius * pressure
        for force, axle in zip(force_per_pressure(vehicle), axles, strict=True)
    )
    shares = (np.full_like(z, share), ideal_front_share(vehicle, z), *friction_used(vehicle, z))
    columns = (z, pressure / BAR, *shares, *torques)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    half = (float(load[0]) for load in axle_loads(vehicle, np.array([0.5])))
    front, rear = map(_axle, axles, vehicle.static_loads, half)
    return _VehicleFacts(
        wheelbase=vehicle.wheelbase,
        pressure_per_g=pressure_per_g(vehicle) / BAR,
        front_share=share,
        front_biased_up_to=finite(front_biased_up_to(vehicle)),
        rear_lifts_at=vehicle.cg_to_front_axle / vehicle.cg_height,
        front=front,
        rear=rear,
        distribution=tuple(_Braking(*r[:4], *map(finite, r[4:6]), *r[6:]) for r in rows),
    )


def _axle(axle: Axle, static: float, half: float) -> _AxleFacts:
    per_bar = axle.pad_friction * axle.torque_gain * BAR  # (2), (3)
    return _AxleFacts(per_bar, 2.0 * per_bar, static / G, half / G, axle.wheel_mass)
