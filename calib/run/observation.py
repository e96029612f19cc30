"""Observations on a log, on which its verdicts depend."""

from dataclasses import dataclass, field
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES, CHANNELS, G
from calib.logs.clock import GAP, step_of
from calib.logs.log import Log
from calib.run.axle_signals import axle_pressure, wheels_held
from calib.run.blocks import Axle, braked_alone_in
from calib.run.copies import made_of_wheels
from calib.run.driving_record import (
    BrakeEvent,
    DrivingRecord,
    brake_events,
    driving_record,
    rolls,
    standing,
)
from calib.run.limits import LIMITS
from calib.run.pressure_delay import PressureDelay, delay_of_wheel, pressure_delay
from calib.run.sensors import Sensor, sensors_of
from calib.run.wheels import Axles, Slipping, WheelParts, axles_of, slipping, slips_of, wheel_parts


@dataclass(frozen=True)
class _Clock:
    """Sampling of a log.

    ``duration`` [s]; ``rate`` of the mean step [Hz]; ``jitter`` root mean square deviation of
    the steps from it, without gaps [s]; ``gaps`` as (start [s], length [s]).
    """

    samples: int
    duration: float
    rate: float
    jitter: float
    gaps: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Observation:
    """Content of a log, in SI.

    Attributes
    ----------
    present, missing : canonical channels; ``missing`` only those that every log must have.
    clock, sensors : see `_Clock` and `Sensor`; ``time`` has no sensor.
    events : applications of the brake, by pressure, or by deceleration where there is none.
    lead_in : unbraked, steady and moving time before the first event [s].
    coasting : all unbraked, steady and moving time [s].
    lead_in_driven : whether the car was accelerated in it.
    standing : time in which no wheel turns [s].
    speed, z : highest speed [m/s], approximate without ``v``; highest deceleration, in g [1].
    alone : the axle that brakes alone by its pressures, "f" or "r"; None for both.
    pressures : how the deceleration follows each pressure, by channel, where that is known.
    wheels_held : mean time for which a wheel speed keeps a value while the car slows [s].
    v_of_wheels : whether ``v`` is made of the wheel speeds.
    axles, slipping, wheels : None where ``a_x`` or a wheel speed is missing; so are the times
        above. ``wheels`` also without rolling or braking.
    """

    present: tuple[str, ...]
    missing: tuple[str, ...]
    clock: _Clock
    sensors: tuple[Sensor, ...]
    events: tuple[BrakeEvent, ...] = ()
    lead_in: float = 0.0
    coasting: float = 0.0
    lead_in_driven: bool = False
    standing: float = 0.0
    speed: float = 0.0
    z: float = 0.0
    alone: Axle | None = None
    pressures: dict[str, PressureDelay] = field(default_factory=dict)
    wheels_held: float = 0.0
    v_of_wheels: bool = False
    axles: Axles | None = None
    slipping: Slipping | None = None
    wheels: WheelParts | None = None

    def sensor(self, channel: str) -> Sensor | None:
        """The sensor of a channel, or None."""
        return next((s for s in self.sensors if s.channel == channel), None)


def observe(log: Log, *, full: bool = True) -> Observation:
    """Observe a log; without ``a_x`` and all wheel speeds only its clock and sensors.

    Without ``full``, noise and resolution of the sensors are NaN, and ``v_of_wheels`` is not looked
    for: `check` and a diagnosis alone ask for them.
    """
    present = tuple(name for name in CHANNELS if name in log)
    missing = tuple(q.name for q in CHANNELS.values() if q.required and q.name not in log)
    clock = clock_of(log.time)
    if set(missing) - {"p_mc"}:
        return Observation(present, missing, clock, sensors_of(log, None, full=full))
    driving = driving_record(log)
    events = brake_events(driving)
    slips = slips_of(log, driving)
    at_limit = slipping(slips, driving)
    rolling = driving.lead_in & driving.moving
    return Observation(
        present=present,
        missing=missing,
        clock=clock,
        sensors=sensors_of(log, driving, full=full),
        events=events,
        lead_in=float((rolling & rolls(driving.z)).sum() * driving.step),
        coasting=float(driving.unbraked.sum() * driving.step),
        lead_in_driven=bool((driving.wheel_z[rolling] < -0.1).sum() > 0.2 * rolling.sum()),
        standing=float(standing(log).sum() * driving.step),
        speed=float(driving.speed.max()),
        z=float(driving.z[driving.moving].max()) if driving.moving.any() else 0.0,
        alone=braked_alone_in(log),
        pressures=_delays(log, driving, at_limit.first) if "p_mc" in log else {},
        wheels_held=wheels_held(log),
        v_of_wheels=full and "v" in log and made_of_wheels(log),
        axles=axles_of(log, driving, slips),
        slipping=at_limit,
        wheels=wheel_parts(log, driving),
    )


_GREATEST = 1.5 * G  # deceleration that no road car reaches [m/s^2]: a glitch of a_x


def _delays(log: Log, driving: DrivingRecord, limit: float) -> dict[str, PressureDelay]:
    """The delay of the deceleration after each pressure until a wheel is at its ``limit`` [s].

    Wheels are told by the master cylinder where they follow it, and the deceleration agrees; else
    by the deceleration, and nothing is said of ``p_mc``: a motor, a booster or a hold is between.
    """
    use = driving.moving & (log.time < limit)
    both = [[f"p_{axle}l", f"p_{axle}r"] for axle in AXLES]
    names = [name for pair in both if all(x in log for x in pair) for name in pair]
    drives = [log[name] for name in ("T_drive_f", "T_drive_r") if name in log]
    true = use & (np.abs(log["a_x"]) <= _GREATEST)
    of_z = partial(pressure_delay, log.time, driving.z, drives=drives, use=true)
    master = of_z([log["p_mc"]])
    wheels = of_z([axle_pressure(log, axle) for axle in AXLES]) if names else None
    if master is None or wheels is None:
        return {"p_mc": master} if master else {}
    if not drives:
        behind = [delay_of_wheel(log.time, log[name], log["p_mc"], use) for name in names]
        told = [master.less(x) for x in behind if x and x.explained > LIMITS.explained_curve]
        if len(told) == len(names) and wheels.within(told):
            return {"p_mc": master, **dict(zip(names, told, strict=True))}
    return dict.fromkeys(names, wheels)


def clock_of(time: Array) -> _Clock:
    """Sampling of a strictly increasing time [s], shape (n,)."""
    steps, step = np.diff(time), step_of(time)
    wide = steps > GAP * step
    jitter = steps[~wide] - step
    return _Clock(
        samples=time.size,
        duration=float(time[-1] - time[0]),
        rate=1.0 / step,
        jitter=float(np.sqrt(np.mean(jitter**2))),
        gaps=tuple((float(time[i]), float(steps[i])) for i in np.flatnonzero(wide)),
    )


def figures(seen: Observation) -> dict[str, float | None]:
    """Every figure in SI, see `calib.line.fleet.columns`; None where the log gives none."""
    clock, pressure = seen.clock, seen.sensor("p_mc")
    zero = seen.axles.front_rear if seen.axles else None
    return {
        "samples": clock.samples,
        "duration": clock.duration,
        "rate": clock.rate,
        "jitter": clock.jitter,
        "gaps": len(clock.gaps),
        "brakings": len(seen.events),
        "lead_in": seen.lead_in,
        "coasting": seen.coasting,
        "speed_max": seen.speed,
        "deceleration_max": seen.z,
        "pressure_max": pressure.high if pressure else None,
        "eta_zero": zero.value if zero else None,
    }
