"""Figures of the channels: missing, stuck, copied, late, or out of the range of a car.

Each function is a figure of `rules.csv` by its name.
"""

from collections.abc import Iterator

import numpy as np

from calib.base.arrays import Mask
from calib.base.names import AXLES, WHEEL_SPEEDS
from calib.base.units import from_si
from calib.base.warning import Measured, bounds_of
from calib.car.braking import MOVING
from calib.plausibility.evidence import Evidence
from calib.run.axle_signals import held_time
from calib.run.copies import copied_pairs, shares_of_speed
from calib.run.driving_record import BITE_Z, DrivingRecord

_NEEDED = ("p_mc", "a_x", *WHEEL_SPEEDS)
_LATE = bounds_of("pressure_late")[1]
_RESISTED, _ROLLS = 0.04, 0.3
"""Largest deceleration of an unbraked car [g], and the time that shows it [s]."""
_CUT = 0.85  # share of zeros [1]: a noisy pressure sensor that is cut at 0 has 2/3
_PRESSED = 20e5  # pressure from which left and right sensor agree in proportion [Pa]
_BEYOND_CARS = {"v": "v_beyond_cars", "omega": "wheel_beyond_cars", "a": "a_x_beyond_cars"}


def channels(e: Evidence) -> Iterator[Measured]:
    """Channels that every log must have."""
    for name in e.run.missing:
        where = ", in bar, at the master cylinder" if name == "p_mc" else ""
        yield Measured("channel_missing", 1.0, words={"channel": name, "where": where})


def computed(e: Evidence) -> Iterator[Measured]:
    """Pressures that are another column of the log times a number."""
    for pressure in e.run.log.computed:
        yield Measured("pressure_derived", 1.0, words=pressure._asdict())


def marked(e: Evidence) -> Iterator[Measured]:
    """Impossible samples that the reader left out."""
    marked, count = e.run.log.marked, sum(one.count for one in e.run.log.marked)
    yield Measured("impossible_samples", count, words={"samples": "|".join(map(str, marked))})


def sensors(e: Evidence) -> Iterator[Measured]:
    """Ranges, stuck values, and time at the end of a range."""
    for sensor in e.run.sensors:
        name, words = sensor.channel, {"channel": sensor.channel}
        longest = max((end - start for start, end in sensor.stuck), default=0.0)
        if name == "v":
            yield Measured("v_stuck", longest)
        elif name in _NEEDED:
            times = ", ".join(f"{a:.2f} to {b:.2f} s" for a, b in sensor.stuck)
            yield Measured("stuck", longest, words={**words, "times": times})
            yield Measured("end_of_range", sensor.saturated, words=words)
        yield Measured("saturated", sensor.saturated, words=words)
        code = _BEYOND_CARS.get(name.split("_")[0])
        if code:
            yield Measured(code, max(sensor.high, sensor.low, key=abs), words=words)
        if name.startswith("p_"):
            yield Measured("pressure_high", from_si(sensor.high, "bar", "Pa"), words=words)
            yield Measured("pressure_low", from_si(sensor.low, "bar", "Pa"), words=words)


def pressure(e: Evidence) -> Iterator[Measured]:
    """Pressure per g, its clock, and, without a motor, the share of z that it explains."""
    run, master = e.run, e.run.sensor("p_mc")
    if master is None:
        return
    if run.z > 2.5 * BITE_Z:
        yield Measured("pressure_per_g", from_si(master.high / run.z, "bar", "Pa"))
    if not run.pressures:
        return
    delay, every = next(iter(run.pressures.values())), ", ".join(run.pressures)
    if master.saturated:
        return
    # on a ramp a zero that is too low looks like a delay; a correct zero has noise
    cut = master.low == 0.0 and master.flat > _CUT and delay.least < 0.0
    zero = "a zero of p_mc that is too low, so that it is cut at 0, or "
    how = f"{zero * cut}{every} {'are' if ',' in every else 'is'} {delay.words}"
    words = {"how": how, "entry": f"{delay.entry} to {every}"}
    yield Measured("pressure_late", delay.least, words=words)
    motors = any(name.startswith("T_drive") for name in run.present)
    if abs(delay.least) <= _LATE and not motors:
        explained = max(delay.explained_in_time, 0.0)
        yield Measured("pressure_foreign", explained, words={"channels": every})


def speed(e: Evidence) -> Iterator[Measured]:
    """Whether there is a reference speed."""
    yield Measured("no_reference_speed", float("v" not in e.run.present))


def copied(e: Evidence) -> Iterator[Measured]:
    """One signal in two channels."""
    log = e.run.log
    names = [name for name in (*WHEEL_SPEEDS, "v", "a_x", "p_mc") if name in log]
    for one, other, same in copied_pairs(log, names):
        yield Measured("same_signal", same, words={"one": one, "other": other})
    for source, share in shares_of_speed(log):
        yield Measured("a_x_of_speed", share, words={"source": source})


def held_values(e: Evidence) -> Iterator[Measured]:
    """Values that a bus or a receiver repeats."""
    yield Measured("v_held", held_time(e.run.log))
    yield Measured("wheels_held", e.run.wheels_held)


def late(e: Evidence) -> Iterator[Measured]:
    """A reference speed that comes late."""
    delay = e.run.signals.delay
    if delay.late:
        used = "v was put in time" if delay.sharp else "v is not used"
        yield Measured("v_late", delay.value, words={"used": used})


def at_rest(e: Evidence) -> Iterator[Measured]:
    """Pressure on the lead-in; without one, where a_x shows that no brake acts."""
    run = e.run
    if run.missing or run.speed < MOVING:
        return
    s = run.signals
    rolling = s.lead_in if s.lead_in.any() else _rolls_at_first(run.driving)
    if rolling.any():
        zero = max((float(np.mean(p[rolling])) for p in (s.p_f, s.p_r)), key=abs)
        yield Measured("pressure_zero", from_si(zero, "bar", "Pa"))


def _rolls_at_first(driving: DrivingRecord) -> Mask:
    """First half of the samples (n,) before the car brakes by a_x; none if it slows there."""
    unbraked = np.flatnonzero(np.cumsum(driving.z > BITE_Z) == 0)
    rolling = np.zeros(driving.z.size, bool)
    rolling[unbraked[: unbraked.size // 2]] = True  # in the second half a ramp may begin
    long = np.count_nonzero(rolling) * driving.step >= _ROLLS
    slows = long and float(np.mean(driving.z[rolling])) > _RESISTED
    return rolling & driving.moving & (long and not slows)


def pressure_sides(e: Evidence) -> Iterator[Measured]:
    """Highest pressures, left against right."""
    log = e.run.log
    for axle in AXLES:
        words = {"left": f"p_{axle}l", "right": f"p_{axle}r"}
        if set(words.values()) <= log.channels.keys():
            left, right = (float(np.max(log[name])) for name in words.values())
            apart = (left - right) / max(left, right, _PRESSED)
            yield Measured("pressure_sides", apart, words=words)


def from_master(e: Evidence) -> Iterator[Measured]:
    """Difference of wheel pressures from p_mc, rms over its mean; not if one axle brakes alone."""
    log, s = e.run.log, e.run.signals
    pressed = log["p_mc"] > _PRESSED / 2.0
    if e.run.alone is None and np.any(pressed):
        master = log["p_mc"][pressed]
        apart = {
            name: float(np.sqrt(np.mean((p[pressed] - master) ** 2)) / np.mean(master))
            for name, p in (("front", s.p_f), ("rear", s.p_r))
        }
        axle = max(apart, key=apart.__getitem__)
        yield Measured("wheel_pressures", apart[axle], words={"axle": axle})
