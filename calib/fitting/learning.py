"""Learn from stops: weigh the draws that explain the ramps of a car by eta and slip of its stops.

    a draw, changes in the stop --regression--> eta, slip --> likelihood of the stop
    product over the stops --tempering--> weights --resampling--> draws

The changes in a stop are the group `stop` of `beliefs.csv`. They are integrated out: stiffness of
the road, inflation and scale of a_x as linear unknowns of the regression; the peak of the road by a
sum over some values, linearly around each; the pads' ratio by Laplace's method.

Where only few draws explain the stops, the model is wrong in another way (Holmes and Walker 2017,
doi:10.1093/biomet/asx010). So the likelihood is raised to a power below 1 where a stop, or all
stops together, would else leave an effective sample size below half the draws.
`tests/studies/results/learning.md` says how much is learned from stops.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.plain import counted
from calib.car.beliefs import DRY_PEAK, STIFFENING, STOP
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble
from calib.fitting.posterior import Posterior, resampled, tempering_step
from calib.fitting.regression import Regression
from calib.model.ramp import RampRun

_GROUPS = 4  # groups of blocks of a stop, whose deceleration hardly changes
_PEAKS = (-1.5, -0.5, 0.5, 1.5)  # values of ln of the peak of another road [standard deviations]
_WITHIN = 0.3  # scatter around each of these values, which are 1 apart [standard deviations]
_STEP = 0.02  # step of ln of a peak, or of ln of the pads' ratio, for a derivative [1]
_SEARCHES = 3  # steps of Newton's method to the likeliest pads
_LONGEST_STEP = 0.3  # of Newton's method, in ln of the pads' ratio [1]
_LARGEST_RMS = 3.0  # of the residuals over their errors, above which no draw explains a stop [1]


def learn(car: Vehicle, e: Posterior, stops: Sequence[RampRun]) -> tuple[Posterior, list[str]]:
    """Return the draws weighed by the ``stops``, and a remark on what each stop changes.

    Without a stop that has a likelihood the draws stay as they are.
    """
    remarks, total = [], np.zeros(e.size)
    for run in stops:
        log = log_likelihood(car, e, run)
        if not np.any(log):
            remarks.append(f"{run.name}: a stop without v, or that nothing explains, tells nothing")
            continue
        power = tempering_step(log, 1.0)
        total += power * log
        alone = _change(e, power * log, power)
        remarks.append(f"{run.name}: a stop, braked within 1 s; alone: {alone}")
    if not np.any(total):
        return e, remarks
    power = tempering_step(total, 1.0)
    together = f"{counted(len(stops), 'stop')} together: {_change(e, power * total, power)}"
    return e.take_with_pulls(resampled(power * total, 0.5)), [*remarks, together]


def _change(e: Ensemble, log: Array, power: float) -> str:
    """Return the change of the pads' ratio by weights of ln ``log`` (n,), in words."""
    weight, ratio = np.exp(log - log.max()), e.log_pad_ratio
    mean = np.average(ratio, weights=weight)
    sigma = math.sqrt(np.average((ratio - mean) ** 2, weights=weight))
    shift = 100.0 * (mean - float(np.mean(ratio)))
    widening = 100.0 * (sigma / float(np.std(ratio)) - 1.0)
    tempered = f" (its power: {power:.2f})" if power < 1.0 else ""
    return f"pads' ratio {shift:+.1f} %, its half width {widening:+.0f} %{tempered}"


def log_likelihood(car: Vehicle, e: Ensemble, run: RampRun) -> Array:
    """Return ln of the likelihood of draws (n,) by one stop.

    It is 0 for a stop without v, and where no draw explains the stop. It holds while the
    deceleration hardly changes: a change of the peak then scales the slip of an axle by one factor.
    """
    if run.slip is None or not (run.braked.any() and run.rolling.size):
        return np.zeros(e.size)
    regression = Regression(car, [run], _GROUPS)
    by_road = [
        math.log(share) + _log_likelihood_on(regression, replace(e, peak=peak), stiffer, sigmas)
        for share, peak, stiffer, sigmas in _roads(e)
    ]
    log = np.asarray(np.logaddexp.reduce(by_road))
    explained = -2.0 * float(log.max()) < _LARGEST_RMS**2 * regression.z.size
    return log if explained else np.zeros(e.size)


