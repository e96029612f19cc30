"""`brake-cal log cut`: a part of a log, by the seconds of its own clock."""

from pathlib import Path
from typing import Annotated

import typer

from cli.console import emit, emit_json, say
from cli.inputs import channel_map_of, seconds_of
from cli.log_convert import KeepNames, check_file, write
from cli.logs import named, read_whole
from cli.options import Force, Json, Map, example, out_file

EPILOG = example(
    "brake-cal log cut sample_logs/sedan/dry_asphalt_stop.csv --from 0.5 --to 4 --out cut.csv"
)


def cut(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="log to cut")],
    out: Annotated[Path, out_file("File to write: .csv, .parquet or .mf4.")],
    start: Annotated[
        str | None,
        typer.Option("--from", metavar="TIME", help='First time, 1.5 or "1.5 s"; else the start.'),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option("--to", metavar="TIME", help='Last time, 4 or "4 s"; else the end.'),
    ] = None,
    keep_names: KeepNames = False,
    force: Force = False,
    channel_map: Map = None,
    json: Json = False,
) -> None:
    """Write the part of a log between two times.

    The times are those of the log's own clock, in seconds unless a unit is given. All columns,
    units and times are kept, also columns that the program does not know. Columns of a --map get
    their canonical names, unless --keep-names.
    """
    from calib.logs.verify import MIN_SAMPLES
    from calib.logs.whole import cut as cut_log

    check_file(out, [log], channel_map)
    if start is None and end is None:
        raise typer.BadParameter("give --from, --to or both", param_hint="--from")
    first, last = seconds_of(start, "--from"), seconds_of(end, "--to")
    if first is not None and last is not None and first >= last:
        raise typer.BadParameter(f"{first:g} s is not before {last:g} s", param_hint="--from")
    whole = read_whole(log, channel_map_of(channel_map), keep_names)
    part = cut_log(whole, first, last)
    write(part, out, force)
    time, every = part.time, whole.time
    if json:
        emit_json(
            {
                "schema": 1,
                "log": named([log])[0],
                "out": out,
                "rows": time.size,
                "start": time[0],
                "end": time[-1],
                "of": every.size,
                "notes": part.notes,
            }
        )
    else:
        emit(
            f"{out}: {time.size} of {every.size} rows, {time[0]:g} to {time[-1]:g} s of "
            f"{every[0]:g} to {every[-1]:g} s, {len(part.columns)} columns"
        )
    for note in part.notes:
        say(f"note: {note}")
    if time.size < MIN_SAMPLES:
        say(f"note: other commands need {MIN_SAMPLES} rows")
