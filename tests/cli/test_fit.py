"""`brake-cal fit` as the shell runs it."""

import hashlib
from dataclasses import replace

import pytest

from calib.logs.write import write_csv
from calib.store.store import Store
from calib.table.budget import by_axle
from tests.cli.conftest import parsed
from tests.support.reference_car import CAR, REAL, SEDAN, noisy, ramp, stop, swapped, with_pads
from tests.support.tyre_files import written

RAMP, VEHICLE = SEDAN / "ramp_wet_asphalt.csv", SEDAN / "vehicle.toml"


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("logs") / "ramp.csv"
    write_csv(noisy(ramp(with_pads(REAL, 0.36, 0.36)), 1), path)
    return path


def test_json_is_one_document(brake_cal, log, store):
    ran = brake_cal("fit", log, "--vehicle", VEHICLE, "--store", store, "--json")
    assert ran.code == 0
    document = parsed(ran)
    stored = Store(store).load(CAR.name)
    assert stored.table.calibration.pad_friction_f.value == pytest.approx(0.36, rel=0.02)
    assert document["table"] == "sedan-2up@1"
    assert document["digest"] == stored.digest
    assert document["path"] == str(stored.path)
    assert document["calibration"]["pad_scale"]["value"] == stored.table.calibration.pad_scale.value
    assert set(document["effects"]) == {"aerodynamic_drag", "rolling_resistance"}
    assert document["quality"]["runs"] == 1.0
    assert document["answer"]["usable"] is False  # a draft
    assert document["budget"] == by_axle(stored.table.budget.axles)
    assert document["remarks"] == list(stored.table.remarks)


def test_a_run_that_will_not_do_ends_with_3_and_makes_no_store(brake_cal, store, tmp_path):
    for log in (swapped(noisy(ramp(REAL), 1)), noisy(stop(REAL), 2)):
        write_csv(replace(log, truth={}), tmp_path / "spoilt.csv")
        ran = brake_cal("fit", tmp_path / "spoilt.csv", "--vehicle", VEHICLE, "--store", store)
        assert (ran.code, ran.result, store.exists()) == (3, "", False)
        assert [str(tmp_path / "spoilt.csv") in x for x in ran.err.splitlines()][-1:] == [True]


def test_forces_of_a_roller_brake_tester(brake_cal, log, store, tmp_path):
    """Pads of 0.36 on both axles, in a file that says 0.38: the forces by T = mu C p."""
    bench = tmp_path / "rollers.toml"
    pressures, text = (1e6, 2e6, 3e6), "schema = 1\n"
    for name, axle in (("front", CAR.front), ("rear", CAR.rear)):
        area = 2 * axle.friction_faces * axle.piston_area * axle.effective_radius
        force = [f"{0.36 * area / axle.rolling_radius * (p - 4e4):.0f} N" for p in pressures]
        text += f"[{name}]\np_mc = {[f'{p:g} Pa' for p in pressures]}\nbrake_force = {force}\n"
    bench.write_text(text)
    arguments = ("fit", log, "--vehicle", VEHICLE, "--store", store, "--bench", bench)
    ran = brake_cal(*arguments, "--json")
    assert ran.code == 0
    ratio = parsed(ran)["calibration"]["pad_log_ratio"]
    assert abs(ratio["value"]) < 0.005
    assert ratio["sigma"] < 0.012
    logs = Store(store).load(CAR.name).table.provenance.logs
    digests = {one.role: one.digest for one in logs}
    assert digests["bench"] == hashlib.sha256(bench.read_bytes()).hexdigest()
    bench.write_text(text.replace("[rear]", "[axle]"))
    ran = brake_cal(*arguments, "--json")
    assert (ran.code, parsed(ran)["error"]["kind"]) == (3, "bench")


def test_a_stated_mass_gives_the_pads_of_a_loaded_car(brake_cal, store, tmp_path):
    loaded = tmp_path / "loaded.csv"
    write_csv(noisy(ramp(replace(REAL, mass_scale=1.2)), 1), loaded)
    words = ("fit", loaded, "--vehicle", VEHICLE, "--store", store)
    document = parsed(brake_cal(*words, "--mass", "2093 kg", "--json"))
    mass = {"value": 2093.0, "tolerance": 0.005, "stated": True, "share": 2093.0 / 1744.0}
    assert document["mass"] == mass
    assert document["calibration"]["pad_friction_f"]["value"] == pytest.approx(0.38, rel=0.02)
    assert brake_cal(*words).code == 0
    pads = Store(store).load(CAR.name).table.calibration.pad_friction_f.value
    assert pads == pytest.approx(0.38 / 1.2, rel=0.02)


def test_a_report_holds_the_inputs_and_is_refused_in_their_place(brake_cal, tmp_path):
    fit = ("fit", RAMP, "--vehicle", VEHICLE, "--store", tmp_path / "tables", "--report")
    page, foreign = tmp_path / "fit.html", tmp_path / "mine.html"
    foreign.write_text("<!DOCTYPE html>")
    for wrong in (tmp_path / "x.pdf", foreign):
        assert brake_cal(*fit, wrong).code == 2
    assert (foreign.read_text(), page.exists()) == ("<!DOCTYPE html>", False)
    assert brake_cal(*fit, page).code == 0
    text = page.read_text()
    for file in (RAMP, VEHICLE):
        assert hashlib.sha256(file.read_bytes()).hexdigest() in text


def test_released_cars_and_a_tyre_file_are_parents(brake_cal, log, store, tmp_path):
    """A second car of the model rests on the first; no mean is made of both."""
    first = ("fit", log, "--vehicle", VEHICLE, "--store", store)
    second, file = tmp_path / "second.csv", tmp_path / "second.toml"
    write_csv(noisy(ramp(with_pads(REAL, 0.38, 0.36)), 5), second)
    file.write_text(VEHICLE.read_text().replace("sedan-2up", "second"))
    fit = ("fit", second, "--vehicle", file, "--store", store)
    assert brake_cal(*fit, "--fleet-prior").code == 2  # no store
    assert brake_cal(*first).code == 0
    assert brake_cal(*fit, "--fleet-prior").code == 4  # a draft
    release = ("tables", "release", "sedan-2up@1", "--reason", "stops agree", "--store", store)
    assert brake_cal(*release).code == 0
    assert brake_cal(*fit).code == 0
    ran = brake_cal(*fit, "--fleet-prior", "--json")
    assert (ran.code, parsed(ran)["table"]) == (0, "second@2")
    tables = Store(store)
    plain, rests = (tables.load(f"second@{n}").table for n in (1, 2))
    parent = tables.load("sedan-2up@1")
    assert [(x.id, x.digest) for x in rests.provenance.parents] == [(parent.id, parent.digest)]
    assert plain.provenance.parents == ()
    assert plain.digest != rests.digest
    merge = ("tables", "merge", "sedan-2up", "second@2", "--name", "g", "--store", store)
    assert brake_cal(*merge).code == 2
    path = written(tmp_path / "tyre.tir", FNOMIN=4300.0)
    assert brake_cal(*fit, "--tyre", path).code == 0
    tyre = tables.load("second@3").table
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    assert ("tyre", digest) in [(x.role, x.digest) for x in tyre.provenance.logs]
    assert brake_cal(*fit, "--tyre", written(path, PKX1=None)).code == 3
