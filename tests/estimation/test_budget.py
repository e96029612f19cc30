"""The budget of an estimate adds up, and each part is the error that its cause makes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.intervals import Z95
from calib.estimation.estimator import estimate
from calib.estimation.metrics import budget
from calib.fitting.fit import fit
from tests.support.reference_car import CAR, IDEAL, REAL, WET, covered, noisy, ramp, stop, without

UNWEIGHED = replace(CAR, mass_tolerance=0.03)
PATCHED = replace(REAL, surface=lambda x: (1.0, 1.0) if x < 85.0 else (0.95, 0.55))
"""The road changes to one with little more than half the peak."""


@pytest.fixture(scope="module")
def table():
    return fit(UNWEIGHED, [noisy(ramp(REAL), 1)])


@pytest.fixture(scope="module")
def logs():
    return {
        "dry": noisy(stop(REAL), 3),
        "wet": noisy(stop(WET), 3),
        "patch": noisy(stop(PATCHED, pressure=24e5), 3),
        "without v": without(noisy(stop(WET), 3), "v"),
    }


def median_sigma(e, axle):
    """Sigma of ln mu at the valid sample with the median interval."""
    widths = np.sort((np.log(axle.upper / axle.lower) / (2.0 * Z95))[e.valid])
    return widths[(widths.size - 1) // 2]


def require_equal_sums(e):
    for axle, parts in zip((e.best.pads_f, e.best.pads_r), budget(e), strict=True):
        assert math.hypot(*parts.values()) == pytest.approx(median_sigma(e, axle), rel=1e-9)
        assert all(sigma > 0.0 for sigma in parts.values())


@pytest.mark.parametrize("name", ["dry", "wet", "patch", "without v"])
def test_parts_add_up_to_the_interval(table, logs, name):
    require_equal_sums(estimate(table, logs[name]))


def test_they_add_up_with_given_pads(table, logs):
    other_pads = replace(CAR, front=replace(CAR.front, pad_friction=0.4))
    require_equal_sums(estimate(table, logs["wet"], other_pads))


def test_where_nothing_is_braked_there_is_no_budget(table, logs):
    e = estimate(table, logs["dry"])
    free = replace(e.signals, p_f=0.0 * e.signals.p_f, p_r=0.0 * e.signals.p_r)
    assert budget(replace(e, unfit=("not braked",), signals=free)) is None


def test_a_weighed_car_has_less_of_the_mass(table, logs):
    """What is left of that part is the resistance of another road, 0.0015 g."""
    weighed_car = fit(replace(CAR, mass_tolerance=0.0), [noisy(ramp(REAL), 1)])
    for name in ("dry", "wet"):
        budgets = [budget(estimate(x, logs[name])) for x in (weighed_car, table)]
        for weighed, unweighed in zip(*budgets, strict=True):
            assert weighed["mass"] < 0.012
            assert unweighed["mass"] == pytest.approx(0.03, rel=0.35)


@pytest.mark.parametrize(("plant", "scale"), [(IDEAL, 0.94), (REAL, 1.06)])
def test_a_mass_wrong_on_ramp_and_stop_is_held_by_the_interval(plant, scale):
    """Unchanged pads look unchanged, but all of them are off by the mass: two sigma of it."""
    wrong = replace(plant, mass_scale=scale)
    table = fit(UNWEIGHED, [noisy(ramp(wrong), 1)])
    e = estimate(table, noisy(stop(wrong), 3))
    error = abs(np.log(e.best.level.value[e.valid][-1] * 0.38 / CAR.front.pad_friction))
    assert error == pytest.approx(0.06, abs=0.02)
    assert min(covered(e)) > 0.9
