"""The split between the axles: an extended Kalman filter over everything that is uncertain.

The level says what both axles brake together; the filter says how it is split. Its state carries
the pads' ratio and all that could be mistaken for it:

    rho        ln of the pads' ratio front over rear, relative to nominal
    s, w       the surface: stiffness and peak relative to the table's (`calib.physics.tyre`)
    kappa      share of the load transfer that follows the body's pitch mode
    xi         load moved otherwise than that, over W (a Gauss-Markov process)
    eta0, sl0  zeros of eta and of the slip: radii of this day
    lag        clock offset between v and the wheels [s]
    q c b2 b3  the table's tyre, and
    rho0       the table's pad ratio, with the covariance of the fit

Measured every block: eta always, the mean slip where v is known. In front of the first braking the
same equations zero eta and the slip. A pad ratio that cannot be told from the table's is given back
as the table's (`calib.statistics.mixture_posterior`).

Causal; one step a block. Not for ABS, for a turn, or beyond the tyre's peak.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.names import G
from calib.physics.braking import MOVING
from calib.physics.vehicle import Vehicle
from calib.signals.blocks import Blocks
from calib.signals.filters import low_pass
from calib.signals.noise import SensorNoise
from calib.statistics.mixture_posterior import mixture_posterior

Array = NDArray[np.float64]

RHO, S, W, XI, KAPPA, ETA0, SLIP0, LAG, Q, C, B2, B3, RHO0 = range(13)
STATES = 13
FROM_TABLE = (C, B2, B3, Q, LAG, RHO0)
"""Where the table's posterior (`calib.fitting.identify.PARAMETERS`) goes."""


@dataclass(frozen=True)
class Priors:
    """What is believed before the stop. Each with its reason; tests/studies/coverage.py tries them.

    ``ratio`` sigma of rho when the pads do not change alike: a wet front and a dry rear pad differ
    by a quarter. ``ratio_odds`` odds that they do change alike, within ``ratio_alike``.
    ``stiffness`` sigma of s: tile to dry asphalt spans 0.6 to 1.1. ``peak_per_stiffness``,
    ``peak``: a softer surface also peaks earlier; mean of w - 1 per unit of s, and sigma around it.
    ``zero`` radii agree within 1 %.
    ``pitch_frequency`` [Hz], ``pitch_damping`` of a usual body (Gillespie, ch. 5); ``kappa``,
    ``kappa_sigma`` how much of the load transfer goes through it: none on a stiff car, nearly all
    without anti-dive. ``pitch`` what else is late or too far, per unit of what a filter of
    ``pitch_time`` [s] holds back; ``pitch_memory`` [s] how long it lasts. ``drift`` random walk of
    rho, s and w [1/sqrt(s)]. ``sync`` [s] misalignment of pressure and wheels while pressure moves.
    ``model`` relative error of a predicted slip. ``foreign`` error of the ratio per unit of s: on a
    strange surface the two axles need not share one curve.
    """

    ratio: float = 0.25
    ratio_odds: float = 1.0
    ratio_alike: float = 0.02
    stiffness: float = 0.35
    peak_per_stiffness: float = -5.0
    peak: float = 1.0
    zero: float = 0.01
    pitch_frequency: float = 1.3
    pitch_damping: float = 0.3
    kappa: float = 0.4
    kappa_sigma: float = 0.4
    pitch: float = 0.25
    pitch_time: float = 0.6
    pitch_memory: float = 0.3
    drift_ratio: float = 0.01
    drift_surface: float = 0.02
    sync: float = 0.02
    model: float = 0.02
    foreign: float = 0.25
    change_gate: float = 12.0
    change_stiffness: float = 0.15
    change_peak: float = 0.5
    change_calm: float = 0.03
    change_pause: int = 4


@dataclass(frozen=True)
class PadRatio:
    """The filter's answer per block, shapes (k,), [1].

    ``log_ratio`` rho with ``sigma``; ``nominal_weight`` that the pads have the table's ratio;
    ``stiffness`` s; ``xi``, ``kappa`` of the load transfer; ``innovation_eta``,
    ``innovation_slip`` over their sigma (NaN where not measured); ``changes`` times of surface
    changes [s].
    """

    log_ratio: Array
    sigma: Array
    nominal_weight: Array
    stiffness: Array
    stiffness_sigma: Array
    xi: Array
    kappa: Array
    innovation_eta: Array
    innovation_slip: Array
    changes: tuple[float, ...]


