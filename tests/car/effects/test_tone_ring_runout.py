"""A ring that is not centred, against the geometry of one, there and back."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.car.effects.tone_ring_runout import EFFECT
from calib.model.known_effects import remove_known_effects
from tests.support.effect_runs import SEDAN, driven, made_motion

RUNOUT = {"runout": 0.002, "runout_phase": 0.3, "runout_side": 1.0}


def test_is_the_ripple_of_an_eccentric_ring():
    """Speed of the teeth past the sensor over that of a centred ring, e/r = 0.002: 1 - e/r sin."""
    motion = made_motion(np.full(50, 20.0))
    angle = motion.history.angle_f + 0.3
    centre = -0.002j * np.exp(1j * angle)  # of the ring, from the hub, in radii of the ring
    sensor = 1.0 + 0.0j  # in the radii of a centred ring
    tangential = np.real(np.abs(sensor - centre))  # lever of the teeth under the sensor
    found = EFFECT.wheel_speed(SEDAN, RUNOUT, motion)
    assert found["fl"] == pytest.approx(tangential, abs=2e-5)
    assert np.array_equal(found["fr"], np.ones(50))


@pytest.mark.parametrize(
    ("side", "left", "right"), [(0.0, 1.0, 1.0), (1.0, 1.0, 0.0), (-0.5, 0.5, 1)]
)
def test_one_ring_or_two(side, left, right):
    motion = made_motion(np.full(50, 20.0))
    found = EFFECT.wheel_speed(SEDAN, {**RUNOUT, "runout_side": side}, motion)
    turned = 0.002 * np.sin(motion.history.angle_f + 0.3)
    assert 1.0 - found["fl"] == pytest.approx(left * turned)
    assert 1.0 - found["fr"] == pytest.approx(right * turned)


def test_only_the_sensor_sees_it():
    bare, off = driven({}), driven({"tone_ring_runout": RUNOUT})
    for channel in ("a_x", "v", "omega_fr", "omega_rl"):
        assert np.array_equal(off[channel], bare[channel])
    ripple = off["omega_fl"] / bare["omega_fl"] - 1.0
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (bare["omega_fl"][1:] + bare["omega_fl"][:-1]))])
    assert ripple == pytest.approx(-0.002 * np.sin(0.005 * angle + 0.3), abs=1e-5)


def test_the_analysis_takes_it_out():
    """The angle comes from the readings, so it is off by at most the runout."""
    effects = {"tone_ring_runout": RUNOUT}
    bare, off = driven({}), driven(effects)
    clean = remove_known_effects(replace(SEDAN, effects=Effects(effects)), off)
    assert clean.log["omega_fl"] == pytest.approx(bare["omega_fl"], rel=1e-5)
