"""What hostile files cost: exit code, seconds and memory of each case, and what is left behind.

python tests/studies/hostile.py [--only WORD] [--tree DIR] [--seconds 60]

Each case of `tests.support.hostile` runs in a process of its own. It is good if it ends with its
exit code within 20 s and 1 GB, says at most one line of error and no traceback, prints no control
character, and leaves no file. ``--tree`` runs another checkout of the program.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.support.hostile import CASES, RAW, Case  # noqa: E402

SECONDS, MEGABYTES = 20.0, 1000.0
MEASURED = """
import os, resource, sys
sys.argv[0] = "brake-cal"
from cli.main import main
try:
    main()
finally:
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    os.write(int(os.environ["USED"]), str(used).encode())
"""
"""Runs the command line and tells its largest memory [MB]."""


def run(case: Case, tree: Path, seconds: float) -> tuple[int, float, float, list[str]]:
    """Exit code, seconds, megabytes, and what is wrong."""
    with tempfile.TemporaryDirectory() as folder:
        words = case.make(Path(folder))
        before = {p.name for p in Path(folder).iterdir()}
        ours, theirs = os.pipe()
        env = {**os.environ, "PYTHONPATH": str(tree), "USED": str(theirs), "COLUMNS": "200"}
        start = time.monotonic()
        process = subprocess.Popen(
            [sys.executable, "-c", MEASURED, *words], cwd=folder, env=env, pass_fds=[theirs],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip
        os.close(theirs)
        try:
            out, err = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
        took = time.monotonic() - start
        used = os.read(ours, 100)
        os.close(ours)
        left = {p.name for p in Path(folder).iterdir()} - before
    megabytes = float(used) if used else float("nan")
    wrong = faults(case, process.returncode, took, megabytes, out, err, left)
    return process.returncode, took, megabytes, wrong


def faults(
    case: Case, code: int, took: float, used: float, out: bytes, err: bytes, left: set[str]
) -> list[str]:
    text = err.decode(errors="replace")
    both = out.decode(errors="replace") + text
    errors = text[text.find("error: ") :].splitlines() if "error: " in text else []
    found = {
        "traceback": "Traceback" in text,
        f"exit code, not {case.code}": code != case.code,
        "time": took > SECONDS,
        "memory": not used <= MEGABYTES,
        f"{len(errors)} lines": code == 3 and len(errors) != 1 and "Traceback" not in text,
        "terminal": RAW.search(both) is not None,
        f"left {sorted(left)}": bool(left),
    }
    return [name for name, is_so in found.items() if is_so]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--tree", type=Path, default=ROOT)
    parser.add_argument("--seconds", type=float, default=60.0)
    chosen = parser.parse_args()
    good = 0
    cases = [case for case in CASES if chosen.only in case.name]
    print(f"{'case':45} {'exit':>4} {'s':>6} {'MB':>6}")
    for case in cases:
        code, took, used, wrong = run(case, chosen.tree.resolve(), chosen.seconds)
        good += not wrong
        print(f"{case.name:45} {code:4} {took:6.1f} {used:6.0f}  {', '.join(wrong)}", flush=True)
    print(f"{good} of {len(cases)} good")


if __name__ == "__main__":
    main()
