"""Ranking of singles, pairs and triples against all subsets, solved one by one."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.diagnosis.explanation.hypothesis import STRENGTH
from calib.diagnosis.search.rank import _beside, _ranked

NAMES = ["a", "a", "b", "b", "b", "c", "d", "d"]
SEEDS = given(st.integers(0, 10_000))


def drawn(seed):
    """A and g of eight columns of four effects."""
    rng = np.random.default_rng(seed)
    J = rng.standard_normal((12, len(NAMES)))
    A = J.T @ J + np.eye(len(NAMES)) / STRENGTH**2
    return A, 8.0 * rng.standard_normal(len(NAMES)), np.array(NAMES)


def solved(A, g, columns):
    """Amounts, and ln of the evidence they gain: normal priors of `STRENGTH`."""
    k = list(columns)
    H, amounts = A[np.ix_(k, k)], np.linalg.solve(A[np.ix_(k, k)], g[k])
    size = np.linalg.slogdet(STRENGTH**2 * H)[1]
    return amounts, 0.5 * float(g[k] @ amounts - size)


def every(A, g, size):
    """The best gain of each set of names by all subsets of positive amounts."""
    best = {}
    for columns in combinations(range(g.size), size):
        names = frozenset(NAMES[k] for k in columns)
        if len(names) < size:
            continue
        amounts, gain = solved(A, g, columns)
        if np.all(amounts > 0.0) and gain > best.get(names, (-np.inf, ()))[0]:
            best[names] = (gain, columns)
    return best


def told(found):
    return {frozenset(NAMES[k] for k in one.columns): one for one in found}


def as_all_subsets(A, g, size, found):
    expected = every(A, g, size)
    assert told(found).keys() == expected.keys()
    for names, one in told(found).items():
        assert one.log_gain == pytest.approx(expected[names][0], abs=1e-8)
        assert sorted(one.columns) == list(expected[names][1])
        assert one.amounts == pytest.approx(solved(A, g, one.columns)[0], abs=1e-8)


@SEEDS
def test_singles_and_pairs_are_the_best_of_all_subsets(seed):
    A, g, of = drawn(seed)
    found = _ranked(A - np.eye(g.size) / STRENGTH**2, g, of, 2)
    for size in (1, 2):
        as_all_subsets(A, g, size, [one for one in found if len(one.columns) == size])


@SEEDS
def test_a_third_is_the_best_of_its_name_beside_a_pair(seed):
    A, g, of = drawn(seed)
    for pair in combinations(range(g.size), 2):
        if of[pair[0]] == of[pair[1]]:
            continue
        options = {}
        for k in range(g.size):
            amounts, gain = solved(A, g, (*pair, k)) if of[k] not in of[list(pair)] else ([], 0.0)
            if len(amounts) and np.all(amounts > 0.0):
                options[of[k]] = max(options.get(of[k], (-np.inf, k)), (gain, k))
        found = {of[one.columns[2]]: one for one in _beside(A, g, of, pair)}
        assert found.keys() == options.keys()
        for name, one in found.items():
            assert one.columns[2] == options[name][1]
            assert one.log_gain == pytest.approx(options[name][0], abs=1e-8)
            assert one.amounts == pytest.approx(solved(A, g, one.columns)[0], abs=1e-8)
