"""Shows that the commands give the same outputs before and after a rebuild of the code.

    python tests/studies/equality.py record DIR [--command /path/to/brake-cal] [--jobs 2]
                                            [--samples sample_logs] [--tables tables]
    python tests/studies/equality.py compare BEFORE AFTER [--tolerance 1e-9]

`record` copies the sample logs and the stored tables into DIR/inputs, runs the command line on
every log and keeps all that comes out. DIR/KIND/NAME/ holds what one call gave: `call.json` (what
was typed, exit code), `stdout.json` or `stdout.txt`, `error.txt` where a log or an option was
refused, and every file that was written. Nothing of the code is imported. DIR is the working
folder, so that all paths in the outputs are relative. The same program gives the same DIR again.

`compare` reads both folders and compares every number:

    |a - b| <= tolerance * max(1, |a|, |b|)

NaN equals NaN, an infinity equals itself, and 1 equals 1.0. Strings must be equal, but for those
that are a number with its unit, and so must keys, columns, rows, units and files. The order of
keys is free, that of columns, rows and lists is not.

    json toml csv parquet              by key or column
    dcm cdfx a2l h xml inca.csv txt    by the numbers, and by the text between them
    html                               the same, of the text that a reader sees, no pictures
    svg                                the same, with the texts of the figure, but no letter shapes
    png                                by bytes; a picture that differs is told, and is no failure

Exit code 0 if all is equal, 1 if something differs, 2 if it was used wrongly. What is left out
stands in the rules below, with the reasons. Not recorded: `watch`, PDF, and logs from a bus.
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
import time
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property
from html.parser import HTMLParser
from itertools import zip_longest
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow.parquet as pq

ROOT = Path(__file__).parents[2]

# ---------------------------------------------------------------------------------------------
# The rules: what was renamed on purpose, and what is not compared.

RENAMED: dict[str, str] = {"flaws": "violations"}
"""Old name to new name, of keys, columns and files. BEFORE is read with it.

"gain" renames every key, column or file of that name, "evidence.gain" only where it stands in
"evidence"; a file is named as a whole, "paper.parquet". Names of columns are without their unit.
What names a key in a value ("figure": "gain") is a text and belongs below.
"""

REWORDED: dict[str, str] = {"nought below": "zero below"}
"""Old text (a regular expression) to new text, in strings and in text files. BEFORE is read with
it: what was renamed may be named in a value, too, in a sentence or in a C header."""

KEYS_LEFT_OUT = {
    "arguments": "commands were renamed",
    "seconds": "a duration",
    "logs_per_second": "a duration",
    "program": "the version of the code",
    "brake_cal.program": "the version of the code, in the metadata of results.parquet",
    "bytes": "the length of an export changes with a key's name and with the version's length",
}

MASKED = (
    # what is replaced in every text, by what; why
    (re.compile(r"brake-cal \d+\.\d+[\w.+]*"), "brake-cal VERSION"),  # the version of the code
    (re.compile(r"<DATE>[\d-]+</DATE>"), "<DATE>"),  # `tables export` takes no date but today's
    (re.compile(r'(["#])[a-zA-Z][0-9a-f]{10}(?=[")])'), r"\1SHAPE"),  # SVG: digest of a shape
)

DIGEST = re.compile(r"(?<![\w.])(?=[0-9a-f]*[a-f])(?:[0-9a-f]{64}|[0-9a-f]{16}|[0-9a-f]{12})(?!\w)")
"""A SHA-256, whole or its beginning. That of an input is compared. That of an output is not: it
follows from every key's name and from the last bit of every number in it."""

PICTURES = ("png",)
"""They show digests and the version of the code, so they cannot be asked to be equal. Their
numbers stand in the other files, and `plot` is recorded as SVG."""

RECORDING = "recording.json"
"""When and how a folder was made: told, not compared."""

LEFT_OUT = re.compile(rf"{RECORDING}|inputs/broken/|.*\.md$|.*/journal\.(jsonl|sqlite)")
"""Files that are not compared: this script's own, its damaged store, the samples' READMEs, and the
journals of batches: JSON lines first, a database now, with the rows of the results.parquet beside
them, which is compared."""

COPIED = re.compile("inputs/|demo/all/out/sample_logs/")
"""Samples and stored tables. They are compared, but where the bytes are equal they are not read,
so that their numbers are not counted as outputs."""

SHOWN = 20
"""Differing places that are printed of each kind."""

# ---------------------------------------------------------------------------------------------
# What is recorded.

LOGS, TABLES, BROKEN = "inputs/sample_logs", "inputs/tables", "inputs/broken"
PLAN, PLAN_OF_CARS = "inputs/plan.csv", "inputs/plan_cars.csv"
FORMATS = {
    "json": "table.json",
    "csv": "table.csv",
    "parquet": "table.parquet",
    "dcm": "table.dcm",
    "cdfx": "table.cdfx",
    "a2l": "table.a2l",
    "c-header": "table.h",
    "inca-csv": "table.inca.csv",
}
COMMANDS = (
    *("check", "fit", "validate", "station", "plot", "simulate", "diagnose", "effects"),
    *("repeatability", "batch", "watch", "demo", "map", "tables", "tables list", "fleet", "limits"),
    *("tables show", "tables diff", "tables verify", "tables export", "tables compare"),
)
CRASH = b"Traceback"
MANOEUVRES = ("ramp", "step", "wave", "staircase", "coast", "stop")
IDENTITY = "--serial 0815 --vin WVWZZZ1JZXW000001 --station line-2 --rxswin R1 --date 2025-01-02"
PATIENCE = 600.0
"""Seconds after which a call is given up."""


Chain = list[str]
"""Calls in their order, "FOLDER: WORDS": the words are typed, FOLDER takes what comes out and is
{here} in the words. A call may need what the ones before it have made."""


