"""The suite holds, and each kind of break is seen by the check that is meant for it."""

import hashlib
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from calib.demo.samples import sample_logs
from calib.estimation import adaptive
from calib.exports import export
from calib.fleet import run
from calib.logs import read
from calib.logs.bus import recording
from calib.physics import forces
from calib.physics.vehicle import Axle
from calib.qualification import causes, check, material
from calib.qualification.report import headline
from calib.qualification.suite import SUITE, qualify
from calib.qualification.use_cases import USE_CASES
from calib.station import station
from calib.statistics import random_effects
from calib.store import store
from calib.units import QUANTITIES, Unit
from calib.validation import validate

NAMES = [one.name for one in SUITE]


def failed(*names):
    """Names of the checks that do not hold, of those named."""
    found = qualify([one for one in SUITE if one.name in names])
    assert len(found.outcomes) == len(names)
    return {outcome.check.name for outcome in found.outcomes if not outcome.held}


@pytest.fixture(scope="module")
def found():
    return qualify()


@pytest.mark.smoke
def test_every_check_holds(found):
    assert {o.check.name: (o.value, o.error) for o in found.outcomes if not o.held} == {}
    assert [o.check.name for o in found.outcomes] == NAMES


def test_the_files_that_were_used_are_told_with_their_digests(found):
    logs = sample_logs()
    assert {"third_party/cal_ramp.parquet", "hidden/case_0/vehicle.toml"} <= set(found.files)
    for name, digest in found.files.items():
        assert hashlib.sha256((logs / name).read_bytes()).hexdigest() == digest


def test_every_check_stands_for_a_malfunction_and_every_malfunction_has_one():
    used = [m.checks for case in USE_CASES for m in case.malfunctions]
    assert all(used)
    assert {name for names in used for name in names} == set(NAMES)
    assert len(set(NAMES)) == len(NAMES)


def test_the_hidden_sizes_are_those_of_the_answers():
    for case, key, value in ((0, "cda", causes.DRAG), (2, "tau", causes.LAG)):
        answer = json.loads((sample_logs() / f"hidden/case_{case}/answer.json").read_text())
        assert answer["settings"][key] == value


def test_a_wrong_torque_gain_is_seen_in_the_formula_and_in_the_pads(monkeypatch):
    right = Axle.torque_gain.fget
    monkeypatch.setattr(Axle, "torque_gain", property(lambda axle: 1.05 * right(axle)))
    assert failed("brake_torque", "fit_pads_f", "axle_load") == {"brake_torque", "fit_pads_f"}


def test_a_wrong_load_transfer_is_seen(monkeypatch):
    right = forces.axle_loads
    monkeypatch.setattr(forces, "axle_loads", lambda vehicle, z: right(vehicle, -z))
    assert failed("axle_load", "constraint", "adaptive_law") == {"axle_load", "constraint"}


def test_a_wrong_adaptive_law_is_seen(monkeypatch):
    right = adaptive.gradient
    monkeypatch.setattr(adaptive, "gradient", lambda y, u, g, dt: right(y, u, g, 1.001 * dt))
    assert failed("adaptive_law", "brake_torque") == {"adaptive_law"}


def test_a_wrong_spread_is_seen(monkeypatch):
    right = random_effects.between_variance
    monkeypatch.setattr(random_effects, "between_variance", lambda x, v: right(x, v) * 3 / 4)
    assert failed("spread_of_cars", "axle_load") == {"spread_of_cars"}


def test_a_wrong_unit_is_seen_by_itself_and_in_a_log(monkeypatch):
    monkeypatch.setitem(QUANTITIES["Pa"][1], "psi", Unit(6894.76))
    assert failed("unit_psi", "read_units", "read_dialect", "broken_logs") == {
        "unit_psi", "read_units", "read_dialect",
    }  # fmt: skip


def test_a_reader_that_takes_everything_is_seen(monkeypatch):
    monkeypatch.setattr("calib.qualification.reading.read_log", lambda path: path)
    assert failed("broken_logs") == {"broken_logs"}


BUS = {"read_asc", "read_blf", "read_log"}


def test_a_bus_that_is_decoded_wrong_is_seen(monkeypatch):
    right = recording.raw
    monkeypatch.setattr(
        recording, "raw", lambda data, start, length, little: right(data, start, length, True)
    )
    assert failed(*BUS, "read_mf4") == BUS


