"""The ratio of front to rear pads from a roller brake tester: brake forces at some pressures.

    F |        .x     F = k (F_n(p) - F_0)    F_n by the vehicle file, (2), (3): 2 mu C p/R
      |      x'       k    pads over those of the file
      |   .x          F_0  springs and seals, less the rolling resistance on the rollers
      +--+------ F_n

The rollers measure each axle alone, so the pads' ratio follows without any tyre. It is the ratio of
cold pads at walking speed. On the road the friction differs, by nearly the same factor on both
axles; a difference of these factors is not part of the standard deviation given here.
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

_SPEED = 1.4
"""Speed of the rollers [m/s]: 5 km/h."""

_HELD = 60.0
"""Time [s] between two rows: brakes that are late have followed."""

_COMMON = 0.5
"""Share of the variance of the machine that is its scale, the same for both axles, which stand on
the same rollers. The rest is an axle's own: how the machine bends from small to large forces, how
the wheels stand. No rule says how much is which: half and half."""

_NO_LINE = 0.1
"""Largest relative standard deviation of a slope [1]. With a larger one the rows are on no line: by
the grade of the pads their friction is known as well."""

_LEAST_SPREAD = 1e-6
"""Root of the sum of squares of nominal forces less their mean [N], below which they do not
rise."""

_PADS = next(key for key in KEYS if key.path == "front.pad_friction")


@dataclass(frozen=True)
class AxleOnRollers:
    """The rows of one axle, three or more: ``pressure`` p_mc [Pa], ``force`` of both wheels [N]."""

    pressure: tuple[float, ...]
    force: tuple[float, ...]


@dataclass(frozen=True)
class RollerBench:
    """A run on a roller brake tester.

    ``name`` of the file, ``source`` its path, ``digest`` SHA-256 of its bytes; ``tolerance`` one
    standard deviation of the relative error of an axle's force [1].
    """

    name: str
    source: str
    digest: str
    tolerance: float
    front: AxleOnRollers
    rear: AxleOnRollers

    def log_pad_ratio(self, vehicle: Vehicle) -> Value:
        """ln of (mu_f/mu_r) over its value in the vehicle file [1], with its standard deviation.

        The standard deviation has two parts: the scatter of the rows, and the part of the tolerance
        that is each axle's own. The relative scatter is estimated from the rows of both axles
        together, since one axle has few; Student's t allows for their number.

        Raises BenchError for rows on no line that rises and for pads that no car has; ModelError
        for an effect of the vehicle that cannot be used.
        """
        front, rear = (self._line(vehicle, axle) for axle in "fr")
        freedom = front.freedom + rear.freedom
        scatter = float(np.sqrt((front.squares + rear.squares) / freedom))
        wide = scatter * quantile95(freedom) / Z95
        sigma_f, sigma_r = (wide * line.lever / line.slope for line in (front, rear))
        of_tolerance = 2.0 * (1.0 - _COMMON) * self.tolerance**2
        value = float(np.log(front.slope)) - float(np.log(rear.slope))
        return Value(value, float(np.sqrt(sigma_f**2 + sigma_r**2 + of_tolerance)))

    def _line(self, vehicle: Vehicle, axle: str) -> "_Line":
        """The line of an axle's measured forces over its nominal ones, by least squares.

        Its slope is 0 where the nominal forces do not rise, as behind a valve that shuts.
        """
        name = AXLE_NAMES[axle]
        rows: AxleOnRollers = getattr(self, name)
        brake: Axle = getattr(vehicle, name)
        pressure, force = np.array(sorted(zip(rows.pressure, rows.force, strict=True))).T
        nominal, mean = _nominal(vehicle, axle, pressure, self.source), float(force.mean())
        x = nominal - nominal.mean()
        spread = max(float(np.linalg.norm(x)), _LEAST_SPREAD)
        slope = float(x @ force) / spread**2
        residual = (force - mean - slope * x) / mean
        line = _Line(slope, float(residual @ residual), force.size - 2, mean / spread)
        sigma = line.lever * float(np.sqrt(line.squares / line.freedom))
        if slope <= 0.0 or sigma > _NO_LINE * slope:
            raise BenchError(
                f"the brake force of the {name} axle does not rise in a line with the "
                f"pressure: its slope is {slope:.2f} +- {sigma:.2f} of that of the vehicle file",
                where=self.source,
                expected=f"rows on a line, whose slope is known to {100 * _NO_LINE:g} %",
                do="leave out rows where the wheels slip on the rollers; measure more pressures",
            )
        friction = slope * brake.pad_friction
        if not _PADS.least <= friction <= _PADS.most:
            raise BenchError(
                f"the brake force of the {name} axle asks for a pad friction of {friction:.3g}",
                where=self.source,
                expected=f"{_PADS.least:g} to {_PADS.most:g}",
                do="check the units, whether the force is that of both wheels, and piston_area, "
                "effective_radius and friction_faces of the vehicle file",
            )
        return line


def _nominal(vehicle: Vehicle, axle: str, pressure: Array, source: str) -> Array:
    """Brake force of an axle [N] (n,) by the vehicle file at an increasing ``pressure`` [Pa] (n,).

    It includes the known effects on pressure and pads, such as a valve or a threshold. ``source``
    of the rows, for errors.
    """
    time = _HELD * np.arange(pressure.size, dtype=np.float64)
    run = constant_speed(time, pressure, _SPEED, source=source)
    brakes = brakes_of(default_model(vehicle), run, {})
    torques = brakes.torques(run)
    torque = sum((torques[brakes.twin(f"{axle}{side}")] for side in "lr"), np.zeros_like(pressure))
    return np.asarray(torque / brakes.axle(f"{axle}l").rolling_radius)


class _Line(NamedTuple):
    """A line through the rows of an axle.

    ``slope`` of force over nominal force [1]; ``squares`` sum of squared residuals, each over the
    mean force [1]; ``freedom`` rows less two; ``lever`` sigma of the slope for a relative scatter
    of 1 [1].
    """

    slope: float
    squares: float
    freedom: int
    lever: float