def _roads(e: Ensemble) -> Iterator[tuple[float, Array, Array, tuple[float, float]]]:
    """Yield the roads of a stop: share, peak, ln of stiffness over the ramp's, and two sigmas.

    Peak and ln of stiffness are (n,), the sigmas are those of ln of peak and of ln of stiffness.
    """
    peaks, stiffness = STOP.log_peak, STOP.log_stiffness
    shares = peaks.share / peaks.share.sum()
    for i, case in enumerate(peaks.cases):
        on_other = case == "other road"
        values = np.array(_PEAKS if on_other else (0.0,))
        weights = np.exp(-0.5 * values**2)
        sigmas = float(peaks.sigma[i]) * (_WITHIN if on_other else 1.0), float(stiffness.sigma[i])
        for x, weight in zip(values, shares[i] * weights / weights.sum(), strict=True):
            peak, stiffer = np.exp(peaks.mean[i] + peaks.sigma[i] * x), stiffness.mean[i]
            if on_other:  # its peak is absolute, those of the others are relative to the ramp's
                stiffer = stiffer + STIFFENING * np.log(peak / DRY_PEAK)
            else:
                peak = peak * e.peak
            yield float(weight), peak * np.ones(e.size), stiffer * np.ones(e.size), sigmas


def _log_likelihood_on(
    regression: Regression, e: Ensemble, stiffer: Array, sigmas: tuple[float, float]
) -> Array:
    """Return ln of the likelihood of draws (n,) on one road, integrated over all changes.

    ``e`` has the peak of the road; ``stiffer`` and ``sigmas`` as in `_roads`.
    """
    # Slips per compliance, means over the rows of eta: (2, n, 2) at the peak and a step beyond. Of
    # the equations (n, unknowns, rows) those of eta are the first half.
    rows = [regression.equations(replace(e, peak=x * e.peak))[0] for x in (1.0, math.exp(_STEP))]
    slips = np.stack([np.abs(np.split(x[:, :2], 2, axis=-1)[0]).mean(axis=-1) for x in rows])
    by_peak = np.log(slips[1] / slips[0]) / _STEP * sigmas[0]  # (n, 2)
    # covariance (n, 2, 2) of ln of the compliances: by peak, stiffness and a_x, and each tyre
    alike = sigmas[1] ** 2 + float(STOP.a_x_scale.sigma[0]) ** 2
    apart = float(STOP.log_tyre.sigma[0]) ** 2 * np.eye(2)
    root_of_logs = np.linalg.cholesky(alike + apart + by_peak[:, :, None] * by_peak[:, None])
    centre, root = e.linear, np.zeros((e.size, 3, 3))  # `linear` makes a new array
    centre[:, :2] *= np.exp(-stiffer)[:, None]
    root[:, :2, :2] = centre[:, :2, None] * root_of_logs
    loaded, change = regression.loaded(e), np.zeros(e.size)  # change of ln of the pads' ratio

    def log_evidence(x: Array) -> Array:
        changed = replace(e, log_pad_ratio=e.log_pad_ratio + x)
        return regression.solve(changed, centre, root, loaded, beyond_peak=True).log_evidence

    for _ in range(_SEARCHES):
        low, log, high = (log_evidence(change + x) for x in (-_STEP, 0.0, _STEP))
        slope, curvature = (high - low) / (2.0 * _STEP), (2.0 * log - low - high) / _STEP**2
        # at least 1, where eta and slip hardly depend on the pads
        precision = np.maximum(curvature, np.maximum(np.abs(slope) / _LONGEST_STEP, 1.0))
        change = change + slope / precision
    # Laplace: the likelihood of the change is normal; the prior of the change is a mixture
    pads, of_likelihood = STOP.log_pad_ratio, 1.0 / precision[:, None]
    variance = pads.sigma**2 + of_likelihood
    density = np.exp(-0.5 * (change[:, None] - pads.mean) ** 2 / variance)
    factor = np.sqrt(of_likelihood / variance) * density @ (pads.share / pads.share.sum())
    return np.asarray(log_evidence(change) + np.log(factor))
