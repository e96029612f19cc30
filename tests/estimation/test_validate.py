"""Validation: whose log it is, what passes, what the summary says."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError, VehicleError
from calib.base.intervals import Z95
from calib.car.mass import MassUsed
from calib.estimation.limits import DEFAULTS
from calib.estimation.metrics import METRICS
from calib.estimation.results import to_dict
from calib.estimation.validate import Validation, validate
from calib.table.exported import Precision, as_exported
from tests.estimation.test_agreement import on_road
from tests.estimation.test_metrics import made_estimate
from tests.support.made_runs import made_run
from tests.support.made_runs import stop as made_stop
from tests.support.plant import magic
from tests.support.reference_car import CAR, REAL, WET, cut, noisy, ramp, stop, without
from tests.support.refusals import refusal
from tests.support.tables import stored_as


@pytest.fixture(scope="module")
def wet():
    return noisy(stop(WET), 3)


@pytest.fixture(scope="module")
def passed(fitted, wet):
    return validate(fitted, [wet])[0]


MASS = MassUsed(1744.0, 0.03, False)


def made_validation(name="a", mu_f=0.4, mu_r=0.36, judgements=(), **figures):
    estimate = on_road(made_estimate(), 0.0)
    values = dict.fromkeys(METRICS) | {"pad_friction_f": mu_f, "pad_friction_r": mu_r} | figures
    return Validation(name, "ab" * 32, "hold-out", estimate, values, tuple(judgements), MASS)


def refused(fitted, log, vehicle=None):
    return refusal(validate, fitted, [log], vehicle, kind=(LogError, VehicleError))


def test_a_good_stop_passes_with_all_its_figures(passed):
    assert passed.passed
    assert passed.role == "hold-out"
    assert [warning.code for warning in passed.warnings] == ["level_changed"]  # the pads are wet
    assert set(passed.figures) == set(METRICS)
    assert [j.figure for j in passed.judgements] == [limit.figure for limit in DEFAULTS]
    assert {j.verdict for j in passed.judgements} == {"passed"}
    assert passed.proof == "truth"
    for name in ("pad_friction_f", "ecu_pad_friction_f"):
        assert passed.figures[name] == pytest.approx(0.31, rel=0.05)
    assert passed.baselines["estimate"][0] < 0.3 * passed.baselines["nominal"][0]
    assert {"ecu", "mean_gain", "gradient_paper"} <= set(passed.baselines)


def test_a_copy_of_the_ramp_is_no_hold_out(fitted):
    """The table alone knows it, by the fingerprint in its record: cut, thinned and rounded."""
    run, rows = noisy(ramp(REAL), 1), slice(0, -60, 2)
    channels = {name: np.round(x[rows], 2) for name, x in run.channels.items()}
    channels["time"] = run.time[rows]
    copy = replace(run, channels=channels, truth={}, digest="ab" * 32)
    (result,) = validate(fitted, [copy])
    assert result.role == "calibration"
    assert not result.passed


def swapped_wheels(log, a, b):
    return replace(
        log, channels={**log.channels, f"omega_{a}": log[f"omega_{b}"],
                       f"omega_{b}": log[f"omega_{a}"]}, truth={}
    )  # fmt: skip


def test_wheels_of_a_diagonal_in_the_wrong_columns_leave_no_valid_sample(fitted):
    dry = noisy(stop(REAL), 5)
    (result,) = validate(fitted, [swapped_wheels(dry, "fr", "rl")])
    assert not result.estimate.valid.any()
    (warning,) = (warning for warning in result.warnings if warning.code == "wheels_crossed")
    assert "omega_fr and omega_rl have changed places" in warning.text
    assert warning.causes[0] in result.refused


def test_without_truth_and_v_nothing_is_proved(fitted, wet, passed):
    (unproved,) = validate(fitted, [without(replace(wet, truth={}), "v")])
    assert unproved.passed
    assert unproved.proof == "none"
    assert unproved.word not in ("passed", "failed")
    judged = [j.figure for j in unproved.judgements if j.verdict != "not known"]
    assert judged == ["valid_share", "covered_share", "ecu_valid_share"]
    stored = stored_as("sedan@1")
    assert to_dict(stored, [unproved])["proof"] == "none"
    summary = to_dict(stored, [unproved, passed])
    assert summary["proof"] == "truth"
    assert [log["proof"] for log in summary["logs"]] == ["none", "truth"]
    calibration = replace(passed, role="calibration")
    assert (calibration.proof, calibration.word) == ("none", "failed")


def test_a_map_that_is_wrong_fails_with_truth_and_with_v(fitted, wet, passed):
    """The ratio of an ECU's pads half as large again; the best estimate has the right map."""

    def with_other_ratio(maps):
        ratio = ("ratio", "ratio_lower", "ratio_upper")
        return replace(maps, **{name: getattr(maps, name) + 0.5 for name in ratio})

    maps = {name: with_other_ratio(getattr(fitted, name)) for name in ("map", "level_map")}
    wrong = replace(fitted, **maps)
    with_truth, without_truth = validate(fitted, [wet, replace(wet, truth={})], exported=wrong)
    assert with_truth.figures["pad_friction_r"] == passed.figures["pad_friction_r"]
    for result, metric in (
        (with_truth, "ecu_normalised_error_r"),
        (without_truth, "ecu_reference_r"),
    ):
        assert not result.passed
        assert metric in [j.figure for j in result.judgements if j.verdict == "failed"]
    # the level is known without the map of the ratio
    assert with_truth.figures["ecu_normalised_error_level"] < 2.0


