"""What the ramps show of a draw: eta and slip, linear in its compliances and the fall of its radii.

    rows = H (c_f, c_r, fall) + error        H by the forces over the loads, the form of the tyres

All else that moves them is an error of a known size: noise of the sensors, zeros and clock of the
run, scale of a_x, and a correlated error of the form (Brynjarsdottir and O'Hagan 2014,
doi:10.1088/0266-5611/30/11/114007): no tyre is a mean of published ones, and it departs alike over
a range of forces.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import G
from calib.car.bias import front_share
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import DEPART_AT, PRIORS, Ensemble, unit_slips
from calib.model.ramp import RampRun

_GROUPS = 14  # points of a ramp: a tyre departs alike from its form over two of them
_GRADE = 0.001  # walk of bias and slope [1/sqrt(s)]
_CLOCK = 0.01  # sigma of the time by which v is late against the wheels [s]
_WALKED = 5e-5  # sigma of what the zero of eta walked since the lead-in [1]
_SLOW = 5.0  # speed below which a ramp tells little [m/s]
_FINEST = 5e-4  # eta - 1 or slip below which an error of the form is no smaller [1]
_ROUGH = 0.02  # share of the variance of that error that is not alike from point to point


@dataclass(frozen=True)
class _Ramp:
    """One ramp, zeroed on its lead-in: means of groups of blocks, (k,) each.

    ``brake`` brake force of both axles over the weight, ``moment_f``, ``moment_r`` other moments
    and ``rolling`` deceleration and moments of the lead-in, (3,), not zeroed;
    ``log_odds`` of the axles' pressures; ``alone`` share of the front axle where one axle brakes
    alone, else None. Without v ``slip`` is what the wheels lose against the speed that a_x carries
    on. Variances are those of the sensors. Else there is, of one standard deviation, ``zero_eta``;
    what an error makes of the slip, (k, m): its ``zeros``, a ``clock`` of v, a ``scale`` of a_x.
    """

    z: Array
    brake: Array
    moment_f: Array
    moment_r: Array
    rolling: Array
    log_odds: Array
    alone: float | None
    eta: Array
    eta_variance: Array
    zero_eta: float
    slip: Array
    slip_covariance: Array
    zeros: Array
    clock: Array
    scale: Array


def told(run: RampRun) -> Index:
    """The braked blocks of a ramp of which eta and slip tell."""
    return np.flatnonzero(run.braked & (run.blocks.speed > _SLOW))


def _ramp(car: Vehicle, run: RampRun, most: int | None) -> _Ramp:
    b, noise = run.blocks, run.noise
    at, lead = told(run), run.rolling
    if not (at.size and lead.size):
        raise ValueError("no blocks of a braking, or none of rolling before it")
    groups = np.array_split(at, min(most or at.size, at.size))
    time, rolled = np.array([g.size for g in groups]) * b.length, lead.size * b.length

    def mean(x: Array) -> Array:
        return np.array([np.mean(x[g]) for g in groups])

    def zeroed(x: Array) -> Array:
        return mean(x) - np.mean(x[lead])

    wheels = noise.omega / mean(b.omega_f)
    zero_wheels = noise.omega / np.mean(b.omega_f[lead]) / np.sqrt(rolled)
    eta_zero = float(np.mean(b.eta[lead]))
    if run.slip is None:
        of_slip = _carried_on(car, run, lead, groups, eta_zero)
    else:
        speed, zero_v = mean(b.speed), noise.v / np.mean(b.speed[lead]) / np.sqrt(rolled)
        of_slip = {
            "slip": zeroed(run.slip),
            "slip_covariance": np.diag((wheels**2 + (noise.v / speed) ** 2) / time),
            "zeros": np.full((speed.size, 1), np.hypot(zero_wheels, zero_v)),
            "clock": (_CLOCK * G * mean(b.z) / speed)[:, None],
            "scale": np.zeros((speed.size, 0)),
        }
    B_f, B_r = (mean(np.maximum(p, 1.0)) for p in (b.p_f, b.p_r))
    # the loads of the run, as known effects move them, are those of this deceleration
    moved = (run.load_f * car.wheelbase / car.weight - car.cg_to_rear_axle) / car.cg_height
    rolling = (moved, run.moment_f / car.weight, run.moment_r / car.weight)
    return _Ramp(
        z=mean(moved),
        brake=zeroed(run.brake_sum) / car.weight,
        moment_f=mean(run.moment_f) / car.weight,
        moment_r=mean(run.moment_r) / car.weight,
        rolling=np.array([np.mean(x[lead]) for x in rolling]),
        log_odds=np.log(B_f / B_r),
        alone={None: None, "f": 1.0, "r": 0.0}[run.only],
        eta=mean(b.eta) / eta_zero - 1.0,
        eta_variance=2.0 * wheels**2 / time,
        zero_eta=float(np.hypot(np.sqrt(2.0) * zero_wheels, _WALKED)),
        **of_slip,
    )


def _carried_on(
    car: Vehicle, run: RampRun, lead: Index, groups: list[Index], eta_zero: float
) -> dict[str, Array]:
    """Slip by a speed that a_x carries on from the lead-in, and its errors, as `_Ramp` has them.

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
    scale, sigma = PRIORS["a_x_scale"]
    start = 2.0 * wheel / np.sqrt(rolled)
    return {
        "slip": (v_0 - (1.0 - scale) * gone - u) / v,
        "slip_covariance": covariance,
        "zeros": np.stack([-G * t * slope_sigma / v, start / v], axis=1),
        "clock": np.zeros((v.size, 0)),
        "scale": (-gone * sigma / v)[:, None],
    }


