"""Runs that will not do: one message that names the file, exit code 3, nothing written.

Files that are no log are in test_hostile.py; what each reader says is tried beside it.
"""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from calib.logs.write import write_csv
from calib.store.store import Store
from tests.cli.conftest import parsed
from tests.support.made_runs import changed
from tests.support.reference_car import CAR, REAL, SEDAN, cut, noisy, ramp, stop, swapped, without

WHEELS = ("omega_fl", "omega_fr", "omega_rl", "omega_rr")
RUNS = {
    "constant a_x": lambda log: changed(log, a_x=np.full(log.time.size, log["a_x"][0])),
    "swapped axles": swapped,
    "no unbraked part": lambda log: cut(log, 2.0),
    "another vehicle": lambda log: changed(log, **{w: log[w] * 0.322 / 0.30 for w in WHEELS}),
    "10 Hz": lambda log: replace(log, channels={k: x[::20] for k, x in log.channels.items()}),
}
GOOD = {"fit": noisy(ramp(REAL), 1), "validate": noisy(stop(REAL), 2)}


@pytest.fixture(scope="module")
def shelf(tmp_path_factory, fitted):
    store = tmp_path_factory.mktemp("bench") / "tables"
    Store(store).save(fitted)
    return store


@pytest.fixture
def attempt(brake_cal, shelf, tmp_path):
    """Run a command on a log; returns the file, what it did, and the list of what it wrote."""

    def run(command, log):
        path, place = tmp_path / "spoilt.csv", tmp_path / f"of_{command}"
        write_csv(replace(log, truth={}), path)
        words = {
            "fit": ("fit", path, "--vehicle", SEDAN / "vehicle.toml", "--store", place),
            "validate": ("validate", CAR.name, path, "--store", shelf, "--out", place),
        }[command]
        ran = brake_cal(*words, "--json")
        return path, ran, [place, *place.rglob("*")] if place.exists() else []

    return run


def refused(path, ran, written):
    assert (ran.code, ran.result) == (3, ""), ran.err
    errors = [line for line in ran.err.splitlines() if line.startswith("error: ")]
    assert len(errors) == 1
    assert ran.err.endswith(f"{errors[0]}\n")  # the last word
    assert len(ran.err.splitlines()) <= 2  # and before it what it was doing
    assert str(path) in errors[0]
    assert written == []


@pytest.mark.parametrize("command", GOOD)
@pytest.mark.parametrize("spoilt", RUNS)
def test_runs_that_will_not_do(attempt, command, spoilt):
    path, ran, written = attempt(command, RUNS[spoilt](GOOD[command]))
    if (command, spoilt) == ("validate", "swapped axles"):  # or weak front pads: weighed, and told
        (log,) = parsed(ran)["logs"]
        assert (ran.code, log["figures"]["valid_share"]) == (1, 0.0)
        assert "axles_exchanged" in log["warned"]
    else:
        refused(path, ran, written)


def test_a_stop_is_no_ramp_and_needs_no_v(attempt):
    log = without(GOOD["validate"], "v")
    assert attempt("validate", log)[1].code == 0
    refused(*attempt("fit", log))


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
