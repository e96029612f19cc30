"""Find the columns for the car's speed, acceleration and pressure, and those by name alone."""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.base.units import BAR
from calib.base.warning import bounds_of
from calib.logs.channel_map import Mapping
from calib.logs.computed import factor_between, is_other_quantity
from calib.run.pressure_delay import pressure_delay
from calib.suggest.columns import ColumnClock, Search, Series, correlation, follows
from calib.suggest.words import axle, corner, has_word, score

_FOLLOWS = 0.8  # lowest correlation [1] of two signals that belong together
_ACCELERATED = 0.5
"""Smallest range of the derivative of speed [m/s^2] to check an acceleration with."""
_PRESSED = 2e5  # smallest range of a brake pressure [Pa] in a log with braking
_SLOPES = (0.4, 2.5)
"""Allowed a_x over the derivative of speed [1]: g in the place of m/s^2 is a factor of 9.8."""
_WITH_WHEELS = 0.98  # lowest correlation [1] of the speed of the car with that of its wheels
_NAMED = 99  # score of a column that has the name of the channel


def _choose(
    search: Search, channel: str, passed: list[tuple[Series, int]], several: str
) -> Series | None:
    """The column of the highest rates whose name fits best; of several equals a doubt, and None."""
    named = [s for s, _ in passed if s.name == channel]
    measured = [s for s, points in passed if points > 0 and not has_word(s.name, "derived")]
    top = 0.0 if named else max((s.rate or 0.0 for s in measured), default=0.0)
    fast = [(s, points) for s, points in passed if 2.0 * (s.rate or 0.0) >= top]
    most = max((points for _, points in fast), default=0)
    likeliest = named or [s for s, points in fast if points == most]
    if len(likeliest) > 1:
        search.doubt(channel, likeliest, several, f"choose one: --take {channel}=NAME")
    if len(likeliest) != 1:
        return None
    for item, _ in passed:
        if item is not likeliest[0]:
            search.refuse(item, f"{likeliest[0].name} is more likely {channel}")
    return likeliest[0]


def find_speed(search: Search, wheels: Array | None) -> Array | None:
    """The values [m/s] of a speed by name and unit that agrees with the wheels."""
    moves = wheels is not None and bool(np.ptp(wheels))
    passed = []
    for item in search.free():
        if item.si != "m/s" or corner(item.name):
            continue
        points = _NAMED if item.name == "v" else score(item.name, "speed")
        if points < 1:
            search.refuse(item, "a speed, but not of the car, by its name")
        elif wheels is not None and moves and correlation(item.values, wheels) < _WITH_WHEELS:
            search.refuse(item, "a speed that does not agree with the wheels")
        else:
            passed.append((item, points))
    chosen = _choose(search, "v", passed, "more than one speed of the car")
    if "v" in search.user_specified:
        return search.values_of_user("v")
    if chosen is not None:
        reasons = ["name", f"unit {chosen.column.unit}", *(["agrees with the wheels"] * moves)]
        search.propose("v", Mapping(chosen.name), moves, *reasons)
    return None if chosen is None else chosen.values


def find_acceleration(search: Search, rate: Array | None, clock: ColumnClock) -> None:
    """Find a_x by its unit, and as the derivative of speed ``rate`` [m/s^2] (n,) up to its sign."""
    checked = rate if rate is not None and float(np.ptp(rate)) > _ACCELERATED else None
    passed = []
    for item in search.free():
        if item.si != "m/s^2":
            continue
        points = _NAMED if item.name == "a_x" else score(item.name, "longitudinal")
        if points < 0:
            search.refuse(item, "an acceleration, but not longitudinal, by its name")
        elif checked is not None and abs(follows(item.values, checked, clock)) < _FOLLOWS:
            search.refuse(item, "an acceleration that is not the derivative of speed")
        elif checked is None and points < 1:
            search.refuse(item, "an acceleration, not known to be longitudinal")
        else:
            passed.append((item, points))
    chosen = _choose(search, "a_x", passed, "more than one longitudinal acceleration")
    if chosen is None:
        return
    named = chosen.name == "a_x" or score(chosen.name, "longitudinal") > 0
    reasons = ["name"] * named + [f"unit {chosen.column.unit}"]
    if checked is None:
        sign = -1 if has_word(chosen.name, "deceleration") else 1
        reasons.append("the speed changes too slowly, or is not known, to check its sign with")
    else:
        ratio = np.cov(clock.smooth(chosen.values), checked)[0, 1] / np.var(checked, ddof=1)
        if not _SLOPES[0] <= abs(ratio) <= _SLOPES[1]:
            why = f"in {chosen.column.unit} it is {abs(ratio):.3g} times the derivative of speed"
            search.doubt("a_x", [chosen], why, "give its unit: --take 'a_x=NAME [UNIT]'")
            return
        agrees = follows(chosen.values, checked, clock)
        sign = 1 if agrees > 0 else -1
        reasons.append(f"is the derivative of speed (correlation {abs(agrees):.2f})")
    reasons += ["positive when the car slows down: sign reversed"] * (sign < 0)
    search.propose("a_x", Mapping(chosen.name, sign=sign), named and checked is not None, *reasons)


