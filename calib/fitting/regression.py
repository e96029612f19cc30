"""The likelihood of a draw by eta and slip of the ramps: a linear regression.

    (eta - 1, slip) = H (c_f, c_r, fall) + error

The unknowns are the compliances c = 1/K of the axles, slip per normalised force, and the fall of
the radii with load. slip is that of the car, the mean of the axles by load. The design matrix H
follows from the draw: forces over loads, and the form of the tyres. The error has a known
covariance: noise of the sensors, zeros and clock of the run, scale of a_x, and a correlated
discrepancy of the form, since a real tyre has not the mean form of the published ones
(Brynjarsdottir and O'Hagan 2014, doi:10.1088/0266-5611/30/11/114007).

`_Ramp` has the data of one ramp with their errors, `Regression` those of all ramps, `Solution` the
result. Shapes: n draws, k rows of a ramp or of all ramps, s variants of the runs. A variant is a
run as it would be without a mistake, see `calib.fitting.hypotheses`.
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

_GROUPS = 14  # a ramp is averaged in this many groups; a discrepancy is alike over two of them
_GRADE = 0.001  # random walk of the road's grade plus the bias of a_x [1/sqrt(s)]
_CLOCK = 0.01  # standard deviation of the delay of v after the wheels [s]
_DRIFT = 5e-5  # standard deviation of the drift of eta's zero since the lead-in [1]
_FINEST = 5e-4  # eta - 1 or slip below which the discrepancy no longer shrinks [1]
_ROUGH = 0.02  # uncorrelated share of the variance of the discrepancy

_DISCREPANCY = {"eta": CAR.form_error_eta.mean, "slip": CAR.form_error_slip.mean}
"""Standard deviation of the discrepancy, relative to eta - 1 or slip [1], in the order of rows."""


class _Ramp:
    """The data of one ramp as means [1].

    Index 0 is the lead-in, which gives the zeros; 1 to k are groups of blocks.
    """

    z: Array  # deceleration (1 + k,)
    only: str | None  # axle that brakes alone, None if both brake
    brake: Array  # force of both axles over the weight (..., 1 + k)
    moments: Array  # other torques of the axles, as forces over the weight (..., 2, 1 + k)
    log_odds: Array  # ln of front over rear pressure (..., 1 + k)
    measured: Array  # eta - 1 and slip of the groups (..., 2, k)
    errors: tuple[dict[str, Array], dict[str, Array]]
    """Errors of eta and of slip by cause (k, m): a column is one independent error of one sigma."""

    def __init__(self, car: Vehicle, run: RampRun, groups: int | None) -> None:
        braked, lead = np.flatnonzero(run.braked), run.rolling
        if not (braked.size and lead.size):
            raise ValueError("no blocks of a braking, or none of rolling before it")
        count = min(groups or braked.size, braked.size)
        self._car, self._run = car, run
        self._mean = GroupMean([lead, *np.array_split(braked, count)])
        self.z, self.only = self._mean(run.quasi_static(car)), run.only
        self.brake, self.moments, self.log_odds = (x[0] for x in self._read_forces([run]))
        self.measured, self.errors = self._read_wheels(run)

    def with_forces_of(self, runs: Sequence[RampRun]) -> "_Ramp":
        """Return the ramp with forces and wheel speeds of ``runs`` (s,), on a new first axis."""
        other = copy.copy(self)
        other.brake, other.moments, other.log_odds = self._read_forces(runs)
        other.measured = np.array([self._measured_in(run) for run in runs])
        return other

    def _read_forces(self, runs: Sequence[RampRun]) -> tuple[Array, Array, Array]:
        """Return ``brake``, ``moments`` and ``log_odds`` of each of ``runs`` (s,)."""
        signals = np.array(  # (s, 5, blocks)
            [(x.brake_sum, x.drag_f, x.drag_r, x.blocks.p_f, x.blocks.p_r) for x in runs]
        )
        np.maximum(signals[:, 3:], 1.0, out=signals[:, 3:])  # [Pa], so that its ln exists
        means = self._mean(signals)  # (s, 5, 1 + k)
        brake, weight = means[:, 0], self._car.weight
        log_odds = self._run.log_odds(means[:, 3], means[:, 4])
        return (brake - brake[:, :1]) / weight, means[:, 1:3] / weight, log_odds

    def _measured_in(self, run: RampRun) -> Array:
        """Return ``measured`` of a variant of the run. Most variants have the same wheel speeds."""
        b, own = run.blocks, self._run.blocks
        same = b.omega_f is own.omega_f and b.omega_r is own.omega_r
        return self.measured if same else self._read_wheels(run)[0]

    def _read_wheels(self, run: RampRun) -> tuple[Array, tuple[dict[str, Array], dict[str, Array]]]:
        """Return ``measured`` and ``errors``: by wheel speeds, and by v or else a_x."""
        b, noise, mean, car = run.blocks, run.noise, self._mean, self._car
        eta, time = mean(b.eta), self._mean.sizes * b.length
        # relative noise n of wheel speeds [sqrt(s)]: a mean over a time T has the error n/sqrt(T)
        wheel_noise = noise.omega / mean(b.omega_f)
        zero_error, ones = wheel_noise[0] / np.sqrt(time[0]), np.ones((time.size - 1, 1))
        if run.slip is None:
            slip, of_slip = _slip_by_acceleration(car, run, eta[0], mean, time[1:])
        else:
            v_noise, with_zero = noise.v / mean(b.speed), mean(run.slip)
            slip = with_zero[1:] - with_zero[0]
            of_slip = {
                "noise": np.diag(np.sqrt((wheel_noise**2 + v_noise**2) / time)[1:]),
                "zeros": np.hypot(zero_error, v_noise[0] / np.sqrt(time[0])) * ones,
                "clock": (_CLOCK * G * mean(b.z) / mean(b.speed))[1:, None],
            }
        of_eta = {
            "noise": np.diag((np.sqrt(2.0 / time) * wheel_noise)[1:]),
            "zeros": np.hypot(np.sqrt(2.0) * zero_error, _DRIFT) * ones,
        }
        return np.array([eta[1:] / eta[0] - 1.0, slip]), (of_eta, of_slip)


def _slip_by_acceleration(
    car: Vehicle, run: RampRun, eta_zero: float, mean: Callable[[Array], Array], length: Array
) -> tuple[Array, dict[str, Array]]:
    """Return the slip (k,) by a speed from a_x, where v is not logged, and its errors by cause.

    v = v_0 - g int (1 - e) (z - o) dt, with scale e and offset o of a_x. v - R omega is slip times
    v, which falls as the car slows, and the error by e, which grows, so both are observable.
    ``mean`` averages over the lead-in and over groups, whose ``length`` is (k,) [s]; ``eta_zero``
    is eta on the lead-in [1].
    """
    b, noise, lead, R = run.blocks, run.noise, run.rolling, car.front.rolling_radius
    rear_share = 1.0 - run.load_f / car.weight
    # R omega, the mean of the axles by load [m/s]: the rear one is eta/eta_zero times the front one
    rim = R * b.omega_f * (1.0 + rear_share * (b.eta / eta_zero - 1.0))
    time = b.end - b.end[lead[-1]]
    slope, v_0 = np.polyfit(time[lead], rim[lead], 1)
    offset = np.mean(b.z[lead]) + slope / G
    lost = np.cumsum(np.where(time > 0.0, G * (b.z - offset) * b.length, 0.0))
    # means of the groups: time [s], speed lost by a_x [m/s], R omega [m/s], z [1]
    t, lost_speed, u, z = (mean(x)[1:] for x in (time, lost, rim, b.z))
    v = u * (1.0 + CAR.compliance.mean * z)
    wheel, rolled = noise.omega * R, lead.size * b.length
    # covariance of the speed at times s <= t: the integral of white noise n has n^2 s, that of a
    # random walk q has q^2 s^2 (t/2 - s/6)
    earlier = np.minimum.outer(t, t)
    walk = (_GRADE * earlier) ** 2 * (np.maximum.outer(t, t) / 2.0 - earlier / 6.0)
    covariance = G**2 * (noise.z**2 * earlier + walk) + np.diag(wheel**2 / length)
    # zeros: the line through the lead-in has independent errors of its middle and of its slope
    of_slope = np.sqrt(12.0) * wheel / rolled * (t + 0.5 * rolled)
    zeros = np.stack([of_slope, np.full_like(t, wheel), G * noise.z * t]) / np.sqrt(rolled)
    return (v_0 - (1.0 - LOG.a_x_scale.mean) * lost_speed - u) / v, {
        "noise": np.linalg.cholesky(covariance / np.outer(v, v)),
        "zeros": (zeros / v).T,
        "accelerometer": (-lost_speed * LOG.a_x_scale.sigma / v)[:, None],
    }


class Solution(NamedTuple):
    """Posterior of the linear parameters of each draw, whose prior is standard normal in x (3,)."""

    log_evidence: Array  # ln of the likelihood of a draw (..., n)
    mean: Array  # of x (..., n, 3)
    precision: Array  # of x (..., n, 3, 3)
    design: Array  # whitened design matrix (..., n, 3, k)
    data: Array  # whitened data (..., n, k)

    def take(self, index: int | Index) -> "Solution":
        """Return the posteriors at one or more places of the first axis."""
        return Solution(*(x[index] for x in self))

    def residual(self, draw: int) -> Array:
        """Residual (k,) of one draw at the mean of x, in standard deviations."""
        return np.asarray(self.data[draw] - self.mean[draw] @ self.design[draw])


class Regression:
    """The regression on all ramps: rows of eta, then of slip, of one ramp after the other."""

    ramps: list[_Ramp]
    errors: dict[str, Array]
    """Errors of the rows by part of a budget (k, m): a column is an independent error, 1 sigma."""
    white: Array  # matrix that whitens the rows (k, k)
    z: Array  # deceleration of each row (k,) [1]
    discrepancy_sizes: dict[str, Array]
    """Standard deviation of the discrepancy by kind of row (k,): 0 in rows of the other kind, and
    where one axle brakes alone."""

    def __init__(self, car: Vehicle, runs: list[RampRun], groups: int | None = _GROUPS) -> None:
        """Read the runs; ``groups`` of blocks of a ramp at most, None for a row of each block."""
        self.car, self.ramps = car, [_Ramp(car, run, groups) for run in runs]
        kinds, sizes = [], []  # of the rows: "eta" or "slip" with the braked axles; sizes
        for ramp in self.ramps:
            for name, measured in zip(_DISCREPANCY, ramp.measured, strict=True):
                kinds.append(np.full(measured.size, f"{name} {ramp.only or 'both'}"))
                sizes.append(_DISCREPANCY[name] * np.maximum(np.abs(measured), _FINEST))
        kind, size = np.concatenate(kinds), np.concatenate(sizes)
        self.z = np.concatenate([np.tile(ramp.z[1:], 2) for ramp in self.ramps])
        self.discrepancy_sizes = {name: size * (kind == f"{name} both") for name in _DISCREPANCY}
        # ramps with the same braked axles share a discrepancy; eta and slip have independent ones
        correlation = _correlation(self.z, self.z) * (kind[:, None] == kind)
        discrepancy = size[:, None] * size * (correlation + _ROUGH * np.eye(size.size))
        self.errors = {
            "noise": self._errors_by("noise"),
            "tyres": np.asarray(np.linalg.cholesky(discrepancy)),
            "zeros": np.hstack([self._errors_by("zeros"), self._errors_by("clock")]),
            "accelerometer": self._errors_by("accelerometer"),
        }
        covariance = sum(error @ error.T for error in self.errors.values())
        self.white = np.linalg.inv(np.linalg.cholesky(np.asarray(covariance)))

    def _errors_by(self, cause: str) -> Array:
        """Return the errors of all rows by one cause (k, m), independent between ramps."""
        from scipy.linalg import block_diag

        parts = []
        for ramp in self.ramps:
            none = np.zeros((ramp.z.size - 1, 0))
            parts += [by_cause.get(cause, none) for by_cause in ramp.errors]
        return np.asarray(block_diag(*parts))

    def with_forces_of(self, variants: Sequence[Sequence[RampRun]]) -> "Regression":
        """Return the regression with forces and wheel speeds of ``variants`` (s,) of its runs.

        The errors are those of the runs themselves. Results have an additional first axis (s,).
        """
        other = copy.copy(self)
        pairs = zip(self.ramps, zip(*variants, strict=True), strict=True)
        other.ramps = [ramp.with_forces_of(runs) for ramp, runs in pairs]
        return other

    def loaded(self, e: Ensemble) -> list[LoadedTyres]:
        """Return the tyres of the draws under the axle loads of each ramp."""
        return [loaded_tyres(self.car, e, ramp.z) for ramp in self.ramps]

    def equations(
        self, e: Ensemble, loaded: Sequence[LoadedTyres] | None = None
    ) -> tuple[Array, Mask]:
        """Return design matrix with data, (..., n, 4, k), and whether both axles roll (..., n).

        The rows of the axis of 4 are the coefficients of front compliance, of rear compliance and
        of the fall of the radii, then the data. ``loaded`` are the tyres of the draws ``e``, if
        they are known.
        """
        pairs = zip(self.ramps, loaded or self.loaded(e), strict=True)
        parts, rolls = zip(*(self._equations_of(r, e, tyres) for r, tyres in pairs), strict=True)
        return np.concatenate(parts, axis=-1), np.asarray(np.stack(rolls).all(axis=0))

    def _equations_of(self, ramp: _Ramp, e: Ensemble, tyres: LoadedTyres) -> tuple[Array, Mask]:
        """Return `equations` of one ramp."""
        share = front_share(self.car, e.log_pad_ratio[:, None] + ramp.log_odds[..., None, :])
        brakes = np.stack([share, 1.0 - share], axis=-3) * ramp.brake[..., None, None, :]
        unit_slips, rolls = tyres.unit_slips(brakes + ramp.moments[..., None, :])
        # changes since the lead-in: slips (..., 2, n, k), loads (2, n, k)
        slips, load_rise = (x[..., 1:] - x[..., :1] for x in (unit_slips, tyres.load_rise))
        load, front = tyres.load[..., 1:], unit_slips[..., 0, :, 1:]
        rows = np.empty((*front.shape[:-1], 4, 2 * front.shape[-1]))
        of_eta, of_slip = np.split(rows, 2, axis=-1)
        of_eta[..., 0, :] = slips[..., 0, :, :]
        of_eta[..., 1, :] = -slips[..., 1, :, :]
        of_eta[..., 2, :] = load_rise[1] - load_rise[0]
        # (eta - 1) (1 - slip_f) = slip_f - slip_r is linear in the compliances; in the small slip_f
        # on the left the compliance is the prior mean
        of_eta[..., 3, :] = ramp.measured[..., :1, :] * (1.0 - CAR.compliance.mean * front)
        of_slip[..., :2, :] = (load * slips).swapaxes(-3, -2)
        of_slip[..., 2, :] = -np.sum(load * load_rise, axis=0)
        of_slip[..., 3, :] = ramp.measured[..., 1:, :]
        return rows, np.asarray(rolls.all(axis=-1))

    def solve(
        self,
        e: Ensemble,
        centre: Array,
        root: Array,
        loaded: Sequence[LoadedTyres] | None = None,
        *,
        beyond_peak: bool = False,
    ) -> Solution:
        """Integrate over the linear parameters, with the prior ``centre`` + ``root`` x.

        ``centre`` is (n, 3), ``root`` (n, 3, 3), x (3,) standard normal.
        ``loaded`` as in `equations`. A draw with a tyre beyond its peak has no likelihood, unless
        ``beyond_peak``: then it has the slip of the peak.
        """
        rows, rolls = self.equations(e, loaded)
        # to_x turns factors of the parameters into those of x, and the data y into y - H centre
        to_x = np.zeros((e.size, 4, 4))
        to_x[:, :3, :3] = root.transpose(0, 2, 1)
        to_x[:, 3, :3] = -centre
        to_x[:, 3, 3] = 1.0
        white: Array = to_x @ (rows @ self.white.T)
        # with whitened H and y: A = 1 + H'H, mean = A^-1 H'y, and
        # ln evidence = -(y'y - mean' H'y + ln det A)/2, up to a constant
        products: Array = white @ white.swapaxes(-2, -1)
        A, g, square = products[..., :3, :3] + np.eye(3), products[..., 3, :3], products[..., 3, 3]
        mean = np.asarray(np.linalg.solve(A, g[..., None])[..., 0], np.float64)
        square = square - np.sum(g * mean, axis=-1)
        log = -0.5 * (square + np.log(np.linalg.det(A)))
        linear = centre + (root @ mean[..., None])[..., 0]
        possible = rolls & np.all(linear[..., :2] > 0.0, axis=-1)  # compliances are positive
        log = np.where(beyond_peak | possible, log, -np.inf)
        return Solution(log, mean, A, white[..., :3, :], white[..., 3, :])

    def residuals(self, e: Ensemble) -> Array:
        """Return residuals (n, k) of the rows of draws with their own linear parameters [1]."""
        rows, _ = self.equations(e)
        return np.asarray(rows[:, 3] - (e.linear[:, None] @ rows[:, :3])[:, 0])

    def discrepancies(self, residual: Array, rng: np.random.Generator) -> dict[str, Array]:
        """Return columns of an `Ensemble` by whitened residuals (n, k): ``v_late``, ``depart_...``.

        ``v_late`` is a draw of the delay of v, a mean over the m runs with v; 0 without any.
        ``depart_eta`` and ``depart_slip`` are posterior means of the discrepancy of the tyre form,
        by its covariance with the rows.
        """
        clock, near = self.white @ self._errors_by("clock"), _correlation(self.z, DEPART_AT)
        count = clock.shape[1]
        # the delays given the white residuals r, with C = clock: mean C'r, covariance 1 - C'C
        root = np.linalg.cholesky(np.eye(count) - clock.T @ clock)
        late = residual @ clock + rng.standard_normal((len(residual), count)) @ root.T  # (n, m)
        return {"v_late": _CLOCK * np.sum(late, axis=1) / max(count, 1)} | {
            f"depart_{name}": _DISCREPANCY[name] * (residual @ self.white * size) @ near
            for name, size in self.discrepancy_sizes.items()
        }


def _correlation(x: Array, y: Array) -> Array:
    """Return the correlation (a, b) of discrepancies at decelerations ``x`` (a,) and ``y`` (b,)."""
    return np.asarray(np.exp(-0.5 * ((x[:, None] - y) / CAR.form_length.mean) ** 2))
