"""Maps of a table: quantiles of a Gaussian toy in closed form, and bounds that hold their share."""

import math
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from calib.fitting import maps as module
from calib.fitting.ensemble import SlipPrediction
from calib.fitting.maps import maps
from calib.fitting.posterior import posterior
from calib.table.table import Value
from tests.support.reference_car import CAR, REAL, noisy, prepared, ramp

Z95 = 1.959964
BOUNDS = ("_lower", "", "_upper")

CHANGE, OF_RAMP = 0.06, 0.05
"""Sigma of the toy's change, and of its ratio of the ramp."""

BASE, RISE, NOISE = 0.02, 0.06, 0.004
"""(eta - 1)/z = BASE + RISE ratio + NOISE, all without the map's own error."""

FOLLOWS, SCATTER = 1.5, 0.1
"""ln(slip/z) = -3 + FOLLOWS ratio + SCATTER."""


class Toy:
    """Stops whose ratio, eta and slip are one Gaussian; above 0.5 g eta is ``jump`` larger."""

    def __init__(self, follows, jump=0.0, count=60000):
        self.jump = jump
        x = np.random.default_rng(7).standard_normal((4, count))
        self.change = CHANGE * x[0]
        self.log_pad_ratio = OF_RAMP * x[1] + self.change
        self.shift = BASE + RISE * self.log_pad_ratio + NOISE * x[2]
        self.log_slip = -3.0 + follows * self.log_pad_ratio + SCATTER * x[3]

    def predicted(self, z):
        shift = z * (self.shift[:, None] + np.where(z > 0.5, self.jump, 0.0))
        slip = z * np.exp(self.log_slip[:, None])
        return SlipPrediction(z, shift, slip, forces=slip, slips=slip, rolls=slip > 0.0)

    def log_level(self, z):
        return np.full(self.change.size, 0.01)


def toy_maps(monkeypatch, follows, jump=0.0):
    toy = Toy(follows, jump)
    monkeypatch.setattr(module, "scenarios", lambda car, e: toy)
    monkeypatch.setattr(module, "predict_stops", lambda car, s, z, odds: s.predicted(z))
    return maps(CAR, None)


def conditional(name, shift, slip_at, follows):
    """Return mean and sigma of ratio or change of the toy, given shift and ln slip.

    ln slip is ``slip_at`` standard deviations from its mean at that shift.
    """
    variance = {"ratio": OF_RAMP**2 + CHANGE**2, "change": CHANGE**2}[name]
    ratio = OF_RAMP**2 + CHANGE**2
    eta = RISE**2 * ratio + NOISE**2
    covariance = RISE * follows * ratio
    slip = follows**2 * ratio + SCATTER**2
    slip_sigma = math.sqrt(slip - covariance**2 / eta)  # of ln slip at a shift
    covariances = np.array([RISE * variance, follows * variance])
    joint = np.array([[eta, covariance], [covariance, slip]])
    deviation = np.array([shift - BASE, covariance / eta * (shift - BASE) + slip_at * slip_sigma])
    gain = np.linalg.solve(joint, covariances)
    return float(gain @ deviation), math.sqrt(variance - gain @ covariances)


@pytest.mark.parametrize("follows", [0.0, FOLLOWS])
def test_cells_are_the_conditional_quantiles_of_a_gaussian(monkeypatch, follows):
    pad_map, _ = toy_maps(monkeypatch, follows)
    bounds_of = {name: [pad_map.grid(name + end) for end in BOUNDS] for name in ("ratio", "change")}
    (z, shift, slip) = pad_map.axes.values()
    spread = math.sqrt(RISE**2 * (OF_RAMP**2 + CHANGE**2) + NOISE**2)
    near = np.flatnonzero(np.abs(shift - BASE) < 1.3 * spread)
    assert near.size >= 3
    i = int(np.argmin(np.abs(z - 0.3)))
    for name, j, k in product(bounds_of, near, np.flatnonzero(np.abs(slip) <= 1.0)):
        mean, sigma = conditional(name, shift[j], slip[k], follows)
        lower, middle, upper = (x[i, j, k] for x in bounds_of[name])
        assert middle == pytest.approx(mean, abs=0.15 * sigma)
        assert upper - lower == pytest.approx(2.0 * Z95 * sigma, rel=0.15)


def test_before_eta_is_read_the_ratio_is_as_drawn(monkeypatch):
    _, level_map = toy_maps(monkeypatch, 0.0)
    sigma = math.hypot(OF_RAMP, CHANGE)
    assert level_map.ratio == pytest.approx(0.0, abs=0.03 * sigma)
    assert level_map.ratio_upper - level_map.ratio_lower == pytest.approx(2 * Z95 * sigma, rel=0.03)
    assert level_map.change_upper - level_map.change_lower == pytest.approx(
        2 * Z95 * CHANGE, rel=0.03
    )
    assert level_map.level == pytest.approx(0.01)


