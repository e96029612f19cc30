"""Effects of the pads against lines, disc temperatures and exponentials worked out by hand."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.effects.catalogue import CATALOGUE
from tests.support.effect_runs import SEDAN, driven, factors, made_history, wave

PRESSURE = CATALOGUE["pad_pressure_dependence"]


def test_the_simulation_heats_its_own_discs_where_none_is_given():
    """The heat comes from the truth channels of the run and is summed here step by step."""
    fade = {"fade_slope": 0.004, "fade_onset": 101.0}
    log = driven({"pad_thermal_fade": fade}, lambda t: 40e5, duration=3.0)
    power = log.truth["true_Tb_fl"] * log["omega_fl"]
    T, dt = [100.0], 0.005
    for a, b in pairwise(power):
        T.append(T[-1] + dt * (0.5 * (a + b) / 3700.0 - (T[-1] - 20.0) / 300.0))
    expected = SEDAN.front.pad_friction * (1.0 - 0.004 * np.maximum(np.array(T) - 101.0, 0.0))
    assert log.truth["true_mu_pad_f"] == pytest.approx(expected, abs=2e-5)
    assert expected[-1] < 0.97 * expected[0]


@given(st.floats(-1e-7, 1e-7), st.floats(0.0, 4e-6))
def test_a_bend_changes_neither_the_factor_at_20_bar_nor_the_mean_slope(slope, bend):
    parameters = {"pressure_slope": slope, "pressure_bend": bend}
    p = np.array([0.0, 20e5, 40e5])
    factor, _ = PRESSURE.friction(parameters, made_history(3), p, p)
    assert factor[1] == pytest.approx(1.0, abs=1e-12)
    assert factor[2] - factor[0] == pytest.approx(slope * 40e5, abs=1e-9)


@given(st.floats(0.0, 0.95), st.floats(1e3, 1e6), st.floats(0.2, 2.0), st.floats(0.0, 1e6))
def test_each_brake_dries_by_its_own_heat(loss, dry, share, energy):
    heat = np.array([0.0, energy])
    history = made_history(2, energy_f=heat, energy_r=0.5 * heat)
    wet = {"wet_loss": loss, "dry_energy": dry, "dry_rear_share": share}
    front, rear = factors("wet_pad_recovery", history, **wet)
    assert front == pytest.approx([1.0 - loss, 1.0 - loss * np.exp(-energy / dry)])
    assert rear == pytest.approx([1.0 - loss, 1.0 - loss * np.exp(-0.5 * energy / dry / share)])


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_left_gains_what_right_loses_and_the_rear_its_share(share):
    even = driven({}, wave)
    log = driven({"side_imbalance": {"imbalance": 0.1, "rear_share": share}}, wave)
    for w, factor in (("fl", 1.1), ("fr", 0.9), ("rl", 1.0 + 0.1 * share), ("rr", 1 - 0.1 * share)):
        assert log.truth[f"true_Tb_{w}"] == pytest.approx(factor * even.truth[f"true_Tb_{w}"])
