"""`brake-cal fleet`: a fleet and its line, from the results of a batch."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from calib.base.plain import counted
from cli.completion import names_of
from cli.console import emit, emit_facts, emit_json, json_text, progress, say
from cli.group import command_group
from cli.options import Json, example, out_folder
from cli.outputs import ready_folder, writing

if TYPE_CHECKING:
    from calib.line.fleet.summary import Summary

DOCUMENT, REPORT = "fleet.json", "report.html"
SHOWN = 10
"""Number of logs apart, and of recordings with copies, that are printed; fleet.json has all."""

app = command_group(
    "Evaluate many cars together.", "brake-cal fleet report checked/results.parquet --out fleet"
)


@app.command(
    epilog=example(
        "brake-cal fleet report checked/results.parquet --out fleet",
        "brake-cal fleet report validated/results.parquet --order eta_zero --json",
    )
)
def report(
    results: Annotated[
        Path, typer.Argument(metavar="RESULTS.parquet", help="Results of `brake-cal batch`.")
    ],
    *,
    order: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Column that orders the logs, else names.")
    ] = None,
    metric: Annotated[
        list[str] | None,
        typer.Option(
            "--figure",
            metavar="NAME",
            help="Only this metric; repeatable.",
            autocompletion=names_of("calib.estimation.metrics", "METRICS"),
        ),
    ] = None,
    out: Annotated[Path | None, out_folder("Write report.html, fleet.json, PNGs here.")] = None,
    json: Json = False,
) -> None:
    """Show distributions, outliers and drift of a batch of logs."""
    from calib.line.fleet.results import open_fleet
    from calib.line.fleet.summary import summarise
    from calib.show.fleet_page import document, facts

    ready_folder(out, (DOCUMENT, REPORT))
    opened = open_fleet(results, order)
    say(f"reading {counted(len(opened.logs), 'row')}, in the order of {opened.ordered_by}")
    found = summarise(opened, tuple(metric or ()))
    if out is not None:
        _write(found, results, out)
    if json:
        emit_json(document(found))
    else:
        emit_facts(facts(found))


@app.command(epilog=example("brake-cal fleet index runs"))
def index(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Folder of station runs.", exists=True, file_okay=False),
    ],
    json: Json = False,
) -> None:
    """Write a page of the last cars of a station.

    DIR/index.html has their verdicts, next steps and trends. DIR/live.html is the same page and
    loads itself again every 10 s. Each run is a folder below
    DIR, as `station --out` writes it. `watch --index DIR` keeps both up to date.
    """
    from calib.line.station.index import INDEX, LIVE
    from calib.show.station_index import write_index

    with writing(folder, "DIR"):
        number = write_index(folder)
    if json:
        emit_json({"schema": 1, "runs": number, "files": [folder / INDEX, folder / LIVE]})
    else:
        emit(f"{counted(number, 'run')}; {folder / INDEX}")


def _write(found: "Summary", results: Path, out: Path) -> None:
    """Draw all files first, then write them."""
    from calib.base.printable import printable
    from calib.base.publish import publish, workshop
    from calib.base.write import write_whole
    from calib.show.fleet_figure import picture_name, sheet
    from calib.show.fleet_page import document, report
    from calib.show.html import page_of
    from calib.show.sheet import render

    looks = [look for look in found.looks if look.values.size]
    title = printable(f"{results.absolute().parent.name}/{results.name}")
    contents = {}
    with progress(f"drawing {len(looks)} metrics", len(looks)) as done:
        for look in looks:
            name = picture_name(look.metric.name)
            contents[name] = render(sheet(found, look).overview(), ".png")
            done()
    contents[DOCUMENT] = json_text(document(found)).encode()
    contents[REPORT] = page_of(report(found, title)).encode()
    with writing(out), workshop(out) as work:
        for name, content in contents.items():
            write_whole(work / name, content)
        publish(work, out, DOCUMENT, _earlier)
    say(f"wrote {out}: report.html, fleet.json, {len(looks)} pictures")


def _earlier(out: Path) -> set[str]:
    """Pictures of an earlier report here."""
    import json

    from calib.show.fleet_figure import picture_name

    try:
        figures = json.loads((out / DOCUMENT).read_text(encoding="utf-8"))["figures"]
        return {picture_name(name) for name in figures}
    except (OSError, ValueError, TypeError, KeyError):
        return set()
