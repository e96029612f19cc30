"""The estimator: causal, blind to truth, honest in its intervals, quiet where it knows nothing."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import WHEELS, G
from calib.estimation.baselines import METHODS
from calib.estimation.constants import Constants
from calib.estimation.estimator import estimate
from calib.estimation.known import known_resistance
from calib.estimation.reasons import Reason
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.model.sensor_noise import LEVELS, add_noise
from calib.run.blocks import BLOCK
from tests.studies import plant_r
from tests.support.made_runs import changed
from tests.support.plant import as_log, drive, magic
from tests.support.reference_car import (
    CAR,
    REAL,
    WET,
    covered,
    cut,
    noisy,
    ramp,
    stop,
    with_pads,
    without,
)


@pytest.fixture(scope="module")
def wet():
    return noisy(stop(WET, duration=12.0), 3)


@pytest.fixture(scope="module")
def result(fitted, wet):
    return estimate(fitted, wet)


def columns(e, until=None):
    """Everything the estimator says of each sample, up to a time [s]."""
    stop = None if until is None else int(np.searchsorted(e.time, until))
    out = {"z": e.signals.z, "eta": e.eta, "valid": e.valid, "braked": e.braked}
    out |= e.best.columns() | {f"force_{i}": force for i, force in enumerate(e.normalised)}
    for name, method in METHODS.items():
        front, rear = method(e)
        out |= {f"{name}.front": front, f"{name}.rear": rear}
    return {name: np.asarray(x[:stop], float) for name, x in out.items()}


def require_equal(result, expected, tolerance):
    for name, x in result.items():
        y = expected[name]
        assert np.array_equal(np.isnan(x), np.isnan(y)), name
        scale = max(1.0, np.nanmax(np.abs(x), initial=0.0))
        assert np.nanmax(np.abs(x - y), initial=0.0) <= tolerance * scale, name


def truth_inside(e, log):
    """Valid samples whose interval holds the true pad friction: shares of both axles."""
    out = []
    for side, axle in (("f", e.best.pads_f), ("r", e.best.pads_r)):
        mu = log.truth[f"true_mu_pad_{side}"]
        out.append(((axle.lower <= mu) & (mu <= axle.upper))[e.valid])
    return out


# Causal, and blind to what it must not see.


@pytest.mark.parametrize("last", [1.75, 4.013])
def test_the_future_changes_nothing(fitted, wet, result, last):
    early = estimate(fitted, cut(wet, 0.0, last))
    require_equal(columns(early), columns(result, early.time[-1] + 1e-9), 1e-12)


def test_one_later_sample_changes_nothing(fitted, wet, result):
    """Not the length of the log either: a wild last second under the same number of samples."""
    late = wet.time > 5.0
    wild = {f"omega_{w}": np.where(late, 0.9, 1.0) * wet[f"omega_{w}"] for w in WHEELS[:2]}
    wild |= {"a_x": np.where(late, -9.0, wet["a_x"]), "p_mc": np.where(late, 0.0, wet["p_mc"])}
    other = estimate(fitted, changed(wet, **wild))
    require_equal(columns(other, 5.0), columns(result, 5.0), 1e-12)
    assert not np.allclose(other.signals.z[-100:], result.signals.z[-100:])


def test_truth_is_never_read(fitted, wet, result):
    for truth in ({}, {name: np.full_like(x, 1e4) for name, x in wet.truth.items()}):
        require_equal(columns(estimate(fitted, replace(wet, truth=truth))), columns(result), 0.0)


# Right, at any rate and without v.


@pytest.mark.parametrize("rate", [40.0, 1000.0])
def test_rates_agree(fitted, rate):
    """The same stop without noise; between the samples of the slow clock nothing is known."""
    slow, usual = (estimate(fitted, stop(WET, rate=r)) for r in (rate, 200.0))
    for a, b in ((slow.best.pads_f, usual.best.pads_f), (slow.best.pads_r, usual.best.pads_r)):
        times = np.linspace(2.2, 6.5, 40)
        mu_a = np.interp(times, slow.time, a.value)
        mu_b = np.interp(times, usual.time, b.value)
        assert np.max(np.abs(mu_a / mu_b - 1.0)) < 0.01
        width = np.interp(times, usual.time, b.upper - b.lower)
        assert np.all(np.abs(mu_a - mu_b) < 0.25 * width)
    assert np.mean(slow.valid) == pytest.approx(np.mean(usual.valid), abs=0.02)


CHANGED = (0.31 / 0.38, 0.27 / 0.38)
"""Pads of WET over those of the ramp."""


# In doubt: the tyres, the accelerometer.


@pytest.mark.parametrize("ratio", [0.9, 1.1])
def test_tyres_that_differ_by_axle_are_in_the_interval(ratio):
    """Rear tyres 10 % softer or stiffer than the front ones, on the ramp and in the stops.

    Without v the interval of the rear pads is near the gate's: how much is valid is not promised.
    """
    plant = replace(REAL, rear_stiffness=ratio)
    table = fit(CAR, [noisy(ramp(plant), 1)])
    clean = stop(with_pads(plant, 0.31, 0.27))
    log = noisy(clean, 0)
    with_v, without_v = estimate(table, log), estimate(table, without(log, "v"))
    assert np.mean(with_v.valid) > 0.5
    assert np.any(without_v.valid)
    for e in (with_v, without_v):
        assert min(*covered(e, 0.31, 0.27), *covered(e, *CHANGED, "change")) >= 0.9


@pytest.mark.parametrize(("scale", "bias"), [(1.05, 0.0), (1.0, -0.3)])
def test_a_wrong_accelerometer_is_put_right_with_v(fitted, wet, scale, bias):
    """5 % of a_x or 0.3 m/s^2 not taken out would move the pads by 5 % and by 10 %."""
    e = estimate(fitted, changed(wet, a_x=scale * wet["a_x"] + bias))
    sensor = e.run.accelerometer(known_resistance(e.table), e.noise)
    assert sensor.scale == pytest.approx(1.0 - 1.0 / scale, abs=0.015)
    assert G * sensor.bias == pytest.approx(-bias, abs=0.05)
    assert min(covered(e, 0.31, 0.27)) > 0.9
    assert np.mean(e.best.pads_f.value[e.valid]) == pytest.approx(0.31, rel=0.03)


def test_without_v_it_works_and_promises_less(fitted, wet, result):
    log = without(wet, "v")
    e = estimate(fitted, log)
    assert e.slips is None
    assert np.mean(e.best.pads_f.value[e.valid]) == pytest.approx(0.31, rel=0.06)
    assert np.mean(np.concatenate(truth_inside(e, log))) > 0.85
    late = slice(-400, -200)
    for name in ("pads_f", "pads_r"):
        answers = getattr(e.best, name), getattr(result.best, name)
        without_v, with_v = (np.mean((x.upper - x.lower)[late]) for x in answers)
        assert without_v > with_v


def test_a_change_of_road_leaves_the_pads(fitted):
    """From the table's road onto one that peaks at little more than half."""
    dry = with_pads(REAL, 0.36, 0.36)
    plant = replace(dry, surface=lambda x: (1.0, 1.0) if x < 85.0 else (0.95, 0.55))
    e = estimate(fitted, noisy(stop(plant, pressure=24e5), 0))
    assert min(covered(e, 0.36, 0.36)) > 0.8


