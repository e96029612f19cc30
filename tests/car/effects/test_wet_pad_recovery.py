"""Wet pads: what is missing goes with the heat, however long it takes to come."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import cumulative_simpson

from tests.support.effect_runs import SEDAN, driven, factors, made_history

WET = {"wet_loss": 0.4, "dry_energy": 50e3}


@given(st.floats(0.0, 0.95), st.floats(1e3, 1e6), st.floats(0.0, 1e6))
def test_each_axle_by_its_own_heat(loss, dry, energy):
    heat = np.array([0.0, energy])
    history = made_history(2, energy_f=heat, energy_r=0.5 * heat)
    front, rear = factors("wet_pad_recovery", history, wet_loss=loss, dry_energy=dry)
    assert front == pytest.approx([1.0 - loss, 1.0 - loss * np.exp(-energy / dry)])
    assert rear == pytest.approx([1.0 - loss, 1.0 - loss * np.exp(-0.5 * energy / dry)])


def test_a_rear_brake_that_has_half_to_dry_is_dry_at_half_the_heat():
    heat = np.array([0.0, 20e3, 90e3])
    history = made_history(3, energy_f=heat, energy_r=0.5 * heat)
    front, rear = factors("wet_pad_recovery", history, **WET, dry_rear_share=0.5)
    assert rear == pytest.approx(front)


@pytest.mark.parametrize("w", ["fl", "rr"])
def test_the_torque_comes_back_with_the_heat_of_its_own_brake(w):
    log = driven({"wet_pad_recovery": WET})
    axle = SEDAN.front if w[0] == "f" else SEDAN.rear
    torque = log.truth[f"true_Tb_{w}"]
    heat = cumulative_simpson(torque * log[f"omega_{w}"], x=log.time, initial=0.0)
    dry = axle.pad_friction * axle.torque_gain * 25e5
    assert torque == pytest.approx(dry * (1.0 - 0.4 * np.exp(-heat / 50e3)), rel=1e-4)
    assert torque[0] == pytest.approx(0.6 * dry)


def test_without_braking_the_pads_stay_wet():
    late = driven({"wet_pad_recovery": WET}, lambda t: 25e5 if t > 2.0 else 0.0)
    first = int(np.argmax(late["p_mc"] > 0.0))
    assert late.truth["true_mu_pad_f"][:first] == pytest.approx(0.6 * 0.38)
    assert late.truth["true_mu_pad_f"][-1] > 0.9 * 0.38
