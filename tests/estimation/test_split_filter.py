"""The split filter: the same as a textbook's, causal, consistent; it blames the right state."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.intervals import Z95
from calib.base.mixtures import mixture_posterior
from calib.base.names import G
from calib.estimation.filter_input import SplitInput
from calib.estimation.priors import Priors
from calib.estimation.split_filter import filter_pad_ratio
from calib.run.blocks import Blocks
from calib.run.noise import SensorNoise
from calib.table.table import TyrePosterior
from tests.support.reference_car import CAR
from tests.support.textbook_filter import textbook

L_F, L_R, H, R = 1.1556, 1.6494, 0.615, 0.322
WEIGHT = 1744.0 * G
PRIORS = Priors()
NOISE = SensorNoise(omega=2e-3, z=5e-3, v=2e-3, omega_white=0.02)
NAMES = (
    *("log_compliance", "curvature_2", "curvature_3", "load_exponent"),
    *("clock_offset", "log_pad_ratio", "log_tyre_ratio", "radius_load"),
)
SIGMAS = (0.03, 0.1, 0.2, 0.02, 0.002, 0.02, 0.01, 3e-4)


def posterior(mean, covariance):
    names = NAMES[: len(mean)]
    return TyrePosterior(names, tuple(mean), tuple(tuple(row) for row in covariance))


POSTERIOR = posterior((math.log(0.04), *(7 * (0.0,))), np.diag(SIGMAS) ** 2)
"""A straight tyre of stiffness 25, known to be on both axles: slips have a closed form."""
SHOWN = ("log_pad_ratio", "sigma", "nominal_weight", "log_stiffness", "load_shift", "elastic_share")


def stop(z, *, ratio=0.0, stiffness=25.0, v=True, eta_zero=0.0, slip_zero=0.0, length=0.05):
    """Blocks and demand of a car that decelerates with ``z`` (k,), straight tyre, no noise.

    Everything follows from (2), (6), (7), (19), (20) and (22), written out here, and from the
    delay of the priors: slip = (F - delta dF/dt)/stiffness.
    """
    end = length * np.arange(1, z.size + 1)
    speed = 30.0 - G * np.cumsum(z) * length
    share = WEIGHT / (L_F + L_R)
    load_f, load_r = share * (L_R + z * H), share * (L_F - z * H)
    braked = z > 0.0
    total = WEIGHT * z
    odds = 2.7 * math.exp(ratio)
    rise = np.where(braked, np.diff(total, prepend=0.0) / length, 0.0)
    built = total - PRIORS.delay * rise
    slip_f = built * odds / (1.0 + odds) / load_f / stiffness
    slip_r = built / (1.0 + odds) / load_r / stiffness
    omega_f = speed * (1.0 - slip_f) / R
    omega_r = speed * (1.0 - slip_r) / R * (1.0 + eta_zero)
    pressure = 70e5 * z
    still = np.zeros(z.size)
    blocks = Blocks(
        end, pressure, pressure, still, still, z, omega_f, omega_r, speed if v else None, speed,
        still, still, ~braked, 10, length,
    )  # fmt: skip
    mean = load_f / WEIGHT * slip_f + load_r / WEIGHT * slip_r + slip_zero
    demand = SplitInput(
        nominal_f=total * 2.7 / 3.7,
        nominal_r=total / 3.7,
        level=np.where(braked, 1.0, np.nan),
        level_error=still,
        moment_f=still,
        moment_r=still,
        drive_f=still,
        drive_r=still,
        load_f=load_f,
        load_r=load_r,
        tyre_sum=total,
        slip=mean if v else None,
        pitch_deficit=still,
        pitch_slope=still,
        rise=rise,
        odds_by_level=np.ones(z.size),
    )
    return blocks, demand


def followed(z, **how):
    blocks, demand = stop(z, **how)
    return filter_pad_ratio(CAR, blocks, demand, NOISE, POSTERIOR, PRIORS)


STEADY = np.concatenate([np.zeros(30), np.full(100, 0.3)])


@pytest.mark.parametrize("v", [True, False])
def test_nothing_surprises_where_the_model_is_the_truth(v):
    answer = followed(STEADY, v=v)
    assert np.max(np.abs(answer.innovation_eta)) < 1e-9
    if v:
        assert np.max(np.abs(answer.innovation_slip)) < 1e-9
    else:
        assert np.all(np.isnan(answer.innovation_slip))
    assert np.max(np.abs(answer.log_pad_ratio)) < 1e-9
    assert np.max(np.abs(answer.log_stiffness)) < 1e-9
    assert answer.changes == ()


@pytest.mark.parametrize("ratio", [-0.3, 0.3])
def test_pads_that_differ_are_found_with_v(ratio):
    answer = followed(STEADY, ratio=ratio)
    assert abs(answer.log_pad_ratio[-1] - ratio) < 2.0 * answer.sigma[-1]
    assert answer.sigma[-1] < 0.1
    assert answer.nominal_weight[-1] < 0.1
    assert answer.sigma[-1] < answer.sigma[30]


def test_without_v_road_and_pads_stay_entangled():
    """The same eta from softer tyres or from other pads: the interval must hold both."""
    answer = followed(STEADY, ratio=0.2, v=False)
    assert answer.sigma[-1] > 1.5 * followed(STEADY, ratio=0.2).sigma[-1]
    assert abs(answer.log_pad_ratio[-1] - 0.2) < Z95 * answer.sigma[-1]


@pytest.mark.parametrize("v", [True, False])
def test_no_stop_learns_from_the_scatter_of_a_table(v):
    """The estimate is that of a table without it; the interval of free pads is wider by it."""
    apart = np.zeros((len(NAMES), len(NAMES)))
    pads, tyres = NAMES.index("log_pad_ratio"), NAMES.index("log_tyre_ratio")
    apart[np.ix_([pads, tyres], [pads, tyres])] = 0.06**2 * np.array([[1.0, -0.9], [-0.9, 1.0]])
    wider = replace(
        POSTERIOR,
        covariance=tuple(map(tuple, (np.asarray(POSTERIOR.covariance) + apart).tolist())),
        scatter=tuple(map(tuple, apart.tolist())),
    )
    blocks, demand = stop(STEADY, stiffness=21.0, ratio=0.1, v=v)
    free = replace(PRIORS, ratio_odds=1e-9)
    plain, doubted = (
        filter_pad_ratio(CAR, blocks, demand, NOISE, known, free) for known in (POSTERIOR, wider)
    )
    for name in ("innovation_eta", "log_stiffness", "elastic_share"):
        np.testing.assert_allclose(getattr(doubted, name), getattr(plain, name), atol=1e-6)
    assert np.all(doubted.sigma > plain.sigma)


def test_past_does_not_know_the_future():
    z = STEADY.copy()
    z[80:] = 0.15
    now, later = followed(STEADY), followed(z)
    for name in SHOWN:
        assert np.array_equal(getattr(now, name)[:80], getattr(later, name)[:80])
    assert np.array_equal(now.innovation_eta[:80], later.innovation_eta[:80])


def test_change_of_road_is_found_in_the_block_where_it_shows():
    blocks, demand = stop(STEADY)
    softer, slips = stop(STEADY, stiffness=17.0)
    after = blocks.end > 4.0
    mixed = replace(blocks, omega_f=np.where(after, softer.omega_f, blocks.omega_f))
    mixed = replace(mixed, omega_r=np.where(after, softer.omega_r, blocks.omega_r))
    other = replace(demand, slip=np.where(after, slips.slip, demand.slip))
    answer = filter_pad_ratio(CAR, mixed, other, NOISE, POSTERIOR, PRIORS)
    assert answer.changes
    assert answer.changes[0] == pytest.approx(4.0, abs=0.11)
    assert answer.log_stiffness[-1] == pytest.approx(math.log(17.0 / 25.0), abs=0.1)
    assert abs(answer.log_pad_ratio[-1]) < Z95 * answer.sigma[-1]


def thrown(blocks, demand, at, by):
    """The same with front wheels slower by ``by`` (m,), relative, in the blocks from ``at`` on."""
    off = np.zeros(blocks.end.size)
    off[at : at + len(by)] = by
    slip = None if demand.slip is None else demand.slip + 0.55 * off
    return replace(blocks, omega_f=blocks.omega_f * (1.0 - off)), replace(demand, slip=slip)


BUMP = (0.03, -0.02, 0.01, -0.015, 0.006)


@pytest.mark.parametrize(("v", "at"), [(True, 45), (False, 110)])
def test_a_bump_moves_nothing(v, at):
    """At once after the bite, while the body still moves, or much later."""
    flat, demand = stop(STEADY, ratio=0.1, v=v)
    plain = filter_pad_ratio(CAR, flat, demand, NOISE, POSTERIOR, PRIORS)
    bump = thrown(flat, demand, at, BUMP)
    answer = filter_pad_ratio(CAR, *bump, NOISE, POSTERIOR, PRIORS)
    assert np.all(np.isnan(answer.innovation_eta[at : at + len(BUMP)]))
    assert np.all(np.isfinite(answer.innovation_eta[at + len(BUMP) :]))
    assert answer.changes == ()
    assert answer.bumps == (pytest.approx((flat.end[at - 1], flat.end[at + len(BUMP) - 1])),)
    np.testing.assert_allclose(answer.log_pad_ratio[-1], plain.log_pad_ratio[-1], atol=0.01)
    np.testing.assert_allclose(answer.log_stiffness[-1], plain.log_stiffness[-1], atol=0.01)


def patch(one, other, start, end):
    """A run that is ``other`` between two times [s], and ``one`` before and after."""
    (blocks, demand), (there, slips) = one, other
    on = (blocks.end > start) & (blocks.end < end)
    return (
        replace(
            blocks,
            omega_f=np.where(on, there.omega_f, blocks.omega_f),
            omega_r=np.where(on, there.omega_r, blocks.omega_r),
        ),
        demand
        if demand.slip is None
        else replace(demand, slip=np.where(on, slips.slip, demand.slip)),
    )


@pytest.mark.parametrize("v", [True, False])
def test_a_patch_of_another_road_is_no_change_of_the_pads(v):
    """Where it begins and where it ends; without v nothing but its edges tells it from pads."""
    long = np.concatenate([np.zeros(30), np.full(160, 0.3)])
    one, other = (stop(long, stiffness=c, v=v) for c in (25.0, 19.0))
    answer = filter_pad_ratio(CAR, *patch(one, other, 4.0, 5.0), NOISE, POSTERIOR, PRIORS)
    assert answer.changes[0] == pytest.approx(4.0, abs=0.11)
    assert np.all(np.abs(answer.log_pad_ratio[60:]) < Z95 * answer.sigma[60:])
    assert abs(answer.log_pad_ratio[-1]) < 0.03


def test_an_axle_that_lifts_is_not_taken_in():
    """A glitch of a_x: the load left on the rear axle is negative, and no slip follows from it."""
    blocks, demand = stop(STEADY)
    hit = blocks.end == blocks.end[90]
    glitch = replace(demand, load_r=np.where(hit, -3000.0, demand.load_r))
    answer = filter_pad_ratio(CAR, blocks, glitch, NOISE, POSTERIOR, PRIORS)
    assert np.isnan(answer.innovation_eta[90])
    assert np.max(np.abs(answer.innovation_eta[91:])) < 1e-6


def test_a_block_between_lead_in_and_bite_is_not_taken_in():
    """The pads may touch or not: what eta does there is no news of the pads."""
    b, demand = stop(np.concatenate([np.zeros(40), np.full(60, 0.3)]))
    touching = np.arange(40, 43)
    demand.level[touching] = np.nan
    plain = filter_pad_ratio(CAR, b, demand, NOISE, POSTERIOR, PRIORS)
    b.omega_r[touching] *= 1.002
    other = filter_pad_ratio(CAR, b, demand, NOISE, POSTERIOR, PRIORS)
    assert np.all(np.isnan(other.innovation_eta[touching]))
    assert np.array_equal(other.log_pad_ratio, plain.log_pad_ratio)


def test_wheels_past_their_peak_are_not_taken_in():
    """A block in which the front wheels nearly lock says nothing of any curve."""
    blocks, demand = stop(STEADY)
    locking = (blocks.end > 4.0) & (blocks.end < 4.3)
    hit = replace(blocks, omega_f=np.where(locking, 0.7, 1.0) * blocks.omega_f)
    answer = filter_pad_ratio(CAR, hit, demand, NOISE, POSTERIOR, PRIORS)
    assert np.all(np.isnan(answer.innovation_eta[locking]))
    assert abs(answer.log_pad_ratio[-1]) < 1e-6


# The same filter by the book.


def random_stop(seed, v, older=False):
    """A stop of random size on a curved tyre, over a change of the road, with noise in all.

    ``older`` has a table of six parameters, and without scatter.
    """
    rng = np.random.default_rng(seed)
    z = np.concatenate([np.zeros(30), rng.uniform(0.15, 0.5) * np.clip(np.arange(90) / 8, 0, 1)])
    ratio, zero = rng.normal(0.0, 0.15), rng.normal(0.0, 2e-3)
    one, demand = stop(z, v=v, ratio=ratio, eta_zero=zero)
    two, there = stop(z, v=v, ratio=ratio, eta_zero=zero, stiffness=rng.uniform(11.0, 18.0))
    late = np.arange(z.size) > rng.integers(60, 90)

    def mixed(a, b, noise):
        return np.where(late, b, a) * (1.0 + noise * rng.normal(size=z.size))

    blocks = replace(
        one,
        omega_f=mixed(one.omega_f, two.omega_f, 5e-5),
        omega_r=mixed(one.omega_r, two.omega_r, 5e-5),
    )
    pressed = one.p_f > 0.0
    demand = replace(
        demand,
        level=np.where(pressed, 0.9 + 0.02 * rng.normal(size=z.size), np.nan),
        level_error=0.05 * rng.random(z.size),
        moment_f=60.0 + 10.0 * rng.normal(size=z.size),
        moment_r=40.0 + 10.0 * rng.normal(size=z.size),
        drive_f=np.full(z.size, 50.0),
        drive_r=np.full(z.size, -30.0),
        pitch_deficit=0.01 * rng.normal(size=z.size),
        pitch_slope=0.02 * rng.normal(size=z.size),
        slip=mixed(demand.slip, there.slip, 5e-3) if v else None,
        odds_by_level=rng.uniform(0.3, 3.0, z.size),
    )
    count = len(NAMES) - 2 * older
    root = rng.normal(size=(count, count)) * 0.3 + np.eye(count)
    scale = np.array(SIGMAS[:count]) / np.sqrt(np.diag(root @ root.T))
    covariance = root @ root.T * np.outer(scale, scale)
    centre = (0.05, 0.3, 0.03, 0.0, 0.0, 0.0, 0.002)
    mean = rng.normal(centre, (0.05, 0.1, 0.02, 1e-3, 0.05, 0.08, 0.002))
    known = posterior((math.log(0.04), *mean)[:count], covariance)
    if older:
        return blocks, demand, known
    # of the eight directions that are open, half of three is scatter
    share = 0.7 * root[:, -3:] * scale[:, None]
    return blocks, demand, replace(known, scatter=tuple(map(tuple, (share @ share.T).tolist())))


def close(one, two, what):
    scale = np.nanmax(np.abs(two))
    assert np.array_equal(np.isnan(one), np.isnan(two)), what
    assert np.nanmax(np.abs(one - two), initial=0.0) <= 1e-6 * scale, what


@pytest.mark.parametrize(
    ("seed", "v", "older"), [(0, True, False), (0, False, False), (1, True, True)]
)
def test_is_the_filter_of_the_book(seed, v, older):
    blocks, demand, known = random_stop(seed, v, older)
    answer = filter_pad_ratio(CAR, blocks, demand, NOISE, known, PRIORS)
    book = textbook(CAR, blocks, demand, NOISE, known, PRIORS)
    assert answer.changes == book.changes
    for name, symbol in (("log_stiffness", "s"), ("load_shift", "xi"), ("elastic_share", "kappa")):
        close(getattr(answer, name), book.state(symbol), name)
    close(answer.log_stiffness_sigma, np.sqrt(book.variance("s", "s")), "log_stiffness_sigma")
    close(answer.innovation_eta, book.innovation[:, 0], "innovation_eta")
    if v:
        close(answer.innovation_slip, book.innovation[:, 1], "innovation_slip")
    # the ratio: its difference from the table's is weighed, and rho follows by regression on it
    foreign = (PRIORS.foreign * book.state("s")) ** 2
    d = book.state("rho") - book.state("rho0")
    both, cross = book.variance("rho", "rho"), book.variance("rho", "rho0")
    spread = both + book.variance("rho0", "rho0") - 2.0 * cross + foreign
    weighed = mixture_posterior(
        d,
        np.sqrt(spread),
        PRIORS.ratio,
        PRIORS.ratio_odds * demand.odds_by_level,
        PRIORS.ratio_alike,
    )
    slope = (both - cross + foreign) / spread
    mean = book.state("rho") + slope * (weighed.mean - d)
    variance = both + foreign - slope**2 * (spread - weighed.sigma**2)
    close(answer.log_pad_ratio, mean, "log_pad_ratio")
    close(answer.sigma, np.sqrt(variance), "sigma")
    close(answer.nominal_weight, weighed.nominal_weight, "nominal_weight")
    # the change since the ramp is the difference itself
    close(answer.change, weighed.mean, "change")
    close(answer.change_sigma, weighed.sigma, "change_sigma")
