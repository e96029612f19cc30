"""The mass of the car in a log: that of its vehicle file, or as stated for the run."""

from dataclasses import dataclass, replace

from calib.base.errors import VehicleError
from calib.base.intervals import Z95
from calib.car.vehicle import Vehicle

_SHARES = (0.5, 2.0)
"""Bounds of a stated mass over that of the file [1]: an empty and a laden van. Beyond them it is in
pounds, or of another car, or the load moves the centre of gravity."""

WEIGHED = 0.005
"""Standard deviation of a stated mass, relative [1]: a scale for cars and fuel burnt since."""


@dataclass(frozen=True)
class MassUsed:
    """The mass in a result: ``value`` [kg] and its relative standard deviation ``tolerance`` [1].

    ``stated`` whether it was given for these logs; ``share`` it is of that of the vehicle file [1].
    """

    value: float
    tolerance: float
    stated: bool
    share: float = 1.0

    def __str__(self) -> str:
        mass = f"{self.value:.6g} kg ±{100.0 * Z95 * self.tolerance:.2g} % (95 %)"
        if self.stated:
            excess = self.share - 1.0
            side = "above" if excess > 0.0 else "below"
            difference = f": {100.0 * abs(excess):.2g} % {side} the vehicle file"
            return f"{mass}, as stated for these logs{difference * (abs(excess) > WEIGHED)}"
        if self.tolerance < Vehicle.mass_tolerance:
            return f"{mass} by the vehicle file"
        return f"{mass}: the load was not stated; give --mass, or mass_tolerance in the file"


def weighed(vehicle: Vehicle, mass: float | None) -> Vehicle:
    """Return the vehicle with a stated ``mass`` [kg]; unchanged without one.

    The centre of gravity stays: not valid for a load high up or far behind. The effect
    ``mass_error`` is dropped; the tolerance is at most `WEIGHED`. Raises VehicleError for a mass
    outside of `_SHARES`.
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
