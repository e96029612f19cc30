"""Find the columns of speed, acceleration and pressure, and those that only a name can tell.

The speed agrees with those of the wheels. The acceleration is the derivative of the speed, up to
its sign. The pressure rises and falls with the deceleration.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import CHANNELS, G
from calib.base.units import BAR
from calib.base.warning import bounds_of
from calib.logs.channel_map import Mapping
from calib.logs.computed import factor_between, may_be_source
from calib.run.pressure_delay import pressure_delay
from calib.suggest.columns import ColumnClock, Search, Series
from calib.suggest.words import axle_of, has_word, score, wheel_of

_CORRELATED = 0.8  # lowest correlation [1]: a_x with dv/dt, a pressure with the deceleration
_CORRELATED_SPEEDS = 0.98  # lowest correlation [1] of the speeds of the car and of its wheels
_LAG = 0.5  # longest lag that is tried [s]: a brake builds up in 0.1 to 0.2 s
_PRESSED = 2e5  # smallest range of a brake pressure [Pa] in a log with braking
_SLOPES = (0.4, 2.5)
"""Allowed range of a_x over the derivative of speed [1]; with g read as m/s^2 it would be 0.1."""
_CANONICAL = 99  # score of a column that has the name of the channel


def _score(name: str, channel: str) -> int:
    """How well a name fits a channel: above 0 if it does, -1 for the name of another quantity."""
    if name == channel:
        return _CANONICAL
    if channel == "p_mc":
        # a name of the master cylinder counts twice, and one without it takes nothing away
        return score(name, "brake") + 2 * max(0, score(name, "master"))
    return score(name, "speed" if channel == "v" else "longitudinal")


def _choose(search: Search, channel: str, passed: list[Series], several: str) -> Series | None:
    """Choose among the columns that passed the tests of a channel; refuse the others.

    The column that has the name of the channel is chosen, or else the column with the best score. A
    column is too slow if a measured one, whose name fits, has more than twice its sample rate. If
    several are equally good, the user is asked with the reason ``several``.
    """
    scores = {s.name: _score(s.name, channel) for s in passed}
    measured = [s for s in passed if scores[s.name] > 0 and not has_word(s.name, "derived")]
    highest = max((s.rate or 0.0 for s in measured), default=0.0)
    fast = [s for s in passed if 2.0 * (s.rate or 0.0) >= highest]
    best = max((scores[s.name] for s in fast), default=0)
    canonical = [s for s in passed if s.name == channel]
    likeliest = canonical or [s for s in fast if scores[s.name] == best]
    if len(likeliest) > 1:
        names = [s.name for s in likeliest]
        search.doubt(channel, names, several, f"choose one: --take {channel}=NAME")
    if len(likeliest) != 1:
        return None
    (chosen,) = likeliest
    for item in passed:
        if item is not chosen:
            search.refuse(item, f"{chosen.name} is more likely {channel}")
    return chosen


def find_speed(search: Search, wheels: Array | None) -> Array | None:
    """Find v by name and unit, and by its agreement with ``wheels`` (n,); return it [m/s]."""
    if wheels is not None and np.ptp(wheels) == 0.0:
        wheels = None  # a constant speed correlates with nothing
    passed = []
    for item in search.free():
        if item.si != "m/s" or wheel_of(item.name):
            continue
        if _score(item.name, "v") < 1:
            search.refuse(item, "a speed, but not of the car, by its name")
        elif wheels is not None and _correlation(item.values, wheels) < _CORRELATED_SPEEDS:
            search.refuse(item, "a speed that does not agree with the wheels")
        else:
            passed.append(item)
    # also beside a column of the user, so that the other speeds are refused
    chosen = _choose(search, "v", passed, "more than one speed of the car")
    if "v" in search.user_specified:
        return search.values_of_user("v")
    if chosen is None:
        return None
    reasons = ["name", f"unit {chosen.column.unit}"]
    if wheels is not None:
        reasons.append("agrees with the wheels")
    search.propose("v", Mapping(chosen.name), wheels is not None, *reasons)
    return chosen.values


def find_acceleration(search: Search, dv_dt: Array | None, clock: ColumnClock) -> None:
    """Find a_x by its unit, and by its agreement, up to its sign, with ``dv_dt`` [m/s^2] (n,)."""
    passed = []
    for item in search.free():
        if item.si != "m/s^2":
            continue
        name_score = _score(item.name, "a_x")
        if name_score < 0:
            search.refuse(item, "an acceleration, but not longitudinal, by its name")
        elif dv_dt is not None and abs(_best_correlation(item.values, dv_dt, clock)) < _CORRELATED:
            search.refuse(item, "an acceleration that is not the derivative of speed")
        elif dv_dt is None and name_score < 1:
            search.refuse(item, "an acceleration, not known to be longitudinal")
        else:
            passed.append(item)
    chosen = _choose(search, "a_x", passed, "more than one longitudinal acceleration")
    if chosen is None:
        return
    is_named = _score(chosen.name, "a_x") > 0
    reasons = ["name"] if is_named else []
    reasons.append(f"unit {chosen.column.unit}")
    if dv_dt is None:
        sign = -1 if has_word(chosen.name, "deceleration") else 1
        reasons.append("the speed changes too slowly, or is not known, to check its sign with")
    else:
        slope = np.cov(clock.smooth(chosen.values), dv_dt)[0, 1] / np.var(dv_dt, ddof=1)
        if not _SLOPES[0] <= abs(slope) <= _SLOPES[1]:
            why = f"in {chosen.column.unit} it is {abs(slope):.3g} times the derivative of speed"
            search.doubt("a_x", [chosen.name], why, "give its unit: --take 'a_x=NAME [UNIT]'")
            return
        agreement = _best_correlation(chosen.values, dv_dt, clock)
        sign = 1 if agreement > 0 else -1
        reasons.append(f"is the derivative of speed (correlation {abs(agreement):.2f})")
    if sign < 0:
        reasons.append("positive when the car slows down: sign reversed")
    is_sure = is_named and dv_dt is not None
    search.propose("a_x", Mapping(chosen.name, sign=sign), is_sure, *reasons)


def refuse_computed(search: Search) -> None:
    """Refuse pressures that are a constant times a column of another quantity."""
    others = [s for s in search.series if may_be_source(s.column.unit)]
    for item in [s for s in search.free() if s.si == "Pa"]:
        for other in others:
            if factor_between(item.values, other.values) is not None:
                origin = f"{other.name} [{other.column.unit}]"
                search.unused[item.name] = f"computed: a fixed number times {origin}"


def find_pressure(search: Search, braking: Array | None, clock: ColumnClock) -> None:
    """Find p_mc by its unit; it follows the deceleration ``braking`` [m/s^2] (n,) without delay.

    A column without a unit is a doubt if it is named a brake pressure: it could be a torque.
    """
    passed, without_unit = [], []
    for item in search.free():
        name_score = _score(item.name, "p_mc")
        if wheel_of(item.name) or name_score < 0:
            continue
        if item.si is None and name_score >= 2 and has_word(item.name, "pressure"):
            without_unit.append(item.name)
        elif item.si == "N*m" and name_score >= 1:
            search.refuse(item, "a torque, not a pressure")
        elif item.si == "Pa":
            if reason := _reason_against_pressure(item, name_score, braking, clock):
                search.refuse(item, reason)
            else:
                passed.append(item)
    chosen = _choose(search, "p_mc", passed, "more than one brake pressure")
    if chosen is None:
        if without_unit and not passed:
            why = "named a brake pressure, but it has no unit that is known"
            search.doubt("p_mc", without_unit, why, "give its unit: --take 'p_mc=NAME [bar]'")
        return
    is_named = _score(chosen.name, "p_mc") > 0
    reasons = ["name"] if is_named else []
    reasons.append(f"unit {chosen.column.unit}")
    is_checked = braking is not None and bool(np.ptp(chosen.values) > _PRESSED)
    if braking is not None and is_checked:
        agreement = _best_correlation(chosen.values, braking, clock)
        reasons.append(f"goes with the deceleration (correlation {agreement:.2f})")
    else:
        reasons.append("no braking is known to check it with")
    search.propose("p_mc", Mapping(chosen.name), is_named and is_checked, *reasons)


def _reason_against_pressure(
    item: Series, name_score: int, braking: Array | None, clock: ColumnClock
) -> str | None:
    """Reason why a pressure is not that of the brake, or None."""
    highest = float(item.values.max())
    if highest > BAR * bounds_of("pressure_high")[1]:
        return f"a pressure of {highest / BAR:.0f} bar is too high for a brake"
    if braking is None or np.ptp(item.values) == 0.0:
        return None if name_score > 0 else "a pressure, not known to be of the brake"
    all_rows = np.ones(braking.size, bool)
    delay = pressure_delay(clock.time, braking / G, [item.values], drives=[], use=all_rows)
    if delay and abs(delay.nearest_to_zero) > bounds_of("pressure_late")[1]:
        do = f"take it with --take, and put it in time with {delay.entry}"
        return f"a pressure that is {delay.words} against the deceleration: {do}"
    agreement = _best_correlation(item.values, braking, clock)
    if agreement < _CORRELATED:
        return f"a pressure that does not agree with the deceleration (correlation {agreement:.2f})"
    return None


def _correlation(a: Array, b: Array) -> float:
    """Correlation of ``a`` and ``b``, both (n,) [1]; 0 if one of them is constant."""
    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    return float(np.corrcoef(a, b)[0, 1])


def _best_correlation(x: Array, dv_dt: Array, clock: ColumnClock) -> float:
    """Correlation [1] of ``x`` (n,) and the derivative of speed ``dv_dt`` (n,) at the best lag."""
    smooth, n = clock.smooth(x), x.size
    longest = min(clock.width(_LAG), n // 4)
    correlations = []
    for lag in range(-longest, longest + 1):  # sample i of x belongs to sample i + lag of dv_dt
        of_x = slice(max(0, -lag), n - max(0, lag))
        of_dv_dt = slice(max(0, lag), n - max(0, -lag))
        correlations.append(_correlation(smooth[of_x], dv_dt[of_dv_dt]))
    return max(correlations, key=abs)


_BY_NAME = {
    "steering": ["steering"],
    "abs_active": ["abs"],
    "T_disc_f": ["disc"],
    "T_disc_r": ["disc"],
    "T_drive_f": ["torque", "drive"],
    "T_drive_r": ["torque", "drive"],
}
"""Channels that have no physical test, with the quantities that the name of a column must fit."""


def find_by_name(search: Search) -> None:
    """Find the channels of `_BY_NAME` by the unit of the column, and its axle and quantities."""
    for channel, quantities in _BY_NAME.items():
        free = search.free()
        fitting = [s for s in free if s.name == channel]
        if not fitting:
            fitting = [s for s in free if s.si == CHANNELS[channel].si]
            if channel.startswith("T_"):
                fitting = [s for s in fitting if axle_of(s.name) == channel[-1]]
            for quantity in quantities:
                fitting = [s for s in fitting if score(s.name, quantity) > 0]
        if len(fitting) > 1:
            do = f"choose one: --take {channel}=NAME; or none: --take {channel}="
            names = [s.name for s in fitting]
            search.doubt(channel, names, "several columns fit by name", do)
        elif fitting:
            reasons = ["name", f"unit {fitting[0].column.unit}", "not tested"]
            if channel.startswith("T_drive"):
                reasons.append("it must be that at the wheels, negative when it slows the car")
            search.propose(channel, Mapping(fitting[0].name), False, *reasons)