class MisuseError(Exception):
    """The script was called wrongly."""


class Samples:
    """The sample logs in the folder of a recording; a pattern that finds nothing is an error."""

    def __init__(self, home: Path):
        self.home = home

    def __call__(self, *patterns: str) -> list[str]:
        """Paths of logs, relative to the folder of the recording, each pattern sorted."""
        found = []
        for pattern in patterns:
            paths = sorted((self.home / LOGS).glob(pattern))
            if not paths:
                raise MisuseError(f"no sample log {pattern}: is --samples right?")
            found += [path.relative_to(self.home).as_posix() for path in paths]
        return found

    def line(self, *patterns: str) -> str:
        """The same for a command line."""
        return " ".join(self(*patterns))

    @property
    def stops(self) -> str:
        """The hold-outs of the reference car."""
        return self.line("sedan/*stop*", "sedan/transition*", "sedan/*wet_pads*")


def chains(logs: Samples) -> dict[str, Chain]:
    """All that is recorded, by name; long ones first, so that no worker is left with one."""
    return {
        **{f"hidden {Path(case).name}": hidden(logs, case) for case in logs("hidden/case_*")},
        "demo": ["demo/all: demo --out {here}/out --json"],
        "simulations": simulations(logs),
        "batch": batches(logs),
        "exports": exports(),
        "stored tables": stored(logs),
        "sedan": sedan(logs),
        "maps": maps(logs),
        "plots": plots(logs),
        "station": stations(logs),
        "checks": checks(logs),
        "simulation study": simulation_study(logs),
        "third party": third_party(logs),
        "gauge": gauge(),
        "refused": refused(logs),
        "cards and help": cards(),
    }


def fits(car: str, vehicle: str, combinations: Mapping[str, str]) -> Chain:
    """Fits of a car into one store, version by version, and what `tables` says of it."""
    store = f"--store fit/{car}/store"
    return [
        *(
            f"fit/{car}/{name}: fit {logs} --vehicle {vehicle} {store} --json"
            for name, logs in combinations.items()
        ),
        f"tables/{car}/list: tables list {store} --json",
        f"tables/{car}/verify: tables verify {store} --json",
    ]


def validations(car: str, table: str, count: int, logs: str) -> Chain:
    """Every version of a fitted table on all the logs."""
    more = f"--store fit/{car}/store --out {{here}}/out --json"
    return [
        f"validate/{car}/version_{n}: validate {table}@{n} {logs} {more}"
        for n in range(1, count + 1)
    ]


def sedan(logs: Samples) -> Chain:
    """The reference car: all combinations of its ramps and its coast, on all of its stops."""
    one, two, coast = logs("sedan/ramp_wet_asphalt.csv", "sedan/ramp_*_repeat.csv", "sedan/coast*")
    vehicle = f"{LOGS}/sedan/vehicle.toml"
    store = "--store fit/sedan/store"
    combinations = {
        "ramp": one,
        "repeat": two,
        "ramp_coast": f"{one} {coast}",
        "repeat_coast": f"{two} {coast}",
        "ramps": f"{one} {two}",
        "ramps_coast": f"{one} {two} {coast}",
        "again": f"{one} {coast}",
    }
    return [
        *fits("sedan", vehicle, combinations),
        f"fit/sedan/words: fit {one} {coast} --vehicle {vehicle} {store}",
        *validations("sedan", "sedan-2up", 6, logs.stops),
        f"validate/sedan/ramps: validate sedan-2up@3 {one} {two} {store} --out {{here}}/out --json",
        f"tables/sedan/diff: tables diff sedan-2up@1 sedan-2up@6 {store} --json",
        f"tables/sedan/same: tables diff sedan-2up@2 sedan-2up@2 {store} --json",
        *(f"tables/sedan/show_{n}: tables show sedan-2up@{n} {store} --json" for n in (1, 6)),
    ]


def simulation_study(logs: Samples) -> Chain:
    """The paper's Section IV, with the right pads in the vehicle file and with wrong ones."""
    car, study = f"{LOGS}/simulation_study/vehicle", "simulation_study"
    ramp, stop = logs("simulation_study/ramp*", "simulation_study/stop*")
    store, wrong = f"--store fit/{study}/store", f"--vehicle {car}_wrong_pads.toml"
    more = f"{store} --out {{here}}/out --json"
    return [
        *fits(study, f"{car}.toml", {"ramp": ramp}),
        f"fit/{study}/wrong: fit {ramp} {wrong} {store} --json",
        *validations(study, "sedan-sim", 2, f"{stop} {ramp}"),
        f"validate/{study}/other_pads: validate sedan-sim@1 {stop} {wrong} {more}",
        f"tables/{study}/show: tables show sedan-sim@2 {store} --json",
    ]


def third_party(logs: Samples) -> Chain:
    """The multi-body car: its ramp, and the two of its hold-outs that can be fitted, too."""
    ramp, slow = logs.line("third_party/cal*"), logs.line("third_party/hold[24]*")
    combinations = {"ramp": ramp, "slow_holds": slow, "all_slow": f"{ramp} {slow}"}
    return [
        *fits("third_party", f"{LOGS}/third_party/vehicle.toml", combinations),
        *validations("third_party", "escort", 3, logs.line("third_party/hold*")),
    ]


