r"""One tyre curve and the pad ratio from ramps, by least squares in what is measured.

The pads' pressure gives the forces of both axles up to a common scale s and the ratio rho of the
pads; s follows from the sum of forces. The forces give the slips through the compliance of
`calib.physics.tyre`, and the slips give what the sensors see:

    p --(2)--> F_f, F_r --tyre--> slip_f, slip_r --(22)--> eta            always
                                              \----------> mean slip     where v is known

Unknown: c, b2, b3, q of the tyre, the clock offset between v and the wheels, rho, and per run the
zero of eta and of the slip. All noise is in the wheel speeds and v; the force side is smooth. From
eta alone c and rho are one number: the prior keeps them apart and the covariance says so.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.names import G
from calib.physics.balance import brake_forces, force_balance
from calib.physics.braking import BITE
from calib.physics.effects.effects import Effects
from calib.physics.forces import mean_slip, speed_ratio
from calib.physics.tyre import Tyre
from calib.physics.vehicle import Vehicle
from calib.signals.blocks import Blocks
from calib.signals.noise import SensorNoise, long_run_density
from calib.statistics.mixture_posterior import mixture_posterior

Array = NDArray[np.float64]

PARAMETERS = (
    "log_compliance",
    "curvature_2",
    "curvature_3",
    "load_exponent",
    "clock_offset",
    "log_pad_ratio",
)
PRIOR_MEAN = np.array([np.log(0.04), 0.05, 0.4, 0.03, 0.0, 0.0])
PRIOR_SIGMA = np.array([1.0, 0.2, 0.4, 0.05, 0.01, 0.15])
"""Passenger-car tyres: slip stiffness 10 to 70 per load; curvature between brush (b2 = 1/3,
b3 = 0.2 at a peak of 1) and Magic Formula (b2 = 0, b3 = 0.45); stiffness per load falls by 0 to
10 % when the load doubles. Sensors on a bus are within 10 ms of each other. Pads within 15 % of the
file."""

NOMINAL_ODDS = 9.0
"""Odds that the pads of a calibration run have the ratio of the vehicle file. A ramp with other
pads than declared is the exception; a clear one (10 % and more) is found all the same."""

PAD_TOLERANCE = 0.01
"""How exactly pads that are as declared have the declared ratio (standard deviation)."""

MODEL_ERROR = 0.01
"""What the tyre curve itself is off, relative to the slip: about what third-party plants show."""

MIN_SPEED = 5.0
"""Below this v [m/s] the clock offset and the noise of v swallow the slip."""


@dataclass(frozen=True)
class RampRun:
    """One ramp, ready to fit: blocks, what they say, and what is known beforehand. SI, shapes (k,).

    ``load_f``, ``load_r`` axle loads [N]; ``moment_f``, ``moment_r`` what slows the wheels besides
    the brake, inertia included, as a force at the road [N]; ``brake_sum`` brake force of both axles
    that the deceleration demands [N]; ``use`` blocks that take part.
    """

    name: str
    blocks: Blocks
    noise: SensorNoise
    load_f: Array
    load_r: Array
    moment_f: Array
    moment_r: Array
    brake_sum: Array
    use: NDArray[np.bool_]


@dataclass(frozen=True)
class Identified:
    """Mean (6,) and covariance (6, 6) of `PARAMETERS`, and what each run gave.

    ``eta_zero``, ``slip_zero`` per run [1]; ``pad_scale`` common factor on nominal pads at the
    identified ratio, per run [1]; ``residuals`` of eta and of slip over their noise, per run, over
    the blocks used, (k,); ``chi2`` mean square of them; ``nominal_weight`` of the file's pad ratio.
    """

    mean: Array
    covariance: Array
    eta_zero: tuple[float, ...]
    slip_zero: tuple[float, ...]
    pad_scale: tuple[float, ...]
    residuals: tuple[tuple[Array, Array], ...]
    chi2: float
    nominal_weight: float

    @property
    def tyre(self) -> Tyre:
        """The tyre at the mean."""
        return Tyre(*(float(x) for x in self.mean[:4]))


def prepare(
    vehicle: Vehicle, name: str, b: Blocks, noise: SensorNoise, effects: Effects
) -> RampRun:
    """Loads, resistances and the demanded brake force of each block.

    A block in which an axle would lift holds a glitch of a_x: it has no loads and no part.
    """
    forces = force_balance(vehicle, effects, b.end, b.speed, b.z, b.p_f, (b.spin_f, b.spin_r))
    stands = np.minimum(forces.load_f, forces.load_r) > 0.0
    # the last blocks of a stop hold the jerk at standstill
    use = (b.speed > MIN_SPEED) & (b.end < b.end[-1] - 0.1) & stands
    return RampRun(
        name=name,
        blocks=b,
        noise=noise,
        load_f=np.where(stands, forces.load_f, np.nan),
        load_r=np.where(stands, forces.load_r, np.nan),
        moment_f=forces.moment_f,
        moment_r=forces.moment_r,
        brake_sum=forces.demanded,
        use=np.asarray(use),
    )


def pad_scale(run: RampRun, B_f: Array, B_r: Array) -> float:
    """Common factor on the brake forces that makes their sum the demanded one, least squares."""
    braked = run.use & (np.maximum(run.blocks.p_f, run.blocks.p_r) > BITE)
    total = (B_f + B_r)[braked]
    return float(total @ run.brake_sum[braked] / (total @ total))


def normalised_forces(
    vehicle: Vehicle, run: RampRun, log_ratio: float
) -> tuple[Array, Array, float]:
    """F_f, F_r [1] of the blocks from pressure, and the pad scale, at a pad ratio."""
    b = run.blocks
    biting = np.maximum(b.p_f, b.p_r) > 0.5 * BITE
    B_f, B_r = brake_forces(vehicle, b.p_f * biting, b.p_r * biting, log_ratio)
    scale = pad_scale(run, B_f, B_r)
    F_f = (scale * B_f + run.moment_f) / run.load_f
    F_r = (scale * B_r + run.moment_r) / run.load_r
    return F_f, F_r, scale


def predict(
    vehicle: Vehicle, run: RampRun, parameters: Array, eta_zero: float, slip_zero: float
) -> tuple[Array, Array]:
    """Eta and the load-weighted mean slip [1] that the sensors would show, without noise."""
    tyre = Tyre(*parameters[:4])
    F_f, F_r, _ = normalised_forces(vehicle, run, parameters[5])
    half_weight = 0.5 * vehicle.weight
    slip_f = tyre.slip(F_f, run.load_f / half_weight)
    slip_r = tyre.slip(F_r, run.load_r / half_weight)
    share = run.load_f / vehicle.weight
    mean = share * slip_f + (1.0 - share) * slip_r
    b = run.blocks
    lag = G * b.z * parameters[4] / np.maximum(b.speed, MIN_SPEED)
    return speed_ratio(slip_f, slip_r) * (1.0 + eta_zero), mean + slip_zero + lag


def _measured_slip(vehicle: Vehicle, run: RampRun) -> Array | None:
    b = run.blocks
    return None if b.v is None else mean_slip(vehicle, run.load_f, b.omega_f, b.omega_r, b.v)


def sigma_eta(noise: SensorNoise, b: Blocks, signal: Array) -> Array:
    """Standard deviation of eta of a block [1]: two axle means, and the model error."""
    sensor = np.sqrt(2.0 / b.length) * noise.omega / _turning(b)
    return np.asarray(np.hypot(sensor, MODEL_ERROR * signal))


def _turning(b: Blocks) -> Array:
    """Front wheel speed [rad/s], at least 1: what turns slower takes no part."""
    return np.maximum(b.omega_f, 1.0)


def sigma_slip(noise: SensorNoise, b: Blocks, signal: Array) -> Array:
    """Standard deviation of the mean slip of a block [1]: v, the wheels, and the model error."""
    speed = np.maximum(b.speed, MIN_SPEED)  # slower blocks take no part
    sensor = np.hypot(noise.v / speed, noise.omega / _turning(b)) / np.sqrt(b.length)
    return np.asarray(np.hypot(sensor, MODEL_ERROR * signal))


def identify(vehicle: Vehicle, runs: list[RampRun]) -> tuple[Identified, list[RampRun]]:
    """Fit all runs together, twice: what the residual holds over the sensors' noise is noise too.

    The road shakes both wheels of an axle alike, and no tyre curve is exact; neither shows between
    left and right. The runs come back with the noise that was used.
    """
    first = identify_once(vehicle, runs)
    louder = [
        replace(run, noise=_honest(run, *residual))
        for run, residual in zip(runs, first.residuals, strict=True)
    ]
    return identify_once(vehicle, louder), louder


def _honest(run: RampRun, eta: Array, slip: Array) -> SensorNoise:
    """Noise of a run, raised where the long-run residual is larger than it promised."""
    step = run.blocks.length
    expected = np.sqrt(step)
    by_eta = max(1.0, long_run_density(eta, step) / expected)
    by_slip = max(1.0, long_run_density(slip, step) / expected) if slip.size else 1.0
    return replace(run.noise, omega=run.noise.omega * by_eta, v=run.noise.v * by_slip)


def identify_once(vehicle: Vehicle, runs: list[RampRun]) -> Identified:
    """Fit all runs together: one tyre, one pad ratio, zeros per run.

    Huber weights past three sigma. The pad ratio is then weighed against its nominal value
    (`calib.statistics.mixture_posterior`), and the rest follows it along their correlation.
    """
    from scipy.optimize import least_squares

    slips = [_measured_slip(vehicle, run) for run in runs]

    def residuals(x: Array) -> list[tuple[Array, Array]]:
        out = []
        for i, (run, slip) in enumerate(zip(runs, slips, strict=True)):
            eta, mean = predict(vehicle, run, x[:6], x[6 + 2 * i], x[7 + 2 * i])
            b = run.blocks
            e = (b.eta - eta) / sigma_eta(run.noise, b, b.eta - 1.0)
            s = np.empty(0) if slip is None else (slip - mean) / sigma_slip(run.noise, b, slip)
            out.append((e[run.use], s[run.use] if slip is not None else s))
        return out

    def objective(x: Array) -> Array:
        data = [part for pair in residuals(x) for part in pair]
        zeros = x[6:] / 0.02  # radii agree within 2 %
        return np.concatenate([(x[:6] - PRIOR_MEAN) / PRIOR_SIGMA, zeros, *data])

    start = np.concatenate([PRIOR_MEAN, np.zeros(2 * len(runs))])
    scale = np.concatenate([PRIOR_SIGMA, np.full(2 * len(runs), 1e-3)])
    # central differences: with one-sided ones a rounding error of a log shows in the fifth digit
    fit = least_squares(objective, start, jac="3-point", x_scale=scale, loss="huber", f_scale=3.0)
    covariance = np.linalg.inv(fit.jac.T @ fit.jac)
    x, covariance, weight = _weigh_ratio(fit.x, covariance)
    rest = residuals(x)
    flat = np.concatenate([part for pair in rest for part in pair])
    return Identified(
        mean=x[:6],
        covariance=covariance[:6, :6],
        eta_zero=tuple(float(v) for v in x[6::2]),
        slip_zero=tuple(float(v) for v in x[7::2]),
        pad_scale=tuple(normalised_forces(vehicle, run, x[5])[2] for run in runs),
        residuals=tuple(rest),
        chi2=float(np.mean(flat**2)),
        nominal_weight=weight,
    )


def _weigh_ratio(x: Array, covariance: Array) -> tuple[Array, Array, float]:
    """Replace the marginal of the pad ratio by the weighed one; the rest keeps its conditionals."""
    variance = covariance[5, 5]
    found = mixture_posterior(x[5], np.sqrt(variance), PRIOR_SIGMA[5], NOMINAL_ODDS, PAD_TOLERANCE)
    along = covariance[:, 5] / variance
    moved = x + along * (found.mean - x[5])
    spread = covariance + np.outer(along, along) * (found.sigma**2 - variance)
    return moved, spread, float(found.nominal_weight)
