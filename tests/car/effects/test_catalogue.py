"""The catalogue: complete cards, one file each, and an order where the order is physics."""

from pathlib import Path

import numpy as np
import pytest

import calib.car.effects.catalogue as catalogue
from calib.base.errors import ModelError
from calib.base.units import to_si
from calib.car.effects.catalogue import (
    CALIPER,
    CATALOGUE,
    LINE,
    SENSOR,
    effect_named,
    nothing,
)
from tests.support.effect_runs import clock, driven

ALL = sorted(CATALOGUE)
PARAMETERS = [(name, p) for name in ALL for p in CATALOGUE[name].card.parameters]


@pytest.mark.parametrize("name", ALL)
def test_a_card_says_everything(name):
    card = CATALOGUE[name].card
    assert card.name == name
    for text in (card.cause, card.equation, card.source, card.looks_like):
        assert text.strip()
    assert card.parameters


@pytest.mark.parametrize(("name", "p"), PARAMETERS, ids=lambda x: getattr(x, "name", x))
def test_a_parameter_has_an_si_unit_and_a_range_around_what_is_usual(name, p):
    assert to_si(1.0, p.unit, p.unit) == 1.0
    assert p.low <= p.typical <= p.high
    assert 0.0 < p.spread < p.high - p.low


def test_one_file_for_each_effect_and_one_effect_for_each_file():
    files = {path.stem for path in Path(catalogue.__file__).parent.glob("*.py")}
    shared = {"__init__", "effect", "effects", "catalogue", "combined", "empirical"}
    assert files - shared == set(CATALOGUE)


def test_no_two_parameters_share_a_name():
    names = [p.name for _, p in PARAMETERS]
    assert len(set(names)) == len(names)


def test_an_unknown_effect_is_refused_with_the_known_ones():
    with pytest.raises(ModelError, match=r"'fad'.*aerodynamic_drag.*see calib/car/effects"):
        effect_named("fad")


CONTRACT = (
    "aerodynamic_drag rolling_resistance road_grade engine_drag pad_thermal_fade "
    "pad_speed_dependence pad_pressure_dependence wet_pad_recovery rolling_radius_mismatch "
    "brake_threshold_pressure hydraulic_lag hydraulic_delay rear_proportioning caliper_hysteresis "
    "pitch_coupling accelerometer_bias accelerometer_scale wheel_inertia side_imbalance "
    "disc_thickness_variation mass_error residual_torque hydraulic_oscillation "
    "regenerative_torque rolling_radius_load tone_ring_runout accelerometer_lag speed_delay "
    "wheel_speed_delay"
)


def test_the_names_are_those_of_the_contract():
    assert " ".join(CATALOGUE) == CONTRACT


def test_what_changes_a_pressure_or_a_reading_has_its_place_in_the_chain():
    hydraulic = {n for n, e in CATALOGUE.items() if e.pressure is not None}
    sensed = {n for n, e in CATALOGUE.items() if e.accelerometer is not None}
    assert sorted(LINE + CALIPER) == sorted(hydraulic)
    assert sensed <= set(SENSOR)


# Nothing -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ALL)
def test_the_strength_comes_first_and_may_be_nothing(name):
    card = CATALOGUE[name].card
    strength = card.parameters[0]
    assert strength.low <= card.neutral <= strength.high
    assert strength.typical != card.neutral
    assert nothing(name)[strength.name] == card.neutral
    assert f"no effect at {strength.name} = {card.neutral:g}" in card.equation


HEAT = {"f": 80.0 + 40.0 * clock(4.0), "r": 60.0 + 20.0 * clock(4.0)}


def restless(t):
    return 14e5 - 15e5 * np.cos(2.5 * t)  # below zero at first, as a noisy sensor


@pytest.mark.parametrize("name", ALL)
def test_at_nothing_the_simulation_is_the_same_to_the_last_bit(name):
    bare = driven({}, restless, temperature=HEAT)
    again = driven({name: nothing(name)}, restless, temperature=HEAT)
    for channels, others in ((bare.channels, again.channels), (bare.truth, again.truth)):
        assert set(channels) == set(others)
        for channel in channels:
            assert np.array_equal(channels[channel], others[channel]), channel


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("end", ["low", "high"])
def test_the_simulation_bears_every_parameter_at_its_bounds(name, end):
    parameters = CATALOGUE[name].card.parameters
    typical = {p.name: p.typical for p in parameters}
    for p in parameters:
        changed = {**typical, p.name: getattr(p, end)}
        log = driven({name: changed}, restless, duration=2.0)
        assert np.all(np.isfinite(log["a_x"]))


@pytest.mark.parametrize(("name", "p"), PARAMETERS, ids=lambda x: getattr(x, "name", x))
def test_a_small_change_of_a_parameter_is_a_small_change_of_the_run(name, p):
    """Halving a step halves what it does: there is a derivative to work with."""
    typical = {q.name: q.typical for q in CATALOGUE[name].card.parameters}
    h, hot = 0.01 * p.spread, {a: 200.0 + 100.0 * clock(3.0) for a in "fr"}

    def run(value):
        log = driven(
            {name: {**typical, p.name: value}}, restless, duration=3.0, temperature=hot
        )  # with a release
        return np.concatenate([log["a_x"], log["v"], log["omega_fl"], log["omega_rl"]])

    middle = run(p.typical - 2.0 * h)
    whole, half = run(p.typical) - middle, run(p.typical - h) - middle
    assert np.linalg.norm(whole) > 1e-6
    assert np.linalg.norm(whole - 2.0 * half) <= 0.1 * np.linalg.norm(whole)