def hidden(logs: Samples, folder: str) -> Chain:
    """A case for `diagnose`: the search, fits and hold-outs, and both with what was found."""
    case, car = Path(folder).name, f"{folder}/vehicle.toml"
    below = f"hidden/{case}"
    calibration, holdouts = (logs.line(f"{below}/{f}/*") for f in ("calibration", "holdout"))
    ramp, fast, coast, slow = (
        f"{folder}/calibration/{log}.parquet"
        for log in ("ramp", "ramp_fast", "coast", "coast_slow")
    )
    combinations = {
        "ramp": ramp,
        "ramp_coast": f"{ramp} {coast}",
        "ramps_coasts": f"{ramp} {fast} {coast} {slow}",
    }
    name = tomllib.loads((logs.home / car).read_text(encoding="utf-8"))["name"]
    store, model = f"--store fit/{case}/store", f"--model diagnose/{case}/out/model.toml"
    more = "--out {here}/out --json"
    simulated = {Path(log).stem: log for log in (*logs(f"{below}/holdout/*"), ramp)}
    return [
        f"diagnose/{case}: diagnose {calibration} --holdout {holdouts} --vehicle {car} {more}",
        *fits(case, car, combinations),
        f"refused/{case}: fit {calibration} --vehicle {car} {store}",
        f"fit/{case}/model: fit {ramp} {fast} {coast} --vehicle {car} {model} {store} --json",
        *validations(case, name, 4, holdouts),
        f"validate/{case}/model: validate {name}@2 {holdouts} {model} {store} {more}",
        *(
            f"simulate/{case}/{stem}: simulate {log} --vehicle {car} {model} "
            "--out {here}/sim.parquet --json"
            for stem, log in simulated.items()
        ),
        f"simulate/{case}/wave: simulate --manoeuvre wave --noise 3 --vehicle {car} {model} "
        "--out {here}/sim.csv --json",
    ]


def stored(logs: Samples) -> Chain:
    """The tables of the repository, on the hold-outs of their cars and in the store's commands."""
    store, limits = f"--store {TABLES}", f"--limits {LOGS}/limits.toml"
    used = {
        "sedan-2up@1": logs.stops,
        "sedan-2up@2": logs.stops,
        "sedan-sim@1": logs.line("simulation_study/stop*"),
        "escort@1": logs.line("third_party/hold*"),
    }
    out = "--out {here}/out --json"
    calls = [
        f"tables/stored/list: tables list {store} --json",
        f"tables/stored/list_words: tables list {store}",
        f"tables/stored/verify: tables verify {store} --json",
        f"tables/stored/verify_words: tables verify {store}",
        f"tables/stored/diff: tables diff sedan-2up@1 sedan-2up@2 {store} --json",
        f"tables/stored/diff_words: tables diff sedan-2up@1 sedan-2up@2 {store}",
        f"tables/stored/diff_cars: tables diff sedan-2up@2 escort@1 {store} --json",
    ]
    for table, holdouts in used.items():
        name = table.replace("@", "_")
        calls += [
            f"tables/stored/{name}: tables show {table} {store} --json",
            f"tables/stored/{name}_words: tables show {table} {store}",
            f"validate/stored/{name}: validate {table} {holdouts} {store} {out}",
            f"validate/stored/{name}_words: validate {table} {holdouts} {store}",
        ]
    summary = "--validation validate/stored/sedan-2up_2/out/summary.json"
    return [
        *calls,
        f"validate/stored/limits: validate sedan-2up {logs.stops} {store} {limits} --json",
        export("state/cdfx", "sedan-2up@2", "cdfx", summary),
    ]


def export(folder: str, table: str, form: str, more: str = "") -> str:
    """A stored table in one format."""
    out = f"--out {{here}}/{FORMATS[form]} --store {TABLES} --json"
    return f"export/{folder}: tables export {table} --format {form} {out} {more}"


def exports() -> Chain:
    """Every format of every stored table; fewer points, fixed point, and what is read back."""
    tables = ("sedan-2up@1", "sedan-2up@2", "sedan-sim@1", "escort@1")
    names = {table: table.replace("@", "_") for table in tables}
    words = (("sedan-2up_2", "--json"), ("points_16", "--json"), ("escort_1", ""))
    return [
        *(export(f"{names[table]}/{form}", table, form) for table in tables for form in FORMATS),
        *(export(f"points_16/{form}", "sedan-2up", form, "--points 16") for form in FORMATS),
        *(export(f"points_8/{form}", "escort", form, "--points 8") for form in ("dcm", "c-header")),
        *(
            export(f"fixed_{bits}/{car}", car, "c-header", f"--points 12 --fixed-point {bits}")
            for bits in (8, 16, 32)
            for car in ("sedan-2up", "escort")
        ),
        *(
            f"import/{folder}_{form}: tables compare export/{folder}/{form}/{FORMATS[form]} "
            f"--store {TABLES} {how}"
            for form in ("dcm", "cdfx")
            for folder, how in words
        ),
    ]


def stations(logs: Samples) -> Chain:
    """A car that passes, with all exports; one that fails; one of the multi-body simulator."""
    one, two, coast = logs("sedan/ramp_wet_asphalt.csv", "sedan/ramp_*_repeat.csv", "sedan/coast*")
    dry, wet = logs.line("sedan/dry*", "sedan/transition*"), logs.line("sedan/*wet_pads*")
    car = f"--vehicle {LOGS}/sedan/vehicle.toml --golden {TABLES}/sedan-2up/v0002"
    told = IDENTITY + "".join(f" --export {form}" for form in FORMATS)
    out = "--store {here}/store --out {here}/out"
    other = f"--vehicle {LOGS}/third_party/vehicle.toml"
    return [
        "limits/file: limits --out {here}/line.toml --json",
        "limits/words: limits",
        f"station/passed: station {one} {dry} --coast {coast} {car} {told} {out} --json",
        f"station/failed: station {one} {dry} {wet} --ramp {two} --coast {coast} {car} {told} "
        f"--limits limits/file/line.toml {out} --json",
        f"station/words: station {one} {dry} --coast {coast} {car} {out}",
        "station/third_party: station "
        f"{logs.line('third_party/cal*', 'third_party/hold*')} {other} {out} --json",
    ]


