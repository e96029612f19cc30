"""Propose a channel map for a foreign log by names, units and physics, and try it on the log."""

import os
from collections.abc import Iterable, Iterator
from collections.abc import Mapping as Named
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from calib.base.errors import BrakeCalError, InputError, one_line
from calib.base.names import CHANNELS
from calib.base.plain import quoted
from calib.base.units import is_unit
from calib.logs.channel_map import ChannelMap, Mapping, assigned_column
from calib.logs.read import REQUIRED, read_log
from calib.logs.source import ColumnSource, address_of, indices_of
from calib.logs.text.cells import column_from_cell
from calib.logs.text.dialect import DETECTED
from calib.run.driving_record import NOMINAL_RADIUS
from calib.suggest.body import (
    find_acceleration,
    find_by_name,
    find_pressure,
    find_speed,
    refuse_computed,
)
from calib.suggest.clock_and_wheels import (
    bridge,
    find_clock,
    find_wheel_pressures,
    find_wheels,
    while_moving,
)
from calib.suggest.columns import (
    GIVE_RADIUS,
    LIKELY,
    SURE,
    ColumnClock,
    Doubt,
    Proposal,
    Radii,
    Search,
    read_series,
    rim_mapping,
)


@dataclass(frozen=True)
class Suggestion:
    """A channel map proposed for ``log``; it is written only if there are no ``doubts``."""

    log: str
    proposals: tuple[Proposal, ...]
    doubts: tuple[Doubt, ...]
    missing: dict[str, str]
    unused: dict[str, str]
    ignore: tuple[str, ...]


def suggest(
    source: ColumnSource,
    where: str,
    *,
    user_specified: Named[str, str] | None = None,
    radii: Radii | None = None,
) -> Suggestion:
    """Propose a channel map for an opened log.

    ``user_specified`` are sources by channel, such as ``Brake [bar]``; empty for a channel that is
    to have none. ``radii`` [m] of front and rear turn speeds at the rim into wheel speeds. Raises
    InputError for a channel or column in ``user_specified`` that does not exist.
    """
    search = Search(*read_series(source), dict(user_specified or {}), radii)
    for channel, cell in search.user_specified.items():
        if proposal := _proposal_of_user(channel, cell, source, where, radii):
            search.proposals[channel] = proposal
    find_clock(search)
    if search.clock is None:
        others = (*search.series, *search.gapped)
        search.unused.update({s.name: _NO_CLOCK for s in others if s.name not in search.unused})
    else:
        _find(search, search.clock)
    proposals = tuple(search.proposals[name] for name in CHANNELS if name in search.proposals)
    proposed = {p.mapping.source for p in proposals}
    reasons = search.unused | {s.name: search.unused.get(s.name, _UNKNOWN) for s in search.series}
    unused = {name: why for name, why in reasons.items() if name not in proposed}
    doubtful = {doubt.channel[:6] for doubt in search.doubts}  # a doubt of one wheel is of all
    none = "no column fits by name, unit and values" if search.clock else _NO_CLOCK
    missing = {
        name: f"its column: {unused[name]}" if name in unused and search.clock else none
        for name in REQUIRED
        if name not in search.proposals and name[:6] not in doubtful
    }
    ignore = tuple(n for n in unused if n in CHANNELS and n not in search.proposals)
    return Suggestion(where, proposals, tuple(search.doubts), missing, unused, ignore)


_UNKNOWN = "not a known channel"
_NO_CLOCK = "not looked for, since the time is not known"


def _find(search: Search, clock: ColumnClock) -> None:
    clock = bridge(search, clock)
    mean, angular = find_wheels(search)
    speed = find_speed(search, mean)
    metres = speed is not None or not (angular or "omega_fl" in search.user_specified)
    rate = while_moving(search, speed if speed is not None else mean, clock)
    rate = rate if rate is None or metres else NOMINAL_RADIUS * rate
    clock = search.clock or clock
    find_acceleration(search, rate, clock)
    refuse_computed(search)
    find_pressure(search, None if rate is None else -rate, clock)
    find_wheel_pressures(search)
    find_by_name(search)


