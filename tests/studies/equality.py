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

NaN equals NaN, and an infinity equals itself. Strings are equal, and so are the keys, columns,
rows, units and files. The order of keys is free, that of columns, rows and lists is not.

    json jsonl toml csv parquet        by key or column
    dcm cdfx h xml inca.csv txt        by the numbers, and by the text between them
    html                               the same, of the text that a reader sees, no pictures
    svg                                the same, with the texts of the figure, but no letter shapes
    png                                by bytes; a picture that differs is told, and is no failure

Exit code 0 if all is equal, 1 if something differs, 2 if it was used wrongly. What is left out
stands in the rules below, with the reasons. Not recorded: `watch`, PDF, and logs from a bus.
"""

import argparse
import csv
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
from functools import partial
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow.parquet as pq

ROOT = Path(__file__).parents[2]

# ---------------------------------------------------------------------------------------------
# The rules: what was renamed on purpose, and what is not compared.

RENAMED: dict[str, str] = {}
"""Old name to new name, of keys, columns and files. BEFORE is read with it.

"gain" renames every key, column or file of that name, "evidence.gain" only where it stands in
"evidence"; a file is named as a whole, "paper.parquet". Names of columns are without their unit.
"""

REWORDED: dict[str, str] = {}
"""Old text (a regular expression) to new text, in strings and in text files. BEFORE is read with
it: a renamed figure may be named in a sentence, too, or in a C header."""

KEYS_LEFT_OUT = {
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

INPUTS = "inputs"
"""Samples and tables that a folder was made from. Equal bytes are not read any further."""

SHOWN = 20
"""Differing places that are printed of each kind."""

# ---------------------------------------------------------------------------------------------
# What is recorded.

LOGS, TABLES = f"{INPUTS}/sample_logs", f"{INPUTS}/tables"
PLAN, PLAN_WITHOUT, BROKEN = f"{INPUTS}/plan.csv", f"{INPUTS}/plan_cars.csv", f"{INPUTS}/broken"
FORMATS = {
    "json": "table.json",
    "csv": "table.csv",
    "parquet": "table.parquet",
    "dcm": "table.dcm",
    "cdfx": "table.cdfx",
    "c-header": "table.h",
    "inca-csv": "table.inca.csv",
}
COMMANDS = (
    *("check", "fit", "validate", "station", "plot", "simulate", "diagnose", "effects"),
    *("repeatability", "batch", "watch", "demo", "map", "map suggest", "tables", "tables list"),
    *("tables show", "tables diff", "tables verify", "tables export", "tables import"),
    *("fleet", "fleet report", "limits", "limits init"),
)
MANOEUVRES = ("ramp", "step", "wave", "staircase", "coast", "stop")
IDENTITY = "--serial 0815 --vin WVWZZZ1JZXW000001 --station line-2 --rxswin R1 --date 2025-01-02"
PATIENCE = 600.0
"""Seconds after which a call is given up."""


class Call(NamedTuple):
    """One line to be typed; ``folder`` takes what comes out, and is {here} in the ``line``."""

    folder: str
    line: str


class MisuseError(Exception):
    """The script was called wrongly."""


Chain = list[Call]
"""Calls in their order, each may need what the ones before have made."""


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
        return shlex.join(self(*patterns))


def stem(path: str) -> str:
    """File name without its ending."""
    return Path(path).stem


def chains(logs: Samples) -> dict[str, Chain]:
    """All that is recorded, by name; long ones first, so that no worker is left with one."""
    cases = logs("hidden/case_*")
    return {
        **{f"hidden {stem(case)}": hidden(logs, case) for case in cases},
        "demo": [Call("demo/all", "demo --out {here}/out --json")],
        "batch": batches(logs),
        "exports": exports(),
        "sedan": sedan(logs),
        "plots": plots(logs),
        "stored tables": stored(logs),
        "third party": third_party(logs),
        "simulation study": simulation_study(logs),
        "station": stations(logs),
        "simulations": simulations(logs),
        "gauge": gauge(),
        "checks": checks(logs),
        "maps": maps(logs),
        "refused": refused(logs),
        "cards and help": cards(),
    }


def fits(car: str, vehicle: str, combinations: Mapping[str, str]) -> Chain:
    """Fits of a car into one store, version by version, and what `tables` says of it."""
    store = f"--store fit/{car}/store"
    made = [
        Call(f"fit/{car}/{name}", f"fit {logs} --vehicle {vehicle} {store} --json")
        for name, logs in combinations.items()
    ]
    return [
        *made,
        Call(f"tables/{car}/list", f"tables list {store} --json"),
        Call(f"tables/{car}/verify", f"tables verify {store} --json"),
    ]


def validations(car: str, name: str, versions: range, logs: str, more: str = "") -> Chain:
    """Every version of a fitted table on all the logs."""
    return [
        Call(
            f"validate/{car}/version_{n}",
            f"validate {name}@{n} {logs} --store fit/{car}/store --out {{here}}/out --json {more}",
        )
        for n in versions
    ]


def sedan(logs: Samples) -> Chain:
    """The reference car: all combinations of its ramps and its coast, on all of its stops."""
    one, two, coast = logs("sedan/ramp_wet_asphalt.csv", "sedan/ramp_*_repeat.csv", "sedan/coast*")
    stops = logs.line("sedan/*stop*", "sedan/transition*", "sedan/*wet_pads*")
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
        Call("fit/sedan/words", f"fit {one} {coast} --vehicle {vehicle} {store}"),
        *validations("sedan", "sedan-2up", range(1, 7), stops),
        Call(
            "validate/sedan/calibration_logs",
            f"validate sedan-2up@3 {one} {two} {coast} {store} --out {{here}}/out --json",
        ),
        Call("tables/sedan/diff", f"tables diff sedan-2up@1 sedan-2up@6 {store} --json"),
        Call("tables/sedan/same", f"tables diff sedan-2up@2 sedan-2up@2 {store} --json"),
        *(Call(f"tables/sedan/show_{n}", f"tables show sedan-2up@{n} {store} --json")
          for n in (1, 6)),
    ]  # fmt: skip


def simulation_study(logs: Samples) -> Chain:
    """The paper's Section IV, with the right pads in the vehicle file and with wrong ones."""
    folder = f"{LOGS}/simulation_study"
    ramp, stop = logs("simulation_study/ramp*", "simulation_study/stop*")
    right, wrong = f"{folder}/vehicle.toml", f"{folder}/vehicle_wrong_pads.toml"
    store = "--store fit/simulation_study/store"
    return [
        *fits("simulation_study", right, {"ramp": ramp}),
        Call("fit/simulation_study/wrong", f"fit {ramp} --vehicle {wrong} {store} --json"),
        *validations("simulation_study", "sedan-sim", range(1, 3), f"{stop} {ramp}"),
        Call(
            "validate/simulation_study/other_pads",
            f"validate sedan-sim@1 {stop} --vehicle {wrong} {store} --out {{here}}/out --json",
        ),
        Call("tables/simulation_study/show", f"tables show sedan-sim@2 {store} --json"),
    ]


