"""Blocks against numpy, and the axle that brakes alone."""

from dataclasses import replace

import numpy as np
import pytest

from calib.run.axle_signals import signals
from calib.run.blocks import blocks, braked_alone
from tests.support.made_runs import made_run
from tests.support.reference_car import IDEAL, noisy, one_axle, without
from tests.support.tables import VEHICLE


@pytest.mark.parametrize(("rate", "samples"), [(40.0, 2), (200.0, 10), (1000.0, 50)])
def test_block_means_are_numpys(rate, samples):
    log = made_run(rate=rate, duration=8.0 + 0.03)
    s = signals(log, VEHICLE.rear.rolling_radius)
    b = blocks(s)
    assert (b.samples, b.length) == (samples, pytest.approx(0.05))
    assert b.end.size == log.time.size // samples
    for name in ("p_f", "p_r", "z", "omega_f", "omega_r", "v", "speed"):
        parts = np.split(getattr(s, name)[: samples * b.end.size], b.end.size)
        assert getattr(b, name) == pytest.approx([np.mean(part) for part in parts])
    assert b.end == pytest.approx(s.time[samples - 1 :: samples][: b.end.size])
    assert b.spin_f[1:] == pytest.approx(np.diff(b.omega_f) / 0.05)
    assert b.eta == pytest.approx(b.omega_r / b.omega_f)
    assert np.array_equal(b.lead_in, np.isin(b.end, s.time[s.lead_in]))


@pytest.mark.parametrize("axle", ["f", "r"])
def test_wheel_pressures_show_the_axle_that_brakes_alone(axle):
    log = noisy(one_axle(IDEAL, axle, other=0.5e5), 0)
    assert braked_alone(log) == axle
    renamed = replace(log, name="ramp with both axles", source="both.csv")
    assert braked_alone(renamed) == axle
    other = [f"p_{a}{s}" for a in "fr" for s in "lr"]
    assert braked_alone(without(log, *other)) is None
    assert braked_alone(without(log, "p_mc")) is None
