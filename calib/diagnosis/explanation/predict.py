"""The sensor readings that a model predicts, along the measured speed.

    p_mc --> pressures --> torques --> tyre forces --> z --> a_x, v
                                         |
                                         +--> slips --> wheel speeds

The prediction uses the measured speed instead of integrating its own, so it does not drift, and a
whole run is computed in array operations, fast enough to be repeated a thousand times in a fit. The
open-loop replay (`calib.model.simulate`) is used to show the result. The wheel follows its
torque on the spring of its tyre (`calib.diagnosis.explanation.wheel_lag`).
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import LogError
from calib.base.names import AXLES, WHEELS, G
from calib.car.disc_temperature import START
from calib.car.effects.combined import (
    as_driven,
    as_read,
    caliper_pressure,
    line_pressure,
    pad_factors,
    speed_delay,
    total_axle_moment,
    total_body_force,
    total_load_shift,
    wheel_factors,
    wheel_speed_delay,
    wheel_speed_factors,
)
from calib.car.effects.effect import Pair
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads, tyre_force
from calib.car.history import Motion, RunHistory
from calib.car.lag import delayed, integral
from calib.car.magic_formula import MagicFormula
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import FORM_AT, Base
from calib.diagnosis.explanation.kept import Kept
from calib.diagnosis.explanation.own import FRONT_HEAT, OWN, REAR_HEAT, SLOPE, ZERO
from calib.diagnosis.explanation.wheel_lag import WheelLag
from calib.logs.log import Log
from calib.run.filters import block_mean, centred_mean
from calib.run.pedal import as_pressed

Array = NDArray[np.float64]

_GRID = 0.01
"""Clock on which a run is predicted [s]; a disc turns at most 20 times a second."""

_PASSES = 3
"""Times that loads, heat and torques are computed from each other."""

_PASSES_OF_TERM = 8
"""The same where an empirical term goes with the deceleration: each pass leaves its slope of the
error, up to a quarter. The first pass takes the measured deceleration, with its noise: with few
passes such a term would predict a_x from itself."""

EDGE = 0.985
"""Share of the peak up to which the rising branch is inverted; forces past it are held there."""


@dataclass(frozen=True)
class ObservedRun:
    """A log on the grid: means over its steps, shapes (n,), SI.

    ``omega`` (4, n) in the order of `WHEELS`; ``v_smooth`` the speed without sensor noise, for
    forces; ``temperature_f``, ``temperature_r`` smoothed, or None; ``angle_f``, ``angle_r`` of the
    wheels; ``drive_f``, ``drive_r`` torque of engine or motor [N m per axle], zero if not logged;
    ``own`` (8,) what it has of its own, see `calib.diagnosis.explanation.own`; ``averaged`` the
    number of samples of the log in a step; ``lags`` how its wheels followed in the last prediction:
    most predictions of a search change neither car nor tyre.
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
    drive_f: Array
    drive_r: Array
    own: Array = field(default_factory=lambda: np.zeros(len(OWN)))
    averaged: int = 1
    lags: Kept[Any, tuple[WheelLag, WheelLag]] = field(
        repr=False, compare=False, default_factory=Kept
    )

    @property
    def warm(self) -> bool:
        """Whether the temperatures of its discs are logged."""
        return self.temperature_f is not None and self.temperature_r is not None

    @property
    def start_heat(self) -> tuple[float, float]:
        """Of front and rear discs at the first sample [degC]; counts where none is logged."""
        front = START + float(self.own[FRONT_HEAT])
        return front, front + float(self.own[REAR_HEAT])


@dataclass(frozen=True)
class Prediction:
    """``a_x`` [m/s^2], ``gained`` speed since the start [m/s], ``omega`` [rad/s], all as read.

    Of the wheels (4, n) ``use`` the force over the load [1], ``lost`` the part of omega that the
    slip of a tyre without a departure takes [rad/s].
    """

    a_x: Array
    gained: Array
    omega: Array
    use: Array
    lost: Array


