"""The catalogue: complete cards, names of the contract, and the physical order of effects."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.combined import (
    accelerometer_lag,
    as_driven,
    as_read,
    caliper_pressure,
    line_pressure,
    pad_factors,
    reading_delay,
    total_axle_moment,
    total_body_force,
    total_load_shift,
    wheel_factors,
    wheel_speed_factors,
)
from calib.car.effects.effects import Effects
from tests.support.effect_runs import SEDAN, clock, driven, made_history, made_motion

PARAMETERS = [(name, p) for name in CATALOGUE for p in CATALOGUE[name].card.parameters]

CONTRACT = (
    "aerodynamic_drag rolling_resistance road_grade engine_drag pad_thermal_fade "
    "pad_speed_dependence pad_pressure_dependence wet_pad_recovery rolling_radius_mismatch "
    "brake_threshold_pressure hydraulic_lag hydraulic_delay rear_proportioning caliper_hysteresis "
    "pitch_coupling accelerometer_bias accelerometer_scale wheel_inertia side_imbalance "
    "disc_thickness_variation mass_error residual_torque hydraulic_oscillation "
    "regenerative_torque rolling_radius_load tone_ring_runout accelerometer_lag speed_delay "
    "wheel_speed_delay"
)
NAMES = """
    drag_area load_share coefficient rolling_growth grade felt drag_torque drag_growth
    drag_rear_share fade_slope fade_onset speed_slope pressure_slope pressure_bend wet_loss
    dry_energy dry_rear_share radius_mismatch threshold threshold_rear_share time_constant lag_bend
    delay knee_slope knee width fixed_share elastic_share natural_frequency damping pitch_gradient
    bias scale_error extra_inertia imbalance rear_share amplitude phase side mass_error
    residual_pressure drain_time rear_bias response_time line_damping regen_torque regen_power
    regen_rear_share regen_onset regen_span regen_lag radius_load runout runout_phase runout_side
    filter_time filter_bend v_delay omega_delay
"""


def test_the_names_are_those_of_the_contract():
    assert " ".join(CATALOGUE) == CONTRACT
    assert [p.name for _, p in PARAMETERS] == NAMES.split()


@pytest.mark.parametrize("name", CATALOGUE)
@given(data=st.data())
def test_at_neutral_strength_an_effect_changes_nothing(name, data):
    """At neutral strength, an effect does nothing for any value of its other parameters."""
    effect, history = CATALOGUE[name], made_history()
    parameters = {p.name: data.draw(st.floats(p.low, p.high)) for p in effect.card.parameters}
    parameters[effect.card.parameters[0].name] = effect.card.neutral
    effects, motion = Effects({name: parameters}), made_motion(history.v)
    line = line_pressure(effects, history)
    for p in (*line, *caliper_pressure(effects, history, *line)):
        assert np.array_equal(p, history.p_mc)
    uneven = wheel_factors(effects, history) | wheel_speed_factors(SEDAN, effects, motion)
    for factor in (*pad_factors(effects, history, history.p_mc, history.p_mc), *uneven.values()):
        assert np.array_equal(factor, np.ones(200))
    for total in (
        *total_axle_moment(SEDAN, effects, motion),
        total_body_force(SEDAN, effects, motion),
        total_load_shift(SEDAN, effects, history),
    ):
        assert np.array_equal(total, np.zeros(200))
    assert np.array_equal(as_read(SEDAN, effects, history, history.z), history.z)
    assert as_driven(SEDAN, effects) == SEDAN
    delays = [reading_delay(effects, f"{link}speed_delay") for link in ("", "wheel_")]
    assert [accelerometer_lag(effects), *delays] == [0.0, 0.0, 0.0]


def restless(t):
    return 14e5 - 15e5 * np.cos(2.5 * t)  # below zero at first, as a noisy sensor; a release


@pytest.mark.parametrize(("name", "p"), PARAMETERS, ids=lambda x: getattr(x, "name", x))
def test_a_small_change_of_a_parameter_is_a_small_change_of_the_run(name, p):
    """Half of a step changes the run by half as much, so there is a derivative."""
    typical = {q.name: q.typical for q in CATALOGUE[name].card.parameters}
    h, hot = 0.01 * p.spread, {a: 200.0 + 100.0 * clock(3.0) for a in "fr"}

    def run(value):
        changed = {**typical, p.name: value}
        log = driven({name: changed}, restless, duration=3.0, temperature=hot)
        return np.concatenate([log["a_x"], log["v"], log["omega_fl"], log["omega_rl"]])

    start = run(p.typical - 2.0 * h)
    change, half_change = run(p.typical) - start, run(p.typical - h) - start
    assert np.linalg.norm(change) > 1e-6
    assert np.linalg.norm(change - 2.0 * half_change) <= 0.1 * np.linalg.norm(change)
