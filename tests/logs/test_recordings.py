"""One known run in every format gives the table of its CSV."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from calib.checks.check import check
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.physics.vehicle_file import read_vehicle
from calib.store.store import Store
from calib.table.table import Table
from tests.support.recordings import SEDAN, ramp, write_bus, write_dbc, write_map, write_mdf

TOLERANCE = 0.25
"""Of the half-width of the 95 % band, half a sigma: of a_x, p_mc and v every other sample is gone,
and the noise that was in it."""

PADS = 0.005
"""Relative, of the pad friction: a tenth of its standard deviation at the rear."""


@cache
def fitted() -> Table:
    return fit(read_vehicle(SEDAN / "vehicle.toml"), [ramp(), coast()])


@cache
def coast() -> Log:
    return read_log(SEDAN / "coast.csv")


def moved(x, y, low, high, x_ref, y_ref):
    """Largest change of a curve where both are known, in half-widths of the band there."""
    at = x_ref[(x_ref >= x[0]) & (x_ref <= x[-1]) & (high - low > 0)]
    half = 0.5 * np.interp(at, x_ref, high - low)
    return np.max(np.abs(np.interp(at, x, y) - np.interp(at, x_ref, y_ref)) / half)


def farthest(found: Table, ref: Table) -> float:
    """The largest change of D, f1 and f2 in half-widths."""
    d, e, p, q = found.difference, ref.difference, found.paper, ref.paper
    return max(
        moved(d.eta, d.D, e.lower, e.upper, e.eta, e.D),
        moved(p.eta, p.f1, q.f1_lower, q.f1_upper, q.eta, q.f1),
        moved(p.eta, p.f2, q.f2_lower, q.f2_upper, q.eta, q.f2),
    )


def write(folder: Path, name: str) -> tuple[Path, Path]:
    """A file of the run and its channel map."""
    path = folder / name
    if "bus" in name:
        return write_bus(path, 0.0 if path.suffix == ".mf4" else 1.7e9), write_dbc(folder)
    version = "4.10" if path.suffix == ".mf4" else "3.30"
    return write_mdf(path, version, 2 if "packed" in name else 0), write_map(folder)


@pytest.mark.smoke
@pytest.mark.parametrize(
    "name",
    ["run.mf4", "packed.mf4", "run.mdf", "run.dat", "bus.mf4", "bus.blf", "bus.asc", "bus.log"],
)
def test_the_table_is_that_of_the_csv(tmp_path, name):
    log = read_log(*write(tmp_path, name))
    found, ref = fit(read_vehicle(SEDAN / "vehicle.toml"), [log, coast()]), fitted()
    assert farthest(found, ref) < TOLERANCE
    for axle in "fr":
        pads = [getattr(t.calibration, f"pad_friction_{axle}").value for t in (found, ref)]
        assert pads[0] == pytest.approx(pads[1], rel=PADS)
    assert found.calibration.pad_scale.value == pytest.approx(
        ref.calibration.pad_scale.value, rel=PADS
    )


def test_on_one_raster_it_is_the_same_but_for_rounding(tmp_path):
    path = write_mdf(tmp_path / "run.mf4", mixed=False)
    log = read_log(path, write_map(tmp_path))
    np.testing.assert_array_equal(log.time, ramp().time)
    for name in log.channels:
        np.testing.assert_allclose(log[name], ramp()[name], rtol=1e-14)
    assert not any("interpolated" in note for note in log.notes)
    found = fit(read_vehicle(SEDAN / "vehicle.toml"), [log, coast()])
    assert farthest(found, fitted()) < 1e-4


def test_what_was_done_is_in_the_log_and_in_the_table(tmp_path):
    log = read_log(*write(tmp_path, "bus.blf"))
    assert any("(message WHEELS of bus 0, 200 Hz) is the clock" in note for note in log.notes)
    assert any("interpolated linearly" in note for note in log.notes)
    assert any("chassis.dbc (SHA-256" in note for note in log.notes)
    assert not any(str(tmp_path) in note for note in log.notes)
    store = Store(tmp_path / "tables")
    stored = store.save(fit(read_vehicle(SEDAN / "vehicle.toml"), [log, coast()]))
    parents = {x.name: x.notes for x in store.load(stored.id).table.provenance.logs}
    assert parents == {"bus": log.notes, "coast": ()}
    assert check(log).notes == log.notes


def test_a_log_that_was_taken_as_it_is_leaves_the_record_as_it_was():
    record, _ = fitted().content()
    kept = {"name", "digest", "role", "fingerprint"}
    assert all(set(x) == kept for x in record["provenance"]["logs"])


def test_the_samples_are_those_of_the_csv(tmp_path):
    """Wheels keep their samples to the resolution of the bus; the rest is theirs in between."""
    log, run = read_log(*write(tmp_path, "bus.blf")), ramp()
    assert run.time[0] <= log.time[0] < log.time[-1] <= run.time[-1]
    for name in ("omega_fl", "omega_fr", "omega_rl", "omega_rr"):
        np.testing.assert_allclose(log[name], np.interp(log.time, run.time, run[name]), atol=0.0026)
    even = np.isclose(np.round(log.time * 100) / 100, log.time, atol=1e-6)
    p = np.interp(log.time[even], run.time, run["p_mc"])
    np.testing.assert_allclose(log["p_mc"][even], p, atol=600.0)


@pytest.mark.parametrize("name", ["run.mf4", "bus.blf"])
@pytest.mark.parametrize("command", ["check", "fit", "validate", "plot", "simulate"])
def test_every_command_reads_it(tmp_path, brake_cal, name, command):
    path, chart = write(tmp_path, name)
    car = SEDAN / "vehicle.toml"
    arguments = {
        "check": [path],
        "fit": [path, "--vehicle", car, "--store", tmp_path / "t"],
        "validate": ["sedan-2up", path, "--store", SEDAN.parents[1] / "tables"],
        "plot": [path, "--out", tmp_path / "x.png"],
        "simulate": [path, "--vehicle", car, "--out", tmp_path / "x.csv"],
    }
    ran = brake_cal(command, *arguments[command], "--map", chart)
    assert ran.code in (0, 1), ran.err
    assert "Traceback" not in ran.err


def test_simulate_takes_no_map_without_a_log(tmp_path, brake_cal):
    car, chart = SEDAN / "vehicle.toml", write_map(tmp_path)
    out = tmp_path / "x.csv"
    ran = brake_cal(
        "simulate", "--manoeuvre", "ramp", "--vehicle", car, "--out", out, "--map", chart
    )
    assert ran.code == 2
    assert not out.exists()
