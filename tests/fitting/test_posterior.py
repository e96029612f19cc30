"""The posterior of a ramp: the truth of plants is inside, and a sharp prior stays sharp."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.fitting.posterior import parts_of, posterior
from calib.model.ramp import prepare
from calib.run.run import Run
from calib.table.table import Value
from tests.studies import plant_r
from tests.studies.brakings import BeyondPeakError
from tests.support.plant import brush, magic
from tests.support.reference_car import (
    CAR,
    IDEAL,
    noisy,
    one_axle,
    prepared,
    ramp,
    with_ratio,
    without,
)

USUAL = Value(0.0, 0.07)
"""ln of the pads' ratio where nobody says anything: pads of a grade."""

RATIO, STIFFNESS = 1.08, 25.0
TYRES = {"magic": magic(STIFFNESS, 0.9), "brush": brush(STIFFNESS, 1.0)}


def interval(x, share=0.95):
    """The middle ``share`` of draws."""
    half = 0.5 * (1.0 - share)
    return np.quantile(x, [half, 1.0 - half])


def sigma(e):
    return float(np.std(e.log_pad_ratio))


@pytest.fixture(scope="module")
def run():
    return noisy(ramp(with_ratio(IDEAL, RATIO)), 1)


@pytest.fixture(scope="module")
def seeing(run):
    return posterior(CAR, [prepared(run)], USUAL)


@pytest.mark.parametrize("tyre", TYRES)
@pytest.mark.parametrize("hidden", [(), ("v",)], ids=["with v", "without v"])
def test_truth_of_a_plant_is_inside(tyre, hidden):
    plant = replace(with_ratio(IDEAL, RATIO), tyre=TYRES[tyre])
    e = posterior(CAR, [prepared(without(noisy(ramp(plant), 2), *hidden))], USUAL)
    for estimate, true in (
        (e.log_pad_ratio, math.log(RATIO)),
        (e.compliance_f, 1.0 / STIFFNESS),
        (e.compliance_r, 1.0 / STIFFNESS),
    ):
        low, high = interval(estimate, 0.98)
        assert low < true < high
    if not hidden:  # v shows the slip itself
        assert np.std(np.log(e.compliance_f)) < 0.1


def test_ratio_of_cars_of_the_second_plant_is_inside():
    """Five forms of tyres, pads that scatter by 7 % in ratio; nine of twelve ratios are enough."""
    inside = []
    for number in range(6):
        rng = np.random.default_rng([40, number])
        try:
            case = plant_r.case(rng)
        except BeyondPeakError:
            continue
        car, truth = case.vehicle, case.ramp.truth
        resistance = Effects(
            {"aerodynamic_drag": {"drag_area": 0.65}, "rolling_resistance": {"coefficient": 0.011}}
        )
        true = np.log(truth["true_mu_pad_f"] / truth["true_mu_pad_r"])[-1]
        filed = np.log(car.front.pad_friction / car.rear.pad_friction)
        for hidden in ((), ("v",)):
            ready = prepare(Run(without(case.ramp, *hidden), car), resistance)
            low, high = interval(filed + posterior(car, [ready], USUAL, draws=1024).log_pad_ratio)
            inside.append(low < true < high)
    assert len(inside) >= 8
    assert np.mean(inside) >= 0.75


def test_a_bench_of_one_percent_comes_back_as_it_was(run):
    """A ramp without v says nothing that is as sure: mean and sigma stay."""
    e = posterior(CAR, [prepared(without(run, "v"))], Value(0.05, 0.01))
    assert np.mean(e.log_pad_ratio) == pytest.approx(0.05, abs=0.004)
    assert 0.008 < sigma(e) < 0.0105


def test_parts_by_cause_are_nearly_the_variance_of_the_draws(run):
    """They are equal for a linear problem and many draws; the parts of a constant are 0."""
    normal = Value(0.0, 0.06)  # of the user: without the tails of the default prior
    for log in (run, without(run, "v")):
        e = posterior(CAR, [prepared(log)], normal)
        pads = e.log_pad_ratio[None] - np.mean(e.log_pad_ratio)
        moved = [pads @ (x - x.mean(axis=0)) / e.size for x in e.pulls.values()]
        whole = sum(float(np.sum(by**2)) for by in moved)
        assert whole == pytest.approx(np.var(e.log_pad_ratio), rel=0.15)
        parts = parts_of(np.vstack([pads, np.ones(e.size)]), e.pulls)
        assert sum(x[0] for x in parts.values()) == pytest.approx(np.var(e.log_pad_ratio))
        assert max(abs(x[1]) for x in parts.values()) < 1e-20


def test_ramps_with_one_axle_show_the_tyres_of_each(run, seeing):
    """The force of an axle that brakes alone hangs on no ratio, so its slip is its compliance."""
    alone = [
        prepared(noisy(one_axle(with_ratio(IDEAL, RATIO), a), 5 + i)) for i, a in enumerate("fr")
    ]
    all_ramps = posterior(CAR, [prepared(run), *alone], USUAL)
    by_all, by_one_ramp = (np.log(e.compliance_f / e.compliance_r) for e in (all_ramps, seeing))
    assert np.std(by_all) < 0.85 * np.std(by_one_ramp)
    assert sigma(all_ramps) < 0.9 * sigma(seeing)
    low, high = interval(all_ramps.log_pad_ratio, 0.98)
    assert low < math.log(RATIO) < high


def test_a_ramp_that_no_tyre_explains_is_refused(run):
    """Brakes of three times the force: no draw is below its peak."""
    strange = prepared(run)
    with pytest.raises(ValueError, match="no draw"):
        posterior(CAR, [replace(strange, brake_sum=3.0 * strange.brake_sum)], USUAL)
