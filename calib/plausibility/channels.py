"""Figures of the channels: missing, stuck, copied, late, or out of the range of a car.

The column `figure` of `rules.csv` names the public function here that measures a rule.
"""

from collections.abc import Iterator

import numpy as np

from calib.base.arrays import Mask
from calib.base.names import AXLES, WHEEL_SPEEDS
from calib.base.units import from_si
from calib.base.warning import Measured, bounds_of
from calib.car.braking import MOVING
from calib.logs.impossible import FEW
from calib.plausibility.evidence import Evidence
from calib.run.axle_signals import held_time
from calib.run.copies import copied_pairs, shares_of_speed
from calib.run.driving_record import BITE_Z, DrivingRecord

_NEEDED = ("p_mc", "a_x", *WHEEL_SPEEDS)
_IN_TIME = bounds_of("pressure_late")[1]  # largest delay of a pressure that is in time [s]
_UNBRAKED, _ROLLED = 0.04, 0.3  # largest deceleration without a brake [g], time of it needed [s]
_CUT = 0.85
"""Share of unbraked samples at exactly 0 above which the zero of p_mc is too low; noise about a
right zero, cut at 0, gives 2/3."""
_PRESSED = 20e5  # pressure from which left and right sensor agree in proportion [Pa]
_BEYOND_CARS = {"v": "v_beyond_cars", "omega": "wheel_beyond_cars", "a": "a_x_beyond_cars"}
"""Code of a value that no car reaches, by the first part of the channel's name."""


def channels(evidence: Evidence) -> Iterator[Measured]:
    """Channels that every log must have."""
    for name in evidence.run.missing:
        where = ", in bar, at the master cylinder" if name == "p_mc" else ""
        yield Measured("channel_missing", 1.0, words={"channel": name, "where": where})


def computed(evidence: Evidence) -> Iterator[Measured]:
    """Pressures that are another column of the log times a number."""
    for pressure in evidence.run.log.computed:
        yield Measured("pressure_derived", 1.0, words=pressure._asdict())


def impossible_samples(evidence: Evidence) -> Iterator[Measured]:
    """Impossible samples that the reader left out."""
    marked = evidence.run.log.marked
    count, texts = sum(samples.count for samples in marked), "|".join(map(str, marked))
    yield Measured("impossible_samples", count, words={"samples": texts})


def sensors(evidence: Evidence) -> Iterator[Measured]:
    """Ranges, stuck values, and time at the end of a range."""
    for sensor in evidence.run.sensors:
        name, words = sensor.channel, {"channel": sensor.channel}
        longest = max((end - start for start, end in sensor.stuck), default=0.0)
        if name == "v":
            yield Measured("v_stuck", longest)
        elif name in _NEEDED:
            times = ", ".join(f"{start:.2f} to {end:.2f} s" for start, end in sensor.stuck)
            yield Measured("stuck", longest, words={**words, "times": times})
            yield Measured("end_of_range", sensor.saturated, words=words)  # refuses a fit
        yield Measured("saturated", sensor.saturated, words=words)
        code = _BEYOND_CARS.get(name.partition("_")[0])
        if code is not None:
            # a few samples beyond are a glitch; more are a wrong unit or decoding
            largest = float(np.quantile(np.abs(evidence.run.log[name]), 1.0 - FEW))
            yield Measured(code, largest, words=words)
        if name.startswith("p_"):
            yield Measured("pressure_high", from_si(sensor.high, "bar", "Pa"), words=words)
            yield Measured("pressure_low", from_si(sensor.low, "bar", "Pa"), words=words)


def pressure(evidence: Evidence) -> Iterator[Measured]:
    """Pressure per g, its clock, and, without a motor, the share of z that it explains."""
    run, master = evidence.run, evidence.run.sensor("p_mc")
    if master is None:
        return
    if run.z > 2.5 * BITE_Z:
        yield Measured("pressure_per_g", from_si(master.high / run.z, "bar", "Pa"))
    if not run.pressures or master.saturated:
        return
    delay, names = next(iter(run.pressures.values())), ", ".join(run.pressures)  # one delay for all
    cause = f"{names} {'are' if len(run.pressures) > 1 else 'is'} {delay.words}"
    # on a ramp a zero that is too low looks like a delay
    if master.low == 0.0 and master.flat > _CUT and delay.nearest_to_zero < 0.0:
        cause = f"a zero of p_mc that is too low, so that it is cut at 0, or {cause}"
    words = {"how": cause, "entry": f"{delay.entry} to {names}"}
    yield Measured("pressure_late", delay.nearest_to_zero, words=words)
    has_motor = any(name.startswith("T_drive") for name in run.present)
    if abs(delay.nearest_to_zero) <= _IN_TIME and not has_motor:
        explained = max(delay.explained_in_time, 0.0)
        yield Measured("pressure_foreign", explained, words={"channels": names})


