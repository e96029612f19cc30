"""Find the time, and the four columns of the wheel speeds and of the wheel pressures."""

from collections import defaultdict
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.errors import LogError
from calib.base.names import WHEEL_SPEEDS, WHEELS
from calib.base.plain import counted
from calib.base.units import BAR, from_si, to_si
from calib.base.warning import bounds_of
from calib.logs.channel_map import Mapping
from calib.logs.clock import REPEATED, TIME_UNITS, check_clock, step_of
from calib.logs.gaps import BRIDGED_GAPS
from calib.logs.resample import rows_on_one_clock
from calib.run.filters import true_intervals
from calib.suggest.columns import GIVE_RADIUS, SMOOTH, ColumnClock, Search, Series, rim_mapping
from calib.suggest.words import has_word, split_wheel

_SLOW = 0.15  # share of the highest speed [1] below which the car is taken to stand
_ACCELERATED = 0.5  # smallest range of the acceleration [m/s^2] to test other columns with
_ALIKE = 0.99  # lowest correlation of two wheel speeds [1]
_APART = 0.1  # largest difference of the mean speeds of four wheels, over the lowest [1]
_STEADY = 0.02  # standard deviation over mean [1] below which noise hides the correlation
ALL_WHEEL_SPEEDS = f"{WHEEL_SPEEDS[0]} ... {WHEEL_SPEEDS[-1]}"  # channel of a doubt on all four


def find_clock(search: Search) -> None:
    """Find the time: its name says so, it does not decrease, and its rate is possible."""
    if "time" not in search.user_specified:
        _propose_clock(search)
    elif (time := search.values_of_user("time")) is not None:
        _set_clock(search, time[_is_later(time)] if _runs(time) else time, [])
    if search.clock is None:
        return
    source = search.proposals["time"].mapping.source
    # rows that repeat a time are left out
    rows = _is_later(next(s.values for s in search.series if s.name == source))
    search.series = [replace(s, values=s.values[rows]) for s in search.series]
    search.gapped = [replace(s, values=s.values[rows]) for s in search.gapped]


def _propose_clock(search: Search) -> None:
    possible = [s for s in (*search.free(), *search.gapped) if s.si in ("s", None)]
    named = [s for s in possible if has_word(s.name, "time")]
    fitting = [s for s in named if _runs(s.values)]
    canonical = [s for s in fitting if s.name == "time"]
    unread = [(name, why) for name, why in search.unused.items() if has_word(name, "time")]
    if canonical or len(fitting) == 1:
        _take_clock(search, (canonical or fitting)[0])
    elif fitting:
        names, why = [s.name for s in fitting], "more than one column is a time"
        search.doubt("time", names, why, "choose one: --take time=NAME")
    elif named:  # the doubt says why it is no clock
        _set_clock(search, named[0].values, [named[0].name])
    elif unread:
        name, why = unread[0]
        search.doubt("time", [name], why, "export the log again, with a time for each row")
    else:
        running = [s for s in possible if _runs(s.values)]
        in_seconds = [s for s in running if s.si == "s"]
        names = [s.name for s in in_seconds or running]
        do = "choose one and give its unit: --take 'time=NAME [s]'"
        search.doubt("time", names, "no column is named a time", do)


def _set_clock(search: Search, time: Array, names: list[str]) -> None:
    """Set the clock to a ``time`` [s] (n,), or ask about it if it cannot be that of a log."""
    try:
        check_clock(time, "time", "s")
    except LogError as error:
        search.proposals.pop("time", None)
        search.user_specified.pop("time", None)  # the user is asked again
        search.doubt("time", names, error.problem, error.do or "record the log again")
    else:
        search.clock = ColumnClock(time, step_of(time))


def _is_later(time: Array) -> Mask:
    """Whether the time of each row is later than that of the row before, shape (n,)."""
    return np.append(True, np.diff(time) > 0.0) if time.size else np.zeros(0, bool)