def refuse_computed(search: Search) -> None:
    """Refuse pressures that are a column of another quantity times a number."""
    others = [s for s in search.series if is_other_quantity(s.column.unit)]
    for item in search.free():
        for other in others if item.si == "Pa" else []:
            if factor_between(item.values, other.values) is not None:
                origin = f"{other.name} [{other.column.unit}]"
                search.unused[item.name] = f"computed: a fixed number times {origin}"


def find_pressure(search: Search, braking: Array | None, clock: ColumnClock) -> None:
    """Find p_mc by its unit; it follows the deceleration ``braking`` [m/s^2] (n,) without delay.

    A column without a unit is a doubt if it is named a brake pressure: it could be a torque.
    """
    checked = braking if braking is not None and np.ptp(braking) >= _ACCELERATED else None
    passed, unnamed = [], []
    for item in search.free():
        points = _NAMED if item.name == "p_mc" else _brake_score(item.name)
        if corner(item.name) or points < 0:
            continue
        if item.si is None and points >= 2 and has_word(item.name, "pressure"):
            unnamed.append(item)
        elif item.si == "N*m" and points >= 1:
            search.refuse(item, "a torque, not a pressure")
        elif item.si == "Pa":
            if reason := _no_brake(item, points, checked, clock):
                search.refuse(item, reason)
            else:
                passed.append((item, points))
    doubts_before_it = len(search.doubts)
    chosen = _choose(search, "p_mc", passed, "more than one brake pressure")
    if chosen is None:
        if unnamed and len(search.doubts) == doubts_before_it:
            why = "named a brake pressure, but it has no unit that is known"
            search.doubt("p_mc", unnamed, why, "give its unit: --take 'p_mc=NAME [bar]'")
        return
    named = chosen.name == "p_mc" or _brake_score(chosen.name) > 0
    reasons = ["name"] * named + [f"unit {chosen.column.unit}"]
    is_checked = checked is not None and bool(np.ptp(chosen.values) > _PRESSED)
    if checked is not None and is_checked:
        agrees = follows(chosen.values, checked, clock)
        reasons.append(f"goes with the deceleration (correlation {agrees:.2f})")
    else:
        reasons.append("no braking is known to check it with")
    search.propose("p_mc", Mapping(chosen.name), named and is_checked, *reasons)


def _brake_score(name: str) -> int:
    return score(name, "brake") + max(0, 2 * score(name, "master"))


def _no_brake(item: Series, points: int, checked: Array | None, clock: ColumnClock) -> str | None:
    """Why a pressure cannot be that of the brake; None if it can."""
    if item.values.max() > BAR * bounds_of("pressure_high")[1]:
        return f"a pressure of {item.values.max() / BAR:.0f} bar is too high for a brake"
    if checked is None or not np.ptp(item.values) > 0.0:
        return None if points > 0 else "a pressure, not known to be of the brake"
    every = np.ones(checked.size, bool)
    delay = pressure_delay(clock.time, checked / G, [item.values], [], every)
    if delay and abs(delay.least) > bounds_of("pressure_late")[1]:
        return (
            f"a pressure that is {delay.words} against the deceleration: take it with --take, "
            f"and put it in time with {delay.entry}"
        )
    if (agrees := follows(item.values, checked, clock)) < _FOLLOWS:
        return f"a pressure that does not agree with the deceleration (correlation {agrees:.2f})"
    return None


_BY_NAME: dict[str, tuple[str, str | None, tuple[str, ...]]] = {
    "steering": ("rad", None, ("steering",)),
    "abs_active": ("1", None, ("abs",)),
    "T_disc_f": ("degC", "f", ("disc",)),
    "T_disc_r": ("degC", "r", ("disc",)),
    "T_drive_f": ("N*m", "f", ("torque", "drive")),
    "T_drive_r": ("N*m", "r", ("torque", "drive")),
}
"""SI unit, axle and words of the channels that have no physical test."""


def find_by_name(search: Search) -> None:
    """Find the channels of `_BY_NAME`."""
    for channel, (si, side, quantities) in _BY_NAME.items():
        free = search.free()
        fitting = [s for s in free if s.name == channel] or [
            s
            for s in free
            if s.si == si
            and side in (None, axle(s.name))
            and all(score(s.name, quantity) > 0 for quantity in quantities)
        ]
        if len(fitting) > 1:
            do = f"choose one: --take {channel}=NAME; or none: --take {channel}="
            search.doubt(channel, fitting, "several columns fit by name", do)
        elif fitting:
            reasons = ["name", f"unit {fitting[0].column.unit}", "not tested"]
            if channel.startswith("T_drive"):
                reasons.append("it must be that at the wheels, negative when it slows the car")
            search.propose(channel, Mapping(fitting[0].name), False, *reasons)
