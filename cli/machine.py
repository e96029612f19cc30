"""`brake-cal demo` and `qualify`: the program tried on this machine."""

import glob
import io
import json
import os
import shlex
import shutil
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from contextvars import copy_context
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from calib.base.names import VERSION
from cli.command import FAILED, Answer, command
from cli.console import json_text, progress, say
from cli.options import option
from cli.outputs import check_folder, write_file, write_folder

if TYPE_CHECKING:
    from calib.help.demo import Ran, Step

DOCUMENT, REPORT = "qualification.json", "qualification.html"


@command("brake-cal qualify", "brake-cal qualify --out qualification")
def qualify(
    *,
    store: Path | None = option("Directory of the tables; else as usual.", "DIR"),
    out: Path | None = option(
        f"Try it, and write {DOCUMENT} and {REPORT}.", "DIR", writes="folder"
    ),
) -> Answer:
    """Say whether the program works on this machine.

    It looks at packages, extras, machine, store and settings, and writes nothing. With --out the
    program is tried against known truths, and the checks are written with their results. Exit code
    1 if something that it needs is wrong, or a check does not hold.
    """
    from calib.help.doctor import FINE, WRONG, doctor_facts, examine

    if out is not None:
        return _qualified(out)
    findings = examine(store)
    works = all(finding.state != WRONG for finding in findings)
    document = {"version": VERSION, "verdict": FINE if works else WRONG, "findings": findings}
    return Answer(document, doctor_facts(findings), FAILED * (not works))


def _qualified(out: Path) -> Answer:
    """Try the program against known truths, and write the results into ``out``."""
    from calib.base.plain import counted
    from calib.help.qualify import SUITE, qualification_facts
    from calib.help.qualify import qualify as run_checks
    from calib.show.html import page_of

    check_folder(out, (DOCUMENT, REPORT))
    task = f"comparing {counted(sum(map(len, SUITE.values())), 'number')} of the sample logs"
    with progress(task, len(SUITE)) as step:
        document = run_checks(SUITE, datetime.now(UTC).isoformat(timespec="seconds"), step)
    facts = qualification_facts(document)
    contents = (REPORT, page_of(facts).encode()), (DOCUMENT, json_text(document).encode())
    write_folder(out, contents, DOCUMENT)
    return Answer(document, facts, FAILED * (document["verdict"] == "failed"))


@command("brake-cal demo", "brake-cal demo --out somewhere")
def demo(
    *,
    out: Path = option("Of all files.", "DIR", writes="folder", built_in=Path("brake-cal-demo")),
) -> Answer:
    """Try the program on the sample logs, in about half a minute.

    Runs commands that check, fit, validate, diagnose and draw, and says what each answered; a page
    links the pages they wrote and the paper's figures. Exit code 1 if one gave another answer than
    expected.
    """
    from calib.help.demo import INDEX, STEPS, demo_facts
    from calib.help.samples import sample_logs
    from calib.show.html import page_of

    check_folder(out, (INDEX,))
    shutil.copytree(sample_logs(), out / "sample_logs", dirs_exist_ok=True)
    ran = {}
    with progress(f"running {len(STEPS)} commands in {out}", len(STEPS)) as advance:
        for step in STEPS:
            ran[step] = answer = _run(out, step)
            if not step.figure or not answer.passed:
                failed = "" if answer.passed else "FAILED: "
                say(f"\n{step.purpose}\n  {step.line}\n  {failed}{answer.answer}")
            advance()
    index = demo_facts(ran, out)
    write_file(out / INDEX, page_of(index).encode())
    answers = [vars(step) | vars(answer) for step, answer in ran.items()]
    document = {"folder": out, "index": out / INDEX, "verdict": index.verdict, "steps": answers}
    facts = replace(index, tables=[], next=f"open {out / INDEX}")
    return Answer(document, facts, FAILED * (index.verdict == "failed"))


def _run(folder: Path, step: "Step") -> "Ran":
    """Run one line as a shell in ``folder`` would.

    Its answer is the first line that it prints; that of `plot` is what the picture says.
    """
    from calib.base.names import SETTINGS_VARIABLE
    from calib.help.demo import Ran
    from cli.main import main

    environment, argv = dict(os.environ), sys.argv
    os.environ[SETTINGS_VARIABLE] = ""  # no settings of a project around it
    os.environ.pop("COLUMNS", None)  # lines stay whole
    out, err, code = io.StringIO(), io.StringIO(), 0
    draws = step.line.startswith("brake-cal plot ")
    with chdir(folder), redirect_stdout(out), redirect_stderr(err):
        words = shlex.split(f"{step.line} {'--json' if draws else '-q'}")
        sys.argv = [file for word in words for file in sorted(glob.glob(word)) or [word]]
        try:
            copy_context().run(main)
        except SystemExit as ended:
            code = int(ended.code or 0)
        finally:
            sys.argv = argv
            os.environ.clear()
            os.environ.update(environment)
    if draws and not code:
        (sheet,) = json.loads(out.getvalue())["sheets"]
        answer = sheet["result"] or sheet["title"]
    else:
        answer = "".join((out.getvalue() or err.getvalue()).strip().splitlines()[:1])
    return Ran(answer, not code and step.expected in answer)
