"""How many faults put into the code on purpose the tests catch.

    python tests/studies/faults.py [--tree DIR] [--only 3 --only 17] [--jobs 2] [--rows FILE]

Each row of `faults.toml` (or of another file, `--rows`) is a text that stands once in `calib/` or
`cli/` and the text put in its place: ten faults of the physics, ten of store and exports, ten of
readers and commands. Files may have moved: the text is looked for. Every fault is put into a copy
of the tree, and the tests of its folders run until one fails. "caught" if one does; "NOT CAUGHT" if
all pass; "no such text" or "several" if the row no longer fits the code.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.studies.study import arguments, carried_out  # noqa: E402

LEFT_OUT = shutil.ignore_patterns(".git", ".venv", "__pycache__", "*.egg-info", ".*_cache")
PATIENCE = 1800.0
"""Seconds after which the tests of a fault are given up."""


@dataclass(frozen=True)
class Fault:
    """``old`` text, ``new`` text, and folders of tests."""

    number: int
    kind: str
    old: str
    new: str
    tests: tuple[str, ...]
    tree: Path


def read(path: Path, tree: Path) -> list[Fault]:
    """The rows of the file, numbered from 1."""
    rows = [(kind, row) for kind, part in tomllib.loads(path.read_text()).items() for row in part]
    return [
        Fault(i, kind, row["old"], row["new"], tuple(row["tests"]), tree)
        for i, (kind, row) in enumerate(rows, 1)
    ]


def place(fault: Fault) -> tuple[str, Path | None]:
    """The file in which the text stands once; what is wrong where there is none."""
    files = [p for top in ("calib", "cli") for p in sorted((fault.tree / top).rglob("*.py"))]
    counts = {path: path.read_text(encoding="utf-8").count(fault.old) for path in files}
    matching = [path for path, n in counts.items() if n]
    if not matching:
        return "no such text", None
    return ("", matching[0]) if sum(counts.values()) == 1 else ("several", None)


def tried(fault: Fault) -> tuple[Fault, str, str]:
    """The fault, what became of it, and the test that caught it."""
    wrong, path = place(fault)
    if path is None:
        return fault, wrong, ""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "tree"
        shutil.copytree(fault.tree, copy, ignore=LEFT_OUT)
        spoilt = copy / path.relative_to(fault.tree)
        spoilt.write_text(spoilt.read_text(encoding="utf-8").replace(fault.old, fault.new))
        folders = [f"tests/{name}" for name in fault.tests if (copy / "tests" / name).is_dir()]
        words = [sys.executable, "-m", "pytest", "-x", "-q", "--tb=line", "-p", "no:cacheprovider"]
        try:
            ran = subprocess.run(
                [*words, *folders],
                cwd=copy,
                env={**os.environ, "PYTHONPATH": str(copy)},
                capture_output=True,
                text=True,
                timeout=PATIENCE,
            )
        except subprocess.TimeoutExpired:
            return fault, "given up", ""
    lines = [line for line in ran.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    caught = ran.returncode == 1 or bool(lines)
    return fault, "caught" if caught else "NOT CAUGHT", lines[0] if lines else ""


def main() -> None:
    """Run the study."""
    options = arguments(
        __doc__,
        tree=str(ROOT),
        rows=str(Path(__file__).with_suffix(".toml")),
        jobs=1,
        only=[str(i) for i in range(1, 31)],
    )
    faults = read(Path(options.rows), Path(options.tree).resolve())
    chosen = [fault for fault in faults if str(fault.number) in options.only]
    counts: Counter[tuple[str, str]] = Counter()
    for fault, word, test in carried_out(tried, chosen, options.jobs):
        counts[fault.kind, word] += 1
        print(f"{fault.number:3} {word:12} {fault.new.strip()[:60]:60} {test[:90]}", flush=True)
    for (kind, word), n in sorted(counts.items()):
        print(f"{kind:22} {word:12} {n}")


if __name__ == "__main__":
    main()
