"""`brake-cal map`: propose a channel map for a log of foreign names."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import complain, emit, emit_json, say
from cli.grid import facts_grid
from cli.group import command_group
from cli.inputs import channel_map_of
from cli.loudness import this_run
from cli.options import Force, Json, example, map_file, out_file
from cli.outputs import refuse_folder, refuse_foreign, refuse_overwriting, writing

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.suggest.propose import Suggestion

UNCERTAIN = 3
"""Exit code for a log that leaves something open, or has no channel at all."""
NOT_ENOUGH = 1
"""Exit code for a map without a channel that every log needs, as that of `check` for such a log."""

app = command_group(
    "Channel maps: which column of a log is which channel.",
    "brake-cal map suggest sample_logs/sedan/ramp_wet_asphalt.csv",
)


@app.command(
    epilog=example("brake-cal map suggest sample_logs/sedan/ramp_wet_asphalt.csv --out map.toml")
)
def suggest(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="log of foreign names")],
    take: Annotated[
        list[str] | None,
        typer.Option(
            "--take",
            metavar="CHANNEL=NAME",
            help="Source of a channel, 'p_mc=Brake [bar]'; empty NAME: no source.",
        ),
    ] = None,
    radius: Annotated[
        float | None,
        typer.Option(metavar="M", help="Radius [m] for wheel speeds in km/h.", min=0.1, max=1.0),
    ] = None,
    channel_map: Annotated[
        Path | None, map_file("Its file format and DBC; not that of the settings.")
    ] = None,
    out: Annotated[Path | None, out_file("Map file to write.", "M.toml")] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Propose a channel map for a log of foreign names.

    It rests on names, units and physics, and says how sure it is. Prints the map on stdout and the
    reasons on stderr. Where something is ambiguous it lists the candidates, writes no map and ends
    with 3. It ends with 1 if the log lacks what every log needs, such as the pressure. Of --map
    only file format and DBC are used; the new map keeps them.
    """
    from calib.logs.read import open_log
    from calib.suggest.propose import suggest as propose
    from calib.suggest.propose import to_toml, tried

    taken = dict(_pair(text) for text in take or [])
    if out is not None:
        refuse_folder(out)
        refuse_overwriting([out], [log], [channel_map])
    read_with = channel_map_of(channel_map)
    found = propose(open_log(log, read_with).source, str(log), told=taken, radius=radius)
    found = tried(found, log, read_with)
    toml = to_toml(found, read_with, None if out is None else out.absolute().parent)
    if out is not None:
        refuse_foreign(out, lambda data: data == toml.encode(), "this map", force)
    written = not found.doubts and bool(found.proposals)
    if json:
        document = {**asdict(found), "toml": toml if written else None}
        emit_json({"schema": 1, "certain": not found.doubts, **document})
    else:
        _tell(found)
    for doubt in found.doubts:
        complain(f"{doubt.channel}: {doubt}")
    if not written:
        if not found.doubts:
            complain(f"{log}: no column is a channel; name them: --take CHANNEL=NAME")
        raise typer.Exit(UNCERTAIN)
    if out is not None:
        from calib.base.write import write_whole

        with writing(out):
            write_whole(out, toml.encode())
        say(f"wrote {out}")
    elif not json:
        emit(toml.rstrip("\n"))
    if found.missing:
        complain(f"{log}: {', '.join(found.missing)} missing: no table can be made of this log")
        raise typer.Exit(NOT_ENOUGH)


def _pair(text: str) -> tuple[str, str]:
    channel, equals, name = text.partition("=")
    if not equals:
        raise typer.BadParameter(f"{text!r} is not CHANNEL=NAME", param_hint="--take")
    return channel.strip(), name.strip()


def _tell(found: "Suggestion") -> None:
    from cli.console import console

    if not this_run().quiet:
        console().print(_grid(found))


def _grid(found: "Suggestion") -> "Grid":
    from calib.suggest.propose import to_lines

    grid = facts_grid()
    for label, text in to_lines(found):
        grid.add_row(label, text)
    return grid
