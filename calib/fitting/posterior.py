r"""The ensemble that explains the ramps.

    prior --> forces over loads --tyre forms--> slips --(22)--> eta, and slip where v is logged

Forms, load exponents, peak, pads' ratio and centre of gravity enter nonlinearly. Given them, eta
and slip are linear in the compliances, the fall of the radii and the zeros: a Gaussian regression
gives these and the evidence of the rest. Beside the noise of the sensors it has a correlated error
of the form (Brynjarsdottir and O'Hagan 2014, doi:10.1088/0266-5611/30/11/114007): no tyre is a mean
of published ones, and it departs alike over a range of forces.

The evidence carries the draws from prior to posterior in steps of equal loss (sequential Monte
Carlo, Del Moral et al. 2006, doi:10.1111/j.1467-9868.2006.00553.x), with moves in between that
leave the prior as it is (preconditioned Crank-Nicolson, Cotter et al. 2013, doi:10.1214/13-STS421).
The sequence of draws is fixed: the same logs give the same table.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import G
from calib.car.tyre_forms import FORMS
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import (
    DEPART_AT,
    PRIORS,
    Ensemble,
    brake_share,
    spread_evenly,
    unit_slips,
)
from calib.model.ramp import RampRun
from calib.table.table import Value

DRAWS = 2048
"""Size of the ensemble: its 2.5 % quantile is known to a tenth of a sigma."""

_GROUPS = 14  # points of a ramp: a tyre departs alike from its form over two of them
_ZERO = 3.0  # time before the bite over which eta and slip are zeroed [s]
_SPARSE = 0.6  # concentration of the forms' weights: two or three make up most of a tyre
_GRADE = 0.001  # walk of bias and slope [1/sqrt(s)]
_CLOCK = 0.01  # sigma of the time by which v is late against the wheels [s]
_WALKED = 5e-5  # sigma of what the zero of eta walked since the lead-in [1]
_SLOW = 5.0  # speed below which a ramp tells little [m/s]
_FINEST = 5e-4  # eta - 1 or slip below which an error of the form is no smaller [1]
_ROUGH = 0.02  # share of the variance of that error that is not alike from point to point
_NONLINEAR = (
    "load_exponent",
    "peak_load_exponent",
    "log_peak",
    "log_pad_ratio",
    "cg_to_front_axle",
    "cg_height",
)


@dataclass(frozen=True)
class _Ramp:
    """One ramp, zeroed on its lead-in: means of groups of blocks, (k,) each.

    ``brake`` brake force of both axles over the weight, ``moment_f``, ``moment_r`` other moments;
    ``log_odds`` of the axles' pressures; ``alone`` share of the front axle where one axle brakes
    alone, else None. ``own`` (k, m) is what else moves the slip, linearly, with ``own_mean`` and
    ``own_sigma`` (m,): with v its zero and the time by which v is late; without v the slip is what
    the wheels lose against the speed that a_x carries on: scale and offset of a_x and that speed.
    Variances are those of the sensors, ``zero_eta`` sigma of the zero of eta.
    """

    z: Array
    brake: Array
    moment_f: Array
    moment_r: Array
    log_odds: Array
    alone: float | None
    eta: Array
    eta_variance: Array
    slip: Array
    slip_covariance: Array
    own: Array
    own_mean: Array
    own_sigma: Array
    zero_eta: float


def _ramp(car: Vehicle, run: RampRun) -> _Ramp:
    b, noise = run.blocks, run.noise
    lead = np.flatnonzero(b.lead_in & run.use)[-round(_ZERO / b.length) :]
    at = np.flatnonzero(run.braked & (b.speed > _SLOW))
    groups = np.array_split(at, min(_GROUPS, at.size))
    time, rolled = np.array([g.size for g in groups]) * b.length, lead.size * b.length

    def mean(x: Array) -> Array:
        return np.array([np.mean(x[g]) for g in groups])

    def zeroed(x: Array) -> Array:
        return mean(x) - np.mean(x[lead])

    wheels = noise.omega / mean(b.omega_f)
    zero_wheels = noise.omega / np.mean(b.omega_f[lead]) / np.sqrt(rolled)
    eta_zero = float(np.mean(b.eta[lead]))
    if run.slip is None:
        slip, covariance, own, own_mean, own_sigma = _carried_on(car, run, lead, groups, eta_zero)
    else:
        speed = mean(b.speed)
        slip, own_mean = zeroed(run.slip), np.zeros(2)
        covariance = np.diag((wheels**2 + (noise.v / speed) ** 2) / time)
        own = np.stack([np.ones_like(speed), G * mean(b.z) / speed], axis=1)
        zero_v = noise.v / np.mean(b.speed[lead]) / np.sqrt(rolled)
        own_sigma = np.array([np.hypot(zero_wheels, zero_v), _CLOCK])
    B_f, B_r = (mean(np.maximum(p, 1.0)) for p in (b.p_f, b.p_r))
    # the loads of the run, as known effects move them, are those of this deceleration
    moved = run.load_f * car.wheelbase / car.weight - car.cg_to_rear_axle
    return _Ramp(
        z=mean(moved) / car.cg_height,
        brake=zeroed(run.brake_sum) / car.weight,
        moment_f=zeroed(run.moment_f) / car.weight,
        moment_r=zeroed(run.moment_r) / car.weight,
        log_odds=np.log(B_f / B_r),
        alone={None: None, "f": 1.0, "r": 0.0}[run.only],
        eta=mean(b.eta) / eta_zero - 1.0,
        eta_variance=2.0 * wheels**2 / time,
        slip=slip,
        slip_covariance=covariance,
        own=own,
        own_mean=own_mean,
        own_sigma=own_sigma,
        zero_eta=float(np.hypot(np.sqrt(2.0) * zero_wheels, _WALKED)),
    )


def _carried_on(
    car: Vehicle, run: RampRun, lead: Index, groups: list[Index], eta_zero: float
) -> tuple[Array, Array, Array, Array, Array]:
    """Slip by a speed that a_x carries on from the lead-in, as `_Ramp` has it.

    v = v_0 - g int (1 - e) (z - o) dt, and the wheels turn at v (1 - slip): as v goes to zero the
    slip's part vanishes and that of the scale e does not.
    """
    b, noise, R = run.blocks, run.noise, car.front.rolling_radius
    rear = 1.0 - run.load_f / car.weight
    rim = R * b.omega_f * (1.0 + rear * (b.eta / eta_zero - 1.0))
    time = b.end - b.end[lead[-1]]
    slope, v_0 = np.polyfit(time[lead], rim[lead], 1)
    offset = np.mean(b.z[lead]) + slope / G
    lost = np.cumsum(np.where(time > 0.0, G * (b.z - offset) * b.length, 0.0))
    t, gone, u = (np.array([np.mean(x[g]) for g in groups]) for x in (time, lost, rim))
    length = np.array([g.size for g in groups]) * b.length
    v = u * (1.0 + PRIORS["compliance"][0] * np.array([np.mean(b.z[g]) for g in groups]))
    wheel = noise.omega * R
    sooner, later = np.minimum(t[:, None], t), np.maximum(t[:, None], t)
    walk = _GRADE**2 * (sooner**3 / 3.0 + sooner**2 * (later - sooner) / 2.0)
    covariance = G**2 * (noise.z**2 * sooner + walk) / np.outer(v, v)
    covariance += np.diag((wheel / v) ** 2 / length)
    rolled = lead.size * b.length
    slope_sigma = np.sqrt(12.0 * wheel**2 / rolled**3 + (G * noise.z) ** 2 / rolled) / G
    own = np.stack([-gone / v, -G * t / v, 1.0 / v], axis=1)
    scale = PRIORS["a_x_scale"]
    mean = np.array([scale[0], 0.0, 0.0])
    sigma = np.array([scale[1], slope_sigma, 2.0 * wheel / np.sqrt(rolled)])
    return (v_0 - gone - u) / v, covariance, own, mean, sigma


def _from_normal(x: Array, ratio: Value) -> Ensemble:
    """The prior's draws (n, 5 + 6) from standard normal ones; unit compliances."""
    from scipy.special import gammaincinv, ndtr

    amount = gammaincinv(_SPARSE, np.clip(ndtr(x[:, : len(FORMS)]), 1e-12, 1.0 - 1e-12)) + 1e-12
    priors = PRIORS | {"log_pad_ratio": (ratio.value, ratio.sigma)}
    drawn = {
        name: priors[name][0] + priors[name][1] * column
        for name, column in zip(_NONLINEAR, x[:, len(FORMS) :].T, strict=True)
    }
    one = np.ones(x.shape[0])
    return Ensemble(
        forms=amount / amount.sum(axis=1, keepdims=True),
        load_exponent=drawn["load_exponent"],
        peak_load_exponent=drawn["peak_load_exponent"],
        peak=np.exp(drawn["log_peak"]),
        log_pad_ratio=drawn["log_pad_ratio"],
        cg_to_front_axle=np.exp(drawn["cg_to_front_axle"]),
        cg_height=np.exp(drawn["cg_height"]),
        compliance_f=one,
        compliance_r=one,
        radius_load=one,
        v_late=0.0 * one,
        depart_eta=np.zeros((one.size, DEPART_AT.size)),
        depart_slip=np.zeros((one.size, DEPART_AT.size)),
    )


