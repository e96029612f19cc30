"""The named effects of an explanation, and its base, each with evidence and intervals."""

import math

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95
from calib.car.effects.effect import acts_on_wheels
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.diagnosis import Named, ParameterEstimate, Where
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, residuals, thinned, whiten
from calib.diagnosis.explanation.explanation import Explanation, of_all
from calib.diagnosis.explanation.hypothesis import based
from calib.diagnosis.explanation.predict import ObservedRun, predict
from calib.diagnosis.explanation.vector import bounds
from calib.diagnosis.proof.verdict import Verdict
from calib.diagnosis.replays.remainder import range_of
from calib.diagnosis.undecided.confusion import Confusion


def half_widths(at: Explanation) -> Array:
    """Half width (m,) of the 95 % interval of each entry of x, wider where more than noise is left.

    A tyre's own form and what logs have of their own are counted.
    """
    return Z95 * np.sqrt(np.maximum(np.diag(at.covariance), 0.0) * max(at.reduced, 1.0))


def named(found: Verdict, confusion: Confusion | None) -> tuple[Named, ...]:
    """Every effect of the best explanation, with evidence; ``confusion`` with those like it."""
    best, half = found.best, half_widths(found.best)
    nearest = None if confusion is None else confusion.pair(0, 1)
    separate = "" if nearest is None else f"{nearest.drive} ({nearest.sigma:.0f} sigma apart)"
    out = []
    for name, own in best.problem.places(best.names).items():
        parameters = {}
        card = definition(best.problem.vehicle.effects, name).card
        for p, width in zip(card.parameters, half[own], strict=True):
            value = min(max(best.effects.parameters[name][p.name], p.low), p.high)
            spread = float(width * p.spread)
            ends = (max(value - spread, p.low), min(value + spread, p.high))
            parameters[p.name] = ParameterEstimate(value, p.unit, ends)
        others = sorted({n for c in found.rivals for n in c.names} - set(best.names))
        runner = next((c for c in found.tried if name not in c.names and c.names), None)
        out.append(
            Named(
                name=name,
                parameters=parameters,
                where=_where_of(best, name),
                gain=_gain_without(best, name),
                gain_holdout=_gain_without(found.seen, name),
                runner_up=None
                if runner is None
                else (" + ".join(runner.names), found.base.reduced - runner.reduced),
                indistinguishable_from=tuple(others),
                separate_by=separate,
            )
        )
    return tuple(out)


def _gain_without(at: Explanation, name: str) -> float:
    """Rise of the mean squared innovation when the effect is removed, all else unchanged."""
    places = at.problem.places(at.names)
    x = at.state.x.copy()
    x[places[name]] = 0.0
    others = of_all(at.problem, at.hypothesis, at.with_x(x), at.runs)
    return sum(float(r @ r) for r in others) / at.count - at.reduced


def _where_of(best: Explanation, name: str) -> Where:
    """The channel and the ranges in which removing the effect changes the innovations most."""
    power, rows = np.zeros(len(CHANNELS)), []
    front = rear = 0.0
    for run in best.runs:
        change, omega = _change(best, name, run)
        front += float(np.sum(omega[:2] ** 2))
        rear += float(np.sum(omega[2:] ** 2))
        power += np.sum(change**2, axis=1)
        heat = np.zeros_like(run.v) if run.temperature_f is None else run.temperature_f
        along = [thinned(run, d)[-change.shape[1] :] for d in (run.p_mc, run.v_smooth, heat)]
        rows.append(np.vstack([np.sum(change**2, axis=0), *along]))
    weight, p, v, heat = np.hstack(rows)
    warm = all(run.temperature_f is not None for run in best.problem.runs)
    on_wheels = acts_on_wheels(definition(best.problem.vehicle.effects, name))
    return Where(
        channel=CHANNELS[int(np.argmax(power))],
        axle=_axle(front, rear) if on_wheels else "body",
        pressure=range_of(p, weight),
        speed=range_of(v, weight),
        temperature=range_of(heat, weight) if warm else None,
    )


def _change(best: Explanation, name: str, run: ObservedRun) -> tuple[Array, Array]:
    """Changes of the whitened channels (6, m) of a run when an effect is removed, common length.

    And those of the wheel speeds (4, n) [rad/s].
    """
    base, effects = based(best.problem, best.hypothesis, best.state)
    vehicle, noise = best.problem.vehicle, best.problem.noise
    rest = effects.without(name).with_(vehicle.effects.only(name))
    both = [predict(vehicle, base, e, run) for e in (effects, rest)]
    parts = [by_channel(whiten(residuals(run, one), noise)) for one in both]
    m = min(c.size for c in parts[0])
    white = np.stack([b[-m:] - a[-m:] for a, b in zip(*parts, strict=True)])
    return white, both[0].omega - both[1].omega


def _axle(front: float, rear: float) -> str:
    """Whose wheels an effect changes, by its power on both: front, rear, both, or body."""
    if front + rear < 1e-9:
        return "body"
    if min(front, rear) > 0.2 * max(front, rear):
        return "both"
    return "front" if front > rear else "rear"


def base_estimates(at: Explanation) -> dict[str, ParameterEstimate]:
    """Pads and tyre with intervals; ``rolling_radius`` over that of the file.

    Pads are as uncertain as the mass besides. An interval is cut at what the fit allows: pads of
    half and double the file's, a tyre of a seventh and seven times a usual one.
    """
    half = half_widths(at)
    half[:2] = np.hypot(half[:2], Z95 * at.problem.vehicle.mass_tolerance)
    low, high = bounds(at.problem, at.names)
    b = at.base
    values = (
        ("pad_friction_f", b.pad_friction_f, 0),
        ("pad_friction_r", b.pad_friction_r, 1),
        ("tyre_stiffness", b.stiffness, 2),
        ("tyre_peak", b.peak, 3),
        ("rolling_radius", b.radius, 9),
    )
    out = {}
    for name, value, i in values:
        x = float(at.state.x[i])
        ends = np.clip((x - half[i], x + half[i]), low[i], high[i])
        lower, upper = (value * math.exp(end - x) for end in ends)
        out[name] = ParameterEstimate(value, "1", (lower, upper))
    return out
