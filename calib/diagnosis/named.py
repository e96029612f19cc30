"""The named effects of an explanation, and its base, each with evidence and intervals."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import WHEELS
from calib.car.effects.catalogue import definition
from calib.car.effects.effect import AT_WHEELS, acts_on
from calib.car.effects.effects import Effects
from calib.diagnosis.diagnosis import Evidence, Named, ParameterEstimate, RunnerUp, Where
from calib.diagnosis.explanation.base import PADS, Base
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, residuals, thinned, whiten
from calib.diagnosis.explanation.explanation import Explanation, innovations, runs_of
from calib.diagnosis.explanation.hypothesis import based
from calib.diagnosis.explanation.predict import ObservedRun, predict
from calib.diagnosis.proof.verdict import Verdict
from calib.diagnosis.replays.gap import range_of
from calib.diagnosis.undecided import Confusion


def intervals(at: Explanation) -> list[tuple[Base, Effects]]:
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
        for b, _ in intervals(at)
    ]
    return {name: _estimate(of, "1") for name, *of in zip(names, *ends, strict=True)}


def named(found: Verdict, confusion: Confusion | None) -> tuple[Named, ...]:
    """Every effect of the best explanation, with evidence; ``confusion`` with those like it."""
    best, search, whole = found.best, found.search, found.best.effects
    known = best.problem.vehicle.effects
    tried = [e for e in search.fits.others(search.best) if e.reduced < search.base.reduced]
    ends = [effects for _, effects in intervals(best)]
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
    axle = _axle(*np.sum(wheels.reshape(2, 2), axis=1)) if on_wheels else "body"
    channel = CHANNELS[int(np.argmax(np.sum(power, axis=1)))]
    return Where(channel, axle, pressure, speed, temperature if warm else None)


def _axle(front: float, rear: float) -> str:
    """Whose wheels an effect changes, by its power on both: front, rear, both, or body."""
    if front + rear < 1e-9:
        return "body"
    if min(front, rear) > 0.2 * max(front, rear):
        return "both"
    return "front" if front > rear else "rear"
