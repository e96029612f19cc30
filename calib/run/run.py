"""One log of one car: each view of it is computed here, once, when it is first asked for.

    log --> driving record --> brakings, slips, wheels, sensors       needs no vehicle
     |
     +--> known effects taken out --> signals --> blocks --> noise    what a fit and an estimate
                                         |          |                 start from
                                         |          +--> accelerometer, balance of forces
                                         +--> lead-in, delay of v, rolling radii, brake response

Without a vehicle there are the views of the first line, and signals and blocks as read.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import CHANNELS
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
from calib.run.axle_signals import Signals, causal_signals, rolling_radii, signals, wheels_held
from calib.run.blocks import Axle, Blocks, block_balance, blocks, braked_alone
from calib.run.brake_response import BrakeBalance, BrakeResponse, brake_balance, brake_response
from calib.run.driving_record import (
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
from calib.run.wheels import (
    Axles,
    Slipping,
    axles_of,
    slipping,
    slips_of,
)

if TYPE_CHECKING:
    from calib.run.known_effects import CorrectedRun
    from calib.run.resistance import Resistance


@dataclass(frozen=True, eq=False)
class Run:
    """A ``log`` as read, of a ``vehicle`` with known effects; ``causal``: signals of an ECU."""

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
    def moves(self) -> bool:
        """Whether ``a_x`` and all wheel speeds are there, which most views need."""
        return not set(self.missing) - {"p_mc"}

    @cached_property
    def clock(self) -> Sampling:
        """Samples, rate, jitter and gaps."""
        return sampling_of(self.log.time)

    @cached_property
    def sensors(self) -> tuple[Sensor, ...]:
        """One for each channel but ``time``."""
        return sensors_of(self.log, self.driving if self.moves else None)

    def sensor(self, channel: str) -> Sensor | None:
        """The sensor of a channel, or None."""
        return next((s for s in self.sensors if s.channel == channel), None)

    @cached_property
    def driving(self) -> DrivingRecord:
        """Smoothed speed, deceleration and pressure."""
        return driving_record(self.log)

    @cached_property
    def events(self) -> tuple[BrakeEvent, ...]:
        """Applications of the brake, by pressure, else by deceleration."""
        return brake_events(self.driving) if self.moves else ()

    @cached_property
    def rolling(self) -> Mask:
        """The lead-in (n,): steady rolling before the first braking, in which eta is zeroed."""
        if not self.moves or self.speed < MOVING:
            return np.zeros(self.log.time.size, bool)
        if "p_mc" in self.log:
            return self.signals.lead_in
        pressure = {"p_mc": np.where(self.driving.braked, 2.0 * BITE, 0.0)}
        return signals(replace(self.log, channels=self.log.channels | pressure)).lead_in

    @property
    def lead_in(self) -> float:
        """Length of the lead-in [s]."""
        return float(self.rolling.sum() * self.log.sample_time)

    @property
    def coasting(self) -> float:
        """All unbraked, steady and moving time [s]."""
        return float(self.driving.unbraked.sum() * self.driving.step) if self.moves else 0.0

    @property
    def speed(self) -> float:
        """Highest speed [m/s], approximate without ``v``."""
        return float(self.driving.speed.max()) if self.moves else 0.0

    @property
    def z(self) -> float:
        """Highest deceleration, in g [1]."""
        if not (self.moves and self.driving.moving.any()):
            return 0.0
        return float(self.driving.z[self.driving.moving].max())

    @cached_property
    def alone(self) -> Axle | None:
        """The axle that brakes alone by its pressures, or None."""
        return braked_alone(self.log) if self.moves else None

    @cached_property
    def pressures(self) -> dict[str, PressureDelay]:
        """Delay of the deceleration after each pressure, by channel."""
        if self.slipping is None or "p_mc" not in self.log:
            return {}
        return delays_of(self.log, self.driving, self.slipping.first)

    @cached_property
    def wheels_held(self) -> float:
        """Mean time for which a wheel speed holds a value while the car slows [s]."""
        return wheels_held(self.log) if self.moves else 0.0

    @cached_property
    def slips(self) -> dict[str, Array]:
        """Smoothed slip of each wheel [1] (n,)."""
        return slips_of(self.log, self.driving)

    @cached_property
    def slipping(self) -> Slipping | None:
        """Wheels at their limit."""
        return slipping(self.slips, self.driving) if self.moves else None

    @cached_property
    def axles(self) -> Axles | None:
        """Front against rear, left against right."""
        return axles_of(self.log, self.driving, self.slips) if self.moves else None

    @cached_property
    def wheels(self) -> WheelParts | None:
        """Change of the four slips by braking; None without rolling or braking, too."""
        return wheel_parts(self.log, self.driving) if self.moves else None

    # --- the car, its known effects taken out -----------------------------------------------------

    @cached_property
    def corrected(self) -> "CorrectedRun":
        """The run as the car without its known effects would have given it."""
        from calib.run.known_effects import remove_known_effects

        assert self.vehicle is not None, "this view needs a vehicle"
        return remove_known_effects(self.vehicle, self.log)

    @property
    def car(self) -> Vehicle:
        """The vehicle as driven, with those effects that take part in the balance of forces."""
        return self.corrected.vehicle

    @cached_property
    def signals(self) -> Signals:
        """Signals of the axles at the rate of the log; as read where no vehicle is known."""
        if self.vehicle is None:
            return signals(self.log)
        radius = self.car.rear.rolling_radius
        read = causal_signals if self.causal else signals
        return read(self.corrected.log, radius)

    @cached_property
    def blocks(self) -> Blocks:
        """Means of the signals over 50 ms."""
        return blocks(self.signals)

    @cached_property
    def noise(self) -> SensorNoise:
        """Noise of the sensors, from the whole run."""
        log = self.log if self.vehicle is None else self.corrected.log
        return sensor_noise(log, self.blocks)

    @cached_property
    def other_scale(self) -> float:
        """Scale of a_x against v [1] by a wrong unit, clock or filter; else 0."""
        return other_scale(self.blocks, self.noise.z, self.noise.v)

    @cached_property
    def lead_in_noise(self) -> SensorNoise:
        """Noise of the sensors, from the lead-in alone."""
        return lead_in_noise(self.corrected.log, self.signals)

    @cached_property
    def rolling_radii(self) -> tuple[float, float] | None:
        """Radii [m] of front and rear wheels on the lead-in; None without ``v`` or a lead-in."""
        return rolling_radii(self.signals)

    @cached_property
    def speed_evidence(self) -> SpeedEvidence:
        """What v shows of the accelerometer."""
        return speed_evidence(self.blocks, self.noise.z, self.noise.v)

    def accelerometer(
        self, resistance: "Resistance", noise: SensorNoise | None = None
    ) -> Accelerometer:
        """Scale and offset of the accelerometer with a known ``resistance``; `noise` by default."""
        b = self.blocks
        evidence = speed_evidence(b, noise.z, noise.v) if noise else self.speed_evidence
        unexplained = block_balance(self.car, resistance.effects, b).demanded / self.car.weight
        return accelerometer(evidence, unexplained, resistance.sigma_z(self.car, b.speed))

    def felt(self, sensor: Accelerometer | None) -> Blocks:
        """Blocks with z corrected by the accelerometer; as read without one."""
        b = self.blocks
        return b if sensor is None else replace(b, z=sensor.corrected(b.z))

    def balance(self, effects: Effects) -> BrakeBalance:
        """Forces of the run with nominal pads and the ``effects`` known of body and wheels."""
        return brake_balance(self.car, effects, self.signals)

    def response(self, effects: Effects) -> BrakeResponse | None:
        """Response of the brakes to the pressure; None if the run brakes too little."""
        return brake_response(self.signals, self.balance(effects))


def figures(run: Run) -> dict[str, float | None]:
    """Every figure of `batch check` in SI; None where the log gives none."""
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
