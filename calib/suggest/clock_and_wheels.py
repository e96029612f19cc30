"""Find the time, and the four columns of the wheel speeds and of the wheel pressures."""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import WHEEL_SPEEDS, WHEELS
from calib.base.units import BAR, from_si, to_si
from calib.base.warning import bounds_of
from calib.logs.channel_map import Mapping
from calib.logs.clock import REPEATED, TIME_UNITS, check_steps, step_of
from calib.logs.gaps import ONLY
from calib.logs.resample import rows_on_one_clock
from calib.run.filters import true_intervals
from calib.suggest.columns import (
    GIVE_RADIUS,
    SMOOTH,
    ColumnClock,
    Doubt,
    Search,
    Series,
    rim_mapping,
    rising,
    together,
)
from calib.suggest.words import has_word, loose_corner

_SLOW = 0.15
"""Share of the highest speed [1] below which samples are not used: the car is about to stop."""


def find_clock(search: Search) -> None:
    """Find the time: named so, not decreasing, in a unit with which its rate is possible."""
    if "time" not in search.user_specified:
        _propose_clock(search)
    elif (time := search.values_of_user("time")) is not None:
        time = time[rising(time)]
        search.clock = ColumnClock(time, step_of(time))
    if search.clock is None:
        return
    try:
        check_steps(search.clock.time, "time")
    except LogError as error:
        search.doubt("time", [], error.problem, error.do or "record the log again")
        search.proposals.pop("time", None)
        search.clock = None
        return
    source = search.proposals["time"].mapping.source
    for written in [s.values for s in search.series if s.name == source]:
        part = rising(written)
        search.series = [replace(s, values=s.values[part]) for s in search.series]
        search.gapped = [replace(s, values=s.values[part]) for s in search.gapped]


def _propose_clock(search: Search) -> None:
    timed = [s for s in search.free() if s.si in ("s", None)]
    gapped = [s for s in search.gapped if s.si in ("s", None)]
    running = [s for s in timed if _runs(s.values)]
    named = [s for s in running if has_word(s.name, "time")]
    fit = [s for s in named if s.name == "time"] or named
    unread = [(name, why) for name, why in search.unused.items() if has_word(name, "time")]
    if len(fit) > 1:
        search.doubt("time", fit, "more than one column is a time", "choose one: --take time=NAME")
    elif fit:
        _take_clock(search, fit[0])
    elif broken := [s for s in (*timed, *gapped) if has_word(s.name, "time")]:
        why = f"{broken[0].name} is named a time, but {_disorder(broken[0].values)}"
        search.doubt("time", broken[:1], why, "correct the log, or export it again")
    elif unread:
        do = "export the log again, with a time for each row"
        search.doubts.append(Doubt("time", unread[0][:1], unread[0][1], do))
    else:
        candidates = [s for s in running if s.si == "s"] or running
        do = "choose one and give its unit: --take 'time=NAME [s]'"
        search.doubt("time", candidates, "no column is named a time", do)


def _runs(values: Array) -> bool:
    """Whether values never fall, and few stand still, as those of a clock."""
    steps = np.diff(values)
    standing = np.count_nonzero(steps == 0.0)
    return bool(steps.size and np.all(steps >= 0.0) and standing <= REPEATED * values.size)


def _take_clock(search: Search, item: Series) -> None:
    """Take a column with its own unit, or with the first one that gives a possible rate."""
    time, unit, order = item.values[rising(item.values)], item.column.unit, "increasing"
    if time.size < item.values.size:
        order += f", but {_disorder(item.values)}: the log is refused until they are deleted"
    low, high = bounds_of("clock_rate")
    own_unit = unit if item.si == "s" and unit else ""
    written = from_si(time, own_unit, "s") if own_unit else time
    for other in filter(None, (own_unit, *TIME_UNITS)):
        time = to_si(written, other, "s")
        if low <= 1.0 / (step := step_of(time)) <= high:
            header = f", and its header says {unit}" if unit else ""
            only = f"only {other} gives a rate of 40 Hz to 1 kHz{header}"
            is_own = other == own_unit
            reasons = ("name", f"unit {unit}", order) if is_own else ("name", order, only)
            search.propose("time", Mapping(item.name, None if is_own else other), is_own, *reasons)
            search.clock = ColumnClock(time, step)
            return
    do = "give the unit: --take 'time=NAME [s]'"
    why = f"{f'unit {unit}' if unit else 'no unit'}, and steps of {step_of(written):.4g}"
    search.doubt("time", [item], why, do)


def bridge(search: Search, clock: ColumnClock) -> ColumnClock:
    """Put all columns on one clock, which is returned, and leave out those with gaps."""
    every = (*search.series, *search.gapped)
    resampled = rows_on_one_clock(clock.time, {s.name: s.values for s in every}, "the log")
    time, search.series = resampled.time, []
    for item, values in zip(every, resampled.values, strict=True):
        missing = np.flatnonzero(np.isnan(values))
        if missing.size:
            first = f"{missing.size} of {time.size} rows, first at {time[missing[0]]:.3f} s"
            search.unused[item.name] = f"no value in {first}; gaps are bridged {ONLY}"
        else:
            rate = item.rate or 1.0 / step_of(clock.time[~np.isnan(item.values)])
            search.series.append(replace(item, values=values, rate=rate))
    search.clock = ColumnClock(time, step_of(time))
    return search.clock


