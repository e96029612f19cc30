"""`brake-cal demo`: command lines on the sample logs, run side by side as in a shell."""

import glob
import io
import os
import runpy
import shlex
import shutil
import sys
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import FAILED, Answer, command
from cli.console import progress, say, this_run
from cli.options import option
from cli.outputs import check_folder, write_file

if TYPE_CHECKING:
    from calib.help.demo import Ran, Step


@command("brake-cal demo", "brake-cal demo --out somewhere")
def demo(
    *,
    out: Path = option(
        "Folder for all files.", "DIR", writes="folder", built_in=Path("brake-cal-demo")
    ),
) -> Answer:
    """Try the program on the sample logs, in about fifteen seconds.

    Runs commands that check, fit, validate, diagnose and draw, and says what each answered; a page
    links the pages they wrote and the paper's figures. Exit code 1 if one gave another answer than
    expected.
    """
    from dataclasses import replace

    from calib.help.demo import CHAINS, INDEX, facts
    from calib.help.samples import sample_logs
    from calib.show.html import page_of

    check_folder(out, (INDEX,))
    shutil.copytree(sample_logs(), out / "sample_logs", dirs_exist_ok=True)
    count, ran = sum(map(len, CHAINS)), {}
    with progress(f"running {count} commands in {out}", count) as step:
        for one, got in _side_by_side(out, CHAINS):
            ran[one] = got
            if not one.figure or not got.passed:
                say(f"\n{one.what}\n  {one.line}\n  {'' if got.passed else 'FAILED: '}{got.answer}")
            step()
    found = facts(ran)
    write_file(out / INDEX, page_of(found).encode())
    answers = [vars(one) | vars(got) for one, got in ran.items()]
    return Answer(
        {"folder": out, "index": out / INDEX, "verdict": found.verdict, "steps": answers},
        replace(found, tables=[], next=f"open {out / INDEX}"),
        FAILED * (found.verdict == "failed"),
    )


def _side_by_side(
    folder: Path, chains: "tuple[tuple[Step, ...], ...]"
) -> "Iterator[tuple[Step, Ran]]":
    """Run the chains on all cores; each step as it is done. What fails ends its chain."""
    from calib.base.processes import cores, end, workers
    from calib.line.fleet.workers import PRELOADED

    drawing = ("matplotlib.figure", "matplotlib.backends.backend_pdf", "calib.show.choose")
    pool = workers(min(cores(), len(chains)), *PRELOADED, *drawing)
    running: dict[Future[Ran], tuple[Step, ...]] = {}
    waiting = [*chains]
    try:
        while waiting or running:
            for chain in waiting:
                running[pool.submit(_run, folder.resolve(), chain[0])] = chain
            waiting = []
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                (step, *rest), got = running.pop(future), future.result()
                yield step, got
                waiting += [tuple(rest)] * bool(rest and got.passed)
    finally:
        end(pool)


def _run(folder: Path, step: "Step") -> "Ran":
    """Run one line as `python -m cli.main` would, in a process that runs nothing else meanwhile.

    Its answer is its headline with the first two numbers; without one, the last line it prints.
    """
    from calib.base.names import SETTINGS_VARIABLE
    from calib.help.demo import Ran

    os.environ[SETTINGS_VARIABLE] = ""  # no settings of a project around it
    os.environ.pop("COLUMNS", None)  # lines stay whole
    os.chdir(folder)
    words = shlex.split(step.line)
    sys.argv = [file for word in words for file in sorted(glob.glob(word)) or [word]]
    out, err, code = io.StringIO(), io.StringIO(), 0
    with redirect_stdout(out), redirect_stderr(err):
        try:
            runpy.run_module("cli.main", run_name="__main__")
        except SystemExit as ended:
            code = int(ended.code or 0)
    facts, printed = this_run().facts, (out.getvalue() or err.getvalue()).strip().splitlines()
    if isinstance(facts, str) or not facts.headline:
        answer = printed[-1] if printed else ""
    else:
        answer = "; ".join([facts.said.rstrip("."), *map(" ".join, facts.numbers[:2])])
    return Ran(answer, not code and step.expected in answer)
