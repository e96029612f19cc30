r"""The estimator on one log: causal, at the log's own rate, what an ECU would give.

    log -> signals -> level (sum of forces) ----------------------> pad friction, torque, interval
                  \-> zero of eta -> look-up -> adaptive law, RLS  /        (the rivals)
                   \-> blocks -> split (Kalman) ------------------/

The Kalman estimate is the product. Its rivals stand beside it: the paper's law and recursive least
squares on any look-up, nominal pads, and one mean gain from deceleration alone.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calib import adaptive, kalman
from calib.course import BITE
from calib.effects.catalogue import total_axle_moment, total_body_force
from calib.effects.effect import Motion, Parameters
from calib.errors import LogError
from calib.evidence import weigh
from calib.forces import axle_loads, braking_sum
from calib.identify import brake_forces, measured_slip
from calib.kalman import Demand, Priors, Split
from calib.level import Level, follow
from calib.logs.log import Log
from calib.lookup import LOOKUPS
from calib.names import G
from calib.resistance import Resistance
from calib.signals import Blocks, Noise, Signals, blocks, sensor_noise, signals
from calib.table import Table
from calib.vehicle import Axle, Vehicle

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LOW_PASS = 0.1
"""Time constant of the causal filter on z and eta in front of a look-up [s]."""

RLS_MEMORY = 1.0
"""Forgetting of the recursive least squares [s]."""


@dataclass(frozen=True)
class Gates:
    """When the estimator stands behind a sample. Each limit with its reason.

    ``pressure`` [Pa] below which a pad level means little; ``speed`` [m/s] below which slip is
    noise; ``settle`` [s] of braking before the level is trusted; ``interval_f``, ``interval_r``
    relative half width of the 95 % interval beyond which a figure is no use; ``steering`` [rad] at
    the driver's wheel: 5 degrees there are as large as the signal; ``lock`` relative departure of a
    wheel from the others that only ABS or a locked wheel shows.
    """

    pressure: float = 2e5
    speed: float = 3.0
    settle: float = 0.3
    interval_f: float = 0.12
    interval_r: float = 0.25
    steering: float = np.deg2rad(5.0)
    lock: float = 0.15


@dataclass(frozen=True)
class AxleEstimate:
    """One axle: pad friction mu with 95 % interval [1], brake torque of one wheel [N m], (n,).

    ``normalised_force`` F_x/F_z [1] over the quasi-static load (6), (7). NaN before the pads bite.
    """

    pad_friction: Array
    lower: Array
    upper: Array
    torque: Array
    normalised_force: Array


@dataclass(frozen=True)
class Estimate:
    """The estimator's answer on one log, at its rate.

    ``eta`` zeroed (22) [1]; ``z`` [1]; ``valid`` the estimator stands behind the sample; ``braked``
    pads bite; ``rivals`` pad friction (front, rear) by method name; ``split`` and ``blocks`` the
    filter's own record; ``eta_zero`` what was zeroed [1].
    """

    time: Array
    z: Array
    eta: Array
    speed: Array
    front: AxleEstimate
    rear: AxleEstimate
    valid: Mask
    braked: Mask
    covered: Mask
    rivals: dict[str, tuple[Array, Array]]
    split: Split
    blocks: Blocks
    level: Level
    eta_zero: float
    pressure_f: Array
    pressure_r: Array
    slip_f: Array | None = None
    slip_r: Array | None = None
    notes: tuple[str, ...] = field(default=())


def estimate(
    table: Table,
    log: Log,
    vehicle: Vehicle | None = None,
    priors: Priors | None = None,
    gates: Gates | None = None,
) -> Estimate:
    """Run the estimator with ``table`` on ``log``.

    ``vehicle`` gives the nominal pads if they are not the table's. Raises LogError when the log has
    no unbraked lead-in to zero eta on.
    """
    car = vehicle or table.vehicle
    s = signals(log, car)
    b = blocks(s)
    _require_lead_in(log, s)
    nominal = car if vehicle else calibrated(table)
    noise = merged_noise(table, sensor_noise(log, b))
    known = known_resistance(table)
    plan = _Plan(table, nominal, known, noise, priors or Priors(), gates or Gates())
    return _run(plan, log, s, b)


@dataclass(frozen=True)
class _Plan:
    """What stays the same over a log."""

    table: Table
    nominal: Vehicle
    known: Resistance
    noise: Noise
    priors: Priors
    gates: Gates

    @property
    def effects(self) -> dict[str, Parameters]:
        return self.known.effects


def calibrated(table: Table) -> Vehicle:
    """The table's vehicle with the pads of its calibration, in the nominal ratio.

    Scaled so that both axles together brake as they did on the ramp; the ratio is the filter's.
    """
    car, cal = table.vehicle, table.calibration
    B_f, B_r = brake_forces(car, np.ones(()), np.ones(()))
    as_fitted = brake_forces(car, np.ones(()), np.ones(()), cal.pad_log_ratio.value)
    scale = cal.pad_scale.value * float(sum(as_fitted) / (B_f + B_r))
    front = replace(car.front, pad_friction=scale * car.front.pad_friction)
    return replace(
        car, front=front, rear=replace(car.rear, pad_friction=scale * car.rear.pad_friction)
    )


def known_resistance(table: Table) -> Resistance:
    """The resistance the table was fitted with; its parameters' errors taken as independent."""
    drag = table.effects["aerodynamic_drag"]["drag_area"]
    roll = table.effects["rolling_resistance"]["coefficient"]
    return Resistance(
        (drag.value, roll.value), ((drag.sigma**2, 0.0), (0.0, roll.sigma**2)), known=True
    )