def simulations(logs: Samples) -> Chain:
    """Logs driven again by the vehicle's own model, and manoeuvres that are fitted and proved."""
    sedan_file = f"{LOGS}/sedan/vehicle.toml"
    driven = logs("sedan/*.csv", "simulation_study/*.parquet", "third_party/*.parquet")
    calls = [
        f"simulate/{Path(log).parent.name}/{Path(log).stem}: simulate {log} "
        f"--vehicle {Path(log).parent}/vehicle.toml --out {{here}}/sim{Path(log).suffix} --json"
        for log in driven
    ]
    calls += [
        f"simulate/manoeuvres/{name}: simulate --manoeuvre {name} --vehicle {sedan_file} "
        f"--noise {seed} --out {{here}}/{name}.csv --json"
        for seed, name in enumerate(MANOEUVRES)
    ]
    made = {name: f"simulate/manoeuvres/{name}/{name}.csv" for name in MANOEUVRES}
    return [
        *calls,
        f"simulate/manoeuvres/told: simulate --manoeuvre step --vehicle {sedan_file} "
        "--speed '90 km/h' --pressure '45 bar' --rate 100 --out {here}/told.parquet --json",
        *fits("manoeuvres", sedan_file, {"ramp": f"{made['ramp']} {made['coast']}"}),
        *validations("manoeuvres", "sedan-2up", 1, f"{made['step']} {made['wave']}"),
        f"check/manoeuvres: check {' '.join(made.values())} --json",
    ]


def gauge() -> Chain:
    """Two ramps each of six cars, with stations and without."""
    return [
        f"repeatability/stations: repeatability --plan {PLAN} --out {{here}}/out --json",
        f"repeatability/cars: repeatability --plan {PLAN_OF_CARS} --eta 0.1 --json",
        f"repeatability/words: repeatability --plan {PLAN_OF_CARS} --quantity pad_scale",
    ]


def batches(logs: Samples) -> Chain:
    """Batches of all commands, and what the fleet's report says of them."""
    many = " ".join(f"{LOGS}/{f}" for f in ("sedan", "simulation_study", "third_party", "hidden"))
    case, quick = logs("hidden/case_0", "hidden/case_5")
    jobs = {
        "check": f"check {many}",
        "check_map": f"check {LOGS}/real/toyota_brake.csv --map {LOGS}/real/toyota.toml",
        "fit_sedan": f"fit {LOGS}/sedan --vehicle {LOGS}/sedan/vehicle.toml",
        "fit_case": f"fit {case}/calibration --vehicle {case}/vehicle.toml",
        "validate": f"validate {LOGS}/sedan --table sedan-2up --store {TABLES}",
        "validate_limits": f"validate '{LOGS}/third_party/hold*.parquet' --table escort@1 "
        f"--store {TABLES} --limits {LOGS}/limits.toml",
        "diagnose": f"diagnose {quick}",
    }
    results = {name: f"batch/{name}/out/results.parquet" for name in jobs}
    reported = ("check", "fit_sedan", "fit_case", "validate", "validate_limits")
    ordered = "--order speed_max --figure eta_zero --figure rate"
    return [
        *(
            f"batch/{name}: batch {words} --workers 2 --out {{here}}/out --json"
            for name, words in jobs.items()
        ),
        *(f"fleet/{name}: fleet {results[name]} --out {{here}}/out --json" for name in reported),
        f"fleet/ordered: fleet {results['check']} {ordered} --json",
        f"fleet/words: fleet {results['check']}",
    ]


def plots(logs: Samples) -> Chain:
    """A page of each sort."""
    ramp, stop = logs("sedan/ramp_wet_asphalt.csv", "sedan/basalt*")
    other = f"--vehicle {LOGS}/simulation_study/vehicle_wrong_pads.toml"
    drawn = {
        "table": "sedan-2up",
        "table_ramp": f"sedan-2up {ramp}",
        "tables": "sedan-2up@1 sedan-2up@2",
        "stop": f"sedan-2up {stop}",
        "truth": f"escort {logs.line('third_party/hold3*')}",
        "other_pads": f"sedan-sim {logs.line('simulation_study/stop*')} {other}",
        "log": logs.line("third_party/cal*"),
        "real": f"{LOGS}/real/toyota_brake.csv --map {LOGS}/real/toyota.toml",
    }
    return [
        f"plot/{name}: plot {what} --store {TABLES} --out {{here}}/page.svg --json"
        for name, what in drawn.items()
    ]


def checks(logs: Samples) -> Chain:
    """What is in every log; a call for each folder."""
    folders = {
        "sedan": "sedan/*.csv",
        "simulation_study": "simulation_study/*.parquet",
        "third_party": "third_party/*.parquet",
    }
    for case in logs("hidden/case_*"):
        for part in ("calibration", "holdout"):
            folders[f"{Path(case).name}_{part}"] = f"hidden/{Path(case).name}/{part}/*.parquet"
    return [
        *(f"check/{name}: check {logs.line(found)} --json" for name, found in folders.items()),
        f"check/words: check {logs.line('sedan/*.csv', 'third_party/*.parquet')}",
    ]


def maps(logs: Samples) -> Chain:
    """The logs of production cars, with their maps and without; proposals for other logs, too."""
    calls = []
    for log in logs("real/*.csv"):
        name = Path(log).stem
        written = f"{LOGS}/real/{name.removesuffix('_brake')}.toml"
        calls += [
            f"check/{name}: check {log} --json",
            f"check/{name}_map: check {log} --map {written} --json",
            f"map/{name}: map {log} --out {{here}}/map.toml --json",
            f"map/{name}_told: map {log} --take p_mc= --radius 0.31 --json",
            f"map/{name}_words: map {log} --map {written}",
            f"check/{name}_suggested: check {log} --map map/{name}/map.toml --json",
        ]
    others = logs("sedan/*.csv", "simulation_study/*.parquet", "third_party/cal*")
    return [*calls, *(f"map/{Path(log).stem}: map {log} --json" for log in others)]


