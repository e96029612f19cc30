"""Tables I and II of the paper as a frozen record, and the mass of the car in a log.

Wheel values are per wheel. ``friction_faces`` counts the pad faces of one caliper (two for a disc
brake): (2) of the paper is for one face.
"""

from dataclasses import asdict, dataclass, field, replace
from typing import Self

from calib.base.errors import VehicleError
from calib.base.intervals import Z95
from calib.base.names import G
from calib.car.effects.effects import Effects


@dataclass(frozen=True)
class Axle:
    """One axle of Table I; every value is for one wheel.

    Attributes
    ----------
    rolling_radius : R [m], effective, unbraked.
    wheel_inertia : J_w [kg m^2], about the wheel axis. Not in the paper.
    piston_area : A [m^2], all pistons that press one pad.
    effective_radius : r [m], of the disc.
    friction_faces : pad faces of one brake [1].
    pad_friction : mu_p,n [1], nominal.
    pad_friction_tolerance : standard deviation of its relative error [1], None by default.
    """

    rolling_radius: float
    wheel_inertia: float
    piston_area: float
    effective_radius: float
    friction_faces: int
    pad_friction: float
    pad_friction_tolerance: float | None = None

    @property
    def torque_gain(self) -> float:
        """C of (3) for one wheel [m^3]: faces * A * r, so that T_b = mu_p C P."""
        return self.friction_faces * self.piston_area * self.effective_radius

    @property
    def wheel_mass(self) -> float:
        """The mass [kg] that has the moment of inertia of the wheel at its rolling radius."""
        return self.wheel_inertia / self.rolling_radius**2

    def with_radius(self, factor: float) -> Self:
        """The axle with its rolling radius times ``factor`` [1]."""
        return replace(self, rolling_radius=self.rolling_radius * factor)


NOT_OF_THE_CAR = (
    *("mass_tolerance", "motor_odds"),
    *("front.pad_friction_tolerance", "rear.pad_friction_tolerance"),
)
"""Fields of a `Vehicle` that are uncertainties: the same car may have other values."""


@dataclass(frozen=True)
class Vehicle:
    """Table II of the paper, both axles, and the known effects.

    Attributes
    ----------
    name : also the name of the tables fitted for it.
    mass : M_v [kg], as driven.
    cg_to_front_axle, cg_to_rear_axle : l_f, l_r [m].
    cg_height : h [m].
    track_width : l_w [m].
    front, rear : the axles.
    mass_tolerance : standard deviation of the relative error of the mass [1].
    motor_odds : prior odds that a motor or an engine brakes with the pedal and is not logged [1].
        Half of the new cars of 2023 have a motor that brakes (ACEA, new car registrations,
        European Union), and most tests log it or switch it off.
    effects : known effects in addition to the paper's model.
    """

    name: str
    mass: float
    cg_to_front_axle: float
    cg_to_rear_axle: float
    cg_height: float
    track_width: float
    front: Axle
    rear: Axle
    mass_tolerance: float = 0.03
    motor_odds: float = 0.1
    effects: Effects = field(default_factory=Effects)

    @property
    def wheelbase(self) -> float:
        """L = l_f + l_r [m]."""
        return self.cg_to_front_axle + self.cg_to_rear_axle

    @property
    def weight(self) -> float:
        """M_v g [N]."""
        return self.mass * G

    def with_radii(self, factor: float) -> Self:
        """The car with the rolling radii of both axles times ``factor`` [1]."""
        return replace(
            self, front=self.front.with_radius(factor), rear=self.rear.with_radius(factor)
        )

    def with_pads(self, front: float, rear: float) -> Self:
        """The car with other pads, of these frictions [1]."""
        front_axle = replace(self.front, pad_friction=front)
        return replace(self, front=front_axle, rear=replace(self.rear, pad_friction=rear))

    def radius_mismatch(self, eta_zero: float) -> float:
        """Mismatch of the axles' radii over that of the file [1], from eta - 1 without brakes."""
        return (1.0 + eta_zero) * self.rear.rolling_radius / self.front.rolling_radius - 1.0

    @property
    def static_loads(self) -> tuple[float, float]:
        """Loads of the front and the rear axle at rest [N], (6) and (7)."""
        share = self.weight / self.wheelbase
        return share * self.cg_to_rear_axle, share * self.cg_to_front_axle


