"""Shows that the commands give the same numbers before and after a rebuild of the code.

    python tests/studies/equality.py record DIR [--command /path/to/brake-cal] [--jobs 2]
    python tests/studies/equality.py compare BEFORE AFTER [--tolerance 1e-9]

`record` copies the sample logs and the stored tables into DIR/inputs and types every line of
`equality.calls` in DIR. DIR/FOLDER/ holds what one call gave: `call.json` (what was typed, exit
code), `stdout.json`, and every file that was written. Nothing of the code is imported.

`compare` reads both folders and compares every number of every call that both have:

    |a - b| <= tolerance * max(1, |a|, |b|)

NaN equals NaN. Strings must be equal, but for those that are a number with its unit, and so must
keys, columns, units and files. The order of keys is free, that of columns, rows and lists is not.
JSON, TOML, CSV and Parquet are compared by key or column, exports by their numbers and the text
between them; pages, pictures and what is printed for people are not. Exit code 1 if anything
differs. What is left out stands in the rules below.
"""

import argparse
import csv
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
from jinja2 import Environment, StrictUndefined

ROOT = Path(__file__).parents[2]
CALLS = Path(__file__).with_suffix(".calls")
LOGS, TABLES, BROKEN = "inputs/sample_logs", "inputs/tables", "inputs/broken"
PATIENCE = 600.0
"""Seconds after which a call is given up."""
SHOWN = 20
"""Differing places that are printed of each kind of output."""

# The rules --------------------------------------------------------------------------------------

LEFT_OUT = {
    "arguments": "commands are renamed",
    "seconds": "a duration",
    "program": "the version of the code",
    "brake_cal.program": "the version of the code, in the metadata of results.parquet",
    "bytes": "the length of an export changes with the version's length",
    "pandas": "metadata of pandas",
    "ARROW:schema": "metadata of Arrow",
}
MASKED = (
    (re.compile(r"brake-cal \d+\.\d+[\w.+]*"), "brake-cal VERSION"),
    (re.compile(r"<DATE>[\d-]+</DATE>"), "<DATE>"),  # the day of storing: in a station's run today
)
DIGEST = re.compile(r"(?<![\w.])(?=[0-9a-f]*[a-f])(?:[0-9a-f]{64}|[0-9a-f]{16}|[0-9a-f]{12})(?!\w)")
"""A SHA-256, whole or its beginning. That of an input is compared. That of an output is not: it
follows from every key's name and from the last bit of every number in it."""

# Recording --------------------------------------------------------------------------------------


def write_inputs(home: Path) -> None:
    """Copy what the commands read, and make the rest: two plans, and a store with damage in it."""
    shutil.copytree(ROOT / "sample_logs", home / LOGS, ignore=shutil.ignore_patterns("*.png"))
    for store in (TABLES, BROKEN):
        shutil.copytree(ROOT / "tables", home / store)
    hurt = sorted((home / BROKEN).glob("sedan-2up/v0001/*.parquet"))[0]
    hurt.write_bytes(hurt.read_bytes()[:-1])
    rows = [("sedan", "ramp_wet_asphalt.csv"), ("sedan", "ramp_wet_asphalt_repeat.csv")]
    rows += [
        (f"hidden/{case.name}", f"calibration/{ramp}.parquet")
        for case in sorted((home / LOGS / "hidden").glob("case_*"))
        for ramp in ("ramp", "ramp_fast")
    ]
    with_station, without = ["log,car,station,vehicle"], ["log,car,vehicle"]
    for k, (folder, log) in enumerate(rows):
        car, vehicle = Path(folder).name, f"sample_logs/{folder}/vehicle.toml"
        with_station.append(f"sample_logs/{folder}/{log},{car},{'AB'[k % 2]},{vehicle}")
        without.append(f"sample_logs/{folder}/{log},{car},{vehicle}")
    for name, lines in (("plan", with_station), ("plan_cars", without)):
        (home / f"inputs/{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def chains(home: Path) -> dict[str, list[str]]:
    """The calls by section; those of a section follow each other."""

    def paths_of(*patterns: str) -> list[str]:
        paths = [p for pattern in patterns for p in sorted((home / LOGS).glob(pattern))]
        return [path.relative_to(home).as_posix() for path in paths]

    cases = {
        Path(path).parent.name: tomllib.loads((home / path).read_text(encoding="utf-8"))["name"]
        for path in paths_of("hidden/case_*/vehicle.toml")
    }
    template = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, autoescape=False
    ).from_string(CALLS.read_text(encoding="utf-8"))
    study = "simulation_study/*.parquet"
    text = template.render(
        cases=cases,
        driven_again=paths_of("sedan/*.csv", study, "third_party/*.parquet"),
        mapped=paths_of("sedan/*.csv", study, "third_party/cal*"),
    )
    calls: dict[str, list[str]] = {}
    for line in filter(None, map(str.strip, text.splitlines())):
        if line.startswith("["):
            section = calls.setdefault(line, [])
        else:
            section.append(line)
    return calls