def refused(logs: Samples) -> Chain:
    """What must be refused, and how it is said."""
    coast, stop, ramp, real = logs(
        "sedan/coast*", "sedan/dry*", "sedan/ramp_wet_asphalt.csv", "real/toyota*.csv"
    )
    vehicle, store = f"--vehicle {LOGS}/sedan/vehicle.toml", f"--store {TABLES}"
    into, mapped = "--store {here}/store", f"{real} --map {LOGS}/real/toyota.toml"
    return [
        f"refused/fit_coast: fit {coast} {vehicle} {into}",
        f"refused/fit_stop: fit {stop} {vehicle} {into}",
        f"refused/fit_twice: fit {ramp} {ramp} {vehicle} {into}",
        f"refused/fit_real: fit {mapped} {vehicle} {into}",
        f"refused/fit_no_vehicle: fit {ramp} --vehicle {LOGS}/limits.toml {into}",
        f"refused/check_toml: check {LOGS}/limits.toml --json",
        "refused/check_missing: check missing.csv --json",
        f"refused/validate_coast: validate sedan-2up {coast} {store}",
        f"refused/validate_no_table: validate sedan-3up {stop} {store}",
        f"refused/validate_no_version: validate sedan-2up@9 {stop} {store}",
        f"refused/validate_other_car: validate escort {stop} {vehicle} {store}",
        f"refused/validate_real: validate sedan-2up {mapped} {store}",
        f"refused/show_broken: tables show sedan-2up@1 --store {BROKEN}",
        f"refused/verify_broken: tables verify --store {BROKEN} --json",
        f"refused/export_form: tables export sedan-2up --format dmc --out {{here}}/x {store}",
        "refused/effect: effects hydraulic_lak",
        "refused/option: check --jason",
        f"refused/simulate: simulate {vehicle} --out {{here}}/x.csv",
        f"refused/golden: station {ramp} {stop} {vehicle} --golden sedan-2up --out {{here}}/x",
        f"refused/quantity: repeatability --plan {PLAN} --quantity pad_scald",
        f"refused/batch: batch validate {LOGS}/sedan --out {{here}}/x",
    ]


def cards() -> Chain:
    """The catalogue of effects, and the help of every command."""
    return [
        "effects/all: effects --json",
        "effects/words: effects",
        "effects/card: effects hydraulic_lag",
        "help/all: --help",
        "help/version: --version",
        *(f"help/{name.replace(' ', '_')}: {name} --help" for name in COMMANDS),
    ]


# ---------------------------------------------------------------------------------------------
# Recording.


