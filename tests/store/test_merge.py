"""The mean of several cars, against closed forms and against cars that are one car."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import t

from calib.base.errors import RevisionError
from calib.estimation.estimator import estimate
from calib.store.merge import merge
from calib.store.state import OUTSIDE, VersionState
from calib.table.budget import level_and_ratio
from calib.table.invariants import violations
from tests.support.cars_of_a_line import car_table, cars, version
from tests.support.reference_car import WET, noisy, stop
from tests.support.tables import VEHICLE, from_content

STIFFNESS = st.lists(st.floats(22.0, 32.0), min_size=2, max_size=5, unique=True)


@pytest.fixture(scope="module")
def copies(runs):
    """Measurements of one car, taken for as many cars."""
    return [version(table, n) for n, table in enumerate(runs, start=1)]


def test_the_mean_of_two_cars_is_a_closed_form():
    """The cars have no errors of their own: equal weights, S^2 = 2, Student's t of one degree."""
    mean = merge(cars(26.0, 28.0), "golden")
    d = mean.difference
    np.testing.assert_allclose(d.D, 27.0 * (d.eta - 1.0), rtol=1e-12)
    root2 = math.sqrt(2.0)
    for shift, scatter in zip(d.eta - 1.0, mean.spread.D, strict=True):
        assert scatter.between == pytest.approx(root2 * shift, rel=1e-6)
        assert scatter.of_mean == pytest.approx(1.0 * shift, rel=1e-6)
    # one more car: (2 + 2/2) (eta - 1)^2; the bands of the cars, 2 (eta - 1), are shared by all
    of_cars = t.ppf(0.975, 1) * math.sqrt(3.0)
    np.testing.assert_allclose(d.upper - d.D, math.hypot(of_cars, 2.0) * (d.eta - 1.0), rtol=1e-6)


