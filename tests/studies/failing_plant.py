"""Drive cars of a third plant, many at once, with ABS of two kinds; for studies of faults.

The plant shares nothing with `calib` but the record of the vehicle. Cars are drawn at random. Each
wheel spins (semi-implicit Euler, steps of 1 ms), tyres follow the Magic Formula, and the load of
the axles follows the deceleration with a lag. A study puts faults into the logs afterwards. SI.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.sensor_noise import add_noise
from tests.support.reference_car import CAR

G, AIR, STEP, EVERY = 9.80665, 1.2, 1e-3, 5
PATTERN, SLIP = 1, 2  # kinds of ABS: a periodic pressure, and a threshold of the slip


@dataclass(frozen=True)
class Plant:
    """A car as it is; ``vehicle`` is the record that the program gets."""

    vehicle: Vehicle
    stiffness: float
    peak: float
    rear_stiffness: float
    drag_area: float
    rolling: float
    radius_scale: tuple[float, float]
    pads: tuple[float, float]
    a_x_offset: float
    a_x_scale: float


@dataclass
class Scene:
    """The course of a run: signals over time (t,), where None stands for a constant."""

    plant: Plant
    v0: float
    pressure: Array  # (t,)
    pads: Array | None = None  # factors (t, 2)
    grade: Array | None = None  # (t,)
    road: Array | None = None  # factor on stiffness and peak (t, 2)
    motor: Array | None = None  # (t, 2), N m
    logged: bool = True  # the motor's torque
    abs_kind: int = 0
    abs_from: float = np.inf
    abs_how: tuple[float, float, float, bool] = (0.1, 5.0, 0.3, False)
    # slip threshold, frequency [Hz], depth, rear alone
    name: str = ""
    notes: dict = field(default_factory=dict)


def drawn(seed: int) -> Plant:
    """Return a car of a random size."""
    r = np.random.default_rng(seed)
    mass, base = r.uniform(1000, 2600), r.uniform(2.4, 3.1)
    front = base * r.uniform(0.40, 0.52)  # cg to front axle
    height = r.uniform(0.48, 0.72)
    radius = r.uniform(0.28, 0.37)
    share = (base - front + r.uniform(0.6, 0.9) * height) / base
    per_bar = r.uniform(0.010, 0.015)  # g per bar
    mu = r.uniform(0.34, 0.42)
    gain = per_bar / 1e5 * mass * G * radius / mu / 4.0  # of two faces and two wheels
    reach = r.uniform(0.11, 0.15)
    v = replace(
        CAR,
        name=f"car-{seed}", mass=mass, cg_to_front_axle=front, cg_to_rear_axle=base - front,
        cg_height=height, track_width=r.uniform(1.4, 1.7),
        front=replace(CAR.front, rolling_radius=radius, wheel_inertia=mass / 1500,
                      piston_area=gain * share / reach, effective_radius=reach, pad_friction=mu),
        rear=replace(CAR.rear, rolling_radius=radius, wheel_inertia=mass / 1600,
                     piston_area=gain * (1 - share) / reach, effective_radius=reach,
                     pad_friction=mu),
    )  # fmt: skip
    return Plant(
        v, r.uniform(18, 35), r.uniform(0.85, 1.15), np.exp(r.normal(0, 0.05)),
        r.uniform(0.5, 1.0), r.uniform(0.008, 0.013), (1.0, 1.0 + r.normal(0, 0.002)),
        (np.exp(r.normal(0, 0.05)) * mu, np.exp(r.normal(0, 0.05)) * mu),
        r.normal(0, 0.15), 1.0 + r.normal(0, 0.007),
    )  # fmt: skip


def run(scenes: list[Scene], seed: int = 0) -> list[Log]:
    """Drive all scenes at once; return logs at 200 Hz with noise, and with the truth."""
    n, steps = len(scenes), min(s.pressure.size for s in scenes)
    ps = [s.plant for s in scenes]

    def per(f):
        return np.array([f(p) for p in ps], float)

    def trace(name, default):
        return np.stack(
            [np.broadcast_to(default if getattr(s, name) is None else getattr(s, name),
                             (s.pressure.size, *np.shape(default)))[:steps] for s in scenes], 1
        )  # fmt: skip

    m, h = per(lambda p: p.vehicle.mass), per(lambda p: p.vehicle.cg_height)
    lf, lr = per(lambda p: p.vehicle.cg_to_front_axle), per(lambda p: p.vehicle.cg_to_rear_axle)
    wheels = [0, 0, 1, 1]
    axles = [lambda p: p.vehicle.front, lambda p: p.vehicle.rear]
    radius = np.stack([per(lambda p, i=i: axles[i](p).rolling_radius * p.radius_scale[i])
                       for i in wheels], 1)  # fmt: skip
    inertia = np.stack([per(lambda p, i=i: axles[i](p).wheel_inertia) for i in wheels], 1)
    gain = np.stack([per(lambda p, i=i: axles[i](p).torque_gain * p.pads[i]) for i in wheels], 1)
    stiff = np.stack([per(lambda p, i=i: p.stiffness * (p.rear_stiffness if i else 1.0))
                      for i in wheels], 1)  # fmt: skip
    peak, drag = per(lambda p: p.peak)[:, None], per(lambda p: p.drag_area)
    rolling = per(lambda p: p.rolling)[:, None]
    pads, grade = trace("pads", np.ones(2)), trace("grade", 0.0)
    road, motor = trace("road", np.ones(2)), trace("motor", np.zeros(2))
    kind = np.array([s.abs_kind for s in scenes])[:, None]
    start = np.array([s.abs_from for s in scenes])[:, None]
    threshold, hertz, depth = (np.array([s.abs_how[i] for s in scenes])[:, None] for i in range(3))
    acts = np.array([[not s.abs_how[3], not s.abs_how[3], True, True] for s in scenes])
    pressures = np.stack([s.pressure[:steps] for s in scenes], 1)
    v = np.array([s.v0 for s in scenes])
    omega, transfer, line = v[:, None] / radius, np.zeros(n), np.zeros((n, 4))
    factor, releasing = np.ones((n, 4)), np.zeros((n, 4), bool)
    phase = np.random.default_rng(seed).uniform(0, 1, (n, 4))
    weight, out = m * G, []
    for k in range(steps):
        t = k * STEP
        active = (t >= start) & acts & (kind > 0)
        half_f = 0.5 * weight * (lr + transfer * h) / (lf + lr)
        half_r = 0.5 * weight - half_f
        load = np.maximum(np.stack([half_f, half_f, half_r, half_r], 1), 50.0)
        vv = np.maximum(v, 0.3)[:, None]
        slip = 1.0 - radius * omega / vv
        C, top = stiff * road[k][:, :1], peak * road[k][:, 1:]
        b = C / (1.65 * top)
        force = load * top * np.sin(1.65 * np.arctan(b * slip))
        slope = load * C * np.cos(1.65 * np.arctan(b * slip)) / (1.0 + (b * slip) ** 2)
        # ABS
        releasing = np.where(slip > threshold, True, np.where(slip < 0.4 * threshold, False,
                                                              releasing))  # fmt: skip
        by_slip = np.clip(factor + STEP * np.where(releasing, -12.0, 2.5), 0.1, 1.0)
        wave = (t * hertz + phase) % 1.0
        by_pattern = 1.0 - depth * np.where(wave < 0.4, 1.0, (1.0 - wave) / 0.6)
        factor = np.where(active, np.where(kind == SLIP, by_slip, by_pattern), 1.0)
        want = pressures[k][:, None] * factor
        line = line + (want - line) * STEP / 0.02
        torque = gain * pads[k][:, wheels] * np.maximum(line, 0.0)
        moving = np.tanh(omega / 0.3)
        drive = 0.5 * motor[k][:, wheels]
        net = radius * (force - rolling * load * moving) - torque * moving + drive
        stiffness = radius**2 * slope / vv
        omega = np.maximum(omega + STEP * net / (inertia + STEP * np.maximum(stiffness, 0)), 0.0)
        felt = (force.sum(1) + 0.5 * AIR * drag * v**2) / weight
        transfer = transfer + (felt - transfer) * STEP / 0.08
        v = v - STEP * G * (felt + grade[k])
        if k % EVERY == 0:
            out.append((v, felt, omega, torque, factor))
    v, felt, omega, torque, factor = (np.stack(x) for x in zip(*out, strict=True))
    return [_log(s, i, seed, felt[:, i], omega[:, i], torque[:, i], motor[::EVERY, i],
                 pressures[::EVERY, i], v[:, i], factor[:, i])
            for i, s in enumerate(scenes)]  # fmt: skip


def _log(s, i, seed, felt, omega, torque, motor, pressure, v, factor) -> Log:
    p = s.plant
    keep = v > 2.0
    last = int(np.argmin(keep)) if not keep.all() else len(v)
    t = EVERY * STEP * np.arange(len(v))
    channels = {"time": t, "p_mc": pressure, "a_x": -G * p.a_x_scale * felt + p.a_x_offset}
    channels |= {f"omega_{w}": omega[:, j] for j, w in enumerate(("fl", "fr", "rl", "rr"))}
    if s.motor is not None and s.logged:
        channels |= {"T_drive_f": motor[:, 0], "T_drive_r": motor[:, 1]}
    truth = {"true_Tb_f": 0.5 * (torque[:, 0] + torque[:, 1]),
             "true_Tb_r": 0.5 * (torque[:, 2] + torque[:, 3]),
             "abs": (np.abs(factor - 1.0).max(1) > 0) * 1.0, "v": v}  # fmt: skip
    cut = slice(max(last, 100))
    log = Log(s.name, "plant", "", {k: x[cut] for k, x in channels.items()},
              {k: x[cut] for k, x in truth.items()})  # fmt: skip
    return add_noise(log, seed * 1000 + i)
