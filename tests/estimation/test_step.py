"""The step on blocks whose truth is a closed form: level, lag, zeros, look-up, reset, reasons."""

import math
from dataclasses import astuple

import numpy as np
import pytest

from calib.base.names import G
from calib.car.effects.catalogue import CATALOGUE
from calib.car.lag import second_order
from calib.estimation.constants import LEVEL, PADS, SLIP, Constants
from calib.estimation.equations import update
from calib.estimation.reasons import Reason
from calib.estimation.state import Sample, SpeedFilter
from calib.estimation.step import run as run_all
from calib.estimation.step import started, step
from calib.table.maps import LevelMap, Reader
from tests.support.tables import B_SHIFT, B_SLIP, B_Z, A, made_map

DT = 0.05
SHIFT = 0.004
"""(eta - 1)/z of the stops."""


def before_eta():
    """A level that is known to +-0.02, a ratio that is known to +-1 only."""
    z = np.array([0.1, 0.8])
    zeros, ones = np.zeros(2), np.ones(2)
    return LevelMap(z, zeros, -0.02 * ones, 0.02 * ones, *2 * (zeros, -ones, ones))


def constants(**changed):
    values = {
        "pads": Reader(made_map(), PADS), "slip": Reader(made_map(), SLIP),
        "level": Reader(before_eta(), LEVEL), "prior": Reader(before_eta(), PADS),
        "noise_rim": 3e-4, "noise_z": 1e-4, "noise_v": 1e-3, "radii": 0.0,
        "late": 0.0, "late_sigma": 1e-3, "ramp_ratio": 0.0, "block": DT,
    }  # fmt: skip
    return Constants(**(values | changed))


def stop(level=0.8, *, lag=1e-3, zero=0.012, wheels=0.998, rolling=1.5, apart=0.0, with_v=True,
         last=5.0, speed=35.0, drift=0.0):  # fmt: skip
    """Blocks of a stop with 0.4 of nominal brake force after ``rolling`` [s].

    The deceleration reads ``zero`` and eta ``wheels`` where nothing brakes, eta with a ``drift``
    [1/s] while the car rolls; ln(slip/z) is ``apart`` standard deviations from its mean in the map.
    """
    out, acting, nominal, v = [], 0.0, 0.0, speed
    for k in range(round((rolling + last) / DT)):
        t = DT * (k + 1)
        then, nominal = nominal, 0.4 * min(max(t - rolling, 0.0) / 0.5, 1.0)
        # behind a lag of first order, of a straight rise within the block
        rate = (nominal - then) / DT
        acting = nominal - lag * rate + (acting - then + lag * rate) * math.exp(-DT / lag)
        z = level * acting
        slip = z * math.exp(z - 3.0 - SHIFT + apart * (0.2 + z)) if z > 0.0 else 0.0
        v -= G * (z + zero) * DT
        turned = wheels + drift * min(t, rolling)
        eta = turned * (1.0 + SHIFT * z)
        # rims weighted by load slip by as much
        rim = v * (1.0 - slip) / (1.0 + 0.4 * (eta / turned - 1.0))
        out.append(
            Sample(z + zero, nominal, 4e7 / 4.0 * nominal, z + zero, eta - 1.0, rim, 0.4,
                   v if with_v else math.nan, 0.0, 0.0, 0.0, 0.0, 0.0)
        )  # fmt: skip
    return out


def run(blocks, c=None, state=None):
    c = c or constants()
    s = state or started(c)
    return [step(c, s, x) for x in blocks], s


def test_a_map_is_read_between_its_cells():
    table_map = made_map()
    rng = np.random.default_rng(3)
    axes = tuple(table_map.axes.values())
    points = rng.uniform([x[0] for x in axes], [x[-1] for x in axes], (50, len(axes)))
    ratio, log_slip = Reader(table_map, ("ratio", "log_slip"))(*points.T)
    z, shift, slip = points.T
    assert ratio == pytest.approx(A + B_Z * z + B_SHIFT * shift + B_SLIP * slip)
    assert log_slip == pytest.approx(z - 3.0 - shift)


def test_a_map_is_held_at_its_ends():
    beyond, end = Reader(made_map(), PADS)(*np.array([[9.0, 0.8], [9.0, 0.02], [-9.0, -1.0]])).T
    assert beyond.shape == (2, 3)
    assert np.array_equal(beyond, end)


