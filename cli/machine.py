"""`brake-cal doctor` and `qualify`: whether the program works on this machine."""

from datetime import UTC, datetime
from pathlib import Path

from calib.base.names import PROGRAM, VERSION
from cli.command import FAILED, Answer, command
from cli.console import json_text, progress
from cli.options import option
from cli.outputs import check_folder, write_folder

DOCUMENT, REPORT = "qualification.json", "qualification.html"


@command("brake-cal doctor", "brake-cal doctor --json")
def doctor(
    *, store: Path | None = option("Directory of the tables; else as usual.", "DIR")
) -> Answer:
    """Say whether the program can work on this machine.

    It looks at packages, extras, machine, store and settings, and writes nothing. Exit code 0 if
    it can work, 1 if something that it needs is wrong.
    """
    from calib.help.doctor import FINE, WRONG, examine
    from calib.show.facts import Facts, Table

    found = examine(store)
    wrong = [one.name for one in found if one.state == WRONG]
    can = f"cannot work here: {', '.join(wrong)}" if wrong else "can work here"
    rows = [(x.name, x.state, "; ".join(filter(None, (x.what, x.do)))) for x in found]
    heads, odd = ("what", "state", "found"), [row for row in rows if row[1] != FINE]
    verdict = WRONG if wrong else FINE
    return Answer(
        {"version": VERSION, "verdict": verdict, "findings": found},
        Facts(
            headline=f"{PROGRAM} {can}",
            tables=[Table(heads, odd)],
            parts=[Facts("All that was looked at", tables=[Table(heads, rows)])],
        ),
        FAILED * bool(wrong),
    )


@command("brake-cal qualify --out qualification")
def qualify(
    *, out: Path = option(f"Write {DOCUMENT} and {REPORT} here.", "DIR", writes="folder")
) -> Answer:
    """Try the program on this machine against known truths.

    Writes the environment and the checks with their results. Exit code 0 if all checks hold.
    """
    from calib.base.plain import counted
    from calib.help.qualify import SUITE, facts
    from calib.help.qualify import qualify as made
    from calib.show.html import page_of

    check_folder(out, (DOCUMENT, REPORT))
    task = f"comparing {counted(sum(map(len, SUITE.values())), 'number')} of the sample logs"
    with progress(task, len(SUITE)) as step:
        document = made(SUITE, datetime.now(UTC).isoformat(timespec="seconds"), step)
    page = page_of(facts(document)).encode()
    contents = [(REPORT, page), (DOCUMENT, json_text(document).encode())]
    write_folder(out, contents, DOCUMENT)
    return Answer(document, facts(document), FAILED * (document["verdict"] == "failed"))