class _Regression:
    """Eta and slip of all ramps, linear in (compliances, fall of the radii, zeros and clocks).

    Rows: eta of each ramp, then slip of those with v. The covariance hangs on the data alone, so
    that all draws share one whitening.
    """

    def __init__(self, car: Vehicle, ramps: list[_Ramp]) -> None:
        self.car, self.ramps = car, ramps
        sizes = [r.own_sigma.size for r in ramps]
        size = 3 + len(ramps) + sum(sizes)
        mean, sigma = PRIORS["compliance"]
        apart = PRIORS["log_tyre_ratio"][1] * mean
        prior = np.zeros((size, size))
        prior[:2, :2] = sigma**2 + 0.25 * apart**2 * np.array([[1.0, -1.0], [-1.0, 1.0]])
        prior[2, 2] = PRIORS["radius_load"][1] ** 2
        own = np.concatenate([[r.zero_eta for r in ramps], *(r.own_sigma for r in ramps)])
        prior[np.arange(3, size), np.arange(3, size)] = own**2
        self.precision = np.linalg.inv(prior)
        self.start = np.zeros(size)
        self.start[:3] = mean, mean, PRIORS["radius_load"][0]
        self.start[3 + len(ramps) :] = np.concatenate([r.own_mean for r in ramps])
        self.white = np.linalg.inv(np.linalg.cholesky(self._covariance()))

    def _covariance(self) -> Array:
        """Of the rows: sensors, and the correlated error of the form over the deceleration."""
        from scipy.linalg import block_diag

        parts = [(r, r.eta, "eta") for r in self.ramps] + [(r, r.slip, "slip") for r in self.ramps]
        z = np.concatenate([r.z for r, *_ in parts])
        size = np.concatenate(
            [np.maximum(np.abs(x), _FINEST) * PRIORS[f"form_error_{of}"][0] for _, x, of in parts]
        )
        kinds = [(of, r.alone) for r, _, of in parts]
        kind = np.repeat([kinds.index(k) for k in kinds], [r.z.size for r, *_ in parts])
        near = _near(z, z) * (kind[:, None] == kind) + _ROUGH * np.eye(z.size)
        self.departs = {
            of: size * np.repeat([k == (of, None) for k in kinds], [r.z.size for r, *_ in parts])
            for of in ("eta", "slip")
        }
        self.places = z
        sensors = [np.diag(r.eta_variance) for r in self.ramps]
        sensors += [r.slip_covariance for r in self.ramps]
        return np.asarray(size[:, None] * size * near + block_diag(*sensors))

    def rows(self, e: Ensemble) -> tuple[Array, Array, Mask]:
        """Design (n, k, p), data (n, k), and whether all forces are below the peaks (n,)."""
        etas, slips, data_eta, data_slip = [], [], [], []
        rolls = np.ones(e.size, dtype=bool)
        size = self.start.size
        own = 3 + len(self.ramps)
        for i, r in enumerate(self.ramps):
            share = (
                brake_share(self.car, e.log_pad_ratio[:, None], r.log_odds)
                if r.alone is None
                else np.full((e.size, 1), r.alone)
            )
            unit = unit_slips(
                self.car, e, r.z, share * r.brake + r.moment_f, (1.0 - share) * r.brake + r.moment_r
            )
            rolls &= unit.rolls.all(axis=1)
            one = np.zeros((e.size, r.z.size, size))
            one[..., 0], one[..., 1] = unit.front, -unit.rear
            one[..., 2], one[..., 3 + i] = unit.grown_r - unit.grown_f, 1.0
            etas.append(one)
            data_eta.append(r.eta * (1.0 - PRIORS["compliance"][0] * unit.front))
            two = np.zeros_like(one)
            two[..., 0], two[..., 1] = unit.share * unit.front, (1.0 - unit.share) * unit.rear
            two[..., 2] = -unit.share * unit.grown_f - (1.0 - unit.share) * unit.grown_r
            two[..., own : own + r.own_sigma.size] = r.own
            own += r.own_sigma.size
            slips.append(two)
            data_slip.append(np.broadcast_to(r.slip, unit.front.shape))
        return np.concatenate(etas + slips, 1), np.concatenate(data_eta + data_slip, 1), rolls

    def solve(self, e: Ensemble) -> tuple[Array, Array, Array]:
        """Log evidence (n,), mean (n, p) and precision (n, p, p) of the linear parameters."""
        H, y, rolls = self.rows(e)
        H, y = self.white @ H, y @ self.white.T
        A = H.transpose(0, 2, 1) @ H + self.precision
        g = np.einsum("nkp,nk->np", H, y) + self.precision @ self.start
        mean = np.linalg.solve(A, g[..., None])[..., 0]
        square = np.einsum("nk,nk->n", y, y) - np.einsum("np,np->n", g, mean)
        log = -0.5 * (square + np.linalg.slogdet(A)[1])
        possible = rolls & np.all(mean[:, :2] > 0.0, axis=1)
        return np.where(possible, log, -np.inf), mean, A

    def late(self, linear: Array) -> Array:
        """Time by which v is late [s] (n,), mean of the runs that have v; 0 without any."""
        at = 3 + len(self.ramps) + np.cumsum([0, *(r.own_sigma.size for r in self.ramps)])
        with_v = [int(k) + 1 for k, r in zip(at, self.ramps, strict=False) if r.own_sigma.size == 2]
        return np.asarray(linear[:, with_v].sum(axis=1) / max(len(with_v), 1))

    def departures(self, e: Ensemble, linear: Array) -> dict[str, Array]:
        """Relative departure of eta - 1 and slip from the forms at `DEPART_AT`, (n, k) each.

        The mean of the correlated error, given what the draws with ``linear`` (n, p) leave.
        """
        H, y, _ = self.rows(e)
        left = (y - np.einsum("nkp,np->nk", H, linear)) @ self.white.T @ self.white
        near = _near(self.places, DEPART_AT)
        return {
            of: PRIORS[f"form_error_{of}"][0] * (left * size) @ near
            for of, size in self.departs.items()
        }