def _proposal_of_user(
    channel: str, cell: str, source: ColumnSource, where: str, radii: Radii | None
) -> Proposal | None:
    """The proposal for a channel whose source the user names; None for an empty name."""
    if channel not in CHANNELS:
        raise InputError(f"there is no channel {channel!r}", expected=", ".join(CHANNELS))
    if not cell:
        return None
    columns, from_user, si = source.columns, column_from_cell(cell), CHANNELS[channel].si
    indices = indices_of(cell, columns) or indices_of(from_user.name, columns)
    if len(indices) != 1:
        message = f"{where} has {len(indices) or 'no'} column{'s' * bool(indices)} {cell!r}"
        names = [address_of(columns[i], columns) for i in indices] or [c.name for c in columns]
        raise InputError(message, expected=f"one of {quoted(names)}")
    column = columns[indices[0]]
    address = address_of(column, columns)
    unit = from_user.unit if column.name != cell and from_user.unit != column.unit else None
    if mapping := rim_mapping(channel, address, unit or column.unit, radii):
        return Proposal(channel, mapping, SURE, ("given, with the radius of its axle",))
    if channel.startswith("omega_") and is_unit(unit or column.unit or "", "m/s"):
        raise InputError(f"{cell!r} is a speed at the rim", where=channel, do=GIVE_RADIUS)
    assigned_column(channel, indices[0], column, Mapping(address, unit), si, where)
    return Proposal(channel, Mapping(address, unit), SURE, ("given",))


def tried(suggestion: Suggestion, path: Path, read_with: ChannelMap | None = None) -> Suggestion:
    """The suggestion, with a doubt if the log cannot be read with it."""
    if suggestion.doubts or not suggestion.proposals:
        return suggestion
    channels = {proposal.channel: proposal.mapping for proposal in suggestion.proposals}
    base = read_with or ChannelMap(str(path), {})
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
    suggestion: Suggestion, read_with: ChannelMap | None = None, folder: Path | None = None
) -> str:
    """The channel map as TOML; comments say how sure each entry is.

    DBC files and text format are those of ``read_with``; paths lead from ``folder``, if given.
    """
    lines = [f"# proposed from {one_line(suggestion.log)}", "schema = 1"]
    databases = read_with.databases if read_with else {}
    if files := {bus: _paths(paths, folder) for bus, paths in databases.items() if paths}:
        lines.append(f"dbc = {_written(files.get('', files))}")
    if suggestion.ignore:
        lines.append(f"ignore = {_written(list(suggestion.ignore))}")
    lines += [f"# {name}: {one_line(why)}" for name, why in suggestion.missing.items()]
    defaults = asdict(Mapping(""))
    for proposal in suggestion.proposals:
        why = one_line("; ".join(proposal.reasons))
        lines += ["", f"[channels.{proposal.channel}]  # {proposal.sure}: {why}"]
        lines += _rows(asdict(proposal.mapping), defaults)
    if text := _rows(asdict(read_with.text), asdict(DETECTED)) if read_with else []:
        lines += ["", "[text]", *text]
    return "\n".join([*lines, ""])


def _rows(values: Named[str, object], defaults: Named[str, object]) -> list[str]:
    return [f"{k} = {_written(value)}" for k, value in values.items() if value != defaults[k]]


def _written(value: object) -> str:
    """A value as TOML in one line."""
    import tomlkit

    if not isinstance(value, dict):
        return tomlkit.item(value).as_string()
    table = tomlkit.inline_table()
    table.update(value)
    return table.as_string()


def _paths(paths: Iterable[Path], folder: Path | None) -> list[str]:
    texts = []
    for path in paths:
        with suppress(ValueError):  # on another drive
            path = Path(os.path.relpath(path, folder)) if folder else path
        texts.append(path.as_posix())
    return texts


def to_lines(suggestion: Suggestion) -> Iterator[tuple[str, str]]:
    """Channel and text for each proposal, doubt, missing channel and unused column."""
    for proposal in suggestion.proposals:
        mapping = proposal.mapping
        extra = "" if mapping.sign == 1 else ", sign -1"
        extra += "" if mapping.scale == 1.0 else f", scale {mapping.scale:.6g}"
        extra += f" [{mapping.unit}]" if mapping.unit else ""
        why = "; ".join(proposal.reasons)
        yield proposal.channel, f"{mapping.source}{extra} ({proposal.sure}: {why})"
    for doubt in suggestion.doubts:
        yield doubt.channel, f"uncertain: {doubt}"
    for name, why in suggestion.missing.items():
        yield name, f"missing: {why}"
    for name, why in suggestion.unused.items():
        yield "left", f"{name}: {why}"
