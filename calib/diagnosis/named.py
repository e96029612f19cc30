"""The named effects of an explanation, and its base, each with evidence and intervals."""

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
from calib.diagnosis.explanation.hypothesis import based, bounds_of
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.proof.verdict import Verdict
from calib.diagnosis.replays.remainder import range_of
from calib.diagnosis.undecided import Confusion

_BASE = {
    "pad_friction_f": "pad_friction_f",
    "pad_friction_r": "pad_friction_r",
    "tyre_stiffness": "stiffness",
    "tyre_peak": "peak",
    "rolling_radius": "radius",
}
"""Names of the base parameters that are told, as `Base` has them."""


def intervals(at: Explanation) -> list[tuple[Base, Effects]]:
    """All parameters at the lower ends of their 95 % intervals, as they are, and at the upper ends.

    A tyre's own form and what logs have of their own are counted. Intervals are wider where more
    than noise is left, and cut at what a fit allows: pads of half and double the file's, a tyre of
    a seventh and seven times a usual one. Pads are as uncertain as the mass besides.
    """
    half = Z95 * np.sqrt(np.maximum(np.diag(at.covariance), 0.0) * max(at.reduced, 1.0))
    half[:2] = np.hypot(half[:2], Z95 * at.problem.vehicle.mass_tolerance)
    ends = (
        np.clip(at.state.x + s * half, *bounds_of(at.problem, at.hypothesis)) for s in (-1, 0, 1)
    )
    return [based(at.problem, at.hypothesis, at.with_x(x)) for x in ends]


def base_estimates(at: Explanation) -> dict[str, ParameterEstimate]:
    """Pads and tyre with intervals; ``rolling_radius`` over that of the file."""
    ends = [[getattr(base, name) for name in _BASE.values()] for base, _ in intervals(at)]
    told = zip(_BASE, *ends, strict=True)
    return {name: ParameterEstimate(x, "1", (low, high)) for name, low, x, high in told}


def named(found: Verdict, confusion: Confusion | None) -> tuple[Named, ...]:
    """Every effect of the best explanation, with evidence; ``confusion`` with those like it."""
    best, ends = found.best, [effects for _, effects in intervals(found.best)]
    others = sorted({n for c in found.rivals for n in c.names} - set(best.names))
    separate = ""
    if confusion is not None:
        nearest = confusion.pairs[0]
        separate = f"{nearest.drive} ({nearest.apart_in_drive:.0f} sigma apart)"
    out = []
    for name in best.names:
        gain, where = _acts(best, name)
        runner = next((c for c in found.tried if name not in c.names and c.names), None)
        out.append(
            Named(
                name=name,
                parameters=_parameters(definition(best.effects, name).card, ends),
                where=where,
                evidence=Evidence(gain, _acts(found.seen, name)[0]),
                runner_up=None
                if runner is None
                else RunnerUp(" + ".join(runner.names), found.base.reduced - runner.reduced),
                indistinguishable_from=tuple(others),
                separate_by=separate,
                defined_in=best.effects.defined_in.get(name),
            )
        )
    return tuple(out)


def _parameters(card: Card, ends: list[Effects]) -> dict[str, ParameterEstimate]:
    out = {}
    for p in card.parameters:
        told = (e.parameters[card.name][p.name] for e in ends)
        low, value, high = (min(max(x, p.low), p.high) for x in told)
        out[p.name] = ParameterEstimate(value, p.unit, (low, high))
    return out


def _acts(at: Explanation, name: str) -> tuple[float, Where]:
    """Rise of the mean squared innovation without an effect, all else unchanged, and where that is.

    The channel and the ranges in which innovations change most, and the wheels that turn otherwise.
    """
    vehicle, base, effects = at.problem.vehicle, at.base, at.effects
    rest = effects.without(name).with_(vehicle.effects.only(name))
    warm = all(run.temperature_f is not None for run in at.runs)
    rise, power, wheels, rows = 0.0, np.zeros(len(CHANNELS)), np.zeros(len(WHEELS)), []
    for run, r in zip(at.runs, at.innovations, strict=True):
        other = predict(vehicle, base, rest, run)
        turned = other.omega - predict(vehicle, base, effects, run).omega
        wheels += np.sum(turned**2, axis=1)
        white = np.concatenate(whiten(residuals(run, other), at.problem.noise))
        rise += float(white @ white - r @ r)
        squares = by_channel((white - r) ** 2)
        m = min(x.size for x in squares)
        common = np.stack([x[-m:] for x in squares])
        power += np.sum(common, axis=1)
        along = (run.p_mc, run.v_smooth, *([run.temperature_f] if warm else []))
        rows.append(np.stack([np.sum(common, axis=0), *(thinned(run, x)[-m:] for x in along)]))
    weight, *drivers = np.hstack(rows)
    pressure, speed, *heat = (range_of(x, weight) for x in drivers)
    on_wheels = acts_on_wheels(definition(vehicle.effects, name))
    axle = _axle(*np.sum(wheels.reshape(2, 2), axis=1)) if on_wheels else "body"
    where = Where(CHANNELS[int(np.argmax(power))], axle, pressure, speed, heat[0] if heat else None)
    return rise / at.count, where


def _axle(front: float, rear: float) -> str:
    """Whose wheels an effect changes, by its power on both: front, rear, both, or body."""
    if front + rear < 1e-9:
        return "body"
    if min(front, rear) > 0.2 * max(front, rear):
        return "both"
    return "front" if front > rear else "rear"
