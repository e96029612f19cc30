"""The mass of the car in a log: that of its file, or one that was stated for the log.

Mass multiplies every pad friction. A car whose load nobody wrote down is known to 3 %
(`Vehicle.mass_tolerance`); one that was weighed to `WEIGHED`.
"""

from dataclasses import dataclass, replace

from calib.base.errors import VehicleError
from calib.car.vehicle import Vehicle

_SHARES = (0.5, 2.0)
"""Bounds of a stated mass over that of the file [1]: an empty van against a laden one. What is
beyond, as pounds written as kg, is another car, or moves the centre of gravity."""

WEIGHED = 0.005
"""Standard deviation of a stated mass, relative [1]: a scale for cars and fuel burnt since."""


@dataclass(frozen=True)
class MassUsed:
    """The mass that a result rests on.

    ``value`` [kg]; ``tolerance`` its relative standard deviation [1]; ``stated`` for these logs,
    instead of taken from the vehicle file; ``share`` it is of that one [1].
    """

    value: float
    tolerance: float
    stated: bool
    share: float = 1.0

    def __str__(self) -> str:
        known = f"{self.value:.6g} kg, known to {100.0 * self.tolerance:.2g} %"
        if self.stated:
            return f"{known}, as stated for these logs{self._beside}"
        if self.tolerance < Vehicle.mass_tolerance:
            return f"{known} by the vehicle file"
        return f"{known}: nobody wrote down the load; state it, or mass_tolerance in the file"

    @property
    def _beside(self) -> str:
        """How far a stated mass is from that of the file, in words; "" within its `WEIGHED`."""
        more = self.share - 1.0
        if abs(more) <= WEIGHED:
            return ""
        return f": {100.0 * abs(more):.2g} % {'above' if more > 0.0 else 'below'} the vehicle file"


def weighed(vehicle: Vehicle, mass: float | None) -> Vehicle:
    """Return the vehicle with a stated ``mass`` [kg]; as it is where none was stated.

    All loads grow with it, the centre of gravity stays: wrong for a load high up or far behind. A
    known error of the file's mass is then meaningless and left out. The tolerance is `WEIGHED`, or
    that of the file where it is smaller. Raises VehicleError for a mass outside of `_SHARES`.
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
    """What `weighed` gives, for the reader of a result."""
    car = weighed(vehicle, mass)
    return MassUsed(car.mass, car.mass_tolerance, mass is not None, car.mass / vehicle.mass)