def _near(x: Array, y: Array) -> Array:
    """How alike a tyre departs from its form at two decelerations, (n, k)."""
    return np.asarray(np.exp(-0.5 * ((x[:, None] - y) / PRIORS["form_length"][0]) ** 2))


def posterior(car: Vehicle, runs: list[RampRun], ratio: Value, draws: int = DRAWS) -> Ensemble:
    """The ensemble given the ramps ``runs``; ``ratio`` what is known of the pads' ratio before.

    Raises ValueError where no draw of the prior explains the ramps at all.
    """
    from scipy.special import ndtri

    regression = _Regression(car, [_ramp(car, run) for run in runs])
    dimension = len(FORMS) + len(_NONLINEAR)
    rng = np.random.default_rng(40)
    start = ndtri(spread_evenly(draws, dimension))

    def log_evidence(x: Array) -> Array:
        return regression.solve(_from_normal(x, ratio))[0]

    x = _carried(start, log_evidence, rng)
    e = _from_normal(x, ratio)
    _, mean, A = regression.solve(e)
    # precision A = C C': mean + C'^-1 noise has covariance A^-1
    noise = rng.standard_normal(mean.shape)[..., None]
    found = mean + np.linalg.solve(np.linalg.cholesky(A).transpose(0, 2, 1), noise)[..., 0]
    departs = regression.departures(e, found)
    front, rear = np.maximum(found[:, :2].T, 0.1 * PRIORS["compliance"][0])
    return Ensemble(
        **{
            **vars(e),
            "compliance_f": front,
            "compliance_r": rear,
            "radius_load": found[:, 2],
            "v_late": regression.late(found),
            "depart_eta": departs["eta"],
            "depart_slip": departs["slip"],
        }
    )


