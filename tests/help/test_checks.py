"""All checks hold, and each kind of break is seen by the check that is meant for it."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from calib.base import random_effects
from calib.base.units import QUANTITIES, Unit
from calib.car import forces
from calib.car.vehicle import Axle
from calib.estimation import adaptive, validate
from calib.exports.write import FORMATS
from calib.help import checks, qualify
from calib.help.checks import SUITE
from calib.help.samples import sample_logs
from calib.store import store


def failed(*names):
    """Names of the checks that do not hold, of those named."""
    found = qualify.qualify([one for one in SUITE if one.name in names])
    assert len(found.outcomes) == len(names)
    return {outcome.check.name for outcome in found.failed}


@pytest.mark.smoke
def test_every_check_holds():
    found = qualify.qualify(SUITE)
    assert {o.check.name: (o.value, o.error) for o in found.failed} == {}
    assert {"third_party/cal_ramp.parquet", "hidden/case_0/vehicle.toml"} <= set(found.files)
    assert len({one.name for one in SUITE}) == len(SUITE)


def test_the_hidden_size_is_that_of_the_answer():
    answer = json.loads((sample_logs() / checks.HIDDEN / "answer.json").read_text())
    assert answer["settings"]["cda"] == checks.DRAG


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
    of_units = {"unit_psi", "read_units", "read_dialect"}
    assert failed(*of_units, "broken_logs") == of_units


def test_a_reader_that_takes_everything_is_seen(monkeypatch):
    monkeypatch.setattr(checks, "read_log", lambda path: path)
    assert failed("broken_logs") == {"broken_logs"}


def wrong_front(monkeypatch, change):
    """Let the estimate of every stop have another front axle."""
    right = validate.estimate

    def wrong(*given, **named):
        found = right(*given, **named)
        return replace(found, front=change(found.front))

    monkeypatch.setattr(validate, "estimate", wrong)


def test_pads_that_are_estimated_wrong_are_seen(monkeypatch):
    wrong_front(monkeypatch, lambda axle: replace(axle, pad_friction=1.1 * axle.pad_friction))
    names = ("stop_mu25_mu33_f", "stop_mu25_mu33_r", "fit_body_pads_f")
    assert failed(*names) == {"stop_mu25_mu33_f"}


def test_an_interval_that_is_too_narrow_is_seen(monkeypatch):
    wrong_front(
        monkeypatch,
        lambda axle: replace(
            axle, lower=axle.pad_friction * 0.9999, upper=axle.pad_friction * 1.0001
        ),
    )
    assert failed("stop_interval", "stop_mu25_mu33_f") == {"stop_interval"}


def test_a_verdict_that_is_always_good_is_seen(monkeypatch):
    monkeypatch.setattr(validate.Validation, "passed", property(lambda self: True))
    assert failed("verdict") == {"verdict"}


def test_an_export_of_a_rounded_curve_is_seen(monkeypatch):
    right = FORMATS["dcm"]

    def wrong(data):
        curves = tuple(replace(c, values=np.round(c.values, 4)) for c in data.curves)
        return right.write(replace(data, curves=curves))

    monkeypatch.setitem(FORMATS, "dcm", replace(right, write=wrong))
    assert failed("export_dcm") == {"export_dcm"}


def test_a_store_that_verifies_nothing_is_seen(monkeypatch):
    monkeypatch.setattr(store.Store, "load", lambda self, name: None)
    assert failed("damaged_tables", "export_dcm") == {"damaged_tables"}


def test_a_diagnosis_without_a_name_is_seen(monkeypatch):
    nothing = SimpleNamespace(verdict="unknown", effects=())
    monkeypatch.setattr(qualify, "diagnose", lambda *logs: nothing)
    names = ("drag_named", "drag_size", "no_cause")
    assert failed(*names) == set(names)