def _runs(values: Array) -> bool:
    """Whether values (n,) are those of a clock: no step is NaN or negative, few steps are 0."""
    steps = np.diff(values)
    repeated = np.count_nonzero(steps == 0.0)
    return bool(steps.size and np.all(steps >= 0.0) and repeated <= REPEATED * values.size)


def _take_clock(search: Search, item: Series) -> None:
    """Take a column as the time in its own unit, or else in the first with a possible rate."""
    time, unit = item.values[_is_later(item.values)], item.column.unit
    order = "increasing"  # a reason for the proposal
    if repeated := item.values.size - time.size:
        rows = counted(repeated, "repeated time")
        order += f", but with {rows}: the log is refused until these rows are deleted"
    low, high = bounds_of("clock_rate")
    has_unit = item.si == "s"
    written = from_si(time, str(unit), "s") if has_unit else time
    own_unit = [str(unit)] if has_unit else []
    for candidate in (*own_unit, *TIME_UNITS):
        time = to_si(written, candidate, "s")
        if not low <= 1.0 / step_of(time) <= high:
            continue
        if candidate in own_unit:
            search.propose("time", Mapping(item.name), True, "name", f"unit {unit}", order)
        else:
            header = f", and its header says {unit}" if unit else ""
            only = f"only {candidate} gives a rate of 40 Hz to 1 kHz{header}"
            search.propose("time", Mapping(item.name, candidate), False, "name", order, only)
        _set_clock(search, time, [])
        return
    header = f"unit {unit}" if unit else "no unit"
    why = f"{header}, and steps of {step_of(written):.4g}"
    search.doubt("time", [item.name], why, "give the unit: --take 'time=NAME [s]'")


def resample(search: Search, clock: ColumnClock) -> ColumnClock:
    """Put all columns on one clock and return it; leave out columns with long gaps."""
    columns = (*search.series, *search.gapped)
    resampled = rows_on_one_clock(clock.time, {s.name: s.values for s in columns}, "the log")
    time, search.series, search.gapped = resampled.time, [], []
    for item, values in zip(columns, resampled.values, strict=True):
        missing = np.flatnonzero(np.isnan(values))
        if missing.size:
            first = f"{missing.size} of {time.size} rows, first at {time[missing[0]]:.3f} s"
            search.unused[item.name] = f"no value in {first}; gaps are bridged {BRIDGED_GAPS}"
        else:
            rate = item.rate or 1.0 / step_of(clock.time[~np.isnan(item.values)])
            search.series.append(replace(item, values=values, rate=rate))
    return ColumnClock(time, step_of(time))


def keep_moving_rows(
    search: Search, speed: Array | None, factor: float, clock: ColumnClock
) -> tuple[Array | None, ColumnClock]:
    """Keep the rows of the longest time in which the car moves.

    ``speed`` (n,) times ``factor`` is in m/s. Return the derivative of the speed [m/s^2], or None
    if there is no speed or it varies too little; and the clock of the rows.
    """
    if speed is None:
        return None, clock
    moves = speed > _SLOW * float(speed.max())
    intervals = true_intervals(moves) or [(0, speed.size)]
    start, end = max(intervals, key=lambda interval: interval[1] - interval[0])
    margin = 2 * clock.width(SMOOTH)  # smoothing distorts the ends
    if end - start > 6 * margin:
        start, end = start + margin, end - margin
    search.series = [replace(s, values=s.values[start:end]) for s in search.series]
    dv_dt = factor * clock.derivative(speed)[start:end]
    is_varied = bool(np.ptp(dv_dt) > _ACCELERATED)
    return dv_dt if is_varied else None, ColumnClock(clock.time[start:end], clock.step)


