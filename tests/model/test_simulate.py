"""The simulation against closed forms, balances, and a plant that shares nothing with it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calib.base.errors import ModelError
from calib.base.names import WHEELS, G
from calib.car import forces
from calib.car.effects.effects import Effects
from calib.car.model import Model, default_model
from calib.car.tyre import MagicFormula
from calib.model.simulate import simulate
from tests.support.effect_runs import SEDAN, apart, clock, on_the_plant, without_inertia
from tests.support.plant import Plant, drive, magic

DRAG = {"aerodynamic_drag": {"drag_area": 0.66}}
ROLLING = {"rolling_resistance": {"coefficient": 0.011}}
BOTH = DRAG | ROLLING
TYRE = MagicFormula(25.0, 0.9, 1.65, 0.1)


def model(effects=BOTH, vehicle=SEDAN, tyre=TYRE, **changes) -> Model:
    return replace(default_model(vehicle), effects=Effects(effects), tyre=tyre, **changes)


def ramp(t):
    return max(t - 1.0, 0.0) * 6e5


def sampled(pressure, time):
    return np.array([pressure(t) for t in time])


def rotating_mass(vehicle):
    return sum(2.0 * a.wheel_inertia / a.rolling_radius**2 for a in (vehicle.front, vehicle.rear))


# Closed forms ------------------------------------------------------------------------------------


def test_coasting_against_drag_alone():
    """(M + J/R^2) dv/dt = -k v^2 gives v = v0/(1 + k v0 t/m)."""
    log = simulate(model(DRAG), clock(20), np.zeros(4001), 33.0)
    k = 0.5 * 1.2 * 0.66 / (SEDAN.mass + rotating_mass(SEDAN))
    assert log["v"] == pytest.approx(33.0 / (1.0 + k * 33.0 * log.time), rel=1e-6)
    assert np.all(log.truth["true_Fx_fl"] < 0.0)  # the road slows the wheels, they push the car


def test_without_wheel_inertia_the_torque_is_the_force():
    bare = without_inertia(SEDAN)
    time = clock(6)
    pressure = sampled(ramp, time)
    log = simulate(model({}, bare), time, pressure, 33.0)
    gain = 2.0 * (
        bare.front.pad_friction * bare.front.torque_gain / bare.front.rolling_radius
        + bare.rear.pad_friction * bare.rear.torque_gain / bare.rear.rolling_radius
    )
    z = gain * pressure / bare.weight
    assert log["a_x"] == pytest.approx(-G * z, abs=1e-8)
    F_zf = forces.axle_loads(bare, z)[0]
    F_f = log.truth["true_Tb_fl"] / bare.front.rolling_radius / (0.5 * F_zf)
    slip = TYRE.slip_at_force(F_f, 2.0 * F_zf / bare.weight)[0]
    assert forces.slip(bare.front, log["omega_fl"], log["v"]) == pytest.approx(slip, abs=1e-9)


# Balances ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ramped():
    time = clock(12)
    return simulate(model(), time, sampled(ramp, time), 33.0)


def test_forces_sum_to_mass_times_deceleration(ramped):
    total = sum(ramped.truth[f"true_Fx_{w}"] for w in WHEELS)
    drag = 0.5 * 1.2 * 0.66 * ramped["v"] ** 2
    assert total + drag == pytest.approx(-SEDAN.mass * ramped["a_x"], rel=1e-8)


@pytest.mark.parametrize("w", ["fl", "rr"])
def test_equation_1_holds_in_every_sample(ramped, w):
    axle = SEDAN.front if w[0] == "f" else SEDAN.rear
    spin = np.diff(ramped[f"omega_{w}"]) / np.diff(ramped.time)
    moment = 0.011 * ramped.truth[f"true_Fz_{w}"] * axle.rolling_radius
    force = forces.tyre_force(axle, ramped.truth[f"true_Tb_{w}"][1:], spin, moment[1:])
    assert force == pytest.approx(ramped.truth[f"true_Fx_{w}"][1:], abs=1e-3)


def energy_missing(rate):
    """Share of the kinetic energy lost that brakes, rolling, slip and drag do not account for."""
    time = clock(12, rate)
    log = simulate(model(), time, sampled(ramp, time), 33.0)
    v, heat = log["v"], 0.5 * 1.2 * 0.66 * log["v"] ** 3
    kinetic = 0.5 * SEDAN.mass * v**2
    for w in WHEELS:
        axle = SEDAN.front if w[0] == "f" else SEDAN.rear
        omega, load = log[f"omega_{w}"], log.truth[f"true_Fz_{w}"]
        moment = log.truth[f"true_Tb_{w}"] + 0.011 * load * axle.rolling_radius
        sliding = v - axle.rolling_radius * omega
        heat = heat + moment * omega + log.truth[f"true_Fx_{w}"] * sliding
        kinetic = kinetic + 0.5 * axle.wheel_inertia * omega**2
    lost = kinetic[0] - kinetic[-1]
    return (lost - np.trapezoid(heat, log.time)) / lost


def test_energy_is_accounted_for():
    """A backward difference loses J (d omega)^2/2 a step, so what is missing goes with the step."""
    coarse, fine = energy_missing(200), energy_missing(400)
    assert coarse < 1e-4
    assert 2.0 * fine - coarse == pytest.approx(0.0, abs=1e-6)


# Against the plant -------------------------------------------------------------------------------

PLANT = Plant(
    SEDAN, tyre=magic(25.0, 0.9, 1.65, 0.0, 0.1), drag_area=0.66, rolling_resistance=0.011
)


def step(t):
    return min(max(t - 1.0, 0.0) * 200e5, 35e5)


def wave(t):
    return 25e5 + 10e5 * np.sin(5.0 * t)


@pytest.mark.parametrize(("pressure", "rate"), [(ramp, 1000), (step, 40), (wave, 200)])
def test_follows_the_plant(pressure, rate):
    """The wheel's lag is known to half a sample: of that size, and no more, is the difference."""
    run = drive(PLANT, pressure, 30.0, duration=5.0, rate=rate)
    log = simulate(model(), run["time"], sampled(pressure, run["time"]), 30.0)
    assert log.time.size == run["time"].size
    fastest = np.max(np.abs(np.diff(run["p_mc"]))) * 0.5
    force = 2.0 * SEDAN.front.pad_friction * SEDAN.front.torque_gain / SEDAN.front.rolling_radius
    assert apart(log, run, "true_Fx_fl") < force * fastest
    # The wheels' momentum, half a sample late; twice, because the slip is late as well.
    late = rotating_mass(SEDAN) / SEDAN.mass * np.max(np.abs(run["a_x"])) / rate
    assert apart(log, run, "v") < late
    eta = run["omega_rl"] / run["omega_fl"]
    error = np.abs(log["omega_rl"] / log["omega_fl"] - eta)
    assert np.median(error) < 0.05 * np.max(np.abs(np.diff(eta)))
    assert apart(log, run, "true_Tb_rr") < 1e-6


