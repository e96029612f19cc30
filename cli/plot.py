"""`brake-cal plot`: tables, results and logs as figures in a file."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.completion import table_names
from cli.inputs import channel_map_of, limits_of_stops, tables_of, vehicle_of
from cli.logs import is_stdin, named, read
from cli.options import (
    Force,
    Json,
    Map,
    Store,
    example,
    limits_file,
    out_file,
    vehicle_file,
)
from cli.outputs import refuse_no_picture, writing
from cli.project import STORE, from_settings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from calib.show.choose import PlotInput
    from calib.show.sheet import Sheet

EPILOG = example(
    "brake-cal plot sedan-2up",
    "brake-cal plot sedan-2up sample_logs/sedan/ramp_wet_asphalt.csv --out ramp.pdf",
    "brake-cal plot sedan-2up sample_logs/sedan/basalt_wet_pads.csv --compare",
    "brake-cal plot sedan-2up@1 sedan-2up@2 --figure f1-f2 --out f1f2.svg",
)
ALL = "all"
"""Value of `--figure` for each figure on its own page."""


def plot(
    what: Annotated[
        list[str],
        typer.Argument(
            metavar="TABLE|RESULT|LOG...",
            help="A table (name, name@version or path), a log, a result of validate.",
            autocompletion=table_names,
        ),
    ],
    out: Annotated[Path | None, out_file("File to write: .png, .svg or .pdf.")] = None,
    store: Store = STORE,
    vehicle: Annotated[
        Path | None, vehicle_file("Vehicle whose pads are the nominal ones; never the settings'.")
    ] = None,
    figure: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="One figure of the page; 'all': each on its own."),
    ] = None,
    limits: Annotated[
        Path | None,
        limits_file("Limits that decide the verdict on a stop.", callback=from_settings("limits")),
    ] = None,
    compare: Annotated[
        bool, typer.Option("--compare", help="Draw other methods beside the estimate of a stop.")
    ] = False,
    force: Force = False,
    channel_map: Map = None,
    json: Json = False,
) -> None:
    """Draw tables, logs and results.

    A table: its curves, and with the ramps it was made of, their measured points. Two tables: one
    against the other. A table and another log: the stop with the estimate and the verdict, or the
    simulation if the log has the truth; a log of another car is refused. A log or a result: its
    channels.

    One page for each; a PDF holds all pages, of PNG and SVG there is one file per page. Without
    --out they are PNG files in this directory, named after their content.
    """
    if out is not None:
        refuse_no_picture(out, force)
    from dataclasses import replace

    from calib.show.sheet import save
    from cli.console import emit, emit_json, progress, say

    given = _read(what, store, vehicle, channel_map)
    stops = bool(given.tables and given.logs)
    if compare and not stops:
        raise typer.BadParameter("only with a TABLE and a LOG", param_hint="--compare")
    if stops:
        given = replace(given, limits=limits_of_stops(limits), compare=compare)
    drawn = _draw(given, figure)
    files = _files(drawn, out, figure)
    pages = sum(map(len, files.values()))
    with writing(out), progress(f"drawing {pages} page{'s' * (pages > 1)}", pages) as done:
        save(files, done)
    if json:
        emit_json({"schema": 1, "files": list(files), "sheets": [_document(s) for s, _ in drawn]})
        return
    for path in files:
        emit(str(path))
    for sheet, _ in drawn:
        say(f"{sheet.title}: {', '.join(sheet.names)} (one alone with --figure NAME)")


def _read(
    what: list[str], store: Path, vehicle: Path | None, channel_map: Path | None
) -> "PlotInput":
    """Read all inputs; a name that is no log and no result is a table."""
    from calib.logs.formats import ending_of
    from calib.logs.read import FORMATS, REQUIRED
    from calib.show.choose import PlotInput
    from calib.show.result import is_result, read_result
    from calib.store.folders import RECORD

    files = [Path(w) for w in what]
    results = [p for p in files if is_result(p)]
    logs = [
        p
        for p in files
        if p not in results
        and p.name != RECORD
        and not p.is_dir()
        and (is_stdin(p) or ending_of(p) in FORMATS or p.is_file())
    ]
    names = [w for w, p in zip(what, files, strict=True) if p not in results and p not in logs]
    _check_usage(len(names), len(logs), len(results), vehicle is not None)
    named(logs)
    mapping = channel_map_of(channel_map)
    needed = REQUIRED if names else ()  # a log alone is drawn with the channels that it has
    return PlotInput(
        tables=tables_of(store, names),
        logs=tuple(read(path, mapping, require=needed) for path in logs),
        results=tuple(read_result(path) for path in results),
        vehicle=vehicle_of(vehicle),
    )


def _check_usage(tables: int, logs: int, results: int, vehicle: bool) -> None:
    if tables > 2 or (tables == 2 and logs):
        raise typer.BadParameter(
            "give one table with its logs, or two tables without logs", param_hint="TABLE"
        )
    if vehicle and not results and not (tables and logs):
        raise typer.BadParameter(
            "only with a TABLE and a LOG, or with a RESULT", param_hint="--vehicle"
        )


def _draw(given: "PlotInput", figure: str | None) -> "list[tuple[Sheet, dict[str, Figure]]]":
    """Every sheet with its figures by name; the page itself has the name ''."""
    from calib.show.choose import sheets

    drawn = []
    for sheet in sheets(given):
        if figure is None:
            figures = {"": sheet.overview()}
        elif figure == ALL:
            figures = {name: sheet.figure(name) for name in sheet.names}
        elif figure in sheet.names:
            figures = {figure: sheet.figure(figure)}
        else:
            raise typer.BadParameter(
                f"{sheet.title} has no {figure!r}; one of {', '.join((*sheet.names, ALL))}",
                param_hint="--figure",
            )
        drawn.append((sheet, figures))
    return drawn


def _files(
    drawn: "list[tuple[Sheet, dict[str, Figure]]]", out: Path | None, figure: str | None
) -> "dict[Path, list[Figure]]":
    """Figures by file: one PDF for all, else one file for each, named after its content."""
    if out is not None and out.suffix.lower() == ".pdf":
        return {out: [f for _, figures in drawn for f in figures.values()]}
    files: dict[Path, list[Figure]] = {}
    for sheet, figures in drawn:
        for name, found in figures.items():
            prefix = sheet.name if out is None or len(drawn) > 1 else ""
            part = name if out is None or figure == ALL else ""
            stem = "-".join(p for p in (out.stem if out else "", prefix, part) if p)
            place = (out or Path("x.png")).with_name(f"{stem}{out.suffix if out else '.png'}")
            files[_unused(place, files)] = [found]
    return files


def _unused(path: Path, taken: "dict[Path, list[Figure]]") -> Path:
    """``path``, with a number where logs from several directories have the same name."""
    number, found = 1, path
    while found in taken:
        number += 1
        found = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return found


def _document(sheet: "Sheet") -> dict[str, object]:
    return {
        "kind": sheet.kind,
        "name": sheet.name,
        "title": sheet.title,
        "result": sheet.result,
        "note": sheet.note,
        "figures": sheet.names,
    }
