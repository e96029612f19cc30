"""The feasible test that best separates two explanations: each manoeuvre is simulated with both.

Both were fitted to the same logs, so they agree there. A manoeuvre in which they disagree most,
over the noise of the sensors, is the one to drive next.
"""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.candidate import Candidate, Problem
from calib.diagnosis.channels import residuals, whiten
from calib.diagnosis.predict import ObservedRun, predict
from calib.names import G

Array = NDArray[np.float64]


def separate_by(problem: Problem, one: Candidate, other: Candidate) -> str:
    """Name of the best manoeuvre with the distance in it, in words."""
    drive, sigma = best_drive(problem, one, other)
    return f"{drive} ({sigma:.0f} sigma apart)"


def best_drive(problem: Problem, one: Candidate, other: Candidate) -> tuple[str, float]:
    """Name of the best manoeuvre, and the distance of the two explanations in it [sigma]."""
    distances = {name: distance(problem, one, other, run) for name, run in manoeuvres(problem)}
    best = max(distances, key=lambda name: distances[name])
    return best, distances[best]


def distance(problem: Problem, one: Candidate, other: Candidate, run: ObservedRun) -> float:
    """Distance of two explanations in a run, in sigma of all its innovations."""
    parts = []
    for candidate in (one, other):
        predicted = predict(problem.vehicle, candidate.base, candidate.effects, run)
        parts.append(np.concatenate(whiten(residuals(run, predicted), problem.noise)))
    return float(np.linalg.norm(parts[0] - parts[1]))


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
