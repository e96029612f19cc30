"""Whether a vehicle can be a car: figures that follow from the file, each with its usual range.

A file can be valid and still describe no car: the area of both sides of a caliper, a height above
the axles, front and rear swapped. Every figure outside its range is a warning with the likely
causes. A mistake within what cars differ by, as a mass that is 10 % wrong, is not seen. What only
some cars have is for a person to confirm.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from calib.base.plain import bound
from calib.base.units import from_si
from calib.base.warning import PlausibilityWarning
from calib.car.bias import front_share, lock_efficiency, pressure_per_g
from calib.car.forces import front_biased_up_to
from calib.car.keys import CHASSIS, KEYS
from calib.car.vehicle import Axle, Vehicle

_GOOD_ROAD = 0.8
"""Friction [1] of a road on which the efficiency of the brakes is judged: dry asphalt, used up to
what passenger tyres hold for certain."""

LEAST_FRONT_BIASED = bound("front_biased_up_to", "low")
"""Deceleration [g] up to which the front axle must lock first, by the file here and by the pads of
the car at the station. Cars with control of the rear pressure (EBD) have 0.4 or more by design, of
which pads that scatter by 3 % between the axles take up to 0.1 in one car of a thousand."""

_UNCONTROLLED = bound("front_biased_up_to", "warn_low")
"""What cars without that control have at least [g]."""

_FRONT_ENGINE = 0.46
"""Front share of the load at rest [1] below which a car has its engine at the rear, or carries."""


@dataclass(frozen=True)
class _Figure:
    """A figure of a vehicle in the unit of its ``code``, with its usual ``low`` to ``high``.

    ``too_low`` and ``too_high`` are the likely causes, the most likely first; ``do`` what to do.
    """

    code: str
    of: Callable[[Vehicle], float]
    low: float
    high: float | None
    too_low: tuple[str, ...]
    too_high: tuple[str, ...]
    do: str


_AREA = ("one piston of several", "another unit", "a master cylinder for a caliper")
_AREAS = ("the pistons of both sides of a fixed caliper", "the area of the pad", "another unit")

_CAUSES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "mass": (
        ("the load of one axle or one wheel", "an empty car"),
        ("pounds written as kg",),
    ),
    "cg_height": (
        ("a height above the axles instead of the road", "another unit"),
        ("the height of the roof", "another unit"),
    ),
    "track_width": (("half of the track",), ("the width of the car over its mirrors",)),
    "rolling_radius": (("the radius of the rim", "another unit"), ("the diameter of the wheel",)),
    "piston_area": (_AREA, _AREAS),
    "effective_radius": (("another unit",), ("the diameter of the disc",)),
    "friction_faces": (
        ("one face counted of two: a disc has a pad on either side",),
        ("the pads of both wheels of an axle",),
    ),
    "pad_friction": (("another unit",), ("a friction of the tyre", "a percentage")),
}
"""Likely causes where a key of the file is below and above its usual range."""

_TWICE = (
    "piston_area of both sides of a fixed caliper, or of both wheels of an axle",
    "effective_radius is a diameter",
    "the mass of one axle",
)
_HALF = (
    "friction_faces is 1 instead of 2",
    "piston_area of one piston of several",
    "the mass in pounds written as kg",
)
_SWAPPED_CG = ("cg_to_front_axle and cg_to_rear_axle are swapped", "distances from the bumper")
_SWAPPED_BRAKES = ("[front] and [rear] are swapped",)
_WHEEL = ("another unit", "wheel_inertia of both wheels of an axle, or without tyre or disc")


def _of_axles(
    code: str, of: Callable[[Axle], float], low: float, high: float,
    too_low: tuple[str, ...], too_high: tuple[str, ...], do: str,
) -> tuple[_Figure, _Figure]:  # fmt: skip
    return (
        _Figure(f"{code}_f", lambda car: of(car.front), low, high, too_low, too_high, do),
        _Figure(f"{code}_r", lambda car: of(car.rear), low, high, too_low, too_high, do),
    )


_FIGURES: tuple[_Figure, ...] = (
    _Figure(
        "wheelbase", lambda car: car.wheelbase, 1.7, 4.7,
        ("distances from another point than the axles",),
        ("the wheelbase written for one of the two distances",),
        "cg_to_front_axle and cg_to_rear_axle add up to the wheelbase",
    ),
    _Figure(
        "static_load_f", lambda car: car.static_loads[0] / car.weight, 0.36, 0.68,
        (*_SWAPPED_CG, "the wheelbase written for cg_to_front_axle"),
        (*_SWAPPED_CG, "the wheelbase written for cg_to_rear_axle"),
        "weigh both axles: front share = cg_to_rear_axle / wheelbase",
    ),
    _Figure(
        "cg_height_ratio", lambda car: car.cg_height / car.wheelbase, 0.13, 0.32,
        ("cg_height above the axles instead of the road",),
        ("cg_height is the height of the roof",),
        "measure cg_height from the road",
    ),
    _Figure(
        "track_ratio", lambda car: car.track_width / car.wheelbase, 0.40, 0.78,
        ("half of the track",), ("the wheelbase is too short",), "look at track_width",
    ),
    *_of_axles(
        "wheel_mass", lambda axle: axle.wheel_mass, 5.0, 32.0,
        _WHEEL, _WHEEL, "wheel_inertia is about 0.6 x mass of wheel and tyre x R^2",
    ),
    _Figure(
        "rotating_share",
        lambda car: 2.0 * (car.front.wheel_mass + car.rear.wheel_mass) / car.mass, 0.015, 0.055,
        ("the mass in pounds written as kg", *_WHEEL),
        ("wheel_inertia of both wheels of an axle", "the mass of one axle", "another unit"),
        "wheel_inertia is that of one wheel, about its axis",
    ),
    _Figure(
        "radius_ratio", lambda car: car.front.rolling_radius / car.rear.rolling_radius, 0.9, 1.1,
        ("a front radius in another unit or of the rim",),
        ("a rear radius in another unit or of the rim",), "measure both rolling radii alike",
    ),
    *_of_axles(
        "disc_ratio", lambda axle: axle.effective_radius / axle.rolling_radius, 0.27, 0.54,
        ("a radius in another unit",), ("the diameter of the disc",), "look at effective_radius",
    ),
    _Figure(
        "pressure_per_g", lambda car: from_si(pressure_per_g(car), "bar", "Pa"), 38.0, 120.0,
        _TWICE, _HALF,
        "compare with a stop: pressure over deceleration in g, without booster or motor",
    ),
    _Figure(
        "brake_share_f", front_share, 0.56, 0.90,
        (*_SWAPPED_BRAKES, "piston_area of both sides at the rear only", "friction_faces"),
        ("piston_area of both sides at the front only", "friction_faces of the rear is 1"),
        "compare piston_area, effective_radius and friction_faces of front and rear",
    ),
    _Figure(
        "front_biased_up_to", front_biased_up_to, LEAST_FRONT_BIASED, None,
        (*_SWAPPED_BRAKES, "piston_area of both sides at the rear only", *_SWAPPED_CG[:1]), (),
        "beyond it the rear axle locks first; `brake-cal station` fails such a car",
    ),
    _Figure(
        "lock_efficiency", lambda car: lock_efficiency(car, _GOOD_ROAD), 0.78, 1.0,
        (*_SWAPPED_CG[:1], *_SWAPPED_BRAKES, "piston_area of both sides on one axle only"), (),
        "compare the brakes of both axles and the distances to the centre of gravity",
    ),
)  # fmt: skip
"""The figures with their ranges: what cars from a microcar to a laden van have, and some room. How
many good cars and mistakes have a warning: tests/studies/results/vehicle_mistakes.md."""


_OF_KEYS = tuple(
    _Figure(
        key.name if key.section == CHASSIS else f"{key.name}_{key.section[0]}",
        key.value_of, key.low, key.high, *_CAUSES[key.name], f"look at {key.path}",
    )
    for key in KEYS
    if key.name in _CAUSES
)  # fmt: skip


def plausible(vehicle: Vehicle) -> tuple[PlausibilityWarning, ...]:
    """Warnings on what no usual car or van has; the values of the file first."""
    return tuple(_judged(vehicle))


def _judged(vehicle: Vehicle) -> Iterator[PlausibilityWarning]:
    for figure in (*_OF_KEYS, *_FIGURES):
        measured, ends = figure.of(vehicle), (figure.low, figure.high)
        if not figure.low <= measured <= (figure.high or measured):
            causes = figure.too_low if measured < figure.low else figure.too_high
            yield PlausibilityWarning(figure.code, vehicle.name, measured, ends, causes, figure.do)


def to_confirm(vehicle: Vehicle) -> tuple[str, ...]:
    """What is usual for some cars only, as sentences; a mistake for all others."""
    share, biased = vehicle.static_loads[0] / vehicle.weight, front_biased_up_to(vehicle)
    found = []
    if share < _FRONT_ENGINE:
        found.append(
            f"{100 * share:.0f} % of the load is on the front axle, as with the engine at the rear "
            "or in a laden van; in any other car cg_to_front_axle and cg_to_rear_axle are swapped"
        )
    if LEAST_FRONT_BIASED <= biased < _UNCONTROLLED:
        found.append(
            f"the rear axle locks first beyond {biased:.2f} g, as in cars that control the rear "
            "pressure (EBD); in any other car the brakes or the load are not those of the file. "
            f"`brake-cal station` fails a car below {LEAST_FRONT_BIASED:g} g"
        )
    return tuple(found)
