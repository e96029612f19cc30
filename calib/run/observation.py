"""Observations on a log, on which its verdicts depend."""

from dataclasses import dataclass

import numpy as np

from calib.base.names import CHANNELS, WHEELS
from calib.logs.log import Log
from calib.run.axle_signals import wheels_held
from calib.run.check_clock import Clock, clock_of
from calib.run.copies import made_of_wheels
from calib.run.crossed_wheels import WheelParts, wheel_parts
from calib.run.driving_record import BrakeEvent, brake_events, driving_record, rolls
from calib.run.limits import LIMITS
from calib.run.one_axle import Axle, braked_alone_in
from calib.run.pressure_checks import explained
from calib.run.sensors import Sensor, sensors_of
from calib.run.wheel_checks import Axles, Slipping, axles_of, slipping

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)
OPTIONAL = tuple(q.name for q in CHANNELS.values() if not q.required)


@dataclass(frozen=True)
class Observation:
    """Content of a log, in SI.

    Attributes
    ----------
    present, missing : canonical channels; ``missing`` only those that every log must have.
    clock, sensors : see `Clock` and `Sensor`; ``time`` has no sensor.
    events : applications of the brake, by pressure, or by deceleration where there is none.
    lead_in : unbraked, steady and moving time before the first event [s].
    coasting : all unbraked, steady and moving time [s].
    lead_in_driven : whether the car was accelerated in it.
    standing : time in which no wheel turns [s].
    speed : highest speed [m/s]; approximate without ``v``.
    z : highest deceleration, in g [1].
    alone : the axle that brakes alone by its pressures, "f" or "r"; None for both.
    explained : share of the deceleration's variance that the pressure explains [1]; None where it
        cannot be told.
    wheels_held : mean time for which a wheel speed keeps a value while the car slows [s].
    v_of_wheels : whether ``v`` is made of the wheel speeds.
    axles, slipping, wheels : None where ``a_x`` or a wheel speed is missing; so are the times
        above. ``wheels`` also without rolling or braking.
    """

    present: tuple[str, ...]
    missing: tuple[str, ...]
    clock: Clock
    sensors: tuple[Sensor, ...]
    events: tuple[BrakeEvent, ...] = ()
    lead_in: float = 0.0
    coasting: float = 0.0
    lead_in_driven: bool = False
    standing: float = 0.0
    speed: float = 0.0
    z: float = 0.0
    alone: Axle | None = None
    explained: float | None = None
    wheels_held: float = 0.0
    v_of_wheels: bool = False
    axles: Axles | None = None
    slipping: Slipping | None = None
    wheels: WheelParts | None = None

    def sensor(self, channel: str) -> Sensor | None:
        """The sensor of a channel, or None."""
        return next((s for s in self.sensors if s.channel == channel), None)


def observe(log: Log, *, noise: bool = True) -> Observation:
    """Observe a log; without ``a_x`` and all wheel speeds only its clock and sensors.

    With ``noise`` false, noise and resolution of the sensors are NaN; no verdict depends on them.
    """
    present = tuple(name for name in CHANNELS if name in log)
    missing = tuple(name for name in REQUIRED if name not in log)
    clock = clock_of(log.time)
    if set(missing) - {"p_mc"}:
        return Observation(present, missing, clock, sensors_of(log, None, noise=noise))
    driving = driving_record(log)
    events = brake_events(driving)
    rolling = driving.lead_in & driving.moving
    steady = rolling & rolls(driving.z)
    wheels = np.max([log[f"omega_{w}"] for w in WHEELS], axis=0)
    return Observation(
        present=present,
        missing=missing,
        clock=clock,
        sensors=sensors_of(log, driving, noise=noise),
        events=events,
        lead_in=float(steady.sum() * driving.step),
        coasting=float(driving.unbraked.sum() * driving.step),
        lead_in_driven=bool((driving.wheel_z[rolling] < -0.1).sum() > 0.2 * rolling.sum()),
        standing=float((wheels < LIMITS.standing).sum() * driving.step),
        speed=float(driving.speed.max()),
        z=float(driving.z[driving.moving].max()) if driving.moving.any() else 0.0,
        alone=braked_alone_in(log),
        explained=explained(log, driving) if "p_mc" in log else None,
        wheels_held=wheels_held(log),
        v_of_wheels="v" in log and made_of_wheels(log),
        axles=axles_of(log, driving),
        slipping=slipping(log, driving, events),
        wheels=wheel_parts(log, driving),
    )
