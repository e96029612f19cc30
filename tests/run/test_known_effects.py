"""Known effects taken out: what is left is a car without them, and its pads are the true ones.

Truth is the torque and the motion of the simulation, which has its own tests against the plant.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import ModelError
from calib.base.names import WHEELS, G
from calib.car import forces
from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.run.known_effects import remove_known_effects
from tests.support.effect_runs import SEDAN, driven, wave

HOT = {"f": np.linspace(80.0, 420.0, 801), "r": np.linspace(60.0, 300.0, 801)}


def typical(name):
    return {p.name: p.typical for p in CATALOGUE[name].card.parameters}


def car_with(effects, *terms):
    return replace(SEDAN, effects=Effects(effects, terms))


def axle(car, w):
    return car.front if w[0] == "f" else car.rear


def pressure_of(log, w):
    return log[f"p_{w}"] if f"p_{w}" in log else log["p_mc"]


def test_without_known_effects_nothing_changes():
    log = driven({}, wave)
    ran = remove_known_effects(SEDAN, log)
    assert ran.log is log
    assert ran.vehicle == SEDAN
    assert np.all(ran.factor_f == 1.0)
    assert np.all(ran.factor_r == 1.0)


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_effect_comes_out_again(name):
    effects = {name: typical(name)}
    log = driven(effects, wave, temperature=HOT)
    ran = remove_known_effects(car_with(effects), log)
    for w in WHEELS:
        wheel = axle(ran.vehicle, w)
        torque = forces.brake_torque(wheel, wheel.pad_friction, pressure_of(ran.log, w))
        scale = float(np.max(log.truth[f"true_Tb_{w}"]))
        assert np.max(np.abs(torque - log.truth[f"true_Tb_{w}"])) < 2e-3 * scale
    # the acceleration is that of the speed, whatever the sensors read
    speed_gain = np.cumsum(0.5 * (ran.log["a_x"][1:] + ran.log["a_x"][:-1]) * np.diff(log.time))
    assert np.max(np.abs(speed_gain - (ran.log["v"][1:] - ran.log["v"][0]))) < 5e-3
    # and the forces balance with the car as driven
    total = sum(log.truth[f"true_Fx_{w}"] for w in WHEELS)
    body = ran.vehicle.weight * (-ran.log["a_x"] / G) - np.abs(total)
    if not ran.vehicle.effects:
        assert np.max(np.abs(body)) < 2e-3 * ran.vehicle.weight


@pytest.mark.parametrize(
    ("name", "channel", "most"), [("accelerometer_lag", "a_x", 0.02), ("speed_delay", "v", 0.002)]
)
def test_a_channel_that_is_late_comes_out_as_without_the_delay(name, channel, most):
    late, right = driven({name: typical(name)}, wave), driven({}, wave)
    ran = remove_known_effects(car_with({name: typical(name)}), late)
    assert np.max(np.abs(late[channel] - right[channel])) > 5.0 * most
    assert np.max(np.abs(ran.log[channel] - right[channel])) < most


@pytest.mark.parametrize("with_v", [True, False])
def test_wheels_that_are_late_keep_their_slip_and_lose_the_delay(with_v):
    name = "wheel_speed_delay"
    late, right = driven({name: typical(name)}, wave), driven({}, wave)
    channels = {k: x for k, x in late.channels.items() if with_v or k != "v"}
    ran = remove_known_effects(car_with({name: typical(name)}), replace(late, channels=channels))
    for w in WHEELS:
        turned = right[f"omega_{w}"] / right["v"]
        by_slip = 0.02 * np.gradient(turned, right.time) * right["v"]
        off = ran.log[f"omega_{w}"] - (right[f"omega_{w}"] - by_slip)
        assert np.max(np.abs(off)) < 0.02
        assert np.max(np.abs(late[f"omega_{w}"] - right[f"omega_{w}"])) > 0.2
    assert ("v" in ran.log) == with_v


def _with_term(term, heat=None):
    from calib.car.model import default_model
    from calib.model.simulate import simulate
    from tests.support.effect_runs import TYRE, clock

    model = replace(default_model(SEDAN), tyre=TYRE, effects=Effects(terms=(term,)))
    time = clock(4.0)
    return simulate(model, time, np.array([wave(t) for t in time]), 30.0, temperature=heat)


def test_a_term_that_cannot_be_taken_out_is_refused():
    term = EmpiricalTerm("body", "temperature", (0.0, 100.0), (0.0, 0.1))
    with pytest.raises(ModelError, match="over temperature"):
        remove_known_effects(car_with({}, term), driven({}, wave))


OVER_HEAT = ((0.0, 500.0), (0.0, -0.5))
"""A thousandth of the brake torque less for each degree of the disc."""


@pytest.mark.parametrize("place", ["front_brakes", "rear_brakes", "brakes"])
def test_a_term_over_temperature_reads_the_discs_of_its_own_axle(place):
    """Front 100 and rear 400 degC: 0.9 of the front torque is left, 0.6 of the rear."""
    term = EmpiricalTerm(place, "temperature", *OVER_HEAT)
    heat = {"f": np.full(801, 100.0), "r": np.full(801, 400.0)}
    log = _with_term(term, heat)
    ran = remove_known_effects(car_with({}, term), log)
    n = log.time.size
    front, rear = 0.9 if place != "rear_brakes" else 1.0, 0.6 if place != "front_brakes" else 1.0
    factors = {"f": front, "r": rear}
    for w in WHEELS:
        wheel = axle(SEDAN, w)
        plain = forces.brake_torque(wheel, wheel.pad_friction, log["p_mc"])
        assert log.truth[f"true_Tb_{w}"] == pytest.approx(factors[w[0]] * plain)
        assert ran.log[f"p_{w}"][:n] == pytest.approx(factors[w[0]] * log["p_mc"])
    assert ran.factor_f == pytest.approx(np.full(n, factors["f"]))
    assert ran.factor_r == pytest.approx(np.full(n, factors["r"]))


@pytest.mark.parametrize(
    ("place", "missing"), [("front_brakes", "f"), ("rear_brakes", "r"), ("brakes", "r")]
)
def test_a_temperature_that_a_term_needs_is_not_guessed(place, missing):
    term = EmpiricalTerm(place, "temperature", *OVER_HEAT)
    heat = {a: np.full(801, 200.0) for a in "fr" if a != missing}
    with pytest.raises(ModelError, match=f"simulation: .*T_disc_{missing}"):
        _with_term(term, heat)
    log = replace(driven({}, wave, temperature=heat), source="stop_7.csv")
    with pytest.raises(ModelError, match=f"stop_7.csv: .*T_disc_{missing}"):
        remove_known_effects(car_with({}, term), log)
