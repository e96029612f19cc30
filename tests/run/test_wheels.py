"""Wheels that disagree by a known amount, and columns of two wheels that are exchanged."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import WHEELS
from calib.plausibility.rules import PURPOSES
from calib.run import wheels
from calib.run.driving_record import driving_record
from calib.run.exchanged_wheels import crossed_diagonal, crossed_side, wheel_parts
from calib.run.wheels import mismatch
from tests.studies.made_lines import PAIRS, exchanged, in_bend, line, recorded, with_brakes
from tests.support.made_runs import RADIUS, SLIP_F, SLIP_R, changed, made_run, ramp, stop, with_slip
from tests.support.refusals import why_not

STOPPED = made_run(stop())


def axles_of(log):
    driving = driving_record(log)
    return wheels.axles_of(log, driving, wheels.slips_of(log, driving))


def slip_of(log):
    driving = driving_record(log)
    return wheels.slipping(wheels.slips_of(log, driving), driving)


def parts_of(log):
    return wheel_parts(log, driving_record(log))


def test_interval_holds_the_truth_as_often_as_it_says():
    rng = np.random.default_rng(1)
    inside = 0
    for _ in range(400):
        a, b = (80.0 + 0.05 * rng.normal(size=400) for _ in range(2))
        result = mismatch(a, 1.001 * b, np.ones(400, bool), 0.005)
        inside += abs(result.value - 0.001) < result.half
    assert 0.92 < inside / 400 < 0.98
    assert mismatch(np.ones(100), np.ones(100), np.ones(100, bool), 0.005) is None


def test_radii_front_rear_and_left_right():
    log = made_run(ramp(start=4.0), duration=8.0)
    factors = {"omega_rl": 1.002, "omega_rr": 1.002, "omega_fr": 1.010}
    axles = axles_of(changed(log, **{w: factor * log[w] for w, factor in factors.items()}))
    assert axles.front_rear.value == pytest.approx(1.002 / 1.005 - 1, abs=3e-5)
    assert axles.left_right_f.value == pytest.approx(0.010, abs=3e-5)
    assert axles.left_right_r.value == pytest.approx(0.0, abs=3e-5)
    assert axles.front_rear.half < 1e-4


def test_eta_while_braked():
    axles = axles_of(made_run(stop(level=28.0)))  # 0.4 g
    expected = (1 - 0.4 * SLIP_R) / (1 - 0.4 * SLIP_F) - 1
    assert axles.eta_braked.value == pytest.approx(expected, rel=0.02)


def test_eta_that_falls_again_is_seen_where_its_mean_is_zero():
    """Eta - 1 = 0.04 z (0.37 - z), over a ramp of 0.1 g/s up to 0.49 g: its means by integrals."""
    log = made_run(ramp(rate=7.0, top=35.0), duration=6.4, noise=0.0)
    z = 0.1 * np.clip(log.time - 1.5, 0.0, None)
    rear = {f"omega_r{s}": log[f"omega_f{s}"] * (1.0 + 0.04 * z * (0.37 - z)) for s in "lr"}
    axles = axles_of(changed(log, **rear))
    assert abs(axles.eta_braked.value) < 3e-4  # 0.6e-4 from 0.20 to 0.49 g
    assert axles.eta_most.value == pytest.approx(13.0e-4, abs=1e-4)  # 0.10 to 0.23 g


@pytest.mark.parametrize("rate", [40.0, 1000.0])
def test_slope_is_the_rolling_radius(rate):
    log = made_run(ramp(rate=8.0), rate=rate)
    assert axles_of(log).slope == pytest.approx(RADIUS, rel=0.03)
    assert axles_of(changed(log, a_x=-log["a_x"])).slope == pytest.approx(-RADIUS, rel=0.03)
    assert axles_of(made_run(lambda t: 0.0 * t)).slope is None


@pytest.mark.parametrize("locks_after", [0.6, 2.5])
def test_locked_wheels_do_not_make_another_radius(locks_after):
    """The wheels stop within 0.3 s while the car goes on: no radius, or that of the time before."""
    log = made_run(stop(level=28.0))
    start = log.time[np.argmax(log["p_mc"] > 2e5)] + locks_after
    turning = np.clip(1.0 - (log.time - start) / 0.3, 0.0, 1.0)
    log = changed(log, **{f"omega_{w}": turning * log[f"omega_{w}"] for w in WHEELS})
    slope = axles_of(log).slope
    assert slope is None or slope == pytest.approx(RADIUS, rel=0.2)


@pytest.mark.parametrize("v", [True, False])
def test_abs_on_one_wheel_and_on_all(v):
    result = slip_of(with_slip(STOPPED, ["fl"], 3.0, 0.4, 0.25, v))
    assert result.cycles == (("fl", pytest.approx(3.0, abs=0.06)),)
    assert result.locked == ()
    on_all = slip_of(with_slip(STOPPED, WHEELS, 3.0, 0.4, 0.25, v=v))
    assert len(on_all.cycles) == (4 if v else 0)


def dipped(times, depth=0.08):
    """The stop with a number of half waves of slip, 0.1 s long, on both front wheels."""
    phase = 2.0 * np.pi * 5.0 * np.clip(STOPPED.time - 3.0, 0.0, 0.2 * times)
    keep = 1.0 - depth * np.maximum(np.sin(phase), 0.0)
    return changed(STOPPED, **{w: keep * STOPPED[w] for w in ("omega_fl", "omega_fr")})


@pytest.mark.parametrize(("times", "cycles"), [(1, 0), (2, 0), (5, 5)])
def test_abs_that_lets_wheels_slip_a_little_is_seen_by_how_often(times, cycles):
    assert len(slip_of(dipped(times)).cycles) == 2 * cycles


def spiked(share):
    """The stop with single samples of a wheel speed that are far too low."""
    wild = np.random.default_rng(5).random(STOPPED.time.size) < 0.01
    wild[1:] &= ~wild[:-1]
    return changed(STOPPED, omega_fr=np.where(wild, share, 1.0) * STOPPED["omega_fr"])


@pytest.mark.parametrize(
    "log",
    [
        with_slip(STOPPED, ["fl"], 3.0, 0.4, 0.10),
        with_slip(STOPPED, ["fl"], 3.0, 2.5, 0.25),
        spiked(0.0),
        changed(spiked(0.5), v=None),
        made_run(ramp()),
        STOPPED,
    ],
    ids=["mild", "slow", "spikes", "spikes without v", "ramp", "stop"],
)
def test_mild_slow_or_single_slips_are_no_abs(log):
    assert slip_of(log).cycles == slip_of(log).locked == ()


def test_locked_wheel():
    locked = np.where(STOPPED.time > 3.0, 0.0, STOPPED["omega_rl"])
    assert slip_of(changed(STOPPED, omega_rl=locked)).locked == ("rl",)


def test_the_three_parts_of_a_closed_form():
    """Slips of 1.2 % per g in front and 0.7 % behind, left and right alike."""
    parts, z = parts_of(made_run(stop(level=20.0))), 20.0 / 70.0
    assert parts.axles.value == pytest.approx((SLIP_F - SLIP_R) * z, rel=0.03)
    assert abs(parts.sides.value) < 3.0 * parts.sides.half
    assert abs(parts.diagonals.value) < 3.0 * parts.diagonals.half
    assert parts.z == pytest.approx(z, rel=0.1)


@pytest.fixture(scope="module")
def car():
    return line(np.random.default_rng(4), 4)


@pytest.fixture(scope="module")
def plain(car):
    return recorded("stop_1", car.runs["stop_1"], car.sensors)


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_each_pair_of_exchanged_wheels_is_named(plain, pair):
    expected = parts_of(plain).axles.value
    log = exchanged(plain, pair)
    side, diagonal = crossed_side(parts_of(log)), crossed_diagonal(parts_of(log), expected)
    of_one_side = pair[0][1] == pair[1][1]
    result, other = (side, diagonal) if of_one_side else (diagonal, side)
    assert result.wheels == pair
    assert other is None
    refused = ["wheels_crossed_side" in why_not(log, purpose) for purpose in PURPOSES]
    assert all(refused) if of_one_side else not any(refused)


@pytest.mark.parametrize("kind", ["plain", "bend", "weak caliper", "uneven brakes", "small wheel"])
def test_a_bend_or_an_uneven_brake_is_no_exchange(car, plain, kind):
    run, expected = car.runs["stop_1"], parts_of(plain).axles.value
    log = {
        "plain": lambda: plain,
        "bend": lambda: recorded("stop_1", in_bend(run, 150.0, 1.5), car.sensors),
        "weak caliper": lambda: recorded("stop_1", with_brakes(run, fl=0.5), car.sensors),
        "uneven brakes": lambda: recorded("stop_1", with_brakes(run, fl=1.1, rr=1.1), car.sensors),
        "small wheel": lambda: replace(
            plain, channels={**plain.channels, "omega_rl": 1.01 * plain["omega_rl"]}
        ),
    }[kind]()
    assert crossed_side(parts_of(log)) is None
    assert crossed_diagonal(parts_of(log), expected) is None
