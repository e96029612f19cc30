"""The same hard stop at several sample rates: the same answer."""

from dataclasses import replace

import pytest

from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp

PLANT = replace(REAL, hydraulic_lag=0.02, relaxation=0.3)
"""Brakes, and tyres, that build up their force in some hundredths of a second; no motor."""


@pytest.fixture(scope="module")
def table():
    return fit(replace(CAR, motor_odds=0.0), [noisy(ramp(PLANT), 1)])


def test_a_hard_stop_has_the_same_answer_at_every_rate(table):
    """30 bar within 0.1 s, as in an emergency."""
    how = {"duration": 9.0, "stop_speed": 1.5}
    logs = [
        as_log(
            drive(PLANT, lambda t: 30e5 * min(max((t - 1.5) / 0.1, 0.0), 1.0), 27.0, rate=r, **how)
        )
        for r in (80.0, 110.0, 333.0)
    ]
    silent = [replace(noisy(log, 4), truth={}) for log in logs]
    results = [validate_one(table, log, None, DEFAULTS, baselines=False) for log in silent]
    assert {result.verdict for result in results} == {"passed"}
    assert {warning.code for result in results for warning in result.all_warnings} == set()
    shares = [result.figures["valid_share"] for result in results]
    assert max(shares) - min(shares) < 0.05