@dataclass(frozen=True)
class SplitInput:
    """What the filter is told of each block besides the sensors, shapes (k,).

    ``nominal_f``, ``nominal_r`` brake forces of nominal pads [N]; ``level`` common factor on them
    (NaN: not braked); ``moment_f``, ``moment_r`` other forces at the road [N]; ``load_f``,
    ``load_r`` [N]; ``tyre_sum`` all tyre forces [N]; ``slip`` measured mean slip [1] or None;
    ``psi`` load that the pitch mode has not yet moved, over W [1] (`pitch_deficit`).
    """

    nominal_f: Array
    nominal_r: Array
    level: Array
    moment_f: Array
    moment_r: Array
    load_f: Array
    load_r: Array
    tyre_sum: Array
    slip: Array | None
    psi: Array


def initial(mean: Array, covariance: Array, priors: Priors) -> tuple[Array, Array]:
    """State and covariance before the stop, from the table's posterior."""
    x, P = np.zeros(STATES), np.zeros((STATES, STATES))
    table = list(FROM_TABLE)
    x[table], P[np.ix_(table, table)] = mean, covariance
    x[W] = 1.0
    x[KAPPA] = priors.kappa
    # the pads of today: the table's ratio, and free around it
    x[RHO] = x[RHO0]
    P[RHO, :] = P[RHO0, :]
    P[:, RHO] = P[:, RHO0]
    P[RHO, RHO] = P[RHO0, RHO0] + priors.ratio**2
    _widen_surface(P, priors, priors.stiffness, priors.peak)
    P[KAPPA, KAPPA] = priors.kappa_sigma**2
    P[ETA0, ETA0] = P[SLIP0, SLIP0] = priors.zero**2
    return x, P


def _widen_surface(P: Array, priors: Priors, stiffness: float, peak: float) -> None:
    k, v = priors.peak_per_stiffness, stiffness**2
    P[S, S] += v
    P[S, W] += k * v
    P[W, S] += k * v
    P[W, W] += k * k * v + peak**2


def filter_pad_ratio(
    vehicle: Vehicle,
    b: Blocks,
    demand: SplitInput,
    noise: SensorNoise,
    mean: Array,
    covariance: Array,
    priors: Priors,
) -> PadRatio:
    """Run the filter over the blocks of a stop."""
    x, P = initial(mean, covariance, priors)
    steps = _steps(vehicle, b, demand, noise, priors)
    decay = math.exp(-b.length / priors.pitch_memory)
    grown = _growth(steps, 1.0 - decay * decay)
    count = b.end.size
    states, variances = np.empty((count, STATES)), np.empty((count, len(KEPT)))
    innovation = np.full((count, 2), np.nan)
    changes: list[float] = []
    # views of P, taken once: the loop changes P in place and never replaces it
    row_xi, column_xi, flat = P[XI], P[:, XI], P.reshape(-1)
    diagonal = flat[:: STATES + 1]
    before_x, before_P = np.empty_like(x), np.empty_like(P)
    pause = 0
    for k, step in enumerate(steps):
        x[XI] *= decay
        row_xi *= decay
        column_xi *= decay
        diagonal += grown[k]
        if step.moving and _carried(now := x.tolist(), step):
            pause = max(pause - 1, 0)
            alert = step.calm and pause == 0
            if alert:
                before_x[:], before_P[:] = x, P
            surprise = _measure(x, P, now, step, innovation[k])
            if alert and surprise > priors.change_gate:
                # the road has changed: what was learnt of the pads must not take the blame
                x[:], P[:] = before_x, before_P
                _widen_surface(P, priors, priors.change_stiffness, priors.change_peak)
                _measure(x, P, now, step, innovation[k])
                changes.append(float(b.end[k]))
                pause = priors.change_pause
        states[k] = x
        variances[k] = flat[KEPT]
    return _answer(states, variances, innovation, tuple(changes), priors)


KEPT = np.array(
    [i * STATES + j for i, j in ((RHO, RHO), (RHO0, RHO0), (RHO, RHO0), (S, S), (XI, XI))]
)
"""The variances that the answer needs, as places in the flat covariance."""


def _growth(steps: "list[_Step]", fresh: float) -> Array:
    """What every block adds to the diagonal of the covariance, shape (k, STATES)."""
    out = np.zeros((len(steps), STATES))
    out[:, XI] = [fresh * step.pitch_variance for step in steps]
    out[:, RHO] = [step.drift_ratio for step in steps]
    out[:, S] = out[:, W] = [step.drift_surface for step in steps]
    return out


@dataclass(slots=True)
class _Step:
    """The numbers of one block as plain floats (flags too): the loop touches no array twice."""

    brake_f: float
    brake_r: float
    level: float
    moment_f: float
    moment_r: float
    load_f: float
    load_r: float
    free: float
    weight: float
    eta: float
    slip: float
    lag_gain: float
    var_eta: float
    var_slip: float
    relative: float
    pitch_variance: float
    psi: float
    drift_ratio: float
    drift_surface: float
    moving: float
    calm: float


