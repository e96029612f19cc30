"""A vehicle: the values of Tables I and II of the paper, and the known effects.

Numbers in parentheses are equations of the paper. Its (2) is for one of the two pad faces of a disc
brake; `Axle.friction_faces` counts them.
"""

from dataclasses import asdict, dataclass, field, replace
from typing import Self

from calib.base.errors import VehicleError
from calib.base.names import G
from calib.car.effects.effects import Effects


@dataclass(frozen=True)
class Axle:
    """One axle of Table I; every value is for one wheel."""

    rolling_radius: float  # R [m], effective, unbraked
    wheel_inertia: float  # J_w [kg m^2], about the wheel axis; not in the paper
    piston_area: float  # A [m^2], all pistons that press one pad
    effective_radius: float  # r [m], of the disc
    friction_faces: int  # pad faces of one brake [1], 2 for a disc brake
    pad_friction: float  # mu_p,n [1], nominal
    pad_friction_tolerance: float | None = None  # relative standard deviation [1]; None: not known

    @property
    def torque_gain(self) -> float:
        """C of (3) for one wheel [m^3]: faces * A * r, so that T_b = mu_p C P."""
        return self.friction_faces * self.piston_area * self.effective_radius

    @property
    def wheel_mass(self) -> float:
        """J_w/R^2 [kg]: the mass that resists like the turning wheel."""
        return self.wheel_inertia / self.rolling_radius**2

    def with_radius(self, factor: float) -> Self:
        """Return the axle with its rolling radius multiplied by ``factor`` [1]."""
        return replace(self, rolling_radius=self.rolling_radius * factor)


UNCERTAINTIES = (
    "mass_tolerance",
    "motor_odds",
    "front.pad_friction_tolerance",
    "rear.pad_friction_tolerance",
)
"""Fields of a `Vehicle` that state uncertainties; two files of one car may differ in them."""


@dataclass(frozen=True)
class Vehicle:
    """Table II of the paper, both axles, and the known effects.

    ``motor_odds`` are the prior odds that the brake pedal also commands a motor whose torque is not
    logged. Half of the new cars of 2023 have a motor that brakes (ACEA, registrations in the
    European Union), and most tests log its torque or switch it off.
    """

    name: str  # also the name of the tables fitted for the car
    mass: float  # M_v [kg], as driven
    cg_to_front_axle: float  # l_f [m]
    cg_to_rear_axle: float  # l_r [m]
    cg_height: float  # h [m]
    track_width: float  # l_w [m]
    front: Axle
    rear: Axle
    mass_tolerance: float = 0.03  # standard deviation of the relative error of the mass [1]
    motor_odds: float = 0.1  # [1]
    effects: Effects = field(default_factory=Effects)  # in addition to the paper's model

    @property
    def wheelbase(self) -> float:
        """L = l_f + l_r [m]."""
        return self.cg_to_front_axle + self.cg_to_rear_axle

    @property
    def weight(self) -> float:
        """M_v g [N]."""
        return self.mass * G

    def with_radii(self, factor: float) -> Self:
        """Return the car with the rolling radii of both axles multiplied by ``factor`` [1]."""
        front, rear = self.front.with_radius(factor), self.rear.with_radius(factor)
        return replace(self, front=front, rear=rear)

    def with_pads(self, front: float, rear: float) -> Self:
        """Return the car with pads of other friction ``front`` and ``rear`` [1]."""
        front_axle = replace(self.front, pad_friction=front)
        return replace(self, front=front_axle, rear=replace(self.rear, pad_friction=rear))

    def radius_mismatch(self, eta_zero: float) -> float:
        """True ratio of front to rear rolling radius over that of this vehicle, less one [1].

        ``eta_zero`` is omega_r/omega_f - 1 in free rolling, when the true ratio is omega_r/omega_f.
        """
        return (1.0 + eta_zero) * self.rear.rolling_radius / self.front.rolling_radius - 1.0

    @property
    def static_loads(self) -> tuple[float, float]:
        """Loads of the front and the rear axle at rest [N], (6) and (7)."""
        load_per_length = self.weight / self.wheelbase
        return load_per_length * self.cg_to_rear_axle, load_per_length * self.cg_to_front_axle


def require_same_car(
    car: Vehicle, other: Vehicle, where: object = None, *, weighed: bool = False
) -> None:
    """Raise VehicleError if ``other`` differs from a table's ``car`` in more than pads and effects.

    ``where`` names the file of ``other``. The mass may differ, too, if ``other`` was ``weighed``.
    """
    may_differ = {*UNCERTAINTIES, "front.pad_friction", "rear.pad_friction"}
    if weighed:
        may_differ.add("mass")
    numbers, other_numbers = _numbers(car), _numbers(other)
    differences = [
        f"{key} {other_numbers[key]:.6g} for {value:.6g}"
        for key, value in numbers.items()
        if key not in may_differ and other_numbers[key] != value
    ]
    if differences:
        flaw = f"the table was fitted for another car: {', '.join(differences[:4])}"
        expected, do = "a vehicle with other pads only", "fit a table for this car"
        raise VehicleError(flaw, where=where or other.name, expected=expected, do=do)


def _numbers(car: Vehicle) -> dict[str, float]:
    """The numbers of a car by the keys of its file, such as ``mass`` and ``front.pad_friction``."""
    entries = asdict(car)
    numbers = {key: value for key, value in entries.items() if isinstance(value, int | float)}
    for axle in ("front", "rear"):
        numbers |= {f"{axle}.{key}": value for key, value in entries[axle].items()}
    return numbers
