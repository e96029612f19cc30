"""What draws of a car make of forces: loads, slips and shares in closed form."""

import numpy as np
import pytest

from calib.fitting.ensemble import draws_of, ensemble_of, loaded_tyres, spread_evenly
from tests.support.drawn_cars import one_car
from tests.support.reference_car import CAR
from tests.support.tables import VEHICLE, made_draws, made_table

L, L_F, H = 2.805, 1.1556, 0.615
"""Wheelbase, way to the front axle, height of the centre of gravity [m]: Table I."""

Z = np.array([0.05, 0.2, 0.5])


def loads(z):
    """(6), (7): of front and rear axle over the weight."""
    return (L - L_F + H * z) / L, (L_F - H * z) / L


def of_axles(front, rear):
    return np.stack([front, rear])[:, None]


def test_compliance_grows_and_the_peak_falls_with_the_load():
    """At the load N over half the weight: c N^q, m N^-p, and similarity in m."""
    q, p = 0.2, 0.1
    forces = of_axles(0.7 * Z, 0.3 * Z)
    car = one_car("exponential", load_exponent=q, peak_load_exponent=p)
    unit_slips, _ = loaded_tyres(CAR, car, Z).unit_slips(forces)
    for slips, force, load in zip(unit_slips, forces, loads(Z), strict=True):
        relative = 2.0 * load
        most = 0.9 * relative**-p
        expected = relative**q * most * -np.log(1.0 - force[0] / load / most)
        assert slips[0] == pytest.approx(expected)


def test_a_road_of_half_the_peak_is_a_tyre_of_half_the_peak():
    forces = of_axles(0.4 * Z, 0.1 * Z)
    road, _ = loaded_tyres(CAR, one_car(), Z, np.array([0.5])).unit_slips(forces)
    tyre, _ = loaded_tyres(CAR, one_car(peak=0.45), Z).unit_slips(forces)
    assert road == pytest.approx(tyre)


def test_beyond_the_peak_or_off_the_road_a_wheel_does_not_roll():
    front, rear = loads(Z)
    lifting = np.array([L_F / H])  # where the rear load is zero
    for z, forces in (
        (Z, of_axles(0.9 * front, 0.1 * Z)),
        (Z, of_axles(0.1 * Z, 0.9 * rear)),
        (lifting, np.zeros((2, 1, 1))),
    ):
        _, rolls = loaded_tyres(CAR, one_car(), z).unit_slips(forces)
        assert not rolls.any()


@pytest.mark.parametrize("dimension", [1, 6, 11])
def test_points_are_in_the_open_cube_and_more_even_than_random_ones(dimension):
    count = 2048
    points = spread_evenly(count, dimension)
    assert points.shape == (count, dimension)
    assert 0.0 < points.min() < points.max() < 1.0
    # Kolmogorov's distance of a random coordinate is 0.83/sqrt(n) in the median
    even = (np.arange(count) + 0.5) / count
    off = np.max(np.abs(np.sort(points, axis=0) - even[:, None]), axis=0) * np.sqrt(count)
    assert np.median(off) < 0.4
    assert np.max(off) < 1.2
    correlation = np.corrcoef(points.T) if dimension > 1 else np.eye(1)
    assert np.max(np.abs(correlation - np.eye(dimension))) < 0.1


def test_the_draws_of_an_ensemble_give_it_back():
    draws = made_draws(400)
    restored = draws_of(VEHICLE, ensemble_of(VEHICLE, draws), made_table().calibration)
    for name in vars(draws).keys() - {"log_pad_level", "weight"}:
        np.testing.assert_allclose(getattr(restored, name), getattr(draws, name), rtol=1e-12)
