"""Bad input at the command line: one message that names the file, exit code 3, nothing written.

What each reader and check says in detail is tried beside them (tests/logs,
tests/run/test_check.py). Here each way to spoil an input goes through `fit` and `validate` as a
user would type them.
"""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from calib.logs.write import write_csv, write_parquet
from calib.store.store import Store
from tests.support.made_runs import changed
from tests.support.reference_car import CAR, REAL, SEDAN, cut, noisy, ramp, stop, swapped, without

WHEELS = ("omega_fl", "omega_fr", "omega_rl", "omega_rr")


@pytest.fixture(scope="module")
def bench(tmp_path_factory, fitted):
    """A good ramp and a good stop, each as a log and as a file, and a store with the table."""
    home = tmp_path_factory.mktemp("bench")
    logs = {"fit": noisy(ramp(REAL), 1), "validate": noisy(stop(REAL), 2)}
    for command, log in logs.items():
        write_csv(replace(log, truth={}), home / f"{command}.csv")
        write_parquet(replace(log, truth={}), home / f"{command}.parquet")
    Store(home / "tables").save(fitted)
    return home, logs


@pytest.fixture
def attempt(brake_cal, bench, tmp_path):
    """Run a command on a log; returns what it did, and the list of what it wrote."""
    home, _ = bench

    def run(command, log, *more, vehicle=SEDAN / "vehicle.toml"):
        if command == "fit":
            places = [tmp_path / "tables"]
            words = ("fit", log, "--vehicle", vehicle, "--store", *places)
        else:
            places = [tmp_path / "results"]
            words = ("validate", CAR.name, log, "--store", home / "tables", "--out", *places)
        ran = brake_cal(*words, *more)
        return ran, [p for place in places if place.exists() for p in [place, *place.rglob("*")]]

    return run


def refused(ran, written, file, code=3):
    assert ran.code == code, ran.err
    assert ran.result == ""
    errors = [line for line in ran.err.splitlines() if line.startswith("error: ")]
    assert len(errors) == 1
    assert ran.err.endswith(f"{errors[0]}\n")  # the last word
    assert len(ran.err.splitlines()) <= 2  # and before it what it was doing
    assert str(file) in errors[0]
    assert written == []


def on(text, row, column, cell):
    """The CSV with one cell replaced; rows count from 1, the header is row 0."""
    lines = text.splitlines()
    cells = lines[row].split(",")
    cells[lines[0].split(",").index(column)] = cell
    lines[row] = ",".join(cells)
    return "\n".join([*lines, ""])


def gone(text, column, cell):
    """The CSV with 0.3 s of one column replaced: too long to be bridged."""
    for row in range(40, 100):
        text = on(text, row, column, cell)
    return text


def without_column(text, column):
    rows = [line.split(",") for line in text.splitlines()]
    k = rows[0].index(column)
    return "\n".join([*(",".join(r[:k] + r[k + 1 :]) for r in rows), ""])


def back_in_time(text):
    lines = text.splitlines()
    lines[200], lines[201] = lines[201], lines[200]
    return "\n".join([*lines, ""])


