"""Solve the equations of a run by a fixed-point iteration over speed, loads, torques and slips.

    v(t) --> loads, effects, torques --> slip (1) --> tyre forces --> z(t) (5) --> v(t)
     ^                                                                              |
     +------------------------ until v and slip do not change ----------------------+

An iteration takes every sample at once. Each sample depends on earlier ones only, so the
solution converges from the first sample to the last. Samples after the end of the run (the stop,
or a wheel past the peak of its tyre) do not affect those before it.

A wheel is in balance at the slip lambda that solves

    (J_w d omega/dt + T_b + M)/R  =  F_z F(lambda),   omega = v (1 - lambda)/R       (1) (21)

T_b is the brake torque, M all other torque that slows the wheel [N m], F the normalised force of
the tyre [1]. d omega/dt is the difference to the sample before (backward Euler), so a step in
pressure causes no numerical oscillation at any sampling rate. One Newton step for all samples is a
bidiagonal system. The left side falls with slip and the right side rises, so there is always a
solution.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.base.names import AXLES, G
from calib.base.units import BAR
from calib.car import forces
from calib.car.brakes import Brakes
from calib.car.effects.combined import total_axle_moment, total_body_force, total_load_shift
from calib.car.effects.effect import Pair
from calib.car.history import Motion, RunHistory
from calib.car.lag import integral
from calib.car.tyre import MagicFormula

TOLERANCE = 1e-9  # largest change of the slip, and of v over v0, in the last iteration [1]
_ITERATIONS = 60  # each gains one to two digits; 30 s of coasting need about twelve
_LEAST_LOAD = 0.01  # share of the weight below which an axle counts as lifted [1]
_EDGE = 0.999
"""Fraction, as `MagicFormula.slip_at` takes it, at which the rising branch is cut. The force there
is within 2e-6 of the peak, and the slope is still positive, so the equations can be solved."""


def rising_branch(
    tyre: MagicFormula, slip: Array, relative_load: Array
) -> tuple[Array, Array, Array]:
    """Normalised force [1], its slope by slip [1], and the slip over that of the cut `_EDGE` [1].

    ``relative_load`` is the axle load over half the weight [1], 4 F_z/W with the load F_z of one
    wheel; shapes (n,). Beyond the cut, where the third result is above 1, the force goes on
    linearly: that helps the solver to converge, and is not physical.
    """
    edge = tyre.slip_at(_EDGE, relative_load)
    clipped = np.clip(slip, -edge, edge)
    beyond = (slip - clipped) * tyre.slope(edge, relative_load)
    force = tyre.force(clipped, relative_load) + beyond
    return force, tyre.slope(clipped, relative_load), np.abs(slip) / edge


@dataclass(frozen=True)
class Drive:
    """Inputs of a run, which do not change between iterations."""

    brakes: Brakes  # with the model of the car
    inputs: RunHistory  # clock, pressure and temperatures
    v0: float  # first speed [m/s]
    stop_speed: float  # speed at which the run ends [m/s]
    drive_torque: Pair  # of engine or motor on front and rear axle [N m] (n,)
    wheel_angle: Mapping[str, Array] = field(default_factory=dict)  # by axle [rad] (n,)

    @property
    def time(self) -> Array:
        """The fine clock [s] (n,)."""
        return self.inputs.time

    def total(self, force: Mapping[str, Array]) -> Array:
        """Sum of the ``force`` of four wheels [N] (n,); a left one alone stands for both sides."""
        # each axle is summed first, so that two equal wheels give the same sum to the last bit
        left_f, left_r = force["fl"], force["rl"]
        return (left_f + force.get("fr", left_f)) + (left_r + force.get("rr", left_r))

    def speed(self, z: Array) -> Array:
        """Speed v [m/s] (n,): v0 minus the integral of g z, by the trapezoidal rule."""
        return self.v0 - integral(self.time, G * z)

    def bounded(self, v: Array) -> Array:
        """Speed v [m/s] (n,) with a positive lower bound, for the samples after the stop."""
        return np.maximum(v, 0.5 * self.stop_speed)


@dataclass(frozen=True)
class SolverState:
    """The result of one iteration, all (n,). Dictionaries are by wheel."""

    v: Array  # [m/s]
    z: Array  # [1]
    loads: Pair  # of the axles [N]
    slip: dict[str, Array]  # [1]
    torque: dict[str, Array]  # of the brake [N m]
    load: dict[str, Array]  # [N]
    force: dict[str, Array]  # of the tyre [N]
    used: dict[str, Array]  # slip over that of the cut `_EDGE` [1]; not physical above 1


def solve(run: Drive) -> SolverState:
    """Iterate until neither v nor slip changes before the end of the run.

    Raises ModelError if the iteration does not converge, or if fewer than two samples remain.
    """
    state = _initial_state(run)
    for _ in range(_ITERATIONS):
        last, state = state, _iterate(run, state)
        end, why = end_of(run, state)
        if end < 2:
            raise ModelError("nothing to simulate", expected="two samples or more", do=why)
        v_change = (state.v - last.v)[:end] / run.v0
        slip_changes = [(state.slip[w] - last.slip[w])[:end] for w in state.slip]
        if np.max(np.abs([v_change, *slip_changes])) < TOLERANCE:
            return state
    flaw = f"the simulation did not converge in {_ITERATIONS} iterations"
    do = "check the parameters of the effects and the clock of the log"
    raise ModelError(flaw, where=run.brakes.model.vehicle.name, do=do)


def history_of(run: Drive, state: SolverState) -> RunHistory:
    """The run as input of the effects, with wheel angles and dissipated heat."""
    if not run.brakes.model.effects:
        return run.inputs
    v = run.bounded(state.v)
    angle, energy = {}, {}
    for a in AXLES:
        axle, wheels = run.brakes.axle(a), [w for w in state.slip if w[0] == a]
        omega = np.mean([forces.wheel_speed(axle, state.slip[w], v) for w in wheels], axis=0)
        torque = np.mean([state.torque[w] for w in wheels], axis=0)
        angle[a] = run.wheel_angle[a] if a in run.wheel_angle else integral(run.time, omega)
        energy[a] = integral(run.time, np.abs(torque * omega))  # a brake only dissipates
    return replace(
        run.inputs,
        v=v,
        z=state.z,
        angle_f=angle["f"],
        angle_r=angle["r"],
        energy_f=energy["f"],
        energy_r=energy["r"],
    )


def end_of(run: Drive, state: SolverState) -> tuple[int, str]:
    """Number of valid samples, and why the run ends there."""
    weight = run.brakes.model.vehicle.weight
    is_beyond = {  # (n,) by limit
        f"slower than {run.stop_speed:g} m/s": state.v < run.stop_speed,
        "the front axle would lift": state.loads[0] < _LEAST_LOAD * weight,
        "the rear axle would lift": state.loads[1] < _LEAST_LOAD * weight,
    }
    for w, used in state.used.items():
        is_beyond[f"wheel {w} would pass the peak of its tyre"] = used > 1.0
    first = {limit: int(np.argmax(mask)) for limit, mask in is_beyond.items() if np.any(mask)}
    if not first:
        return run.time.size, f"ends at {run.time[-1]:.3f} s, where its pressure ends"
    end = min(first.values())
    reasons = ", ".join(limit for limit, index in first.items() if index == end)
    pressure = max(p[end] for p in run.brakes.clamp.values()) / BAR
    return end, f"ends before {run.time[end]:.3f} s at {pressure:.1f} bar: {reasons}"


def _initial_state(run: Drive) -> SolverState:
    """State at the start of the iteration: brakes only, no inertia, linear tyres."""
    vehicle = run.brakes.model.vehicle
    torque = run.brakes.torques(run.inputs)
    force = {w: T_b / run.brakes.axle(w).rolling_radius for w, T_b in torque.items()}
    z = run.total(force) / vehicle.weight
    slip = dict.fromkeys(force, np.clip(z / run.brakes.model.tyre.stiffness, -0.02, 0.02))
    loads = forces.axle_loads(vehicle, z)
    return SolverState(run.speed(z), z, loads, slip, torque, load={}, force=force, used={})


def _iterate(run: Drive, old: SolverState) -> SolverState:
    """Compute loads (6), (7), effects, one Newton step of (1) for each wheel, z by (5), and v."""
    model, vehicle = run.brakes.model, run.brakes.model.vehicle
    history, v = history_of(run, old), run.bounded(old.v)
    loads = [np.maximum(load, _LEAST_LOAD * vehicle.weight) for load in _loads(run, old.z, history)]
    motion = Motion(v, loads[0], loads[1], history)
    other_moments = total_axle_moment(vehicle, model.effects, motion)
    moments = np.subtract(other_moments, run.drive_torque)  # of the axles (2, n)
    torque = run.brakes.torques(history)
    slip, load, force, used = {}, {}, {}, {}
    for w, T_b in torque.items():
        i = AXLES.index(w[0])
        load[w] = 0.5 * loads[i]
        slip[w] = _next_slip(run, w, T_b + 0.5 * moments[i], load[w], old)
        grip, _, used[w] = rising_branch(model.tyre, slip[w], 4.0 * load[w] / vehicle.weight)
        force[w] = load[w] * grip
    body = total_body_force(vehicle, model.effects, motion)
    z = (run.total(force) + body) / vehicle.weight  # (5)
    return SolverState(run.speed(z), z, _loads(run, z, history), slip, torque, load, force, used)


def _next_slip(run: Drive, w: str, moment: Array, load: Array, old: SolverState) -> Array:
    """Slip [1] (n,) of the wheel ``w`` after one Newton step of (1) from the ``old`` state.

    ``moment`` is T_b + M of (1) [N m], ``load`` is F_z [N], (n,) each.
    """
    from scipy.linalg.lapack import dtbtrs

    model, axle = run.brakes.model, run.brakes.axle(w)
    slip, v, step = old.slip[w], run.bounded(old.v), np.diff(run.time)
    omega = forces.wheel_speed(axle, slip, v)
    first = -G * old.z[0] * omega[0] / v[0]  # the first sample has a constant slip
    spin = np.concatenate([[first], np.diff(omega) / step])  # d omega/dt [rad/s^2]
    grip, slope, _ = rising_branch(model.tyre, slip, 4.0 * load / model.vehicle.weight)
    residual = forces.tyre_force(axle, moment, spin) - load * grip  # (1)
    # -d residual/d lambda: omega = v (1 - lambda)/R enters its own sample and the next one
    inertia = axle.wheel_mass * v
    bands = np.zeros((2, slip.size))  # the diagonal, and the band below it
    bands[0] = load * slope
    bands[0, 1:] += inertia[1:] / step
    bands[1, :-1] = -inertia[:-1] / step
    change, _ = dtbtrs(bands, residual[:, None], uplo="L")
    return np.asarray(slip + change[:, 0])


def _loads(run: Drive, z: Array, history: RunHistory) -> Pair:
    """Axle loads [N] at z [1], (6) and (7), less the transfer that is delayed by an effect."""
    vehicle = run.brakes.model.vehicle
    front, rear = forces.axle_loads(vehicle, z)
    shift = vehicle.weight * total_load_shift(vehicle, run.brakes.model.effects, history)
    return front - shift, rear + shift
