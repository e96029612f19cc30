"""The level of a block: by pressure where that is steady, by deceleration where it moves."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.block_level import block_level
from calib.estimation.estimator import estimate
from calib.estimation.priors import Priors
from calib.run.axle_signals import signals
from calib.run.blocks import blocks
from tests.support.reference_car import CAR, REAL, held, noisy, stop, without

PRIORS = Priors()
BLOCKS = blocks(signals(stop(), CAR))
DENSITY = 5e-4


def weighed(z, pressure):
    """Levels 1 by pressure and 2 by deceleration: what is over 1 is the share of the second."""
    b = replace(BLOCKS, z=z, p_f=pressure, p_r=pressure)
    return block_level(np.ones(z.size), np.full(z.size, 2.0), b, DENSITY, PRIORS)


def test_a_steady_pressure_is_trusted_and_errs_by_nothing():
    steady = np.full(BLOCKS.end.size, 0.3)
    found = weighed(steady, 20e5 * np.ones_like(steady))
    assert np.all(found.value == 1.0)
    assert np.all(found.error == 0.0)


def test_a_moving_one_is_weighed_by_both_errors():
    """A pressure that doubles every second from 5 bar on: p'/p is ln 2 for all time."""
    t = BLOCKS.end
    found = weighed(np.full(t.size, 0.3), 5e5 * 2.0**t)
    late = PRIORS.delay_sigma * (1.0 - 2.0**-BLOCKS.length) / BLOCKS.length
    noisy_z = DENSITY / math.sqrt(BLOCKS.length) / 0.3
    share = late**2 / (late**2 + noisy_z**2)
    assert found.value[-1] == pytest.approx(1.0 + share, rel=1e-3)
    # of two independent errors that are weighed by their squares
    assert found.error[-1] == pytest.approx(late * noisy_z / math.hypot(late, noisy_z), rel=1e-2)


def test_noise_of_a_faint_braking_is_told():
    """At a third of the deceleration it is three times as large."""
    t = BLOCKS.end
    strong, faint = (weighed(np.full(t.size, z), 5e5 * 4.0**t) for z in (0.3, 0.1))
    assert faint.value[-1] < strong.value[-1]
    assert faint.error[-1] > strong.error[-1]


def test_late_brakes_are_no_change_of_the_pads(fitted):
    """Without v the first second decides; brakes that follow 0.12 s late made it 30 % wrong."""
    log = noisy(stop(replace(REAL, hydraulic_lag=0.12)), 0)
    e = estimate(fitted, without(log, "v"), with_laws=False)
    assert e.valid.sum() > 500
    assert min(held(e)) > 0.95