def test_dry_roads_are_left_alone(fitted):
    """Nominal pads on a stiffer, higher road: torque never worse than nominal by 2 % of it."""
    log = noisy(stop(replace(REAL, tyre=magic(27.0, 1.0)), pressure=32e5), 0)
    e = estimate(fitted, log)
    for a, axle in (("f", e.best.torque_f), ("r", e.best.torque_r)):
        true, mu = log.truth[f"true_Tb_{a}l"], log.truth[f"true_mu_pad_{a}"]
        scale = np.sqrt(np.mean(true[e.valid] ** 2))
        error = np.sqrt(np.mean((axle.value - true)[e.valid] ** 2)) / scale
        nominal_error = np.sqrt(np.mean((0.38 / mu - 1.0)[e.valid] ** 2))
        assert error < nominal_error + 0.02


def test_a_small_ensemble_is_held_by_its_intervals():
    """Two cars that nobody tuned for, on roads and pads drawn at random."""
    is_inside, shares = [], []
    for number in range(2):
        case = plant_r.drawn(5, number)
        table = fit(case.vehicle, [case.ramp])
        for drawn in case.stops:
            e = estimate(table, drawn.log)
            is_inside += truth_inside(e, drawn.log)
            if drawn.surface != "tile":
                counted = e.braked & (e.signals.speed > 3.0)
                shares.append(np.mean(e.valid[counted]))
    assert np.mean(np.concatenate(is_inside)) >= 0.85
    assert min(shares) >= 0.70


