"""Describe a fit: its effects by name, its base, and the drive that separates it from a rival.

The drive is the one in which the predictions of both fits differ most, without the part of the
difference that other pads, tyres and sizes of effects would explain. A linear model of all logs
and the drive gives that part; it is rough for large effects.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95
from calib.base.names import WHEELS, G
from calib.base.units import BAR
from calib.car.effects.catalogue import definition
from calib.car.effects.effect import AT_WHEELS, acts_on
from calib.car.effects.effects import Effects
from calib.diagnosis.diagnosis import Evidence, Named, ParameterEstimate, RunnerUp, Where
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, residuals, thinned, whiten
from calib.diagnosis.explanation.fit import Fit, innovations, linearised, runs_of
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import base_and_effects
from calib.diagnosis.explanation.predict import ObservedRun, predict, run_of
from calib.diagnosis.explanation.unknowns import PADS, RANDOM_EFFECTS, Base
from calib.diagnosis.search import Search
from calib.diagnosis.verdict import Verdict
from calib.logs.log import Log

_DRIVES = {  # drives that any proving ground can do; an application begins after 1 s
    # first speed [m/s], pressure [bar], its rise [bar/s], period of its applications [s]
    "coast down from 130 km/h": (36.0, 0.0, 1e9, 12.0),
    "coast down from 50 km/h": (14.0, 0.0, 1e9, 12.0),
    "slow ramp to 45 bar": (33.0, 45.0, 5.0, 12.0),
    "light stop at 8 bar from 60 km/h": (17.0, 8.0, 1e9, 12.0),
    "hard stop at 45 bar from 120 km/h": (33.0, 45.0, 1e9, 12.0),
    "applications of 20 bar, 1 s on and 1 s off": (30.0, 20.0, 1e9, 2.0),
}


def _intervals(fit: Fit) -> list[tuple[Base, Effects]]:
    """Base and effects at the lower ends of the 95 % intervals, the estimates, the upper ends.

    Tyre discrepancies and random effects are marginalised. Intervals are wider if more than noise
    is left. Those of pads include the uncertainty of the mass. All end at the bounds of the prior.
    """
    half = Z95 * np.sqrt(np.maximum(np.diag(fit.covariance), 0.0) * max(fit.mean_square, 1.0))
    half[PADS] = np.hypot(half[PADS], Z95 * fit.problem.vehicle.mass_tolerance)
    low, high = fit.prior.low[: half.size], fit.prior.high[: half.size]
    ends = (np.clip(fit.state.x + sign * half, low, high) for sign in (-1, 0, 1))
    return [base_and_effects(fit.problem, fit.hypothesis, replace(fit.state, x=x)) for x in ends]


def base_estimates(fit: Fit) -> dict[str, ParameterEstimate]:
    """Estimate pads, tyre and ``rolling_radius``, a factor on the file's radii, with intervals."""
    names = ("pad_friction_f", "pad_friction_r", "tyre_stiffness", "tyre_peak", "rolling_radius")
    ends = [
        (b.pad_friction_f, b.pad_friction_r, b.tyre.stiffness, b.tyre.peak, b.radius)
        for b, _ in _intervals(fit)
    ]
    ends_by_name = zip(names, zip(*ends, strict=True), strict=True)
    return {name: _estimate(values, "1") for name, values in ends_by_name}


def named(verdict: Verdict) -> tuple[Named, ...]:
    """Describe every effect of the best fit, with evidence, and names that are as likely."""
    best, search = verdict.best, verdict.search
    ends = [effects for _, effects in _intervals(best)]
    holdout_runs = runs_of(search.holdouts.problem, verdict.after.random_effects)
    others = {name for rival in verdict.rivals for name in rival.names} - set(best.names)
    separate = ""
    if verdict.rivals:
        drive, sigma = best_drive(best, verdict.rivals[0])
        separate = f"{drive} ({sigma:.0f} sigma apart)"
    collected = []
    for name in best.names:
        # the effect is left out, or as the vehicle file has it
        without = best.effects.without(name).with_(best.problem.vehicle.effects.only(name))
        parameters = {
            p.name: _estimate((e.parameters[name][p.name] for e in ends), p.unit)
            for p in definition(best.effects, name).card.parameters
        }
        collected.append(
            Named(
                name,
                parameters,
                where=_where(best, name, without),
                evidence=Evidence(*(_rise(best, without, x) for x in (best.runs, holdout_runs))),
                runner_up=_runner_up(search, name),
                indistinguishable_from=tuple(sorted(others)),
                separate_by=separate,
            )
        )
    return tuple(collected)


def _rise(fit: Fit, without: Effects, runs: list[ObservedRun]) -> float:
    """Rise of the mean squared innovation of ``runs`` if only the effects ``without`` act [1]."""
    full, less = (
        np.concatenate([innovations(fit.problem, fit.base, effects, run) for run in runs])
        for effects in (fit.effects, without)
    )
    return float(less @ less) / less.size - float(full @ full) / full.size


