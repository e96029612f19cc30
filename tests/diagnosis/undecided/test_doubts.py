"""What pads may hide widens their intervals by what it does to them, in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.agreement import half_widths
from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.undecided.doubts import base_half_widths, tyre_spread
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN, driven


@pytest.fixture(scope="module")
def runs():
    """A coast and two ramps of a car without effects, none so quick that inertia tells the mass."""
    pedals = (
        lambda t: 0.0,
        lambda t: 4e5 * max(t - 1.0, 0.0),
        lambda t: 5e5 * min(max(t - 1.0, 0.0), 4.0),
    )
    driven_at = zip(pedals, (33.0, 30.0, 25.0), strict=True)
    logs = [driven({}, pedal, v0, duration=6.0) for pedal, v0 in driven_at]
    return [run_of(add_noise(log, 3 + i)) for i, log in enumerate(logs)]


def wider(runs, tolerance, unseen=()):
    """Standard deviation that the doubts add to ln of the pads, front and rear [1]."""
    problem = problem_of(replace(SEDAN, mass_tolerance=tolerance, effects=Effects()), runs)
    base = fit(problem, (), np.zeros(BASE))
    plain, all_told = half_widths(base)[:2], base_half_widths(base, unseen)[:2]
    return np.sqrt(all_told**2 - plain**2) / 1.96, base


def test_pads_follow_the_mass_and_the_tyres_of_their_axle(runs):
    # slips and the sum of forces stay: ln F_f moves by -d (1 - phi), ln F_r by +d phi
    sigma, base = wider(runs, 1e-9)
    front, rear = (
        axle.torque_gain * pad / axle.rolling_radius
        for axle, pad in (
            (SEDAN.front, base.base.pad_friction_f),
            (SEDAN.rear, base.base.pad_friction_r),
        )
    )
    phi = front / (front + rear)
    by_tyres = tyre_spread() * np.array([1.0 - phi, phi])
    assert sigma == pytest.approx(by_tyres, rel=0.2)
    heavy, _ = wider(runs, 0.05)
    # the force of the brakes goes with the mass
    assert np.sqrt(heavy**2 - sigma**2) == pytest.approx([0.05, 0.05], rel=0.15)


def test_what_the_logs_could_not_show_counts_and_what_they_show_does_not(runs):
    bare, _ = wider(runs, 1e-9)
    hidden, _ = wider(runs, 1e-9, ("rolling_radius_load",))
    assert np.all(hidden > bare)
    shown, _ = wider(runs, 1e-9, ("hydraulic_lag",))  # these logs show it: it moves no pads
    assert shown == pytest.approx(bare, rel=0.05)