def test_every_row_of_f1_and_f2_obeys_the_constraint_at_the_mean_z():
    mean = merge(cars(25.0, 27.5, 28.0), "golden")
    p, car = mean.paper, mean.vehicle
    np.testing.assert_allclose(p.z, 60.0 * (p.eta - 1.0), rtol=1e-12)
    front = car.cg_to_rear_axle + p.z * car.cg_height
    rear = car.cg_to_front_axle - p.z * car.cg_height
    np.testing.assert_allclose(p.f1, -(rear / front) * p.f2, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(p.f1 - p.f2, mean.difference.D, rtol=0.0, atol=1e-15)


@settings(max_examples=3)
@given(STIFFNESS, st.randoms(use_true_random=False))
def test_the_mean_is_sound_and_the_order_of_the_cars_does_not_matter(stiffness, random):
    parents = cars(*stiffness)
    mean = merge(parents, "golden")
    assert violations(mean) == ()
    random.shuffle(parents)
    assert merge(parents, "golden").digest == mean.digest
    assert from_content(*mean.content()).digest == mean.digest


def test_pads_and_stiffness_are_the_means_of_logarithms():
    tables = [car_table(1, 26.0, -0.03, 0.02), car_table(2, 28.0, 0.05, -0.04)]
    mean = merge([version(table, n) for n, table in enumerate(tables, 1)], "golden")
    levels = [level_and_ratio(VEHICLE, table.calibration) for table in tables]
    mean_levels = level_and_ratio(VEHICLE, mean.calibration)
    assert mean_levels.ratio == pytest.approx(-0.01)
    assert mean_levels.level == pytest.approx(0.5 * (levels[0].level + levels[1].level))
    assert mean.calibration.slip_stiffness.value == pytest.approx(math.sqrt(26.0 * 28.0))
    spread = mean.spread
    assert spread.pad_ratio.between == pytest.approx(0.06 / math.sqrt(2.0), rel=1e-6)
    apart = levels[0].level - levels[1].level
    assert spread.pad_level.between == pytest.approx(abs(apart) / math.sqrt(2.0), rel=1e-6)
    of_tyres = math.log(28.0 / 26.0)
    assert spread.stiffness.between == pytest.approx(of_tyres / math.sqrt(2.0), rel=1e-6)


def test_axes_of_different_length_have_their_common_range_and_it_is_told():
    short, long = car_table(1, 26.0), car_table(2, 28.0)
    d, p, g = short.difference, short.paper, short.tyre
    short = replace(
        short,
        difference=replace(d, **{name: getattr(d, name)[:15] for name in vars(d)}),
        paper=replace(p, **{name: getattr(p, name)[:15] for name in vars(p)}),
        tyre=replace(g, **{name: getattr(g, name)[:15] for name in vars(g)}),
    )
    mean = merge([version(short, 1), version(long, 2)], "golden")
    assert mean.difference.eta[[0, -1]].tolist() == [1.0, d.eta[14]]
    assert mean.tyre.slip[-1] == g.slip[14]
    assert mean.difference.eta.size == 21
    assert any("curves end at eta 1.00350, where sedan@1 ends" in r for r in mean.remarks)


def test_the_record_names_the_parents_and_what_no_mean_shrinks(store):
    parents = [store.save(version_.table) for version_ in cars(26.0, 27.0, 28.0)]
    stored = store.save(merge(parents, "golden"))
    origin = store.load("golden@1").table.provenance
    assert [(p.id, p.digest) for p in origin.parents] == [(p.id, p.digest) for p in parents]
    assert {log.name for log in origin.logs} == {"ramp_1.csv", "ramp_2.csv", "ramp_3.csv"}
    assert any("vehicle file, the surface of the track" in r for r in stored.table.remarks)
    assert stored.table.spread.cars == 3
    assert all(verdict.sound for verdict in store.verify())
    assert store.save(merge(parents[::-1], "golden")).id == "golden@1"


def test_copies_of_one_car_have_next_to_no_spread(copies):
    """Only the runs scatter."""
    mean = merge(copies, "golden")
    spread, top = mean.spread, int(np.argmax(mean.difference.D))
    assert spread.D[top].between < 0.01 * mean.difference.D[top]
    assert spread.pad_level.between < 0.003
    assert spread.pad_ratio.between < 0.01
    assert spread.stiffness.between < 0.02  # one run has 0.022
    for car in copies:
        assert mean.calibration.pad_friction_f.value == pytest.approx(
            car.table.calibration.pad_friction_f.value, rel=0.02
        )


def test_the_draws_and_the_figures_of_the_mean_tell_the_same_car(copies):
    """The draws are of one more car: their middle is the mean, within a tenth of a sigma."""
    mean = merge(copies, "golden")
    cal, draws = mean.calibration, mean.draws
    stiffness = -0.5 * np.log(draws.compliance_f * draws.compliance_r)
    for drawn, figure in (
        (stiffness, math.log(cal.slip_stiffness.value)),
        (draws.log_pad_ratio, cal.pad_log_ratio.value),
    ):
        assert abs(np.mean(drawn) - figure) < 0.1 * np.std(drawn)


def test_what_all_cars_share_does_not_shrink_with_their_number(copies):
    few, many = merge(copies[:2], "golden"), merge(copies, "golden")
    budget = copies[0].table.budget
    for mean in (few, many):
        assert mean.budget.level["mass"] == pytest.approx(budget.level["mass"])
        assert mean.budget.front["mass"] == pytest.approx(budget.front["mass"])
    assert many.budget.front["cars"] < 0.5 * few.budget.front["cars"]


def test_it_is_estimated_with_and_its_interval_holds_the_pads(copies):
    estimated = estimate(merge(copies, "golden"), noisy(stop(WET), 3))
    assert estimated.valid.sum() > 100
    for axle, true in ((estimated.best.pads_f, 0.31), (estimated.best.pads_r, 0.27)):
        covered = (axle.lower <= true) & (true <= axle.upper)
        assert np.mean(covered[estimated.valid]) >= 0.9


# What has no mean

PAIR = cars(26.0, 28.0)
FRONT = PAIR[1].table.vehicle.front


def of_second(state=PAIR[1].state, **changes):
    """The pair with the second table changed."""
    return [PAIR[0], replace(version(replace(PAIR[1].table, **changes), 2), state=state)]


def of_origin(**changes):
    return of_second(provenance=replace(PAIR[1].table.provenance, **changes))


def of_vehicle(**changes):
    return of_second(vehicle=replace(PAIR[1].table.vehicle, **changes))


def shortened():
    d = PAIR[1].table.difference
    return of_second(difference=replace(d, **{name: getattr(d, name)[:8] for name in vars(d)}))


@pytest.mark.parametrize(
    "parents",
    [
        *([], PAIR[:1], [PAIR[0], PAIR[0]], [PAIR[0], version(PAIR[0].table, 7)]),
        of_origin(logs=PAIR[0].table.provenance.logs),
        of_origin(identity={"serial": "S1"}),
        of_vehicle(mass=1750.0),
        of_vehicle(front=replace(FRONT, piston_area=3e-3)),
        of_second(VersionState("rejected", reason="front pads wet")),
        of_second(VersionState("withdrawn")),
        of_second(OUTSIDE),
        [version(merge(PAIR, "golden"), 1), *cars(1.0, 2.0, 27.0)[2:]],
        shortened(),
    ],
)
def test_what_has_no_mean_is_refused(parents):
    with pytest.raises(RevisionError) as error:
        merge(parents, "mean")
    assert error.value.exit_code == 2


def test_what_is_open_about_a_car_is_no_other_vehicle():
    front = replace(PAIR[1].table.vehicle.front, pad_friction_tolerance=0.03)
    merge(
        of_vehicle(name="another name", mass_tolerance=0.005, motor_odds=0.0, front=front), "golden"
    )
