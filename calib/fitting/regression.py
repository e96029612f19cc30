r"""The likelihood of a draw: eta and slip of the ramps, by linear regression.

    rows = H (c_f, c_r, fall) + error        H by the forces over the loads, the form of the tyres

The unknowns are the compliances of the axles and the fall of the radii with load. The error has a
known covariance: noise of the sensors, zeros and clock of the run, scale of a_x, and a correlated
discrepancy of the form, as no tyre is a mean of published ones (Brynjarsdottir and O'Hagan 2014,
doi:10.1088/0266-5611/30/11/114007).
"""

import copy
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import G
from calib.car.balance import front_share
from calib.car.beliefs import CAR, LOG
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import DEPART_AT, Ensemble, LoadedTyres, loaded_tyres
from calib.model.ramp import RampRun
from calib.run.filters import GroupMean

_GROUPS = 14  # groups of blocks of a ramp: the discrepancy of a tyre is alike over two of them
_GRADE = 0.001  # random walk of bias and slope [1/sqrt(s)]
_CLOCK = 0.01  # standard deviation of the delay of v after the wheels [s]
_WALKED = 5e-5  # standard deviation of the drift of eta's zero since the lead-in [1]
_FINEST = 5e-4  # eta - 1 or slip below which the discrepancy no longer shrinks [1]
_ROUGH = 0.02  # uncorrelated share of the variance of the discrepancy

_KINDS = ("eta", "slip")  # of rows, in their order
_ERROR = {"eta": CAR.form_error_eta.mean, "slip": CAR.form_error_slip.mean}


def _carried_on(
    car: Vehicle, run: RampRun, eta_zero: float, mean: Callable[[Array], Array], length: Array
) -> tuple[Array, dict[str, Array]]:
    """Slip (k,) against the speed that a_x gives from the lead-in on, and its errors by cause.

    v = v_0 - g int (1 - e) (z - o) dt with scale e and offset o; the wheels turn at v (1 - slip).
    As the car slows, the part of the slip vanishes and that of e does not. ``mean`` averages over
    groups of blocks, of a ``length`` each [s].
    """
    b, noise, lead, R = run.blocks, run.noise, run.rolling, car.front.rolling_radius
    rear = 1.0 - run.load_f / car.weight
    rim = R * b.omega_f * (1.0 + rear * (b.eta / eta_zero - 1.0))
    time = b.end - b.end[lead[-1]]
    slope, v_0 = np.polyfit(time[lead], rim[lead], 1)
    offset = np.mean(b.z[lead]) + slope / G
    lost = np.cumsum(np.where(time > 0.0, G * (b.z - offset) * b.length, 0.0))
    t, gone, u, z = (mean(x)[1:] for x in (time, lost, rim, b.z))
    v = u * (1.0 + CAR.compliance.mean * z)
    wheel, rolled = noise.omega * R, lead.size * b.length
    earlier = np.minimum.outer(t, t)
    walk = (_GRADE * earlier) ** 2 * (np.maximum.outer(t, t) / 2.0 - earlier / 6.0)
    off = G**2 * (noise.z**2 * earlier + walk) + np.diag(wheel**2 / length)
    slope_sigma = np.sqrt(12.0 * wheel**2 / rolled**3 + (G * noise.z) ** 2 / rolled) / G
    return (v_0 - (1.0 - LOG.a_x_scale.mean) * gone - u) / v, {
        "noise": np.linalg.cholesky(off / np.outer(v, v)),
        "zeros": np.stack([-G * t * slope_sigma / v, 2.0 * wheel / np.sqrt(rolled) / v], axis=1),
        "accelerometer": (-gone * LOG.a_x_scale.sigma / v)[:, None],
    }