TEXTS = {
    "empty file": lambda t: "",
    "truncated": lambda t: t[: len(t) // 2],
    "no pressure": lambda t: without_column(t, "p_mc [bar]"),
    "unknown unit": lambda t: t.replace("[bar]", "[barg]"),
    "hole": lambda t: gone(t, "omega_fl [rad/s]", ""),
    "word": lambda t: on(t, 40, "p_mc [bar]", "high"),
    "time back": back_in_time,
}


@pytest.mark.parametrize("command", ["fit", "validate"])
@pytest.mark.parametrize("spoilt", TEXTS)
def test_files_that_are_no_log(attempt, bench, tmp_path, command, spoilt):
    path = tmp_path / "spoilt.csv"
    path.write_text(TEXTS[spoilt]((bench[0] / f"{command}.csv").read_text()))
    refused(*attempt(command, path, "--json"), path)


@pytest.mark.parametrize("command", ["fit", "validate"])
def test_no_file(attempt, tmp_path, command):
    refused(*attempt(command, tmp_path / "none.csv", "--json"), "none.csv")


@pytest.mark.parametrize("command", ["fit", "validate"])
@pytest.mark.parametrize("spoilt", ["truncated", "one bit", "text"])
def test_parquet_that_is_damaged(attempt, bench, tmp_path, command, spoilt):
    data = bytearray((bench[0] / f"{command}.parquet").read_bytes())
    if spoilt == "one bit":
        data[len(data) // 2] ^= 1
    path = tmp_path / "spoilt.parquet"
    other = {"truncated": data[: len(data) // 2], "text": b"time,p_mc\n"}
    path.write_bytes(other.get(spoilt, bytes(data)))
    refused(*attempt(command, path, "--json"), path)


def constant(channel):
    return lambda log: changed(log, **{channel: np.full(log.time.size, log[channel][0])})


def standing(log):
    rng = np.random.default_rng(0)
    still = {name: np.abs(1e-3 * rng.standard_normal(log.time.size)) for name in (*WHEELS, "v")}
    return changed(log, **still, a_x=0.05 * rng.standard_normal(log.time.size))


def controlled(log):
    """ABS on the front left wheel: it dips by 40 % four times a second."""
    cycle = (log.time > 4.0) & ((log.time * 4.0) % 1.0 < 0.5)
    return changed(log, omega_fl=np.where(cycle, 0.6, 1.0) * log["omega_fl"])


def on_other_wheels(log):
    return changed(log, **{w: log[w] * 0.322 / 0.30 for w in WHEELS})


RUNS = {
    "constant a_x": constant("a_x"),
    "swapped axles": swapped,
    "wrong sign of a_x": lambda log: changed(log, a_x=-log["a_x"]),
    "no unbraked part": lambda log: cut(log, 2.0),
    "standstill": standing,
    "another vehicle": on_other_wheels,
    "10 Hz": lambda log: replace(log, channels={k: x[::20] for k, x in log.channels.items()}),
    "a quarter of a second": lambda log: cut(log, 0.0, 0.3),
}


@pytest.mark.parametrize("command", ["fit", "validate"])
@pytest.mark.parametrize("spoilt", RUNS)
def test_runs_that_will_not_do(attempt, bench, tmp_path, command, spoilt):
    path = tmp_path / "spoilt.csv"
    write_csv(RUNS[spoilt](replace(bench[1][command], truth={})), path)
    ran = attempt(command, path, "--json")
    if (command, spoilt) == ("validate", "swapped axles"):  # or weak front pads: weighed, and told
        (run, _), (log,) = ran, json.loads(ran[0].out)["logs"]
        assert (run.code, log["figures"]["valid_share"]) == (1, 0.0)
        assert "axles_exchanged" in log["warned"]
    else:
        refused(*ran, path)


def test_abs_spoils_a_ramp_and_a_stop_is_only_not_trusted(attempt, bench, tmp_path):
    path = tmp_path / "spoilt.csv"
    write_csv(controlled(replace(bench[1]["fit"], truth={})), path)
    refused(*attempt("fit", path), path)
    write_csv(controlled(replace(bench[1]["validate"], truth={})), path)
    ran, written = attempt("validate", path)
    assert ran.code == 1
    assert "valid_share" in ran.out
    assert written


def test_a_stop_is_no_ramp_but_a_hold_out(attempt, bench):
    path = bench[0] / "validate.csv"
    refused(*attempt("fit", path), path)
    assert attempt("validate", path)[0].code == 0


VEHICLES = {
    "negative mass": ('mass = "1744 kg"', 'mass = "-1744 kg"'),
    "unit missing": ('mass = "1744 kg"', "mass = 1744"),
    "typing error": ("cg_height", "cg_hight"),
    "no TOML": ("[front]", "[front"),
    "another car": ("0.322 m", "0.300 m"),
}


@pytest.mark.parametrize("command", ["fit", "validate"])
@pytest.mark.parametrize("spoilt", [*VEHICLES, "no file"])
def test_vehicle_files(attempt, bench, tmp_path, command, spoilt):
    path, log = tmp_path / "vehicle.toml", bench[0] / f"{command}.csv"
    if spoilt in VEHICLES:
        path.write_text((SEDAN / "vehicle.toml").read_text().replace(*VEHICLES[spoilt]))
    if command == "fit":
        wrong = log if spoilt == "another car" else path
        refused(*attempt("fit", log, "--json", vehicle=path), wrong)
    else:
        refused(*attempt("validate", log, "--json", "--vehicle", path), path)


def test_all_that_is_wrong_with_a_vehicle_is_told_at_once(attempt, bench, tmp_path):
    path = tmp_path / "vehicle.toml"
    text = (SEDAN / "vehicle.toml").read_text()
    path.write_text(text.replace("pad_friction = 0.38", 'pad_friction = "good"'))
    ran, written = attempt("fit", bench[0] / "fit.csv", "--json", vehicle=path)
    assert (ran.code, ran.result, written) == (3, "", [])
    assert ran.err.splitlines()[-3:] == [
        f"error: {path}: 2 errors",
        "  front.pad_friction: 'good' is not a quantity; expected a number",
        "  rear.pad_friction: 'good' is not a quantity; expected a number",
    ]


@pytest.mark.parametrize(
    ("option", "text"),
    [
        ("--limits", "schema = 1\n[limits]\ntorque_eror_f = { max = 0.05 }\n"),
        ("--limits", "schema = 1\n[limits\n"),
        ("--map", 'schema = 1\n[channels.p_mx]\nsource = "x"\n'),
        ("--map", "schema = 1\n[channels\n"),
    ],
)
def test_limits_and_maps(attempt, bench, tmp_path, option, text):
    path = tmp_path / "file.toml"
    path.write_text(text)
    refused(*attempt("validate", bench[0] / "validate.csv", "--json", option, path), path)


def test_the_same_ramp_twice(brake_cal, bench, tmp_path):
    copy = tmp_path / "copy.csv"
    copy.write_bytes((bench[0] / "fit.csv").read_bytes())
    store = tmp_path / "tables"
    ran = brake_cal(
        "fit", bench[0] / "fit.csv", copy, "--vehicle", SEDAN / "vehicle.toml", "--store", store
    )
    refused(ran, [store] if store.exists() else [], copy)


@pytest.mark.parametrize("command", ["fit", "validate"])
def test_a_coast_alone(attempt, command):
    path = SEDAN / "coast.csv"
    refused(*attempt(command, path), path)


def test_without_v_a_run_is_no_bad_input(attempt, bench, tmp_path):
    for command in ("fit", "validate"):
        path = tmp_path / f"{command}.csv"
        write_csv(without(replace(bench[1][command], truth={}), "v"), path)
        assert attempt(command, path)[0].code == 0


def test_an_own_process_ends_the_same_way(tmp_path):
    """Once as the shell does it: no traceback on the way out of the interpreter either."""
    path = tmp_path / "empty.csv"
    path.write_text("")
    words = ("fit", path, "--vehicle", SEDAN / "vehicle.toml", "--store", tmp_path / "t", "--json")
    ran = subprocess.run(
        [sys.executable, "-m", "cli.main", *map(str, words)],
        cwd=SEDAN.parents[1],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == json.loads(ran.stdout)["error"]["exit_code"] == 3
    assert ran.stderr.splitlines()[-1].startswith(f"error: {path}: the file is empty")
    assert "Traceback" not in ran.stderr
    assert list(tmp_path.iterdir()) == [path]