def test_a_recording_that_is_timed_wrong_is_seen(monkeypatch):
    right = read.on_one_clock

    def late(wanted, where):
        moved = [replace(w, trace=replace(w.trace, time=w.trace.time + 0.01 * (i == 0)))
                 for i, w in enumerate(wanted)]  # fmt: skip
        return right(moved, where)

    monkeypatch.setattr(read, "on_one_clock", late)
    assert failed(*BUS, "read_mf4", "read_units") == BUS | {"read_mf4"}


def test_readers_that_take_half_a_recording_are_seen(monkeypatch):
    monkeypatch.setattr("calib.qualification.recorded.read_log", lambda path, chart: path)
    assert failed("broken_bus_logs", "broken_mdf") == {"broken_bus_logs", "broken_mdf"}


def test_what_a_missing_package_reads_is_left_out_and_told(monkeypatch):
    right = check.find_spec
    monkeypatch.setattr(check, "find_spec", lambda name: None if name == "can" else right(name))
    found = qualify([c for c in SUITE if c.name in (*BUS, "read_mf4", "broken_bus_logs")])
    assert [o.check.name for o in found.outcomes] == ["read_mf4"]
    assert {c.name: c.missing for c in found.left_out} == dict.fromkeys(
        (*BUS, "broken_bus_logs"), ("can",)
    )
    assert headline(found).startswith("All 1 checks hold. Not made, because can is not installed: ")


@pytest.mark.parametrize("verdict", ["passed", "failed"])
def test_a_station_with_one_verdict_is_seen(monkeypatch, verdict):
    monkeypatch.setattr(station.StationCheck, "verdict", property(lambda self: verdict))
    assert failed("station_verdicts", "station_holdout") == {"station_verdicts"}


def test_a_batch_that_mixes_its_rows_is_seen(monkeypatch):
    right = run.write_results

    def turned(rows, settings, out):
        *rows, last = rows
        cells = [row.cells for row in rows]
        moved = [replace(row, cells=c) for row, c in zip(rows, [*cells[1:], cells[0]], strict=True)]
        return right([*moved, last], settings, out)

    monkeypatch.setattr(run, "write_results", turned)
    assert "batch_pads" in failed("batch_pads", "batch_rows")


def test_pads_that_are_estimated_wrong_are_seen(monkeypatch):
    right = validate.estimate

    def wrong(*given, **named):
        found = right(*given, **named)
        front = replace(found.front, pad_friction=1.1 * found.front.pad_friction)
        return replace(found, front=front)

    monkeypatch.setattr(validate, "estimate", wrong)
    assert failed("stop_mu30_f", "stop_mu30_r", "fit_body_pads_f") == {"stop_mu30_f"}


def test_an_interval_that_is_too_narrow_is_seen(monkeypatch):
    right = validate.estimate

    def wrong(*given, **named):
        found = right(*given, **named)
        front = found.front
        return replace(found, front=replace(front, lower=front.pad_friction * 0.9999))

    monkeypatch.setattr(validate, "estimate", wrong)
    assert failed("stop_interval", "stop_mu30_f") == {"stop_interval"}


def test_a_verdict_that_is_always_good_is_seen(monkeypatch):
    monkeypatch.setattr(validate.Validation, "passed", property(lambda self: True))
    assert failed("verdict") == {"verdict"}


@pytest.mark.parametrize("form", ["csv", "dcm", "cdfx", "c-header"])
def test_an_export_of_a_rounded_curve_is_seen(monkeypatch, form):
    right = export.FORMATS[form]

    def wrong(order):
        curves = tuple(replace(c, values=np.round(c.values, 4)) for c in order.data.curves)
        return right(replace(order, data=replace(order.data, curves=curves)))

    monkeypatch.setitem(export.FORMATS, form, wrong)
    of_all = {f"export_{name}" for name in ("csv", "dcm", "cdfx", "c_header")}
    assert failed(*of_all) == {f"export_{form.replace('-', '_')}"}


def test_a_store_that_verifies_nothing_is_seen(monkeypatch):
    monkeypatch.setattr(store.Store, "load", lambda self, name: None)
    assert failed("damaged_tables", "export_csv") == {"damaged_tables"}


def test_a_diagnosis_without_a_name_is_seen(monkeypatch):
    nothing = SimpleNamespace(verdict="unknown", effects=())
    monkeypatch.setattr(material, "diagnose", lambda *logs: nothing)
    names = ("drag_named", "drag_size", "lag_named", "lag_size", "no_cause")
    assert failed(*names) == set(names)
