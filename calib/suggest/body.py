"""Find the columns for the car's speed, acceleration and brake pressure."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G
from calib.logs.channel_map import Mapping
from calib.run.filters import centred_mean
from calib.run.limits import LIMITS
from calib.suggest.physics import LATE, ColumnClock, correlation, lead, slope
from calib.suggest.proposal import LIKELY, SURE, Doubt, Proposal
from calib.suggest.series import Series, finest
from calib.suggest.words import (
    BRAKE,
    DECELERATION,
    DERIVED,
    LONG,
    MASTER,
    NO_BRAKE,
    NO_LONG,
    NO_SPEED,
    SPEED,
    corner,
    score,
    words,
)

Array = NDArray[np.float64]

FOLLOWS = 0.8
"""Lowest correlation [1] of two signals that belong together."""
ACCELERATED = 0.5
"""Smallest range of the derivative of speed [m/s^2] to check an acceleration with."""
LATER = 0.01
"""Gain of correlation [1] from which on a pressure counts as later than the deceleration."""
PRESSED = 2e5
"""Smallest range of a brake pressure [Pa] in a log with braking."""
SLOPES = (0.7, 1.4)
"""Allowed a_x over the derivative of speed [1]: slope, pitch and slip change it less than this."""


@dataclass(frozen=True)
class FoundChannel:
    """At most one proposal for a channel, or doubts; ``refused`` columns with the reason."""

    proposal: Proposal | None = None
    doubts: tuple[Doubt, ...] = ()
    refused: tuple[tuple[str, str], ...] = ()
    series: Series | None = None


def choose(
    channel: str, passed: list[tuple[Series, int]], why: str, found: Callable[[Series], Proposal]
) -> FoundChannel:
    """The column whose name fits best; if several fit equally well, a doubt.

    Of measured columns, those that are sampled coarsely beside another are no candidates.
    """
    if not passed:
        return FoundChannel()
    fine = _fine(channel, passed)
    best = max(points for _, points in fine)
    top = [s for s, points in fine if points == best]
    exact = [s for s in top if s.name == channel] or top
    if len(exact) > 1:
        names = tuple(s.name for s in exact)
        return FoundChannel(
            doubts=(Doubt(channel, names, why, f"choose one: --take {channel}=NAME"),)
        )
    kept = {s.name for s, _ in fine}
    refused = tuple(
        (s.name, _less_likely(s, exact[0], channel, s.name not in kept))
        for s, _ in passed
        if s.name != exact[0].name
    )
    return FoundChannel(found(exact[0]), (), refused, exact[0])


def _fine(channel: str, passed: list[tuple[Series, int]]) -> list[tuple[Series, int]]:
    """The columns without those that are coarser than a measured one that is named as well."""
    measured = [s for s, points in passed if points > 0 and not DERIVED & set(words(s.name))]
    if any(s.name == channel for s, _ in passed):
        return passed
    coarse = {s.name for s in measured} - {s.name for s in finest(measured)}
    return [(s, points) for s, points in passed if s.name not in coarse]


def _less_likely(item: Series, better: Series, channel: str, coarse: bool) -> str:
    if coarse:
        return f"sampled at {item.rate:.3g} Hz, and {better.name} at {better.rate:.3g} Hz"
    return f"{better.name} is more likely {channel}"


def find_speed(series: list[Series], wheels: Array | None) -> FoundChannel:
    """Find the reference speed: a speed by name and unit that agrees with the wheels."""
    passed, refused = [], []
    for item in series:
        if item.si != "m/s" or corner(item.name):
            continue
        points = 99 if item.name == "v" else score(item.name, SPEED, NO_SPEED)
        if points < 1:
            refused.append((item.name, "a speed, but not of the car, by its name"))
        elif wheels is not None and np.ptp(wheels) and correlation(item.values, wheels) < 0.98:
            refused.append((item.name, "a speed that does not agree with the wheels"))
        else:
            passed.append((item, points))
    checked = wheels is not None and bool(np.ptp(wheels))

    def proposal(item: Series) -> Proposal:
        reasons = (
            "name",
            f"unit {item.column.unit}",
            *(["agrees with the wheels"] if checked else []),
        )
        return Proposal("v", Mapping(item.name), SURE if checked else LIKELY, reasons)

    found = choose("v", passed, "more than one speed of the car", proposal)
    return FoundChannel(found.proposal, found.doubts, (*refused, *found.refused), found.series)


def find_acceleration(
    series: list[Series], rate: Array | None, clock: ColumnClock, metres: bool
) -> FoundChannel:
    """Find the longitudinal acceleration: by unit, and by the derivative of speed up to its sign.

    Parameters
    ----------
    series : all columns.
    rate : derivative of speed, shape (n,), or None.
    clock : of the log.
    metres : whether ``rate`` is in m/s^2; else in rad/s^2 of the wheels.
    """
    passed, refused = [], []
    measured = rate is not None and float(np.ptp(rate)) > (ACCELERATED if metres else 2.0)
    for item in series:
        points = 99 if item.name == "a_x" else score(item.name, LONG, NO_LONG)
        if item.si != "m/s^2":
            continue
        if points < 0:
            refused.append((item.name, "an acceleration, but not longitudinal, by its name"))
        elif measured and rate is not None and abs(_follows(item, rate, clock)) < FOLLOWS:
            refused.append((item.name, "an acceleration that is not the derivative of speed"))
        elif not measured and points < 1:
            refused.append((item.name, "an acceleration, not known to be longitudinal"))
        else:
            passed.append((item, points))
    used = rate if measured else None

    def proposal(item: Series) -> Proposal:
        if used is None:
            return _unchecked_acceleration(item, rate, metres)
        return _acceleration(item, used, clock)

    found = choose("a_x", passed, "more than one longitudinal acceleration", proposal)
    wrong = _wrong_unit(found.series, used, clock, metres)
    if wrong:
        return FoundChannel(doubts=(wrong,), refused=tuple(refused))
    return FoundChannel(found.proposal, found.doubts, (*refused, *found.refused), found.series)


def _follows(item: Series, rate: Array, clock: ColumnClock) -> float:
    """Correlation with the derivative of speed at the best lag, with its sign [1]."""
    smooth = centred_mean(item.values, clock.width(0.2) | 1)
    forward, back = lead(smooth, rate, clock)[1], lead(-smooth, rate, clock)[1]
    return forward if forward >= back else -back


def _named_and_unit(item: Series) -> tuple[bool, list[str]]:
    named = item.name == "a_x" or score(item.name, LONG, NO_LONG) > 0
    return named, [*(["name"] if named else []), f"unit {item.column.unit}"]


def _unchecked_acceleration(item: Series, rate: Array | None, metres: bool) -> Proposal:
    sign = -1 if DECELERATION & set(words(item.name)) else 1
    _, reasons = _named_and_unit(item)
    if rate is None:
        reasons.append("no speed is known to check its sign with")
    else:
        unit = "m/s^2" if metres else "rad/s^2"
        most = f"{float(np.abs(rate).max()):.2g} {unit}"
        reasons.append(f"the speed changes by {most} at most: too slowly to check its sign")
    reasons += ["named a deceleration: sign reversed"] if sign < 0 else []
    return Proposal("a_x", Mapping(item.name, sign=sign), LIKELY, tuple(reasons))


def _acceleration(item: Series, rate: Array, clock: ColumnClock) -> Proposal:
    named, reasons = _named_and_unit(item)
    follows = _follows(item, rate, clock)
    sign = 1 if follows > 0 else -1
    reasons.append(f"is the derivative of speed (correlation {abs(follows):.2f})")
    if sign < 0:
        reasons.append("positive when the car slows down: sign reversed")
    sure = SURE if named else LIKELY
    return Proposal("a_x", Mapping(item.name, sign=sign), sure, tuple(reasons))


def _wrong_unit(
    item: Series | None, rate: Array | None, clock: ColumnClock, metres: bool
) -> Doubt | None:
    """A doubt if the size of the acceleration contradicts its unit."""
    if item is None or rate is None:
        return None
    ratio = abs(slope(centred_mean(item.values, clock.width(0.2) | 1), rate))
    low, high = SLOPES if metres else LIMITS.wheel_radius
    if low <= ratio <= high:
        return None
    off, what = ratio, "speed" if metres else "the wheel speed [m]"
    hint = next(
        (f": is it in {u}?" for u, f in (("g", 1 / G), ("m/s^2", G)) if 0.7 < off / f < 1.4), ""
    )
    why = f"in {item.column.unit} it is {off:.3g} times the derivative of {what}{hint}"
    return Doubt("a_x", (item.name,), why, "give its unit: --take 'a_x=NAME [UNIT]'")


def find_pressure(series: list[Series], braking: Array | None, clock: ColumnClock) -> FoundChannel:
    """Find the brake pressure: by unit, correlated with the deceleration and not later than it.

    ``braking`` is the deceleration, shape (n,), or None if speed does not change. A column
    without a unit is a doubt if it is named a brake pressure: it could be a torque or a
    percentage.
    """
    passed, refused, unnamed = [], [], []
    for item in series:
        points = 99 if item.name == "p_mc" else _brake_score(item.name)
        if corner(item.name) or points < 0:
            continue
        if item.si in (None, "?") and points >= 2 and _presses(item):
            unnamed.append(item)
        elif item.si == "N*m" and points >= 1:
            refused.append((item.name, "a torque, not a pressure"))
        elif item.si == "Pa":
            reason = _no_brake(item, points, braking, clock)
            if reason:
                refused.append((item.name, reason))
            else:
                passed.append((item, points))
    found = choose(
        "p_mc", passed, "more than one brake pressure", lambda i: _pressure(i, braking, clock)
    )
    doubts = found.doubts
    if found.proposal is None and not doubts and unnamed:
        names = tuple(item.name for item in unnamed)
        why = "named a brake pressure, but it has no unit that is known"
        doubts = (Doubt("p_mc", names, why, "give its unit: --take 'p_mc=NAME [bar]'"),)
    return FoundChannel(found.proposal, doubts, (*refused, *found.refused), found.series)


def _brake_score(name: str) -> int:
    return score(name, BRAKE, NO_BRAKE) + max(0, 2 * score(name, MASTER, NO_BRAKE))


def _presses(item: Series) -> bool:
    found = set(words(item.name))
    return bool(found & {"pressure", "press", "prs", "druck", "bremsdruck", "vordruck", "p"})


def _no_brake(item: Series, points: int, braking: Array | None, clock: ColumnClock) -> str | None:
    """Reason why a pressure is not the brake pressure, or None."""
    if item.values.max() > LIMITS.pressure:
        return f"a pressure of {item.values.max() / 1e5:.0f} bar is too high for a brake"
    if braking is None or np.ptp(braking) < ACCELERATED or not item.moves:
        return None if points > 0 else "a pressure, not known to be of the brake"
    ahead, follows = lead(item.values, braking, clock)
    if follows < FOLLOWS:
        return f"a pressure that does not agree with the deceleration (correlation {follows:.2f})"
    in_time = lead(item.values, braking, clock, LATE)[1]
    if follows - in_time > LATER:
        return f"a pressure that comes {-ahead:.2f} s after the deceleration"
    return None


def _pressure(item: Series, braking: Array | None, clock: ColumnClock) -> Proposal:
    reasons = [*(["name"] if _is_named(item) else []), f"unit {item.column.unit}"]
    applied = float(np.ptp(item.values)) > PRESSED
    if braking is None:
        reasons.append("no speed is known to check it with")
        return Proposal("p_mc", Mapping(item.name), LIKELY, tuple(reasons))
    if not applied or np.ptp(braking) < ACCELERATED:
        reasons.append("no braking in the log to check it with")
        return Proposal("p_mc", Mapping(item.name), LIKELY, tuple(reasons))
    ahead, follows = lead(item.values, braking, clock, LATE)
    when = f"{ahead:.2f} s before" if ahead > 0 else "with"
    reasons.append(f"{when} the deceleration (correlation {follows:.2f})")
    return Proposal("p_mc", Mapping(item.name), SURE if _is_named(item) else LIKELY, tuple(reasons))


def _is_named(item: Series) -> bool:
    return item.name == "p_mc" or _brake_score(item.name) > 0
