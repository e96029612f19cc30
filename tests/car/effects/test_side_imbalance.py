"""Imbalance: left and right part, their sum stays."""

import numpy as np
import pytest

from tests.support.effect_runs import apart, driven, on_the_plant, wave


def test_left_gains_what_right_loses():
    log, even = (
        driven({"side_imbalance": {"imbalance": 0.1, "rear_share": 0.0}}, wave),
        driven({}, wave),
    )
    assert log.truth["true_Tb_fl"] == pytest.approx(1.1 * even.truth["true_Tb_fl"])
    assert log.truth["true_Tb_fr"] == pytest.approx(0.9 * even.truth["true_Tb_fr"])
    assert np.array_equal(log.truth["true_Tb_rl"], log.truth["true_Tb_rr"])
    assert np.array_equal(log["omega_rl"], log["omega_rr"])
    assert np.max(log["omega_fr"] - log["omega_fl"]) > 0.1


def test_the_sides_are_mirrored_by_the_sign():
    one = driven({"side_imbalance": {"imbalance": 0.1, "rear_share": 0.0}}, wave)
    other = driven({"side_imbalance": {"imbalance": -0.1, "rear_share": 0.0}}, wave)
    assert one["omega_fl"] == pytest.approx(other["omega_fr"], abs=1e-9)


def test_the_rear_takes_its_share():
    even = driven({}, wave)
    log = driven({"side_imbalance": {"imbalance": 0.1, "rear_share": 0.5}}, wave)
    assert log.truth["true_Tb_rl"] == pytest.approx(1.05 * even.truth["true_Tb_rl"])
    assert log.truth["true_Tb_rr"] == pytest.approx(0.95 * even.truth["true_Tb_rr"])


def test_follows_the_plant_with_uneven_pressures():
    log = driven({"side_imbalance": {"imbalance": 0.1, "rear_share": 0.0}}, wave)
    own = {"fl": lambda t: 1.1 * wave(t), "fr": lambda t: 0.9 * wave(t)}
    run = on_the_plant(wave, own=own)
    for channel in ("omega_fl", "omega_fr", "omega_rl"):
        assert apart(log, run, channel) < 0.01