def test_a_reading_is_taken_in_as_the_textbook_has_it():
    rng = np.random.default_rng(1)
    root = rng.normal(size=(4, 4))
    P, x, R, y = root @ root.T, rng.normal(size=4) - [0.0, 4.0, 0.0, 0.0], 0.3, 1.7
    H = np.array([*rng.normal(size=2), 0.0, 0.0])
    S, upper = H @ P @ H + R, np.triu_indices(4)
    s = started(constants())
    s.speed = SpeedFilter(*x, *P[upper])
    assert update(constants(), s, H[0], H[1], y, R, 0.0) == pytest.approx(y / np.sqrt(S))
    out = astuple(s.speed)
    assert out[:4] == pytest.approx(x + P @ H / S * y)
    assert out[4:] == pytest.approx((P - np.outer(P @ H, H @ P) / S)[upper])


def test_all_blocks_at_once_are_each_by_itself():
    """To the last bit: one code for an ECU and for a log."""
    blocks = [*stop(0.5), *stop(1.0, rolling=2.0, apart=0.5)]
    answers, _ = run(blocks)
    for name, together in run_all(constants(), Sample(*np.array(blocks).T))._asdict().items():
        by_step = np.stack([getattr(answer, name) for answer in answers], axis=-1)
        assert np.array_equal(together, by_step, equal_nan=True), name


@pytest.mark.parametrize("level", [0.5, 0.8, 1.2])
def test_the_level_is_that_of_the_forces(level):
    answers, _ = run(stop(level))
    last = answers[-1]
    assert last.level[0] == pytest.approx(math.log(level), abs=0.01)
    assert last.level[1] < math.log(level) < last.level[2]
    assert last.level[2] - last.level[1] < 0.08


@pytest.mark.parametrize("apart", [-0.8, 0.0, 1.2])
def test_the_ratio_is_that_of_the_map(apart):
    """Linear in all three axes; its bounds are those of the map and what the sensors leave open."""
    answers, _ = run(stop(apart=apart))
    last, z = answers[-1], 0.32
    true = A + B_Z * z + B_SHIFT * SHIFT + B_SLIP * apart
    assert last.ratio[0] == pytest.approx(true, abs=0.02)
    assert 0.1 <= last.ratio[0] - last.ratio[1] < 0.15
    assert 0.2 <= last.ratio[2] - last.ratio[0] < 0.25
    assert last.change[0] == pytest.approx(last.ratio[0] - 0.05, abs=1e-9)
    assert last.slip == pytest.approx(z - 3.0 - SHIFT + apart * (0.2 + z), abs=0.05)


@pytest.mark.parametrize("noise", [1e-6, 1e-4, 1e-3])
@pytest.mark.parametrize("lag", [0.001, 0.08, 0.15])
def test_a_lag_is_found_however_quiet_the_sensors_are(lag, noise):
    _, s = run(stop(lag=lag), constants(noise_z=noise))
    assert s.lag.value == pytest.approx(lag, abs=0.02)


def test_the_error_of_eta_holds_a_body_that_pitches():
    """By modes of the catalogue, from 0.5 to 1.3 s after the bite: eta errs by about one sigma.

    Loads that are late by h (z - z_b)/L change the slips of both axles by that over their loads.
    """
    rng, n, time = np.random.default_rng(2), 200, 0.01 * np.arange(150)
    card = {row.name: row for row in CATALOGUE["pitch_coupling"].card.parameters}
    share, omega, damping = (
        np.clip(rng.normal(card[x].typical, card[x].spread, n), card[x].low, card[x].high)
        for x in ("elastic_share", "natural_frequency", "damping")
    )
    squares = []
    for last_z, rise, front, height, *mode in zip(
        rng.uniform(0.15, 0.6, n), rng.uniform(0.2, 0.6, n), rng.uniform(0.5, 0.62, n),
        rng.uniform(0.18, 0.27, n), share, omega, damping, strict=True,
    ):  # fmt: skip
        z = last_z * np.minimum(time / rise, 1.0)
        load = front + height * z
        late = mode[0] * height * (z - second_order(time, z, mode[1], mode[2]))
        eta_error = z * late / (load * (1.0 - load))  # over the slip per z
        keep = np.exp(-(time[-1] - time) / 0.3)
        for end in (50, 90, 130):
            weight = keep[:end] / keep[:end].sum()
            mean = weight @ z[:end]
            variance = weight @ z[:end] ** 2 - mean**2
            squares.append((weight @ eta_error[:end]) ** 2 / variance / mean**2)
    assert 0.25 < np.mean(squares) / Constants.unsteady < 4.0