def reference_speed(evidence: Evidence) -> Iterator[Measured]:
    """Whether there is a reference speed."""
    yield Measured("no_reference_speed", float("v" not in evidence.run.present))


def copied(evidence: Evidence) -> Iterator[Measured]:
    """The same signal in two channels; a_x as the derivative of a speed."""
    log = evidence.run.log
    names = [name for name in (*WHEEL_SPEEDS, "v", "a_x", "p_mc") if name in log]
    for channel, copy, correlation in copied_pairs(log, names):
        yield Measured("same_signal", correlation, words={"one": channel, "other": copy})
    for source, share in shares_of_speed(log):
        yield Measured("a_x_of_speed", share, words={"source": source})


def held_values(evidence: Evidence) -> Iterator[Measured]:
    """Values that a bus or a receiver repeats."""
    yield Measured("v_held", held_time(evidence.run.log))
    yield Measured("wheels_held", evidence.run.wheels_held)


def delay_of_v(evidence: Evidence) -> Iterator[Measured]:
    """Delay of the reference speed, if it is late."""
    delay = evidence.run.signals.delay
    if delay.late:
        used = "v was put in time" if delay.sharp else "v is not used"
        yield Measured("v_late", delay.value, words={"used": used})


def zero_of_pressure(evidence: Evidence) -> Iterator[Measured]:
    """Pressure on the lead-in, else where a_x shows that no brake acts."""
    run = evidence.run
    if run.missing or run.speed < MOVING:
        return
    s = run.signals
    rolling = s.lead_in if s.lead_in.any() else _unbraked_by_a_x(run.driving)
    if rolling.any():
        zero = max((float(np.mean(p[rolling])) for p in (s.p_f, s.p_r)), key=abs)
        yield Measured("pressure_zero", from_si(zero, "bar", "Pa"))


def _unbraked_by_a_x(driving: DrivingRecord) -> Mask:
    """Mask (n,) of the first half of the time until a_x shows a braking; none if the car slows."""
    # a ramp may begin in the second half
    half = np.count_nonzero(np.cumsum(driving.z > BITE_Z) == 0) // 2
    rolling = np.zeros_like(driving.moving)
    if half * driving.step >= _ROLLED and np.mean(driving.z[:half]) <= _UNBRAKED:
        rolling[:half] = driving.moving[:half]
    return rolling


def pressure_sides(evidence: Evidence) -> Iterator[Measured]:
    """Highest pressure left less right, over the higher one [1]."""
    log = evidence.run.log
    for axle in AXLES:
        words = {"left": f"p_{axle}l", "right": f"p_{axle}r"}
        if set(words.values()) <= log.channels.keys():
            left, right = (float(np.max(log[name])) for name in words.values())
            difference = (left - right) / max(left, right, _PRESSED)
            yield Measured("pressure_sides", difference, words=words)


def from_master(evidence: Evidence) -> Iterator[Measured]:
    """Rms of wheel pressures less p_mc, over the mean of p_mc; not if one axle brakes alone."""
    log, s = evidence.run.log, evidence.run.signals
    pressed = log["p_mc"] > _PRESSED / 2.0
    if evidence.run.alone is None and np.any(pressed):
        master, differences = log["p_mc"][pressed], []
        for axle, p in (("front", s.p_f), ("rear", s.p_r)):
            rms = float(np.sqrt(np.mean((p[pressed] - master) ** 2)) / np.mean(master))
            differences.append((rms, axle))
        rms, axle = max(differences, key=lambda difference: difference[0])
        yield Measured("wheel_pressures", rms, words={"axle": axle})