def third_party(logs: Samples) -> Chain:
    """The multi-body car: its ramp, and the two of its hold-outs that can be fitted, too."""
    ramp, holds = logs.line("third_party/cal_ramp*"), logs("third_party/hold*")
    slow = [hold for hold in holds if "hold2" in hold or "hold4" in hold]
    combinations = {
        "ramp": ramp,
        "slow_holds": " ".join(slow),
        "all_slow": " ".join((ramp, *slow)),
    }
    return [
        *fits("third_party", f"{LOGS}/third_party/vehicle.toml", combinations),
        *validations("third_party", "escort", range(1, 4), " ".join(holds)),
    ]


def hidden(logs: Samples, folder: str) -> Chain:
    """A case for `diagnose`: fits, hold-outs, the search, and both with what was found."""
    case = stem(folder)
    vehicle, model = f"{folder}/vehicle.toml", f"diagnose/{case}/out/model.toml"
    of = partial("hidden/{}/{}".format, case)
    calibration, holdouts = logs.line(of("calibration/*")), logs.line(of("holdout/*"))
    ramp, fast, coast, slow = (
        logs.line(of(f"calibration/{name}.*")) for name in ("ramp", "ramp_fast", "coast*w", "coast")
    )
    name = tomllib.loads((logs.home / vehicle).read_text(encoding="utf-8"))["name"]
    store, driving = f"--store fit/{case}/store", f"--vehicle {vehicle} --model {model}"
    combinations = {
        "ramp": ramp,
        "ramp_coast": f"{ramp} {coast}",
        "ramps_coasts": f"{ramp} {fast} {coast} {slow}",
        "everything": calibration,
    }
    return [
        Call(
            f"diagnose/{case}",
            f"diagnose {calibration} --holdout {holdouts} --vehicle {vehicle} "
            "--out {here}/out --json",
        ),
        *fits(case, vehicle, combinations),
        Call(f"fit/{case}/model", f"fit {ramp} {fast} {coast} {driving} {store} --json"),
        *validations(case, name, range(1, 5), holdouts),
        Call(
            f"validate/{case}/model",
            f"validate {name}@2 {holdouts} --model {model} {store} --out {{here}}/out --json",
        ),
        *(
            Call(
                f"simulate/{case}/{stem(log)}",
                f"simulate {log} {driving} --out {{here}}/sim{Path(log).suffix} --json",
            )
            for log in (*logs(of("holdout/*")), ramp)
        ),
        Call(
            f"simulate/{case}/manoeuvre",
            f"simulate --manoeuvre wave --noise 3 {driving} --out {{here}}/sim.csv --json",
        ),
    ]


