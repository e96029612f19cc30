"""Every figure against what it must be by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from calib.base.intervals import Z95
from calib.estimation.estimator import Estimate
from calib.estimation.metrics import METRICS, departure, score, truth_of
from calib.estimation.readout import Bounded, Readout
from calib.estimation.reasons import Reason
from calib.estimation.step import Answer
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.blocks import Blocks
from calib.run.noise import SensorNoise
from tests.support.reference_car import CAR
from tests.support.tables import made_table

N = 1000
TIME = np.arange(N) / 200.0
GAIN_F, GAIN_R = 2 * 28.84e-4 * 0.1309, 2 * 11.34e-4 * 0.1240
"""(3) of Table I, both pad faces [m^3]."""


SIGMA = 0.02
"""Standard deviation of ln of all answers, if a test gives no other."""


def bounded(value, sigma=SIGMA):
    """A quantity with its 95 % interval, all of it log-normal."""
    value = np.broadcast_to(np.asarray(value, float), (N,)).copy()
    return Bounded(value, value * np.exp(-Z95 * sigma), value * np.exp(Z95 * sigma))


def readout(mu_f=0.40, mu_r=0.36, *, pressure=20e5, sigma=SIGMA, valid=None, innovation=None):
    """What the step says of pads ``mu_f``, ``mu_r``; those of the file are 0.38."""
    torque_f, torque_r = mu_f * GAIN_F * pressure, mu_r * GAIN_R * pressure
    level = (torque_f + torque_r) / (0.38 * (GAIN_F + GAIN_R) * pressure)
    reason = np.full(N, Reason.VALID) if valid is None else np.where(valid, 0, Reason.SLOW)
    bounded_values = {
        "level": level, "pads_f": mu_f, "pads_r": mu_r, "change_f": mu_f / 0.38,
        "change_r": mu_r / 0.38, "torque_f": torque_f, "torque_r": torque_r,
        "torque_sum": 2.0 * (torque_f + torque_r), "ratio": np.divide(mu_f, mu_r),
    }  # fmt: skip
    answer = {"innovation": np.zeros(N) if innovation is None else np.repeat(innovation, N // 100)}
    answer["ratio"] = np.log(np.broadcast_to(bounded_values["ratio"], (3, N)))
    answer |= {"zero_eta": np.ones(N), "reason": reason}
    return Readout(
        inputs=None,
        step=Answer(**dict.fromkeys(Answer._fields, np.zeros(N)) | answer),
        **{k: bounded(x, sigma) for k, x in bounded_values.items()},
    )


def made_estimate(mu_f=0.40, mu_r=0.36, *, pressure=20e5, valid=None, innovation=None, force=0.1,
                  speed=None, **changed):  # fmt: skip
    """5 s of braking at 0.3 g and 20 m/s; blocks of 50 ms, all braked."""
    blocks = 100
    ones, flat = np.ones(blocks), np.ones(N)
    noise = np.random.default_rng(0).standard_normal(blocks) if innovation is None else innovation
    best = readout(mu_f, mu_r, pressure=pressure, valid=valid, innovation=noise)
    load = 2.0 * best.torque_f.value / CAR.front.rolling_radius / force
    means = Blocks(
        end=TIME[9::10], p_f=ones, p_r=ones, drive_f=ones, drive_r=ones, z=ones,
        omega_f=ones, omega_r=ones, v=None, speed=20.0 * ones, spin_f=ones, spin_r=ones,
        lead_in=ones < 0.0, samples=10, length=0.05,
    )  # fmt: skip
    values = {
        "table": made_table(),
        "car": CAR,
        "run": SimpleNamespace(blocks=means),
        "corrected": SimpleNamespace(factor_f=1.0, factor_r=1.0, log=BLIND),
        "signals": Signals(
            time=TIME, p_f=pressure * flat, p_r=pressure * flat, drive_f=0.0 * flat,
            drive_r=0.0 * flat, z=0.3 * flat, omega_f=flat, omega_r=flat, v=None,
            speed=20.0 * flat if speed is None else speed, lead_in=flat < 0.0, sample_time=0.005,
        ),
        "forces": SimpleNamespace(
            active=flat > 0.0,
            balance=SimpleNamespace(drag_f=0.0, drag_r=0.0, load_f=load, load_r=load),
        ),
        "best": best,
        "ecu": readout(mu_f, mu_r, pressure=pressure),
        "noise": SensorNoise(4e-4, 1e-4, 3e-4, 1e-3),
    }  # fmt: skip
    return Estimate(**(values | changed))


def with_blocks(estimate, **changed):
    """The estimate with other means."""
    return replace(estimate, run=SimpleNamespace(blocks=replace(estimate.run.blocks, **changed)))


def truth_log(mu_f=0.40, mu_r=0.36, *, pressure=20e5, pads=True):
    """A log whose truth is known."""
    truth = {}
    for side, mu, gain in (("f", mu_f, GAIN_F), ("r", mu_r, GAIN_R)):
        for k in "lr":
            truth[f"true_Tb_{side}{k}"] = np.broadcast_to(mu * gain * pressure, (N,)).copy()
        if pads:
            truth[f"true_mu_pad_{side}"] = np.broadcast_to(np.asarray(mu, float), (N,)).copy()
    return Log("made", "made.csv", "0" * 64, {"time": TIME}, truth=truth)


def read_from(estimate, log):
    """The estimate as if it came of this log."""
    return replace(estimate, corrected=SimpleNamespace(factor_f=1.0, factor_r=1.0, log=log))


def scored(estimate, log=None):
    return score(read_from(estimate, truth_log() if log is None else log))


BLIND = replace(truth_log(), truth={})
LEVEL = (0.40 * GAIN_F + 0.36 * GAIN_R) / (0.38 * (GAIN_F + GAIN_R))
WIDTH = np.sinh(Z95 * SIGMA)
"""Half width of an interval over its middle."""


def test_a_perfect_estimate():
    figures = scored(made_estimate())
    for name in ("torque_error", "pad_friction_bias", "final_error", "pad_friction_drift"):
        assert figures[f"{name}_f"] == pytest.approx(0.0, abs=1e-12)
        assert figures[f"{name}_r"] == pytest.approx(0.0, abs=1e-12)
    for name in ("truth_in_interval", "valid_share", "covered_share", "ecu_valid_share"):
        assert figures[name] == 1.0
    for prefix in ("", "ecu_", "true_"):
        assert figures[f"{prefix}pad_friction_f"] == pytest.approx(0.40)
        assert figures[f"{prefix}pad_friction_r"] == pytest.approx(0.36)
        assert figures[f"{prefix}pad_level"] == pytest.approx(LEVEL)
    for side in ("f", "r", "level"):
        assert figures[f"interval_{side}"] == pytest.approx(WIDTH)
        assert figures[f"ecu_interval_{side}"] == pytest.approx(WIDTH)
        assert figures[f"ecu_normalised_error_{side}"] == pytest.approx(0.0, abs=1e-9)
    names = {name for name, value in figures.items() if value is not None}
    assert set(METRICS) - names == {"ecu_reference_f", "ecu_reference_r"}


def test_errors_are_relative_and_by_axle():
    """Front 3 % too high, inside the bounds of 4 %, rear 10 % too low, everywhere."""
    figures = scored(made_estimate(0.40 * 1.03, 0.36 * 0.90))
    for side, error in (("f", 0.03), ("r", 0.10)):
        assert figures[f"torque_error_{side}"] == pytest.approx(error)
        assert figures[f"pad_friction_bias_{side}"] == pytest.approx(error)
        assert figures[f"final_error_{side}"] == pytest.approx(error)
    assert figures["truth_in_interval"] == pytest.approx(0.5)


def test_drift_compares_the_last_with_the_first_third():
    mu = np.repeat([0.40, 0.45, 0.36], [333, 334, 333])
    figures = scored(made_estimate(mu, 0.36), BLIND)
    assert figures["pad_friction_drift_f"] == pytest.approx(0.10)
    assert figures["pad_friction_drift_r"] == pytest.approx(0.0)
    assert figures["pad_friction_f"] == pytest.approx(np.mean(mu))


def test_shares_count_braked_samples_above_3_metres_a_second():
    valid = np.zeros(N, bool)
    valid[200:500] = True
    pressure = np.where(np.arange(N) >= 100, 20e5, 1e5)
    speed = np.where(np.arange(N) < 700, 20.0, 2.0)
    covered = np.arange(N) < 300
    force = np.where(covered, 0.9, 1.1) * made_table().tyre.force[-1]
    e = made_estimate(valid=valid, pressure=pressure, speed=speed, force=force)
    figures = scored(e, BLIND)
    assert figures["valid_share"] == pytest.approx(300 / 600)
    assert figures["covered_share"] == pytest.approx(100 / 300, abs=0.06)  # the load is smoothed


def test_true_pads_follow_from_torque_and_pressure():
    log = truth_log(0.33, 0.29, pads=False)
    front, rear = truth_of(read_from(made_estimate(), log)).pad_friction
    assert front == pytest.approx(np.full(N, 0.33))
    assert rear == pytest.approx(np.full(N, 0.29))
    # below a bar there is nothing to divide by
    low = truth_of(read_from(made_estimate(pressure=0.5e5), log))
    assert np.all(np.isnan(low.pad_friction[0]))


def test_innovation_is_that_of_what_was_measured_after_the_lead_in():
    measured = 0.8 * np.random.default_rng(3).standard_normal(40)
    e = made_estimate(innovation=np.concatenate([np.full(50, 9.0), measured, np.full(10, np.nan)]))
    figures = scored(with_blocks(e, lead_in=np.arange(100) < 50), BLIND)
    assert figures["innovation_rms"] == pytest.approx(np.sqrt(np.mean(measured**2)))
    assert figures["innovation_colour"] == pytest.approx(np.mean(measured[1:] * measured[:-1]))


def test_a_truth_of_nought_is_no_proof():
    log = truth_log()
    figures = scored(made_estimate(), replace(log, truth={name: np.zeros(N) for name in log.truth}))
    for name in ("torque_error_f", "pad_friction_bias_r", "final_error_f"):
        assert figures[name] is None
    assert figures["ecu_normalised_error_f"] is None
    assert figures["ecu_normalised_error_level"] is None


# What is handed out.


def with_speed(e):
    return with_blocks(e, v=20.0 * np.ones(100))


def test_the_ecu_is_scored_over_its_own_valid_samples():
    valid = np.arange(N) < 600
    mu = np.where(valid, 0.40, 0.90)
    e = made_estimate(ecu=readout(mu, 0.36, valid=valid), speed=np.where(np.arange(N) < 800, 20, 2))
    figures = scored(e)
    assert figures["ecu_valid_share"] == pytest.approx(600 / 800)
    assert figures["ecu_pad_friction_f"] == pytest.approx(0.40)
    assert figures["ecu_pad_level"] == pytest.approx(LEVEL)
    assert figures["ecu_torque_error_f"] == pytest.approx(0.0, abs=1e-12)


def test_an_ecu_without_an_answer_has_no_figures_and_no_share():
    figures = scored(with_speed(made_estimate(ecu=readout(valid=np.zeros(N, bool)))))
    of_ecu = {k: x for k, x in figures.items() if k.startswith(("ecu_", "true_")) and x is not None}
    assert of_ecu == {"ecu_valid_share": 0.0}


def test_errors_of_the_ecu_over_their_sigma():
    """Front e^0.03 and rear e^-0.05 times the truth, half of the samples without an error."""
    off = np.where(np.arange(N) % 2, 1.0, 0.0)
    e = made_estimate(ecu=readout(0.40 * np.exp(0.03 * off), 0.36 * np.exp(-0.05 * off)))
    figures = scored(e)
    assert figures["ecu_normalised_error_f"] == pytest.approx(0.03 / SIGMA / np.sqrt(2))
    assert figures["ecu_normalised_error_r"] == pytest.approx(0.05 / SIGMA / np.sqrt(2))
    assert figures["ecu_torque_error_f"] == pytest.approx(np.expm1(0.03) / np.sqrt(2))
    assert figures["ecu_torque_error_r"] == pytest.approx(-np.expm1(-0.05) / np.sqrt(2))
    true_sum = 0.40 * GAIN_F + 0.36 * GAIN_R
    total = (0.40 * GAIN_F * np.exp(0.03) + 0.36 * GAIN_R * np.exp(-0.05)) / true_sum
    assert figures["ecu_level_error"] == pytest.approx(abs(total - 1.0) / np.sqrt(2))
    assert figures["ecu_normalised_error_level"] == pytest.approx(
        abs(np.log(total)) / SIGMA / np.sqrt(2)
    )
    assert figures["torque_error_f"] == pytest.approx(0.0, abs=1e-12)  # of the best estimate


def test_a_truth_at_the_end_of_an_uneven_interval_is_1_96_sigma_away():
    """Rear pads that may be much weaker, and hardly stronger, than what is most likely."""
    pads = Bounded(*(x * np.ones(N) for x in (0.40, 0.30, 0.41)))
    for end, sigmas in ((0.30, Z95), (0.41, Z95), (0.40, 0.0)):
        e = made_estimate(ecu=replace(readout(0.36, 0.40), pads_r=pads))
        figures = scored(e, truth_log(0.36, end))
        assert figures["ecu_normalised_error_r"] == pytest.approx(sigmas, abs=1e-9)


def test_the_difference_of_two_posteriors_is_one_in_its_own_spread():
    """Conjugate normals: both see the ramp, and the stop; one sees v, too."""
    rng = np.random.default_rng(7)
    truth = 0.10 * rng.standard_normal(N)
    readings = [truth + s * rng.standard_normal(N) for s in (0.1, 0.05)]
    weights = 1.0 / np.array([0.10, 0.1, 0.05]) ** 2
    ecu = weights[1] * readings[0] / weights[:2].sum()
    best = (weights[1] * readings[0] + weights[2] * readings[1]) / weights.sum()
    rms = departure(
        bounded(np.exp(ecu), weights[:2].sum() ** -0.5),
        bounded(np.exp(best), weights.sum() ** -0.5),
        np.ones(N, bool),
    )
    assert rms == pytest.approx(1.0, abs=4.0 / np.sqrt(2 * N))
