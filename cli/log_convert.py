"""`brake-cal log convert`: logs as CSV, Parquet or MDF."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit, emit_json, progress, say
from cli.inputs import channel_map_of
from cli.options import Json, Map, example, out_file
from cli.outputs import (
    ready_folder,
    refuse_folder,
    refuse_overwriting,
    stems_of,
    writing,
)

if TYPE_CHECKING:
    from calib.logs.channel_map import ChannelMap
    from calib.logs.whole import WholeLog

EPILOG = example(
    "brake-cal log convert sample_logs/sedan/coast.csv --out coast.parquet",
    "brake-cal log convert sample_logs/sedan/*.csv --out parquet --to parquet",
)

Force = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]
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
        check_file(out, logs, channel_map, force)
        if len(logs) > 1:
            raise typer.BadParameter("several logs need a folder and --to", param_hint="--out")
        written = [_one(logs[0], out, mapping, keep_names)]
    else:
        check_folder(out, logs, to, force)
        written = _into(out, logs, to, mapping, keep_names)
    if json:
        emit_json({"schema": 1, "logs": [_document(*one) for one in written]})
        return
    for log, path in written:
        emit(f"{path}: {log.columns[0].values.size} rows, {len(log.columns)} columns")
        for note in log.notes:
            say(f"{log.source}: {note}")


def check_file(out: Path, logs: list[Path], channel_map: Path | None, force: bool) -> None:
    """Refuse an output of an unknown ending, one that is an input, and one that exists."""
    from calib.logs.convert import ENDINGS

    if out.suffix.lower() not in ENDINGS:
        raise typer.BadParameter(
            f"must end in {', '.join(ENDINGS)}, or be a folder with --to", param_hint="--out"
        )
    refuse_folder(out)
    refuse_overwriting([out], logs, [channel_map])
    _refuse_existing(out, force)


def check_folder(out: Path, logs: list[Path], to: str, force: bool) -> None:
    """The same of a folder for the logs, in the format ``to``."""
    from calib.logs.convert import ENDINGS

    if f".{to.lower()}" not in ENDINGS:
        known = ", ".join(ending[1:] for ending in ENDINGS)
        raise typer.BadParameter(f"unknown format {to!r}; known: {known}", param_hint="--to")
    files = [out / name for name in _names(logs, to)]
    refuse_overwriting(files, logs)
    for file in files:
        _refuse_existing(file, force)
    ready_folder(out)


def _names(logs: list[Path], to: str) -> list[str]:
    return [f"{stem}.{to.lower()}" for stem in stems_of(logs, "LOG")]


def _refuse_existing(file: Path, force: bool) -> None:
    if file.exists() and not force:
        raise typer.BadParameter(f"{file} exists; --force replaces it", param_hint="--out")


def _one(
    path: Path, out: Path, mapping: "ChannelMap | None", keep_names: bool
) -> "tuple[WholeLog, Path]":
    from calib.logs.convert import write_log
    from calib.logs.whole import read_whole

    log = read_whole(path, mapping, keep_names)
    with writing(out):
        write_log(log, out)
    return log, out


def _into(
    out: Path, logs: list[Path], to: str, mapping: "ChannelMap | None", keep_names: bool
) -> "list[tuple[WholeLog, Path]]":
    """All logs into a folder, or none."""
    from calib.publish import publish, workshop

    names = _names(logs, to)
    made = []
    plural = "s" * (len(logs) > 1)
    with (
        writing(out),
        progress(f"converting {len(logs)} log{plural}", len(logs)) as done,
        workshop(out) as work,
    ):
        for path, name in zip(logs, names, strict=True):
            made.append((_one(path, work / name, mapping, keep_names)[0], out / name))
            done()
        publish(work, out, names[-1])
    return made


def _document(log: "WholeLog", out: Path) -> dict[str, object]:
    return {
        "log": log.source,
        "out": out,
        "rows": log.columns[0].values.size,
        "columns": [{"name": column.name, "unit": column.unit} for column in log.columns],
        "notes": log.notes,
    }