def merged_noise(table: Table, own: Noise) -> Noise:
    """The larger of the table's noise and this log's: a quiet ramp does not make a quiet sensor."""
    return Noise(**{key: max(value, getattr(own, key)) for key, value in table.noise.items()})


def _require_lead_in(log: Log, s: Signals) -> None:
    if s.time[s.lead_in].size * s.sample_time < 0.4:
        raise LogError(
            "no unbraked part in front of the braking, so eta cannot be zeroed",
            where=log.source,
            expected="at least 0.5 s of straight coasting first",
            do="start the log earlier",
        )


def _run(plan: _Plan, log: Log, s: Signals, b: Blocks) -> Estimate:
    car = plan.nominal
    B_f, B_r = brake_forces(car, s.p_f, s.p_r)
    pressure = np.maximum(s.p_f, s.p_r)
    zero = float(np.mean(s.omega_r[s.lead_in]) / np.mean(s.omega_f[s.lead_in])) - 1.0
    began = _began(s)
    active = began & (pressure > BITE)
    demanded, moments, loads = _demanded(plan, s)
    density = plan.noise.z * car.weight
    level = follow(s.sample_time, demanded, B_f + B_r, active, density)
    answer = _filter(plan, s, b, level)
    at = np.searchsorted(b.end, s.time, side="right") - 1  # the last complete block
    rho, sigma = (_held(v, at) for v in (answer.log_ratio, answer.sigma))
    theta, sigma_level = _level_weighed(plan, s, level, began)
    front, rear = _axles(plan, s, theta, sigma_level, rho, sigma, moments, loads)
    eta = s.omega_r / s.omega_f / (1.0 + zero)
    rivals, covered = _rivals(plan, s, eta, loads, moments, level, active)
    slips = _slips(plan.table.vehicle, s)
    return Estimate(
        time=s.time,
        z=s.z,
        eta=eta,
        speed=s.speed,
        front=front,
        rear=rear,
        valid=_valid(plan, log, s, front, rear, active),
        braked=np.asarray(pressure > plan.gates.pressure),
        covered=covered,
        rivals=rivals,
        split=answer,
        blocks=b,
        level=level,
        eta_zero=zero,
        pressure_f=s.p_f,
        pressure_r=s.p_r,
        slip_f=slips[0] if slips else None,
        slip_r=slips[1] if slips else None,
    )


def _began(s: Signals) -> Mask:
    """From the end of the lead-in on."""
    began = np.ones(s.time.size, bool)
    last = np.flatnonzero(s.lead_in)
    began[: int(last[-1]) + 1] = False
    return began


def _demanded(plan: _Plan, s: Signals) -> tuple[Array, tuple[Array, Array], tuple[Array, Array]]:
    """Brake force of both axles that z demands [N], and what else acts: moments [N] and loads [N].

    The wheels slow with the car: d omega/dt = -g z/R, exact but for the change of slip.
    """
    car = plan.nominal
    loads = axle_loads(car, s.z)
    motion = Motion(v=s.speed, load_f=loads[0], load_r=loads[1])
    extra = total_axle_moment(car, plan.effects, motion)
    moments = tuple(
        m / a.rolling_radius - 2.0 * a.wheel_inertia * G * s.z / a.rolling_radius**2
        for m, a in zip(extra, (car.front, car.rear), strict=True)
    )
    tyres = braking_sum(car, s.z, total_body_force(car, plan.effects, motion))
    return tyres - moments[0] - moments[1], (moments[0], moments[1]), loads


