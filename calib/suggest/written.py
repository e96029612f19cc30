"""A suggestion as a channel map, and as lines of text."""

import os
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from calib.logs.channel_map import ChannelMap, DatabaseFile
from calib.suggest.proposal import Proposal, Suggestion

if TYPE_CHECKING:
    from tomlkit.items import Array, Table


def to_toml(
    found: Suggestion, read_with: ChannelMap | None = None, folder: Path | None = None
) -> str:
    """The channel map as TOML; comments say how sure each entry is.

    ``read_with`` is the map that the log was opened with: its DBC files and text format are kept.
    The paths of the DBC files lead from ``folder``, in which the map is to stand; they are absolute
    without one.
    """
    import tomlkit

    document = tomlkit.document()
    document.add(tomlkit.comment(f"proposed from {_one_line(found.log)}"))
    document.add("schema", 1)
    if read_with is not None and (files := _databases(read_with, folder)):
        document.add("dbc", files)
    if read_with is not None and read_with.j1939 is not None:
        document.add("j1939", list(read_with.j1939) or "any")
    if found.ignore:
        document.add("ignore", list(found.ignore))
    for name, why in found.missing.items():
        document.add(tomlkit.comment(f"{name}: {_one_line(why)}"))
    channels = tomlkit.table(is_super_table=True)
    for proposal in found.proposals:
        channels.add(proposal.channel, _entry(proposal))
    document.add("channels", channels)
    if read_with is not None and (text := _text_format(read_with)):
        document.add("text", text)
    return tomlkit.dumps(document)


def _databases(read_with: ChannelMap, folder: Path | None) -> "Array | dict[str, Array] | None":
    """The files that describe frames, by bus where the map has them so; None for no files."""
    if read_with.buses:
        return {bus: _files(files, folder) for bus, files in read_with.buses}
    return _files(read_with.dbc, folder) if read_with.dbc else None


def _files(files: Iterable[DatabaseFile], folder: Path | None) -> "Array":
    import tomlkit

    found = tomlkit.array()
    for file in files:
        path = _path_from(folder, file.path)
        one_bus = tomlkit.inline_table().append("file", path).append("bus", file.bus or "")
        found.append(one_bus if file.bus else path)
    return found


def _path_from(folder: Path | None, path: Path) -> str:
    """``path`` from a folder; absolute without one, and on another drive."""
    try:
        shown = path if folder is None else Path(os.path.relpath(path, folder))
    except ValueError:
        shown = path
    return shown.as_posix()


def _text_format(read_with: ChannelMap) -> dict[str, str]:
    """What the map says of the text format."""
    return {name: value for name, value in asdict(read_with.text).items() if value is not None}


def _entry(proposal: Proposal) -> "Table":
    import tomlkit

    mapping, entry = proposal.mapping, tomlkit.table()
    entry.comment(f"{proposal.sure}: {_one_line('; '.join(proposal.reasons))}")
    entry.trivia.comment_ws = "  "
    entry.add("source", mapping.source)
    if mapping.unit is not None:
        entry.add("unit", mapping.unit)
    if mapping.sign != 1:
        entry.add("sign", mapping.sign)
    if mapping.scale != 1.0:
        entry.add("scale", mapping.scale)
    return entry


def _one_line(text: str) -> str:
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def to_lines(found: Suggestion) -> Iterator[tuple[str, str]]:
    """Channel and text for each proposal, doubt, missing channel and unused column."""
    for proposal in found.proposals:
        mapping = proposal.mapping
        extra = "" if mapping.sign == 1 else ", sign -1"
        extra += "" if mapping.scale == 1.0 else f", scale {mapping.scale:.6g}"
        extra += f" [{mapping.unit}]" if mapping.unit else ""
        yield (
            proposal.channel,
            f"{mapping.source}{extra} ({proposal.sure}: {'; '.join(proposal.reasons)})",
        )
    for doubt in found.doubts:
        yield doubt.channel, f"uncertain: {doubt}"
    for name, why in found.missing.items():
        yield name, f"missing: {why}"
    for name, why in found.left.items():
        yield "left", f"{name}: {why}"