# The gates: where it does not stand behind its answer.


def test_settled_braking_is_valid_and_the_lead_in_is_not(result):
    # in whole blocks: that in which the brake is applied counts
    assert not np.any(result.valid[result.time < 1.5 + Constants.settle - BLOCK])
    assert np.all(
        result.valid[(result.time > 1.5 + Constants.settle + BLOCK) & (result.time < 2.2)]
    )
    steady = (result.time > 2.2) & (result.signals.speed > 4.0)
    assert np.all(result.valid[steady])
    assert np.min(result.signals.speed) < 2.0
    assert not np.any(result.valid[result.signals.speed < 2.7])  # of the last whole block


def test_steering_gate(fitted, wet):
    degrees = np.where((wet.time > 3.0) & (wet.time < 4.0), 12.0, 1.0)
    e = estimate(fitted, changed(wet, steering=-np.deg2rad(degrees)))
    assert not np.any(e.valid[(e.time > 3.05) & (e.time < 4.0)])
    assert np.all(e.valid[(e.time > 2.3) & (e.time < 3.0)])
    assert np.all(e.valid[(e.time > 4.2) & (e.time < 6.0)])


def with_bend(log, lateral, first, last):
    """The log with a bend of ``lateral`` v^2/R [m/s^2], left positive, between two times [s].

    The outer wheels run on a circle of R + b/2, the inner ones of R - b/2; the outer ones carry
    2 h/(g b) of the lateral acceleration more of their load and slip less by as much.
    """
    inside = (log.time > first) & (log.time < last)
    half = np.where(inside, 0.5 * CAR.track_width * lateral / log["v"] ** 2, 0.0)
    more = np.where(inside, 2.0 * CAR.cg_height * lateral / (G * CAR.track_width), 0.0)
    wheels = {}
    for axle, radius in (("f", CAR.front.rolling_radius), ("r", CAR.rear.rolling_radius)):
        for side, sign in (("l", -1.0), ("r", 1.0)):
            slip = 1.0 - log[f"omega_{axle}{side}"] * radius / log["v"]
            speed = log["v"] / radius * (1.0 + sign * half)
            wheels[f"omega_{axle}{side}"] = speed * (1.0 - slip / (1.0 + sign * more))
    return changed(log, **wheels)


def test_bend_gate(fitted, wet):
    """Half as much again as the gate is a bend; half of the gate is the way round a patch."""
    e = estimate(fitted, with_bend(wet, -1.5 * Constants.lateral, 3.0, 4.0))
    # the wheels are compared over 0.2 s: ln(3) of it until two thirds of the bend show
    assert not np.any(e.valid[(e.time > 3.0 + 0.3) & (e.time < 4.0)])
    assert np.mean(e.valid[(e.time > 2.3) & (e.time < 3.0)]) > 0.98
    assert np.mean(e.valid[(e.time > 4.4) & (e.time < 6.0)]) > 0.98
    mild = estimate(fitted, with_bend(wet, -0.5 * Constants.lateral, 3.0, 4.0))
    assert np.mean(mild.valid[(e.time > 2.3) & (e.time < 6.0)]) > 0.98


@pytest.mark.parametrize("wheel", ["fl", "rr"])
def test_abs_gate(fitted, wet, wheel):
    """A wheel dips by 40 % for 0.1 s at a time; after the last dip the answer is not trusted."""
    cycle = (wet.time > 3.0) & (wet.time < 4.0) & ((wet.time * 4.0) % 1.0 < 0.4)
    hit = np.where(cycle, 0.6, 1.0) * wet[f"omega_{wheel}"]
    e = estimate(fitted, changed(wet, **{f"omega_{wheel}": hit}))
    assert not np.any(e.valid[(e.time > 3.05) & (e.time < 4.5)])
    assert np.all(e.valid[(e.time > 2.3) & (e.time < 2.99)])
    for axle in (e.best.pads_f, e.best.pads_r):
        assert np.all(np.isfinite(axle.value[e.time > 2.0]))