def find_wheels(search: Search) -> tuple[Array | None, bool]:
    """Find four speeds that are named for the wheels and agree.

    Return their mean (n,), or else that of the user's wheel speeds; and whether it is in rad/s.
    """
    fours = _agreeing_fours(search)
    angular = [four for four in fours if four["fl"].si == "rad/s"]
    likeliest = [four for four in angular if four["fl"].name == "omega_fl"] or angular or fours
    if len(likeliest) > 1:
        names = [" ".join(four[wheel].name for wheel in WHEELS) for four in likeliest]
        do = "choose one: --take omega_fl=NAME, and the same for the others"
        _doubt_wheels(search, names, "several sets of four", do)
    if len(likeliest) != 1:
        of_user = [search.values_of_user(channel) for channel in WHEEL_SPEEDS]
        speeds = [x for x in of_user if x is not None]
        if len(speeds) < len(WHEEL_SPEEDS):
            return None, True
        return np.mean(speeds, axis=0), True
    wheels = [likeliest[0][wheel] for wheel in WHEELS]
    mean = np.mean([_sign(item) * item.values for item in wheels], axis=0)
    unit, si = wheels[0].column.unit, wheels[0].si
    if si is None or (si == "m/s" and search.radii is None):
        why, do = f"speeds at the rim, in {unit}, need a radius to become wheel speeds", GIVE_RADIUS
        if si is None:
            why = "their unit is not known"
            do = "give it: --take 'omega_fl=NAME [rad/s]', and the same for the others"
        _doubt_wheels(search, [item.name for item in wheels], why, do)
        return mean, False
    for channel, item in zip(WHEEL_SPEEDS, wheels, strict=True):
        mapping = rim_mapping(channel, item.name, unit, search.radii) or Mapping(item.name)
        reasons = ["name", f"unit {unit}", "the four wheels agree"]
        if _sign(item) < 0:
            mapping = replace(mapping, sign=-1)
            reasons.append("counts backwards: sign reversed")
        search.propose(channel, mapping, True, *reasons)
    if si == "m/s" and search.radii:
        mean = mean / float(np.mean(search.radii))
    return mean, True


def _agreeing_fours(search: Search) -> list[dict[str, Series]]:
    """Return each set of four, by wheel, that agrees; refuse the columns of the others."""
    agreeing = []
    for four in _fours(search, ("rad/s", "m/s", None)):
        if _are_of_one_car([_sign(four[w]) * four[w].values for w in WHEELS]):
            agreeing.append(four)
        elif four["fl"].si is not None:  # without a unit they may be no speeds at all
            for item in four.values():
                search.refuse(item, "it does not agree with the other three wheels")
    return agreeing


def _are_of_one_car(speeds: list[Array]) -> bool:
    """Whether the speeds of four wheels, each (n,), have similar means and are correlated."""
    means = [float(np.mean(x)) for x in speeds]
    if min(means) <= 0.0 or max(means) > (1.0 + _APART) * min(means):
        return False
    if any(np.ptp(x) == 0.0 for x in speeds):
        return False
    are_steady = max(float(np.std(x)) for x in speeds) < _STEADY * max(means)
    return are_steady or float(np.corrcoef(speeds).min()) > _ALIKE


def _fours(search: Search, units: tuple[str | None, ...]) -> list[dict[str, Series]]:
    """Return each set of four columns, by wheel, that differ only in the wheel of their names."""
    by_name: defaultdict[tuple[str, str | None], dict[str, Series]] = defaultdict(dict)
    for item in search.free():
        wheel, name = split_wheel(item.name)
        if wheel and item.si in units:
            by_name[name, item.si].setdefault(wheel, item)
    return [four for four in by_name.values() if len(four) == 4]


def _sign(item: Series) -> int:
    """-1 for a wheel speed that counts backwards, else 1."""
    return -1 if float(np.median(item.values)) < 0.0 else 1


def _doubt_wheels(search: Search, names: list[str], why: str, do: str) -> None:
    if not any(channel in search.user_specified for channel in WHEEL_SPEEDS):
        search.doubt(ALL_WHEEL_SPEEDS, names, why, do)


def find_wheel_pressures(search: Search) -> None:
    """Find four columns of pressures that are named for the wheels."""
    fours, highest = _fours(search, ("Pa",)), BAR * bounds_of("pressure_high")[1]
    if len(fours) == 1 and all(item.values.max() <= highest for item in fours[0].values()):
        for wheel, item in fours[0].items():
            unit = f"unit {item.column.unit}"
            search.propose(f"p_{wheel}", Mapping(item.name), False, "name", unit)
