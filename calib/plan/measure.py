"""What can be done to know a car better: runs to drive, and what a workshop measures.

    p ^          ___        lead-in 3 s, rise, hold 1 s, release
      |        .'   |       a ramp ends where the car, or its one braked axle, comes to `end`
      |______.'     |__
      +---------------> t

`measures.csv` has one row for each: `end` of a ramp as deceleration over g, or of one axle as
the force over its load [1]; `rise` of a ramp or length of a coast [s]; `seconds` that a
measurement in the workshop takes.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.base.names import AXLES, WHEEL_PRESSURES, WHEELS
from calib.base.plain import rows
from calib.car.balance import force_per_pressure
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.simulate import simulate

LEAD_IN, HOLD, RELEASE = 3.0, 1.0, 0.5
"""Times of a run [s]: a fit zeroes eta over the last 3 s before the bite."""

RATE = 100.0
"""Samples per second of a planned run: a fit takes means over blocks of 50 ms or more."""

_SLOWEST = 5.0  # speed at the end of a rise, at least [m/s]: a fit leaves out slower blocks


@dataclass(frozen=True)
class Measure:
    """One row of `measures.csv`; ``axle`` that brakes alone, "" for both; nan where empty."""

    name: str
    kind: str
    axle: str
    end: float
    rise: float
    seconds: float
    text: str
    driver: str

    @property
    def driven(self) -> bool:
        """Whether it is a run with a log, and not a measurement in a workshop."""
        return self.kind in ("ramp", "coast")

    @property
    def is_whole_ramp(self) -> bool:
        """Whether it is a ramp with both axles, of which one is enough."""
        return self.kind == "ramp" and not self.axle

    @property
    def duration(self) -> float:
        """Time of the work, or to the end of the rise of a run [s]."""
        lead_in = LEAD_IN * (self.kind == "ramp")
        return lead_in + self.rise if self.driven else self.seconds


@dataclass(frozen=True)
class Track:
    """Where the runs are driven: ``length`` [m] and first ``speed`` [m/s]."""

    length: float = np.inf
    speed: float = 100.0 / 3.6


@cache
def measures() -> tuple[Measure, ...]:
    """All measures, runs before measurements in a workshop."""
    return tuple(_measure(row) for row in rows("measures.csv", "calib.plan"))


def _measure(row: dict[str, str]) -> Measure:
    end, rise, seconds = (float(row.pop(name) or "nan") for name in ("end", "rise", "seconds"))
    return Measure(end=end, rise=rise, seconds=seconds, **row)


def pressure_trace(car: Vehicle, run: Measure) -> tuple[Array, Array]:
    """Time [s] and master-cylinder pressure [Pa] of a run, (n,) each, at `RATE`."""
    if run.kind == "coast":
        time = np.arange(round(run.rise * RATE) + 1) / RATE
        return time, np.zeros_like(time)
    corners = np.cumsum([0.0, LEAD_IN, run.rise, HOLD, RELEASE, RELEASE])
    time = np.arange(round(corners[-1] * RATE) + 1) / RATE
    gains, loads = (
        sum(x for x, axle in zip(of_axles, AXLES, strict=True) if run.axle in ("", axle))
        for of_axles in (force_per_pressure(car), car.static_loads)
    )
    top = run.end * loads / gains  # (2), (5), with the pads of the file
    return time, np.interp(time, corners, [0.0, 0.0, top, top, 0.0, 0.0])


def drive(model: Model, run: Measure, track: Track, sensors: frozenset[str]) -> Log:
    """Simulate a run as it would be driven and logged, without noise.

    ``sensors`` the optional channels. Raises ModelError where it cannot be driven: longer than the
    track, nearly at rest before the end of the rise, a tyre beyond its peak, or one axle alone
    without logged wheel pressures.
    """
    if run.axle and not sensors >= set(WHEEL_PRESSURES):
        raise ModelError(f"{run.text} needs {', '.join(sorted(WHEEL_PRESSURES))}")
    time, pressure = pressure_trace(model.vehicle, run)
    alone = {w: pressure * (w[0] == run.axle) for w in WHEELS} if run.axle else None
    log = simulate(model, time, pressure, track.speed, wheel_pressure=alone, name=run.name)
    if log.time[-1] < run.duration or log["v"][-1] < _SLOWEST:
        raise ModelError(
            f"{run.text} would end after {log.time[-1]:.1f} s at {3.6 * log['v'][-1]:.0f} km/h",
            expected=f"{run.duration:.1f} s, and {3.6 * _SLOWEST:.0f} km/h at the end",
        )
    if (way := float(np.trapezoid(log["v"], log.time))) > track.length:
        raise ModelError(f"{run.text} takes {way:.0f} m", expected=f"up to {track.length:.0f} m")
    optional = {"v", *WHEEL_PRESSURES} - sensors
    channels = {name: x for name, x in log.channels.items() if name not in optional}
    return replace(log, channels=channels)