class _Ramp:
    """One ramp: means over its lead-in, which is the zero, and over k groups of blocks.

    Of lead-in and groups, (1 + k,) [1]: ``brake`` force of both axles over the weight; ``moments``
    other torques of the axles as forces over the weight, (2, 1 + k); ``log_odds`` ln of front over
    rear pressure. ``only`` the axle that brakes alone. ``rows`` eta - 1 and slip of the groups,
    (2, k), without v against the speed by a_x; their ``errors`` by cause, (k, m), a column for each
    error of one standard deviation.
    """

    def __init__(self, car: Vehicle, run: RampRun, most: int | None) -> None:
        braked, lead = np.flatnonzero(run.braked), run.rolling
        if not (braked.size and lead.size):
            raise ValueError("no blocks of a braking, or none of rolling before it")
        groups = [lead, *np.array_split(braked, min(most or braked.size, braked.size))]
        self._mean = GroupMean(groups)
        self.z = self._mean(run.quasi_static(car))
        self._read_forces(car, run)
        self._read_wheels(car, run)

    def with_forces_of(self, car: Vehicle, run: RampRun) -> "_Ramp":
        """The same ramp with the forces of ``run``, and its wheel speeds if they are others."""
        other = copy.copy(self)
        other._read_forces(car, run)
        if run.blocks.omega_f is not self._omega[0] or run.blocks.omega_r is not self._omega[1]:
            other._read_wheels(car, run)
        return other

    def _read_forces(self, car: Vehicle, run: RampRun) -> None:
        pressures = (self._mean(np.maximum(p, 1.0)) for p in (run.blocks.p_f, run.blocks.p_r))
        brake = self._mean(run.brake_sum)
        self.brake = (brake - brake[0]) / car.weight
        self.moments = np.stack([self._mean(x / car.weight) for x in (run.drag_f, run.drag_r)])
        self.log_odds, self.only = run.log_odds(*pressures), run.only

    def _read_wheels(self, car: Vehicle, run: RampRun) -> None:
        b, noise, mean = run.blocks, run.noise, self._mean
        self._omega = b.omega_f, b.omega_r
        time = self._mean.sizes * b.length
        eta, wheels = mean(b.eta), noise.omega / mean(b.omega_f)
        zero_wheels, zeros = wheels[0] / np.sqrt(time[0]), np.ones((time.size - 1, 1))
        if run.slip is None:
            slip, of_slip = _carried_on(car, run, eta[0], mean, time[1:])
        else:
            measured, late = mean(run.slip), noise.v / mean(b.speed)
            slip = measured[1:] - measured[0]
            of_slip = {
                "noise": np.diag(np.sqrt((wheels**2 + late**2) / time)[1:]),
                "zeros": np.hypot(zero_wheels, late[0] / np.sqrt(time[0])) * zeros,
                "clock": (_CLOCK * G * mean(b.z) / mean(b.speed))[1:, None],
            }
        of_eta = {
            "noise": np.diag((np.sqrt(2.0 / time) * wheels)[1:]),
            "zeros": np.hypot(np.sqrt(2.0) * zero_wheels, _WALKED) * zeros,
        }
        self.rows, self.errors = np.array([eta[1:] / eta[0] - 1.0, slip]), (of_eta, of_slip)


class Solution(NamedTuple):
    """Posterior of the linear parameters of draws (n,), in standard normal numbers x.

    ``log_evidence`` (n,); ``mean`` (n, 3), ``precision`` (n, 3, 3) of x; ``design`` (3, n, k),
    ``data`` (n, k) whitened.
    """

    log_evidence: Array
    mean: Array
    precision: Array
    design: Array
    data: Array

    def take(self, draws: Index) -> "Solution":
        """The posterior of some ``draws``."""
        axes = (0, 0, 0, 1, 0)
        return Solution(*(np.take(x, draws, axis) for x, axis in zip(self, axes, strict=True)))

    def residual(self, draw: int) -> Array:
        """Residual of one draw at its mean, in standard deviations (k,)."""
        return np.asarray(self.data[draw] - self.mean[draw] @ self.design[:, draw])


