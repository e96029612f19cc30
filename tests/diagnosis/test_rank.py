"""Ranking of singles, pairs and triples against all subsets, solved one by one."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.diagnosis.explanation.hypothesis import STRENGTH
from calib.diagnosis.rank import _ranked

NAMES = ["a", "a", "b", "b", "b", "c", "d", "d"]


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


def best_of_all(A, g, size):
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


@given(st.integers(0, 10_000))
def test_singles_and_pairs_are_the_best_of_all_subsets(seed):
    A, g, names_of = drawn(seed)
    ranked = _ranked(A - np.eye(g.size) / STRENGTH**2, g, names_of, 2)
    for size in (1, 2):
        of_size = [subset for subset in ranked if len(subset.columns) == size]
        best = {frozenset(NAMES[k] for k in subset.columns): subset for subset in of_size}
        expected = best_of_all(A, g, size)
        assert best.keys() == expected.keys()
        for names, subset in best.items():
            assert subset.log_gain == pytest.approx(expected[names][0], abs=1e-8)
            assert sorted(subset.columns) == list(expected[names][1])
            assert subset.amounts == pytest.approx(solved(A, g, subset.columns)[0], abs=1e-8)
