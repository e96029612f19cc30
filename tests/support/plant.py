"""A plant that shares nothing with calib/: a car with four spinning wheels, integrated stiffly.

It is what the program is tried against. Own tyre curves (Magic Formula with the E term, or a
brush), own load transfer (with the body's pitch mode if wanted), wheel speeds as states of a stiff
integrator. Only the record of the vehicle is taken from the project. Everything is SI; the sample
rate is that of the result, not of the integration. Deterministic and free of noise.

    run = drive(Plant(vehicle), pressure=lambda t: 4e6, v0=25.0)
    run["omega_fl"], run["true_Tb_fl"], ...
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import solve_ivp

from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from tests.support.cornering import GRAVITY, STRAIGHT, Tyre, along, cornering
from tests.support.shared import shared

AIR = 1.2

WHEELS = ("fl", "fr", "rl", "rr")
SIDES = (0, 0, 1, 1)
# State: v, distance, the transferred deceleration and its rate, then omega of every wheel and the
# slip that its tyre's deflection stands for.
V, X, TRANSFER, RATE, OMEGA, DEFLECTED = 0, 1, 2, 3, slice(4, 8), slice(8, 12)

STANDING = 0.1
"""Spin rate [rad/s] within which a wheel counts as standing; tanh is 1 to the last bit past 2."""

Pressure = Callable[[float], float]
"""Pressure [Pa] at a time [s]."""


def magic(
    stiffness: float = 25.0,
    peak: float = 0.9,
    shape: float = 1.65,
    curvature: float = 0.0,
    load_exponent: float = 0.0,
) -> Tyre:
    """Pacejka's formula; ``curvature`` is E, the compliance grows with load^load_exponent."""

    def force(slip: float, load: float, stiffness_factor: float, peak_factor: float) -> float:
        mu = peak * peak_factor
        b = stiffness * stiffness_factor / (shape * mu) * load**-load_exponent
        x = b * slip
        return mu * math.sin(shape * math.atan(x - curvature * (x - math.atan(x))))

    return force


def brush(stiffness: float = 25.0, peak: float = 0.9, load_exponent: float = 0.0) -> Tyre:
    """A brush with parabolic pressure: a cubic up to full sliding, flat after it."""

    def force(slip: float, load: float, stiffness_factor: float, peak_factor: float) -> float:
        mu = peak * peak_factor
        x = stiffness * stiffness_factor * load**-load_exponent * abs(slip) / (3.0 * mu)
        magnitude = mu * (1.0 - (1.0 - min(x, 1.0)) ** 3)
        return math.copysign(magnitude, slip)

    return force


def burckhardt(stiffness: float = 25.0, peak: float = 0.9, load_exponent: float = 0.0) -> Tyre:
    """Burckhardt's formula: an exponential rise, less a straight fall of 0.35 of the peak."""

    def force(slip: float, load: float, stiffness_factor: float, peak_factor: float) -> float:
        mu = peak * peak_factor
        k = stiffness * stiffness_factor * load**-load_exponent
        fall, rise, s = 0.35 * mu, 1.06 * mu, abs(slip)
        magnitude = rise * (1.0 - math.exp(-(k + fall) / rise * s)) - fall * s
        return math.copysign(magnitude, slip)

    return force


def dugoff(stiffness: float = 25.0, peak: float = 0.9, load_exponent: float = 0.0) -> Tyre:
    """Dugoff's formula: straight up to half of the peak."""

    def force(slip: float, load: float, stiffness_factor: float, peak_factor: float) -> float:
        mu = peak * peak_factor
        x = stiffness * stiffness_factor * load**-load_exponent * abs(slip) / mu
        return math.copysign(mu * (x if x < 0.5 else 1.0 - 0.25 / x), slip)

    return force


