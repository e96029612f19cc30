"""Propose a channel map for a foreign log by names, units and physics, and try it on the log."""

import os
from collections import abc
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from calib.base.errors import BrakeCalError, one_line
from calib.base.names import CHANNELS, WHEEL_SPEEDS
from calib.logs.channel_map import ChannelMap, Mapping
from calib.logs.read import REQUIRED, read_log
from calib.logs.source import ColumnSource
from calib.logs.text.dialect import DETECTED
from calib.run.driving_record import NOMINAL_RADIUS
from calib.suggest import body, clock_and_wheels
from calib.suggest.columns import LIKELY, ColumnClock, Doubt, Proposal, Radii, Search, start_search

_UNKNOWN = "not a known channel"
_NO_CLOCK = "not looked for, since the time is not known"


@dataclass(frozen=True)
class Suggestion:
    """A channel map proposed for a log; it is written only if there are no doubts."""

    log: str  # path of the log
    proposals: tuple[Proposal, ...]
    doubts: tuple[Doubt, ...]
    missing: dict[str, str]  # reason, by the name of a required channel
    unused: dict[str, str]  # reason, by the name of a column
    ignore: tuple[str, ...]  # columns that have the name of a channel and are not to be one


def suggest(
    source: ColumnSource,
    where: str,
    *,
    user_specified: abc.Mapping[str, str] | None = None,
    radii: Radii | None = None,
) -> Suggestion:
    """Propose a channel map for the opened log with the path ``where``.

    ``user_specified`` has the column of a channel, such as ``Brake [bar]``, or "" for no column.
    With the ``radii`` [m] of front and rear wheels, speeds at the rim become wheel speeds. Raises
    InputError for a channel or column in ``user_specified`` that does not exist.
    """
    search = start_search(source, where, user_specified or {}, radii)
    clock_and_wheels.find_clock(search)
    if search.clock is None:
        for item in (*search.series, *search.gapped):
            search.refuse(item, _NO_CLOCK)
    else:
        _find_others(search, search.clock)
    for item in search.series:
        search.refuse(item, _UNKNOWN)  # unless it has a reason; proposed ones are left out below
    proposals = tuple(search.proposals[name] for name in CHANNELS if name in search.proposals)
    proposed = {proposal.mapping.source for proposal in proposals}
    unused = {name: why for name, why in search.unused.items() if name not in proposed}
    ignore = tuple(n for n in unused if n in CHANNELS and n not in search.proposals)
    doubtful = {doubt.channel for doubt in search.doubts}
    if clock_and_wheels.ALL_WHEEL_SPEEDS in doubtful:
        doubtful.update(WHEEL_SPEEDS)
    absent = "no column fits by name, unit and values" if search.clock else _NO_CLOCK
    missing = {}
    for name in REQUIRED:
        if name not in search.proposals and name not in doubtful:
            has_own_column = name in unused and search.clock is not None  # one of its name
            missing[name] = f"its column: {unused[name]}" if has_own_column else absent
    return Suggestion(where, proposals, tuple(search.doubts), missing, unused, ignore)


def _find_others(search: Search, clock: ColumnClock) -> None:
    """Find all channels except the time."""
    clock = clock_and_wheels.resample(search, clock)
    wheels, is_angular = clock_and_wheels.find_wheels(search)
    speed = body.find_speed(search, wheels)
    motion = wheels if speed is None else speed
    factor = 1.0  # from ``motion`` to m/s; a speed without a unit is taken as one in m/s
    if speed is None and is_angular:
        factor = NOMINAL_RADIUS
    dv_dt, clock = clock_and_wheels.keep_moving_rows(search, motion, factor, clock)
    body.find_acceleration(search, dv_dt, clock)
    body.refuse_computed(search)
    body.find_pressure(search, None if dv_dt is None else -dv_dt, clock)
    clock_and_wheels.find_wheel_pressures(search)
    body.find_by_name(search)