def _filter(plan: _Plan, s: Signals, b: Blocks, level: Level) -> Split:
    """Feed the split filter: block means, and the level as known at the end of each block."""
    car = plan.nominal
    load_f, load_r = axle_loads(car, b.z)
    motion = Motion(v=b.speed, load_f=load_f, load_r=load_r)
    extra = total_axle_moment(car, plan.effects, motion)
    moment_f, moment_r = (
        (m + 2.0 * a.wheel_inertia * spin) / a.rolling_radius
        for m, a, spin in zip(extra, (car.front, car.rear), (b.spin_f, b.spin_r), strict=True)
    )
    B_f, B_r = brake_forces(car, b.p_f, b.p_r)
    ends = np.searchsorted(s.time, b.end)
    now = np.where(np.maximum(b.p_f, b.p_r) > BITE, level.value[ends], np.nan)
    demand = Demand(
        nominal_f=B_f,
        nominal_r=B_r,
        level=now,
        moment_f=moment_f,
        moment_r=moment_r,
        load_f=load_f,
        load_r=load_r,
        tyre_sum=braking_sum(car, b.z, total_body_force(car, plan.effects, motion)),
        slip=measured_slip(car, load_f, b),
        psi=kalman.pitch_deficit(car, s.z, s.sample_time, plan.priors)[ends],
    )
    posterior = plan.table.posterior
    return kalman.split(
        car,
        b,
        demand,
        plan.noise,
        np.asarray(posterior.mean),
        np.asarray(posterior.covariance),
        plan.priors,
    )


def _held(values: Array, at: NDArray[np.int64]) -> Array:
    """Each block's value from the sample on at which the block is complete."""
    return np.where(at >= 0, values[np.maximum(at, 0)], values[0])


LEVEL_FREE = 0.4
"""Spread of a pad level that is not nominal, relative: wet pads lose half."""

LEVEL_ALIKE = 0.005
"""How exactly unchanged pads keep their level, relative."""

LEVEL_ODDS = 1.0
"""Odds that the pads have the level of the calibration."""