def test_a_cell_that_nobody_sees_has_the_prior(monkeypatch):
    """What hard stops show alone says nothing in a soft one: the bounds of before."""
    pad_map, level_map = toy_maps(monkeypatch, 0.0, jump=0.3)
    soft = pad_map.axes["z"] < 0.5
    far = int(np.argmin(np.abs(pad_map.axes["shift"] - BASE - 0.3)))
    near = int(np.argmin(np.abs(pad_map.axes["shift"] - BASE)))
    assert pad_map.grid("prior")[soft, far] == pytest.approx(1.0, abs=0.05)
    assert np.all(pad_map.grid("prior")[soft, near] < 0.9)
    for end in BOUNDS:
        bound = pad_map.grid(f"ratio{end}")[soft, far]
        first = getattr(level_map, f"ratio{end}")[soft, None]
        assert bound == pytest.approx(np.broadcast_to(first, bound.shape), abs=0.01)


# Simulation-based calibration (Talts et al. 2018): fresh stops of the same list.


@pytest.fixture(scope="module")
def table():
    e = posterior(CAR, [prepared(noisy(ramp(REAL), 1))], Value(0.0, 0.07))
    return e, *maps(CAR, e)


@pytest.fixture(scope="module")
def fresh(table):
    """Stops drawn at random, of other places than those of the map."""
    rng = np.random.default_rng(11)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "spread_evenly", lambda count, d: rng.uniform(1e-9, 1.0, (count, d)))
        return module.scenarios(CAR, table[0], 8192)


def read(pad_map, z, shift, place):
    """Columns of the map at points, linear between its cells, by another reader."""
    axes = tuple(pad_map.axes.values())
    ends = [np.clip(x, a[0], a[-1]) for x, a in zip((z, shift, place), axes, strict=True)]
    points = np.stack(ends, axis=1)
    return SimpleNamespace(
        **{
            name: RegularGridInterpolator(axes, pad_map.grid(name))(points)
            for name in pad_map.names
        }
    )


def mixed(cells, odds, name):
    """Bounds of a mixture of cells with their odds, as those of a normal of its moments."""
    middle = np.array([getattr(cell, name) for cell in cells])
    width = np.array([getattr(c, f"{name}_upper") - getattr(c, f"{name}_lower") for c in cells])
    mean = odds @ middle
    sigma = np.sqrt(odds @ ((0.5 * width / Z95) ** 2 + middle**2) - mean**2)
    return SimpleNamespace(
        **{name + end: mean + k * sigma for end, k in zip(BOUNDS, (-Z95, 0.0, Z95), strict=True)}
    )


def shares(true, cells, name, counted):
    """Return the share of the truths below the lower bound, the median and the upper bound."""
    return [float(np.mean((true <= getattr(cells, name + end))[counted])) for end in BOUNDS]


@pytest.mark.parametrize("z", [0.1, 0.28, 0.5])
@pytest.mark.parametrize("name", ["ratio", "change"])
@pytest.mark.parametrize("sees", [True, False], ids=["with the slip", "without"])
def test_ranks_of_the_ratio_are_uniform(table, fresh, z, name, sees):
    """The reading has no noise here; a map has at least its own, so bounds are a little wide."""
    _, pad_map, _ = table
    stops = SlipPrediction(*(x[..., 0] for x in module.predict_stops(CAR, fresh, np.array([z]))))
    true = fresh.log_pad_ratio if name == "ratio" else fresh.change
    where, shift = np.full(true.size, z), stops.eta_rise / z
    if sees:
        first = read(pad_map, where, shift, 0.0 * where)
        place = (np.log(np.maximum(stops.slip, 1e-4) / z) - first.log_slip) / first.log_slip_sigma
        cells = read(pad_map, where, shift, place)
    else:  # anywhere along the slip, which is normal there: moments of a mixture
        odds = np.exp(-0.5 * pad_map.axes["slip"] ** 2)
        cells = mixed([read(pad_map, where, shift, x + 0.0 * where) for x in pad_map.axes["slip"]],
                      odds / odds.sum(), name)  # fmt: skip
    below, middle, above = shares(true, cells, name, stops.rolls)
    assert 0.90 < above - below < 0.99
    assert middle == pytest.approx(0.5, abs=0.05)
    assert below < 0.06
    assert above > 0.94


def test_ranks_of_the_level_are_uniform(table, fresh):
    _, _, level_map = table
    for i, z in enumerate(level_map.z):
        level = fresh.log_level(float(z))
        ranks = [np.mean(level <= getattr(level_map, f"level{end}")[i]) for end in BOUNDS]
        assert ranks == pytest.approx([0.025, 0.5, 0.975], abs=0.015)