_LOSS = 0.5  # share of the draws that count after a step
_STRIDE = 0.4  # of a move
_MOVES, _MOST_MOVES = 0.8, 6  # accepted moves of a draw between two steps, and tries


def _carried(x: Array, log_evidence: Callable[[Array], Array], rng: np.random.Generator) -> Array:
    """Draws ``x`` (n, d) of a standard normal carried to the posterior."""
    log, power = log_evidence(x), 0.0
    if not np.any(np.isfinite(log)):
        raise ValueError("no draw of the prior explains the ramps")
    while power < 1.0:
        step = _step(log, 1.0 - power)
        weight = np.exp(step * (log - log.max()))
        at = np.searchsorted(
            np.cumsum(weight) / weight.sum(), (np.arange(log.size) + rng.random()) / log.size
        )
        at = np.minimum(at, log.size - 1)
        x, log, power = x[at], log[at], power + step
        moved = 0.0
        for _ in range(_MOST_MOVES):
            other = np.sqrt(1.0 - _STRIDE**2) * x + _STRIDE * rng.standard_normal(x.shape)
            better = log_evidence(other)
            take = np.log(rng.random(log.size)) < power * (better - log)
            x, log = np.where(take[:, None], other, x), np.where(take, better, log)
            moved += float(np.mean(take))
            if moved > _MOVES:
                break
    return x


def _step(log: Array, most: float) -> float:
    """Power of the evidence after which the share `_LOSS` of the draws counts, at most ``most``."""

    def counting(power: float) -> float:
        weight = np.exp(power * (log - log.max()))
        return float(weight.sum() ** 2 / (weight @ weight) / log.size)

    if counting(most) >= _LOSS:
        return most
    low, high = 0.0, most
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if counting(middle) >= _LOSS else (low, middle)
    return high
