"""What a model says the sensors should read, along the speed that was measured.

    p_mc --> pressures --> torques --> tyre forces --> z --> a_x, v
                                         |
                                         +--> slips --> wheel speeds

The measured speed stands where the state would be, so nothing drifts and a whole run is one pass of
arrays: cheap enough to ask it a thousand times. The open-loop replay (`calib.simulate`) is for
showing; this is for fitting. The change of slip is left out of d omega/dt: the wheel follows within
J v/(R^2 F_z K), 2 to 6 ms.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.effects.catalogue import effect_named
from calib.effects.effect import Effect, Motion, Parameters, Trace
from calib.errors import LogError
from calib.logs.log import Log
from calib.names import WHEELS, G
from calib.vehicle import Vehicle

Array = NDArray[np.float64]
Effects = Mapping[str, Parameters]

GRID = 0.01
"""Clock on which a run is predicted [s]; a disc turns at most 20 times a second."""

SHAPE = 1.65
"""Shape factor of the Magic Formula that stands for any tyre here."""

EDGE = 0.985
"""Share of the peak up to which the rising branch is inverted; forces past it are held there."""


@dataclass(frozen=True)
class Base:
    """What is re-identified always: pad friction of the axles [1], tyre stiffness and peak [1]."""

    pad_friction_f: float
    pad_friction_r: float
    stiffness: float
    peak: float


@dataclass(frozen=True)
class Run:
    """A log on the grid: means over its steps, shapes (n,), SI.

    ``omega`` (4, n) in the order of `WHEELS`; ``v_smooth`` the speed without sensor noise, for
    forces; ``temperature_f``, ``temperature_r`` smoothed, or None; ``angle`` of the front wheels.
    """

    name: str
    time: Array
    step: float
    p_mc: Array
    a_x: Array
    v: Array
    omega: Array
    v_smooth: Array
    temperature_f: Array | None
    temperature_r: Array | None
    angle_f: Array
    angle_r: Array


@dataclass(frozen=True)
class Prediction:
    """``a_x`` [m/s^2] as read, ``gained`` speed since the first sample [m/s], ``omega`` [rad/s]."""

    a_x: Array
    gained: Array
    omega: Array
    torque_f: Array
    torque_r: Array


def run_of(log: Log) -> Run:
    """Put a log on the grid. Raises LogError without a reference speed."""
    if "v" not in log:
        raise LogError(
            "no reference speed v",
            where=log.source,
            expected="v [m/s]",
            do="a diagnosis needs it: wheel speeds alone cannot tell slip from speed",
        )
    n = max(1, round(GRID / log.sample_time))
    count = log.time.size // n

    def mean(x: Array) -> Array:
        return np.asarray(x[: count * n].reshape(count, n).mean(axis=1))

    step = n * log.sample_time
    omega = np.stack([mean(log[f"omega_{w}"]) for w in WHEELS])
    v = mean(log["v"])
    heat = [log.channels.get(f"T_disc_{side}") for side in "fr"]
    return Run(
        name=log.name,
        time=mean(log.time),
        step=step,
        p_mc=mean(log["p_mc"]),
        a_x=mean(log["a_x"]),
        v=v,
        omega=omega,
        v_smooth=smooth(v, max(1, round(0.1 / step))),
        temperature_f=None if heat[0] is None else smooth(mean(heat[0]), max(1, round(0.5 / step))),
        temperature_r=None if heat[1] is None else smooth(mean(heat[1]), max(1, round(0.5 / step))),
        angle_f=np.cumsum(0.5 * (omega[0] + omega[1])) * step,
        angle_r=np.cumsum(0.5 * (omega[2] + omega[3])) * step,
    )


def smooth(x: Array, width: int) -> Array:
    """Centred mean over ``width`` samples, the ends held."""
    left = width // 2
    padded = np.pad(x, (left, width - 1 - left), "edge")
    total = np.cumsum(np.concatenate([[0.0], padded]))
    return np.asarray((total[width:] - total[:-width]) / width)


PRESSURE_ORDER = (
    "hydraulic_delay",
    "hydraulic_lag",
    "rear_proportioning",
    "brake_threshold_pressure",
    "caliper_hysteresis",
)
"""From the master cylinder to the pads."""


Term = tuple[Effect, Parameters]


def predict(
    vehicle: Vehicle, base: Base, effects: Effects, run: Run, extra: tuple[Term, ...] = ()
) -> Prediction:
    """Predict a run; ``extra`` are effects outside the catalogue.

    Loads and what depends on them are passed through three times, which settles them.
    """
    present = [(effect_named(name), parameters) for name, parameters in effects.items()]
    present += extra
    weight = vehicle.mass * G
    for effect, parameters in present:
        weight *= effect.mass(parameters)
    z = -run.a_x / G
    energy = (np.zeros_like(z), np.zeros_like(z))
    state = _State(vehicle, base, run, present, weight)
    for _ in range(3):
        trace = _trace(run, z, energy)
        torques = state.torques(trace)
        energy = _energy(run, torques)
        forces, loads, z = state.balance(trace, torques, z)
    slips = [state.slip(force, load) for force, load in zip(forces, loads, strict=True)]
    a_true = -G * z
    a_read = a_true
    trace = _trace(run, z, energy)
    for effect, parameters in present:
        a_read = effect.accelerometer(vehicle, parameters, trace, a_read)
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (a_true[1:] + a_true[:-1])) * run.step])
    omega = np.stack([run.v * (1.0 - slips[i]) / state.radius[i // 2] for i in range(4)])
    return Prediction(a_read, gained, omega, torques[0] + torques[1], torques[2] + torques[3])


def trace_of(run: Run) -> Trace:
    """The run as an effect sees it before anything is predicted: measured z, no energy."""
    nothing = np.zeros_like(run.time)
    return _trace(run, -run.a_x / G, (nothing, nothing))


def _trace(run: Run, z: Array, energy: tuple[Array, Array]) -> Trace:
    return Trace(
        time=run.time,
        v=run.v_smooth,
        z=z,
        p_mc=run.p_mc,
        temperature_f=run.temperature_f,
        temperature_r=run.temperature_r,
        angle_f=run.angle_f,
        angle_r=run.angle_r,
        energy_f=energy[0],
        energy_r=energy[1],
    )


def _energy(run: Run, torques: list[Array]) -> tuple[Array, Array]:
    """Energy turned into heat by one brake of each axle so far [J]."""
    front = np.cumsum(0.5 * (torques[0] + torques[1]) * run.omega[0]) * run.step
    rear = np.cumsum(0.5 * (torques[2] + torques[3]) * run.omega[2]) * run.step
    return front, rear


class _State:
    """The chain of one run: what stays the same from pass to pass."""

    def __init__(
        self,
        vehicle: Vehicle,
        base: Base,
        run: Run,
        present: list[tuple[Effect, Parameters]],
        weight: float,
    ):
        self.vehicle, self.base, self.run, self.weight = vehicle, base, run, weight
        order = {name: i for i, name in enumerate(PRESSURE_ORDER)}
        self.present = sorted(present, key=lambda item: order.get(item[0].card.name, 99))
        self.axles = (vehicle.front, vehicle.rear)
        self.radius = [axle.rolling_radius for axle in self.axles]
        self.inertia = [axle.wheel_inertia for axle in self.axles]
        for effect, parameters in self.present:
            for i, (factor, extra) in enumerate(
                zip(effect.radius(parameters), effect.inertia(parameters), strict=True)
            ):
                self.radius[i] *= factor
                self.inertia[i] += extra

    def torques(self, trace: Trace) -> list[Array]:
        """Brake torque of every wheel [N m] in the order of `WHEELS`."""
        p_f = p_r = self.run.p_mc
        for effect, parameters in self.present:
            p_f, p_r = effect.pressure(parameters, trace, p_f, p_r)
        k_f, k_r = np.ones_like(p_f), np.ones_like(p_r)
        for effect, parameters in self.present:
            f, r = effect.friction(parameters, trace, p_f, p_r)
            k_f, k_r = k_f * f, k_r * r
        front = self.base.pad_friction_f * k_f * self.vehicle.front.torque_gain * p_f
        rear = self.base.pad_friction_r * k_r * self.vehicle.rear.torque_gain * p_r
        out = [front, front, rear, rear]
        for effect, parameters in self.present:
            for wheel, factor in effect.wheels(parameters, trace).items():
                out[WHEELS.index(wheel)] = out[WHEELS.index(wheel)] * factor
        return out

    def balance(
        self, trace: Trace, torques: list[Array], z: Array
    ) -> tuple[list[Array], list[Array], Array]:
        """Tyre forces and loads of every wheel [N], and z [1], from z of the last pass."""
        car, W = self.vehicle, self.weight
        shift = np.zeros_like(z)
        for effect, parameters in self.present:
            shift = shift + effect.load_shift(car, parameters, trace)
        share = car.cg_to_rear_axle + z * car.cg_height
        load_f = W * (share / car.wheelbase - shift)
        load_r = W - load_f
        motion = Motion(trace.v, load_f, load_r, trace)
        moment = [np.zeros_like(z), np.zeros_like(z)]
        body = np.zeros_like(z)
        for effect, parameters in self.present:
            f, r = effect.axle_moment(car, parameters, motion)
            moment = [moment[0] + f, moment[1] + r]
            body = body + effect.body_force(car, parameters, motion)
        forces = []
        for i, torque in enumerate(torques):
            side = i // 2
            spin = -G * z / self.radius[side]
            forces.append(
                (torque + 0.5 * moment[side] + self.inertia[side] * spin) / self.radius[side]
            )
        total = forces[0] + forces[1] + forces[2] + forces[3] + body
        loads = [0.5 * load_f, 0.5 * load_f, 0.5 * load_r, 0.5 * load_r]
        return forces, loads, total / W

    def slip(self, force: Array, load: Array) -> Array:
        """Slip [1] on the rising branch of the Magic Formula."""
        peak, stiffness = self.base.peak, self.base.stiffness
        x = np.clip(force / np.maximum(load, 1.0) / peak, -EDGE, EDGE)
        return np.asarray(SHAPE * peak / stiffness * np.tan(np.arcsin(x) / SHAPE))