def stored(logs: Samples) -> Chain:
    """The tables of the repository, on the hold-outs of their cars and in the store's commands."""
    store, limits = f"--store {TABLES}", f"--limits {LOGS}/limits.toml"
    stops = logs.line("sedan/*stop*", "sedan/transition*", "sedan/*wet_pads*")
    used = {
        "sedan-2up@1": stops,
        "sedan-2up@2": stops,
        "sedan-sim@1": logs.line("simulation_study/stop*"),
        "escort@1": logs.line("third_party/hold*"),
    }
    folder = {table: table.replace("@", "_") for table in used}
    return [
        Call("tables/stored/list", f"tables list {store} --json"),
        Call("tables/stored/list_words", f"tables list {store}"),
        Call("tables/stored/verify", f"tables verify {store} --json"),
        Call("tables/stored/verify_words", f"tables verify {store}"),
        Call("tables/stored/diff", f"tables diff sedan-2up@1 sedan-2up@2 {store} --json"),
        Call("tables/stored/diff_words", f"tables diff sedan-2up@1 sedan-2up@2 {store}"),
        Call("tables/stored/diff_cars", f"tables diff sedan-2up@2 escort@1 {store} --json"),
        *(Call(f"tables/stored/{folder[t]}_show", f"tables show {t} {store} --json") for t in used),
        *(Call(f"tables/stored/{folder[t]}_show_words", f"tables show {t} {store}") for t in used),
        *(
            Call(
                f"validate/stored/{folder[t]}",
                f"validate {t} {logged} {store} --out {{here}}/out --json",
            )
            for t, logged in used.items()
        ),
        *(
            Call(f"validate/stored/{folder[t]}_words", f"validate {t} {logged} {store}")
            for t, logged in used.items()
        ),
        Call("validate/stored/limits", f"validate sedan-2up {stops} {store} {limits} --json"),
        Call(
            "export/state/cdfx",
            f"tables export sedan-2up@2 --format cdfx --out {{here}}/table.cdfx {store} --json "
            "--validation validate/stored/sedan-2up_2/out/summary.json",
        ),
    ]


def exports() -> Chain:
    """Every format of every stored table; fewer points, fixed point, and what is read back."""
    store = f"--store {TABLES}"

    def export(folder: str, table: str, form: str, more: str = "") -> Call:
        return Call(
            f"export/{folder}",
            f"tables export {table} --format {form} --out {{here}}/{FORMATS[form]} {store} "
            f"--json {more}",
        )

    tables = ("sedan-2up@1", "sedan-2up@2", "sedan-sim@1", "escort@1")
    return [
        *(
            export(f"{table.replace('@', '_')}/{form}", table, form)
            for table in tables
            for form in FORMATS
        ),
        *(export(f"points_16/{form}", "sedan-2up", form, "--points 16") for form in FORMATS),
        *(export(f"points_8/{form}", "escort", form, "--points 8") for form in ("dcm", "c-header")),
        *(
            export(f"fixed_{bits}/{car}", car, "c-header", f"--points 12 --fixed-point {bits}")
            for bits in (8, 16, 32)
            for car in ("sedan-2up", "escort")
        ),
        *(
            Call(f"import/{folder}_{form}", f"tables import export/{folder}/{form}/{name} {more}")
            for form, name in FORMATS.items()
            if form in ("dcm", "cdfx")
            for folder, more in (
                ("sedan-2up_2", f"{store} --json"),
                ("points_16", f"{store} --json"),
                ("escort_1", store),
            )
        ),
    ]


