"""The physics of `calib.forces` forward: from pressure and first speed to what the sensors see.

    v(t) --> loads, effects, torques --> slip (1) --> tyre forces --> z(t) (5) --> v(t)
     ^                                                                  |
     +------------------ until v and slip no longer change -------------+

The whole run is one array; a pass takes every sample at once. Each sample depends on earlier ones
only, so the passes settle from the front to the back, and what lies after the end of the run (the
stop, or a wheel past the peak of its tyre) cannot disturb what lies before.

Straight line; left and right tyres alike; load transfer without delay; slip on the rising branch.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib import forces, wheel
from calib.effects.catalogue import total_axle_moment, total_body_force
from calib.effects.effect import Motion, Parameters
from calib.errors import ModelError
from calib.logs.log import Log
from calib.magic_formula import MagicFormula
from calib.model import Model
from calib.names import WHEELS, G
from calib.table import content_digest
from calib.vehicle import Axle

Array = NDArray[np.float64]

TOLERANCE = 1e-9
"""Largest change of v (relative to the first speed) and of slip in the last pass."""

PASSES = 60
"""A pass gains one to two digits; half a minute of coasting takes a dozen."""

RELAXATION_LENGTH = 0.3
"""Length [m] over which a tyre takes to a new surface; a passenger-car tyre rolls 0.2 to 0.5 m."""

LEAST_LOAD = 0.01
"""Share of the weight [1] below which an axle counts as lifted."""


@dataclass(frozen=True)
class Run:
    """What does not change from pass to pass: ``time`` [s] (n,), ``pressure`` [Pa] (n,) by wheel.

    Only the left wheels are there when the right ones are their mirror image.
    """

    model: Model
    time: Array
    pressure: dict[str, Array]
    v0: float
    stop_speed: float

    def axle(self, w: str) -> Axle:
        """The axle of a wheel."""
        return self.model.vehicle.front if w[0] == "f" else self.model.vehicle.rear

    def torque(self, w: str) -> Array:
        """Brake torque of one wheel [N m] (n,)."""
        pads = self.model.pad_friction_f if w[0] == "f" else self.model.pad_friction_r
        return forces.brake_torque(self.axle(w), pads, self.pressure[w])

    def total(self, force: Mapping[str, Array]) -> Array:
        """Sum of the tyre forces of all four wheels [N] (n,)."""
        mirrored = len(WHEELS) / len(force)
        return np.asarray(mirrored * np.sum(list(force.values()), axis=0))

    def speed(self, z: Array) -> Array:
        """V [m/s] (n,): v0 less the integral of g z, by trapezes."""
        lost = 0.5 * G * (z[1:] + z[:-1]) * np.diff(self.time)
        return self.v0 - np.concatenate([[0.0], np.cumsum(lost)])


@dataclass(frozen=True)
class State:
    """One pass: ``v`` [m/s], ``z`` [1] (n,); by wheel slip [1], what it was asked for, force [N].

    ``used`` is the slip over that of the tyre's peak [1]; above 1 the state is not physical.
    """

    v: Array
    z: Array
    slip: dict[str, Array]
    demand: dict[str, wheel.Demand]
    force: dict[str, Array]
    used: dict[str, Array]


def simulate(
    model: Model,
    time: Array,
    pressure: Array,
    v0: float,
    *,
    wheel_pressure: Mapping[str, Array] | None = None,
    stop_speed: float = 1.0,
    name: str = "simulation",
) -> Log:
    """Drive the model from ``v0`` [m/s] with ``pressure`` [Pa] in the brakes at ``time`` [s].

    Arrays are (n,). ``wheel_pressure`` holds pressures of single wheels [Pa] by wheel name; the
    others have ``pressure``. The first sample is taken as steady. Returns a log with truth
    channels. It ends with the last sample at or above ``stop_speed`` [m/s], or the last one before
    a wheel would pass the peak of its tyre or an axle would lift; its last note says which, when
    and why.

    Raises ModelError if there is nothing to drive: ``v0`` not above ``stop_speed``, shapes that
    differ, time that does not increase, numbers that are not finite, an end before the second
    sample.
    """
    own = dict(wheel_pressure or {})
    _check_drive(time, {"pressure": pressure, **own}, v0, stop_speed)
    solved = WHEELS if own else ("fl", "rl")
    run = Run(model, time, {w: own.get(w, pressure) for w in solved}, v0, stop_speed)
    state = _settle(run)
    end, note = _end(run, state)
    channels = _channels(run, state, pressure, own, end)
    truth = _truth(run, state, end)
    return Log(
        name=name,
        source=f"simulation of {model.vehicle.name}",
        digest=content_digest({"name": name}, {"channels": channels, "truth": truth}),
        channels=channels,
        truth=truth,
        notes=(note,),
    )


def tyres_along(model: Model, time: Array, v: Array) -> tuple[MagicFormula, MagicFormula]:
    """The tyre of the front and of the rear axle on the surface under it, at every sample."""
    if not model.surfaces:
        return model.tyre, model.tyre
    travelled = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(time))])
    front, rear = (
        _tyre_at(model, time, travelled, behind) for behind in (0.0, model.vehicle.wheelbase)
    )
    return front, rear


def _tyre_at(model: Model, time: Array, travelled: Array, behind: float) -> MagicFormula:
    """The tyre of an axle ``behind`` [m] the front one; a surface comes within a tyre's length."""
    starts, factors = [], [(1.0, 1.0)]
    for surface in model.surfaces:
        on_road = surface.unit == "m"
        starts.append(surface.start if on_road else np.interp(surface.start, time, travelled))
        factors.append((surface.stiffness, surface.peak))
    points = np.ravel([[start, start + RELAXATION_LENGTH] for start in starts])
    logs = np.repeat(np.log(factors), 2, axis=0)[1:-1]
    stiffness, peak = (np.exp(np.interp(travelled - behind, points, c)) for c in logs.T)
    return model.tyre.on_surface(stiffness, peak)