def while_moving(search: Search, motion: Array | None, clock: ColumnClock) -> Array | None:
    """Derivative of the speed, of the longest part in which the car moves; drops other rows."""
    if motion is None:
        return None
    fast = motion > _SLOW * float(motion.max())
    start, end = max(
        true_intervals(fast), key=lambda run: run[1] - run[0], default=(0, motion.size)
    )
    margin = 2 * clock.width(SMOOTH)  # smoothing distorts the ends
    whole = end - start > 6 * margin
    part = slice(start + margin, end - margin) if whole else slice(start, end)
    search.series = [replace(s, values=s.values[part]) for s in search.series]
    search.clock = ColumnClock(clock.time[part], clock.step)
    return clock.rate_of(motion)[part]


def _disorder(time: Array) -> str:
    steps = np.diff(time)
    for flaw, wrong in (
        ("has no value", np.flatnonzero(np.isnan(time))),
        ("goes back", np.flatnonzero(steps < 0.0) + 1),
        ("repeats a time", np.flatnonzero(steps == 0.0) + 1),
    ):
        if wrong.size:
            return f"{flaw} in {wrong.size} rows, first in row {wrong[0] + 1}"
    return "has one row"


def _fours(search: Search, *quantities: str | None) -> list[dict[str, Series]]:
    fours: dict[tuple[str, str | None], dict[str, Series]] = {}
    for item in search.free():
        wheel, name = loose_corner(item.name)
        if wheel and item.si in quantities:
            fours.setdefault((name, item.si), {}).setdefault(wheel, item)
    return [four for four in fours.values() if len(four) == 4]


def find_wheels(search: Search) -> tuple[Array | None, bool]:
    """Four speeds named for the wheels and alike; their mean, and whether it is in rad/s."""
    good, mirrored = [], set[str]()
    for four in _fours(search, "rad/s", "m/s", None):
        backwards = {x.name for x in four.values() if float(np.median(x.values)) < 0.0}
        turned = [
            replace(four[w], values=-four[w].values) if four[w].name in backwards else four[w]
            for w in WHEELS
        ]
        if together([item.values for item in turned]):
            good.append(turned)
            mirrored |= backwards
        elif four["fl"].si is not None:
            for item in four.values():
                search.refuse(item, "it does not agree with the other three wheels")
    angular = [each for each in good if each[0].si == "rad/s"]
    fit = [each for each in angular if each[0].name == "omega_fl"] or angular or good
    if len(fit) != 1:
        if fit:
            names = [" ".join(item.name for item in each) for each in fit]
            do = "choose one: --take omega_fl=NAME, and the same for the others"
            _doubt_wheels(search, names, "several sets of four", do)
        specified = [x for w in WHEEL_SPEEDS if (x := search.values_of_user(w)) is not None]
        return (np.mean(specified, axis=0) if len(specified) == 4 else None), False
    (chosen,) = fit
    mean = np.mean([x.values for x in chosen], axis=0)
    unit, si = chosen[0].column.unit, chosen[0].si
    if si is None or (si == "m/s" and search.radii is None):
        why, do = f"speeds at the rim, in {unit}, need a radius to become wheel speeds", GIVE_RADIUS
        if si is None:
            why = "their unit is not known"
            do = "give it: --take 'omega_fl=NAME [rad/s]', and the same for the others"
        _doubt_wheels(search, [item.name for item in chosen], why, do)
        return mean, False
    for channel, wheel in zip(WHEEL_SPEEDS, chosen, strict=True):
        at_rim = rim_mapping(channel, wheel.name, unit, search.radii) or Mapping(wheel.name)
        reasons = ["name", f"unit {unit}", "the four wheels agree"]
        if wheel.name in mirrored:
            at_rim = replace(at_rim, sign=-1)
            reasons.append("counts backwards: sign reversed")
        search.propose(channel, at_rim, True, *reasons)
    return mean / float(np.mean(search.radii)) if si == "m/s" and search.radii else mean, True


def _doubt_wheels(search: Search, names: list[str], why: str, do: str) -> None:
    if not set(WHEEL_SPEEDS) & set(search.user_specified):
        channel = f"{WHEEL_SPEEDS[0]} ... {WHEEL_SPEEDS[-1]}"
        search.doubts.append(Doubt(channel, tuple(names), why, do))


def find_wheel_pressures(search: Search) -> None:
    """Four columns of pressures that are named for the wheels."""
    fours, most = _fours(search, "Pa"), BAR * bounds_of("pressure_high")[1]
    if len(fours) == 1 and all(item.values.max() <= most for item in fours[0].values()):
        for wheel, item in fours[0].items():
            unit = f"unit {item.column.unit}"
            search.propose(f"p_{wheel}", Mapping(item.name), False, "name", unit)
