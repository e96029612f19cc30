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
from calib.estimation import baselines, validate
from calib.exports.write import FORMATS
from calib.help import checks, qualify
from calib.help.checks import SUITE
from calib.help.samples import sample_logs
from calib.store import store


def failed(*names):
    """Names of the checks that do not hold, of those named."""
    found = qualify.qualify([one for one in SUITE if one.name in names])
    assert len(found["checks"]) == len(names)
    return {one["name"] for one in found["checks"] if not one["held"]}


@pytest.mark.smoke
def test_every_check_holds():
    found = qualify.qualify(SUITE)
    assert [one for one in found["checks"] if not one["held"]] == []
    assert {"third_party/cal_ramp.parquet", "hidden/case_0/vehicle.toml"} <= set(found["files"])
    assert len({one.name for one in SUITE}) == len(SUITE)


def test_the_hidden_size_is_that_of_the_answer():
    answer = json.loads((sample_logs() / checks.HIDDEN / "answer.json").read_text())
    assert answer["settings"]["cda"] == checks.DRAG


def wrong_estimate(monkeypatch, name, change):
    """Let a quantity of the front axle be another one in the estimate of every stop."""
    right = validate.estimate

    def wrong(*given, **named):
        found = right(*given, **named)
        return replace(found, best=replace(found.best, **{name: change(getattr(found.best, name))}))

    monkeypatch.setattr(validate, "estimate", wrong)


def wrong_gain(monkeypatch):
    right = Axle.torque_gain.fget
    monkeypatch.setattr(Axle, "torque_gain", property(lambda axle: 1.05 * right(axle)))


def wrong_loads(monkeypatch):
    right = forces.axle_loads
    monkeypatch.setattr(forces, "axle_loads", lambda vehicle, z: right(vehicle, -z))


def wrong_law(monkeypatch):
    right = baselines.gradient
    monkeypatch.setattr(baselines, "gradient", lambda y, u, g, dt: right(y, u, g, 1.001 * dt))


def wrong_spread(monkeypatch):
    right = random_effects.between_variance
    monkeypatch.setattr(random_effects, "between_variance", lambda x, v: right(x, v) * 3 / 4)


def wrong_unit(monkeypatch):
    monkeypatch.setitem(QUANTITIES["Pa"][1], "psi", Unit(6894.76))


def reader_that_takes_everything(monkeypatch):
    monkeypatch.setattr(checks, "read_log", lambda path: path)


def wrong_pads(monkeypatch):
    wrong_estimate(monkeypatch, "pads_f", lambda x: x._replace(value=1.1 * x.value))


def narrow_interval(monkeypatch):
    wrong_estimate(
        monkeypatch,
        "pads_f",
        lambda x: x._replace(lower=x.value * 0.9999, upper=x.value * 1.0001),
    )


def verdict_that_is_always_good(monkeypatch):
    monkeypatch.setattr(validate.Validation, "passed", property(lambda self: True))


def rounded_export(monkeypatch):
    right = FORMATS["dcm"]

    def wrong(data):
        curves = tuple(replace(c, values=np.round(c.values, 4)) for c in data.curves)
        return right.write(replace(data, curves=curves))

    monkeypatch.setitem(FORMATS, "dcm", replace(right, write=wrong))


def store_that_verifies_nothing(monkeypatch):
    monkeypatch.setattr(store.Store, "load", lambda self, name: None)


def diagnosis_without_a_name(monkeypatch):
    nothing = SimpleNamespace(verdict="unknown", effects=())
    monkeypatch.setattr(qualify, "diagnose", lambda *logs: nothing)


@pytest.mark.parametrize(
    ("break_it", "fails", "holds"),
    [
        (wrong_gain, "brake_torque fit_pads_f", "axle_load"),
        (wrong_loads, "axle_load constraint", "adaptive_law"),
        (wrong_law, "adaptive_law", "brake_torque"),
        (wrong_spread, "spread_of_cars", "axle_load"),
        (wrong_unit, "unit_psi read_units read_dialect", "broken_logs"),
        (reader_that_takes_everything, "broken_logs", ""),
        (wrong_pads, "stop_mu25_mu33_f", "stop_mu25_mu33_r fit_body_pads_f"),
        (narrow_interval, "stop_interval", "stop_mu25_mu33_f"),
        (verdict_that_is_always_good, "verdict", ""),
        (rounded_export, "export_dcm", ""),
        (store_that_verifies_nothing, "damaged_tables", "export_dcm"),
        (diagnosis_without_a_name, "drag_named drag_size no_cause", ""),
    ],
)
def test_a_break_is_seen_by_the_checks_that_are_meant_for_it(monkeypatch, break_it, fails, holds):
    break_it(monkeypatch)
    assert failed(*fails.split(), *holds.split()) == set(fails.split())