def stations(logs: Samples) -> Chain:
    """A car that passes, with all exports; one that fails; one of the multi-body simulator."""
    ramp, repeat, coast = logs(
        "sedan/ramp_wet_asphalt.csv", "sedan/ramp_*_repeat.csv", "sedan/coast*"
    )
    same, wet = logs.line("sedan/dry*", "sedan/transition*"), logs.line("sedan/*wet_pads*")
    vehicle = f"--vehicle {LOGS}/sedan/vehicle.toml --golden {TABLES}/sedan-2up/v0002"
    forms = " ".join(f"--export {form}" for form in FORMATS)
    out = "--store {here}/store --out {here}/out"
    other = logs.line("third_party/cal*", "third_party/hold*")
    return [
        Call("limits/file", "limits init --out {here}/line.toml --json"),
        Call("limits/words", "limits init"),
        Call(
            "station/passed",
            f"station {ramp} {same} --coast {coast} {vehicle} {IDENTITY} {forms} {out} --json",
        ),
        Call(
            "station/failed",
            f"station {ramp} {same} {wet} --ramp {repeat} --coast {coast} {vehicle} "
            f"--limits limits/file/line.toml {IDENTITY} {forms} {out} --json",
        ),
        Call("station/words", f"station {ramp} {same} --coast {coast} {vehicle} {out}"),
        Call(
            "station/third_party",
            f"station {other} --vehicle {LOGS}/third_party/vehicle.toml {out} --json",
        ),
    ]


def simulations(logs: Samples) -> Chain:
    """Logs driven again by the vehicle's own model, and manoeuvres that are fitted and proved."""
    calls = [
        Call(
            f"simulate/{car}/{stem(log)}",
            f"simulate {log} --vehicle {LOGS}/{car}/vehicle.toml "
            f"--out {{here}}/sim{Path(log).suffix} --json",
        )
        for car in ("sedan", "simulation_study", "third_party")
        for log in logs(f"{car}/*.csv" if car == "sedan" else f"{car}/*.parquet")
    ]
    vehicle = f"--vehicle {LOGS}/sedan/vehicle.toml"
    calls += [
        Call(
            f"simulate/manoeuvres/{name}",
            f"simulate --manoeuvre {name} {vehicle} --noise {seed} --out {{here}}/{name}.csv "
            "--json",
        )
        for seed, name in enumerate(MANOEUVRES)
    ]
    made = {name: f"simulate/manoeuvres/{name}/{name}.csv" for name in MANOEUVRES}
    stops = " ".join(made[name] for name in ("step", "wave", "staircase"))
    return [
        *calls,
        Call(
            "simulate/manoeuvres/told",
            f"simulate --manoeuvre step {vehicle} --speed '90 km/h' --pressure '45 bar' "
            "--rate 100 --out {here}/told.parquet --json",
        ),
        *fits(
            "manoeuvres", f"{LOGS}/sedan/vehicle.toml", {"ramp": f"{made['ramp']} {made['coast']}"}
        ),
        *validations("manoeuvres", "sedan-2up", range(1, 2), stops),
        Call("check/manoeuvres", f"check {' '.join(made.values())} --json"),
    ]


def gauge() -> Chain:
    """Two ramps each of six cars, with stations and without."""
    return [
        Call("repeatability/stations", f"repeatability --plan {PLAN} --out {{here}}/out --json"),
        Call("repeatability/cars", f"repeatability --plan {PLAN_WITHOUT} --eta 0.1 --json"),
        Call("repeatability/words", f"repeatability --plan {PLAN_WITHOUT} --quantity pad_scale"),
    ]