@dataclass(frozen=True)
class Plant:
    """The car as it really is; what ``vehicle`` says is what the program is told."""

    vehicle: Vehicle
    tyre: Tyre = field(default_factory=magic)  # see `magic` and `brush`
    # Friction of the front and the rear pads [1] at a time [s]; nominal if None.
    pads: Callable[[float], tuple[float, float]] | None = None
    drag_area: float = 0.0  # c_d A [m^2]
    rolling_resistance: float = 0.0  # c_rr [1], a moment on the wheels
    radius_scale: tuple[float, float] = (1.0, 1.0)  # true over nominal, front and rear [1]
    radius_load: float = 0.0  # share by which a radius falls when its axle's load doubles [1]
    rear_stiffness: float = 1.0  # of the rear tyres over that of the front ones [1]
    mass_scale: float = 1.0  # true over nominal mass [1]
    # Stiffness and peak factors [1] of the road at a distance [m]; all alike if None.
    surface: Callable[[float], tuple[float, float]] | None = None
    pitch_frequency: float = 0.0  # of the load transfer [Hz]; 0 if it follows at once
    pitch_damping: float = 0.3  # its damping ratio [1]
    pitch_felt: float = 0.0  # angle by which the nose dips per g [rad]; it tilts the accelerometer
    grade: float = 0.0  # sine of the slope [1], positive uphill; the accelerometer feels it
    # Factor on the load of an axle [1] at a distance [m].
    bumps: Callable[[float], float] | None = None
    # Torque of a motor at both wheels of the front and of the rear axle together [N m], negative
    # where it slows, at a time [s].
    motor: Callable[[float], tuple[float, float]] | None = None
    hydraulic_lag: float = 0.0  # time constant of the wheels' pressures [s]
    curvature: Callable[[float], float] | None = None  # of the path [1/m] at a time [s], + left
    # Way [m] over which a tyre builds up its force: sigma d lambda'/dt = v (lambda - lambda'), and
    # the force is that of lambda' (Pacejka, Tyre and Vehicle Dynamics, ch. 7).
    relaxation: float = 0.0


@dataclass(frozen=True)
class Moment:
    """One instant: ``z`` force against the motion over the weight [1]; the rest by wheel.

    ``slip`` [1] by wheel speed, path and radius; ``deflecting`` rate of what the tyre has of it.
    """

    z: float
    load: tuple[float, ...]
    force: tuple[float, ...]
    torque: tuple[float, ...]
    spin: tuple[float, ...]
    slip: tuple[float, ...]
    deflecting: tuple[float, ...]