def run_of(log: Log) -> ObservedRun:
    """Average a log onto the grid. Raises LogError if it has no reference speed."""
    if "v" not in log:
        raise LogError(
            "no reference speed v",
            where=log.source,
            expected="v [m/s]",
            do="a diagnosis needs it: wheel speeds alone cannot tell slip from speed",
        )
    n = max(1, round(_GRID / log.sample_time))
    step = n * log.sample_time
    omega = np.stack([block_mean(log[f"omega_{w}"], n) for w in WHEELS])
    v = block_mean(log["v"], n)
    slow = max(1, round(0.5 / step))
    heat = [
        centred_mean(block_mean(log[name], n), slow, held_ends=True) if name in log else None
        for name in ("T_disc_f", "T_disc_r")
    ]
    turned = wheel_angles(log)
    drive = [
        block_mean(log[name] if name in log else np.zeros_like(log.time), n)
        for name in ("T_drive_f", "T_drive_r")
    ]
    return ObservedRun(
        name=log.name,
        time=block_mean(log.time, n),
        step=step,
        p_mc=as_pressed(block_mean(log["p_mc"], n), step),
        a_x=block_mean(log["a_x"], n),
        v=v,
        omega=omega,
        v_smooth=centred_mean(v, max(1, round(0.1 / step)), held_ends=True),
        temperature_f=heat[0],
        temperature_r=heat[1],
        angle_f=block_mean(turned["f"], n),
        angle_r=block_mean(turned["r"], n),
        drive_f=drive[0],
        drive_r=drive[1],
        averaged=n,
    )


