"""The car in which something is hidden: four wheels, integrated stiffly, every effect a switch.

It is kin of `tests.support.plant` (its tyres are used here) and shares nothing with
`calib.model.simulate` or the catalogue of effects: states instead of quasi-steady wheels,
loads from the tyre forces, and details that a catalogue would leave out. Everything is SI.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import integrate, interpolate, signal
from scipy.integrate import solve_ivp

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle
from tests.support.hidden.hydraulics import STEP, Lines
from tests.support.hidden.settings import Hidden
from tests.support.plant import AIR, GRAVITY, Tyre

AMBIENT = 20.0
CAPACITY = (13.4e3, 8.1e3)
"""Heat capacity of the discs of one axle [J/K], and below how fast they cool [1/s]: both as the
discs of the shared logs warm."""
COOLING = (0.0038, 0.0060)
HALT = 1.65
"""A log ends at this speed [m/s]."""
FADE_WIDTH = 12.0
"""Kelvins over which a fade sets in."""

NOTHING = Hidden()

# The state. Energies are of the brakes of one axle, ANGLE is the front left wheel's.
V, FL, FR, RL, RR, Z, Z_RATE, E_F, E_R, T_F, T_R, ANGLE, SLOSH, SLOSH_RATE, ABS_F, ABS_R = range(16)
MOTOR = 16


@dataclass(frozen=True)
class Car:
    """The true car: what the program is told (``vehicle``), its base and what is hidden.

    ``pad_scale`` of both axles and ``stiffness_scale`` are factors [1] on pads and tyre;
    ``rear_tyre`` where the rear axle has another one.
    """

    vehicle: Vehicle
    tyre: Tyre
    pad_scale: tuple[float, float] = (1.0, 1.0)
    stiffness_scale: float = 1.0
    hidden: Hidden = NOTHING
    rear_tyre: Tyre | None = None


@dataclass(frozen=True)
class Start:
    """How a run begins: speed [m/s], temperature of all discs [degC], angle of the wheels [rad]."""

    v: float
    temperature: float
    angle: float = 0.0


def drive(
    car: Car, lines: Lines, start: Start, rate: float = 200.0, rtol: float = 1e-6
) -> dict[str, Array]:
    """Drive until the pressures end or the car halts. Channels as perfect sensors have them."""
    rates = equations(car, lines)

    def halted(t: float, y: Array) -> float:
        return float(y[V] - HALT)

    halted.terminal = True  # type: ignore[attr-defined]
    end = (lines.master.size - 1) * STEP
    first = settle(car, rates, start)
    solution = solve_ivp(
        lambda t, y: rates(t, y.tolist())[0],
        (0.0, end),
        first,
        method="LSODA",
        t_eval=np.arange(int(end * rate + 1e-6) + 1) / rate,
        events=halted,
        rtol=rtol,
        atol=1e-7,
        max_step=0.04,
    )
    if solution.status < 0:
        raise ArithmeticError(solution.message)
    return readings(car, lines, solution.t, solution.y, rates)


Rates = Callable[[float, list[float]], tuple[list[float], float]]
"""Time and state -> their rates and the specific force along the body [m/s^2]."""


def settle(car: Car, rates: Rates, start: Start) -> list[float]:
    """The first state: wheels let spin at constant speed until they follow."""
    axles = (car.vehicle.front, car.vehicle.rear)
    radius = (axles[0].rolling_radius, axles[1].rolling_radius * (1 + car.hidden.radius_mismatch))
    y = [start.v, *(start.v / radius[i] for i in (0, 0, 1, 1)), 0.0, 0.0, 0.0, 0.0]
    y += [start.temperature, start.temperature, start.angle, 0.0, 0.0, 1.0, 1.0, 0.0]

    def frozen(t: float, omega: Array) -> list[float]:
        d = rates(0.0, [y[0], *omega.tolist(), *y[5:]])[0]
        return [d[i] - d[V] * w / start.v for i, w in enumerate(omega.tolist(), 1)]

    y[1:5] = solve_ivp(frozen, (0.0, 0.5), y[1:5], method="LSODA", rtol=1e-8).y[:, -1].tolist()
    return y


def equations(car: Car, lines: Lines) -> Rates:
    """Return the right-hand side, its constants bound."""
    h, nominal = car.hidden, car.vehicle
    weight = nominal.mass * (1.0 + h.mass_error) * GRAVITY
    length, height = nominal.wheelbase, nominal.cg_height
    axles = (nominal.front, nominal.front, nominal.rear, nominal.rear)
    side = (0, 0, 1, 1)
    radius = [a.rolling_radius for a in axles[:2]]
    radius += [a.rolling_radius * (1.0 + h.radius_mismatch) for a in axles[2:]]
    inertia = [axles[i].wheel_inertia + (h.inertia if i < 2 else 0.0) for i in range(4)]
    uneven = [h.imbalance, -h.imbalance]
    uneven += [h.imbalance_rear * x for x in uneven]
    gain = [
        a.friction_faces * a.piston_area * a.effective_radius * a.pad_friction * car.pad_scale[s]
        for a, s in zip(axles, side, strict=True)
    ]
    gain = [g * (1.0 + x) for g, x in zip(gain, uneven, strict=True)]
    pressures = [x.tolist() for x in (lines.master, lines.front, lines.rear)]
    last = len(pressures[0]) - 2
    omega_n = 2.0 * math.pi * h.pitch_frequency
    omega_s = 2.0 * math.pi * h.slosh_frequency
    pads = pad_law(h)
    rear_tyre = car.rear_tyre or car.tyre
    tyres = (car.tyre, car.tyre, rear_tyre, rear_tyre)
    stiffness_scale, slope = car.stiffness_scale, math.sin(math.atan(h.grade))

    def rates(t: float, y: list[float]) -> tuple[list[float], float]:
        v = max(y[V], 0.5)
        i = min(int(t / STEP), last)
        part = t / STEP - i
        master, p_f, p_r = (x[i] + part * (x[i + 1] - x[i]) for x in pressures)
        if h.abs_slip:
            p_f, p_r = p_f * y[ABS_F], p_r * y[ABS_R]
        k = (pads(v, y[T_F], p_f, y[E_F] / 2.0), pads(v, y[T_R], p_r, y[E_R]))
        rolls = radius
        if h.radius_load:  # a straight line in the load, in slip and lever alike
            f = nominal.cg_to_rear_axle / length
            more = y[Z] * height / length
            flat = (more / f, more / f, -more / (1.0 - f), -more / (1.0 - f))
            rolls = [r * (1.0 - h.radius_load * x) for r, x in zip(radius, flat, strict=True)]
        slips = [1.0 - rolls[i] * y[i + 1] / v for i in range(4)]
        stiffness = stiffness_scale * (1.0 + h.stiffness_speed * (v - 20.0))
        stiffness *= 1.0 - h.stiffness_heat * (y[E_F] + y[E_R])

        def push(z: float) -> tuple[list[float], list[float]]:
            f = 0.5 * weight * (nominal.cg_to_rear_axle + z * height) / length
            load = [f, f, 0.5 * weight - f, 0.5 * weight - f]
            pressed = zip(load, slips, tyres, strict=True)
            return load, [n * tyre(s, 4.0 * n / weight, stiffness, 1.0) for n, s, tyre in pressed]

        load, force = push(y[Z])
        if h.through_springs != 1.0:
            late = h.through_springs * y[Z]
            for _ in range(3):
                load, force = push(late + (1.0 - h.through_springs) * sum(force) / weight)
        if not h.pitch_frequency:  # the load follows at once: a fast fixed point
            for _ in range(2):
                load, force = push(sum(force) / weight)
        z_tyre = sum(force) / weight
        torque = [gain[i] * k[i // 2] * (p_f if i < 2 else p_r) for i in range(4)]
        if h.thickness:
            ripple = h.thickness * math.sin(y[ANGLE])
            torque[0] *= 1.0 + ripple
            torque[1] *= 1.0 + h.thickness_right * ripple
        other = list(resisting(h, load, radius, v))
        d = [0.0] * 17
        if h.regen_torque:
            for i in (2 * h.regen_axle, 2 * h.regen_axle + 1):
                demand = min(h.regen_torque, h.regen_power / y[i + 1]) * min(v / 3.0, 1.0)
                demand = demand if master > 1e5 else 0.0
                other[i] += y[MOTOR] if h.regen_lag else demand
            if h.regen_lag:
                d[MOTOR] = (demand - y[MOTOR]) / h.regen_lag
        for i in range(4):
            d[i + 1] = (rolls[i] * force[i] - torque[i] - other[i]) / inertia[i]
        spring = omega_s**2 * y[SLOSH] + 0.1 * omega_s * y[SLOSH_RATE] if h.slosh_mass else 0.0
        dry = (1.0 - h.slosh_mass) * weight / GRAVITY
        open_flap = h.flap_area * min(max((master - 2e5) / 10e5, 0.0), 1.0)
        drag = 0.5 * AIR * (h.drag_area + open_flap) * v * v
        body = sum(force) + drag + slope * weight * (1.0 - h.slosh_mass)
        d[V] = (h.slosh_mass * weight / GRAVITY * spring - body) / dry
        d[SLOSH], d[SLOSH_RATE] = y[SLOSH_RATE], -spring - d[V] - slope * GRAVITY
        if h.pitch_frequency:
            d[Z] = y[Z_RATE]
            d[Z_RATE] = omega_n**2 * (z_tyre - y[Z]) - 2.0 * h.pitch_damping * omega_n * y[Z_RATE]
        elif h.radius_load:  # the carcass settles within 10 ms
            d[Z] = (z_tyre - y[Z]) / 0.01
        d[E_F] = torque[0] * y[FL] + torque[1] * y[FR]
        d[E_R] = torque[2] * y[RL] + torque[3] * y[RR]
        d[T_F] = d[E_F] / CAPACITY[0] - COOLING[0] * (y[T_F] - AMBIENT)
        d[T_R] = d[E_R] / CAPACITY[1] - COOLING[1] * (y[T_R] - AMBIENT)
        d[ANGLE] = y[FL]
        if h.abs_slip:
            d[ABS_F] = modulation(0.5 * (slips[0] + slips[1]), y[ABS_F], h.abs_slip)
            d[ABS_R] = modulation(0.5 * (slips[2] + slips[3]), y[ABS_R], h.abs_slip)
        return d, d[V] + (slope * GRAVITY if h.grade_felt else 0.0)

    return rates


def pad_law(h: Hidden) -> Callable[[float, float, float, float], float]:
    """Return mu over its base level [1] of speed, disc temperature, pressure and energy."""

    def law(v: float, temperature: float, p: float, energy: float) -> float:
        k = 1.0
        if h.fade:
            x = (temperature - h.fade_onset) / FADE_WIDTH
            k *= 1.0 - h.fade * FADE_WIDTH * (math.log1p(math.exp(x)) if x < 30.0 else x)
        if h.speed_slope:
            k *= math.exp(h.speed_slope * (v - 20.0))
        if h.pressure_slope:
            k *= 1.0 + h.pressure_slope * (p - 20e5)
        if h.wet_loss:
            k *= 1.0 - h.wet_loss * math.exp(-energy / h.dry_energy)
        return k

    return law


def resisting(h: Hidden, load: list[float], radius: list[float], v: float) -> list[float]:
    """Moments against the rolling of the wheels [N m] beside the brakes."""
    rolling = h.rolling * (1.0 + 0.08 * ((v / 20.0) ** 2 - 1.0))
    engine = 0.5 * h.engine_torque * (0.9 + 0.1 * v / 20.0)
    fading = min(v / 2.0, 1.0)
    moments = [rolling * n * r * fading for n, r in zip(load, radius, strict=True)]
    moments[0] += engine * fading
    moments[1] += engine * fading
    moments[2] += h.seized * fading
    return moments


def modulation(slip: float, share: float, limit: float) -> float:
    """Rate [1/s] of the share of pressure that an anti-lock valve lets through."""
    over = 0.5 * (1.0 + math.tanh((slip - limit) / (0.05 * limit)))
    return over * -6.0 * max(share - 0.5, 0.0) + (1.0 - over) * 1.5 * (1.0 - share)


def readings(car: Car, lines: Lines, time: Array, y: Array, rates: Rates) -> dict[str, Array]:
    """What perfect sensors of this car read, its own sensor errors included."""
    h = car.hidden
    felt = np.array(
        [rates(t, s)[1] for t, s in zip(time.tolist(), y.T.tolist(), strict=True)],
    )
    if h.pitch_gain:
        felt = felt - GRAVITY * np.sin(h.pitch_gain * y[Z])
    grid = np.arange(lines.master.size) * STEP
    run = {"time": time, "p_mc": np.interp(time, grid, lines.master)}
    run |= {"a_x": filtered(time, felt * (1.0 + h.scale_error) + h.bias, h.filter_frequency)}
    for name, row in (("fl", FL), ("fr", FR), ("rl", RL), ("rr", RR)):
        run[f"omega_{name}"] = averaged(time, y[row], h.wheel_window)
    run["omega_fl"] *= 1.0 + h.tooth_error * np.cos(y[ANGLE])
    return run | {"v": earlier(time, y[V], h.v_late), "T_disc_f": y[T_F], "T_disc_r": y[T_R]}


def filtered(time: Array, x: Array, frequency: float) -> Array:
    """A Butterworth filter of second order, from rest, with its corner [Hz]; 0 for none."""
    if not frequency:
        return x
    corner = 2.0 * math.pi * frequency
    system = ([corner**2], [1.0, math.sqrt(2.0) * corner, corner**2])
    return x[0] + signal.lsim(system, x - x[0], time - time[0])[1]


def averaged(time: Array, x: Array, window: float) -> Array:
    """Means of ``x`` over the last ``window`` [s]; before the first sample it rose as at it."""
    if not window:
        return x.copy()
    path = integrate.cumulative_trapezoid(x, time, initial=0.0)
    then, rise = time - time[0] - window, (x[1] - x[0]) / (time[1] - time[0])
    quadratic = np.where(then < 0.0, x[0] * then + 0.5 * rise * then**2, 0.0)
    return (path - np.interp(then, time - time[0], path) - quadratic) / window


def earlier(time: Array, x: Array, by: float) -> Array:
    """``x`` of ``by`` [s] earlier, by a spline; before the first sample it rose as at it."""
    if not by:
        return x
    then = time - by
    rise = (x[1] - x[0]) / (time[1] - time[0])
    spline = interpolate.CubicSpline(time, x)(np.maximum(then, time[0]))
    return spline + rise * np.minimum(then - time[0], 0.0)