def _runner_up(search: Search, name: str) -> RunnerUp | None:
    """The most probable fit without ``name`` whose effects explain something, or None."""
    for fit in sorted(search.fits.fitted.values(), key=lambda f: -f.log_evidence):
        gain = search.base.mean_square - fit.mean_square
        if fit.names and name not in fit.names and gain > 0.0:
            return RunnerUp(" + ".join(fit.names), gain)
    return None


def _estimate(ends: Iterable[float], unit: str) -> ParameterEstimate:
    low, value, high = ends  # in the order of `_intervals`
    return ParameterEstimate(value, unit, (low, high))


def _where(fit: Fit, name: str, without: Effects) -> Where:
    """Find where an effect acts, by the changes of predictions ``without`` the effect.

    Channel and ranges are those of the largest changes. The axle is that whose wheel speeds change.
    """
    vehicle, wheels, rows = fit.problem.vehicle, np.zeros(len(WHEELS)), []
    for run in fit.runs:
        full = predict(vehicle, fit.base, fit.effects, run)
        less = predict(vehicle, fit.base, without, run)
        wheels += np.sum((less.omega - full.omega) ** 2, axis=1)
        change = whiten(residuals(run, less) - residuals(run, full), fit.problem.noise)
        power = by_channel(change**2)
        heat = np.zeros_like(run.v) if run.temperature_f is None else run.temperature_f
        drivers = thinned(run, np.stack([run.p_mc, run.v, heat]))
        rows.append(np.vstack([power, drivers[:, -power.shape[1] :]]))  # whitened: fewer samples
    power, drivers = np.split(np.hstack(rows), [len(CHANNELS)])  # of all runs, (6, n) and (3, n)
    pressure, speed, temperature = (_range_of(x, np.sum(power, axis=0)) for x in drivers)
    is_heat_logged = all(run.temperature_f is not None for run in fit.runs)
    axle = "body"
    if acts_on(definition(vehicle.effects, name), AT_WHEELS):
        axle = _axle_of(*np.sum(wheels.reshape(2, 2), axis=1).tolist())
    channel = CHANNELS[int(np.argmax(np.sum(power, axis=1)))]
    return Where(channel, axle, pressure, speed, temperature if is_heat_logged else None)


def _axle_of(front: float, rear: float) -> str:
    """Axle of an effect, from the squares of its changes of front and rear wheel speeds."""
    if front + rear < 1e-9:
        return "body"
    if min(front, rear) > 0.2 * max(front, rear):
        return "both"
    return "front" if front > rear else "rear"


def _range_of(driver: Array, weight: Array) -> tuple[float, float]:
    """The range of a driver that holds the middle 80 % of the ``weight``, both (n,)."""
    positive = weight + 1e-12  # equal weights if all are zero
    low, high = np.quantile(driver, (0.1, 0.9), weights=positive, method="inverted_cdf")
    return float(low), float(high)


def best_drive(fit: Fit, other: Fit) -> tuple[str, float]:
    """Return the drive that best separates two fits, and the distance of the fits then [sigma].

    The change from one fit to the other is one unknown, 0 for ``fit`` and 1 for ``other``. The
    distance is 1 over the sigma with which logs and drive show that unknown.
    """
    problem = replace(fit.problem, runs=manoeuvres(fit))
    random_effects = np.zeros((len(problem.runs), len(RANDOM_EFFECTS)))
    state = replace(fit.state, random_effects=random_effects)
    driven = linearised(problem, fit.hypothesis, state)
    logs, drives = _products(fit, other), _products(driven, other)
    # 1/sigma^2 of that unknown
    squares = [fit.marginal([*logs, drive]).eliminated()[0].item() for drive in drives]
    best = int(np.argmax(squares))
    return problem.runs[best].source, float(np.sqrt(max(squares[best], 0.0)))


def _products(fit: Fit, other: Fit) -> list[Products]:
    """Inner products of each log, with the change to the ``other`` fit as a further column."""
    changes = [
        innovations(fit.problem, other.base, other.effects, run, lag) - r
        for run, lag, r in zip(fit.runs, fit.lags, fit.innovations, strict=True)
    ]
    return fit.products_with([change[None] for change in changes])


def manoeuvres(fit: Fit) -> tuple[ObservedRun, ...]:
    """Return the `_DRIVES` as runs with a rough course of speed: 70 bar make 1 g."""
    has_heat, runs = fit.problem.runs[0].temperature_f is not None, []
    time = 0.01 * np.arange(1200)
    for name, (v0, p_max, rise, period) in _DRIVES.items():
        p = BAR * np.clip(rise * (time % period - 1.0), 0.0, p_max)
        z = p / 70e5
        v = np.maximum(v0 - 0.01 * np.cumsum(z * G), 2.0)
        channels = {"time": time, "p_mc": p, "a_x": -z * G, "v": v}
        omega = v / fit.problem.vehicle.front.rolling_radius
        heat = 100.0 + 0.3 * (v0**2 - v**2)  # [degC], from 100 degC at first, all discs alike
        channels |= {f"omega_{wheel}": omega for wheel in WHEELS}
        if has_heat:
            channels |= {"T_disc_f": heat, "T_disc_r": heat}
        runs.append(run_of(Log(name, name, "", channels)))
    return tuple(runs)
