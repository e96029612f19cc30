"""The split filter: gradients, first state, pitch mode, causality, consistency."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from calib.estimation.split_filter import (
    B2,
    B3,
    ETA0,
    FROM_TABLE,
    KAPPA,
    LAG,
    RHO,
    RHO0,
    SLIP0,
    STATES,
    XI,
    C,
    Priors,
    Q,
    S,
    SplitInput,
    W,
    _answer,
    _predict,
    _Step,
    _steps,
    _widen_surface,
    filter_pad_ratio,
    initial,
    pitch_deficit,
)
from calib.names import G
from calib.signals.blocks import Blocks
from calib.signals.noise import SensorNoise
from tests.support.reference_car import CAR

L_F, L_R, H, R = 1.1556, 1.6494, 0.615, 0.322
WEIGHT = 1744.0 * G
PRIORS = Priors()
NOISE = SensorNoise(omega=2e-3, z=5e-3, v=2e-3, omega_white=0.02)
MEAN = np.array([math.log(0.04), 0.0, 0.0, 0.0, 0.0, 0.0])
"""A straight tyre of stiffness 25: every slip below has a closed form."""
COVARIANCE = np.diag([0.03, 0.1, 0.2, 0.02, 0.002, 0.02]) ** 2


def step(z=0.3, level=0.9, psi=0.02, **changed):
    """One block of a stop of the reference car, with drag-like moments."""
    share = WEIGHT / (L_F + L_R)
    values = {
        "brake_f": 0.73 * WEIGHT * z,
        "brake_r": 0.27 * WEIGHT * z,
        "level": level,
        "moment_f": 60.0,
        "moment_r": 40.0,
        "load_f": share * (L_R + z * H),
        "load_r": share * (L_F - z * H),
        "free": 0.012,
        "weight": WEIGHT,
        "eta": 1.004,
        "slip": 0.012,
        "lag_gain": G * z / 20.0,
        "var_eta": 1e-8,
        "var_slip": 1e-8,
        "relative": 0.02,
        "pitch_variance": 1e-5,
        "psi": psi,
        "drift_ratio": 0.0,
        "drift_surface": 0.0,
        "moving": True,
        "calm": True,
    }
    return _Step(**(values | changed))


@st.composite
def states(draw):
    x = np.zeros(STATES)
    for index, low, high in (
        (RHO, -0.5, 0.5),
        (S, -0.6, 0.3),
        (W, 0.5, 4.0),
        (XI, -0.03, 0.03),
        (KAPPA, -0.5, 1.2),
        (ETA0, -0.01, 0.01),
        (SLIP0, -0.01, 0.01),
        (LAG, -0.02, 0.02),
        (Q, -0.05, 0.1),
        (C, -4.0, -2.5),
        (B2, -0.2, 0.3),
        (B3, 0.0, 0.6),
        (RHO0, -0.2, 0.2),
    ):
        x[index] = draw(st.floats(low, high))
    return x


@given(
    x=states(),
    z=st.floats(0.03, 0.6),
    level=st.sampled_from([0.0, 0.4, 1.0, 1.3]),
    psi=st.floats(-0.05, 0.05),
    rear=st.sampled_from([0.0, 1.0]),
)
def test_gradients_are_those_of_central_differences(x, z, level, psi, rear):
    block = step(z, level, psi)
    block = replace(block, brake_r=rear * block.brake_r)
    rows = _predict(x, block)[2]
    for i in range(STATES):
        h = 1e-5
        e = h * np.eye(STATES)[i]
        above, below = _predict(x + e, block), _predict(x - e, block)
        for k in (0, 1):
            slope = (above[k] - below[k]) / (2.0 * h)
            assert rows[k, i] == pytest.approx(slope, rel=1e-5, abs=1e-7), (i, k)


@given(z=st.floats(0.05, 0.5), level=st.floats(0.4, 1.2), rho=st.floats(-0.4, 0.4))
def test_prediction_is_the_closed_form_of_a_straight_tyre(z, level, rho):
    """F = (brake + moment)/load, slip = F/25, eta = (1 - slip_r)/(1 - slip_f), written out."""
    x = np.zeros(STATES)
    x[[RHO, W, C, ETA0, SLIP0, LAG]] = rho, 1.0, math.log(0.04), 0.002, -0.001, 0.005
    block = step(z, level, psi=0.0)
    eta, slip, _ = _predict(x, block)
    total = level * (block.brake_f + block.brake_r)
    odds = block.brake_f / block.brake_r * math.exp(rho)
    brakes = total * odds / (1.0 + odds), total / (1.0 + odds)
    slip_f = 0.04 * (brakes[0] + 60.0) / block.load_f
    slip_r = 0.04 * (brakes[1] + 40.0) / block.load_r
    assert eta == pytest.approx(1.002 * (1.0 - slip_r) / (1.0 - slip_f))
    share = block.load_f / WEIGHT
    mean = share * slip_f + (1.0 - share) * slip_r
    assert slip == pytest.approx(mean - 0.001 + 0.005 * G * z / 20.0)


def test_load_that_pitch_moves_late_lowers_the_front():
    """psi is load not yet moved: a lighter front axle slips more for the same brake."""
    x = np.zeros(STATES)
    x[[W, C, KAPPA]] = 1.0, math.log(0.04), 1.0
    assert _predict(x, step(psi=0.02))[0] > _predict(x, step(psi=0.0))[0]


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=36, max_size=36),
    st.lists(st.floats(0.001, 0.3), min_size=6, max_size=6),
)
def test_first_covariance_is_symmetric_and_positive(entries, sigmas):
    root = np.array(entries).reshape(6, 6) + 1.5 * np.eye(6)
    correlated = root @ root.T
    scale = np.array(sigmas) / np.sqrt(np.diag(correlated))
    posterior = correlated * np.outer(scale, scale) + 1e-10 * np.eye(6)
    x, P = initial(MEAN, posterior, PRIORS)
    assert np.array_equal(P, P.T)
    # xi starts with no variance: it gets its own with the first block
    rest = np.delete(np.delete(P, XI, 0), XI, 1)
    scaled = rest / np.sqrt(np.outer(np.diag(rest), np.diag(rest)))
    assert np.min(np.linalg.eigvalsh(scaled)) > 0.0
    assert P[XI, XI] == 0.0
    table = list(FROM_TABLE)
    assert np.array_equal(P[np.ix_(table, table)], posterior)
    # what the ramp left open of the ratio is open today as well, and the pads' own change
    assert P[RHO, RHO] == pytest.approx(posterior[5, 5] + PRIORS.ratio**2)
    assert P[RHO, RHO0] == posterior[5, 5]
    assert x[W] == 1.0
    assert x[RHO] == x[RHO0]


def reference(z, time, priors):
    """h/L (z - the mode's answer), by a continuous-time simulation in balance at first."""
    natural = 2.0 * math.pi * priors.pitch_frequency
    mode = ([natural**2], [1.0, 2.0 * priors.pitch_damping * natural, natural**2])
    moved = z[0] + scipy.signal.lsim(mode, z - z[0], time)[1]
    return (z - moved) * H / (L_F + L_R)


@pytest.mark.parametrize("damping", [0.1, 0.3, 0.7])
@pytest.mark.parametrize("frequency", [1.0, 1.6])
def test_pitch_deficit_is_that_of_the_continuous_mode(frequency, damping):
    priors = replace(PRIORS, pitch_frequency=frequency, pitch_damping=damping)
    worst = []
    for rate in (200.0, 1000.0):
        time = np.arange(round(5.0 * rate)) / rate
        z = 0.02 + 0.3 * np.clip((time - 1.0) / 0.25, 0.0, 1.0)
        off = pitch_deficit(CAR, z, 1.0 / rate, priors) - reference(z, time, priors)
        worst.append(np.max(np.abs(off)))
    largest = np.max(np.abs(reference(z, time, priors)))
    assert worst[0] < 0.06 * largest  # about the error of half a sample
    assert worst[1] < 0.25 * worst[0]


@given(z=st.floats(-0.5, 1.0), rate=st.sampled_from([40.0, 200.0, 1000.0]))
def test_pitch_deficit_of_a_constant_deceleration_is_nought(z, rate):
    deficit = pitch_deficit(CAR, np.full(300, z), 1.0 / rate, PRIORS)
    assert np.max(np.abs(deficit)) < 1e-9


def test_pitch_deficit_knows_no_future():
    z = np.random.default_rng(1).normal(size=400)
    other = np.concatenate([z[:200], np.zeros(200)])
    both = [pitch_deficit(CAR, x, 0.005, PRIORS)[:200] for x in (z, other)]
    assert np.array_equal(*both)


def stop(z, *, ratio=0.0, stiffness=25.0, v=True, eta_zero=0.0, slip_zero=0.0, length=0.05):
    """Blocks and demand of a car that decelerates with ``z`` (k,), straight tyre, no noise.

    Everything follows from (2), (6), (7), (19), (20) and (22), written out here.
    """
    end = length * np.arange(1, z.size + 1)
    speed = 30.0 - G * np.cumsum(z) * length
    share = WEIGHT / (L_F + L_R)
    load_f, load_r = share * (L_R + z * H), share * (L_F - z * H)
    braked = z > 0.0
    total = WEIGHT * z
    odds = 2.7 * math.exp(ratio)
    slip_f = total * odds / (1.0 + odds) / load_f / stiffness
    slip_r = total / (1.0 + odds) / load_r / stiffness
    omega_f = speed * (1.0 - slip_f) / R
    omega_r = speed * (1.0 - slip_r) / R * (1.0 + eta_zero)
    pressure = 70e5 * z
    still = np.zeros(z.size)
    blocks = Blocks(
        end, pressure, pressure, z, omega_f, omega_r, speed if v else None, speed,
        still, still, ~braked, 10, length,
    )  # fmt: skip
    mean = load_f / WEIGHT * slip_f + load_r / WEIGHT * slip_r + slip_zero
    demand = SplitInput(
        nominal_f=total * 2.7 / 3.7,
        nominal_r=total / 3.7,
        level=np.where(braked, 1.0, np.nan),
        moment_f=still,
        moment_r=still,
        load_f=load_f,
        load_r=load_r,
        tyre_sum=total,
        slip=mean if v else None,
        psi=still,
    )
    return blocks, demand


def followed(z, mean=MEAN, noise=NOISE, priors=PRIORS, **how):
    blocks, demand = stop(z, **how)
    return filter_pad_ratio(CAR, blocks, demand, noise, mean, COVARIANCE, priors)


STEADY = np.concatenate([np.zeros(30), np.full(100, 0.3)])


@pytest.mark.parametrize("v", [True, False])
def test_nothing_surprises_where_the_model_is_the_truth(v):
    answer = followed(STEADY, v=v)
    assert np.max(np.abs(answer.innovation_eta)) < 1e-9
    if v:
        assert np.max(np.abs(answer.innovation_slip)) < 1e-9
    else:
        assert np.all(np.isnan(answer.innovation_slip))
    assert np.max(np.abs(answer.log_ratio)) < 1e-9
    assert np.max(np.abs(answer.stiffness)) < 1e-9
    assert answer.changes == ()


def test_zeros_are_learnt_on_the_lead_in():
    """A radius mismatch shows at once and surprises no more when the brakes bite."""
    answer = followed(STEADY, eta_zero=0.003, slip_zero=-0.004)
    assert abs(answer.innovation_eta[0]) > 0.2
    assert np.max(np.abs(answer.innovation_eta[30:])) < 0.3
    assert abs(answer.log_ratio[-1]) < 0.02


@pytest.mark.parametrize("ratio", [-0.3, 0.3])
def test_pads_that_differ_are_found_with_v(ratio):
    answer = followed(STEADY, ratio=ratio)
    assert abs(answer.log_ratio[-1] - ratio) < 2.0 * answer.sigma[-1]
    assert answer.sigma[-1] < 0.1
    assert answer.nominal_weight[-1] < 0.1
    assert answer.sigma[-1] < answer.sigma[30]


def test_a_stiffer_road_is_not_blamed_on_the_pads():
    answer = followed(STEADY, stiffness=25.0 * math.exp(0.2))
    assert answer.stiffness[-1] == pytest.approx(0.2, abs=0.05)
    assert abs(answer.log_ratio[-1]) < 1.96 * answer.sigma[-1]


def test_without_v_road_and_pads_stay_entangled():
    """The same eta from softer tyres or from other pads: the interval must hold both."""
    answer = followed(STEADY, ratio=0.2, v=False)
    assert answer.sigma[-1] > 1.5 * followed(STEADY, ratio=0.2).sigma[-1]
    assert abs(answer.log_ratio[-1] - 0.2) < 1.96 * answer.sigma[-1]


def test_past_does_not_know_the_future():
    z = STEADY.copy()
    z[80:] = 0.15
    now, later = followed(STEADY), followed(z, ratio=0.0)
    for name in ("log_ratio", "sigma", "nominal_weight", "stiffness", "xi", "kappa"):
        assert np.array_equal(getattr(now, name)[:80], getattr(later, name)[:80])
    assert np.array_equal(now.innovation_eta[:80], later.innovation_eta[:80])


def test_change_of_road_is_found_in_the_block_where_it_shows():
    blocks, demand = stop(STEADY)
    softer, slips = stop(STEADY, stiffness=17.0)
    after = blocks.end > 4.0
    mixed = replace(blocks, omega_f=np.where(after, softer.omega_f, blocks.omega_f))
    mixed = replace(mixed, omega_r=np.where(after, softer.omega_r, blocks.omega_r))
    told = replace(demand, slip=np.where(after, slips.slip, demand.slip))
    answer = filter_pad_ratio(CAR, mixed, told, NOISE, MEAN, COVARIANCE, PRIORS)
    assert answer.changes
    assert answer.changes[0] == pytest.approx(4.0, abs=0.11)
    assert answer.stiffness[-1] == pytest.approx(math.log(17.0 / 25.0), abs=0.1)
    assert abs(answer.log_ratio[-1]) < 1.96 * answer.sigma[-1]


def test_variances_stay_positive_over_a_long_stop():
    answer = followed(np.concatenate([np.zeros(30), np.full(500, 0.1)]), length=0.05)
    assert np.all(answer.sigma > 0.0)
    assert np.all(np.isfinite(answer.sigma))
    assert np.all((answer.nominal_weight >= 0.0) & (answer.nominal_weight <= 1.0))


def test_an_axle_that_lifts_is_not_taken_in():
    """A glitch of a_x: the load left on the rear axle is negative, and no slip follows from it."""
    blocks, demand = stop(STEADY)
    hit = blocks.end == blocks.end[90]
    glitch = replace(demand, load_r=np.where(hit, -3000.0, demand.load_r))
    answer = filter_pad_ratio(CAR, blocks, glitch, NOISE, MEAN, COVARIANCE, PRIORS)
    assert np.isnan(answer.innovation_eta[90])
    assert np.max(np.abs(answer.innovation_eta[91:])) < 1e-6


def test_wheels_past_their_peak_are_not_taken_in():
    """A block in which the front wheels nearly lock says nothing of any curve."""
    blocks, demand = stop(STEADY)
    locking = (blocks.end > 4.0) & (blocks.end < 4.3)
    hit = replace(blocks, omega_f=np.where(locking, 0.7, 1.0) * blocks.omega_f)
    answer = filter_pad_ratio(CAR, hit, demand, NOISE, MEAN, COVARIANCE, PRIORS)
    assert np.all(np.isnan(answer.innovation_eta[locking]))
    assert abs(answer.log_ratio[-1]) < 1e-6


def textbook(blocks, demand, priors):
    """The filter as a book writes it: F P F' + Q, then one scalar update after the other."""
    x, P = initial(MEAN, COVARIANCE, priors)
    decay = math.exp(-blocks.length / priors.pitch_memory)
    F = np.eye(STATES)
    F[XI, XI] = decay
    states, variances, innovation, changes, pause = [], [], [], [], 0

    def update(x, P, block):
        eta, slip, (H_eta, H_slip) = _predict(x, block)
        first = x, block.eta - eta, H_eta, (eta - 1.0 - x[ETA0], block.var_eta)
        out = []
        for from_x, error, H, (signal, variance) in (
            first,
            (x, block.slip - slip, H_slip, (slip - x[SLIP0], block.var_slip)),
        ):
            if not np.isnan(error):
                error = error - H @ (x - from_x)
                total = H @ P @ H + variance + (block.relative * signal) ** 2
                K = P @ H / total
                x, P = x + K * error, P - np.outer(K, P @ H)
            out.append(error / math.sqrt(total) if not np.isnan(error) else np.nan)
        return x, P, out

    for k, block in enumerate(_steps(CAR, blocks, demand, NOISE, priors)):
        Q_ = np.zeros((STATES, STATES))
        Q_[XI, XI] = (1.0 - decay**2) * block.pitch_variance
        Q_[RHO, RHO], Q_[S, S] = block.drift_ratio, block.drift_surface
        Q_[W, W] = block.drift_surface
        x, P = F @ x, F @ P @ F.T + Q_
        out = [np.nan, np.nan]
        if block.moving:
            pause = max(pause - 1, 0)
            new_x, new_P, out = update(x, P, block)
            if np.nanmean(np.square(out)) > priors.change_gate and block.calm and pause == 0:
                P = P.copy()
                _widen_surface(P, priors, priors.change_stiffness, priors.change_peak)
                new_x, new_P, out = update(x, P, block)
                changes.append(float(blocks.end[k]))
                pause = priors.change_pause
            x, P = new_x, new_P
        states.append(x)
        variances.append([P[RHO, RHO], P[RHO0, RHO0], P[RHO, RHO0], P[S, S], P[XI, XI]])
        innovation.append(out)
    as_arrays = (np.array(states), np.array(variances), np.array(innovation))
    return _answer(*as_arrays, tuple(changes), priors)


@pytest.mark.parametrize("v", [True, False])
def test_the_loop_is_the_filter_of_the_books(v):
    blocks, demand = stop(STEADY, v=v, ratio=0.1, eta_zero=1e-3)
    other, there = stop(STEADY, v=v, ratio=0.1, eta_zero=1e-3, stiffness=12.0)
    random = np.random.default_rng(3)
    late = np.arange(STEADY.size) > 80  # the road changes
    jitter = 1.0 + 2e-4 * random.normal(size=STEADY.size)
    blocks = replace(blocks, omega_r=np.where(late, other.omega_r, blocks.omega_r) * jitter)
    blocks = replace(blocks, omega_f=np.where(late, other.omega_f, blocks.omega_f))
    psi = 0.01 * random.normal(size=STEADY.size)
    slip = np.where(late, there.slip, demand.slip) if v else None
    demand = replace(demand, psi=psi, slip=slip)
    found = filter_pad_ratio(CAR, blocks, demand, NOISE, MEAN, COVARIANCE, PRIORS)
    book = textbook(blocks, demand, PRIORS)
    assert found.changes == book.changes
    assert len(found.changes) >= 1
    for name in ("log_ratio", "sigma", "stiffness", "xi", "kappa", "innovation_eta"):
        one, two = getattr(found, name), getattr(book, name)
        assert np.max(np.abs(one - two)) <= 1e-10 * np.max(np.abs(two)), name
