import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from calib.fleet.outliers import SHARE, named, spread


def by_definition(p, share):
    """Benjamini and Hochberg (1995), (1): the k smallest, k the last with p_(k) <= k/m share."""
    ranked = sorted(p)
    held = [k for k in range(1, len(p) + 1) if ranked[k - 1] <= k / len(p) * share]
    return [x <= ranked[held[-1] - 1] for x in p] if held else [False] * len(p)


@given(st.lists(st.floats(0.0, 1.0) | st.floats(0.0, 0.1), min_size=1, max_size=50))
def test_named_is_the_rule_of_benjamini_and_hochberg(p):
    expected = by_definition(p, SHARE * (1 - 1e-12))
    assume(expected == by_definition(p, SHARE * (1 + 1e-12)))  # on the limit rounding decides
    assert named(np.array(p)).tolist() == expected


def test_what_is_not_known_is_never_named():
    assert named(np.array([np.nan, 1e-9])).tolist() == [False, True]
    assert named(np.array([np.nan])).tolist() == [False]


@pytest.mark.parametrize(("cars", "fleets"), [(8, 1000), (30, 1000), (1000, 300), (10_000, 60)])
def test_a_fleet_without_outliers_names_none(cars, fleets):
    """One car or more is named in about 5 % of fleets, whatever their size."""
    rng = np.random.default_rng(cars)
    wrong = [named(spread(rng.normal(size=cars)).p).any() for _ in range(fleets)]
    assert np.mean(wrong) < 0.05 + 4.0 * np.sqrt(0.05 * 0.95 / fleets)


@pytest.mark.parametrize("cars", [100, 200, 500])
def test_sixteen_figures_together_name_no_more(cars):
    """The rule is over all figures: one that is bent by chance is enough to name a good car."""
    rng = np.random.default_rng(cars)
    wrong = [
        named(np.array([spread(rng.normal(size=cars)).p for _ in range(16)])).any()
        for _ in range(150)
    ]
    assert np.mean(wrong) < 0.05 + 4.0 * np.sqrt(0.05 * 0.95 / 150)


def test_a_skewed_fleet_of_ten_thousand_names_a_few_at_most():
    rng = np.random.default_rng(7)
    for draw in (lambda n: np.exp(0.5 * rng.normal(size=n)), lambda n: rng.gamma(4.0, size=n)):
        assert np.mean([named(spread(draw(10_000)).p).sum() for _ in range(20)]) < 2.0


def test_outliers_are_named_and_do_not_hide_each_other():
    x = 0.38 + 0.01 * np.random.default_rng(8).normal(size=500)
    x[[3, 50, 77]] = (0.45, 0.30, 0.50)
    found = spread(x)
    assert np.flatnonzero(named(found.p)).tolist() == [3, 50, 77]
    assert found.z[3] == pytest.approx(7.0, abs=1.0)
    assert found.scale == pytest.approx(0.01, rel=0.1)


def test_the_number_beyond_three_is_what_chance_gives():
    rng = np.random.default_rng(9)
    many = [spread(rng.normal(size=2000)) for _ in range(100)]
    assert np.mean([s.beyond for s in many]) == pytest.approx(many[0].expected, rel=0.15)


def test_gaps_few_cars_and_figures_without_scale():
    x = np.r_[np.nan, np.arange(20.0)]
    found = spread(x)
    assert (found.count, found.median) == (20, 9.5)
    assert np.isnan(found.z[0])
    for values in (np.arange(3.0), np.r_[np.zeros(50), 1.0], np.full(4, np.nan)):
        assert not np.isfinite(spread(values).z).any()
        assert not named(spread(values).p).any()