def _check_drive(time: Array, pressures: Mapping[str, Array], v0: float, stop_speed: float) -> None:
    if not 0.0 < stop_speed < v0 < np.inf:
        raise ModelError(
            f"first speed {v0:g} m/s", expected=f"more than the stop speed, {stop_speed:g} m/s"
        )
    if time.size < 2 or not np.all(np.diff(time) > 0.0):
        raise ModelError("time does not increase", expected="two samples or more, each later")
    for name, pressure in pressures.items():
        if name not in ("pressure", *WHEELS):
            raise ModelError(f"unknown wheel {name!r}", expected=f"one of {', '.join(WHEELS)}")
        if pressure.shape != time.shape or not np.all(np.isfinite(pressure)):
            raise ModelError(
                f"pressure of shape {pressure.shape} or not finite",
                where=name,
                expected=f"{time.size} finite samples",
            )


def _settle(run: Run) -> State:
    """Pass until neither v nor slip changes before the end. Raises ModelError if they never do."""
    state = _first(run)
    for _ in range(PASSES):
        new = _pass(run, state)
        end, why = _end(run, new)
        if end < 2:
            raise ModelError("nothing to simulate", expected="two samples or more", do=why)
        before = slice(0, end)
        changes = [np.abs(new.v - state.v)[before] / run.v0]
        changes += [np.abs(new.slip[w] - state.slip[w])[before] for w in new.slip]
        state = new
        if np.max(changes) < TOLERANCE:
            return state
    raise ModelError(
        f"the simulation did not settle in {PASSES} passes",
        where=run.model.vehicle.name,
        do="check the parameters of the effects and the clock of the log",
    )


def _first(run: Run) -> State:
    """Where the passes start: no effects, no inertia, every wheel on a straight tyre."""
    force = {w: run.torque(w) / run.axle(w).rolling_radius for w in run.pressure}
    z = run.total(force) / run.model.vehicle.weight
    slip = {w: np.clip(z / np.mean(run.model.tyre.stiffness), -0.02, 0.02) for w in force}
    return State(run.speed(z), z, slip, {}, force, {})


