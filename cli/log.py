"""`brake-cal check` and `log`: say for what a log can be used; show, draw, cut or convert it."""

from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import FAILED, UNREADABLE, Answer, command
from cli.console import print_error, progress, say, usage_error
from cli.logs import read
from cli.options import Map, argument, option, require_known
from cli.outputs import PAGES, write_file, write_page

if TYPE_CHECKING:
    from calib.logs.whole import Inventory, WholeLog
    from calib.run.events import RunEvent


@command("brake-cal check sample_logs/sedan/*.csv")
def check(logs: list[Path] = argument("Logs to check.", "LOG..."), *, channel_map: Map) -> Answer:
    """Say for what each log can be used, without a vehicle file.

    Each log gets one line; -v shows also what it contains. Exit code 1 if a log is usable for
    nothing, 3 if one cannot be read.
    """
    from calib.base.errors import InputError
    from calib.plausibility.check import check as check_log
    from calib.plausibility.check import to_dict
    from calib.show.check import check_facts

    findings, failed = [], []  # failed: each log that cannot be read, with its error
    with progress() as step:
        for i, path in enumerate(logs):
            step(f"reading {path.name}", i, len(logs))
            try:
                findings.append(check_log(read(path, channel_map, require=())))
            except InputError as error:
                failed.append((path, error))
    for _, reason in failed:
        print_error(str(reason))
    document: dict[str, object] = {"error": failed[0][1].to_dict()} if failed else {}
    document["logs"] = [to_dict(finding) for finding in findings]
    document["unreadable"] = [{"source": path, "error": str(reason)} for path, reason in failed]
    code = 0 if all(finding.usable for finding in findings) else FAILED
    return Answer(document, check_facts(findings), UNREADABLE if failed else code)


@command(
    "brake-cal log sample_logs/sedan/ramp_wet_asphalt.csv --out ramp.html",
    "brake-cal log sample_logs/sedan/dry_asphalt_stop.csv --from 0.5 --until 4 --out cut.csv",
)
def log(
    logs: list[Path] = argument("Logs of any format.", "LOG..."),
    *,
    out: Path | None = option(
        "Draw (.png, .svg, .pdf, .html) or write it (.csv, .parquet, .mf4).", "FILE", writes="log"
    ),
    start: float | None = option("Cut: first time [s], else the start.", "TIME", "--from"),
    until: float | None = option("Cut: last time [s], else the end.", "TIME"),
    si: bool = option("Use SI units, as the code of an ECU takes them: pressures in Pa."),
    channel: list[str] = option("Show or draw only this column; repeatable.", "NAME"),
    channel_map: Map,
) -> Answer:
    """Show, draw, cut or convert logs.

    Every column is shown with unit, range, rate and gaps, and so are the events of the run. --out
    draws one log, or writes it in another format, with all columns and units, to the last bit.
    --from and --until cut at times of the clock of the log. Columns that --map names become
    channels, with their names, sign and scale.
    """
    from calib.logs.whole import channels_log, cut, in_si, inventory, read_whole
    from calib.logs.write import WRITERS
    from calib.run.events import run_events
    from calib.show.facts import Facts
    from calib.show.log import document, log_facts, written_document

    if start is not None and until is not None and start >= until:
        raise usage_error(f"{start:g} s is not before {until:g} s", "--from")
    if out is not None and len(logs) > 1:
        raise usage_error(f"takes one log; {len(logs)} were given", "--out")
    write = WRITERS.get(out.suffix.lower()) if out is not None else None
    contents = []
    for path in logs:
        whole = read_whole(path, channel_map)
        if start is not None or until is not None:
            whole = cut(whole, start, until)
        if si:
            whole = in_si(whole)
        for name in channel:
            names = [column.name for column in whole.columns]
            require_known(name, names, "column", "--channel")
        part = whole.only(channel) if channel else whole
        if out is not None and write is not None:  # the only log is converted
            write_file(out, write(part))
            for note in part.notes:
                say(f"{part.source}: {note}")
            written_log = written_document(part, out)
            message = f"{out}: {written_log['rows']} rows, {len(written_log['columns'])} columns"
            return Answer({"logs": [written_log]}, message)
        contents.append((part, inventory(part), run_events(channels_log(whole))))
    if out is not None:
        _draw(*contents[0], out)
    facts = Facts(parts=[log_facts(*content) for content in contents])
    return Answer({"out": out, "logs": [document(*content) for content in contents]}, facts)


def _draw(
    log: "WholeLog", columns: "tuple[Inventory, ...]", events: "tuple[RunEvent, ...]", out: Path
) -> None:
    from calib.show.log import MAX_PANELS, log_facts, log_sheet, panels_of
    from calib.show.sheet import render

    count, ending = len(panels_of(log)), out.suffix.lower()
    if not 0 < count <= MAX_PANELS:
        raise usage_error(f"{count} panels; draw 1 to {MAX_PANELS}: choose columns", "--channel")
    if ending in PAGES:
        write_page(out, log_facts(log, columns, events))
    else:
        write_file(out, render(log_sheet(log, events).overview(), ending))
