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
    channel_map: Map = None,
    json: Json = False,
) -> None:
    """Write logs as CSV, Parquet or MDF 4, with all columns and units.

    Values are the same to the last bit. A log of several sample rates comes onto one clock, as for
    the other commands. Columns of a --map get their canonical names and the map's sign and scale,
    so that no map is needed any more, unless --keep-names.
    """
    mapping = channel_map_of(channel_map)
    if to is None:
        check_file(out, logs, channel_map)
        if len(logs) > 1:
            raise typer.BadParameter("several logs need a folder and --to", param_hint="--out")
        written = [_one(logs[0], out, mapping, keep_names)]
    else:
        written = _into(out, logs, to, mapping, keep_names)
    if json:
        emit_json({"schema": 1, "logs": [_document(*one) for one in written]})
        return
    for log, path in written:
        emit(f"{path}: {log.columns[0].values.size} rows, {len(log.columns)} columns")
        for note in log.notes:
            say(f"{log.source}: {note}")


def check_file(out: Path, logs: list[Path], channel_map: Path | None) -> None:
    """Refuse an output of an unknown ending, and one that is an input."""
    from calib.logs.convert import ENDINGS

    if out.suffix.lower() not in ENDINGS:
        raise typer.BadParameter(
            f"must end in {', '.join(ENDINGS)}, or be a folder with --to", param_hint="--out"
        )
    refuse_folder(out)
    refuse_overwriting([out], logs, [channel_map])


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
    from calib.logs.convert import ENDINGS
    from calib.publish import publish, workshop

    ending = f".{to.lower().lstrip('.')}"
    if ending not in ENDINGS:
        known = ", ".join(e[1:] for e in ENDINGS)
        raise typer.BadParameter(f"unknown format {to!r}; known: {known}", param_hint="--to")
    names = [f"{stem}{ending}" for stem in stems_of(logs, "LOG")]
    refuse_overwriting((out / name for name in names), logs)
    ready_folder(out)
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