def wheel_angles(log: Log) -> dict[str, Array]:
    """Measured angle of the wheels [rad] (n,) by axle, from the first sample on."""
    return {a: integral(log.time, 0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"])) for a in AXLES}


def predict(vehicle: Vehicle, base: Base, effects: Effects, run: ObservedRun) -> Prediction:
    """Predict a run.

    Loads and what depends on them are computed in `_PASSES`. The deceleration acts on the tyre
    forces through the inertia of the wheels alone, so each pass leaves 3 % of its error. Where the
    second pass finds the torques of the first, they depend on neither deceleration nor heat, and it
    is the last one.
    """
    car = as_driven(vehicle, effects).with_radii(base.radius)
    base = base.of_log(run.own)
    z = -run.a_x / G
    energy = (np.zeros_like(z), np.zeros_like(z))
    pressed = history_of(run)
    if base.clock != 0.0:
        on_time = np.interp(run.time - base.clock, run.time, run.p_mc)
        pressed = replace(pressed, p_mc=on_time)
    arrives = line_pressure(effects, pressed)
    clamps = caliper_pressure(effects, pressed, *arrives)
    drive = (run.drive_f, run.drive_r)
    bare, tyre = replace(car, effects=Effects()), base.tyre
    lags = run.lags.of((bare, tyre), lambda: _wheel_lags(bare, tyre, run))
    torques: list[Array] = []
    leans = any(term.driver == "deceleration" for term in effects.terms)
    for turn in range(_PASSES_OF_TERM if leans else _PASSES):
        history = _history(run, z, energy)
        before, torques = torques, _torques(car, base, effects, history, clamps)
        energy = _energy(run, torques)
        forces, rates, loads, z = _balance(car, effects, history, torques, drive, lags)
        if turn == 1 and not leans and all(map(np.array_equal, before, torques)):
            break
    late = wheel_speed_delay(effects)
    slips: list[Array] = []
    plain: list[Array] = []
    for i, force in enumerate(forces):
        if i % 2 == 1 and force is forces[i - 1]:  # left and right are equal
            slips.append(slips[-1])
            plain.append(plain[-1])
            continue
        load = np.maximum(loads[i], 1.0)
        slip = _slip(car, tyre, (force, rates[i]), load, lags[i // 2])
        plain.append(slip)
        if base.form is not None:
            slip = slip * (1.0 + np.interp(np.abs(force / load), FORM_AT, base.form[i // 2]))
        slips.append(delayed(run.time, slip, late))
    a_true = -G * z
    last = _history(run, z, energy)
    a_read = as_read(car, effects, last, a_true) + run.own[ZERO]
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (a_true[1:] + a_true[:-1])) * run.step])
    axles = (car.front, car.front, car.rear, car.rear)
    shown = delayed(run.time, gained, speed_delay(effects))  # by v as it is read
    v = run.v + (delayed(run.time, gained, late) - shown)  # of the time that the wheels show
    omega = np.stack(
        [v * (1.0 - s) / axle.rolling_radius for s, axle in zip(slips, axles, strict=True)]
    )
    moved = Motion(run.v_smooth, 2.0 * loads[0], 2.0 * loads[2], last)
    for w, factor in wheel_speed_factors(car, effects, moved).items():
        omega[WHEELS.index(w)] *= factor
    use = np.abs(np.stack(forces) / np.maximum(np.stack(loads), 1.0))
    radii = np.array([axle.rolling_radius for axle in axles])
    lost = np.stack(plain) * v / radii[:, None]
    return Prediction(
        a_read, shown - G * run.own[SLOPE] * (run.time - run.time[0]), omega, use, lost
    )


def history_of(run: ObservedRun) -> RunHistory:
    """The run as input of the effects before the first iteration: measured z, no energy."""
    nothing = np.zeros_like(run.time)
    return _history(run, -run.a_x / G, (nothing, nothing))


def _history(run: ObservedRun, z: Array, energy: tuple[Array, Array]) -> RunHistory:
    return RunHistory(
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
        source=run.name,
        start_heat=run.start_heat,
        averaged=run.averaged,
    )


def _energy(run: ObservedRun, torques: list[Array]) -> tuple[Array, Array]:
    """Heat of one brake of each axle since the first sample [J] (n,)."""
    front = np.cumsum(0.5 * (torques[0] + torques[1]) * run.omega[0]) * run.step
    rear = np.cumsum(0.5 * (torques[2] + torques[3]) * run.omega[2]) * run.step
    return front, rear


def _torques(
    car: Vehicle, base: Base, effects: Effects, history: RunHistory, clamps: Pair
) -> list[Array]:
    """Brake torque of every wheel [N m] in the order of `WHEELS`."""
    k_f, k_r = pad_factors(effects, history, *clamps)
    front = base.pad_friction_f * k_f * car.front.torque_gain * clamps[0]
    rear = base.pad_friction_r * k_r * car.rear.torque_gain * clamps[1]
    uneven = wheel_factors(effects, history)
    even = (front, front, rear, rear)
    return [
        torque * uneven[w] if w in uneven else torque
        for w, torque in zip(WHEELS, even, strict=True)
    ]


def _wheel_lags(car: Vehicle, tyre: MagicFormula, run: ObservedRun) -> tuple[WheelLag, WheelLag]:
    """How the wheels of both axles follow, as if both used the road as the whole car does."""
    z, out = -run.a_x / G, []
    for axle, load in zip((car.front, car.rear), axle_loads(car, z), strict=True):
        relative = 2.0 * load / car.weight
        _, slope, _ = tyre.rising(z, relative, EDGE)
        tau = axle.wheel_inertia * run.v_smooth / axle.rolling_radius**2 / (0.5 * load * slope)
        out.append(WheelLag.of(tau, tyre.relaxation, run.v_smooth, run.step))
    return out[0], out[1]


def _balance(
    car: Vehicle,
    effects: Effects,
    history: RunHistory,
    torques: list[Array],
    drive: Pair,
    lags: tuple[WheelLag, WheelLag],
) -> tuple[list[Array], list[Array], list[Array], Array]:
    """Tyre forces [N], their rates [N/s] and loads [N] of every wheel, and z [1].

    From z of the last iteration.
    """
    late = car.weight * total_load_shift(car, effects, history)
    load_f, load_r = axle_loads(car, history.z)
    halves = (0.5 * (load_f - late), 0.5 * (load_r + late))
    motion = Motion(history.v, 2.0 * halves[0], 2.0 * halves[1], history)
    moments = total_axle_moment(car, effects, motion)
    forces: list[Array] = []
    rates: list[Array] = []
    for i, torque in enumerate(torques):
        if i % 2 == 1 and torque is torques[i - 1]:  # left and right are equal
            forces.append(forces[-1])
            rates.append(rates[-1])
            continue
        side = i // 2
        axle = (car.front, car.rear)[side]
        spin = -G * history.z / axle.rolling_radius
        steady = tyre_force(axle, torque, spin, 0.5 * (moments[side] - drive[side]))
        force, rate = lags[side].follow(steady)
        forces.append(force)
        rates.append(rate)
    loads = [halves[0], halves[0], halves[1], halves[1]]
    total = forces[0] + forces[1] + forces[2] + forces[3]
    return forces, rates, loads, (total + total_body_force(car, effects, motion)) / car.weight


def _slip(
    car: Vehicle, tyre: MagicFormula, force: tuple[Array, Array], load: Array, lag: WheelLag
) -> Array:
    """Slip [1] of a wheel while its tyre carries a force [N] that has a rate [N/s].

    On the rising branch; forces past it are held there.
    """
    carried = force[0] / load
    slip, slope, held = tyre.rising(carried, 4.0 * load / car.weight, EDGE)
    if tyre.relaxation == 0.0:
        return slip
    change = (force[1] - carried * np.gradient(load, lag.step)) / load
    return slip + np.where(held, 0.0, lag.way * change / slope)
