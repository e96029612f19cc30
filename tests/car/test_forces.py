"""Equations (1) to (22) against statics, closed forms and figures worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car import balance, forces
from calib.car.effects.combined import total_axle_moment, total_body_force
from calib.car.effects.effects import Effects
from calib.car.history import Motion, constant_speed
from calib.car.model import default_model
from calib.car.vehicle import Vehicle
from calib.model.simulate import simulate
from tests.support.tables import VEHICLE

z_values = st.floats(-0.3, 1.2)
D_values = st.floats(-1.0, 1.0)
friction = st.floats(0.01, 1.0)


@st.composite
def vehicles(draw) -> Vehicle:
    """Passenger cars and vans whose rear wheels stay on the road at 1.2 g."""
    height = draw(st.floats(0.3, 0.8))
    return replace(
        VEHICLE,
        mass=draw(st.floats(700.0, 4000.0)),
        cg_to_front_axle=draw(st.floats(1.3 * height, 2.5)),
        cg_to_rear_axle=draw(st.floats(0.8, 2.5)),
        cg_height=height,
    )


def loads_by_moments(car: Vehicle, F_f: float, F_r: float) -> tuple[float, float]:
    """Axle loads where each axle brakes with its normalised force: balance of lift and pitch."""
    pitch = [car.cg_to_front_axle - car.cg_height * F_f, -car.cg_to_rear_axle - car.cg_height * F_r]
    F_zf, F_zr = np.linalg.solve([[1.0, 1.0], pitch], [car.mass * 9.80665, 0.0])
    return float(F_zf), float(F_zr)


# Pads and wheels ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("faces", "g"), [(1, 0.36), (2, 0.71)])
def test_tables_1_and_2_at_50_bar(faces, g):
    """4 T_b/(R M g), worked out by hand for one and for two pad faces."""
    axles = [replace(axle, friction_faces=faces) for axle in (VEHICLE.front, VEHICLE.rear)]
    force = sum(2.0 * forces.brake_torque(a, a.pad_friction, 50e5) / 0.322 for a in axles)
    assert force / (1744.0 * 9.80665) == pytest.approx(g, rel=0.01)


# Loads and sums ----------------------------------------------------------------------------------


@given(vehicles(), friction, friction)
def test_loads_and_sums_against_statics(car, F_f, F_r):
    """(5)-(10), (17): the deceleration is what the two axles give, by moments about the c.g."""
    F_zf, F_zr = loads_by_moments(car, F_f, F_r)
    F_xf, F_xr = F_f * F_zf, F_r * F_zr
    z = np.asarray((F_xf + F_xr) / (car.mass * 9.80665))
    assert forces.axle_loads(car, z) == pytest.approx((F_zf, F_zr), rel=1e-9)
    L_f, L_r, h = car.cg_to_front_axle, car.cg_to_rear_axle, car.cg_height
    load_f, load_r = forces.axle_loads(car, z)
    ratio = F_f * (L_r + z * h) / (F_r * (L_f - z * h))  # (8); (9), (10) are 1 over it
    assert F_f * load_f / (F_r * load_r) == pytest.approx(ratio, rel=1e-9)


@given(vehicles(), st.floats(0.01, 1.2))
def test_the_loads_give_the_i_curve(car, z):
    """Fig. 2: F_xr over F_xf, z taken out of F_x = z F_z on both axles."""
    W, h, l_r, L = car.mass * 9.80665, car.cg_height, car.cg_to_rear_axle, car.wheelbase
    F_xf = z * W * (l_r + z * h) / L
    F_xr = 0.5 * (W / h * np.sqrt(l_r**2 + 4.0 * h * L * F_xf / W) - (W * l_r / h + 2.0 * F_xf))
    F_zf, F_zr = forces.axle_loads(car, np.asarray(z))
    assert F_zr / F_zf == pytest.approx(F_xr / F_xf, rel=1e-6)


# The split ---------------------------------------------------------------------------------------


@given(vehicles(), z_values, D_values)
def test_equation_18_holds_for_any_deceleration_and_difference(car, z, D):
    z = np.asarray(z)
    F_zf, F_zr = forces.axle_loads(car, z)
    f1, f2 = forces.paper_curves(car, z, D)
    assert f1 == pytest.approx(-F_zr / F_zf * f2, abs=1e-9)
    assert f1 - f2 == pytest.approx(D, abs=1e-9)
    F_f, F_r = z + f1, z + f2  # (11), (12)
    assert F_f * F_zf + F_r * F_zr == pytest.approx(z * car.weight, abs=1e-9 * car.weight)


def test_a_car_without_rear_brakes_is_front_biased_for_ever():
    bare = replace(VEHICLE, rear=replace(VEHICLE.rear, piston_area=0.0))
    assert balance.front_biased_up_to(bare) == float("inf")


# Slip --------------------------------------------------------------------------------------------


@given(st.floats(-0.2, 0.9), st.floats(-0.2, 0.9), st.floats(1.0, 70.0))
def test_slips_give_wheel_speeds_and_eta_and_back(slip_f, slip_r, v):
    """(19)-(22): the same V from both wheels, and eta without it."""
    omega_f = forces.wheel_speed(VEHICLE.front, slip_f, v)
    omega_r = forces.wheel_speed(VEHICLE.rear, slip_r, v)
    assert 0.322 * omega_f / (1.0 - slip_f) == pytest.approx(v)
    assert forces.slip(VEHICLE.front, omega_f, v) == pytest.approx(slip_f, abs=1e-12)
    assert forces.speed_ratio(slip_f, slip_r) == pytest.approx(omega_r / omega_f)


# Both directions ---------------------------------------------------------------------------------


def test_forces_account_for_what_simulate_adds():
    """From pressure and a_x alone to the truth of every wheel, drag and rolling present."""
    effects = Effects(
        {"aerodynamic_drag": {"drag_area": 0.66}, "rolling_resistance": {"coefficient": 0.012}}
    )
    time = np.arange(1600) / 200.0
    pressure = 5e5 * np.maximum(time - 1.0, 0.0)
    log = simulate(default_model(replace(VEHICLE, effects=effects)), time, pressure, 33.0)
    z = forces.deceleration(log["a_x"])
    loads = forces.axle_loads(VEHICLE, z)
    motion = Motion(log["v"], *loads, constant_speed(log.time, log["p_mc"], 33.0))
    moments = total_axle_moment(VEHICLE, effects, motion)
    total = np.zeros_like(z)
    axles = (("fl", VEHICLE.front), ("rl", VEHICLE.rear))
    for (w, axle), load, moment in zip(axles, loads, moments, strict=True):
        torque = forces.brake_torque(axle, axle.pad_friction, log["p_mc"])
        spin = np.diff(log[f"omega_{w}"], prepend=np.nan) / 0.005
        force = forces.tyre_force(axle, torque, spin, 0.5 * moment)
        total += 2.0 * force
        assert torque == pytest.approx(log.truth[f"true_Tb_{w}"])
        assert 0.5 * load == pytest.approx(log.truth[f"true_Fz_{w}"], rel=1e-6)
        assert force[1:] == pytest.approx(log.truth[f"true_Fx_{w}"][1:], abs=0.01)
    drag = total_body_force(VEHICLE, effects, motion)
    assert total[1:] == pytest.approx((VEHICLE.weight * z - drag)[1:], abs=0.02)  # (5), (17)
    assert np.min(drag) > 10.0  # it is there to be accounted for


def test_mean_slip_is_weighed_by_load():
    v = np.array([20.0, 20.0, 0.0])
    omega_f, omega_r = v * (1 - 0.02) / 0.322, v * (1 - 0.01) / 0.322
    slip = forces.mean_slip(VEHICLE, np.full(3, 0.6 * VEHICLE.weight), omega_f, omega_r, v)
    assert slip[:2] == pytest.approx(np.full(2, 0.6 * 0.02 + 0.4 * 0.01))
    assert np.isnan(slip[2])
