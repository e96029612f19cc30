"""The solver: what the history holds, where a run ends, and that it converges."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import ModelError
from calib.car.brakes import brakes_of
from calib.car.effects.effects import Effects
from calib.car.history import constant_speed
from calib.car.model import default_model
from calib.car.tyre import MagicFormula
from calib.model.solver import Drive, end_of, history_of, rising_branch, solve
from tests.support.effect_runs import SEDAN

TIME = np.arange(801) / 200.0
NO_DRIVE = (np.zeros(TIME.size), np.zeros(TIME.size))
DRAG = {"aerodynamic_drag": {"drag_area": 0.66}}


def run_with(effects, pressure=25e5):
    model = replace(default_model(SEDAN), effects=Effects(effects))
    inputs = constant_speed(TIME, np.full(TIME.size, pressure), 30.0)
    return Drive(brakes_of(model, inputs, {}), inputs, 30.0, 1.0, NO_DRIVE)


def test_what_the_brakes_and_the_road_took_is_what_the_car_lost():
    run = run_with(DRAG)
    state = solve(run)
    history = history_of(run, state)
    R = SEDAN.front.rolling_radius
    distance = np.concatenate([[0.0], np.cumsum(0.5 * (state.v[1:] + state.v[:-1])) / 200.0])
    assert history.angle_f[-1] == pytest.approx(distance[-1] / R, rel=0.02)  # less by the slip
    assert history.angle_f[-1] < history.angle_r[-1] < distance[-1] / R
    inertia = SEDAN.front.wheel_inertia + SEDAN.rear.wheel_inertia
    kinetic = (0.5 * SEDAN.mass + inertia / R**2) * (30.0**2 - state.v[-1] ** 2)
    drag = np.trapezoid(0.6 * 0.66 * state.v**3, TIME)
    heat = 2.0 * (history.energy_f[-1] + history.energy_r[-1])
    assert heat == pytest.approx(kinetic - drag, rel=0.02)  # the rest is left on the road
    assert heat < kinetic - drag


def test_an_axle_lifts_when_its_load_has_left_and_not_before():
    """Quasi-static the rear lifts at z = l_f/h; on slow springs the car brakes harder by then."""
    tall = replace(SEDAN, cg_height=1.6, cg_to_front_axle=0.9, cg_to_rear_axle=1.7)
    pitch = {"elastic_share": 1.0, "natural_frequency": 3.0, "damping": 0.9, "pitch_gradient": 0.0}
    tyre, z_lift = MagicFormula(60.0, 3.0), []
    for effects in ({}, {"pitch_coupling": pitch}):
        model = replace(
            default_model(tall), effects=Effects(effects), tyre=tyre, pad_friction_r=0.0
        )
        inputs = constant_speed(TIME, np.clip(TIME - 0.5, 0.0, None) * 60e5, 40.0)
        run = Drive(brakes_of(model, inputs, {}), inputs, 40.0, 1.0, NO_DRIVE)
        state = solve(run)
        end, why = end_of(run, state)
        assert "the rear axle would lift" in why
        z_lift.append(state.z[end - 1])
    assert z_lift[0] == pytest.approx((0.9 - 0.01 * 2.6) / 1.6, abs=0.002)  # 1 % of W is left
    assert z_lift[1] > 1.1 * z_lift[0]


def test_refuses_what_has_not_converged(monkeypatch):
    monkeypatch.setattr("calib.model.solver._ITERATIONS", 2)
    with pytest.raises(ModelError, match="did not converge in 2 iterations"):
        solve(run_with(DRAG))


TYRE = MagicFormula(25.0, 0.9, load_exponent=0.1)


def test_beyond_the_edge_the_force_goes_on_rising_without_a_step():
    edge = float(TYRE.slip_at(0.999))
    around = np.array([edge * (1 - 1e-9), edge * (1 + 1e-9)])
    (low, high), _, (inside, outside) = rising_branch(TYRE, around, np.ones(2))
    assert high == pytest.approx(low, abs=1e-9)
    assert inside < 1.0 < outside
    far, slope, _ = rising_branch(TYRE, np.linspace(-3.0 * edge, 3.0 * edge, 50), np.ones(50))
    assert np.all(np.diff(far) > 0.0)
    assert np.all(slope > 0.0)
    assert TYRE.peak - TYRE.force(np.array([edge]))[0] < 2e-6 * TYRE.peak