@dataclass(frozen=True)
class LinearPrior:
    """What is known of the linear parameters of each draw before the ramps.

    ``precision`` (n, 3, 3) and ``pull`` (n, 3), precision times mean; ``log_weight`` (n,) of the
    draw, with the norm of that density.
    """

    precision: Array
    pull: Array
    log_weight: Array

    def standard(self, linear: Array) -> Array:
        """The linear parameters (n, 3) in the coordinates in which this is standard normal."""
        off = linear - np.linalg.solve(self.precision, self.pull[..., None])[..., 0]
        return np.asarray(np.einsum("ni,nij->nj", off, np.linalg.cholesky(self.precision)))


class Regression:
    """The rows of all ramps: eta of each, then slip of each, in ``most`` groups of blocks.

    None for ``most`` makes each block a row.

    ``errors`` (k, m) by part of a budget: what each error of one standard deviation makes of the
    rows.
    """

    def __init__(self, car: Vehicle, runs: list[RampRun], most: int | None = _GROUPS) -> None:
        self.car, self.ramps = car, [_ramp(car, run, most) for run in runs]
        self.errors = self._errors()
        covariance = sum(error @ error.T for error in self.errors.values())
        self.white = np.linalg.inv(np.linalg.cholesky(np.asarray(covariance)))

    def _errors(self) -> dict[str, Array]:
        from scipy.linalg import block_diag

        def stacked(of_eta: list[Array], of_slip: list[Array]) -> Array:
            return np.asarray(block_diag(*of_eta, *of_slip))

        none = [np.zeros((r.z.size, 0)) for r in self.ramps]
        sensors = stacked(
            [np.diag(r.eta_variance) for r in self.ramps], [r.slip_covariance for r in self.ramps]
        )
        zeros = [np.full((r.z.size, 1), r.zero_eta) for r in self.ramps]
        return {
            "noise": np.asarray(np.linalg.cholesky(sensors)),
            "tyres": np.asarray(np.linalg.cholesky(self._form())),
            "zeros": stacked(zeros, [np.hstack([r.zeros, r.clock]) for r in self.ramps]),
            "accelerometer": stacked(none, [r.scale for r in self.ramps]),
        }

    def _form(self) -> Array:
        """Covariance of the error of the form, over the deceleration."""
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
        return np.asarray(size[:, None] * size * near)

    def rows(self, e: Ensemble) -> tuple[Array, Mask]:
        """Design and data (4, n, k); whether forces are below the peaks (n,)."""
        eta, slip, rolls = [], [], np.ones(e.size, dtype=bool)
        for r in self.ramps:
            share = (
                front_share(self.car, e.log_pad_ratio[:, None] + r.log_odds)
                if r.alone is None
                else np.full((e.size, 1), r.alone)
            )
            unit = unit_slips(
                self.car, e, r.z, share * r.brake + r.moment_f, (1.0 - share) * r.brake + r.moment_r
            )
            rolls &= unit.rolls.all(axis=1)
            z, moment_f, moment_r = (np.full((e.size, 1), x) for x in r.rolling)
            zero = unit_slips(self.car, e, z, moment_f, moment_r)
            by_f, by_r = unit.front - zero.front, unit.rear - zero.rear
            grown_f, grown_r = unit.grown_f - zero.grown_f, unit.grown_r - zero.grown_r
            known = r.eta * (1.0 - PRIORS["compliance"][0] * unit.front)
            eta.append([by_f, -by_r, grown_r - grown_f, known])
            front, rear = unit.share, 1.0 - unit.share
            seen = np.broadcast_to(r.slip, front.shape)
            grown = front * grown_f + rear * grown_r
            slip.append([front * by_f, rear * by_r, -grown, seen])
        return np.concatenate(eta + slip, axis=-1), rolls

    def solve(self, e: Ensemble, prior: LinearPrior) -> tuple[Array, Array, Array]:
        """Log evidence (n,), mean (n, 3) and precision (n, 3, 3) of the linear parameters."""
        rows, rolls = self.rows(e)
        *H, y = rows @ self.white.T
        A = np.einsum("ink,jnk->nij", H, H) + prior.precision
        g = np.einsum("ink,nk->ni", H, y) + prior.pull
        mean = np.linalg.solve(A, g[..., None])[..., 0]
        square = np.einsum("nk,nk->n", y, y) - np.einsum("ni,ni->n", g, mean)
        log = prior.log_weight - 0.5 * (square + np.log(np.linalg.det(A)))
        possible = rolls & np.all(mean[:, :2] > 0.0, axis=1)
        return np.where(possible, log, -np.inf), mean, A

    def left(self, e: Ensemble, linear: Array) -> Array:
        """What the draws with ``linear`` (n, 3) leave of the rows (n, k)."""
        *H, y = self.rows(e)[0]
        return np.asarray(y - np.einsum("ink,ni->nk", H, linear))

    def pulls(self, left: Array) -> dict[str, Array]:
        """How ln of the probability of a draw grows with each of `errors`, (n, m) by part."""
        return {part: left @ (self.white @ error) for part, error in self.errors.items()}

    def late(self, left: Array, rng: np.random.Generator) -> Array:
        """Time by which v is late [s] (n,), mean of the runs that have v; 0 without any."""
        from scipy.linalg import block_diag

        none = [np.zeros((r.z.size, 0)) for r in self.ramps]
        error = self.white @ block_diag(*none, *(r.clock for r in self.ramps))
        if not error.size:
            return np.zeros(left.shape[0])
        root = np.linalg.cholesky(np.eye(error.shape[1]) - error.T @ error)
        drawn = left @ error
        drawn += rng.standard_normal(drawn.shape) @ root.T
        return np.asarray(_CLOCK * np.mean(drawn, axis=1))

    def departures(self, left: Array) -> dict[str, Array]:
        """Relative departure of eta - 1 and slip from the forms at `DEPART_AT`, (n, k) each.

        The mean of the correlated error, given what the draws leave, ``left``.
        """
        pull, near = left @ self.white, _near(self.places, DEPART_AT)
        return {
            of: PRIORS[f"form_error_{of}"][0] * (pull * size) @ near
            for of, size in self.departs.items()
        }


def _near(x: Array, y: Array) -> Array:
    """How alike a tyre departs from its form at two decelerations, (n, k)."""
    return np.asarray(np.exp(-0.5 * ((x[:, None] - y) / PRIORS["form_length"][0]) ** 2))