def instant(plant: Plant, t: float, state: list[float], p: tuple[float, ...]) -> Moment:
    """Forces at one instant. Without a pitch mode the load transfer is solved for, not lagged."""
    car, v = plant.vehicle, max(state[V], 0.1)
    weight = car.mass * plant.mass_scale * GRAVITY
    length = car.cg_to_front_axle + car.cg_to_rear_axle
    axles = (car.front, car.rear)
    mu = plant.pads(t) if plant.pads else (car.front.pad_friction, car.rear.pad_friction)
    drag = 0.5 * AIR * plant.drag_area * state[V] ** 2
    at_rest = [a.rolling_radius * s for a, s in zip(axles, plant.radius_scale, strict=True)]
    loads_at_rest = [0.5 * weight * x / length for x in (car.cg_to_rear_axle, car.cg_to_front_axle)]
    road = [(1.0, 1.0), (1.0, 1.0)]
    if plant.surface:
        road = [plant.surface(state[X]), plant.surface(state[X] - length)]
    road[1] = (road[1][0] * plant.rear_stiffness, road[1][1])
    thrown = (1.0, 1.0)
    if plant.bumps:
        thrown = plant.bumps(state[X]), plant.bumps(state[X] - length)
    turn = STRAIGHT
    if plant.curvature:
        turn = cornering(car, plant.tyre, plant.curvature(t), v)
    motor = [0.5 * torque for torque in (plant.motor(t) if plant.motor else (0.0, 0.0))]
    z, z_before = state[TRANSFER], None
    for _ in range(8):
        half = [
            0.5 * weight * (car.cg_to_rear_axle + z * car.cg_height) / length,
            0.5 * weight * (car.cg_to_front_axle - z * car.cg_height) / length,
        ]
        radius = [
            r * (1.0 - plant.radius_load * (now / then - 1.0))
            for r, now, then in zip(at_rest, half, loads_at_rest, strict=True)
        ]
        loads = [half[i] * thrown[i] * k for i, k in zip(SIDES, turn.load, strict=True)]
        slips = [
            1.0 - radius[i] * w / (v * k)
            for i, w, k in zip(SIDES, state[OMEGA], turn.path, strict=True)
        ]
        carried = state[DEFLECTED] if plant.relaxation else slips
        forces = [
            n * along(plant.tyre, s, turn.across, 4.0 * n / weight, road[i])
            for i, s, n in zip(SIDES, carried, loads, strict=True)
        ]
        felt = (sum(forces) + drag + turn.resistance * 2.0 * half[0]) / weight
        if plant.pitch_frequency or abs(felt - z) < 1e-13:
            break
        # Steffensen: the force is nearly a straight line in the transferred load
        slope = (felt - z_before[1]) / (z - z_before[0]) if z_before else 0.0
        z_before, z = (z, felt), z + (felt - z) / (1.0 - slope)
    torque = [
        mu[i] * axles[i].friction_faces * axles[i].piston_area * axles[i].effective_radius * q
        for i, q in zip(SIDES, p, strict=True)
    ]
    # A brake, and a motor that brakes, holds a wheel that stands; it turns none backwards.
    turning = [math.tanh(w / STANDING) for w in state[OMEGA]]
    braking = [b - min(motor[i], 0.0) for i, b in zip(SIDES, torque, strict=True)]
    driving = [max(motor[i], 0.0) for i in SIDES]
    spin = [
        (radius[i] * (f - plant.rolling_resistance * n) - b * k + m) / axles[i].wheel_inertia
        for i, f, n, b, k, m in zip(SIDES, forces, loads, braking, turning, driving, strict=True)
    ]
    deflecting = []
    if plant.relaxation:
        deflecting = [v / plant.relaxation * (s - c) for s, c in zip(slips, carried, strict=True)]
    by_wheel = (loads, forces, torque, spin, slips, deflecting)
    return Moment(felt, *(tuple(values) for values in by_wheel))


def per_pascal(vehicle: Vehicle) -> float:
    """z per pressure [1/Pa] with nominal pads, (2) and (5)."""
    gain = sum(
        2.0 * a.torque_gain * a.pad_friction / a.rolling_radius
        for a in (vehicle.front, vehicle.rear)
    )
    return gain / vehicle.weight


@shared
def drive(
    plant: Plant,
    pressure: Pressure,
    v0: float,
    *,
    duration: float = 30.0,
    rate: float = 200.0,
    stop_speed: float = 1.0,
    wheel_pressure: dict[str, Pressure] | None = None,
    rtol: float = 1e-8,
    max_step: float = 0.05,
) -> dict[str, np.ndarray]:
    """Drive until ``duration`` [s] or ``stop_speed`` [m/s]; channels and truth by name, SI.

    ``max_step`` [s] bounds the step, so that a short pulse of pressure is not jumped over. A wheel
    past its peak locks, as it does on the road.
    """
    wheel_traces = wheel_pressure or {}
    traces = [wheel_traces.get(w, pressure) for w in WHEELS]
    if plant.hydraulic_lag:
        traces = [lagged(trace, plant.hydraulic_lag, duration) for trace in traces]
    omega_n = 2.0 * math.pi * plant.pitch_frequency

    def derivative(t: float, state: np.ndarray) -> list[float]:
        s = state.tolist()
        now = instant(plant, t, s, tuple(trace(t) for trace in traces))
        follow = omega_n**2 * (now.z - s[TRANSFER]) - 2.0 * plant.pitch_damping * omega_n * s[RATE]
        body = [-GRAVITY * (now.z + plant.grade), s[V], s[RATE], follow]
        return [*body, *now.spin, *now.deflecting]

    def stopped(t: float, state: np.ndarray) -> float:
        return float(state[V] - stop_speed)

    stopped.terminal = True  # type: ignore[attr-defined]
    solution = solve_ivp(
        derivative,
        (0.0, duration),
        _start(plant, v0, traces),
        method="LSODA",
        t_eval=np.arange(round(duration * rate) + 1) / rate,
        events=stopped,
        rtol=rtol,
        atol=1e-9,
        max_step=max_step,
    )
    if solution.status < 0:
        raise ArithmeticError(solution.message)
    return _channels(plant, solution.t, solution.y, pressure, traces, wheel_traces)