def batches(logs: Samples) -> Chain:
    """Batches of all commands, and what the fleet's report says of them."""
    many = " ".join(f"{LOGS}/{f}" for f in ("sedan", "simulation_study", "third_party", "hidden"))
    case = logs("hidden/case_*")[0]
    jobs = {
        "check": f"check {many}",
        "check_map": f"check {LOGS}/real/toyota_brake.csv --map {LOGS}/real/toyota.toml",
        "fit_sedan": f"fit {LOGS}/sedan --vehicle {LOGS}/sedan/vehicle.toml",
        "fit_case": f"fit {case}/calibration --vehicle {case}/vehicle.toml",
        "validate": f"validate {LOGS}/sedan --table sedan-2up --store {TABLES}",
        "validate_limits": f"validate '{LOGS}/third_party/hold*.parquet' --table escort@1 "
        f"--store {TABLES} --limits {LOGS}/limits.toml",
        "diagnose": f"diagnose {logs('hidden/case_5')[0]}",
    }
    calls = [
        Call(f"batch/{name}", f"batch {line} --workers 2 --out {{here}}/out --json")
        for name, line in jobs.items()
    ]
    reported = ("check", "fit_sedan", "fit_case", "validate", "validate_limits")
    return [
        *calls,
        *(
            Call(
                f"fleet/{name}",
                f"fleet report batch/{name}/out/results.parquet --out {{here}}/out --json",
            )
            for name in reported
        ),
        Call(
            "fleet/ordered",
            "fleet report batch/check/out/results.parquet --order speed_max --figure eta_zero "
            "--figure rate --json",
        ),
        Call("fleet/words", "fleet report batch/check/out/results.parquet"),
    ]


def plots(logs: Samples) -> Chain:
    """A page of each sort."""
    store, car = f"--store {TABLES}", f"--vehicle {LOGS}/simulation_study/vehicle_wrong_pads.toml"
    ramp, stop = logs("sedan/ramp_wet_asphalt.csv", "sedan/basalt*")
    drawn = {
        "table": "sedan-2up",
        "table_ramp": f"sedan-2up {ramp}",
        "tables": "sedan-2up@1 sedan-2up@2",
        "stop": f"sedan-2up {stop}",
        "truth": f"escort {logs('third_party/hold3*')[0]}",
        "other_pads": f"sedan-sim {logs('simulation_study/stop*')[0]} {car}",
        "log": logs("third_party/cal*")[0],
        "real": f"{LOGS}/real/toyota_brake.csv --map {LOGS}/real/toyota.toml",
    }
    return [
        Call(f"plot/{name}", f"plot {what} {store} --out {{here}}/page.svg --json")
        for name, what in drawn.items()
    ]


def checks(logs: Samples) -> Chain:
    """What is in every log; a call for each folder."""
    folders = [LOGS + "/sedan", LOGS + "/simulation_study", LOGS + "/third_party"]
    folders += logs("hidden/case_*/calibration", "hidden/case_*/holdout")
    calls = []
    for folder in folders:
        below = Path(folder).relative_to(LOGS).as_posix()
        found = logs.line(f"{below}/*.csv" if below == "sedan" else f"{below}/*.parquet")
        name = below.replace("hidden/", "")
        calls.append(Call(f"check/{name}", f"check {found} --json"))
    return [
        *calls,
        Call("check/words", f"check {logs.line('sedan/*.csv', 'third_party/*.parquet')}"),
    ]


def maps(logs: Samples) -> Chain:
    """The logs of production cars, with their maps and without; proposals for all CSV logs."""
    calls = []
    for log in logs("real/*.csv"):
        name = stem(log)
        written = f"{LOGS}/real/{name.removesuffix('_brake')}.toml"
        calls += [
            Call(f"check/{name}", f"check {log} --json"),
            Call(f"check/{name}_map", f"check {log} --map {written} --json"),
            Call(f"map/{name}", f"map suggest {log} --out {{here}}/map.toml --json"),
            Call(f"map/{name}_told", f"map suggest {log} --take p_mc= --radius 0.31 --json"),
            Call(f"map/{name}_words", f"map suggest {log} --map {written}"),
            Call(f"check/{name}_suggested", f"check {log} --map map/{name}/map.toml --json"),
        ]
    others = logs("sedan/*.csv", "simulation_study/*.parquet", "third_party/cal*")
    return [*calls, *(Call(f"map/{stem(log)}", f"map suggest {log} --json") for log in others)]


