"""The ratio of front to rear pads from a roller brake tester: brake forces at some pressures.

    F |        .x     F = k (F_n(p) - F_0)    F_n by the vehicle file, (2), (3): 2 mu C p/R
      |      x'       k    pads over those of the file
      |   .x          F_0  springs and seals, less the rolling resistance on the rollers
      +--+------ F_n

The rollers measure each axle alone, so the ratio of the pads follows without any tyre, for cold
pads at walking speed. On the road the friction differs, by nearly the same factor on both axles; a
difference of these factors is not part of the standard deviation given here.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import BenchError
from calib.base.intervals import Z95
from calib.base.names import AXLE_NAMES
from calib.base.random_effects import quantile95
from calib.car.brakes import brakes_of
from calib.car.history import constant_speed
from calib.car.keys import KEYS
from calib.car.model import default_model
from calib.car.vehicle import Axle, Vehicle
from calib.table.table import Value

TOLERANCE = 0.01
"""Half of the error of 2 % that German rules allow for the brake force shown (Richtlinie fuer die
Anwendung, Beschaffenheit und Pruefung von Bremspruefstaenden, Verkehrsblatt 2003, p. 303; 3 % for
testers from before): a limit is taken as two standard deviations."""

_SPEED = 1.4  # speed of the rollers [m/s]: 5 km/h
_ROW_TIME = 60.0  # between two rows [s]: brakes with a lag have then followed the pressure
_LARGEST_SIGMA = 0.1  # largest relative sigma of a slope [1]: the grade of the pads says as much
_LEAST_SPREAD = 1e-6  # norm of the deviations of nominal forces [N], below which they do not rise

_COMMON_SHARE = 0.5
"""Share of the machine's variance that both axles have in common: its scale [1]. The rest differs
between the axles: nonlinearity of the machine, position of the wheels. No rule gives the shares."""

_FRICTION = next(key for key in KEYS if key.path == "front.pad_friction")


@dataclass(frozen=True)
class AxleOnRollers:
    """The rows of one axle, three or more."""

    pressure: tuple[float, ...]  # p_mc [Pa]
    force: tuple[float, ...]  # brake force of both wheels [N]


class _Line(NamedTuple):
    """A line through the rows of an axle."""

    slope: float  # of force over nominal force [1]
    squares: float  # sum of squared residuals, each over the mean force [1]
    freedom: int  # degrees of freedom: rows less two
    lever: float  # sigma of the slope for a relative scatter of 1 [1]


@dataclass(frozen=True)
class RollerBench:
    """A run on a roller brake tester."""

    name: str  # of the file
    source: str  # path of the file
    digest: str  # SHA-256 of the file
    tolerance: float  # standard deviation of the relative error of an axle's force [1]
    front: AxleOnRollers
    rear: AxleOnRollers

    def log_pad_ratio(self, vehicle: Vehicle) -> Value:
        """ln of (mu_f/mu_r) over its value in the vehicle file [1], with its standard deviation.

        The standard deviation has two parts: the scatter of the rows, and the part of the tolerance
        that the axles do not share. The relative scatter is that of the rows of both axles;
        Student's t allows for their small number. Raises BenchError for rows on no line that rises
        and for pads that no car has; ModelError for an effect of the vehicle that cannot be used.
        """
        front, rear = (self._line(vehicle, axle) for axle in "fr")
        freedom = front.freedom + rear.freedom
        scatter = float(np.sqrt((front.squares + rear.squares) / freedom))
        row_sigma = scatter * quantile95(freedom) / Z95
        sigma_f, sigma_r = (row_sigma * line.lever / line.slope for line in (front, rear))
        machine_variance = 2.0 * (1.0 - _COMMON_SHARE) * self.tolerance**2
        value = float(np.log(front.slope)) - float(np.log(rear.slope))
        return Value(value, float(np.sqrt(sigma_f**2 + sigma_r**2 + machine_variance)))

    def _line(self, vehicle: Vehicle, axle: str) -> _Line:
        """Fit a line to an axle's measured forces over its nominal forces, by least squares.

        The slope is 0 where the nominal forces do not rise, as behind a valve that shuts.
        """
        name = AXLE_NAMES[axle]
        rows: AxleOnRollers = getattr(self, name)
        brake: Axle = getattr(vehicle, name)
        by_pressure = sorted(zip(rows.pressure, rows.force, strict=True))
        pressure, force = np.array(by_pressure).T  # (n,) each
        nominal, mean = _nominal(vehicle, axle, pressure, self.source), float(force.mean())
        x = nominal - nominal.mean()  # [N]
        spread = max(float(np.linalg.norm(x)), _LEAST_SPREAD)
        slope = float(x @ force) / spread**2
        residual = (force - mean - slope * x) / mean
        line = _Line(slope, float(residual @ residual), force.size - 2, mean / spread)
        sigma = line.lever * float(np.sqrt(line.squares / line.freedom))
        if slope <= 0.0 or sigma > _LARGEST_SIGMA * slope:
            raise BenchError(
                f"the brake force of the {name} axle does not rise in a line with the "
                f"pressure: its slope is {slope:.2f} +- {sigma:.2f} of that of the vehicle file",
                where=self.source,
                expected=f"rows on a line, whose slope is known to {100 * _LARGEST_SIGMA:g} %",
                do="leave out rows where the wheels slip on the rollers; measure more pressures",
            )
        least, most = _FRICTION.least, _FRICTION.most
        friction = slope * brake.pad_friction
        if not least <= friction <= most:
            flaw = f"the brake force of the {name} axle asks for a pad friction of {friction:.3g}"
            keys = "piston_area, effective_radius and friction_faces of the vehicle file"
            do = f"check the units, whether the force is that of both wheels, and {keys}"
            raise BenchError(flaw, where=self.source, expected=f"{least:g} to {most:g}", do=do)
        return line


def _nominal(vehicle: Vehicle, axle: str, pressure: Array, source: str) -> Array:
    """Brake force of an axle [N] (n,) by the vehicle file at an increasing ``pressure`` [Pa] (n,).

    It includes the known effects on pressure and pads, such as a valve. Errors name the ``source``.
    """
    time = _ROW_TIME * np.arange(pressure.size, dtype=np.float64)
    run = constant_speed(time, pressure, _SPEED, source=source)
    brakes = brakes_of(default_model(vehicle), run, {})
    torques = brakes.torques(run)
    torque = sum((torques[brakes.twin(f"{axle}{side}")] for side in "lr"), np.zeros_like(pressure))
    return np.asarray(torque / brakes.axle(f"{axle}l").rolling_radius)
