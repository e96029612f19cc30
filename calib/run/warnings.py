"""Warnings on a usable log, before any vehicle file is known; their words are in `warnings.csv`."""

import math
from collections.abc import Iterator

from calib.base.warning import PlausibilityWarning, warning
from calib.logs.log import Log
from calib.run.limits import LIMITS
from calib.run.run import Run


def warnings_of(name: str, seen: Run) -> tuple[PlausibilityWarning, ...]:
    """Warnings on the log ``name``."""
    rules = (
        _clock, clock_gaps, _lead_in, _radii, swapped_axles, _abs, locked_wheels, _speed, saturated,
        _wheel_speeds, _pressure, _pressure_clock,
    )  # fmt: skip
    return tuple(warning for rule in rules for warning in rule(name, seen))


def impossible_samples(log: Log) -> Iterator[PlausibilityWarning]:
    """Samples that no car drives and that the reader left out."""
    if log.marked:
        yield PlausibilityWarning(
            "impossible_samples", log.name, sum(one.count for one in log.marked), (0.0, 0.0),
            tuple(str(one) for one in log.marked),
            "they are not used; decode the error value of a signal as no value",
        )  # fmt: skip


def _clock(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    clock = seen.clock
    if clock.rate < LIMITS.slow_rate:
        yield warning("clock_rate", log, clock.rate, (LIMITS.slow_rate, None))
    if clock.jitter * clock.rate > LIMITS.jitter:
        yield warning("clock_jitter", log, clock.jitter * clock.rate, (0.0, LIMITS.jitter))


def clock_gaps(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    """Samples that are missing: what is computed between their neighbours is no measurement."""
    gaps = seen.clock.gaps
    if gaps:
        when, length = max(gaps, key=lambda gap: gap[1])
        yield warning("clock_gaps", log, length, when=when, count=len(gaps))


def _lead_in(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    if seen.events and seen.lead_in < LIMITS.lead_in_good:
        yield warning("lead_in", log, seen.lead_in, (LIMITS.lead_in_good, None))
    if seen.lead_in_driven:
        yield warning("lead_in_driven", log, 1.0)
    if seen.standing > 0.0:
        yield warning("standing", log, seen.standing)


def _radii(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    axles = seen.axles
    if axles is None:
        return
    eta = axles.front_rear
    if eta is None:
        yield warning("eta_zero_unknown", log, 1.0)
    else:
        if abs(eta.value) > max(LIMITS.tyres, eta.half):  # tyres that are worn unlike are zeroed
            yield warning("eta_zero", log, eta.value, (-LIMITS.tyres, LIMITS.tyres))
        if eta.half > LIMITS.zero:
            yield warning("eta_zero_uncertain", log, eta.half, (0.0, LIMITS.zero))
    for axle, sides in (("f", axles.left_right_f), ("r", axles.left_right_r)):
        if sides is not None and abs(sides.value) > max(LIMITS.sides, sides.half):
            yield warning(f"sides_{axle}", log, sides.value, (-LIMITS.sides, LIMITS.sides))


def swapped_axles(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    """Eta that goes the wrong way while braking."""
    eta = seen.axles.eta_braked if seen.axles else None
    if eta is None:
        return
    more, less, sign = ("rear", "front", -1.0) if seen.alone == "r" else ("front", "rear", 1.0)
    if sign * eta.value < -max(LIMITS.zero, eta.half):
        expected = (-LIMITS.zero, None) if sign > 0.0 else (None, LIMITS.zero)
        yield warning("axles_swapped", log, eta.value, expected, more=more, less=less, axle=less[0])


def _abs(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    cycles = seen.slipping.cycles if seen.slipping else ()
    if cycles:
        wheels = ", ".join(dict.fromkeys(wheel for wheel, _ in cycles))
        yield warning("abs", log, len(cycles), wheels=wheels, when=cycles[0][1])


def locked_wheels(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    """Wheels that lock: what they say after it is no speed of the car."""
    locked = seen.slipping.locked if seen.slipping else ()
    if locked:
        yield warning("locked_wheels", log, len(locked), wheels=", ".join(locked))


def _speed(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    v = seen.sensor("v")
    if v is None:
        yield warning("no_reference_speed", log, 1.0)
    elif v.stuck:
        yield warning("v_stuck", log, max(end - start for start, end in v.stuck))


def saturated(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    """Channels that stay at the end of their range."""
    for sensor in seen.sensors:
        if sensor.saturated:
            yield warning("saturated", log, sensor.saturated, channel=sensor.channel)


def _wheel_speeds(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    """The standard deviation of eta in a mean over 0.2 s, from the wheels' noise and steps [1].

    Two wheels make an axle and two axles make eta: the factors cancel.
    """
    noise = [
        math.hypot(s.noise, s.resolution / math.sqrt(12.0)) / s.high
        for s in seen.sensors
        if s.channel.startswith("omega") and s.high > 0 and not math.isnan(s.noise)
    ]
    blur = max(noise, default=0.0) / math.sqrt(max(1.0, 0.2 * seen.clock.rate))
    if blur > LIMITS.zero:
        yield warning("coarse_wheel_speeds", log, blur, (0.0, LIMITS.zero))


def _pressure(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    pressure, a_x = seen.sensor("p_mc"), seen.sensor("a_x")
    if pressure is None or a_x is None or not seen.events:
        return
    if pressure.flat > LIMITS.flat and pressure.low == 0.0 and a_x.noise > 0.01:
        yield warning("pressure_computed", log, pressure.flat, (0.0, LIMITS.flat))
    if seen.z > 0.1 and pressure.high / seen.z > LIMITS.stiff:
        per_g = pressure.high / seen.z / 1e5
        yield warning("pressure_per_g", log, per_g, (0.0, LIMITS.stiff / 1e5))


def _pressure_clock(log: str, seen: Run) -> Iterator[PlausibilityWarning]:
    """A pressure that may be off by far more than brakes are, or not: the log does not tell."""
    late = LIMITS.pressure_searched
    for channel, delay in seen.pressures.items():
        most = max(delay.low, delay.high, key=abs)
        if abs(most) > late and not delay.beyond(LIMITS.pressure_late):
            yield warning("pressure_clock", log, most, (-late, late), channel=channel)