def test_pads_that_step_are_followed_within_three_blocks():
    """From 0.8 to 0.6 while the pressure holds; the bounds hold them but for the step itself."""
    blocks = stop(level=0.8, last=3.0)
    speed, zero = blocks[-1].rim, 0.012
    for _ in range(20):
        z = 0.6 * 0.4
        speed -= G * (z + zero) * DT
        blocks.append(blocks[-1]._replace(demand=z + zero, z=z + zero, rim=speed, v=speed))
    answers, _ = run(blocks)
    for answer in answers[-17:]:
        assert answer.level[0] == pytest.approx(math.log(0.6), abs=0.03)
        assert answer.level[1] < math.log(0.6) < answer.level[2]


def test_a_second_stop_starts_anew():
    """Wet pads first, dry ones then: the first stop is forgotten, the zeros are not."""
    _, s = run(stop(0.5))
    answers, _ = run(stop(1.0, rolling=2.0), state=s)
    valid = [a for a in answers if a.reason == Reason.VALID]
    assert valid[0].level[0] == pytest.approx(0.0, abs=0.03)
    assert valid[-1].level[0] == pytest.approx(0.0, abs=0.01)
    assert valid[-1].ratio[0] == pytest.approx(A + B_Z * 0.4 + B_SHIFT * SHIFT, abs=0.03)


def test_zeros_follow_what_drifts_until_the_bite():
    """Tyres that warm by 0.1 % in five minutes; 2e-5 of eta is 0.1 % of the ratio."""
    _, s = run(stop(rolling=60.0, drift=1e-3 / 300.0, speed=45.0))
    assert s.eta_less_1.value == pytest.approx(-0.002 + 60.0 * 1e-3 / 300.0, abs=3e-5)
    assert s.demand.value == pytest.approx(0.012, abs=1e-3)


def test_without_a_lead_in_all_is_finite_and_wide():
    whole, short = (run(stop(rolling=r))[0] for r in (1.5, 0.0))
    assert all(np.all(np.isfinite(x)) for a in short for x in a[:-2])
    assert short[-1].reason == Reason.VALID
    widths = [a[-1].ratio[2] - a[-1].ratio[1] for a in (whole, short)]
    assert widths[1] > widths[0]
    assert short[-1].level[0] == pytest.approx(math.log(0.8), abs=0.1)


def test_reasons():
    blocks = stop()
    answers, s = run(blocks)
    reasons = [int(a.reason) for a in answers]
    assert set(reasons[:30]) == {Reason.NOT_BRAKED}
    assert reasons[30:36].count(Reason.JUST_APPLIED) >= 3
    assert set(reasons[38:]) == {Reason.VALID}
    last = blocks[-1]
    for changed, reason in (
        ({"pressure": 1e5}, Reason.NOT_BRAKED),
        ({"rim": 1.0}, Reason.SLOW),
        ({"disturbed": Reason.CORNERS}, Reason.CORNERS),
        ({"disturbed": Reason.LOCKED, "rim": 1.0}, Reason.LOCKED),
    ):
        assert step(constants(), s, last._replace(**changed)).reason == reason


def test_an_eta_that_no_stop_shows_is_not_read():
    answers, _ = run([x._replace(eta_less_1=-0.002 + 0.1 * (x.eta_less_1 + 0.002) / 0.004)
                      if x.nominal else x for x in stop()])  # fmt: skip
    last = answers[-1]
    assert last.reason == Reason.BEYOND_MAP
    assert last.ratio == pytest.approx([0, -1, 1], abs=0.3)
    assert last.level[0] == pytest.approx(math.log(0.8), abs=0.02)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_read_the_answer_is_finite(seed):
    """Sensors that fail: any number, for as long as they like."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-3.0, 1.0, 9)
    blocks = []
    for _ in range(400):
        if rng.random() < 0.05:
            size = 10.0 ** rng.uniform(-3.0, 1.0, 9)
        x = size * rng.standard_normal(9)
        pressure = 1e6 * max(x[2], 0.0)
        v = math.nan if rng.random() < 0.5 else 20.0 * x[6]
        blocks.append(
            Sample(x[0], pressure / 1e7, pressure, x[3], math.exp(0.1 * x[4]),
                   max(20.0 * x[5], 0.3), 0.4, v, 4.0 * (rng.random() < 0.1), x[7], 0.0, x[8], 0.0)
        )  # fmt: skip
    answers, _ = run(blocks)
    for answer in answers:
        assert all(np.all(np.isfinite(x)) for x in answer[:-2])
        for middle, low, high in answer[:3]:
            assert low <= middle <= high