def try_on_log(suggestion: Suggestion, path: Path, base: ChannelMap | None = None) -> Suggestion:
    """Read the log with a suggestion and the file format of ``base``; add a doubt if that fails."""
    if suggestion.doubts or not suggestion.proposals:
        return suggestion
    channels = {proposal.channel: proposal.mapping for proposal in suggestion.proposals}
    base = base or ChannelMap(str(path), {})
    proposed = replace(base, where="the proposed map", channels=channels, ignore=suggestion.ignore)
    try:
        read_log(path, proposed, require=tuple(channels))
    except BrakeCalError as error:
        do = "correct the log, or choose other columns: --take CHANNEL=NAME"
        doubt = Doubt("map", (), f"the log cannot be read with it: {error}", do)
        likely = tuple(replace(proposal, sure=LIKELY) for proposal in suggestion.proposals)
        return replace(suggestion, proposals=likely, doubts=(doubt,))
    return suggestion


def to_toml(
    suggestion: Suggestion, base: ChannelMap | None = None, folder: Path | None = None
) -> str:
    """Write the channel map as TOML, with comments that say how sure each entry is.

    DBC files and text format are those of ``base``; their paths are relative to ``folder``.
    """
    lines = [f"# proposed from {one_line(suggestion.log)}", "schema = 1"]
    databases = base.databases if base else {}
    if files := {bus: _paths(paths, folder) for bus, paths in databases.items() if paths}:
        are_for_all_buses = "" in files
        lines.append(f"dbc = {_toml(files[''] if are_for_all_buses else files)}")
    if suggestion.ignore:
        lines.append(f"ignore = {_toml(list(suggestion.ignore))}")
    lines += [f"# {name}: {one_line(why)}" for name, why in suggestion.missing.items()]
    defaults = asdict(Mapping(""))
    for proposal in suggestion.proposals:
        why = one_line("; ".join(proposal.reasons))
        lines += ["", f"[channels.{proposal.channel}]  # {proposal.sure}: {why}"]
        lines += _changed(asdict(proposal.mapping), defaults)
    text = _changed(asdict(base.text), asdict(DETECTED)) if base else []
    if text:
        lines += ["", "[text]", *text]
    return "\n".join([*lines, ""])


def _changed(values: abc.Mapping[str, object], defaults: abc.Mapping[str, object]) -> list[str]:
    """Entries that differ from the defaults, each as a line of TOML."""
    return [f"{key} = {_toml(x)}" for key, x in values.items() if x != defaults[key]]


def _toml(value: object) -> str:
    """A value as TOML in one line."""
    import tomlkit

    if not isinstance(value, dict):
        return tomlkit.item(value).as_string()
    table = tomlkit.inline_table()
    table.update(value)
    return table.as_string()


def _paths(paths: abc.Iterable[Path], folder: Path | None) -> list[str]:
    texts = []
    for path in paths:
        with suppress(ValueError):  # on another drive
            path = Path(os.path.relpath(path, folder)) if folder else path
        texts.append(path.as_posix())
    return texts


def to_lines(suggestion: Suggestion) -> abc.Iterator[tuple[str, str]]:
    """Channel and text for each proposal, doubt and missing channel.

    A column that is not used has no channel: it stands under "left", as in the JSON document.
    """
    for proposal in suggestion.proposals:
        mapping = proposal.mapping
        sign = "" if mapping.sign == 1 else ", sign -1"
        scale = "" if mapping.scale == 1.0 else f", scale {mapping.scale:.6g}"
        unit = f" [{mapping.unit}]" if mapping.unit else ""
        why = "; ".join(proposal.reasons)
        yield proposal.channel, f"{mapping.source}{sign}{scale}{unit} ({proposal.sure}: {why})"
    for doubt in suggestion.doubts:
        yield doubt.channel, f"uncertain: {doubt}"
    for name, why in suggestion.missing.items():
        yield name, f"missing: {why}"
    for name, why in suggestion.unused.items():
        yield "left", f"{name}: {why}"
