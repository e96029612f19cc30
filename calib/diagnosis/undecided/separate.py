"""How large a change would be in a further drive, beyond what all that is fitted can imitate.

    columns of the logs + columns of a manoeuvre --> less what pads, tyres, effects do --> sigma

One linear step: right for small effects, and the order of magnitude for large ones.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.columns import seen
from calib.diagnosis.explanation.explanation import Explanation, innovations, marginal
from calib.diagnosis.explanation.hypothesis import State, based
from calib.diagnosis.explanation.own import OWN
from calib.diagnosis.explanation.predict import ObservedRun

Other = tuple[Base, Effects]
"""What is changed to."""


def best_drives(at: Explanation, others: Sequence[Other]) -> list[tuple[str, float]]:
    """For each of the ``others`` the manoeuvre that tells it best from ``at``.

    And how far apart they are in the logs and in that together [sigma].
    """
    logs = [at.products_of(i, _changes(at, others, i)) for i in range(len(at.innovations))]
    shown = {}
    for name, run in manoeuvres(at):
        driven = _driven(at, run)
        products = [*logs, driven.products_of(0, _changes(driven, others, 0))]
        E, _ = marginal(driven, products, at.hypothesis.sizes).beyond()
        shown[name] = np.sqrt(np.maximum(np.diag(E), 0.0))
    names, sizes = list(shown), np.stack([*shown.values()])
    best = np.argmax(sizes, axis=0).tolist()
    return [(names[i], float(sizes[i, k])) for k, i in enumerate(best)]


def _driven(at: Explanation, run: ObservedRun) -> Explanation:
    """What is known of ``at``, of one further run alone, which has nothing of its own."""
    problem = replace(at.problem, runs=(run,))
    state = State(at.state.x, at.state.form, np.zeros((1, len(OWN))))
    return seen(problem, at.hypothesis, state)


def _changes(at: Explanation, others: Sequence[Other], i: int) -> Array:
    """Changes (m, n) of the innovations of a log."""
    run = at.runs[i]
    return np.stack(
        [
            innovations(at.problem, base, effects, run) - at.innovations[i]
            for base, effects in others
        ]
    )


def own_of(at: Explanation) -> Other:
    """Base and effects of an explanation."""
    return based(at.problem, at.hypothesis, at.state)


def manoeuvres(at: Explanation) -> list[tuple[str, ObservedRun]]:
    """Tests that any proving ground can do, with a rough course of speed: 70 bar give 1 g."""
    out = []
    time = np.arange(0.0, 12.0, 0.01)
    nothing, since = np.zeros_like(time), time - 1.0
    tests: dict[str, tuple[float, Array]] = {
        "coast down from 130 km/h": (36.0, nothing),
        "coast down from 50 km/h": (14.0, nothing),
        "slow ramp to 45 bar": (33.0, np.clip(5e5 * since, 0.0, 45e5)),
        "light stop at 8 bar from 60 km/h": (17.0, np.where(since > 0.0, 8e5, 0.0)),
        "hard stop at 45 bar from 120 km/h": (33.0, np.where(since > 0.0, 45e5, 0.0)),
        "applications of 20 bar, 1 s on and 1 s off": (
            30.0,
            np.where(time % 2.0 > 1.0, 20e5, 0.0),
        ),
    }
    radius = at.problem.vehicle.front.rolling_radius
    for name, (v0, p) in tests.items():
        z = p / 70e5
        v = np.maximum(v0 - np.cumsum(z * G) * 0.01, 2.0)
        warm = at.problem.runs[0].temperature_f is not None
        heat = 100.0 + 0.3 * (v0**2 - v**2) if warm else None
        omega = np.tile(v / radius, (4, 1))
        angle = np.cumsum(v / radius) * 0.01
        run = ObservedRun(
            name=name,
            time=time,
            step=0.01,
            p_mc=p,
            a_x=-z * G,
            v=v,
            omega=omega,
            v_smooth=v,
            temperature_f=heat,
            temperature_r=heat,
            angle_f=angle,
            angle_r=angle,
            drive_f=nothing,
            drive_r=nothing,
        )
        out.append((name, run))
    return out
