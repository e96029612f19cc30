"""`brake-cal map`: propose a channel map for a log of foreign names."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import complain, emit, emit_json, say
from cli.grid import facts_grid
from cli.inputs import channel_map_of
from cli.options import Json, example, map_file, out_file
from cli.outputs import refuse_folder, refuse_overwriting, writing

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.suggest.proposal import Suggestion

UNCERTAIN = 3

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Channel maps: which column of a foreign log is which channel.",
    epilog=example("brake-cal map suggest sample_logs/real/toyota_brake.csv"),
)


@app.callback()
def group() -> None:
    """Channel maps: which column of a foreign log is which channel."""


@app.command(
    epilog=example("brake-cal map suggest sample_logs/real/toyota_brake.csv --out map.toml")
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
        Path | None, map_file("Its file format; not that of the settings.")
    ] = None,
    out: Annotated[Path | None, out_file("Map file to write.", "M.toml")] = None,
    json: Json = False,
) -> None:
    """Propose a channel map for a LOG from names, units and physics, with its confidence.

    Prints the map on stdout and the reasons on stderr. Where something is ambiguous it lists the
    candidates, writes no map and ends with 3. Of --map only the file format is used.
    """
    from calib.logs.read import open_log
    from calib.suggest.propose import suggest as propose
    from calib.suggest.written import to_toml

    taken = dict(_pair(text) for text in take or [])
    if out is not None:
        refuse_folder(out)
        refuse_overwriting([out], [log], [channel_map])
    source = open_log(log, channel_map_of(channel_map)).source
    found = propose(source, str(log), told=taken, radius=radius)
    if json:
        emit_json({"schema": 1, "certain": not found.doubts, **_document(found)})
    else:
        _tell(found)
    if found.doubts:
        for doubt in found.doubts:
            complain(f"{doubt.channel}: {doubt.why}: {', '.join(doubt.candidates)}; {doubt.do}")
        raise typer.Exit(UNCERTAIN)
    if out is not None:
        from calib.files import write_whole

        with writing(out):
            write_whole(out, to_toml(found).encode())
        say(f"wrote {out}")
    elif not json:
        emit(to_toml(found).rstrip("\n"))


def _pair(text: str) -> tuple[str, str]:
    channel, equals, name = text.partition("=")
    if not equals:
        raise typer.BadParameter(f"{text!r} is not CHANNEL=NAME", param_hint="--take")
    return channel.strip(), name.strip()


def _document(found: "Suggestion") -> dict[str, object]:
    from dataclasses import asdict

    from calib.suggest.written import to_toml

    toml = None if found.doubts else to_toml(found)
    return {**asdict(found), "toml": toml}


def _tell(found: "Suggestion") -> None:
    from cli.console import console

    console().print(_grid(found))


def _grid(found: "Suggestion") -> "Grid":
    from calib.suggest.written import to_lines

    grid = facts_grid()
    for label, text in to_lines(found):
        grid.add_row(label, text)
    return grid