def _pass(run: Run, old: State) -> State:
    """Loads (6), (7), effects, one step towards (1) for every wheel, (5), and v."""
    model, vehicle = run.model, run.model.vehicle
    effects: dict[str, Parameters] = dict(model.effects)
    # After the stop v is of no matter, but it must not turn the equations over.
    travel = wheel.Travel(run.time, np.maximum(old.v, 0.5 * run.stop_speed), old.z)
    raw = forces.axle_loads(vehicle, old.z)
    loads = [np.maximum(load, LEAST_LOAD * vehicle.weight) for load in raw]
    motion = Motion(travel.v, *loads)
    moments = total_axle_moment(vehicle, effects, motion)
    tyres = tyres_along(model, run.time, travel.v)
    slip, demand, force, used = {}, {}, {}, {}
    for w in run.pressure:
        i = "fr".index(w[0])
        tyre = wheel.RisingTyre(tyres[i], 2.0 * loads[i] / vehicle.weight)
        demand[w] = wheel.Demand(run.torque(w), 0.5 * moments[i], 0.5 * loads[i])
        slip[w] = wheel.next_slip(run.axle(w), tyre, demand[w], travel, old.slip[w])
        force[w] = demand[w].load * tyre.force(slip[w])
        used[w] = tyre.used(slip[w])
    z = (run.total(force) + total_body_force(vehicle, effects, motion)) / vehicle.weight  # (5)
    return State(run.speed(z), z, slip, demand, force, used)


def _end(run: Run, state: State) -> tuple[int, str]:
    """Number of samples that stand, and why there are no more."""
    loads = forces.axle_loads(run.model.vehicle, state.z)
    limits = {
        f"slower than {run.stop_speed:g} m/s": state.v < run.stop_speed,
        "the front axle would lift": loads[0] < LEAST_LOAD * run.model.vehicle.weight,
        "the rear axle would lift": loads[1] < LEAST_LOAD * run.model.vehicle.weight,
    } | {f"wheel {w} would pass the peak of its tyre": used > 1.0 for w, used in state.used.items()}
    met = {why: int(np.argmax(beyond)) for why, beyond in limits.items() if np.any(beyond)}
    if not met:
        return run.time.size, f"ends with its pressure at {run.time[-1]:.3f} s"
    end = min(met.values())
    reasons = ", ".join(why for why, index in met.items() if index == end)
    pressure = max(p[end] for p in run.pressure.values()) / 1e5
    return end, f"ends before {run.time[end]:.3f} s at {pressure:.1f} bar: {reasons}"


def _channels(
    run: Run, state: State, pressure: Array, own: Mapping[str, Array], end: int
) -> dict[str, Array]:
    omega = {w: forces.wheel_speed(run.axle(w), state.slip[_twin(run, w)], state.v) for w in WHEELS}
    channels = {"time": run.time, "p_mc": pressure, "a_x": -G * state.z}
    channels |= {f"omega_{w}": omega[w] for w in WHEELS} | {"v": state.v}
    channels |= {f"p_{w}": own[w] for w in WHEELS if w in own}
    return {name: values[:end].copy() for name, values in channels.items()}


def _truth(run: Run, state: State, end: int) -> dict[str, Array]:
    truth = {f"true_Tb_{w}": state.demand[_twin(run, w)].torque for w in WHEELS}
    truth |= {f"true_Fx_{w}": state.force[_twin(run, w)] for w in WHEELS}
    truth |= {f"true_Fz_{w}": state.demand[_twin(run, w)].load for w in WHEELS}
    truth["true_mu_pad_f"] = np.full(run.time.size, run.model.pad_friction_f)
    truth["true_mu_pad_r"] = np.full(run.time.size, run.model.pad_friction_r)
    return {name: values[:end].copy() for name, values in truth.items()}


def _twin(run: Run, w: str) -> str:
    """The wheel that was solved for this one."""
    return w if w in run.pressure else f"{w[0]}l"