def lagged(pressure: Pressure, lag: float, duration: float, step: float = 1e-3) -> Pressure:
    """The pressure behind a first-order lag [s], as if it had begun at rest; straight between."""
    keep, values = math.exp(-step / lag), [pressure(0.0)]
    for k in range(1, round(duration / step) + 2):
        values.append(keep * values[-1] + (1.0 - keep) * pressure(k * step))

    def trace(t: float) -> float:
        k = min(int(t / step), len(values) - 2)
        return values[k] + (t / step - k) * (values[k + 1] - values[k])

    return trace


def _start(plant: Plant, v0: float, traces: list[Pressure]) -> list[float]:
    """The first state: as if the car had braked with the first pressure for ever."""
    axles = (plant.vehicle.front, plant.vehicle.rear)
    radius = [a.rolling_radius * s for a, s in zip(axles, plant.radius_scale, strict=True)]
    p = tuple(trace(0.0) for trace in traces)
    quick = replace(plant, pitch_frequency=0.0, relaxation=0.0)

    def frozen(t: float, omega: np.ndarray) -> list[float]:
        now = instant(quick, 0.0, [v0, 0.0, 0.0, 0.0, *omega.tolist()], p)
        drift = [-GRAVITY * (now.z + plant.grade) * w / v0 for w in omega.tolist()]
        return [s - d for s, d in zip(now.spin, drift, strict=True)]

    free = [v0 / radius[i] for i in SIDES]
    solution = solve_ivp(frozen, (0.0, 0.5), free, method="LSODA", rtol=1e-9, atol=1e-10)
    omega = solution.y[:, -1].tolist()
    now = instant(quick, 0.0, [v0, 0.0, 0.0, 0.0, *omega], p)
    carried = now.slip if plant.relaxation else ()
    return [v0, 0.0, now.z if plant.pitch_frequency else 0.0, 0.0, *omega, *carried]


def _channels(
    plant: Plant,
    time: np.ndarray,
    states: np.ndarray,
    pressure: Pressure,
    traces: list[Pressure],
    wheel_traces: dict,
) -> dict[str, np.ndarray]:
    pressures = [tuple(trace(t) for trace in traces) for t in time.tolist()]
    moments = [
        instant(plant, t, s, p)
        for t, s, p in zip(time.tolist(), states.T.tolist(), pressures, strict=True)
    ]
    mu = plant.pads or (
        lambda t: (plant.vehicle.front.pad_friction, plant.vehicle.rear.pad_friction)
    )
    run = {"time": time, "p_mc": np.array([pressure(t) for t in time.tolist()])}
    z = np.array([m.z for m in moments])
    dip = plant.pitch_felt * (states[TRANSFER] if plant.pitch_frequency else z)
    run |= {"a_x": -GRAVITY * (z * np.cos(dip) + np.sin(dip)), "v": states[V]}
    for i, w in enumerate(WHEELS):
        run[f"omega_{w}"] = states[OMEGA][i]
        run[f"true_Tb_{w}"] = np.array([m.torque[i] for m in moments])
        run[f"true_Fx_{w}"] = np.array([m.force[i] for m in moments])
        run[f"true_Fz_{w}"] = np.array([m.load[i] for m in moments])
        if w in wheel_traces:
            run[f"p_{w}"] = np.array([p[i] for p in pressures])
    for k, side in enumerate("fr"):
        if plant.motor:
            run[f"T_drive_{side}"] = np.array([plant.motor(t)[k] for t in time.tolist()])
        run[f"true_mu_pad_{side}"] = np.array([mu(t)[k] for t in time.tolist()])
    return run


def as_log(run: dict[str, np.ndarray], name: str = "plant") -> Log:
    """The run as a log, truth apart from the channels."""
    truth = {k: v for k, v in run.items() if k.startswith("true_")}
    channels = {k: v for k, v in run.items() if k not in truth}
    return Log(name=name, source="plant", digest="", channels=channels, truth=truth)
