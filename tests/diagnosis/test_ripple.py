"""A ripple has a phase in every run: found from its evidence, and handed to the replay."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of, with_ripple_phase
from calib.diagnosis.replays import HoldOuts, gap_of, replayed
from calib.logs.log import Log
from calib.model.sensor_noise import add_noise
from tests.support.explained import fitted, problem_of_logs
from tests.support.hidden.cases import CARS, NOISE, SURFACES
from tests.support.hidden.hydraulics import STEP, lines
from tests.support.hidden.plant import Car, Start, drive
from tests.support.hidden.settings import Hidden
from tests.support.plant import magic

CAR = CARS[1]
STARTS = (0.3, 1.7, 2.9, 4.4)
"""Angles of the wheels [rad] at which the runs begin."""

HIDDEN = {
    "disc_thickness_variation": Hidden(thickness=0.05, thickness_right=0.0),
    "tone_ring_runout": Hidden(tooth_error=0.002),
}


def driven(hidden: Hidden, angle: float, pressure: float, seed: int) -> Log:
    """A stop of the plant that begins at an angle of its wheels; coasts for 2 s first."""
    car = Car(CAR, magic(*SURFACES["dry_asphalt"]), hidden=hidden)
    time = np.arange(0.0, 7.0, STEP)
    pressed = lines(hidden, pressure * np.clip((time - 2.0) / 0.5, 0.0, 1.0))
    run = drive(car, pressed, Start(28.0, 80.0, angle), rtol=5e-6)
    log = Log(name=f"from_{angle:g}", source="plant", digest="", channels=run)
    return add_noise(log, seed, NOISE)


@pytest.fixture(scope="module", params=list(HIDDEN))
def runs(request):
    logs = [driven(HIDDEN[request.param], a, 18e5 + 4e5 * i, i) for i, a in enumerate(STARTS)]
    return request.param, logs


def apart(a: float, b: float) -> float:
    """Distance of two angles [rad]."""
    return abs((a - b + np.pi) % (2.0 * np.pi) - np.pi)


def test_the_origins_of_the_runs_differ_as_their_first_angles_do(runs):
    _, logs = runs
    recorded = [run_of(log) for log in logs]
    shifted = problem_of(CAR, recorded).runs
    origins = [a.angle_f[0] - b.angle_f[0] for a, b in zip(shifted, recorded, strict=True)]
    for origin, angle in zip(origins, STARTS, strict=True):
        assert apart(origin - origins[0], angle - STARTS[0]) < 0.15


def test_the_gap_of_a_ripple_shrinks_on_hold_outs(runs):
    name, logs = runs
    problem = problem_of_logs(CAR, logs[:2])
    shifted = with_ripple_phase(CAR, [run_of(log) for log in logs[2:]], problem.noise)
    holdouts = HoldOuts(tuple(logs[2:]), replace(problem, runs=shifted))
    base = fitted(problem)
    after = replayed(holdouts, fitted(problem, (name,)), base)
    gap = gap_of(after.base_logs, after.logs, holdouts.logs)
    channel = "a_x" if name == "disc_thickness_variation" else "omega_fl"
    first, last = gap.rms(channel=channel)
    assert last < 0.5 * first
    runs = tuple(replace(run, angle_f=run.angle_f + np.pi) for run in shifted)
    late = replace(holdouts, problem=replace(problem, runs=runs))
    wrong_phase = late.replays(after.simulated, after.random_effects)
    # a wrong phase doubles the ripple
    assert gap_of(after.base_logs, wrong_phase, holdouts.logs).rms(channel=channel)[1] > 1.5 * first