def require_same_car(
    car: Vehicle, other: Vehicle, where: object = None, *, weighed: bool = False
) -> None:
    """Raise VehicleError if ``other`` differs from a table's ``car`` in more than pads and effects.

    ``where`` names its file. The mass may differ where it was ``weighed``.
    """
    free = {*NOT_OF_THE_CAR, "front.pad_friction", "rear.pad_friction", *["mass"] * weighed}
    theirs = _numbers(other)
    differ = [
        f"{key} {theirs[key]:.6g} for {x:.6g}"
        for key, x in _numbers(car).items()
        if key not in free and theirs[key] != x
    ]
    if differ:
        raise VehicleError(
            f"the table was fitted for another car: {', '.join(differ[:4])}",
            where=other.name if where is None else where,
            expected="a vehicle with other pads only",
            do="fit a table for this car",
        )


def _numbers(car: Vehicle) -> dict[str, float]:
    parts = asdict(car)
    axles = {f"{end}.{k}": x for end in ("front", "rear") for k, x in parts[end].items()}
    return {**{k: x for k, x in parts.items() if isinstance(x, float)}, **axles}


_SHARES = (0.5, 2.0)
"""Bounds of a stated mass over that of the file [1]: an empty van against a laden one. Beyond them
it is another car, or in pounds, or the load moves the centre of gravity."""

WEIGHED = 0.005
"""Standard deviation of a stated mass, relative [1]: a scale for cars and fuel burnt since."""


@dataclass(frozen=True)
class MassUsed:
    """The mass in a result.

    ``value`` [kg]; ``tolerance`` its relative standard deviation [1]; ``stated`` for these logs,
    instead of taken from the vehicle file; ``share`` it is of that one [1].
    """

    value: float
    tolerance: float
    stated: bool
    share: float = 1.0

    def __str__(self) -> str:
        mass = f"{self.value:.6g} kg ±{100.0 * Z95 * self.tolerance:.2g} % (95 %)"
        if self.stated:
            more = self.share - 1.0
            side = "above" if more > 0.0 else "below"
            beside = f": {100.0 * abs(more):.2g} % {side} the vehicle file"
            return f"{mass}, as stated for these logs{beside * (abs(more) > WEIGHED)}"
        if self.tolerance < Vehicle.mass_tolerance:
            return f"{mass} by the vehicle file"
        return f"{mass}: the load was not stated; give --mass, or mass_tolerance in the file"


def weighed(vehicle: Vehicle, mass: float | None) -> Vehicle:
    """Return the vehicle with a stated ``mass`` [kg]; as it is where none was stated.

    All loads grow with it and the centre of gravity stays, which is wrong for a load high up or far
    behind. The effect ``mass_error`` is dropped. The tolerance is `WEIGHED`, or that of the file
    where it is smaller. Raises VehicleError for a mass outside of `_SHARES`.
    """
    if mass is None:
        return vehicle
    share = mass / vehicle.mass
    if not _SHARES[0] <= share <= _SHARES[1]:
        raise VehicleError(
            f"a stated mass of {mass:.5g} kg is {share:.2f} times the {vehicle.mass:.5g} kg of the "
            "vehicle file",
            where=vehicle.name,
            expected=f"{_SHARES[0]:g} to {_SHARES[1]:g} times",
            do="check number and unit of the mass; a car with such a load has its own vehicle file",
        )
    return replace(
        vehicle,
        mass=mass,
        mass_tolerance=min(vehicle.mass_tolerance, WEIGHED),
        effects=vehicle.effects.without("mass_error"),
    )


def mass_used(vehicle: Vehicle, mass: float | None) -> MassUsed:
    """The mass that `weighed` gives, for a report."""
    car = weighed(vehicle, mass)
    return MassUsed(car.mass, car.mass_tolerance, mass is not None, car.mass / vehicle.mass)
