"""What columns explain, against numpy's own least squares."""

import numpy as np
import pytest

from calib.base.noise import explained_square


@pytest.mark.parametrize("seed", range(5))
def test_is_numpy_s_for_each_set_of_columns(seed):
    rng = np.random.default_rng(seed)
    columns, y = (
        rng.normal(size=(7, 3, 40)) * rng.uniform(1e-3, 1e5, (7, 3, 1)),
        rng.normal(size=40),
    )
    found = explained_square(columns, y)
    for one, square in zip(columns, found, strict=True):
        left = y - one.T @ np.linalg.lstsq(one.T, y)[0]
        assert y @ y - square == pytest.approx(float(left @ left), rel=1e-9)


def test_zero_and_doubled_columns_add_nothing():
    x, y = np.arange(5.0), np.array([1.0, 0.0, 2.0, -1.0, 3.0])
    alone = explained_square(x[None], y)
    assert explained_square(np.array([x, 0.0 * x, 3.0 * x]), y) == pytest.approx(float(alone))
