"""A log of a car: each view of the log is computed once, when it is first asked for.

    log --> driving record --> events, slips, axles, wheels, sensors     without a vehicle
     |
     +--> known effects taken out --> signals --> blocks --> noise, accelerometer
                                         |
                                         +--> lead-in, rolling radii, response of the brakes

A fit and an estimate start from the second line. Without a vehicle the signals there are as read.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import CHANNELS, WHEEL_SPEEDS
from calib.car.braking import BITE, MOVING
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.accelerometer import (
    Accelerometer,
    SpeedEvidence,
    accelerometer,
    other_scale,
    speed_evidence,
)
from calib.run.axle_signals import Signals, causal_signals, held_time, signals
from calib.run.blocks import Axle, Blocks, block_balance, blocks, braked_alone
from calib.run.brake_response import BrakeResponse, brake_balance, brake_response
from calib.run.driving_record import (
    NOMINAL_RADIUS,
    BrakeEvent,
    DrivingRecord,
    Sampling,
    brake_events,
    driving_record,
    sampling_of,
)
from calib.run.exchanged_wheels import WheelParts, wheel_parts
from calib.run.noise import SensorNoise, lead_in_noise, sensor_noise
from calib.run.pressure_delay import PressureDelay, delays_of
from calib.run.sensors import Sensor, sensors_of
from calib.run.wheels import Axles, Slipping, axles_of, slipping, slips_of

if TYPE_CHECKING:
    from calib.run.known_effects import CorrectedRun
    from calib.run.resistance import Resistance


@dataclass(frozen=True, eq=False)
class Run:
    """Views of a ``log``, of a ``vehicle`` if known; if ``causal``, as an ECU has the signals."""

    log: Log
    vehicle: Vehicle | None = None
    causal: bool = False

    def __repr__(self) -> str:
        return f"Run of {self.log!r}"

    # --- the log, without a vehicle ---------------------------------------------------------------

    @property
    def present(self) -> tuple[str, ...]:
        """Canonical channels of the log."""
        return tuple(name for name in CHANNELS if name in self.log)

    @cached_property
    def missing(self) -> tuple[str, ...]:
        """Canonical channels that are required and not in the log."""
        return tuple(q.name for q in CHANNELS.values() if q.required and q.name not in self.log)

    @property
    def has_motion_channels(self) -> bool:
        """Whether ``a_x`` and all wheel speeds are logged, which most views need."""
        return not set(self.missing) - {"p_mc"}

    @cached_property
    def clock(self) -> Sampling:
        """Number of samples, rate, jitter and gaps."""
        return sampling_of(self.log.time)

    @cached_property
    def sensors(self) -> tuple[Sensor, ...]:
        """The sensor of each channel but ``time``."""
        return sensors_of(self.log, self.driving if self.has_motion_channels else None)

    def sensor(self, channel: str) -> Sensor | None:
        """Return the sensor of a channel, or None if it is not logged."""
        return next((sensor for sensor in self.sensors if sensor.channel == channel), None)

    @cached_property
    def driving(self) -> DrivingRecord:
        """Smoothed speed, deceleration and pressure."""
        return driving_record(self.log)

    @cached_property
    def events(self) -> tuple[BrakeEvent, ...]:
        """Applications of the brake, by pressure, else by deceleration."""
        return brake_events(self.driving) if self.has_motion_channels else ()

    @cached_property
    def rolling(self) -> Mask:
        """Mask (n,) of the lead-in: unbraked rolling before the first braking, to zero eta."""
        if not self.has_motion_channels or self.speed < MOVING:
            return np.zeros(self.log.time.size, bool)
        if "p_mc" in self.log:
            return self.signals.lead_in
        # without a pressure the deceleration shows the braking
        pressure = np.where(self.driving.braked, 2.0 * BITE, 0.0)
        with_pressure = replace(self.log, channels={**self.log.channels, "p_mc": pressure})
        return signals(with_pressure).lead_in

    @property
    def lead_in(self) -> float:
        """Length of the lead-in [s]."""
        return float(self.rolling.sum() * self.log.sample_time)

    @property
    def coasting(self) -> float:
        """Time of unbraked rolling [s], as in `DrivingRecord.unbraked`."""
        if not self.has_motion_channels:
            return 0.0
        return float(self.driving.unbraked.sum() * self.driving.step)

    @property
    def speed(self) -> float:
        """Highest speed [m/s], approximate without ``v``."""
        return float(self.driving.speed.max()) if self.has_motion_channels else 0.0

    @property
    def z(self) -> float:
        """Highest deceleration while the car moves [g]."""
        if not (self.has_motion_channels and self.driving.moving.any()):
            return 0.0
        return float(self.driving.z[self.driving.moving].max())

    @cached_property
    def alone(self) -> Axle | None:
        """The axle that, by the pressures, brakes alone, or None."""
        return braked_alone(self.log) if self.has_motion_channels else None

    @cached_property
    def pressures(self) -> dict[str, PressureDelay]:
        """Delay of the deceleration after each pressure, by channel."""
        if self.slipping is None or "p_mc" not in self.log:
            return {}
        return delays_of(self.log, self.driving, self.slipping.first)

    @cached_property
    def wheels_held(self) -> float:
        """Mean time for which a wheel speed holds a value while the car slows [s]."""
        if not self.has_motion_channels:
            return 0.0
        times = [held_time(self.log, name, MOVING / NOMINAL_RADIUS) for name in WHEEL_SPEEDS]
        return float(np.median(times))

    @cached_property
    def slips(self) -> dict[str, Array]:
        """Smoothed slip of each wheel [1] (n,)."""
        return slips_of(self.log, self.driving)

    @cached_property
    def slipping(self) -> Slipping | None:
        """ABS cycles and locked wheels."""
        return slipping(self.slips, self.driving) if self.has_motion_channels else None

    @property
    def first_slip(self) -> float:
        """Time at which a wheel first slips deeply [s]; infinite if none is known to."""
        return self.slipping.first if self.slipping else math.inf

    @cached_property
    def axles(self) -> Axles | None:
        """Front wheels against rear wheels, left against right, and all against v and a_x."""
        return axles_of(self.log, self.driving, self.slips) if self.has_motion_channels else None

    @cached_property
    def wheels(self) -> WheelParts | None:
        """Change of the four slips by braking; None if the log does not show it."""
        return wheel_parts(self.log, self.driving) if self.has_motion_channels else None

    # --- the car, its known effects taken out -----------------------------------------------------

    @cached_property
    def corrected(self) -> "CorrectedRun":
        """The run as the car without its known effects would have given it."""
        from calib.run.known_effects import remove_known_effects

        assert self.vehicle is not None, "this view needs a vehicle"
        return remove_known_effects(self.vehicle, self.log)

    @property
    def car(self) -> Vehicle:
        """The vehicle as driven, with the known effects of the balance of forces alone."""
        return self.corrected.vehicle

    @cached_property
    def signals(self) -> Signals:
        """Signals of the axles at the rate of the log; as read without a vehicle."""
        if self.vehicle is None:
            return signals(self.log)
        read = causal_signals if self.causal else signals
        return read(self.corrected.log, self.car.rear.rolling_radius)

    @cached_property
    def blocks(self) -> Blocks:
        """Means of the signals over blocks of 50 ms."""
        return blocks(self.signals)

    @cached_property
    def noise(self) -> SensorNoise:
        """Noise of the sensors, from the whole run."""
        log = self.log if self.vehicle is None else self.corrected.log
        return sensor_noise(log, self.blocks)

    @cached_property
    def other_scale(self) -> float:
        """Scale of a_x against v [1] that a wrong unit, clock or filter makes; else 0."""
        return other_scale(self.blocks, self.noise.z, self.noise.v)

    @cached_property
    def lead_in_noise(self) -> SensorNoise:
        """Noise of the sensors, from the lead-in alone."""
        return lead_in_noise(self.corrected.log, self.signals)

    @cached_property
    def rolling_radii(self) -> tuple[float, float] | None:
        """Radii [m] of front and rear wheels on the lead-in; None without ``v`` or a lead-in."""
        s = self.signals
        if s.v is None or not s.lead_in.any():
            return None
        speed, front, rear = (np.mean(x[s.lead_in]) for x in (s.v, s.omega_f, s.omega_r))
        return float(speed / front), float(speed / rear)

    @cached_property
    def speed_evidence(self) -> SpeedEvidence:
        """What v shows of the accelerometer, with the `noise` of the run."""
        return speed_evidence(self.blocks, self.noise.z, self.noise.v)

    def accelerometer(
        self, resistance: "Resistance", noise: SensorNoise | None = None
    ) -> Accelerometer:
        """Scale and offset of the accelerometer; ``noise`` is that of the run by default."""
        b = self.blocks
        evidence = speed_evidence(b, noise.z, noise.v) if noise else self.speed_evidence
        unexplained = block_balance(self.car, resistance.effects, b).demanded / self.car.weight
        return accelerometer(evidence, unexplained, resistance.sigma_z(self.car, b.speed))

    def felt(self, sensor: Accelerometer | None) -> Blocks:
        """Return the blocks with the z that the tyres feel; without ``sensor``, z as read."""
        b = self.blocks
        return b if sensor is None else replace(b, z=sensor.corrected(b.z))

    def response(self, effects: Effects) -> BrakeResponse | None:
        """Response of the brakes, with ``effects`` of body and wheels; None with little braking."""
        return brake_response(self.signals, brake_balance(self.car, effects, self.signals))


def figures(run: Run) -> dict[str, float | None]:
    """Return the figures of `batch check`, in SI; None for a figure that the log does not give."""
    clock, pressure = run.clock, run.sensor("p_mc")
    zero = run.axles.front_rear if run.axles else None
    return {
        "samples": clock.samples,
        "duration": clock.duration,
        "rate": clock.rate,
        "jitter": clock.jitter,
        "gaps": len(clock.gaps),
        "brakings": len(run.events),
        "lead_in": run.lead_in,
        "coasting": run.coasting,
        "speed_max": run.speed,
        "deceleration_max": run.z,
        "pressure_max": pressure.high if pressure else None,
        "eta_zero": zero.value if zero else None,
    }
