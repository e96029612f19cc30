"""Rules for the use of a log; each reason says what to drive or correct."""

import math
from collections.abc import Iterator
from itertools import groupby, permutations

from calib.base.names import AXLE_NAMES, WHEELS
from calib.run.driving_record import BITE_Z, NOMINAL_RADIUS, BrakeEvent
from calib.run.limits import LIMITS
from calib.run.run import Run
from calib.run.wheels import CORRECT, crossed_side

PURPOSES = ("fit", "validate", "coast", "diagnose")
"""What a log may serve for; "coast": a fit, in addition to its ramps."""

_OMEGAS = tuple(f"omega_{wheel}" for wheel in WHEELS)
_GREATEST = {"v": 110.0, "omega": 400.0}  # [SI] above the values of any road car

_SPEEDS = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}  # taken for each other [m/s]

_UNIT_KNOWN = 0.16
"""Largest distance (logarithm) from the factor between two units at which they are named: half of
that between the closest two, 1.61 and 2.24."""


def problems(seen: Run, purpose: str) -> list[str]:
    """Reasons why a log is not usable for one of `PURPOSES`, each with what to do.

    Or for "search": reasons why its channels are too wrong to be searched for effects.
    """
    basic = list(_unusable(seen, purpose))
    more = () if seen.missing else _RULES[purpose](seen)
    return list(dict.fromkeys([*basic, *more]))


def _unusable(seen: Run, purpose: str) -> Iterator[str]:
    """For every purpose."""
    for name in seen.missing:
        where = ", in bar, at the master cylinder" if name == "p_mc" else ""
        yield f"{name} is missing: record it{where}"
    if not LIMITS.rates[0] <= seen.clock.rate <= LIMITS.rates[1]:
        yield f"the clock runs at {seen.clock.rate:.4g} Hz: record at 40 Hz to 1 kHz, best 200 Hz"
    if set(seen.missing) - {"p_mc"}:
        return
    if seen.speed < 3.0:
        yield f"the car is too slow ({seen.speed:.1f} m/s at most): drive at 30 km/h or more"
    for sensor in seen.sensors:
        if sensor.stuck and sensor.channel in ("a_x", "p_mc", *_OMEGAS):
            times = ", ".join(f"{a:.2f} to {b:.2f} s" for a, b in sensor.stuck)
            what = f"{sensor.channel} does not change from {times} while others do"
            yield f"{what}: repair the sensor and drive again"
        highest = max(sensor.high, -sensor.low)
        if highest > _GREATEST.get(sensor.channel.split("_")[0], math.inf):
            what = f"{sensor.channel} reaches {highest:.4g}; no road car does"
            yield f"{what}: repair the sensor, or correct its unit in the channel map"
    for rule in (_wrong_a_x, _wrong_v, _wrong_pressure):
        yield from rule(seen)
    searched = purpose in ("diagnose", "search")
    yield from _foreign_pressure(
        seen, LIMITS.pressure_searched if searched else LIMITS.pressure_late
    )
    crossed = crossed_side(seen.wheels, seen.alone)
    if crossed is not None:
        yield f"{crossed}: {CORRECT}, or look for a brake circuit without pressure"


def _wrong_a_x(seen: Run) -> Iterator[str]:
    slope = seen.axles.slope if seen.axles else None
    if slope is None:
        return
    if slope < 0:
        what = "a_x is positive while the wheels slow down"
        yield f"{what}: reverse its sign in a channel map (sign = -1); forward is positive"
    if not _between(abs(slope), LIMITS.wheel_radius):
        what = f"a_x and the wheel speeds make wheels of a radius of {abs(slope):.3g} m"
        yield f"{what}: check the unit of both (g or m/s^2, rad/s or rpm)"


def _wrong_v(seen: Run) -> Iterator[str]:
    """A ``v`` in another unit than it says: it makes wheels that no car has, or that a_x denies."""
    if seen.axles is None or seen.axles.radius is None:
        return
    radius, by_a_x = seen.axles.radius, seen.axles.slope or 0.0
    known = _between(by_a_x, LIMITS.tyre_radius)
    agree = not known or _between(radius / by_a_x, (1.0 / LIMITS.radii_agree, LIMITS.radii_agree))
    if agree and _between(radius, LIMITS.tyre_radius):
        return
    low, high = LIMITS.tyre_radius
    against = f", and a_x one of {by_a_x:.3g} m" if known else ""
    what = f"v and the wheel speeds make a rolling radius of {radius:.3g} m{against}"
    do = _right_unit(radius / (by_a_x if known else NOMINAL_RADIUS))
    yield f"{what}; tyres have {low:g} to {high:g} m: {do}"


def _right_unit(factor: float) -> str:
    """What to do about a ``v`` that is ``factor`` times too large [1]."""
    for unit, read_as in permutations(_SPEEDS, 2):
        if factor > 0.0 and abs(math.log(factor * _SPEEDS[unit] / _SPEEDS[read_as])) < _UNIT_KNOWN:
            return f"v is in {unit} and was read as {read_as}; correct its unit"
    return "check the units of v and of the wheel speeds (rad/s or rpm)"