def refused(logs: Samples) -> Chain:
    """What must be refused, and how it is said."""
    coast, stop, ramp, real = logs(
        "sedan/coast*", "sedan/dry*", "sedan/ramp_wet_asphalt.csv", "real/toyota*.csv"
    )
    vehicle, store = f"--vehicle {LOGS}/sedan/vehicle.toml", f"--store {TABLES}"
    into = "--store {here}/store"
    mapped = f"{real} --map {LOGS}/real/toyota.toml"
    lines = {
        "fit_coast": f"fit {coast} {vehicle} {into}",
        "fit_stop": f"fit {stop} {vehicle} {into}",
        "fit_twice": f"fit {ramp} {ramp} {vehicle} {into}",
        "fit_real": f"fit {mapped} {vehicle} {into}",
        "fit_no_vehicle": f"fit {ramp} --vehicle {LOGS}/limits.toml {into}",
        "check_toml": f"check {LOGS}/limits.toml --json",
        "check_missing": "check missing.csv --json",
        "validate_no_table": f"validate sedan-3up {stop} {store}",
        "validate_no_version": f"validate sedan-2up@9 {stop} {store}",
        "validate_other_car": f"validate escort {stop} {vehicle} {store}",
        "validate_real": f"validate sedan-2up {mapped} {store}",
        "show_broken": f"tables show sedan-2up@1 --store {BROKEN}",
        "verify_broken": f"tables verify --store {BROKEN} --json",
        "export_form": f"tables export sedan-2up --format dmc --out {{here}}/x.dcm {store}",
        "effect": "effects hydraulic_lak",
        "option": "check --jason",
        "simulate": f"simulate {vehicle} --out {{here}}/x.csv",
        "station_golden": f"station {ramp} {stop} {vehicle} --golden sedan-2up --out {{here}}/x",
        "quantity": f"repeatability --plan {PLAN} --quantity pad_scald",
        "batch": f"batch validate {LOGS}/sedan --out {{here}}/x",
    }
    return [Call(f"refused/{name}", line) for name, line in lines.items()]


