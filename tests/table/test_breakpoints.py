"""Breakpoints against all possible breakpoints, and their error against a fine grid."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from calib.table.breakpoints import misfit, place


@st.composite
def curves(draw, most=14):
    """An axis that increases strictly and one to three curves over it."""
    n = draw(st.integers(3, most))
    steps = draw(st.lists(st.floats(1e-3, 10.0), min_size=n - 1, max_size=n - 1))
    x = 1.0 + np.concatenate([[0.0], np.cumsum(steps)])
    count = draw(st.integers(1, 3))
    values = st.lists(st.floats(-1.0, 1.0), min_size=n, max_size=n)
    return x, np.array([draw(values) for _ in range(count)])


def gaps_at(places, x, y, rows):
    """Errors of a table of these rows at the places, for each curve."""
    return np.array([np.interp(places, x[rows], v[rows]) - np.interp(places, x, v) for v in y])


def by_grid(x, y, kept_rows):
    """Worst error on a fine grid that holds the rows, and rms by Simpson's rule (exact here)."""
    grid = np.unique(np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(x)]))
    gaps = gaps_at(grid, x, y, kept_rows)
    middle = 0.5 * (gaps[:, 1:] + gaps[:, :-1])
    squares = (gaps[:, 1:] ** 2 + 4 * middle**2 + gaps[:, :-1] ** 2) / 6 * np.diff(grid)
    return np.abs(gaps).max(), np.sqrt(squares.sum(axis=1).max() / (x[-1] - x[0]))


@given(curves(), st.integers(2, 16))
def test_misfit_is_the_error_on_a_fine_grid(case, points):
    x, y = case
    kept_rows = place(x, y, points)
    error = misfit(x, y, x[kept_rows], y[:, kept_rows])
    worst, rms = by_grid(x, y, kept_rows)
    assert error.worst == pytest.approx(worst, abs=1e-12)
    assert error.rms == pytest.approx(rms, abs=1e-9)
    gaps = gaps_at(error.worst_at, x, y, kept_rows)
    assert np.abs(gaps).max() == pytest.approx(error.worst, abs=1e-12)


@given(curves(most=9), st.integers(2, 8))
def test_no_other_placement_is_better(case, points):
    x, y = case
    assume(points < len(x))
    inner = range(1, len(x) - 1)
    placements = [[0, *c, len(x) - 1] for k in range(points - 1) for c in combinations(inner, k)]
    best = min(by_grid(x, y, kept_rows)[0] for kept_rows in placements)
    kept_rows = place(x, y, points)
    assert by_grid(x, y, kept_rows)[0] == pytest.approx(best, abs=1e-12)


@pytest.mark.parametrize("points", [4, 8, 16])
def test_a_parabola_is_met_evenly_by_exactly_the_points_asked_for(points):
    """The best chords of a parabola have equal lengths h and errors h^2/4 (Taylor's remainder)."""
    x = np.linspace(0.0, 1.0, 113)
    y = (x * x)[None]
    kept_rows = place(x, y, points)
    assert len(kept_rows) == points
    ideal = (1.0 / (points - 1)) ** 2 / 4.0
    worst = misfit(x, y, x[kept_rows], y[:, kept_rows]).worst
    assert ideal * (1 - 1e-9) <= worst < 1.3 * ideal