def typed(words: str, name: str, home: Path) -> list[str]:
    """The words of a call, its folder and its files put in. Raises FileNotFoundError."""
    out = []
    for word in shlex.split(words.replace("@/", f"{name}/")):
        paths = sorted(home.glob(word)) if "*" in word else []
        if "*" in word and not paths:
            raise FileNotFoundError(f"{name}: no file {word}")
        out += [path.relative_to(home).as_posix() for path in paths] or [word]
    return out


def run(call: str, command: list[str], home: Path) -> tuple[str, int]:
    """Type one line in the folder of the recording, keep what comes out; its folder, exit code."""
    name, _, words = call.partition(": ")
    arguments = typed(words, name, home)
    folder = home / name
    folder.mkdir(parents=True)
    process = subprocess.run(
        [*command, *arguments],
        cwd=home,
        env={k: v for k, v in os.environ.items() if k != "FORCE_COLOR"} | {"NO_COLOR": "1"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=PATIENCE,
        check=False,
    )
    outcome = {"arguments": arguments, "exit_code": process.returncode}
    (folder / "call.json").write_text(json.dumps(outcome, indent=2) + "\n", encoding="utf-8")
    if "--json" in arguments and process.stdout:
        (folder / "stdout.json").write_bytes(process.stdout)
    refused = name.startswith("refused/")
    if b"Traceback" in process.stderr or (process.returncode not in (0, 1) and not refused):
        print(f"{name} ended with {process.returncode}: {process.stderr[-400:].decode()}")
    return name, process.returncode


def record(home: Path, command: list[str], jobs: int) -> None:
    """Run everything."""
    home.mkdir(parents=True)
    write_inputs(home)
    codes: dict[str, int] = {}

    def work(section: tuple[str, list[str]]) -> str:
        codes.update(run(call, command, home) for call in section[1])
        return f"{section[0]:<22} {len(section[1]):4} calls"

    with ThreadPoolExecutor(jobs) as pool:
        for line in pool.map(work, chains(home).items()):
            print(line, flush=True)
    print(f"{len(codes)} calls; exit codes {dict(sorted(Counter(codes.values()).items()))}")


# Reading: every file becomes named columns of numbers or of texts -------------------------------

Column = np.ndarray | tuple[str, ...]
Columns = Iterator[tuple[str, Column]]
Reword = Callable[[str], str]
QUANTITY = re.compile(r"([+-]?\d+\.?\d*(?:[eE][+-]?\d+)?) (\S+)")
"""A number with its unit, as vehicle files and models have it."""
NUMBER = re.compile(r"(?<![\w.])[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
"""A number in a text. Digits within a name (f1, sedan_2up) and hyphens within a word are text."""


def reworded(inputs: frozenset[str]) -> Reword:
    """A text without what is not compared."""

    def known_digest(match: re.Match[str]) -> str:
        return match[0] if any(digest.startswith(match[0]) for digest in inputs) else "DIGEST"

    def text(text: str) -> str:
        for pattern, put in MASKED:
            text = pattern.sub(put, text)
        return DIGEST.sub(known_digest, text)

    return text


def leaves(value: Any, text: Reword, place: str = "") -> Columns:
    """Leaves of a document, by the path of keys to each; a list of numbers is one leaf."""
    numeric = [isinstance(x, int | float) and not isinstance(x, bool)
               for x in (value if isinstance(value, list) else [value])]  # fmt: skip
    if isinstance(value, dict):
        yield f"{place}{{}}", ()
        for key, part in value.items():
            if key not in LEFT_OUT:
                yield from leaves(part, text, f"{place}.{key}" if place else key)
    elif numeric and all(numeric):
        yield place, np.array(value, dtype=float).reshape(-1)
    elif isinstance(value, list):
        yield f"{place}[]", (f"{len(value)} parts",)
        for i, part in enumerate(value):
            yield from leaves(part, text, f"{place}[{i}]")
    elif isinstance(value, str) and (quantity := QUANTITY.fullmatch(value)):
        yield place, np.array([float(quantity[1])])
        yield f"{place} unit", (quantity[2],)
    else:
        yield place, (text(value) if isinstance(value, str) else repr(value),)


def read_csv(path: Path, text: Reword) -> Columns:
    """Columns by their name and unit, without the remarks."""
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = csv.reader(line for line in lines if line and not line.startswith("#"))
    columns = list(zip_longest(*rows, fillvalue=""))
    yield "columns", tuple(head for head, *_ in columns)
    for head, *cells in columns:
        try:
            yield head, np.array([cell or "nan" for cell in cells], dtype=float)
        except ValueError:
            yield head, tuple(map(text, cells))


def read_parquet(path: Path, text: Reword) -> Columns:
    """Columns with their units and meanings, and the metadata of the file."""
    table = pq.read_table(path)
    yield "columns", tuple(table.column_names)
    for name, of in [("", table.schema), *zip(table.column_names, table.schema, strict=True)]:
        metadata = {key.decode(): value.decode() for key, value in (of.metadata or {}).items()}
        yield from leaves(metadata, text, f"{name} metadata")
    for name, column in zip(table.column_names, table.columns, strict=True):
        yield f"{name} type", (str(column.type), f"{column.null_count} nulls")
        values = column.to_pandas().to_numpy()
        numeric = values.dtype.kind in "iuf"
        yield name, values.astype(float) if numeric else tuple(text(str(v)) for v in values)


def read_text(path: Path, text: Reword) -> Columns:
    """All numbers of an export, and its lines with # for each number."""
    lines = text(path.read_text(encoding="utf-8", errors="replace")).splitlines()
    yield "numbers", np.array([float(n) for line in lines for n in NUMBER.findall(line)])
    yield "lines", tuple(NUMBER.sub("#", line) for line in lines)


READERS: dict[str, Callable[[Path, Reword], Columns]] = {
    ".json": lambda path, text: leaves(json.loads(path.read_text(encoding="utf-8")), text),
    ".toml": lambda path, text: leaves(tomllib.loads(path.read_text(encoding="utf-8")), text),
    ".csv": read_csv,
    ".parquet": read_parquet,
    **dict.fromkeys((".dcm", ".cdfx", ".a2l", ".h", ".xml"), read_text),
}


def read(path: Path, text: Reword) -> dict[str, Column]:
    """Columns by name; of two with one name none is lost."""
    out: dict[str, Column] = {}
    for name, column in READERS[path.suffix](path, text):
        while name in out:
            name += "'"
        out[name] = column
    return out


# Comparing --------------------------------------------------------------------------------------


def difference(a: Column, b: Column, tolerance: float) -> str | None:
    """What differs in words, or None."""
    if len(a) != len(b) or isinstance(a, tuple) != isinstance(b, tuple):
        return f"{len(a)} {type(a).__name__} != {len(b)} {type(b).__name__}"
    if isinstance(a, tuple):
        wrong = [i for i in range(len(a)) if a[i] != b[i]]
    else:
        same = (a == b) | (np.isnan(a) & np.isnan(b))
        with np.errstate(invalid="ignore"):
            close = np.abs(a - b) <= tolerance * np.maximum(1.0, np.maximum(np.abs(a), np.abs(b)))
        wrong = np.flatnonzero(~(same | close)).tolist()
    if not wrong:
        return None
    more = f"; and {len(wrong) - 1} more" if len(wrong) > 1 else ""
    return f"[{wrong[0]}] {str(a[wrong[0]])[:160]} != {str(b[wrong[0]])[:160]}{more}"


def files(home: Path) -> dict[str, Path]:
    """Every file that is compared, by its name in the other folder."""
    paths = [p for p in sorted(home.rglob("*")) if p.is_file() and p.suffix in READERS]
    names = [p.relative_to(home).as_posix() for p in paths]
    copied = re.compile(r"inputs/|recording\.json|demo/all/out/sample_logs/")
    return {n: p for n, p in zip(names, paths, strict=True) if not copied.match(n)}


def calls(home: Path) -> set[str]:
    """The folders of the calls."""
    return {p.parent.relative_to(home).as_posix() for p in home.rglob("call.json")}


def compare(home_before: Path, home_after: Path, tolerance: float) -> int:
    """Compare two recordings and print what was found; 1 if something differs."""
    logs = [
        p for home in (home_before, home_after) for p in (home / LOGS).rglob("*") if p.is_file()
    ]
    inputs = frozenset(hashlib.sha256(path.read_bytes()).hexdigest() for path in logs)
    ours, theirs = files(home_before), files(home_after)
    alone = sorted(calls(home_before) ^ calls(home_after))
    print(f"calls of one side only, not compared: {', '.join(alone) or 'none'}")
    places: dict[str, list[str]] = {}
    numbers = 0
    for name in sorted({*ours, *theirs}):
        if name.startswith(tuple(f"{call}/" for call in alone)):
            continue
        differences = places.setdefault(name.split("/")[0], [])
        if name not in ours or name not in theirs:
            differences.append(f"{name} in {'BEFORE' if name in ours else 'AFTER'} only")
            continue
        left, right = (read(of[name], reworded(inputs)) for of in (ours, theirs))
        for place in {**left, **right}:
            if place not in left or place not in right:
                differences.append(
                    f"{name}: {place} in {'BEFORE' if place in left else 'AFTER'} only"
                )
                continue
            numbers += isinstance(left[place], np.ndarray) * len(left[place])
            if text := difference(left[place], right[place], tolerance):
                differences.append(f"{name}: {place} {text}")
    for kind, differences in places.items():
        print(f"{kind}: {len(differences)} places differ", *differences[:SHOWN], sep="\n  ")
    count = sum(map(len, places.values()))
    print(f"{'DIFFERENT' if count else 'EQUAL'}: {count} places differ; {numbers} numbers")
    return int(count > 0)


def main() -> int:
    """Record or compare; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    commands = parser.add_subparsers(dest="what", required=True)
    recorder = commands.add_parser("record", help="run the commands and keep what comes out")
    recorder.add_argument("dir", type=Path, metavar="DIR", help="a new folder")
    recorder.add_argument("--command", default="brake-cal", help="the program, and its first words")
    recorder.add_argument("--jobs", type=int, default=2, help="calls at the same time")
    comparer = commands.add_parser("compare", help="compare two recordings")
    comparer.add_argument("before", type=Path, metavar="BEFORE")
    comparer.add_argument("after", type=Path, metavar="AFTER")
    comparer.add_argument("--tolerance", type=float, default=1e-9)
    options = parser.parse_args()
    if options.what == "compare":
        return compare(options.before, options.after, options.tolerance)
    record(options.dir.absolute(), shlex.split(options.command), options.jobs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