def _steps(
    vehicle: Vehicle, b: Blocks, d: SplitInput, noise: SensorNoise, priors: Priors
) -> list[_Step]:
    held = np.abs(b.z - low_pass(b.z, b.length, priors.pitch_time))
    transfer = vehicle.cg_height / vehicle.wheelbase
    p = np.maximum(b.p_f, b.p_r)
    rate = np.abs(np.diff(p, prepend=p[0])) / b.length
    braked = np.isfinite(d.level)
    relative = priors.model + np.where(braked, priors.sync * rate / np.maximum(p, 3e5), 0.0)
    speed = np.maximum(b.speed, 1.0)
    omega = np.maximum(b.omega_f, 1.0)
    sensor = noise.omega**2 / omega**2 / b.length
    count = b.end.size
    columns = (
        d.nominal_f,
        d.nominal_r,
        np.nan_to_num(d.level),
        d.moment_f,
        d.moment_r,
        d.load_f,
        d.load_r,
        d.tyre_sum / vehicle.weight,
        np.full(count, vehicle.weight),
        b.eta,
        np.full(count, np.nan) if d.slip is None else d.slip,
        G * b.z / speed,
        2.0 * sensor,
        sensor + noise.v**2 / speed**2 / b.length,
        relative,
        (priors.pitch * held * transfer) ** 2,
        d.psi,
        np.full(count, priors.drift_ratio**2 * b.length),
        np.full(count, priors.drift_surface**2 * b.length),
        (b.speed > MOVING) & _rolling(b, d.slip),
        held < priors.change_calm,
    )
    return [_Step(*row) for row in np.column_stack(columns).tolist()]


ROLLING = 0.08
"""Slip or eta - 1 [1] past which a tyre is beyond its peak, or a wheel locks: no curve holds."""


def _rolling(b: Blocks, slip: Array | None) -> NDArray[np.bool_]:
    """Blocks in which all wheels roll on the rising branch of their tyres."""
    ok = np.abs(b.eta - 1.0) < ROLLING
    return np.asarray(ok if slip is None else ok & (np.abs(slip) < ROLLING))


def pitch_deficit(vehicle: Vehicle, z: Array, step: float, priors: Priors) -> Array:
    """Load over W [1] that a body with the priors' pitch mode has not yet moved to the front.

    h/L (z - G z), G a damped second-order mode of unit gain, discretised by the matched transform;
    starts in balance. The body's mode differs from the priors' by what ``xi`` takes up.
    """
    from scipy.signal import lfilter

    natural = 2.0 * math.pi * priors.pitch_frequency
    radius = math.exp(-priors.pitch_damping * natural * step)
    angle = natural * math.sqrt(1.0 - priors.pitch_damping**2) * step
    a1, a2 = -2.0 * radius * math.cos(angle), radius * radius
    gain = 1.0 + a1 + a2
    # the state that a constant z[0] would leave
    start = [(1.0 - gain) * z[0], -a2 * z[0]]
    moved = lfilter([gain], [1.0, a1, a2], z, zi=start)[0]
    return np.asarray((z - moved) * vehicle.cg_height / vehicle.wheelbase)


def _carried(x: list[float], step: _Step) -> bool:
    """Both axles are on the road; with one lifted, a_x had a glitch and no load is known."""
    moved = (x[XI] + x[KAPPA] * step.psi) * step.weight
    return -step.load_r < moved < step.load_f


def _measure(x: Array, P: Array, now: list[float], step: _Step, innovation: Array) -> float:
    """Take in eta and, where there is one, the slip; return the mean squared innovation.

    ``now`` is x as plain floats.
    """
    eta, slip, rows = _predict(now, step)
    relative = step.relative
    along = rows.dot(P)
    (var_eta, both), (_, var_slip) = along.dot(rows.T).tolist()
    var_eta += step.var_eta + (relative * (eta - 1.0 - now[ETA0])) ** 2
    root = math.sqrt(var_eta)
    first = innovation[0] = (step.eta - eta) / root
    turn = second = scale = 0.0
    if not math.isnan(step.slip):
        # what eta has not said of the slip
        turn = both / var_eta
        var_slip += step.var_slip + (relative * (slip - now[SLIP0])) ** 2 - both * turn
        scale = 1.0 / math.sqrt(var_slip)
        second = innovation[1] = (step.slip - slip - turn * root * first) * scale
    white = np.array(((1.0 / root, 0.0), (-turn * scale, scale))).dot(along)
    x += np.array((first, second)).dot(white)
    P -= white.T.dot(white)
    return (first * first + second * second) / (2.0 if scale else 1.0)