def test_spikes_of_one_sample_are_no_abs(fitted, wet, result):
    hit = np.array(wet["omega_rr"])
    hit[40::300] *= 0.5
    e = estimate(fitted, changed(wet, omega_rr=hit))
    assert not np.any(e.best.step.reason == Reason.LOCKED)
    assert np.mean(e.valid) > 0.9 * np.mean(result.valid)


# What the estimate starts from.


def test_the_change_is_over_the_ramp_and_not_over_the_file(fitted, wet, result):
    """A file that says other pads, of the same ratio, changes nothing of it."""
    sides = {a: replace(getattr(CAR, a), pad_friction=0.5) for a in ("front", "rear")}
    e = estimate(fitted, wet, replace(CAR, **sides))
    late = e.valid & (e.time > 3.0)
    for name in ("change_f", "change_r"):
        change, expected = getattr(e.best, name).value, getattr(result.best, name).value
        assert change[late] == pytest.approx(expected[late], rel=0.02)


# Tyres and brakes that act late.


@pytest.fixture(scope="module")
def quick():
    """A fast pedal on tyres with 0.5 m of relaxation, on basalt, the rear pads 15 % worse."""
    ratio = math.exp(0.5 * 0.15)
    front, rear = (0.7 * a.pad_friction * k for a, k in ((CAR.front, ratio), (CAR.rear, 1 / ratio)))
    plant = replace(with_pads(REAL, front, rear), relaxation=0.5, surface=lambda x: (0.95, 0.55))
    run = drive(plant, lambda t: 90e5 * min(max(t - 1.5, 0.0), 0.31), 20.0, duration=6.0)
    levels = {name: replace(level, sd=0.3 * level.sd) for name, level in LEVELS.items()}
    return add_noise(as_log(run, "quick"), 3, levels)


def test_a_fast_pedal_on_soft_tyres_is_no_change_of_the_pads(fitted, quick):
    """Slip leads the force by sigma/v. Who takes the tyre for stiff finds worse rear pads."""
    e = estimate(fitted, quick)
    assert all(np.mean(inside) > 0.95 for inside in truth_inside(e, quick))


def test_rear_pressure_that_is_held_is_estimated_where_wheel_pressures_are_logged(fitted):
    """The front axle carries more than on the ramp: past its greatest force, and still right."""

    def pedal(t):
        return 45e5 * min(max((t - 1.5) / 0.25, 0.0), 1.0)

    def rear(t):
        return min(pedal(t), 8e5)

    wheel_pressures = {"fl": pedal, "fr": pedal, "rl": rear, "rr": rear}
    run = drive(REAL, pedal, 27.0, duration=9.0, stop_speed=1.5, wheel_pressure=wheel_pressures)
    (result,) = validate(fitted, [noisy(as_log(run, "held"), 1)])
    # the ECU has the pressure of the master cylinder alone, and is wrong
    failed = {judged.figure for judged in result.judgements if judged.verdict == "failed"}
    assert "ecu_reference_f" in failed
    assert all(figure.startswith("ecu_") for figure in failed)
    assert result.figures["valid_share"] > 0.9
    e = result.estimate
    assert np.max(e.normalised[0][e.valid]) > fitted.tyre.force[-1]
    assert min(covered(e)) > 0.95


def test_slips_are_counted_from_free_rolling(fitted):
    """As the plant has them, with the 0.04 % that rolling resistance makes before any braking."""
    log = stop(REAL)
    e = estimate(fitted, log)
    for a, slip, scale in (("f", e.slips[0], 1.0), ("r", e.slips[1], 1.0008)):
        rim = 0.322 * scale * 0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"])
        true = 1.0 - rim / log["v"]
        assert true[0] > 4e-4
        assert slip == pytest.approx(true, abs=5e-5)


def test_a_car_that_stands_at_the_end_changes_nothing(fitted, wet, result):
    """Wheel speeds of exactly nought: no eta, no slip, no warning."""
    moving = cut(wet, 0.0, 9.0)
    still = {k: np.zeros(400) for k in moving.channels}
    still["p_mc"] += moving["p_mc"][-1]
    still["time"] = moving.time[-1] + moving.sample_time * np.arange(1, 401)
    channels = {k: np.concatenate([x, still[k]]) for k, x in moving.channels.items()}
    e = estimate(fitted, replace(moving, channels=channels, truth={}))
    require_equal(columns(e, 8.99), columns(result, 8.99), 1e-12)
    assert not np.any(e.valid[e.time > 9.05])
    assert np.all(np.isfinite(e.eta))
