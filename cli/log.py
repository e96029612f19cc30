"""`brake-cal log`: every column of a log and its events, a part of it, its other formats."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.command import Answer, command
from cli.console import Step, misuse, progress, say, this_run
from cli.logs import named, read_whole
from cli.options import Map, logs, option, quantity, require_known
from cli.outputs import (
    PAGES,
    check_file,
    check_folder,
    refuse_foreign,
    stems_of,
    write_file,
    write_folder,
)

if TYPE_CHECKING:
    from calib.logs.whole import Inventory, WholeLog
    from calib.run.driving_record import RunEvent

    Looked = tuple[WholeLog, tuple[Inventory, ...], tuple[RunEvent, ...]]

_TIME: dict[str, Any] = {"typed": str | None, "make": quantity("s", plain=True)}


@command(
    "brake-cal log sample_logs/sedan/ramp_wet_asphalt.csv --out ramp.html",
    "brake-cal log sample_logs/sedan/dry_asphalt_stop.csv --from 0.5 --until 4 --out cut.csv",
    "brake-cal log sample_logs/sedan/*.csv --out parquet --to parquet",
)
def log(
    logs: list[Path] = logs("logs of any format"),
    *,
    out: Path | None = option(
        "Draw (.png, .svg, .pdf, .html) or write (.csv, .parquet, .mf4) one log, or a folder "
        "with --to.",
        "FILE|DIR",
        writes="folder",
    ),
    to: str | None = option("csv, parquet or mf4, for a folder.", "FORMAT"),
    start: float | None = option(
        'Cut: first time, 1.5 or "1.5 s"; else the start.', "TIME", "--from", **_TIME
    ),
    until: float | None = option('Cut: last time, 4 or "4 s"; else the end.', "TIME", **_TIME),
    channel: list[str] = option("Show or draw only this column; may be repeated.", "NAME"),
    keep_names: bool = option("Leave names and values as they are, also those of a map."),
    force: bool = option("Replace a file that exists, whatever it holds."),
    channel_map: Map,
) -> Answer:
    """Show, draw, cut or convert logs.

    Shows every column with unit, range, rate and gaps, and the events of the run. --out draws them
    over one time axis, or writes the log in another format: all columns and units are kept, values
    are the same to the last bit. --from and --until cut at times of the log's own clock. Columns of
    a --map get their canonical names and the map's sign and scale, unless --keep-names. Nothing is
    filtered or zeroed; a log of several sample rates comes onto one clock.
    """
    from calib.logs.whole import channels_log, cut, inventory
    from calib.run.driving_record import run_events
    from calib.show.facts import Facts
    from calib.show.log import document, facts

    this_run().force = force
    if start is not None and until is not None and start >= until:
        raise misuse(f"{start:g} s is not before {until:g} s", "--from")

    def read_part(path: Path) -> "WholeLog":
        whole = read_whole(path, channel_map, keep_names)
        return _chosen(whole if start is until is None else cut(whole, start, until), channel)

    names = _checked(out, to, named(logs))
    if out is not None and names:
        written = _write(logs, out, names, read_part, bool(to))
        lines = [f"{x['out']}: {x['rows']} rows, {len(x['columns'])} columns" for x in written]
        return Answer({"logs": written}, "\n".join(lines))
    looked: list[Looked] = []
    for path in logs:
        log = read_part(path)
        whole = read_whole(path, channel_map) if channel else log
        looked.append((log, inventory(log), run_events(channels_log(whole))))
    if out is not None:
        _draw(*looked[0], out)
    return Answer(
        {"out": out, "logs": [document(*one) for one in looked]},
        Facts(parts=[facts(*one) for one in looked]),
    )


def _write(
    logs: list[Path], out: Path, names: list[str], read: "Callable[[Path], WholeLog]", folder: bool
) -> list[dict[str, Any]]:
    """Write logs one by one, all or none; what is in each."""
    from calib.logs.write import WRITERS
    from calib.show.log import written

    rows: list[dict[str, Any]] = []

    def contents(step: Step) -> Iterator[tuple[str, bytes]]:
        for path, name in zip(logs, names, strict=True):
            log, place = read(path), out / name if folder else out
            content = WRITERS[place.suffix.lower()](log)
            refuse_foreign(place, content.__eq__)
            rows.append(written(log, place))
            yield name, content
            step()
            for note in log.notes:
                say(f"{log.source}: {note}")

    with progress("", len(logs)) as step:
        if folder:
            write_folder(out, contents(step), names[-1])
        else:
            write_file(out, next(contents(step))[1])
    return rows


def _checked(out: Path | None, to: str | None, logs: list[Path]) -> list[str]:
    """Names of the files to write, none for a drawing; refuses what cannot be written."""
    from calib.logs.write import WRITERS
    from calib.show.sheet import ENDINGS

    if to is not None:
        require_known(to.lower(), [ending[1:] for ending in WRITERS], "format ")
        if out is None:
            raise misuse("--to needs a folder", "--out")
        names = [f"{stem}.{to.lower()}" for stem in stems_of(logs, "LOG")]
        check_folder(out, names)
        return names
    if out is None:
        return []
    drawn = out.suffix.lower() in (*ENDINGS, *PAGES)
    check_file(out, "drawing" if drawn else "log")
    if len(logs) > 1:
        raise misuse("several logs need a folder and --to", "--out")
    return [] if drawn else [out.name]


def _chosen(log: "WholeLog", names: list[str]) -> "WholeLog":
    have = [column.name for column in log.columns]
    for name in names:
        require_known(name, have, "column ")
    return log.only(names) if names else log


def _draw(
    log: "WholeLog", columns: "tuple[Inventory, ...]", events: "tuple[RunEvent, ...]", out: Path
) -> None:
    from calib.show.html import page_of
    from calib.show.log import MOST, facts, panels_of, sheet
    from calib.show.sheet import ENDINGS, render

    if not 0 < (count := len(panels_of(log))) <= MOST:
        raise misuse(f"{count} panels; 1 to {MOST} can be drawn: choose columns", "--channel")
    picture = out.suffix.lower() in ENDINGS
    drawn = render(sheet(log, events).overview(), out.suffix.lower() if picture else ".png")
    write_file(out, drawn if picture else page_of(facts(log, columns, events, drawn)).encode())
