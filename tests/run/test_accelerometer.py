"""Scale, bias, grade and drag told apart: in runs worked out by hand, and of the plant's car."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.fitting.fit import fit
from calib.run.accelerometer import accelerometer, other_scale, speed_evidence
from calib.run.blocks import Blocks
from tests.support.reference_car import CAR, REAL, misread, noisy, ramp

STEP, COUNT, LEAD = 0.05, 160, 30
DENSITY_Z, DENSITY_V = 4e-3, 1.4e-3
RESIST = 0.015
TIME = STEP * np.arange(1, COUNT + 1)
BRAKED = TIME > STEP * LEAD


def run(seed=0, *, scale=0.0, bias=0.0, grade=0.0, drag=0.0, lag=0.0, noisy=True):
    """Blocks of 1.5 s of rolling and a stop at 0.4 g, and the deceleration that the tyres feel [1].

    a_x has an error of ``scale`` [1] and a ``bias`` [g]. The ``grade`` [g], downhill positive, is a
    number or one for each block. ``drag`` [g] adds to the known resistance while the car rolls. v
    is late by ``lag`` [s].
    """
    rng = np.random.default_rng(seed)
    felt = np.where(BRAKED, 0.4, RESIST + drag)
    speed = 35.0 - np.cumsum(G * (felt - grade)) * STEP
    per_block = noisy / np.sqrt(STEP)
    z = felt * (1.0 + scale) + bias + per_block * DENSITY_Z * rng.standard_normal(COUNT)
    late = speed + G * (felt - grade) * lag
    v = late + per_block * DENSITY_V * rng.standard_normal(COUNT)
    zero = np.zeros(COUNT)
    b = Blocks(
        end=TIME,
        p_f=np.where(BRAKED, 2e6, 0.0),
        p_r=np.where(BRAKED, 2e6, 0.0),
        drive_f=zero,
        drive_r=zero,
        z=z,
        omega_f=v / 0.3,
        omega_r=v / 0.3,
        v=v,
        speed=v,
        spin_f=zero,
        spin_r=zero,
        lead_in=~BRAKED,
        samples=10,
        length=STEP,
    )
    return b, felt


def estimated(b):
    """The accelerometer by the blocks, with the known resistance `RESIST`."""
    evidence = speed_evidence(b, DENSITY_Z, DENSITY_V)
    return accelerometer(evidence, b.z - RESIST, np.full(COUNT, 1e-3))


def other_scale_of(b):
    return other_scale(b, DENSITY_Z, DENSITY_V)


@pytest.mark.parametrize("scale", [-0.05, 0.05])
def test_a_scale_is_taken_out(scale):
    b, felt = run(scale=scale)
    sensor = estimated(b)
    assert sensor.corrected(felt * (1.0 + scale))[-1] == pytest.approx(0.4, rel=0.02)
    assert np.sqrt(sensor.variance_scale) < 0.012


@pytest.mark.parametrize("size", [-0.03, 0.03])
def test_a_bias_is_taken_out_and_a_grade_is_not(size):
    """Against v a bias looks like a grade; while rolling, a_x shows a bias, but no grade."""
    b, felt = run(bias=size)
    assert estimated(b).corrected(felt + size)[-1] == pytest.approx(0.4, rel=0.02)
    b, felt = run(grade=size)
    sensor = estimated(b)
    assert sensor.corrected(felt)[-1] == pytest.approx(0.4, rel=0.02)


def test_drag_on_the_lead_in_is_no_bias():
    """v slows as a_x says, so nothing is wrong with a_x."""
    sensor = estimated(run(drag=0.04)[0])
    assert abs(sensor.bias) < 0.008
    assert sensor.drag == pytest.approx(0.04, abs=0.01)


@pytest.mark.parametrize("lag", [-0.02, 0.02])
def test_v_that_is_late_is_no_scale(lag):
    """v is off by g z lag from the bite on: one step of 0.08 m/s and not a growing error."""
    sensor = estimated(run(lag=lag)[0])
    # 0.08 of the 30 m/s that the stop takes off would be a scale of 0.3 %, were it not for the lag
    assert abs(sensor.scale) < 2.0 * np.sqrt(sensor.variance_scale)
    assert abs(sensor.bias) < 0.003


def test_without_v_a_bias_and_a_drag_stay_in_doubt():
    b, _ = run(bias=0.03)
    with_v, without = estimated(b), estimated(replace(b, v=None))
    assert np.sqrt(without.variance_bias) > 2.0 * np.sqrt(with_v.variance_bias)
    assert np.sqrt(without.variance_scale) == pytest.approx(0.02, rel=0.02)


def test_the_sigma_is_that_of_the_errors():
    """120 runs with scales, biases, grades and drags as the priors have them."""
    rng = np.random.default_rng(5)
    inside = []
    for seed in range(120):
        hidden = {
            "scale": rng.normal(0.0, 0.02),
            "bias": rng.normal(0.0, 0.03) * (rng.random() < 0.15),
            "grade": rng.normal(0.0, 0.03) * (rng.random() < 0.3),
            "drag": rng.normal(0.0, 0.03) * (rng.random() < 0.15),
        }
        b, felt = run(seed, **hidden)
        sensor = estimated(b)
        read = felt * (1.0 + hidden["scale"]) + hidden["bias"]
        error = sensor.corrected(read) - felt
        inside.append(abs(error[-1]) < 1.96 * sensor.sigma(read)[-1])
    assert 0.9 < np.mean(inside) < 0.995


@pytest.mark.parametrize(("size", "turns"), [(-0.04, 0.6), (0.03, 0.8)])
def test_a_slope_that_changes_is_felt_by_the_tyres_and_is_no_scale(size, turns):
    b, felt = run(grade=size * np.sin(turns * TIME))
    sensor = estimated(b)
    assert sensor.walk_probability > 0.99
    assert sensor.disagreement > abs(size)
    error = (sensor.corrected(felt) - felt)[BRAKED][40:]
    assert np.mean(np.abs(error) < 1.96 * sensor.sigma(felt)[BRAKED][40:]) > 0.9
    assert np.all(np.abs(error) < 0.4 * 0.04)


def test_a_steady_slope_and_a_wrong_sensor_are_no_slope_that_changes():
    for hidden in ({}, {"grade": 0.03}, {"scale": 0.03}, {"bias": 0.03}, {"lag": 0.02}):
        assert estimated(run(**hidden)[0]).walk_probability < 0.3


@pytest.mark.parametrize("scale", [0.22, -0.15, -0.2, -0.3])
def test_a_scale_that_no_sensor_has_is_another_cause(scale):
    other = other_scale_of(run(1, scale=scale)[0])
    assert other / (1.0 - other) == pytest.approx(scale, abs=0.04)


@pytest.mark.parametrize("hidden", [{}, {"scale": 0.05}, {"grade": 0.15}, {"lag": 0.02}])
def test_what_a_sensor_or_a_road_has_is_no_other_cause(hidden):
    b, felt = run(**hidden)
    sensor = estimated(b)
    assert other_scale_of(b) == 0.0
    error = (sensor.corrected(b.z) - felt)[BRAKED][40:]
    assert abs(np.mean(error)) < 0.01  # a slope of 15 % is a slope


@pytest.fixture(scope="module")
def clean():
    return ramp(REAL)


@pytest.mark.parametrize(("scale", "offset"), [(1.05, 0.0), (0.95, 0.0), (1.0, 0.3), (1.0, -0.3)])
def test_pads_of_a_misread_ramp_are_those_of_the_plant(clean, scale, offset):
    for seed in range(2):
        c = fit(CAR, [misread(noisy(clean, seed), scale, offset)]).calibration
        for estimate in (c.pad_friction_f, c.pad_friction_r):
            assert abs(estimate.value - 0.38) < 3.0 * estimate.sigma
        assert c.pad_scale.value == pytest.approx(1.0, abs=0.02)
