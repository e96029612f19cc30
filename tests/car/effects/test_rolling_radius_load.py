"""Radius over load against the load transfer by hand, there and back."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.car.effects.rolling_radius_load import EFFECT
from calib.model.known_effects import remove_known_effects
from tests.support.effect_runs import SEDAN, driven, made_motion

FLAT = {"rolling_radius_load": {"radius_load": 0.01}}


def test_twice_the_load_by_hand():
    """A wheel at twice its load at rest turns exp(q) faster, one without load exp(-q)."""
    W = 1744.0 * 9.80665
    rest_f = W * 1.6494 / 2.805
    motion = made_motion([20.0], load_f=2.0 * rest_f, load_r=0.0)
    found = EFFECT.wheel_speed(SEDAN, {"radius_load": 0.01}, motion)
    assert found["fl"] == pytest.approx(np.exp(0.01))
    assert found["rr"] == pytest.approx(np.exp(-0.01))
    assert np.array_equal(found["fl"], found["fr"])


def test_a_held_stop_by_hand():
    """Front load over that at rest 1 + z h/l_r, rear 1 - z h/l_f; nothing else of the run moves."""
    bare, flat = driven({}), driven(FLAT)
    z = -bare["a_x"] / 9.80665
    ratio_f = flat["omega_fl"] / bare["omega_fl"]
    ratio_r = flat["omega_rl"] / bare["omega_rl"]
    assert ratio_f == pytest.approx(np.exp(0.01 * z * 0.615 / 1.6494), rel=1e-9)
    assert ratio_r == pytest.approx(np.exp(-0.01 * z * 0.615 / 1.1556), rel=1e-9)
    for channel in ("a_x", "v"):
        assert np.array_equal(flat[channel], bare[channel])


def test_the_analysis_takes_it_out():
    bare, flat = driven({}), driven(FLAT)
    clean = remove_known_effects(replace(SEDAN, effects=Effects(FLAT)), flat)
    for w in ("fl", "fr", "rl", "rr"):
        assert clean.log[f"omega_{w}"] == pytest.approx(bare[f"omega_{w}"], rel=1e-9)
