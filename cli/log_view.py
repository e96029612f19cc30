"""`brake-cal log view`: every column of a log, and the events of the run."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit_facts, emit_json, say
from cli.inputs import channel_map_of
from cli.logs import named, read_whole
from cli.options import Force, Json, Map, example, out_file
from cli.outputs import (
    PAGES,
    refuse_ending,
    refuse_no_page,
    refuse_no_picture,
    refuse_overwriting,
    writing,
)

if TYPE_CHECKING:
    from calib.logs.whole import Inventory, WholeLog
    from calib.run.events import RunEvent

EPILOG = example(
    "brake-cal log view sample_logs/sedan/ramp_wet_asphalt.csv",
    "brake-cal log view sample_logs/sedan/ramp_wet_asphalt.csv --out ramp.html",
)


def view(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="logs to look at")],
    out: Annotated[
        Path | None, out_file("Draw one log: .png, .svg, .pdf, or a page .html.")
    ] = None,
    channel: Annotated[
        list[str] | None,
        typer.Option("--channel", metavar="NAME", help="Only this column; may be repeated."),
    ] = None,
    force: Force = False,
    channel_map: Map = None,
    json: Json = False,
) -> None:
    """Show every column of logs, and the events of the run.

    With unit, range, rate and gaps. Columns of a --map have their canonical names; all others are
    shown as they are. Nothing is filtered or zeroed. --out draws all columns over one time axis,
    with the events marked.
    """
    named(logs)
    _check_out(out, logs, channel_map, force)
    mapping = channel_map_of(channel_map)
    found = []
    from calib.logs.whole import channels_log, inventory
    from calib.run.events import run_events
    from calib.show.log_page import facts

    for path in logs:
        whole = read_whole(path, mapping)
        events = run_events(channels_log(whole))
        shown = _chosen(whole, channel or [])
        found.append((shown, inventory(shown), events))
    if out is not None:
        _draw(*found[0], out)
    if json:
        emit_json({"schema": 1, "out": out, "logs": [_document(*one) for one in found]})
        return
    for one in found:
        emit_facts(facts(*one))


def _check_out(out: Path | None, logs: list[Path], channel_map: Path | None, force: bool) -> None:
    if out is None:
        return
    from calib.show.sheet import ENDINGS

    refuse_ending(out, (*ENDINGS, *PAGES))
    if len(logs) > 1:
        raise typer.BadParameter("one log can be drawn at a time", param_hint="--out")
    refuse_overwriting([out], logs, [channel_map])
    (refuse_no_page if _is_page(out) else refuse_no_picture)(out, force)


def _is_page(out: Path) -> bool:
    return out.suffix.lower() in PAGES


def _chosen(log: "WholeLog", names: list[str]) -> "WholeLog":
    from calib.base.toml import did_you_mean

    have = [column.name for column in log.columns]
    for name in names:
        if name not in have:
            hint = did_you_mean(name, have) or f"it has {', '.join(have)}"
            raise typer.BadParameter(f"no column {name!r}; {hint}", param_hint="--channel")
    return log.only(names) if names else log


def _draw(
    log: "WholeLog", columns: "tuple[Inventory, ...]", events: "tuple[RunEvent, ...]", out: Path
) -> None:
    from calib.base.write import write_whole
    from calib.show.html import page_of
    from calib.show.log_figure import MOST, figure, panels_of
    from calib.show.log_page import facts
    from calib.show.sheet import render

    count = len(panels_of(log))
    if not 0 < count <= MOST:
        raise typer.BadParameter(
            f"{count} panels; 1 to {MOST} can be drawn: choose columns", param_hint="--channel"
        )
    page = _is_page(out)
    drawn = render(figure(log, events), ".png" if page else out.suffix.lower())
    content = page_of(facts(log, columns, events, drawn)).encode() if page else drawn
    with writing(out):
        write_whole(out, content)
    say(f"wrote {out}")


def _document(
    log: "WholeLog", columns: "tuple[Inventory, ...]", events: "tuple[RunEvent, ...]"
) -> dict[str, object]:
    return {
        "log": log.name,
        "source": log.source,
        "digest": log.digest,
        "rows": log.time.size,
        "start": log.time[0],
        "end": log.time[-1],
        "columns": columns,
        "events": events,
        "notes": log.notes,
    }
