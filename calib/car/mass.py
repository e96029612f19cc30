"""The mass of the car in a log: the mass of the vehicle file, or a mass stated for the log."""

from dataclasses import dataclass, replace

from calib.base.errors import VehicleError
from calib.base.intervals import Z95
from calib.car.vehicle import Vehicle

_LEAST, _MOST = 0.5, 2.0
"""Range of a stated mass over that of the file [1]: an empty and a laden van. Outside, the number
is in pounds or of another car, or the load moves the centre of gravity."""

WEIGHED = 0.005  # relative sigma of a stated mass [1]: error of a scale for cars, and fuel burnt


@dataclass(frozen=True)
class MassUsed:
    """The mass that a result used."""

    value: float  # [kg]
    tolerance: float  # relative standard deviation [1]
    stated: bool  # whether the mass was given for these logs
    share: float = 1.0  # ``value`` over the mass of the vehicle file [1]

    def __str__(self) -> str:
        mass = f"{self.value:.6g} kg ±{100.0 * Z95 * self.tolerance:.2g} % (95 %)"
        excess = self.share - 1.0
        if self.stated and abs(excess) <= WEIGHED:
            return f"{mass}, as stated for these logs"
        if self.stated:
            difference = f"{100.0 * abs(excess):.2g} % {'above' if excess > 0.0 else 'below'}"
            return f"{mass}, as stated for these logs: {difference} the vehicle file"
        if self.tolerance < Vehicle.mass_tolerance:  # the default is for a load nobody knows
            return f"{mass} by the vehicle file"
        return f"{mass}: the load was not stated; give --mass, or mass_tolerance in the file"


def with_mass(vehicle: Vehicle, mass: float | None) -> Vehicle:
    """Return the vehicle with a stated ``mass`` [kg], or unchanged with None.

    The effect ``mass_error`` is dropped, and the tolerance is at most `WEIGHED`. Not valid for a
    load high up or far behind, since the centre of gravity does not move. Raises VehicleError for a
    mass out of the range `_LEAST` to `_MOST`.
    """
    if mass is None:
        return vehicle
    share = mass / vehicle.mass
    if not _LEAST <= share <= _MOST:
        of_file = f"the {vehicle.mass:.5g} kg of the vehicle file"
        flaw = f"a stated mass of {mass:.5g} kg is {share:.2f} times {of_file}"
        do = "check number and unit of the mass; a car with such a load has its own vehicle file"
        expected = f"{_LEAST:g} to {_MOST:g} times"
        raise VehicleError(flaw, where=vehicle.name, expected=expected, do=do)
    tolerance, effects = min(vehicle.mass_tolerance, WEIGHED), vehicle.effects.without("mass_error")
    return replace(vehicle, mass=mass, mass_tolerance=tolerance, effects=effects)


def mass_used(vehicle: Vehicle, mass: float | None) -> MassUsed:
    """Return the mass of `with_mass`, for a report."""
    car = with_mass(vehicle, mass)
    return MassUsed(car.mass, car.mass_tolerance, mass is not None, car.mass / vehicle.mass)
