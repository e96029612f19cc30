"""What a fit says: its effects by name, its base, and the drive that would tell it from a rival.

The drive is chosen by one linear step, which is right for small effects, and the order of magnitude
for large ones:

    columns of the logs + columns of a manoeuvre --> less what pads, tyres, effects do --> sigma
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
from calib.diagnosis.explanation.base import OWN, PADS, Base
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, residuals, thinned, whiten
from calib.diagnosis.explanation.fit import Fit, innovations, linearised, runs_of
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import based
from calib.diagnosis.explanation.predict import ObservedRun, predict, run_of
from calib.diagnosis.verdict import Verdict
from calib.logs.log import Log

_TESTS = {
    # first speed [m/s], pressure [bar], its rise [bar/s], period of its applications [s]
    "coast down from 130 km/h": (36.0, 0.0, 1e9, 12.0),
    "coast down from 50 km/h": (14.0, 0.0, 1e9, 12.0),
    "slow ramp to 45 bar": (33.0, 45.0, 5.0, 12.0),
    "light stop at 8 bar from 60 km/h": (17.0, 8.0, 1e9, 12.0),
    "hard stop at 45 bar from 120 km/h": (33.0, 45.0, 1e9, 12.0),
    "applications of 20 bar, 1 s on and 1 s off": (30.0, 20.0, 1e9, 2.0),
}
"""Tests that any proving ground can do; an application begins after 1 s."""


def _intervals(fit: Fit) -> list[tuple[Base, Effects]]:
    """All parameters at the lower ends of their 95 % intervals, as they are, and at the upper ends.

    A tyre's own form and what logs have of their own are counted. Intervals are wider where more
    than noise is left, and cut at what a fit allows. Pads are as uncertain as the mass besides.
    """
    half = Z95 * np.sqrt(np.maximum(np.diag(fit.covariance), 0.0) * max(fit.reduced, 1.0))
    half[PADS] = np.hypot(half[PADS], Z95 * fit.problem.vehicle.mass_tolerance)
    low, high = fit.prior.low[: half.size], fit.prior.high[: half.size]
    ends = (np.clip(fit.state.x + s * half, low, high) for s in (-1, 0, 1))
    return [based(fit.problem, fit.hypothesis, replace(fit.state, x=x)) for x in ends]


def base_estimates(fit: Fit) -> dict[str, ParameterEstimate]:
    """Pads and tyre with intervals; ``rolling_radius`` over that of the file."""
    names = ("pad_friction_f", "pad_friction_r", "tyre_stiffness", "tyre_peak", "rolling_radius")
    ends = [
        (b.pad_friction_f, b.pad_friction_r, b.tyre.stiffness, b.tyre.peak, b.radius)
        for b, _ in _intervals(fit)
    ]
    return {name: _estimate(of, "1") for name, *of in zip(names, *ends, strict=True)}


def named(verdict: Verdict) -> tuple[Named, ...]:
    """Every effect of the best fit, with evidence, and what is as likely."""
    best, search, whole = verdict.best, verdict.search, verdict.best.effects
    car_effects = best.problem.vehicle.effects
    tried = sorted(search.fits.fitted.values(), key=lambda e: -e.log_evidence)
    ends = [effects for _, effects in _intervals(best)]
    logs = (best.runs, runs_of(search.holdouts.problem, verdict.after.random_effects))
    others = sorted({n for e in verdict.rivals for n in e.names} - set(best.names))
    apart = (best_drive(best, rival) for rival in verdict.rivals[:1])
    separate = "".join(f"{drive} ({sigma:.0f} sigma apart)" for drive, sigma in apart)
    out = []
    for name in best.names:
        without = whole.without(name).with_(car_effects.only(name))
        rises = (_reduced(best, without, runs) - _reduced(best, whole, runs) for runs in logs)
        runners_up = (
            RunnerUp(" + ".join(e.names), search.base.reduced - e.reduced)
            for e in tried
            if e.names and name not in e.names and e.reduced < search.base.reduced
        )
        out.append(
            Named(
                name=name,
                parameters={
                    p.name: _estimate((e.parameters[name][p.name] for e in ends), p.unit)
                    for p in definition(whole, name).card.parameters
                },
                where=_where(best, name, without),
                evidence=Evidence(*rises),
                runner_up=next(runners_up, None),
                indistinguishable_from=tuple(others),
                separate_by=separate,
            )
        )
    return tuple(out)


def _estimate(ends: Iterable[float], unit: str) -> ParameterEstimate:
    low, value, high = ends
    return ParameterEstimate(value, unit, (low, high))


def _reduced(fit: Fit, effects: Effects, runs: list[ObservedRun]) -> float:
    """Mean squared innovation of some runs with some effects, all else as in a fit."""
    r = np.concatenate([innovations(fit.problem, fit.base, effects, run) for run in runs])
    return float(r @ r) / r.size


def _where(fit: Fit, name: str, without: Effects) -> Where:
    """Where an effect acts: what changes ``without`` it.

    The channel and the ranges in which innovations change most, and the wheels that turn otherwise.
    """
    vehicle, wheels, rows = fit.problem.vehicle, np.zeros(len(WHEELS)), []
    for run in fit.runs:
        whole, less = (
            predict(vehicle, fit.base, effects, run) for effects in (fit.effects, without)
        )
        wheels += np.sum((less.omega - whole.omega) ** 2, axis=1)
        change = whiten(residuals(run, less) - residuals(run, whole), fit.problem.noise)
        power = by_channel(change**2)
        heat = np.zeros_like(run.v) if run.temperature_f is None else run.temperature_f
        along = thinned(run, np.stack([run.p_mc, run.v, heat]))
        rows.append(np.vstack([power, along[:, -power.shape[1] :]]))
    power, drivers = np.split(np.hstack(rows), [len(CHANNELS)])
    pressure, speed, temperature = (_range_of(x, np.sum(power, axis=0)) for x in drivers)
    warm = all(run.temperature_f is not None for run in fit.runs)
    on_wheels = acts_on(definition(vehicle.effects, name), AT_WHEELS)
    front, rear = np.sum(wheels.reshape(2, 2), axis=1).tolist() if on_wheels else (0.0, 0.0)
    if front + rear < 1e-9:
        axle = "body"
    elif min(front, rear) > 0.2 * max(front, rear):
        axle = "both"
    else:
        axle = "front" if front > rear else "rear"
    channel = CHANNELS[int(np.argmax(np.sum(power, axis=1)))]
    return Where(channel, axle, pressure, speed, temperature if warm else None)


def _range_of(driver: Array, weight: Array) -> tuple[float, float]:
    """The range of a driver that holds the middle 80 % of the weight."""
    some = weight + 1e-12  # where nothing is left, all counts alike
    low, high = np.quantile(driver, (0.1, 0.9), weights=some, method="inverted_cdf")
    return float(low), float(high)


def best_drive(fit: Fit, other: Fit) -> tuple[str, float]:
    """The manoeuvre that best tells another fit from this one.

    And how far apart they are in the logs and in that together [sigma].
    """
    problem = replace(fit.problem, runs=manoeuvres(fit))
    state = replace(fit.state, random_effects=np.zeros((len(problem.runs), len(OWN))))
    driven = linearised(problem, fit.hypothesis, state)
    logs, tests = (_products(one, other) for one in (fit, driven))
    sizes = [fit.marginal([*logs, test]).beyond()[0].item() for test in tests]
    best = int(np.argmax(sizes))
    return problem.runs[best].source, float(np.sqrt(max(sizes[best], 0.0)))


def _products(fit: Fit, other: Fit) -> list[Products]:
    """Inner products of each log, with what another fit changes behind its own columns."""
    changes = [
        innovations(fit.problem, other.base, other.effects, run, lag) - r
        for run, lag, r in zip(fit.runs, fit.lags, fit.innovations, strict=True)
    ]
    return fit.products_with([change[None] for change in changes])


def manoeuvres(fit: Fit) -> tuple[ObservedRun, ...]:
    """The `_TESTS` with a rough course of speed: 70 bar give 1 g."""
    warm, out = fit.problem.runs[0].temperature_f is not None, []
    time = 0.01 * np.arange(1200)
    for name, (v0, most, rise, period) in _TESTS.items():
        p = BAR * np.clip(rise * (time % period - 1.0), 0.0, most)
        z = p / 70e5
        v = np.maximum(v0 - 0.01 * np.cumsum(z * G), 2.0)
        channels = {"time": time, "p_mc": p, "a_x": -z * G, "v": v}
        turn, heat = v / fit.problem.vehicle.front.rolling_radius, 100.0 + 0.3 * (v0**2 - v**2)
        channels |= {f"omega_{wheel}": turn for wheel in WHEELS}
        channels |= dict.fromkeys(("T_disc_f", "T_disc_r") if warm else (), heat)
        out.append(run_of(Log(name, name, "", channels)))
    return tuple(out)
