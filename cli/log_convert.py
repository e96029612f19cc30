"""`brake-cal log convert`: logs as CSV, Parquet or MDF."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit, emit_json, progress, say
from cli.inputs import channel_map_of
from cli.logs import named, read_whole
from cli.options import Force, Json, Map, example, out_file
from cli.outputs import (
    ready_folder,
    refuse_folder,
    refuse_foreign,
    refuse_overwriting,
    stems_of,
    writing,
)

if TYPE_CHECKING:
    from calib.logs.whole import WholeLog

EPILOG = example(
    "brake-cal log convert sample_logs/sedan/coast.csv --out coast.parquet",
    "brake-cal log convert sample_logs/sedan/*.csv --out parquet --to parquet",
)

KeepNames = Annotated[
    bool,
    typer.Option("--keep-names", help="Leave names and values as they are, also those of a map."),
]


def convert(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="logs of any format")],
    out: Annotated[
        Path, out_file("File (.csv, .parquet, .mf4), or a folder with --to.", "FILE|DIR")
    ],
    to: Annotated[
        str | None,
        typer.Option("--to", metavar="FORMAT", help="csv, parquet or mf4, for a folder."),
    ] = None,
    keep_names: KeepNames = False,
    force: Force = False,
    channel_map: Map = None,
    json: Json = False,
) -> None:
    """Write logs as CSV, Parquet or MDF 4.

    All columns and units are kept. Values are the same to the last bit. A log of several sample
    rates comes onto one clock, as for the other commands. Columns of a --map get their canonical
    names and the map's sign and scale, so that no map is needed any more, unless --keep-names.
    """
    mapping = channel_map_of(channel_map)
    if to is None:
        check_file(out, logs, channel_map)
        if len(logs) > 1:
            raise typer.BadParameter("several logs need a folder and --to", param_hint="--out")
        log = read_whole(logs[0], mapping, keep_names)
        write(log, out, force)
        written = [(log, out)]
    else:
        names = _checked_names(out, logs, to)
        whole = partial(read_whole, mapping=mapping, keep_names=keep_names)
        written = _into(out, dict(zip(names, logs, strict=True)), whole, force)
    if json:
        emit_json({"schema": 1, "logs": [_document(*one) for one in written]})
        return
    for log, path in written:
        emit(f"{path}: {log.columns[0].values.size} rows, {len(log.columns)} columns")
        for note in log.notes:
            say(f"{log.source}: {note}")


def check_file(out: Path, logs: list[Path], channel_map: Path | None) -> None:
    """Refuse an output of an unknown ending, and one that is an input."""
    from calib.logs.write import WRITERS

    if out.suffix.lower() not in WRITERS:
        raise typer.BadParameter(
            f"must end in {', '.join(WRITERS)}, or be a folder with --to", param_hint="--out"
        )
    named(logs)
    refuse_folder(out)
    refuse_overwriting([out], logs, [channel_map])


def _checked_names(out: Path, logs: list[Path], to: str) -> list[str]:
    """Names of the files in the folder ``out``; refuses an unknown format, and an input."""
    from calib.logs.write import WRITERS

    if f".{to.lower()}" not in WRITERS:
        known = ", ".join(ending[1:] for ending in WRITERS)
        raise typer.BadParameter(f"unknown format {to!r}; known: {known}", param_hint="--to")
    names = [f"{stem}.{to.lower()}" for stem in stems_of(named(logs), "LOG")]
    refuse_overwriting((out / name for name in names), logs)
    ready_folder(out, names)
    return names


def write(log: "WholeLog", out: Path, force: bool) -> None:
    """Write a log in the format of the ending, unless another file would be lost."""
    from calib.base.write import write_whole

    content = _content(log, out, force)
    with writing(out):
        write_whole(out, content)


def _content(log: "WholeLog", out: Path, force: bool) -> bytes:
    from calib.logs.write import WRITERS

    content = WRITERS[out.suffix.lower()](log)
    refuse_foreign(out, lambda data: data == content, "this log", force)
    return content


def _into(
    out: Path, logs: dict[str, Path], whole: "Callable[[Path], WholeLog]", force: bool
) -> "list[tuple[WholeLog, Path]]":
    """All logs into a folder by the names of their files, or none."""
    from calib.base.publish import publish, workshop
    from calib.base.write import write_whole

    made = []
    plural = "s" * (len(logs) > 1)
    with (
        writing(out),
        progress(f"converting {len(logs)} log{plural}", len(logs)) as done,
        workshop(out) as work,
    ):
        for name, path in logs.items():
            made.append((whole(path), out / name))
            write_whole(work / name, _content(*made[-1], force))
            done()
        publish(work, out, list(logs)[-1])
    return made


def _document(log: "WholeLog", out: Path) -> dict[str, object]:
    return {
        "log": log.source,
        "out": out,
        "rows": log.columns[0].values.size,
        "columns": [{"name": column.name, "unit": column.unit} for column in log.columns],
        "notes": log.notes,
    }
