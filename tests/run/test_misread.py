"""The accelerometer of a calibration run against the deceleration that the plant has."""

import numpy as np
import pytest

from calib.base.names import G
from calib.fitting.fit import fit
from calib.run.resistance import identify
from calib.run.run import Run
from tests.support.reference_car import CAR, REAL, misread, noisy, ramp, without


@pytest.fixture(scope="module")
def clean():
    return ramp(REAL)


def departure(clean, log):
    """Corrected less true z [1] of the braked blocks."""
    run, true = Run(log, CAR), Run(clean, CAR).blocks.z
    felt = run.felt(run.accelerometer(identify(CAR, ())))
    return (felt.z - true)[true > 0.2], true[true > 0.2]


@pytest.mark.parametrize("scale", [0.95, 1.0, 1.05])
def test_scale_is_taken_out_to_one_percent(clean, scale):
    """v tells the scale to 0.7 % on clean logs; five means of three sigma over root five."""
    shares = []
    for seed in range(5):
        off, true = departure(clean, misread(noisy(clean, seed), scale))
        shares.append(np.mean(off / true))
    assert abs(np.mean(shares)) < 0.01
    assert np.max(np.abs(shares)) < 0.025


@pytest.mark.parametrize("offset", [-0.3, 0.0, 0.3])
def test_an_offset_is_taken_out_where_v_tells_it(clean, offset):
    """The car rolls on level ground: lead-in and v agree on a bias. A fifth of it may be left."""
    for seed in range(3):
        off, _ = departure(clean, misread(noisy(clean, seed), offset=offset))
        assert abs(np.mean(off)) * G < 0.06


def test_without_v_the_scale_stays_as_it_was_read(clean):
    off, true = departure(clean, misread(without(noisy(clean, 0), "v"), 1.05))
    assert np.mean(off / true) == pytest.approx(0.05, abs=0.01)


@pytest.mark.parametrize(("scale", "offset"), [(1.05, 0.0), (0.95, 0.0), (1.0, 0.3), (1.0, -0.3)])
def test_pads_of_a_misread_ramp_are_those_of_the_plant(clean, scale, offset):
    for seed in range(2):
        c = fit(CAR, [misread(noisy(clean, seed), scale, offset)]).calibration
        for found in (c.pad_friction_f, c.pad_friction_r):
            assert abs(found.value - 0.38) < 3.0 * found.sigma
        assert c.pad_scale.value == pytest.approx(1.0, abs=0.02)