# Ends --------------------------------------------------------------------------------------------


def test_ends_at_the_stop_speed():
    log = simulate(model(), clock(30), np.full(6001, 30e5), 20.0, stop_speed=2.0)
    assert 2.0 <= log["v"][-1] < 2.05
    assert log["v"][-1] + log["a_x"][-1] / 200.0 < 2.0
    assert "slower than 2 m/s" in log.notes[-1]


def test_ends_before_a_wheel_passes_the_peak_and_says_so():
    time = clock(5)
    log = simulate(model(), time, 15e5 * time, 33.0)
    last = log.time.size
    assert last < time.size
    assert f"{time[last]:.3f} s" in log.notes[-1]
    assert "peak of its tyre" in log.notes[-1]
    named = [w for w in WHEELS if f"wheel {w}" in log.notes[-1]]
    assert named
    for w in named:
        used = log.truth[f"true_Fx_{w}"][-1] / log.truth[f"true_Fz_{w}"][-1]
        assert 0.98 * TYRE.peak < used < TYRE.peak


@settings(max_examples=8)
@given(st.integers(50, 1500), st.floats(10e5, 80e5), st.floats(5.0, 40.0))
def test_later_pressure_does_not_change_earlier_samples(cut, pressure, v0):
    time = clock(8)
    p = pressure * (1.0 + 0.3 * np.sin(7.0 * time))
    try:
        whole = simulate(model(), time, p, v0)
    except ModelError:
        return  # beyond the tyre from the start
    part = simulate(model(), time[:cut], p[:cut], v0)
    n = part.time.size
    assert n == min(cut, whole.time.size)
    for channel in ("v", "a_x", "omega_fl", "omega_rr"):
        assert part[channel] == pytest.approx(whole[channel][:n], abs=1e-6)


# Doors -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("time", "pressure", "v0"),
    [
        (clock(1), np.zeros(201), 0.5),
        (clock(1), np.zeros(201), np.nan),
        (clock(1), np.zeros(200), 20.0),
        (clock(1), np.full(201, np.nan), 20.0),
        (clock(1)[::-1], np.zeros(201), 20.0),
        (np.zeros(1), np.zeros(1), 20.0),
        (clock(1), np.full(201, 300e5), 20.0),  # past the peak of the tyre
    ],
)
def test_refuses_what_cannot_be_driven(time, pressure, v0):
    with pytest.raises(ModelError):
        simulate(model(), time, pressure, v0)


def test_tyres_with_a_relaxation_length_follow_the_plant():
    def pedal(t):
        return 10e5 * (1.0 - np.cos(6.0 * t))  # rises by up to 60 bar/s

    run = on_the_plant(pedal, v0=20.0, duration=2.0, relaxation=0.4)
    error, time = {}, clock(2.0)
    for relaxation in (0.0, 0.4):
        tyre = MagicFormula(25.0, 0.9, 1.65, relaxation=relaxation)
        log = simulate(model({}, tyre=tyre), time, sampled(pedal, time), 20.0)
        error[relaxation] = max(apart(log, run, f"omega_{w}") for w in ("fl", "rl"))
    assert error[0.4] < 0.25 * error[0.0]