def _predict(x: list[float], step: _Step) -> tuple[float, float, Array]:
    """Eta and mean slip, and their gradients as rows, shape (2, STATES).

    F_f = (phi B + moment)/(F_zf - (xi + kappa psi) W), slip by `calib.physics.tyre`, eta by (22).
    """
    rho, s, w, xi, kappa, eta0, slip0, lag, q, c, b2, b3, _ = x
    W_, psi, lag_gain = step.weight, step.psi, step.lag_gain
    moved = (xi + kappa * psi) * W_
    load_f, load_r = step.load_f - moved, step.load_r + moved
    half = math.exp(0.5 * rho)
    B_f, B_r = step.brake_f * half, step.brake_r / half
    carried = step.level > 0.0  # the brakes give forces; unbraked, the normalised force is given
    if carried:
        phi = B_f / (B_f + B_r)
        total = step.level * (step.brake_f + step.brake_r)
        turn = phi * (1.0 - phi) * total
        F_f = (phi * total + step.moment_f) / load_f
        F_r = ((1.0 - phi) * total + step.moment_r) / load_r
    else:
        turn, F_f, F_r = 0.0, step.free, step.free
    curve = (math.exp(c - s), w, q, b2, b3, W_, carried)
    slip_f, f0, f1, f2, f3, f4, f5, f6, f7 = _axle(F_f, load_f, 1.0, turn, curve)
    slip_r, r0, r1, r2, r3, r4, r5, r6, r7 = _axle(F_r, load_r, -1.0, turn, curve)
    ratio = (1.0 - slip_r) / (1.0 - slip_f)
    a, r = (1.0 + eta0) * ratio / (1.0 - slip_f), (1.0 + eta0) / (1.0 - slip_f)
    share = step.load_f / W_
    rest = 1.0 - share
    e3, p3 = a * f3 - r * r3, share * f3 + rest * r3
    rows = np.array(
        [
            *(a * f0 - r * r0, a * f1 - r * r1, a * f2 - r * r2, e3, psi * e3, ratio, 0.0, 0.0),
            *(a * f4 - r * r4, a * f5 - r * r5, a * f6 - r * r6, a * f7 - r * r7, 0.0),
            *(share * f0 + rest * r0, share * f1 + rest * r1, share * f2 + rest * r2),
            *(p3, psi * p3, 0.0, 1.0, lag_gain, share * f4 + rest * r4),
            *(share * f5 + rest * r5, share * f6 + rest * r6, share * f7 + rest * r7, 0.0),
        ]
    ).reshape(2, STATES)
    mean = share * slip_f + rest * slip_r + slip0 + lag_gain * lag
    return (1.0 + eta0) * ratio, mean, rows


def _axle(
    F: float, load: float, sign: float, turn: float, curve: tuple[float, ...]
) -> tuple[float, ...]:
    """Slip of an axle (`calib.physics.tyre`), and its gradient over rho, s, w, xi, q, c, b2, b3."""
    stiffness, w, q, b2, b3, W_, carried = curve
    relative = 2.0 * load / W_
    E = stiffness * relative**q
    u = F * w
    slip = E * F * (1.0 + b2 * u + b3 * u * u)
    slope = E * (1.0 + 2.0 * b2 * u + 3.0 * b3 * u * u)
    return (
        slip,
        slope * sign * turn / load,
        -slip,
        E * F * F * (b2 + 2.0 * b3 * u),
        sign * W_ / load * (slope * F * carried - slip * q),
        slip * math.log(relative),
        slip,
        E * F * u,
        E * F * u * u,
    )


def _answer(
    x: Array, v: Array, innovation: Array, changes: tuple[float, ...], priors: Priors
) -> PadRatio:
    """Weigh rho against the table's rho0 and add what a strange surface leaves open."""
    foreign = (priors.foreign * x[:, S]) ** 2
    deviation = x[:, RHO] - x[:, RHO0]
    variance = np.maximum(v[:, 0] + v[:, 1] - 2.0 * v[:, 2], 1e-12) + foreign
    found = mixture_posterior(
        deviation, np.sqrt(variance), priors.ratio, priors.ratio_odds, priors.ratio_alike
    )
    # rho given the deviation: the rest of it moves along its correlation with the deviation
    along = (v[:, 0] - v[:, 2] + foreign) / variance
    mean = x[:, RHO] + along * (found.mean - deviation)
    rest = np.maximum(v[:, 0] + foreign - along**2 * variance, 0.0)
    return PadRatio(
        log_ratio=mean,
        sigma=np.sqrt(rest + along**2 * found.sigma**2),
        nominal_weight=found.nominal_weight,
        stiffness=x[:, S],
        stiffness_sigma=np.sqrt(np.maximum(v[:, 3], 0.0)),
        xi=x[:, XI],
        kappa=x[:, KAPPA],
        innovation_eta=innovation[:, 0],
        innovation_slip=innovation[:, 1],
        changes=changes,
    )