def test_a_table_in_single_precision_is_as_good_as_the_whole_one(fitted, wet, passed):
    precision = Precision(single=True)
    (single,) = validate(fitted, [wet], exported=as_exported(fitted, precision))
    for name in ("ecu_pad_friction_f", "ecu_pad_friction_r", "ecu_pad_level"):
        assert single.figures[name] == pytest.approx(passed.figures[name], rel=1e-4)
    exported = to_dict(stored_as("t@1"), [single], precision)["exported"]
    assert exported == {"points": None, "bits": None, "single": True, "code": False}


def test_braking_too_soft_to_judge_does_not_pass(fitted):
    """1.9 bar brake the car, and no figure of an ECU comes of it: that is no proof."""
    soft = validate(fitted, [noisy(stop(REAL, pressure=1.9e5), 0)])[0]
    assert soft.figures["ecu_valid_share"] == 0.0
    assert soft.figures["ecu_pad_friction_f"] is None
    assert not soft.passed


def test_logs_that_will_not_do(fitted, wet):
    assert "roll for a second before the stop" in refused(fitted, cut(wet, 1.8))
    assert "no braking" in refused(fitted, made_run(lambda t: 0.0 * t))
    assert "brake for 1 s or more" in refused(fitted, made_run(made_stop(end=2.0)))


# What is said of all together.


def as_json(table, results):
    return json.loads(json.dumps(to_dict(stored_as(table), results), allow_nan=False))


def test_summary_holds_everything_and_is_json(fitted, wet, passed):
    (blind,) = validate(fitted, [replace(wet, name="blind", truth={})])
    summary = as_json("sedan@1", [passed, blind])
    assert summary["schema"] == 1
    assert summary["table"] == "sedan@1"
    first = summary["logs"][0]
    assert set(first["figures"]) == set(METRICS)
    for side in ("front", "rear"):
        parts = first["budget"][side]
        half = Z95 * math.sqrt(sum(x**2 for x in parts.values()))
        axle, valid = getattr(passed.estimate.best, f"pads_{side[0]}"), passed.estimate.valid
        widths = np.sort(0.5 * np.log(axle.upper / axle.lower)[valid])
        assert half == pytest.approx(widths[(widths.size - 1) // 2], rel=1e-9)
    assert first["digest"] == wet.digest
    assert first["rms_error_by_method"]["estimate"]["front"] == passed.baselines["estimate"][0]
    limit = first["limits"][0]
    assert limit.pop("value") == passed.figures["valid_share"]
    assert limit == {"figure": "valid_share", "min": 0.7, "max": None, "warn": [None, None]} | {
        "passed": True,
        "warned": False,
    }
    assert summary["agreement"]["largest_departure_f"] == pytest.approx(0.0, abs=1e-9)


def test_pads_that_no_brake_has_are_not_valid(fitted):
    """The car said to be ten times as heavy, by the vehicle file of its table."""
    heavy = replace(fitted, vehicle=replace(fitted.vehicle, mass=10.0 * CAR.mass))
    (result,) = validate(heavy, [noisy(stop(REAL), 2)])
    assert not result.passed
    assert "no pad has such a friction" in result.refused


@pytest.mark.parametrize("logged", ["with v", "without v"])
def test_locked_wheels_fail(fitted, logged):
    """All wheels lock on a slippery road."""
    log = noisy(stop(replace(REAL, tyre=magic(25.0, 0.5)), 60e5, "locked"), 4)
    (locked,) = validate(fitted, [log if logged == "with v" else without(log, "v")])
    assert not locked.passed
    assert not locked.estimate.valid.any()
    assert [w.code for w in locked.warnings] == ["locked_wheels"]
    assert "a wheel locks, or ABS works" in locked.refused  # once they stand it is slow, too


def test_log_of_a_car_with_other_wheels(fitted, wet):
    """The same stop with wheels of 0.30 m turns 7 % faster."""
    faster = {f"omega_{w}": wet[f"omega_{w}"] * 0.322 / 0.30 for w in ("fl", "fr", "rl", "rr")}
    other = replace(wet, channels={**wet.channels, **faster})
    message = refused(fitted, other)
    assert "(rolling_radius_f)" in message
    assert "0.3 m" in message
    assert validate(fitted, [without(other, "v")])  # without v it cannot be told
