"""Bad input at the command line: one message that names the file, exit code 3, nothing written.

What each reader and check says in detail is tried beside them (`tests/test_bad_input.py`,
tests/logs, tests/run), files made to break a reader in `test_hostile.py`. Here one of each kind of
spoilt input goes through `fit` and `validate`.
"""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from calib.logs.write import write_csv
from calib.store.store import Store
from tests.support.made_runs import changed
from tests.support.reference_car import CAR, REAL, SEDAN, cut, noisy, ramp, stop, swapped, without

WHEELS = ("omega_fl", "omega_fr", "omega_rl", "omega_rr")
CARS = (SEDAN / "vehicle.toml").read_text()


@pytest.fixture(scope="module")
def bench(tmp_path_factory, fitted):
    """A good ramp and a good stop, each as a log and as a file, and a store with the table."""
    home = tmp_path_factory.mktemp("bench")
    logs = {"fit": noisy(ramp(REAL), 1), "validate": noisy(stop(REAL), 2)}
    for command, log in logs.items():
        write_csv(replace(log, truth={}), home / f"{command}.csv")
    Store(home / "tables").save(fitted)
    return home, logs


@pytest.fixture
def attempt(brake_cal, bench, tmp_path):
    """Run a command on a log; returns what it did, and the list of what it wrote."""
    home, _ = bench

    def run(command, log, *more, vehicle=SEDAN / "vehicle.toml"):
        if command == "fit":
            place = tmp_path / "tables"
            words = ("fit", log, "--vehicle", vehicle, "--store", place)
        else:
            place = tmp_path / "results"
            words = ("validate", CAR.name, log, "--store", home / "tables", "--out", place)
        ran = brake_cal(*words, *more)
        return ran, [place, *place.rglob("*")] if place.exists() else []

    return run


def refused(ran, written, file):
    assert (ran.code, ran.result) == (3, ""), ran.err
    errors = [line for line in ran.err.splitlines() if line.startswith("error: ")]
    assert len(errors) == 1
    assert ran.err.endswith(f"{errors[0]}\n")  # the last word
    assert len(ran.err.splitlines()) <= 2  # and before it what it was doing
    assert str(file) in errors[0]
    assert written == []


TEXTS = {
    "no file": None,
    "truncated": lambda t: t[: len(t) // 2],
    "unknown unit": lambda t: t.replace("[bar]", "[barg]"),
}


@pytest.mark.parametrize("command", ["fit", "validate"])
@pytest.mark.parametrize("spoilt", TEXTS)
def test_files_that_are_no_log(attempt, bench, tmp_path, command, spoilt):
    path = tmp_path / "spoilt.csv"
    if spoil := TEXTS[spoilt]:
        path.write_text(spoil((bench[0] / f"{command}.csv").read_text()))
    refused(*attempt(command, path, "--json"), path)


RUNS = {
    "constant a_x": lambda log: changed(log, a_x=np.full(log.time.size, log["a_x"][0])),
    "swapped axles": swapped,
    "no unbraked part": lambda log: cut(log, 2.0),
    "another vehicle": lambda log: changed(log, **{w: log[w] * 0.322 / 0.30 for w in WHEELS}),
    "10 Hz": lambda log: replace(log, channels={k: x[::20] for k, x in log.channels.items()}),
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


def test_a_stop_is_no_ramp_and_needs_no_v(attempt, bench, tmp_path):
    path = tmp_path / "stop.csv"
    write_csv(without(replace(bench[1]["validate"], truth={}), "v"), path)
    assert attempt("validate", path)[0].code == 0
    refused(*attempt("fit", path), path)


def test_all_that_is_wrong_with_a_vehicle_is_told_at_once(attempt, bench, tmp_path):
    path = tmp_path / "vehicle.toml"
    path.write_text(CARS.replace("pad_friction = 0.38", 'pad_friction = "good"'))
    ran, written = attempt("fit", bench[0] / "fit.csv", "--json", vehicle=path)
    assert (ran.code, ran.result, written) == (3, "", [])
    assert [line.split(":")[0] for line in ran.err.splitlines()[-2:]] == [
        "  front.pad_friction",
        "  rear.pad_friction",
    ]


@pytest.mark.parametrize(
    ("option", "text"),
    [
        ("--vehicle", CARS.replace('mass = "1744 kg"', "mass = 1744")),
        ("--vehicle", CARS.replace("0.322 m", "0.300 m")),  # another car than that of the table
        ("--limits", "schema = 1\n[limits]\ntorque_eror_f = { max = 0.05 }\n"),
        ("--map", 'schema = 1\n[channels.p_mx]\nsource = "x"\n'),
    ],
)
def test_files_beside_a_log(attempt, bench, tmp_path, option, text):
    path = tmp_path / "file.toml"
    path.write_text(text)
    refused(*attempt("validate", bench[0] / "validate.csv", "--json", option, path), path)


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
    assert ran.stderr.splitlines()[-1].startswith(f"error: {path}: ")
    assert "Traceback" not in ran.stderr
    assert list(tmp_path.iterdir()) == [path]
