"""What is warned about, by numbers set by hand and by a plant with one thing wrong."""

import json
from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.names import G
from calib.signals.accelerometer import Accelerometer
from calib.validation.validate import to_dict, validate
from calib.validation.warnings import PlausibilityWarning, warnings_of
from tests.support.reference_car import CAR, REAL, WET, noisy, stop, with_pads
from tests.validation.test_metrics import made_estimate

BLOCKS = 100


def sensor(**values):
    """An accelerometer that is right, but for ``values``; sigma 0.1 % and 0.0005 g."""
    fields = dict.fromkeys(("scale", "bias", "covariance", "grade", "drag"), 0.0)
    fields |= {"variance_scale": 1e-6, "variance_bias": 2.5e-7, **values}
    return Accelerometer(**{name: np.full(BLOCKS, value) for name, value in fields.items()})


def codes(estimate):
    return [warning.code for warning in warnings_of("log", estimate)]


def test_a_sensor_that_is_right_and_like_pads_are_not_warned_about():
    assert codes(made_estimate(mu_r=0.40, accelerometer=sensor())) == []


@pytest.mark.parametrize(
    ("wrong", "code", "measured"),
    [
        ({"scale": 0.04}, "a_x_scale", 0.04 / 0.96),
        ({"scale": -0.04}, "a_x_scale", -0.04 / 1.04),
        ({"bias": 0.03}, "a_x_offset", -0.03 * G),
        ({"bias": -0.03}, "a_x_offset", 0.03 * G),
        ({"drag": 0.03}, "unexplained_drag", 0.03 * G),
    ],
)
def test_a_wrong_sensor_is_named_with_what_was_measured(wrong, code, measured):
    """a_x is -g z: an offset of z has the other sign."""
    (warning,) = warnings_of("log", made_estimate(mu_r=0.40, accelerometer=sensor(**wrong)))
    assert warning.code == code
    assert warning.measured == pytest.approx(measured)
    assert not warning.expected[0] <= warning.measured <= warning.expected[1]
    assert warning.causes
    assert warning.do


def test_what_is_not_sure_is_not_warned_about():
    assert (
        codes(made_estimate(mu_r=0.4, accelerometer=sensor(scale=0.04, variance_scale=9e-4))) == []
    )
    unsure = sensor(bias=0.03, variance_bias=1.6e-3)
    assert codes(made_estimate(mu_r=0.4, accelerometer=unsure)) == []


def test_pads_that_changed_apart_are_named_where_something_is_valid():
    """Fields `change` of the made estimate are its pads: 0.44 over 0.36."""
    e = made_estimate(0.44, 0.36, accelerometer=sensor())
    sure = replace(e, split=replace(e.split, change_sigma=np.full(BLOCKS, 0.05)))
    (warning,) = warnings_of("log", sure)
    assert warning.code == "pads_changed_apart"
    assert warning.measured == pytest.approx(0.44 / 0.36 - 1.0)
    vague = replace(e, split=replace(e.split, change_sigma=np.full(BLOCKS, 0.2)))
    assert codes(vague) == []
    assert codes(replace(sure, valid=np.zeros_like(e.valid))) == []


def test_a_warning_is_one_sentence_that_names_the_log_and_the_causes():
    warning = PlausibilityWarning(
        "a_x_scale", "stop_3", 0.05, (-0.02, 0.02), ("one", "two"), "do x"
    )
    assert (
        str(warning)
        == "stop_3: a_x_scale is 0.05, expected -0.02 to 0.02; likely one, or two; do x"
    )


# On the plant


@pytest.fixture(scope="module")
def clean():
    return stop(REAL)


def misread(log, scale=1.0, offset=0.0):
    return replace(log, channels={**log.channels, "a_x": scale * log["a_x"] + offset})


@pytest.mark.parametrize("seed", range(4))
def test_a_clean_stop_is_not_warned_about(fitted, clean, seed):
    assert codes(estimate(fitted, noisy(clean, seed))) == []


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("scale", [0.92, 1.08])
def test_a_scale_of_a_x_is_named_and_measured(fitted, clean, seed, scale):
    found = warnings_of("log", estimate(fitted, misread(noisy(clean, seed), scale)))
    (warning,) = [one for one in found if one.code == "a_x_scale"]
    assert warning.measured == pytest.approx(scale - 1.0, abs=0.025)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("offset", [-0.4, 0.4])
def test_an_offset_of_a_x_is_named_and_measured(fitted, clean, seed, offset):
    found = warnings_of("log", estimate(fitted, misread(noisy(clean, seed), offset=offset)))
    (warning,) = [one for one in found if one.code == "a_x_offset"]
    assert warning.measured == pytest.approx(offset, abs=0.1)


def test_pads_wet_on_one_axle_are_named(fitted):
    log = noisy(stop(with_pads(REAL, 0.38, 0.24)), 3)
    found = warnings_of("log", estimate(fitted, log))
    (warning,) = [one for one in found if one.code == "pads_changed_apart"]
    assert warning.measured == pytest.approx(0.38 / 0.24 - 1.0, rel=0.3)


def test_the_summary_holds_the_warnings_with_their_log(fitted, clean):
    log = replace(misread(noisy(clean, 0), 1.08), name="wrong")
    results = validate(fitted, [replace(noisy(clean, 1), name="right"), log], CAR)
    summary = json.loads(json.dumps(to_dict("sedan@1", results), allow_nan=False))
    assert summary["warnings"]
    assert {one["log"] for one in summary["warnings"]} == {"wrong"}
    first = next(one for one in summary["warnings"] if one["code"] == "a_x_scale")
    assert set(first) == {"code", "log", "measured", "expected", "causes", "do"}
    assert first["expected"] == [-0.02, 0.02]


# The answer that is sharp


@pytest.mark.parametrize("seed", range(3))
def test_change_of_the_pads_is_held_by_its_interval(fitted, seed):
    """0.38 all round on the ramp, 0.31 and 0.27 in the stop."""
    e = estimate(fitted, noisy(stop(WET), seed))
    for axle, true in ((e.front, 0.31 / 0.38), (e.rear, 0.27 / 0.38)):
        held = (axle.change_lower <= true) & (true <= axle.change_upper)
        assert np.mean(held[e.valid]) >= 0.9
