"""The named effects of an explanation, and its base, each with evidence and intervals."""

from dataclasses import replace

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import WHEELS
from calib.car.effects.effect import Card, acts_on_wheels
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.diagnosis import Evidence, Named, ParameterEstimate, RunnerUp, Where
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, residuals, thinned, whiten
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.explanation.hypothesis import based
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.proof.verdict import Verdict
from calib.diagnosis.replays.remainder import range_of
from calib.diagnosis.undecided import Confusion


def intervals(at: Explanation) -> list[tuple[Base, Effects]]:
    """All parameters at the lower ends of their 95 % intervals, as they are, and at the upper ends.

    A tyre's own form and what logs have of their own are counted. Intervals are wider where more
    than noise is left, and cut at what a fit allows: pads of half and double the file's, a tyre of
    a seventh and seven times a usual one. Pads are as uncertain as the mass besides.
    """
    half = Z95 * np.sqrt(np.maximum(np.diag(at.covariance), 0.0) * max(at.reduced, 1.0))
    half[:2] = np.hypot(half[:2], Z95 * at.problem.vehicle.mass_tolerance)
    low, high = at.prior.low[: half.size], at.prior.high[: half.size]
    ends = (np.clip(at.state.x + s * half, low, high) for s in (-1, 0, 1))
    return [based(at.problem, at.hypothesis, replace(at.state, x=x)) for x in ends]


def base_estimates(at: Explanation) -> dict[str, ParameterEstimate]:
    """Pads and tyre with intervals; ``rolling_radius`` over that of the file."""
    names = ("pad_friction_f", "pad_friction_r", "tyre_stiffness", "tyre_peak", "rolling_radius")
    ends = (
        (b.pad_friction_f, b.pad_friction_r, float(b.tyre.stiffness), float(b.tyre.peak), b.radius)
        for b, _ in intervals(at)
    )
    told = zip(names, *ends, strict=True)
    return {name: ParameterEstimate(x, "1", (low, high)) for name, low, x, high in told}


def named(found: Verdict, confusion: Confusion | None) -> tuple[Named, ...]:
    """Every effect of the best explanation, with evidence; ``confusion`` with those like it."""
    best, ends = found.best, [effects for _, effects in intervals(found.best)]
    others = sorted({n for c in found.rivals for n in c.names} - set(best.names))
    nearest = confusion.pairs[0] if confusion else None
    separate = f"{nearest.drive} ({nearest.apart_in_drive:.0f} sigma apart)" if nearest else ""
    out = []
    for name in best.names:
        gain, where = _acts(best, name)
        runners_up = (
            RunnerUp(" + ".join(c.names), found.base.reduced - c.reduced)
            for c in found.tried
            if c.names and name not in c.names and c.reduced < found.base.reduced
        )
        out.append(
            Named(
                name=name,
                parameters=_parameters(definition(best.effects, name).card, ends),
                where=where,
                evidence=Evidence(gain, _acts(found.seen, name)[0]),
                runner_up=next(runners_up, None),
                indistinguishable_from=tuple(others),
                separate_by=separate,
                defined_in=best.effects.defined_in.get(name),
            )
        )
    return tuple(out)


def _parameters(card: Card, ends: list[Effects]) -> dict[str, ParameterEstimate]:
    out = {}
    for p in card.parameters:
        low, value, high = (e.parameters[card.name][p.name] for e in ends)
        out[p.name] = ParameterEstimate(value, p.unit, (low, high))
    return out


def _acts(at: Explanation, name: str) -> tuple[float, Where]:
    """Rise of the mean squared innovation without an effect, all else unchanged, and where that is.

    The channel and the ranges in which innovations change most, and the wheels that turn otherwise.
    """
    vehicle, base, effects = at.problem.vehicle, at.base, at.effects
    rest = effects.without(name).with_(vehicle.effects.only(name))
    rise, power, wheels, rows = 0.0, np.zeros(len(CHANNELS)), np.zeros(len(WHEELS)), []
    for run, r in zip(at.runs, at.innovations, strict=True):
        other = predict(vehicle, base, rest, run)
        turned = other.omega - predict(vehicle, base, effects, run).omega
        wheels += np.sum(turned**2, axis=1)
        white = whiten(residuals(run, other), at.problem.noise)
        rise += float(white @ white - r @ r)
        squares = by_channel((white - r) ** 2)
        m = min(x.size for x in squares)
        common = np.stack([x[-m:] for x in squares])
        power += np.sum(common, axis=1)
        heat = np.zeros_like(run.v) if run.temperature_f is None else run.temperature_f
        along = (thinned(run, x)[-m:] for x in (run.p_mc, run.v, heat))
        rows.append(np.stack([np.sum(common, axis=0), *along]))
    weight, *drivers = np.hstack(rows)
    pressure, speed, temperature = (range_of(x, weight) for x in drivers)
    warm = all(run.temperature_f is not None for run in at.runs)
    on_wheels = acts_on_wheels(definition(vehicle.effects, name))
    axle = _axle(*np.sum(wheels.reshape(2, 2), axis=1)) if on_wheels else "body"
    channel = CHANNELS[int(np.argmax(power))]
    return rise / at.count, Where(channel, axle, pressure, speed, temperature if warm else None)


def _axle(front: float, rear: float) -> str:
    """Whose wheels an effect changes, by its power on both: front, rear, both, or body."""
    if front + rear < 1e-9:
        return "body"
    if min(front, rear) > 0.2 * max(front, rear):
        return "both"
    return "front" if front > rear else "rear"
