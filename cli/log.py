"""`brake-cal check` and `log`: for what a log can be used, what is in it, its other formats."""

from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import FAILED, UNREADABLE, Answer, command
from cli.console import complain, misuse, progress, say
from cli.logs import read
from cli.options import Map, argument, option, require_known
from cli.outputs import PAGES, write_file, write_page

if TYPE_CHECKING:
    from calib.logs.whole import Inventory, WholeLog
    from calib.plausibility.check import Findings
    from calib.run.events import RunEvent


@command("brake-cal check sample_logs/sedan/*.csv")
def check(logs: list[Path] = argument("logs to check", "LOG..."), *, channel_map: Map) -> Answer:
    """Say for what each log can be used, as far as can be told without a vehicle file.

    One line for each; -v shows what the log contains as well. Exit code 1 if a log is usable for
    nothing, 3 if one cannot be read.
    """
    from calib.base.errors import InputError
    from calib.plausibility.check import check as look_at
    from calib.plausibility.check import to_dict
    from calib.show.check import check_facts

    findings: list[Findings] = []
    failed: list[tuple[Path, InputError]] = []
    with progress() as step:  # a log that cannot be read does not stop the check of the others
        for i, path in enumerate(logs):
            step(f"reading {path.name}", i, len(logs))
            try:
                findings.append(look_at(read(path, channel_map, require=())))
            except InputError as error:
                failed.append((path, error))
    for _, wrong in failed:
        complain(str(wrong))
    unreadable = [{"source": path, "error": str(wrong)} for path, wrong in failed]
    first = {"error": failed[0][1].to_dict()} if failed else {}
    document = {**first, "logs": [to_dict(f) for f in findings], "unreadable": unreadable}
    useless = FAILED * (not all(one.usable for one in findings))
    return Answer(document, check_facts(findings), UNREADABLE if failed else useless)


@command(
    "brake-cal log sample_logs/sedan/ramp_wet_asphalt.csv --out ramp.html",
    "brake-cal log sample_logs/sedan/dry_asphalt_stop.csv --from 0.5 --until 4 --out cut.csv",
)
def log(
    logs: list[Path] = argument("logs of any format", "LOG..."),
    *,
    out: Path | None = option(
        "Draw (.png, .svg, .pdf, .html) or write it (.csv, .parquet, .mf4).", "FILE", writes="log"
    ),
    start: float | None = option("Cut: first time [s]; else the start.", "TIME", "--from"),
    until: float | None = option("Cut: last time [s]; else the end.", "TIME"),
    si: bool = option("In SI units: pressures in Pa, as the code of an ECU takes them."),
    channel: list[str] = option("Show or draw only this column; may be repeated.", "NAME"),
    channel_map: Map,
) -> Answer:
    """Show, draw, cut or convert logs.

    Shows every column with unit, range, rate and gaps, and the events of the run. --out draws one
    log, or writes it in another format, with all columns and units, to the last bit. --from and
    --until cut at times of its own clock. Columns of a --map get their canonical names, sign and
    scale.
    """
    from calib.logs.whole import channels_log, cut, in_si, inventory, read_whole
    from calib.logs.write import WRITERS
    from calib.run.events import run_events
    from calib.show.facts import Facts
    from calib.show.log import document, log_facts, written

    if start is not None and until is not None and start >= until:
        raise misuse(f"{start:g} s is not before {until:g} s", "--from")
    if out is not None and len(logs) > 1:
        raise misuse("takes one log", "--out")
    looked: list[tuple[WholeLog, tuple[Inventory, ...], tuple[RunEvent, ...]]] = []
    for path in logs:
        whole = read_whole(path, channel_map)
        whole = whole if (start, until) == (None, None) else cut(whole, start, until)
        whole = in_si(whole) if si else whole
        for name in channel:
            require_known(name, [column.name for column in whole.columns], "column ")
        part = whole.only(channel) if channel else whole
        if out is not None and (write := WRITERS.get(out.suffix.lower())):
            write_file(out, write(part))
            for note in part.notes:
                say(f"{part.source}: {note}")
            written_log = written(part, out)
            message = f"{out}: {written_log['rows']} rows, {len(written_log['columns'])} columns"
            return Answer({"logs": [written_log]}, message)
        looked.append((part, inventory(part), run_events(channels_log(whole))))
    if out is not None:
        _draw(*looked[0], out)
    facts = Facts(parts=[log_facts(*one) for one in looked])
    return Answer({"out": out, "logs": [document(*one) for one in looked]}, facts)


def _draw(
    log: "WholeLog", columns: "tuple[Inventory, ...]", events: "tuple[RunEvent, ...]", out: Path
) -> None:
    from calib.show.log import MOST, log_facts, log_sheet, panels_of
    from calib.show.sheet import render

    if not 0 < (count := len(panels_of(log))) <= MOST:
        raise misuse(f"{count} panels; 1 to {MOST} can be drawn: choose columns", "--channel")
    if (ending := out.suffix.lower()) in PAGES:
        write_page(out, log_facts(log, columns, events))
    else:
        write_file(out, render(log_sheet(log, events).overview(), ending))