def write_inputs(home: Path, samples: Path, tables: Path) -> None:
    """Copy what the commands read, and make the rest: a plan, and a store with damage in it."""
    shutil.copytree(samples, home / LOGS, ignore=shutil.ignore_patterns("*.png", "*.md"))
    shutil.copytree(tables, home / TABLES)
    shutil.copytree(tables, home / BROKEN)
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
    for path, lines in ((PLAN, with_station), (PLAN_OF_CARS, without)):
        (home / path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def run(call: str, command: list[str], home: Path) -> tuple[str, int]:
    """Type one line in the folder of the recording, keep what comes out; its folder, exit code."""
    name, _, words = call.partition(": ")
    arguments = shlex.split(words.replace("{here}", name))
    folder = home / name
    folder.mkdir(parents=True)
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "FORCE_COLOR")}
    done = subprocess.run(
        [*command, *arguments],
        cwd=home,
        env=environment | {"NO_COLOR": "1"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=PATIENCE,
        check=False,
    )
    write_json(folder / "call.json", {"arguments": arguments, "exit_code": done.returncode})
    if done.stdout:
        stdout = "stdout.json" if "--json" in arguments else "stdout.txt"
        (folder / stdout).write_bytes(done.stdout)
    if done.returncode not in (0, 1) or CRASH in done.stderr:
        (folder / "error.txt").write_bytes(done.stderr)
    return name, done.returncode


def write_json(path: Path, document: dict[str, object]) -> None:
    """Write a document."""
    path.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")


def version_of(command: list[str]) -> str:
    """What the program says of itself."""
    try:
        asked = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise MisuseError(f"{shlex.join(command)} does not run ({error})") from None
    return asked.stdout.strip()


def record(home: Path, command: list[str], samples: Path, tables: Path, jobs: int) -> None:
    """Run everything, and tell which calls ended as only the refused ones may."""
    if home.exists() and any(home.iterdir()):
        raise MisuseError(f"{home} is not empty")
    version = version_of(command)
    home.mkdir(parents=True, exist_ok=True)
    write_inputs(home, samples, tables)
    begun = time.perf_counter()
    codes: dict[str, int] = {}

    def work(item: tuple[str, Chain]) -> str:
        start = time.perf_counter()
        codes.update(run(call, command, home) for call in item[1])
        return f"{item[0]:<20} {len(item[1]):4} calls {time.perf_counter() - start:6.1f} s"

    with ThreadPoolExecutor(jobs) as pool:
        for line in pool.map(work, chains(Samples(home)).items()):
            print(line, flush=True)
    counted = {str(code): count for code, count in sorted(Counter(codes.values()).items())}
    told = {
        "command": command,
        "version": version,
        "recorded": time.strftime("%Y-%m-%d %H:%M:%S"),
        "seconds": round(time.perf_counter() - begun, 1),
        "exit_codes": counted,
    }
    write_json(home / RECORDING, told)
    said = ", ".join(f"{count} with {code}" for code, count in counted.items())
    print(f"\n{len(codes)} calls in {told['seconds']:.0f} s; exit codes: {said}")
    for folder, code in sorted(codes.items()):
        error = home / folder / "error.txt"
        if error.exists() and (CRASH in error.read_bytes() or not folder.startswith("refused/")):
            print(f"look at {error}: exit code {code}")


# ---------------------------------------------------------------------------------------------
# Reading: every file becomes named leaves, of numbers or of texts.


class Leaf(NamedTuple):
    """Values under one name; ``at`` is the line of each, in files that are read as text."""

    values: np.ndarray | tuple[str, ...]
    at: tuple[int, ...] | None = None


Leaves = Iterator[tuple[str, Leaf]]


@dataclass(frozen=True)
class Side:
    """One of the folders, and how its names and texts are brought to those of the other."""

    home: Path
    inputs: frozenset[str]
    renamed: Mapping[str, str] = field(default_factory=dict)
    reworded: Mapping[str, str] = field(default_factory=dict)

    def name(self, *keys: str) -> str:
        """The last of nested keys, as it is called in the other folder."""
        ends = (".".join(keys[k:]) for k in range(len(keys)))
        return next((self.renamed[end] for end in ends if end in self.renamed), keys[-1])

    def text(self, text: str) -> str:
        """A text without what is not compared."""
        for old, new in self.reworded.items():
            text = re.sub(old, new, text)
        for pattern, put in MASKED:
            text = pattern.sub(put, text)
        return DIGEST.sub(self._digest, text)

    def _digest(self, found: re.Match[str]) -> str:
        known = any(digest.startswith(found[0]) for digest in self.inputs)
        return found[0] if known else "DIGEST"

    @cached_property
    def files(self) -> dict[str, Path]:
        """Every file that is compared, by its name in the other folder."""
        paths = [path for path in sorted(self.home.rglob("*")) if path.is_file()]
        folders = [path.parent.relative_to(self.home) for path in paths]
        names = [f / self.name(path.name) for f, path in zip(folders, paths, strict=True)]
        named = {name.as_posix(): path for name, path in zip(names, paths, strict=True)}
        return {name: path for name, path in named.items() if not LEFT_OUT.match(name)}


def input_digests(home: Path) -> frozenset[str]:
    """SHA-256 of every log that a folder was made from."""
    logs = [path for path in (home / LOGS).rglob("*") if path.is_file()]
    return frozenset(hashlib.sha256(path.read_bytes()).hexdigest() for path in logs)


def number(value: object) -> bool:
    """Whether a value of a document is a number; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


QUANTITY = re.compile(r"([+-]?\d+\.?\d*(?:[eE][+-]?\d+)?) (\S+)")
"""A number with its unit, as vehicle files and models have it."""


def leaves(value: Any, side: Side, place: str = "", keys: tuple[str, ...] = ()) -> Leaves:
    """Leaves of a document, by the path of keys to each; a list of numbers is one leaf."""
    if isinstance(value, dict):
        yield f"{place}{{}}", Leaf(("a table",))
        for key, part in value.items():
            if key not in KEYS_LEFT_OUT:
                name = side.name(*keys, key)
                yield from leaves(part, side, f"{place}.{name}" if place else name, (*keys, key))
    elif isinstance(value, list) and value and all(map(number, value)):
        yield place, Leaf(np.array(value, dtype=float))
    elif isinstance(value, list):
        yield f"{place}[]", Leaf((f"{len(value)} parts",))
        for i, part in enumerate(value):
            yield from leaves(part, side, f"{place}[{i}]", keys)
    elif number(value):
        yield place, Leaf(np.array([value], dtype=float))
    elif isinstance(value, str) and (found := QUANTITY.fullmatch(value)):
        yield place, Leaf(np.array([float(found[1])]))
        yield f"{place} unit", Leaf((found[2],))
    else:
        yield place, Leaf((repr(side.text(value) if isinstance(value, str) else value),))


def read_json(path: Path, side: Side) -> Leaves:
    """One document."""
    return leaves(json.loads(path.read_text(encoding="utf-8")), side)


def read_toml(path: Path, side: Side) -> Leaves:
    """The document, and its remarks."""
    text = path.read_text(encoding="utf-8")
    yield from leaves(tomllib.loads(text), side)
    remarks = re.findall(r"(?m)(?:^|\s)#([^\"\n]*)$", text)
    yield from numbers_and_words([side.text(remark) for remark in remarks], "remark")


def values_of(cells: list[str], side: Side) -> Leaf:
    """Numbers if every cell that holds something is one, else texts."""
    try:
        return Leaf(np.array([cell or "nan" for cell in cells], dtype=float))
    except ValueError:
        return Leaf(tuple(map(side.text, cells)))


def read_csv(path: Path, side: Side) -> Leaves:
    """Columns by their name and unit, and the remarks."""
    lines = path.read_text(encoding="utf-8").splitlines()
    remarks = [side.text(line) for line in lines if line.startswith("#")]
    yield from numbers_and_words(remarks, "remark")
    rows = csv.reader(line for line in lines if line and not line.startswith("#"))
    columns = list(zip_longest(*rows, fillvalue=""))
    heads = [head.partition(" [") for head, *_ in columns]
    names = [side.name(name) + bracket + unit for name, bracket, unit in heads]
    yield "columns", Leaf(tuple(names))
    for name, (_, *cells) in zip(names, columns, strict=True):
        yield name, values_of(cells, side)


def read_parquet(path: Path, side: Side) -> Leaves:
    """Columns with their units and meanings, and the metadata of the file."""
    table = pq.read_table(path)
    names = [side.name(name) for name in table.column_names]
    yield "columns", Leaf(tuple(names))
    yield from leaves(metadata(table.schema.metadata), side, "metadata")
    for name, what in zip(names, table.schema, strict=True):
        yield from leaves(metadata(what.metadata), side, f"{name} metadata")
        column = table.column(what.name)
        yield f"{name} type", Leaf((str(what.type), f"{column.null_count} nulls"))
        values = column.to_pandas().to_numpy()
        if values.dtype.kind in "iuf":
            yield name, Leaf(values.astype(float))
        else:
            yield name, Leaf(tuple(side.text(str(value)) for value in values))


def metadata(of: dict[bytes, bytes] | None) -> dict[str, str]:
    """Metadata of Parquet as text, without what pandas and Arrow say of themselves."""
    told = {key.decode(): value.decode() for key, value in (of or {}).items()}
    return {k: v for k, v in told.items() if k not in ("pandas", "ARROW:schema")}


NUMBER = re.compile(r"(?<![\w.])[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
"""A number in a text. Digits within a name (f1, sedan_2up) and hyphens within a word are text."""


def numbers_and_words(lines: list[str], what: str) -> Leaves:
    """All numbers of a text, and its lines with # for each number."""
    found = [(n, part) for n, line in enumerate(lines, 1) for part in NUMBER.findall(line)]
    values = np.array([float(part) for _, part in found])
    yield f"number in {what}", Leaf(values, tuple(n for n, _ in found))
    texts = tuple(NUMBER.sub("#", line) for line in lines)
    yield what, Leaf(texts, tuple(range(1, len(lines) + 1)))


def read_text(path: Path, side: Side) -> Leaves:
    """Any text."""
    text = path.read_text(encoding="utf-8", errors="replace")
    return numbers_and_words(side.text(text).splitlines(), "line")


class Visible(HTMLParser):
    """Collects the text of a page that a reader sees."""

    HIDDEN = ("style", "script")

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self.inside: str | None = None

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.inside = tag

    def handle_endtag(self, tag: str) -> None:
        self.inside = None

    def handle_data(self, data: str) -> None:
        if self.inside not in self.HIDDEN and data.strip():
            self.words.append(" ".join(data.split()))


def read_html(path: Path, side: Side) -> Leaves:
    """The visible text."""
    page = Visible()
    page.feed(path.read_text(encoding="utf-8"))
    return numbers_and_words([side.text(words) for words in page.words], "text")


LETTERS = re.compile(r'<use xlink:href="#[A-Z][^>]*/>|<path id="[A-Z][^>]*/>')
"""Shapes of letters and where each stands in its line: they would spell the digest again. What is
written stands in a remark beside them."""


def read_svg(path: Path, side: Side) -> Leaves:
    """Every line of the drawing and what is written in it."""
    text = LETTERS.sub("", path.read_text(encoding="utf-8"))
    lines = [line.strip() for line in side.text(text).splitlines()]
    return numbers_and_words([line for line in lines if line], "line")


READERS: dict[str, Callable[[Path, Side], Leaves]] = {
    "json": read_json,
    "toml": read_toml,
    "csv": read_csv,
    "parquet": read_parquet,
    "html": read_html,
    "svg": read_svg,
}
"""By the ending; all others are texts."""


def ending(name: str) -> str:
    """What follows the first point of a file's own name that belongs to its format."""
    return "inca.csv" if name.endswith(".inca.csv") else Path(name).suffix[1:]


# ---------------------------------------------------------------------------------------------
# Comparing.


@dataclass
class Tally:
    """What was compared of one kind of output; ``changed`` numbers differ, be it by one bit."""

    files: int = 0
    numbers: int = 0
    changed: int = 0
    largest: float = 0.0
    where: str = ""
    places: list[str] = field(default_factory=list)


def gaps(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """|a - b| / max(1, |a|, |b|), (n,); 0 where both are NaN or the same infinity."""
    with np.errstate(invalid="ignore"):
        scaled = np.abs(a - b) / np.maximum(1.0, np.maximum(np.abs(a), np.abs(b)))
    scaled[(a == b) | (np.isnan(a) & np.isnan(b))] = 0.0
    return np.where(np.isnan(scaled), np.inf, scaled)


def position(leaf: Leaf, i: int) -> str:
    """Where a value of a leaf stands."""
    if leaf.at is not None:
        return f" {leaf.at[i]}"
    return f"[{i}]" if len(leaf.values) > 1 else ""


def shown(value: object) -> str:
    """A value in a line of differences."""
    text = repr(float(value)) if isinstance(value, float) else str(value)
    return text if len(text) <= 160 else f"{text[:160]} ..."


def difference(a: Leaf, b: Leaf, place: str, tolerance: float, tally: Tally) -> str | None:
    """Count two leaves of one name; what differs in words, or None."""
    numeric = isinstance(a.values, np.ndarray), isinstance(b.values, np.ndarray)
    if numeric[0] != numeric[1]:
        return f"numbers in {'BEFORE' if numeric[0] else 'AFTER'} only"
    if numeric[0]:
        tally.numbers += len(a.values)
    length = "" if len(a.values) == len(b.values) else f"{len(a.values)} != {len(b.values)} values"
    n = min(len(a.values), len(b.values))
    if numeric[0]:
        scaled = gaps(a.values[:n], b.values[:n])
        tally.changed += int(np.count_nonzero(scaled))
        if n and scaled.max() > tally.largest:
            at = int(scaled.argmax())
            tally.largest, tally.where = float(scaled[at]), f"{place}{position(a, at)}"
        wrong = np.flatnonzero(scaled > tolerance)
    else:
        wrong = np.array([i for i in range(n) if a.values[i] != b.values[i]])
    if not wrong.size:
        return length or None
    first = int(wrong[0])
    told = f"{shown(a.values[first])} != {shown(b.values[first])}"
    if numeric[0]:
        told += f" (by {scaled[first]:.3g}, at most {scaled.max():.3g})"
    more = f"; and {wrong.size - 1} more" if wrong.size > 1 else ""
    return f"{position(a, first).strip()} {told}{more}{'; ' * bool(length)}{length}".strip()


def collected(found: Leaves) -> dict[str, Leaf]:
    """Leaves by name; of two with one name none is lost."""
    named: dict[str, Leaf] = {}
    for place, leaf in found:
        while place in named:
            place += "'"
        named[place] = leaf
    return named


def alone(ours: Mapping[str, Leaf], theirs: Mapping[str, Leaf]) -> list[str]:
    """Places on one side only; of a table or a list that is missing as a whole, only itself."""
    missing = [place for place in ours if place not in theirs]
    wholes = [place[:-2] for place in missing if place.endswith(("{}", "[]"))]
    inside = tuple(f"{whole}{sign}" for whole in wholes for sign in ".[")
    return [p for p in missing if not p.removesuffix("{}").removesuffix("[]").startswith(inside)]


def compare_files(name: str, a: Side, b: Side, tolerance: float, tally: Tally) -> list[str]:
    """Compare two files of one name; the places that differ, in words."""
    first, second = a.files[name], b.files[name]
    tally.files += 1
    if ending(name) in PICTURES or COPIED.match(name):
        if first.read_bytes() == second.read_bytes():
            return []
        if ending(name) in PICTURES:
            return ["other bytes"]
    read = READERS.get(ending(name), read_text)
    try:
        left, right = collected(read(first, a)), collected(read(second, b))
    except ValueError as error:
        return [] if first.read_bytes() == second.read_bytes() else [f"cannot be read ({error})"]
    places = [f"{place} in BEFORE only" for place in alone(left, right)]
    places += [f"{place} in AFTER only" for place in alone(right, left)]
    for place, leaf in left.items():
        if place in right:
            told = difference(leaf, right[place], f"{name}: {place}", tolerance, tally)
            places += [f"{place} {told}"] if told else []
    return places


def compare(before: Path, after: Path, tolerance: float) -> int:
    """Compare two recordings and print what was found; 1 if something differs."""
    for home in (before, after):
        if not (home / RECORDING).is_file():
            raise MisuseError(f"{home} holds no recording that was brought to its end")
        told = json.loads((home / RECORDING).read_text(encoding="utf-8"))
        print(f"{home}: {shlex.join(told['command'])}, {told['version']}, {told['recorded']}")
    inputs = input_digests(before) | input_digests(after)
    a, b = Side(before, inputs, RENAMED, REWORDED), Side(after, inputs)
    tallies: dict[tuple[str, str], Tally] = {}
    pictures = []
    for name in sorted({*a.files, *b.files}):
        tally = tallies.setdefault((name.split("/")[0], ending(name)), Tally())
        if name in a.files and name in b.files:
            found = compare_files(name, a, b, tolerance, tally)
        else:
            found = [f"in {'BEFORE' if name in a.files else 'AFTER'} only"]
        into = pictures if ending(name) in PICTURES and name in a.files.keys() & b.files else None
        (tally.places if into is None else into).extend(f"{name}: {place}" for place in found)
    return report(tallies, pictures, tolerance)


def report(tallies: dict[tuple[str, str], Tally], pictures: list[str], tolerance: float) -> int:
    """Print a line a kind and the places; 1 if there is any."""
    print(f"\n{'kind':<14} {'format':<9} {'files':>5} {'numbers':>9} {'not the same bits':>17} "
          f"{'largest':>9}  where")  # fmt: skip
    for (kind, form), tally in sorted(tallies.items()):
        print(
            f"{kind:<14} {form:<9} {tally.files:5d} {tally.numbers:9d} {tally.changed:17d} "
            f"{tally.largest:9.2g}  {tally.where}"
        )
    totals = [sum(getattr(t, n) for t in tallies.values()) for n in ("files", "numbers", "changed")]
    largest = max((tally.largest for tally in tallies.values()), default=0.0)
    print(f"{'all':<24} {totals[0]:5d} {totals[1]:9d} {totals[2]:17d} {largest:9.2g}")
    if pictures:
        print(f"\n{len(pictures)} pictures have other bytes (no failure): look at them")
        print("\n".join(f"  {place}" for place in pictures[:SHOWN]))
    for (kind, form), tally in sorted(tallies.items()):
        if tally.places:
            print(f"\n{kind} {form}: {len(tally.places)} places differ")
            print("\n".join(f"  {place}" for place in tally.places[:SHOWN]))
            if len(tally.places) > SHOWN:
                print(f"  and {len(tally.places) - SHOWN} more")
    count = sum(len(tally.places) for tally in tallies.values())
    bound = f"|a - b| <= {tolerance:g} * max(1, |a|, |b|)"
    print(f"\n{'DIFFERENT' if count else 'EQUAL'}: {count} places differ; {bound}")
    return int(count > 0)


def main() -> int:
    """Record or compare; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    commands = parser.add_subparsers(dest="what", required=True)
    recorder = commands.add_parser("record", help="run the commands and keep what comes out")
    recorder.add_argument("dir", type=Path, metavar="DIR", help="new or empty folder")
    recorder.add_argument("--command", default="brake-cal", help="the program, and its first words")
    recorder.add_argument("--samples", type=Path, default=ROOT / "sample_logs")
    recorder.add_argument("--tables", type=Path, default=ROOT / "tables", help="stored tables")
    recorder.add_argument("--jobs", type=int, default=2, help="calls at the same time")
    comparer = commands.add_parser("compare", help="compare two recordings")
    comparer.add_argument("before", type=Path, metavar="BEFORE")
    comparer.add_argument("after", type=Path, metavar="AFTER")
    comparer.add_argument("--tolerance", type=float, default=1e-9)
    asked = parser.parse_args()
    try:
        if asked.what == "compare":
            return compare(asked.before, asked.after, asked.tolerance)
        command = shlex.split(asked.command)
        if os.sep in command[0]:
            command[0] = os.path.abspath(command[0])
        record(asked.dir.absolute(), command, asked.samples, asked.tables, asked.jobs)
    except MisuseError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
