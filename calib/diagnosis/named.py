"""What an explanation says: its effects by name, its base, and what the logs cannot tell.

For each question that they leave, the drive that would tell it best, by one linear step, which is
right for small effects, and the order of magnitude for large ones:

    columns of the logs + columns of a manoeuvre --> less what pads, tyres, effects do --> sigma
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import combinations, compress

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95
from calib.base.names import WHEELS, G
from calib.car.effects.catalogue import definition, every_effect
from calib.car.effects.effect import AT_WHEELS, acts_on
from calib.car.effects.effects import Effects
from calib.diagnosis.diagnosis import (
    Alike,
    Confusion,
    Evidence,
    Named,
    Pair,
    ParameterEstimate,
    RunnerUp,
    ShowingDrive,
    Size,
    Where,
)
from calib.diagnosis.explanation.base import OWN, PADS, Base
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, residuals, thinned, whiten
from calib.diagnosis.explanation.explanation import Explanation, innovations, runs_of, seen
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import based
from calib.diagnosis.explanation.predict import ObservedRun, predict, run_of
from calib.diagnosis.replays import range_of
from calib.diagnosis.verdict import Verdict
from calib.logs.log import Log

_SHOWN = 5.0  # size [sigma] from which logs show an effect: ln of the odds is 7, its price is 5
_CLEAR = 10.0  # size [sigma] from which a drive shows it surely

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


def _intervals(at: Explanation) -> list[tuple[Base, Effects]]:
    """All parameters at the lower ends of their 95 % intervals, as they are, and at the upper ends.

    A tyre's own form and what logs have of their own are counted. Intervals are wider where more
    than noise is left, and cut at what a fit allows. Pads are as uncertain as the mass besides.
    """
    half = Z95 * np.sqrt(np.maximum(np.diag(at.covariance), 0.0) * max(at.reduced, 1.0))
    half[PADS] = np.hypot(half[PADS], Z95 * at.problem.vehicle.mass_tolerance)
    low, high = at.prior.low[: half.size], at.prior.high[: half.size]
    ends = (np.clip(at.state.x + s * half, low, high) for s in (-1, 0, 1))
    return [based(at.problem, at.hypothesis, replace(at.state, x=x)) for x in ends]


def base_estimates(at: Explanation) -> dict[str, ParameterEstimate]:
    """Pads and tyre with intervals; ``rolling_radius`` over that of the file."""
    names = ("pad_friction_f", "pad_friction_r", "tyre_stiffness", "tyre_peak", "rolling_radius")
    ends = [
        (b.pad_friction_f, b.pad_friction_r, float(b.tyre.stiffness), float(b.tyre.peak), b.radius)
        for b, _ in _intervals(at)
    ]
    return {name: _estimate(of, "1") for name, *of in zip(names, *ends, strict=True)}


def named(found: Verdict, confusion: Confusion | None) -> tuple[Named, ...]:
    """Every effect of the best explanation, with evidence; ``confusion`` with those like it."""
    best, search, whole = found.best, found.search, found.best.effects
    known = best.problem.vehicle.effects
    tried = [e for e in search.fits.others(search.best) if e.reduced < search.base.reduced]
    ends = [effects for _, effects in _intervals(best)]
    logs = (best.runs, runs_of(search.held.problem, found.after.own))
    others = sorted({n for e in found.rivals for n in e.names} - set(best.names))
    nearest = confusion.pairs[0] if confusion else None
    separate = f"{nearest.drive} ({nearest.apart_in_drive:.0f} sigma apart)" if nearest else ""
    out = []
    for name in best.names:
        rest = whole.without(name).with_(known.only(name))
        rises = (_reduced(best, rest, runs) - _reduced(best, whole, runs) for runs in logs)
        runners_up = (
            RunnerUp(" + ".join(e.names), search.base.reduced - e.reduced)
            for e in tried
            if e.names and name not in e.names
        )
        out.append(
            Named(
                name=name,
                parameters={
                    p.name: _estimate((e.parameters[name][p.name] for e in ends), p.unit)
                    for p in definition(whole, name).card.parameters
                },
                where=_where(best, name, rest),
                evidence=Evidence(*rises),
                runner_up=next(runners_up, None),
                indistinguishable_from=tuple(others),
                separate_by=separate,
                defined_in=whole.defined_in.get(name),
            )
        )
    return tuple(out)


def _estimate(ends: Iterable[float], unit: str) -> ParameterEstimate:
    low, value, high = ends
    return ParameterEstimate(value, unit, (low, high))


def _reduced(at: Explanation, effects: Effects, runs: list[ObservedRun]) -> float:
    """Mean squared innovation of some runs with some effects, all else as in an explanation."""
    r = np.concatenate([innovations(at.problem, at.base, effects, run) for run in runs])
    return float(r @ r) / r.size


def _where(at: Explanation, name: str, rest: Effects) -> Where:
    """Where an effect acts: what changes with the ``rest`` of the effects alone.

    The channel and the ranges in which innovations change most, and the wheels that turn otherwise.
    """
    vehicle, wheels, rows = at.problem.vehicle, np.zeros(len(WHEELS)), []
    for run in at.runs:
        whole, less = (predict(vehicle, at.base, effects, run) for effects in (at.effects, rest))
        wheels += np.sum((less.omega - whole.omega) ** 2, axis=1)
        change = whiten(residuals(run, less) - residuals(run, whole), at.problem.noise)
        power = by_channel(change**2)
        heat = np.zeros_like(run.v) if run.temperature_f is None else run.temperature_f
        along = thinned(run, np.stack([run.p_mc, run.v, heat]))
        rows.append(np.vstack([power, along[:, -power.shape[1] :]]))
    power, drivers = np.split(np.hstack(rows), [len(CHANNELS)])
    pressure, speed, temperature = (range_of(x, np.sum(power, axis=0)) for x in drivers)
    warm = all(run.temperature_f is not None for run in at.runs)
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


def confusion_of(best: Explanation, like: Sequence[Explanation]) -> Confusion | None:
    """The best explanation with those that are ``like`` it; None if there are none."""
    if not like:
        return None
    members, pairs = (best, *like), []
    for (i, one), (j, other) in combinations(enumerate(members), 2):
        apart = np.concatenate(one.innovations) - np.concatenate(other.innovations)
        ((drive, sigma),) = best_drives(one, [(other.base, other.effects)])
        pairs.append(Pair((i, j), float(np.linalg.norm(apart)), drive, sigma))
    alike = (Alike(e.names, e.reduced, e.reduced - best.reduced) for e in members)
    return Confusion(tuple(alike), tuple(pairs))


def drives(at: Explanation) -> tuple[ShowingDrive, ...]:
    """The best drive for each effect that the logs could not have shown at its usual size.

    On top of what explains them. Effects that the vehicle file has are known, and not among them.
    """
    every = every_effect(at.problem.vehicle.effects)
    cards = [effect.card for name, effect in every.items() if name not in at.effects]
    others = [(at.base, at.effects.with_(Effects({card.name: card.usual}))) for card in cards]
    unseen = _sizes(at, _products(at, others)) < _SHOWN
    out = []
    found = best_drives(at, [*compress(others, unseen)])
    for card, (drive, sigma) in zip(compress(cards, unseen), found, strict=True):
        size = {name: Size(value, card.units[name]) for name, value in card.usual.items()}
        out.append(ShowingDrive(card.name, size, drive, sigma, clear=sigma > _CLEAR))
    return tuple(out)


def best_drives(at: Explanation, others: Sequence[tuple[Base, Effects]]) -> list[tuple[str, float]]:
    """For each of the ``others`` the manoeuvre that tells it best from ``at``.

    And how far apart they are in the logs and in that together [sigma].
    """
    if not others:
        return []
    problem = replace(at.problem, runs=manoeuvres(at))
    state = replace(at.state, own=np.zeros((len(problem.runs), len(OWN))))
    driven, logs = seen(problem, at.hypothesis, state), _products(at, others)
    shown = np.stack([_sizes(at, [*logs, test]) for test in _products(driven, others)])
    best = [problem.runs[i].source for i in np.argmax(shown, axis=0)]
    return list(zip(best, np.max(shown, axis=0).tolist(), strict=True))


def _products(at: Explanation, others: Sequence[tuple[Base, Effects]]) -> list[Products]:
    """Inner products of each log, with what the ``others`` change behind its own columns."""
    changes = [
        np.stack([innovations(at.problem, *other, run, lag) - r for other in others])
        for run, lag, r in zip(at.runs, at.lags, at.innovations, strict=True)
    ]
    return at.products_with(changes)


def _sizes(at: Explanation, products: list[Products]) -> Array:
    """Sizes of the columns behind those of ``at``, beyond what these can imitate [sigma]."""
    E, _ = at.marginal(products).beyond()
    return np.sqrt(np.maximum(np.diag(E), 0.0))


def manoeuvres(at: Explanation) -> tuple[ObservedRun, ...]:
    """The `_TESTS` with a rough course of speed: 70 bar give 1 g."""
    warm, out = at.problem.runs[0].temperature_f is not None, []
    time = 0.01 * np.arange(1200)
    for name, (v0, most, rise, period) in _TESTS.items():
        p = 1e5 * np.clip(rise * (time % period - 1.0), 0.0, most)
        z = p / 70e5
        v = np.maximum(v0 - 0.01 * np.cumsum(z * G), 2.0)
        channels = {"time": time, "p_mc": p, "a_x": -z * G, "v": v}
        turn, heat = v / at.problem.vehicle.front.rolling_radius, 100.0 + 0.3 * (v0**2 - v**2)
        channels |= {f"omega_{wheel}": turn for wheel in WHEELS}
        channels |= dict.fromkeys(("T_disc_f", "T_disc_r") if warm else (), heat)
        out.append(run_of(Log(name, name, "", channels)))
    return tuple(out)