def _between(x: float, ends: tuple[float, float]) -> bool:
    return ends[0] <= x <= ends[1]


def _wrong_pressure(seen: Run) -> Iterator[str]:
    for sensor in seen.sensors:
        name, low, high = sensor.channel, sensor.low / 1e5, sensor.high / 1e5
        if not name.startswith("p_"):
            continue
        if sensor.high > LIMITS.pressure:
            yield f"{name} reaches {high:.0f} bar: check its unit"
        if sensor.low < -3e5:
            yield f"{name} falls to {low:.1f} bar: check its zero and its sign"
        if sensor.low > LIMITS.never_free:
            yield f"{name} never falls below {low:.1f} bar: check its zero with the pedal released"
    master = seen.sensor("p_mc")
    if master and seen.z > 2.5 * BITE_Z and master.high < LIMITS.softest * seen.z:
        what = f"p_mc takes {master.high / 1e5 / seen.z:.1f} bar for each g"
        least = f"no car less than {LIMITS.softest / 1e5:g}"
        yield f"{what}, and {least}: check its unit (bar or MPa) and its scale"


def _foreign_pressure(seen: Run, late: float) -> Iterator[str]:
    """A pressure of another run, or of a clock that is off by more than ``late`` [s].

    Nothing is said of how much the pressure explains where a motor brakes as well.
    """
    master = seen.sensor("p_mc")
    if master and master.saturated:
        return
    motor = any(name.startswith("T_drive") for name in seen.present)
    off = {name: delay for name, delay in seen.pressures.items() if delay.beyond(late)}
    if off:
        alike = groupby(off.items(), key=lambda item: (item[1].words, item[1].entry))
        told = [(", ".join(name for name, _ in items), *words) for words, items in alike]
        which = "; ".join(f"{names} {'are' if ',' in names else 'is'} {x}" for names, x, _ in told)
        entries = ", ".join(f"{entry} to {names}" for names, _, entry in told)
        yield (
            f"{which} against the deceleration, and brakes make {late:g} s at most: look for a "
            "pressure of another run, log the torque T_drive of a motor that brakes first, record "
            f"all channels on one clock, or give {entries} in a channel map"
        )
        return
    weak = {x: d.in_time for x, d in seen.pressures.items() if d.in_time < LIMITS.explained}
    if weak and not motor:
        yield (
            f"{', '.join(weak)}: the deceleration is explained to "
            f"{100 * max(*weak.values(), 0.0):.0f} %, and to {100 * LIMITS.explained:.0f} % or "
            "more by that of the same run: look for a pressure of another run, and log the torque "
            "T_drive of a motor that brakes"
        )


def _not_for_fit(seen: Run) -> Iterator[str]:
    if not seen.events:
        yield "no braking: drive a slow pressure ramp of 3 to 8 s; use a coast log only in addition"
        return
    yield from _short_lead_in(seen, LIMITS.lead_in_fit, "ramp")
    span = LIMITS.one_axle_z if seen.alone else LIMITS.ramp_z
    good = [e for e in seen.events if e.braking >= LIMITS.ramp_time and e.rise >= LIMITS.ramp_rise]
    ramp = max(good, key=lambda e: e.rise_z, default=None)
    if ramp is None or ramp.rise_z < span:
        yield _no_ramp(max(seen.events, key=lambda e: e.rise_z), span)
        ramp = max(seen.events, key=lambda e: e.braking)
    yield from _disturbed(seen, ramp)
    if seen.wheels_held > LIMITS.wheels_held_fit:
        held = f"{seen.wheels_held:.2f} s, and may for {LIMITS.wheels_held_fit:g} s"
        yield f"the wheel speeds keep a value for {held}: log them at 100 Hz or more"
    yield from _blurred_eta(seen)


def _short_lead_in(seen: Run, least: float, braking: str) -> Iterator[str]:
    if seen.lead_in < least:
        do = f"roll for a second before the {braking}, with no engine or motor that brakes"
        yield f"{seen.lead_in:.2f} s of steady rolling at the start: {do}"


def _no_ramp(event: BrakeEvent, span: float) -> str:
    """Why the widest rise is no ramp: it must rise steadily, for long enough, by ``span`` [g]."""
    if event.rise < LIMITS.ramp_rise:
        do = "press slowly, over 3 to 8 s, so that every level is covered"
        return f"the brake is applied within {event.rise:.1f} s: {do}"
    if event.braking < LIMITS.ramp_time:
        do = f"brake for {LIMITS.ramp_time:g} s or more, from a higher speed"
        return f"{event.braking:.1f} s of braking above 3 m/s: {do}"
    if event.z_high - event.z_low > span + 0.1:
        longest = f"the longest one spans {event.rise_z:.2f} g in {event.rise:.1f} s"
        what = f"the braking reaches {event.z_high:.2f} g, but not in one rise: {longest}"
        return f"{what}; press steadily, and do not let the pedal go in between"
    return f"the ramp spans {event.rise_z:.2f} g: brake up to {span + 0.1:.2f} g, without ABS"


