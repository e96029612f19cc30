"""`brake-cal demo` and `qualify`: try the program on this machine."""

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

from calib.base.names import VERSION
from cli.command import FAILED, Answer, command
from cli.console import json_text, progress, say
from cli.options import option
from cli.outputs import check_folder, write_file, write_folder

DOCUMENT, REPORT = "qualification.json", "qualification.html"


@command("brake-cal qualify", "brake-cal qualify --out qualification")
def qualify(
    *,
    store: Path | None = option("Folder of the tables, else the usual one.", "DIR"),
    out: Path | None = option("Try the program; write each check here.", "DIR", writes="folder"),
) -> Answer:
    """Say whether the program works on this machine.

    It looks at packages, extras, machine, store and settings. With --out it compares results of the
    program with known truths instead, and writes each check with its result. Exit code 1 if
    something that the program needs is wrong, or a check does not hold.
    """
    from calib.help.doctor import FINE, WRONG, doctor_facts, examine

    if out is not None:
        return _qualified(out)
    findings = examine(store)
    is_wrong = any(finding.state == WRONG for finding in findings)
    document = {"version": VERSION, "verdict": WRONG if is_wrong else FINE, "findings": findings}
    return Answer(document, doctor_facts(findings), FAILED if is_wrong else 0)


def _qualified(out: Path) -> Answer:
    from calib.base.plain import counted
    from calib.help.qualify import SUITE, qualification_facts
    from calib.help.qualify import qualify as run_checks
    from calib.show.html import page_of

    check_folder(out, (DOCUMENT, REPORT))
    task = f"comparing {counted(sum(map(len, SUITE.values())), 'number')} of the sample logs"
    with progress(task, len(SUITE)) as step:
        document = run_checks(SUITE, datetime.now(UTC).isoformat(timespec="seconds"), step)
    facts = qualification_facts(document)
    page, text = page_of(facts).encode(), json_text(document).encode()
    write_folder(out, [(REPORT, page), (DOCUMENT, text)], DOCUMENT)
    return Answer(document, facts, FAILED if document["verdict"] == "failed" else 0)


@command("brake-cal demo", "brake-cal demo --out somewhere")
def demo(
    *, out: Path = option("Folder.", "DIR", writes="folder", built_in=Path("brake-cal-demo"))
) -> Answer:
    """Try the program on the sample logs, in about half a minute.

    It runs commands that check, fit, validate, diagnose and draw, and says what each answered. A
    page links the pages that they wrote and the figures of the paper. Exit code 1 if a command gave
    another answer than expected.
    """
    from calib.help.demo import INDEX, STEPS, Ran, demo_facts
    from calib.help.samples import sample_logs
    from calib.show.html import page_of

    check_folder(out, (INDEX,))
    shutil.copytree(sample_logs(), out / "sample_logs", dirs_exist_ok=True)
    results = {}
    with progress(f"running {len(STEPS)} commands in {out}", len(STEPS)) as advance:
        for step in STEPS:
            answer, code = _run(out, step.line)
            result = Ran(answer, code == 0 and step.expected in answer)
            results[step] = result
            if not step.figure or not result.passed:
                failed = "" if result.passed else "FAILED: "
                say(f"\n{step.purpose}\n  {step.line}\n  {failed}{result.answer}")
            advance()
    index = demo_facts(results, out)
    write_file(out / INDEX, page_of(index).encode())
    answers = [vars(step) | vars(result) for step, result in results.items()]
    document = {"folder": out, "index": out / INDEX, "verdict": index.verdict, "steps": answers}
    facts = replace(index, tables=[], next=f"open {out / INDEX}")
    return Answer(document, facts, FAILED if index.verdict == "failed" else 0)


def _run(folder: Path, command_line: str) -> tuple[str, int]:
    """Run a command as a shell in ``folder`` would; return its answer and its exit code.

    The answer is the first printed line; of `plot`, it is the result or title of the picture.
    """
    from calib.base.names import SETTINGS_VARIABLE
    from cli.main import main

    environment, argv = dict(os.environ), sys.argv
    os.environ[SETTINGS_VARIABLE] = ""  # the settings of a project around the folder do not count
    os.environ.pop("COLUMNS", None)  # lines stay whole
    out, err, code = io.StringIO(), io.StringIO(), 0
    is_plot = command_line.startswith("brake-cal plot ")
    with chdir(folder), redirect_stdout(out), redirect_stderr(err):
        sys.argv = []
        for word in shlex.split(f"{command_line} {'--json' if is_plot else '-q'}"):
            sys.argv += sorted(glob.glob(word)) or [word]
        try:
            copy_context().run(main)
        except SystemExit as ended:
            code = int(ended.code or 0)
        finally:
            sys.argv = argv
            os.environ.clear()
            os.environ.update(environment)
    if is_plot and code == 0:
        (sheet,) = json.loads(out.getvalue())["sheets"]
        return sheet["result"] or sheet["title"], code
    lines = (out.getvalue() or err.getvalue()).strip().splitlines()
    return lines[0] if lines else "", code
