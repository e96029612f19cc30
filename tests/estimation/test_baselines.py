"""The methods beside the estimate: shown, or left out with a note; none of them stops a run."""

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from tests.support.reference_car import CAR, IDEAL, REAL, noisy, ramp, stop, with_pads

LAWS = {f"{law}_{name}" for law in ("gradient", "rls") for name in ("paper", "difference", "tyre")}
LAWS |= {"gradient_as_written"}
UNSTABLE = {name for name in LAWS if name.startswith("gradient")}
PLAIN = {"nominal", "mean_gain", "temperature"}
"""Methods without a look-up."""


def test_a_law_that_is_unstable_is_left_out_with_a_note(fitted):
    """gamma u^2 dt = 8/s (p/20 bar)^2 dt is 2.45 at 70 bar and 40 Hz; no wheel locks."""
    log = stop(with_pads(REAL, 0.2, 0.2), 70e5, duration=6.0, rate=40.0)
    e = estimate(fitted, noisy(log, 2))
    assert set(e.baselines) == {*PLAIN, *LAWS - UNSTABLE}
    (note,) = e.notes
    assert (
        "gradient_as_written, gradient_paper, gradient_difference, gradient_tyre left out" in note
    )
    assert "unstable" in note
    assert np.mean(e.valid[e.braked & (e.speed > 5.0)]) > 0.5


def test_without_laws_there_are_nominal_pads_only(fitted):
    """A batch asks for no more, and must not pay for it."""
    e = estimate(fitted, noisy(stop(), 3), with_laws=False)
    assert set(e.baselines) == {"nominal"}
    assert e.notes == ()


def test_mean_gain_is_the_mean_weighted_by_force():
    """Pads 0.31/0.27 of nominal 0.38: one factor, with the gains A r of Table I as weights."""
    e = estimate(fit(CAR, [ramp(IDEAL)]), stop(with_pads(IDEAL, 0.31, 0.27), 30e5), CAR)
    front, rear = e.baselines["mean_gain"]
    assert np.array_equal(front, rear)
    assert front[0] == 0.38
    weights = (28.84 * 130.9, 11.34 * 124.0)
    mean = np.average([0.31, 0.27], weights=weights)
    assert front[e.valid & (e.time > 3.0)] == pytest.approx(mean, rel=0.005)
