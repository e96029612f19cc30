"""The measures of `measures.csv`, by which a car can be known better.

A measure is a run to drive, or work in a workshop. The pressure p of a ramp over time:

    p ^          ___
      |        .'   |         lead-in 3 s, rise, hold 1 s, release
      |______.'     |__
      +---------------> t
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

LEAD_IN, HOLD, RELEASE = 3.0, 1.0, 0.5  # times [s]; a fit zeroes eta over 3 s before the bite
RATE = 100.0  # samples per second of a run; a fit takes means over blocks of 50 ms or more
_SLOWEST = 5.0  # least speed at the end of a run [m/s]: a fit leaves out slower blocks


@dataclass(frozen=True)
class Measure:
    """A row of `measures.csv`; an empty number is NaN."""

    name: str
    kind: str  # "ramp", "coast", "weighing" or "rollers"
    axle: str  # "f" or "r" if the front or rear axle brakes alone, else ""
    end: float  # of a ramp, the deceleration over g [1]; of an axle alone, its force over load [1]
    rise: float  # time of the rise of a ramp, or of a coast [s]
    seconds: float  # time of a measurement in the workshop [s]
    text: str  # name for people
    driver: str  # what the driver or the workshop does

    @property
    def driven(self) -> bool:
        """Whether the measure is a run and not work in a workshop."""
        return self.kind in ("ramp", "coast")

    @property
    def is_whole_ramp(self) -> bool:
        """Whether the measure is a ramp with both axles, which every plan needs."""
        return self.kind == "ramp" and not self.axle

    @property
    def duration(self) -> float:
        """Time of the work, or of a run to the end of its rise [s]."""
        if self.kind == "ramp":
            return LEAD_IN + self.rise
        return self.rise if self.driven else self.seconds


@dataclass(frozen=True)
class Track:
    """The track of the runs."""

    length: float = np.inf  # [m]
    speed: float = 100.0 / 3.6  # at which a run begins [m/s]


@cache
def measures() -> tuple[Measure, ...]:
    """Return all measures, runs before work in a workshop."""
    listed = []
    for row in rows("measures.csv", "calib.plan"):
        end, rise, seconds = (float(row.pop(name) or "nan") for name in ("end", "rise", "seconds"))
        listed.append(Measure(end=end, rise=rise, seconds=seconds, **row))
    return tuple(listed)


def pressure_trace(car: Vehicle, run: Measure) -> tuple[Array, Array]:
    """Return time [s] and master-cylinder pressure [Pa] of a run, (n,) each, at `RATE`."""
    if run.kind == "coast":
        time = np.arange(round(run.rise * RATE) + 1) / RATE
        return time, np.zeros_like(time)
    corners = np.cumsum([0.0, LEAD_IN, run.rise, HOLD, RELEASE, RELEASE])  # the last: rolling
    time = np.arange(round(corners[-1] * RATE) + 1) / RATE
    braked = [run.axle in ("", axle) for axle in AXLES]
    gain = np.sum(force_per_pressure(car), where=braked)  # [N/Pa]
    load = np.sum(car.static_loads, where=braked)  # [N]
    top = run.end * load / gain  # force over load is `end`: (2), (5), with the pads of the file
    return time, np.interp(time, corners, [0.0, 0.0, top, top, 0.0, 0.0])


def drive(model: Model, run: Measure, track: Track, sensors: frozenset[str]) -> Log:
    """Simulate a run as it would be driven and logged, without noise.

    ``sensors`` are the optional channels that are logged. Raises ModelError for a run that is
    longer than the track, at whose end the car is nearly at rest, in which a tyre is beyond its
    peak, or with one axle alone and no sensors of wheel pressures.
    """
    if run.axle and not sensors.issuperset(WHEEL_PRESSURES):
        raise ModelError(f"{run.text} needs {', '.join(sorted(WHEEL_PRESSURES))}")
    time, pressure = pressure_trace(model.vehicle, run)
    by_wheel = None
    if run.axle:
        by_wheel = {w: pressure if w[0] == run.axle else 0.0 * pressure for w in WHEELS}
    log = simulate(model, time, pressure, track.speed, wheel_pressure=by_wheel, name=run.name)
    end_time, end_speed = log.time[-1], log["v"][-1]
    if end_time < run.duration or end_speed < _SLOWEST:
        flaw = f"{run.text} would end after {end_time:.1f} s at {3.6 * end_speed:.0f} km/h"
        expected = f"{run.duration:.1f} s, and {3.6 * _SLOWEST:.0f} km/h at the end"
        raise ModelError(flaw, expected=expected)
    distance = float(np.trapezoid(log["v"], log.time))
    if distance > track.length:
        flaw = f"{run.text} takes {distance:.0f} m"
        raise ModelError(flaw, expected=f"up to {track.length:.0f} m")
    not_logged = {"v", *WHEEL_PRESSURES} - sensors
    channels = {name: x for name, x in log.channels.items() if name not in not_logged}
    return replace(log, channels=channels)