def _blurred_eta(seen: Run) -> Iterator[str]:
    """A table is a curve over eta: its change under braking must be known to half of itself."""
    most = seen.axles.eta_most if seen.axles else None
    if most is None or most.half < 0.5 * abs(most.value):
        return
    what = f"eta changes by {100 * abs(most.value):.3f} % under braking, +- {100 * most.half:.3f} %"
    if max(abs(most.value), most.half) < LIMITS.eta_alike:
        yield (
            f"{what}: both axles slip alike, and nothing tells front from rear; look for wheel "
            "speeds in the wrong columns; else the brakes are so near to the ideal balance that "
            "this car can have no table"
        )
    else:
        yield f"{what}: too little is known; log the wheel speeds finer and faster, or coast longer"


def _disturbed(seen: Run, ramp: BrakeEvent) -> Iterator[str]:
    slips = seen.slipping
    if slips and any(ramp.start <= t <= ramp.end for _, t in slips.cycles):
        when = min(t for _, t in slips.cycles if t >= ramp.start)
        yield f"ABS works from {when:.2f} s on: end the ramp earlier, or use a road with more grip"
    if slips and slips.locked:
        yield f"wheel {', '.join(slips.locked)} locks: end the ramp earlier"
    for sensor in seen.sensors:
        if sensor.saturated and sensor.channel in ("p_mc", "a_x", *_OMEGAS):
            what = f"{sensor.channel} is at the end of its range for {sensor.saturated:.2f} s"
            yield f"{what}: widen the range"
    for when, length in seen.clock.gaps:
        if length > LIMITS.hole and ramp.start <= when <= ramp.end:
            yield f"{length:.2f} s are missing from {when:.2f} s on, within the ramp: drive again"


def _not_for_validate(seen: Run) -> Iterator[str]:
    if not seen.events:
        yield "no braking: drive a stop from 50 km/h or more"
        return
    if seen.events[0].first == 0:
        yield from _short_lead_in(seen, LIMITS.lead_in_good, "stop")
    braking = sum(event.braking for event in seen.events)
    locked = seen.slipping is not None and seen.slipping.locked
    if braking < LIMITS.braking and not locked:  # of locked wheels the speed is not known
        yield f"{braking:.1f} s of braking above 3 m/s: brake for {LIMITS.braking:g} s or more"


def _not_for_coast(seen: Run) -> Iterator[str]:
    if seen.events:
        yield "the brake is applied: a coast log has no braking"
    elif seen.coasting < LIMITS.coasting:
        yield f"only {seen.coasting:.1f} s of coasting: coast for {LIMITS.coasting:g} s or more"


def _without_speed(seen: Run) -> Iterator[str]:
    why = "wheel speeds alone cannot tell slip from speed"
    if "v" not in seen.present:
        yield f"no reference speed v: log it, {why}"
    if seen.v_of_wheels:
        yield f"v is made of the wheel speeds: log the speed over ground of another sensor, {why}"


def _not_for_diagnose(seen: Run) -> Iterator[str]:
    yield from _without_speed(seen)
    if seen.events:
        yield from _not_for_validate(seen)
        yield from _short_lead_in(seen, LIMITS.lead_in_diagnose, "stop")
    else:
        yield from (f"no braking, and {short}, or drive a stop" for short in _not_for_coast(seen))


_RULES = {
    "fit": _not_for_fit,
    "validate": _not_for_validate,
    "coast": _not_for_coast,
    "diagnose": _not_for_diagnose,
    "search": _without_speed,
}


def uses(seen: Run) -> Iterator[str]:
    """What can be determined from a log, with its accuracy, in words."""
    axles = seen.axles
    if axles is None:
        return
    zero = axles.front_rear
    if zero is not None:
        enough = "fine" if zero.half <= LIMITS.table_zero else "too coarse"
        sharp = f"to {100 * zero.half:.3f} % ({enough} for a table)"
        yield f"the zero of eta {sharp}, if the car rolled without its engine"
    if axles.slope is not None and axles.slope > 0:
        yield f"sign and size of a_x: with the wheels it makes a radius of {axles.slope:.2f} m"
    logged = [name for name in ("T_drive_f", "T_drive_r") if name in seen.present]
    if logged:
        yield f"brake forces less the torque of engine or motor: {', '.join(logged)}"
    if seen.alone:
        what = f"the {AXLE_NAMES[seen.alone]} tyres' stiffness, and the pads' ratio"
        yield f"{what}, in a fit with a ramp of both axles: the other axle has no pressure"
    if seen.events and "p_mc" in seen.missing:
        yield f"deceleration and slip of {len(seen.events)} braking(s); without pressure no torque"