def _level_weighed(plan: _Plan, s: Signals, level: Level, began: Mask) -> tuple[Array, Array]:
    """Level and its relative sigma with mass and resistance counted, weighed against nominal.

    On a dry road the level is nominal within its error and stays there: compensation does no harm.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        resist = plan.known.sigma_z(plan.nominal, s.speed) / np.maximum(_low_pass(s, s.z), 0.02)
        noise = level.sigma / level.value
        sigma = np.sqrt(noise**2 + resist**2 + plan.nominal.mass_tolerance**2)
        free = np.log(np.where(level.value > 0.0, level.value, np.nan))
    found = weigh(free, sigma, LEVEL_FREE, LEVEL_ODDS, LEVEL_ALIKE)
    return np.exp(found.mean), found.sigma


def _low_pass(s: Signals, x: Array, time: float = LOW_PASS) -> Array:
    """First-order causal low-pass, started at the first value."""
    from scipy.signal import lfilter

    a = 1.0 - float(np.exp(-s.sample_time / time))
    return np.asarray(lfilter([a], [1.0, a - 1.0], x, zi=[(1.0 - a) * x[0]])[0])


def _axles(
    plan: _Plan,
    s: Signals,
    theta: Array,
    sigma_level: Array,
    rho: Array,
    sigma: Array,
    moments: tuple[Array, Array],
    loads: tuple[Array, Array],
) -> tuple[AxleEstimate, AxleEstimate]:
    """Level and ratio to pad friction, torque and normalised force of each axle."""
    car = plan.nominal
    B_f, B_r = brake_forces(car, np.maximum(s.p_f, 1.0), np.maximum(s.p_r, 1.0))
    phi_0 = B_f / (B_f + B_r)
    half = np.exp(0.5 * rho)
    phi = B_f * half / (B_f * half + B_r / half)
    out = []
    for axle, p, share, share_0, lever, moment, load in (
        (car.front, s.p_f, phi, phi_0, 1.0 - phi, moments[0], loads[0]),
        (car.rear, s.p_r, 1.0 - phi, 1.0 - phi_0, phi, moments[1], loads[1]),
    ):
        mu = axle.pad_friction * theta * share / share_0
        # d ln(share)/d rho is the other axle's share; a factor of e^5 either way is no answer
        spread = np.minimum(1.96 * np.sqrt(sigma_level**2 + (lever * sigma) ** 2), 5.0)
        torque = mu * axle.torque_gain * np.maximum(p, 0.0)
        brake = 2.0 * torque / axle.rolling_radius
        F = (np.nan_to_num(brake) + moment) / _low_pass(s, load)
        out.append(AxleEstimate(mu, mu * np.exp(-spread), mu * np.exp(spread), torque, F))
    return out[0], out[1]


def _slips(vehicle: Vehicle, s: Signals) -> tuple[Array, Array] | None:
    """Slips (19), (20) of the axles [1] with the rolling radii of the lead-in; None without v."""
    if s.v is None:
        return None
    out = []
    for omega in (s.omega_f, s.omega_r):
        radius = np.mean(s.v[s.lead_in]) / np.mean(omega[s.lead_in])
        out.append(1.0 - radius * omega / np.maximum(s.v, 0.5))
    return out[0], out[1]


def _rivals(
    plan: _Plan,
    s: Signals,
    eta: Array,
    loads: tuple[Array, Array],
    moments: tuple[Array, Array],
    level: Level,
    active: Mask,
) -> tuple[dict[str, tuple[Array, Array]], Mask]:
    """Pad friction by the other methods, and where eta is inside the table."""
    car = plan.nominal
    out: dict[str, tuple[Array, Array]] = {
        "nominal": (
            np.full_like(eta, car.front.pad_friction),
            np.full_like(eta, car.rear.pad_friction),
        ),
        "mean_gain": (car.front.pad_friction * level.value, car.rear.pad_friction * level.value),
    }
    z, smooth = _low_pass(s, s.z), _low_pass(s, eta)
    motion = Motion(v=s.speed, load_f=loads[0], load_r=loads[1])
    carried = braking_sum(car, z, total_body_force(car, plan.effects, motion)) / car.weight
    load_f, load_r = (_low_pass(s, load) for load in loads)
    covered = np.ones(eta.size, bool)
    for name, read in LOOKUPS.items():
        reading = read(plan.table, z, smooth, carried)
        covered = reading.inside
        for law in ("gradient", "rls"):
            out[f"{law}_{name}"] = (
                _adapt(s, car.front, reading.F_f, load_f, moments[0], s.p_f, active, law),
                _adapt(s, car.rear, reading.F_r, load_r, moments[1], s.p_r, active, law),
            )
    return out, covered


def _adapt(
    s: Signals,
    axle: Axle,
    force: Array,
    load: Array,
    moment: Array,
    pressure: Array,
    active: Mask,
    law: str,
) -> Array:
    """One adaptive law on one axle, per wheel; returns mu_n + zeta [1]."""
    # wheel inertia is already in the moment at the road
    y = adaptive.measured_output(
        axle, force, 0.5 * load, np.zeros_like(load), pressure, 0.5 * moment * axle.rolling_radius
    )
    u = np.where(active, adaptive.regressor(axle, pressure), 0.0)
    if law == "gradient":
        zeta = adaptive.gradient(y, u, adaptive.gain(axle), s.sample_time)
    else:
        zeta = adaptive.least_squares(y, u, RLS_MEMORY, s.sample_time)
    return axle.pad_friction + zeta


def _valid(
    plan: _Plan, log: Log, s: Signals, front: AxleEstimate, rear: AxleEstimate, active: Mask
) -> Mask:
    g = plan.gates
    ok = active & (np.maximum(s.p_f, s.p_r) > g.pressure) & (s.speed > g.speed)
    # braked for a while without a break
    last_free = np.maximum.accumulate(np.where(active, -np.inf, s.time))
    ok &= s.time - last_free > g.settle
    with np.errstate(invalid="ignore"):
        ok &= (front.upper - front.lower) < 2.0 * g.interval_f * front.pad_friction
        ok &= (rear.upper - rear.lower) < 2.0 * g.interval_r * rear.pad_friction
    if "steering" in log:
        ok &= np.abs(log["steering"]) < g.steering
    wheels = np.stack([log[f"omega_{w}"] for w in ("fl", "fr", "rl", "rr")])
    spread = wheels.max(axis=0) - wheels.min(axis=0)
    ok &= spread < g.lock * np.maximum(wheels.max(axis=0), 1.0)
    return np.asarray(ok & np.isfinite(front.pad_friction))
