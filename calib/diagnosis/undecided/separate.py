"""The feasible test that best separates two explanations, and how far apart they would be with it.

Both were fitted to the same logs, so they agree there. What a fit to logs and a further drive would
take up with other pads, tyres and sizes of the effects does not separate them. One linear step
ranks the manoeuvres; the best ones are then simulated with the one explanation, and the other is
fitted anew to logs and drive together:

    manoeuvres --> linear step --> best few --> simulated with one, other refitted --> sigma
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G
from calib.diagnosis.explanation.candidate import Candidate, derivatives
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import ObservedRun, run_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.proof.hold_outs import model_of
from calib.model.simulate import simulate

Array = NDArray[np.float64]


def best_drive(problem: Problem, one: Candidate, other: Candidate) -> tuple[str, float]:
    """Name of the best manoeuvre, and how far apart the two would be with it [sigma]."""
    tests = dict(manoeuvres(problem))
    logs = _products(problem, one, other)
    ranked = {}
    for name, run in tests.items():
        both = logs + _products(replace(problem, runs=(run,)), one, other)
        ranked[name] = float(free_lengths(both, one.x.size)[0])
    first = sorted(ranked, key=lambda name: -ranked[name])[: GATES.simulated]
    distances = {name: _refitted(problem, one, other, tests[name]) for name in first}
    best = max(distances, key=lambda name: distances[name])
    return best, distances[best]


def _refitted(problem: Problem, one: Candidate, other: Candidate, run: ObservedRun) -> float:
    """How much worse the other explains logs and a drive that the one made [sigma]."""
    driven = simulate(
        model_of(problem.vehicle, one),
        run.time,
        run.p_mc,
        float(run.v[0]),
        temperature={
            axle: heat
            for axle, heat in (("f", run.temperature_f), ("r", run.temperature_r))
            if heat is not None
        },
    )
    more = replace(problem, runs=(*problem.runs, run_of(driven)))
    worse = fit(more, other.names, other.x).chi2 - more.chi2(one.base, one.effects)
    return float(np.sqrt(max(worse, 0.0)))


def _products(problem: Problem, one: Candidate, other: Candidate) -> Array:
    innovations = problem.flat(one.base, one.effects)
    return inner_products(problem, one, [problem.flat(other.base, other.effects) - innovations])


def inner_products(problem: Problem, at: Candidate, changes: Sequence[Array]) -> Array:
    """Inner products (k + m, k + m) of the changes by k parameters, and of m ``changes`` (n,)."""
    innovations = problem.flat(at.base, at.effects)
    M = np.column_stack([derivatives(problem, at, innovations), *changes])
    return np.asarray(M.T @ M)


def free_lengths(products: Array, k: int) -> Array:
    """Length (m,) of each change that the first k directions cannot imitate."""
    own, cross = products[:k, :k], products[:k, k:]
    imitated = np.sum(cross * (np.linalg.pinv(own, hermitian=True) @ cross), axis=0)
    return np.asarray(np.sqrt(np.maximum(np.diag(products)[k:] - imitated, 0.0)))


def manoeuvres(problem: Problem) -> list[tuple[str, ObservedRun]]:
    """Tests that any proving ground can do, with a rough course of speed: 70 bar give 1 g."""
    out = []
    time = np.arange(0.0, 12.0, 0.01)
    after = time > 1.0
    tests: dict[str, tuple[float, Array]] = {
        "coast down from 130 km/h": (36.0, np.zeros_like(time)),
        "coast down from 50 km/h": (14.0, np.zeros_like(time)),
        "slow ramp to 45 bar": (33.0, np.clip(5e5 * (time - 1.0), 0.0, 45e5)),
        "light stop at 8 bar from 60 km/h": (17.0, np.where(after, 8e5, 0.0)),
        "hard stop at 45 bar from 120 km/h": (33.0, np.where(after, 45e5, 0.0)),
        "applications of 20 bar, 1 s on and 1 s off": (
            30.0,
            np.where(time % 2.0 > 1.0, 20e5, 0.0),
        ),
    }
    for name, (v0, p) in tests.items():
        v = np.asarray(np.maximum(v0 - np.cumsum(p / 70e5 * G) * 0.01, 2.0), float)
        warm = problem.runs[0].temperature_f is not None
        heat = np.asarray(100.0 + 0.3 * (v0**2 - v**2), float) if warm else None
        radius = problem.vehicle.front.rolling_radius
        omega = np.tile(v / radius, (4, 1))
        angle = np.cumsum(v / radius) * 0.01
        run = ObservedRun(
            name=name,
            time=time,
            step=0.01,
            p_mc=p,
            a_x=-p / 70e5 * G,
            v=v,
            omega=omega,
            v_smooth=v,
            temperature_f=heat,
            temperature_r=heat,
            angle_f=angle,
            angle_r=angle,
            drive_f=np.zeros_like(time),
            drive_r=np.zeros_like(time),
        )
        out.append((name, run))
    return out