class Regression:
    """The regression on all ramps: rows of eta, then of slip, of each ramp.

    ``most`` groups of blocks of a ramp, None for a row of each block. ``errors`` (k, m) by part of
    a budget: the columns are errors of one standard deviation.
    """

    def __init__(self, car: Vehicle, runs: list[RampRun], most: int | None = _GROUPS) -> None:
        self.car, self.most, self.ramps = car, most, [_Ramp(car, run, most) for run in runs]
        self.errors = {
            "noise": self._errors_of("noise"),
            "tyres": np.asarray(np.linalg.cholesky(self._form())),
            "zeros": np.hstack([self._errors_of("zeros"), self._errors_of("clock")]),
            "accelerometer": self._errors_of("accelerometer"),
        }
        covariance = sum(error @ error.T for error in self.errors.values())
        self.white = np.linalg.inv(np.linalg.cholesky(np.asarray(covariance)))

    def with_forces_of(self, runs: Sequence[RampRun]) -> "Regression":
        """The same regression with forces and pressures of ``runs``; the errors stay."""
        other = copy.copy(self)
        pairs = zip(self.ramps, runs, strict=True)
        other.ramps = [ramp.with_forces_of(self.car, run) for ramp, run in pairs]
        return other

    def _errors_of(self, cause: str) -> Array:
        from scipy.linalg import block_diag

        each = [(of, np.zeros((r.z.size - 1, 0))) for r in self.ramps for of in r.errors]
        return np.asarray(block_diag(*(of.get(cause, none) for of, none in each)))

    def _form(self) -> Array:
        """Covariance of the discrepancy of the tyre form, which is correlated over z."""
        each = [(r, of, x) for r in self.ramps for of, x in zip(_KINDS, r.rows, strict=True)]
        kind = np.concatenate([np.full(x.size, f"{of} {r.only}") for r, of, x in each])
        off = [_ERROR[of] * np.maximum(np.abs(x), _FINEST) for _, of, x in each]
        size = np.concatenate(off)
        self.places = np.concatenate([r.z[1:] for r, _, _ in each])
        self.discrepancy_sizes = {of: size * (kind == f"{of} None") for of in _KINDS}
        near = _near(self.places, self.places) * (kind[:, None] == kind)
        return np.asarray(size[:, None] * size * (near + _ROUGH * np.eye(size.size)))

    def loaded(self, e: Ensemble) -> list[LoadedTyres]:
        """The tyres of the draws under the axle loads of each ramp."""
        return [loaded_tyres(self.car, e, r.z) for r in self.ramps]

    def rows(self, e: Ensemble, loaded: Sequence[LoadedTyres] | None = None) -> tuple[Array, Mask]:
        """Design matrix and data, (4, n, k); whether all tyres are below their peaks, (n,).

        ``loaded`` tyres of the draws ``e``, if they are known.
        """
        rows, rolls = [], np.ones(e.size, dtype=bool)
        for r, tyres in zip(self.ramps, loaded or self.loaded(e), strict=True):
            share = front_share(self.car, e.log_pad_ratio[:, None] + r.log_odds)
            unit = tyres.slips(np.stack([share, 1.0 - share]) * r.brake + r.moments[:, None])
            rolls &= unit.rolls.all(axis=1)
            by, grown = (x[..., 1:] - x[..., :1] for x in (unit.slip, unit.grown))
            load, eta = unit.load[..., 1:], r.rows[0]
            eta = eta * (1.0 - CAR.compliance.mean * unit.slip[0][:, 1:])
            rows.append([by[0], -by[1], grown[1] - grown[0], eta])
            slip = np.broadcast_to(r.rows[1], eta.shape)
            rows.append([*load * by, -np.sum(load * grown, axis=0), slip])
        return np.concatenate(rows, axis=-1), rolls

    def solve(
        self,
        e: Ensemble,
        centre: Array,
        root: Array,
        loaded: Sequence[LoadedTyres] | None = None,
        *,
        anywhere: bool = False,
    ) -> Solution:
        """Integrate over linear parameters ``centre`` (n, 3) + ``root`` x, x standard normal.

        ``loaded`` as of `rows`. ``anywhere``: beyond the peak of a tyre too, with the slip there.
        """
        rows, rolls = self.rows(e, loaded)
        *H, y = rows @ self.white.T
        y = y - np.einsum("ink,ni->nk", H, centre)
        H = np.einsum("ink,nij->jnk", H, root)
        A = np.einsum("ink,jnk->nij", H, H) + np.eye(3)
        g = np.einsum("ink,nk->ni", H, y)
        mean = np.linalg.solve(A, g[..., None])[..., 0]
        square = np.einsum("nk,nk->n", y, y) - np.einsum("ni,ni->n", g, mean)
        log = -0.5 * (square + np.log(np.linalg.det(A)))
        linear = centre + np.einsum("nij,nj->ni", root, mean)
        log = np.where(anywhere | rolls & np.all(linear[:, :2] > 0.0, axis=1), log, -np.inf)
        return Solution(log, mean, A, np.asarray(H), y)

    def residuals(self, e: Ensemble) -> Array:
        """Residuals of the rows, by draw, (n, k) [1]."""
        *H, y = self.rows(e)[0]
        return np.asarray(y - np.einsum("ink,ni->nk", H, e.linear))

    def discrepancies(self, residual: Array, rng: np.random.Generator) -> dict[str, Array]:
        """Delay of v and discrepancies of the tyre form, by name of `Ensemble`, from residuals.

        ``v_late`` a draw of the mean of the runs with v, 0 without any; ``depart_eta`` and
        ``depart_slip`` posterior means of the discrepancy. ``residual`` whitened, (n, k).
        """
        clock, near = self.white @ self._errors_of("clock"), _near(self.places, DEPART_AT)
        root = np.linalg.cholesky(np.eye(clock.shape[1]) - clock.T @ clock)
        late = residual @ clock + rng.standard_normal((len(residual), clock.shape[1])) @ root.T
        return {"v_late": _CLOCK * np.sum(late, axis=1) / max(clock.shape[1], 1)} | {
            f"depart_{of}": _ERROR[of] * (residual @ self.white * size) @ near
            for of, size in self.discrepancy_sizes.items()
        }


def _near(x: Array, y: Array) -> Array:
    """Correlation of a tyre's discrepancy at decelerations ``x`` (n,) and ``y`` (k,)."""
    return np.asarray(np.exp(-0.5 * ((x[:, None] - y) / CAR.form_length.mean) ** 2))