def cards() -> Chain:
    """The catalogue of effects, and the help of every command."""
    return [
        Call("effects/all", "effects --json"),
        Call("effects/words", "effects"),
        Call("effects/card", "effects hydraulic_lag"),
        Call("help/all", "--help"),
        Call("help/version", "--version"),
        *(Call(f"help/{name.replace(' ', '_')}", f"{name} --help") for name in COMMANDS),
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
    for path, lines in ((PLAN, with_station), (PLAN_WITHOUT, without)):
        (home / path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def run(call: Call, command: list[str], home: Path) -> int:
    """Type one line in the folder of the recording and keep what comes out; the exit code."""
    arguments = shlex.split(call.line.replace("{here}", call.folder))
    folder = home / call.folder
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
    told = {"arguments": arguments, "exit_code": done.returncode}
    (folder / "call.json").write_text(json.dumps(told, indent=2) + "\n", encoding="utf-8")
    if done.stdout:
        name = "stdout.json" if "--json" in arguments else "stdout.txt"
        (folder / name).write_bytes(done.stdout)
    if done.returncode not in (0, 1) or b"Traceback" in done.stderr:
        (folder / "error.txt").write_bytes(done.stderr)
    return done.returncode


def record(home: Path, command: list[str], samples: Path, tables: Path, jobs: int) -> int:
    """Run everything; 0 unless a call ended as only the refused ones may."""
    if home.exists() and any(home.iterdir()):
        raise MisuseError(f"{home} is not empty")
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True)
    home.mkdir(parents=True, exist_ok=True)
    write_inputs(home, samples, tables)
    begun, codes = time.perf_counter(), {}

    def work(item: tuple[str, Chain]) -> str:
        start = time.perf_counter()
        codes.update({call.folder: run(call, command, home) for call in item[1]})
        return f"{item[0]:<20} {len(item[1]):4} calls {time.perf_counter() - start:6.1f} s"

    with ThreadPoolExecutor(jobs) as pool:
        for line in pool.map(work, chains(Samples(home)).items()):
            print(line, flush=True)
    seconds = time.perf_counter() - begun
    counted = {str(code): count for code, count in sorted(Counter(codes.values()).items())}
    told = {
        "command": command,
        "version": version.stdout.strip(),
        "recorded": time.strftime("%Y-%m-%d %H:%M:%S"),
        "seconds": round(seconds, 1),
        "calls": len(codes),
        "exit_codes": counted,
    }
    (home / RECORDING).write_text(json.dumps(told, indent=2) + "\n", encoding="utf-8")
    said = ", ".join(f"{count} with {code}" for code, count in counted.items())
    print(f"\n{len(codes)} calls in {seconds:.0f} s; exit codes: {said}")
    odd = [f for f, code in codes.items() if code not in (0, 1) and not f.startswith("refused/")]
    odd += [p.parent.relative_to(home).as_posix() for p in sorted(home.rglob("error.txt"))
            if "Traceback" in p.read_text(encoding="utf-8", errors="replace")]  # fmt: skip
    for folder in odd:
        print(f"look at {folder}/error.txt: exit code {codes[folder]}")
    return 0


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
        whole = ".".join(keys)
        for old, new in self.renamed.items():
            if whole == old or whole.endswith(f".{old}"):
                return new
        return keys[-1]

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

    def named(self, path: Path) -> str:
        """A file of this folder by its name in the other one."""
        return "/".join(map(self.name, path.relative_to(self.home).parts))


def number(value: object) -> bool:
    """Whether a value of a document is a number; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


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
    else:
        yield place, Leaf((repr(side.text(value) if isinstance(value, str) else value),))


def read_json(path: Path, side: Side) -> Leaves:
    """One document."""
    return leaves(json.loads(path.read_text(encoding="utf-8")), side)


def read_journal(path: Path, side: Side) -> Leaves:
    """A document a line, sorted: which worker is done first is chance."""
    lines = sorted(path.read_text(encoding="utf-8").splitlines())
    return leaves([json.loads(line) for line in lines], side)


def read_toml(path: Path, side: Side) -> Leaves:
    """The document, and its remarks."""
    text = path.read_text(encoding="utf-8")
    yield from leaves(tomllib.loads(text), side)
    remarks = re.findall(r"(?m)(?:^|\s)#([^\"\n]*)$", text)
    yield from numbers_and_words([side.text(remark) for remark in remarks], "remark")


def column(cells: list[str], side: Side) -> Leaf:
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
    rows = list(csv.reader(line for line in lines if line and not line.startswith("#")))
    heads = []
    for head in rows[0]:
        name, bracket, unit = head.partition(" [")
        heads.append(side.name(name) + bracket + unit)
    yield "columns", Leaf(tuple(heads))
    yield "cells", Leaf(tuple(str(n) for n in sorted({len(row) for row in rows})))
    for head, cells in zip(heads, zip(*rows[1:], strict=False), strict=False):
        yield head, column(list(cells), side)


def read_parquet(path: Path, side: Side) -> Leaves:
    """Columns with their units and meanings, and the metadata of the file."""
    table = pq.read_table(path)
    names = [side.name(name) for name in table.column_names]
    yield "columns", Leaf(tuple(names))
    yield from leaves(metadata(table.schema.metadata), side, "metadata")
    for name, what in zip(names, table.schema, strict=True):
        yield from leaves(metadata(what.metadata), side, f"{name} metadata")
        values = table.column(what.name).to_pandas().to_numpy()
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
    "jsonl": read_journal,
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


def compare_files(name: str, a: Side, b: Side, tolerance: float, tally: Tally) -> list[str]:
    """Compare two files of one name; the places that differ, in words."""
    first, second = a.files[name], b.files[name]
    tally.files += 1
    if ending(name) in PICTURES or name.startswith(f"{INPUTS}/"):
        if first.read_bytes() == second.read_bytes():
            return []
        if ending(name) in PICTURES:
            return ["other bytes"]
    read = READERS.get(ending(name), read_text)
    try:
        left, right = collected(read(first, a)), collected(read(second, b))
    except ValueError as error:
        return [] if first.read_bytes() == second.read_bytes() else [f"cannot be read ({error})"]
    places = [f"{place} in BEFORE only" for place in left if place not in right]
    places += [f"{place} in AFTER only" for place in right if place not in left]
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
    a, b = side(before, inputs, RENAMED, REWORDED), side(after, inputs)
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
