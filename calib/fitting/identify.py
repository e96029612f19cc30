"""One tyre curve and the pad ratio from ramps, by least squares in what is measured.

Unknown: the parameters of `calib.model.parameters`, and per run the zeros of eta and slip, how
the ratio of the pads changes along it, or, where one axle brakes alone, how its tyres depart; what
they predict: `calib.model.ramp`. All noise is
in the wheel speeds and v; the force side is smooth. From eta alone compliance and pad ratio are one
number: the prior keeps them apart and the covariance says so. A ramp with one axle only, whose
share is known, parts them.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calib.car.vehicle import Vehicle
from calib.fitting.pad_level import level_residuals, level_spread
from calib.fitting.weigh_ratio import weigh_ratio
from calib.model.covariance_parts import Parts, information_parts
from calib.model.parameters import AT, COUNT, RampParameters, parameters_of, priors_with
from calib.model.ramp import (
    AS_OTHERS,
    OfRun,
    RampRun,
    normalised_forces,
    predict,
    sigma_eta,
    sigma_slip,
)
from calib.model.resistance import Resistance
from calib.model.settings import SETTINGS
from calib.run.noise import SensorNoise, long_run_density
from calib.table.table import TyrePosterior, Value

Array = NDArray[np.float64]


_OF_RUN = OfRun(
    eta_zero=SETTINGS.zero_sigma,
    slip_zero=SETTINGS.zero_sigma,
    softer=SETTINGS.tyres_repeat,
    drift=SETTINGS.ratio_drift,
    pressure_apart=SETTINGS.pressure_apart,
)
"""Sigma of the prior, about zero, of what each run has of its own."""

SCALE = _OF_RUN._replace(eta_zero=1e-3, slip_zero=1e-3)
"""Size of a usual change of the same: lead-ins tell the zeros."""

ROUGH, EXACT = 1e-3, 1e-10
"""Relative fall of the sum of squares at which a fit ends: on the way, and at last."""


@dataclass(frozen=True)
class Identified:
    """The posterior of the parameters, and what each run gave.

    ``posterior`` over the names of `RampParameters`; ``eta_zero``, ``slip_zero`` per run [1];
    ``pad_scale`` common factor on nominal pads at the identified ratio, per run that brakes both
    axles [1]; ``residuals`` of eta and of slip over their noise, per run, over the blocks used,
    (k,); ``chi2`` mean square of them; ``nominal_weight`` of the file's pad ratio; ``parts`` of the
    posterior's covariance by what each comes from, (k, k).
    """

    posterior: TyrePosterior
    eta_zero: tuple[float, ...]
    slip_zero: tuple[float, ...]
    pad_scale: tuple[float, ...]
    residuals: tuple[tuple[Array, Array], ...]
    chi2: float
    nominal_weight: float
    parts: Parts

    @property
    def mean(self) -> RampParameters[float]:
        """The parameters at the mean."""
        return parameters_of(self.posterior)


def identify(
    vehicle: Vehicle,
    runs: list[RampRun],
    known: Resistance | None = None,
    start: Identified | None = None,
    stated: Value | None = None,
) -> tuple[Identified, list[RampRun]]:
    """Fit all runs together, twice: what the residual holds over the sensors' noise is noise too.

    The road shakes both wheels of an axle alike, and no tyre curve is exact; neither shows between
    left and right. The runs come back with the noise that was used. ``known`` the resistance that
    they were prepared with; None for runs that know the level of their pads exactly. ``start`` a
    fit of a part of the same runs, where there is one. ``stated`` what the user says of the pads'
    ratio, in place of its prior.
    """
    first = identify_once(vehicle, runs, known, start, stated)
    louder = [
        replace(run, noise=_honest(run, *residual))
        for run, residual in zip(runs, first.residuals, strict=True)
    ]
    return identify_once(vehicle, louder, known, start, stated), louder


def _honest(run: RampRun, eta: Array, slip: Array) -> SensorNoise:
    """Noise of a run, raised where the long-run residual is larger than it promised."""
    step = run.blocks.length
    expected = np.sqrt(step)
    by_eta = max(1.0, long_run_density(eta, step) / expected)
    by_slip = max(1.0, long_run_density(slip, step) / expected) if slip.size else 1.0
    return replace(run.noise, omega=run.noise.omega * by_eta, v=run.noise.v * by_slip)


def identify_once(
    vehicle: Vehicle,
    runs: list[RampRun],
    known: Resistance | None = None,
    start: Identified | None = None,
    stated: Value | None = None,
) -> Identified:
    """Fit all runs together: one tyre, one pad ratio, one level of the pads, zeros per run.

    Data past ``huber`` sigma have Huber's weights, priors have not: far out, less than their square
    would let pads and tyres imitate each other without end. Pads and tyres that are as declared are
    then weighed against such that are not (`weigh_ratio`). ``start``, ``stated`` as `identify` has
    them.
    """
    spread = level_spread(vehicle, runs, known)
    begin = None if start is None else _vector(start)
    best, jacobian, _ = _least_squares(vehicle, runs, spread, begin, stated=stated)
    weighed = weigh_ratio(best, information_parts(runs, jacobian), stated)
    parameters, own = _parts(runs, weighed.mean)
    rest = _residuals(vehicle, runs, weighed.mean)
    parts = {part: share[:COUNT, :COUNT] for part, share in weighed.parts.items()}
    flat = np.concatenate([part for pair in rest for part in pair])
    return Identified(
        posterior=TyrePosterior(
            names=RampParameters._fields,
            mean=tuple(float(v) for v in parameters),
            covariance=_rows(sum(parts.values(), np.zeros((COUNT, COUNT)))),
            scatter=_rows(weighed.scatter[:COUNT, :COUNT]),
        ),
        eta_zero=tuple(one.eta_zero for one in own),
        slip_zero=tuple(one.slip_zero for one in own),
        pad_scale=tuple(
            normalised_forces(vehicle, run, parameters.log_pad_ratio)[2]
            for run in runs
            if run.only is None
        ),
        residuals=tuple(rest),
        chi2=float(np.mean(flat**2)),
        nominal_weight=weighed.declared_weight,
        parts=parts,
    )


def misfits(
    vehicle: Vehicle,
    explanations: list[list[RampRun]],
    known: Resistance | None = None,
    stated: Value | None = None,
) -> list[float]:
    """Sum of the squares of residuals and priors [1] with each explanation of the same blocks.

    Data past ``huber`` sigma count with Huber's loss, as in the fit. Two explanations differ by
    twice the logarithm of their odds, but for their volumes. The first one is fitted in full, the
    others from where it ended, so that none looks better than it is. ``stated`` as `identify` has
    it.
    """
    spread = level_spread(vehicle, explanations[0], known)
    start, _, loss = _least_squares(vehicle, explanations[0], spread, stated=stated)
    others = (
        _least_squares(vehicle, runs, spread, start, stated=stated, roughly=True)[2]
        for runs in explanations[1:]
    )
    return [loss, *others]


def _rows(matrix: Array) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(float(v) for v in row) for row in matrix)


def _parts(runs: list[RampRun], x: Array) -> tuple[RampParameters[float], list[OfRun[float]]]:
    """The parameters, and what each run has of its own."""
    own = x[COUNT:].reshape(len(runs), -1).tolist()
    return RampParameters(*x[:COUNT]), [OfRun(*values) for values in own]


def _vector(found: Identified) -> Array:
    """Parameters and zeros of a fit as one vector; all else of the runs as usual."""
    own = zip(found.eta_zero, found.slip_zero, strict=True)
    zeros = [AS_OTHERS._replace(eta_zero=eta, slip_zero=slip) for eta, slip in own]
    return np.concatenate([found.mean, *zeros])


def _least_squares(
    vehicle: Vehicle,
    runs: list[RampRun],
    level_sigma: Array,
    start: Array | None = None,
    *,
    stated: Value | None = None,
    roughly: bool = False,
) -> tuple[Array, Array, float]:
    """Most probable parameters and zeros, the Jacobian of all residuals there, and their loss.

    Its rows: the priors of the parameters and of what the runs have of their own, then the data run
    by run, then the levels of the pads, ``level_sigma`` about the common one.

    Without a ``start`` first with equal tyres on both axles, then from there with all parameters:
    far from it, unlike pads and unlike tyres can imitate each other.
    """
    from scipy.optimize import least_squares

    priors = priors_with(stated)
    sigma = [prior.sigma for prior in priors]
    spread = np.array([*sigma, *_OF_RUN * len(runs)])
    scale = np.array([*sigma, *SCALE * len(runs)])
    centre = np.zeros(spread.size)
    centre[:COUNT] = [prior.mean for prior in priors]
    x = centre.copy() if start is None else start.copy()

    def objective(part: Array, free: NDArray[np.int64]) -> Array:
        x[free] = part
        data = [one for pair in _residuals(vehicle, runs, x) for one in pair]
        level = level_residuals(vehicle, runs, x[AT.log_pad_ratio], level_sigma)
        return np.concatenate([(x - centre) / spread, *data, level])

    every = np.arange(x.size)
    equal = np.delete(every, [AT.log_tyre_ratio, AT.radius_load])
    # the last one with central differences: with one-sided ones a rounding error of a log shows in
    # the fifth digit
    last = (every, "2-point", ROUGH) if roughly else (every, "3-point", EXACT)
    for free, jac, tolerance in (last,) if start is not None else ((equal, "2-point", ROUGH), last):
        fit = least_squares(
            objective,
            x[free],
            jac=jac,
            x_scale=scale[free],
            loss=partial(_huber_of_data, x.size),
            f_scale=SETTINGS.huber,
            ftol=tolerance,
            args=(free,),
        )
        x[free] = fit.x
    return fit.x, np.asarray(fit.jac), 2.0 * float(fit.cost)


def _huber_of_data(priors: int, z: Array) -> Array:
    """Huber's loss and its two derivatives (3, n) by ``z`` (n,), squares over that of its scale.

    The first rows are ``priors``, and stay squares however far they are.
    """
    far = (z > 1.0) & (np.arange(z.size) >= priors)
    root = np.sqrt(np.where(far, z, 1.0))
    return np.array(
        [np.where(far, 2.0 * root - 1.0, z), 1.0 / root, np.where(far, -0.5 / root**3, 0.0)]
    )


def _residuals(vehicle: Vehicle, runs: list[RampRun], x: Array) -> list[tuple[Array, Array]]:
    """Residuals of eta and of slip over their sigma, per run, over the blocks used."""
    parameters, of_runs = _parts(runs, x)
    out = []
    for run, own in zip(runs, of_runs, strict=True):
        eta, mean = predict(vehicle, run, parameters, own)
        b = run.blocks
        e = (b.eta - eta) / sigma_eta(run, run.since_rolling(b.eta))
        if run.slip is None:
            out.append((e[run.use], np.empty(0)))
        else:
            s = (run.slip - mean) / sigma_slip(run, run.since_rolling(run.slip))
            out.append((e[run.use], s[run.use]))
    return out
