r"""The estimator on one log: causal, at the log's own rate, what an ECU would give.

    log -> signals -> balance -> level (sum of forces) --\
                  \-> blocks -> split (Kalman) ----------+--> pad friction, torque, interval
                   \-> zero of eta -> look-ups -> laws        (the baselines, shown beside it)

The Kalman estimate is the product. Its baselines stand beside it: the paper's law and recursive
least squares on any look-up, nominal pads, and one mean gain from deceleration alone.
"""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.errors import LogError
from calib.estimation import split_filter
from calib.estimation.balance import BrakeBalance, brake_balance, smoothed
from calib.estimation.baselines import baselines
from calib.estimation.pad_level import PadLevel, estimate_pad_level
from calib.estimation.split_filter import PadRatio, Priors, SplitInput
from calib.fitting.known_effects import remove_known_effects
from calib.fitting.resistance import DRAG, ROLLING, Resistance
from calib.logs.log import Log
from calib.names import WHEELS
from calib.physics.balance import brake_forces, force_balance
from calib.physics.braking import BITE
from calib.physics.effects.combined import as_driven
from calib.physics.effects.effects import Effects
from calib.physics.forces import mean_slip
from calib.physics.vehicle import Vehicle
from calib.signals.axle_signals import Signals, eta_of, signals
from calib.signals.blocks import Blocks, blocks
from calib.signals.noise import SensorNoise, lead_in_noise
from calib.statistics.mixture_posterior import mixture_posterior
from calib.table.table import Table

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Gates:
    """When the estimator stands behind a sample. Each limit with its reason.

    ``pressure`` [Pa] below which a pad level means little; ``speed`` [m/s] below which slip is
    noise; ``settle`` [s] of braking before the level is trusted; ``interval_f``, ``interval_r``
    relative half width of the 95 % interval beyond which a figure is no use; ``steering`` [rad] at
    the driver's wheel: 5 degrees there are as large as the signal; ``lock`` relative departure of a
    wheel from the others that only ABS or a locked wheel shows, ``recover`` [s] after it.
    """

    pressure: float = 2e5
    speed: float = 3.0
    settle: float = 0.3
    interval_f: float = 0.12
    interval_r: float = 0.25
    steering: float = np.deg2rad(5.0)
    lock: float = 0.15
    recover: float = 1.0


@dataclass(frozen=True)
class AxleEstimate:
    """One axle: pad friction mu with 95 % interval [1], brake torque of one wheel [N m], (n,).

    ``normalised_force`` F_x/F_z [1] over the quasi-static load (6), (7). Nominal, with a wide
    interval, before the pads first bite.
    """

    pad_friction: Array
    lower: Array
    upper: Array
    torque: Array
    normalised_force: Array


COLUMNS = {
    "time": "s",
    "z": "1",
    "eta": "1",
    "normalised_force_f": "1",
    "normalised_force_r": "1",
    "pad_friction_f": "1",
    "pad_friction_r": "1",
    "pad_friction_f_lower": "1",
    "pad_friction_f_upper": "1",
    "pad_friction_r_lower": "1",
    "pad_friction_r_upper": "1",
    "brake_torque_fl": "N*m",
    "brake_torque_fr": "N*m",
    "brake_torque_rl": "N*m",
    "brake_torque_rr": "N*m",
    "valid": "1",
}
"""Columns of an estimate as a table and as a file, in their order, with their units."""


@dataclass(frozen=True)
class Estimate:
    """The estimator's answer on one log, at its rate.

    ``eta`` zeroed (22) [1]; ``z`` [1]; ``valid`` the estimator stands behind the sample; ``braked``
    pads bite; ``baselines`` pad friction (front, rear) by method name; ``split`` and ``blocks`` the
    filter's own record; ``eta_zero`` what was zeroed [1]; ``factor_f``, ``factor_r`` what known
    effects did to the pad friction, which is given without them [1].
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
    baselines: dict[str, tuple[Array, Array]]
    split: PadRatio
    blocks: Blocks
    level: PadLevel
    eta_zero: float
    pressure_f: Array
    pressure_r: Array
    slip_f: Array | None = None
    slip_r: Array | None = None
    factor_f: Array | float = 1.0
    factor_r: Array | float = 1.0
    notes: tuple[str, ...] = field(default=())

    def __repr__(self) -> str:
        count = f"Estimate: {self.time.size} samples, {np.count_nonzero(self.valid)} valid"
        if not self.valid.any():
            return count
        last = int(np.flatnonzero(self.valid)[-1])
        pads = [
            f"{name} {axle.pad_friction[last]:.3f} "
            f"(95 % {axle.lower[last]:.3f} to {axle.upper[last]:.3f})"
            for name, axle in (("front", self.front), ("rear", self.rear))
        ]
        return f"{count}; pad friction at {self.time[last]:.2f} s: {', '.join(pads)}"

    def columns(self) -> dict[str, Array | Mask]:
        """The samples by the names of `COLUMNS`, (n,) each.

        Pad friction and its bounds are per axle, torque is per wheel: both wheels of an axle have
        the same.
        """
        f, r = self.front, self.rear
        values = (
            self.time,
            self.z,
            self.eta,
            f.normalised_force,
            r.normalised_force,
            f.pad_friction,
            r.pad_friction,
            f.lower,
            f.upper,
            r.lower,
            r.upper,
            f.torque,
            f.torque,
            r.torque,
            r.torque,
            self.valid,
        )
        return dict(zip(COLUMNS, values, strict=True))

    def to_frame(self) -> "pd.DataFrame":
        """`columns` as a frame, one row per sample; the units are in its ``attrs["units"]``."""
        import pandas as pd

        frame = pd.DataFrame(self.columns())
        frame.attrs["units"] = dict(COLUMNS)
        return frame


def estimate(
    table: Table,
    log: Log,
    vehicle: Vehicle | None = None,
    priors: Priors | None = None,
    gates: Gates | None = None,
    *,
    with_laws: bool = True,
) -> Estimate:
    """Run the estimator with a table on a log.

    Parameters
    ----------
    table : what the car was calibrated to. Its known effects are taken out of the log first, see
        `calib.fitting.known_effects`.
    log : the run, with an unbraked lead-in.
    vehicle : the nominal pads if they are not the table's, and known effects beside or instead of
        the table's.
    priors, gates : of the split filter, and of ``valid``; by default those that were tried.
    with_laws : without, the baselines are only nominal pads and the mean gain.

    Raises LogError when the log has no unbraked lead-in to zero eta on.

    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> frame = calib.estimate(table, calib.read_log(logs / "stop_noisy.parquet")).to_frame()
    >>> last = frame[frame.valid].iloc[-1]
    >>> bool(last.pad_friction_r_lower < 0.4 < last.pad_friction_r_upper)  # as it was simulated
    True
    >>> frame.attrs["units"]["brake_torque_fl"]
    'N*m'
    """
    ran = remove_known_effects(_with_effects(table, vehicle), log)
    used = replace(table, vehicle=ran.vehicle)
    nominal = None if vehicle is None else _with_pads(ran.vehicle, vehicle)
    s = signals(ran.log, nominal or ran.vehicle)
    _require_lead_in(log, s)
    b = blocks(s)
    plan = plan_for(used, ran.log, s, nominal, priors, gates)
    forces = brake_balance(plan.nominal, plan.known.effects, s)
    level = level_of(plan, s, forces)
    answer = split_of(plan, s, b, level)
    front, rear = _axles(plan, s, forces, level, answer, b)
    zero = float(np.mean(s.omega_r[s.lead_in]) / np.mean(s.omega_f[s.lead_in])) - 1.0
    eta = eta_of(s.omega_f, s.omega_r) / (1.0 + zero)
    others = baselines(used, plan.nominal, s, forces, eta, level, laws=with_laws)
    slips = _slips(s)
    return Estimate(
        time=s.time,
        z=s.z,
        eta=eta,
        speed=s.speed,
        front=front,
        rear=rear,
        valid=_valid(plan, ran.log, s, front, rear, forces.active),
        braked=np.maximum(s.p_f, s.p_r) > plan.gates.pressure,
        covered=others.covered,
        baselines=others.pads,
        split=answer,
        blocks=b,
        level=level,
        eta_zero=zero,
        pressure_f=s.p_f,
        pressure_r=s.p_r,
        slip_f=slips[0] if slips else None,
        slip_r=slips[1] if slips else None,
        factor_f=ran.factor_f,
        factor_r=ran.factor_r,
    )


@dataclass(frozen=True)
class Plan:
    """What stays the same over a log.

    ``nominal`` the car with the pads that the estimate starts from; ``known`` the resistance;
    ``noise`` of the sensors.
    """

    table: Table
    nominal: Vehicle
    known: Resistance
    noise: SensorNoise
    priors: Priors
    gates: Gates


def plan_for(
    table: Table,
    log: Log,
    s: Signals,
    vehicle: Vehicle | None = None,
    priors: Priors | None = None,
    gates: Gates | None = None,
) -> Plan:
    """The plan of a log: nominal pads of ``vehicle``, or those of the calibration."""
    return Plan(
        table=table,
        nominal=vehicle or calibrated(table),
        known=known_resistance(table),
        noise=merged_noise(table, lead_in_noise(log, s)),
        priors=priors or Priors(),
        gates=gates or Gates(),
    )


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


def as_used(table: Table, vehicle: Vehicle | None) -> Vehicle:
    """The car of an estimate as it is driven: mass, radii and inertias with their known errors."""
    car = _with_effects(table, vehicle)
    return _with_pads(as_driven(car, car.effects), vehicle or table.vehicle)


def _with_effects(table: Table, vehicle: Vehicle | None) -> Vehicle:
    own = vehicle.effects if vehicle else Effects()
    return replace(table.vehicle, effects=table.vehicle.effects.with_(own))


def _with_pads(car: Vehicle, pads: Vehicle) -> Vehicle:
    front = replace(car.front, pad_friction=pads.front.pad_friction)
    return replace(car, front=front, rear=replace(car.rear, pad_friction=pads.rear.pad_friction))


def known_resistance(table: Table) -> Resistance:
    """The resistance the table was fitted with; its parameters' errors taken as independent.

    What the vehicle knows of drag or rolling resistance itself goes before it.
    """
    effects = table.effects.with_(table.vehicle.effects)
    drag, rolling = (table.effects.sigma[effect][name] for effect, name in (DRAG, ROLLING))
    return Resistance(effects, ((drag**2, 0.0), (0.0, rolling**2)), known=True)


def merged_noise(table: Table, own: SensorNoise) -> SensorNoise:
    """The larger of the table's noise and this log's: a quiet ramp does not make a quiet sensor."""
    return SensorNoise(**{key: max(value, getattr(own, key)) for key, value in table.noise.items()})


def _require_lead_in(log: Log, s: Signals) -> None:
    if s.time[s.lead_in].size * s.sample_time < 0.4:
        raise LogError(
            "no unbraked part in front of the braking, so eta cannot be zeroed",
            where=log.source,
            expected="at least 0.5 s of straight coasting first",
            do="start the log earlier",
        )


def level_of(plan: Plan, s: Signals, forces: BrakeBalance) -> PadLevel:
    """The common pad level of a run, before anything is said of the split."""
    density = plan.noise.z * plan.nominal.weight
    nominal = forces.nominal_f + forces.nominal_r
    demanded = forces.balance.demanded
    return estimate_pad_level(s.sample_time, demanded, nominal, forces.active, density)


def split_of(plan: Plan, s: Signals, b: Blocks, level: PadLevel) -> PadRatio:
    """Feed the split filter: block means, and the level as known at the end of each block."""
    car = plan.nominal
    spin = (b.spin_f, b.spin_r)
    forces = force_balance(car, plan.known.effects, b.end, b.speed, b.z, b.p_f, spin)
    B_f, B_r = brake_forces(car, b.p_f, b.p_r)
    ends = np.searchsorted(s.time, b.end)
    now = np.where(np.maximum(b.p_f, b.p_r) > BITE, level.value[ends], np.nan)
    demand = SplitInput(
        nominal_f=B_f,
        nominal_r=B_r,
        level=now,
        moment_f=forces.moment_f,
        moment_r=forces.moment_r,
        load_f=forces.load_f,
        load_r=forces.load_r,
        tyre_sum=forces.tyre_sum,
        slip=None if b.v is None else mean_slip(car, forces.load_f, b.omega_f, b.omega_r, b.v),
        psi=split_filter.pitch_deficit(car, s.z, s.sample_time, plan.priors)[ends],
    )
    posterior = plan.table.posterior
    return split_filter.filter_pad_ratio(
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


def _level_weighed(plan: Plan, s: Signals, level: PadLevel) -> tuple[Array, Array]:
    """Level and its relative sigma with mass and resistance counted, weighed against nominal.

    On a dry road the level is nominal within its error and stays there: compensation does no harm.
    Before the pads first bite nothing is known of them: nominal, as uncertain as pads are. Between
    brakings the last level stands, as uncertain again.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        resist = plan.known.sigma_z(plan.nominal, s.speed) / np.maximum(smoothed(s, s.z), 0.02)
        # a level of nought is as good as unknown: ten times everything
        noise = np.minimum(np.abs(level.sigma / level.value), 10.0)
        sigma = np.sqrt(noise**2 + resist**2 + plan.nominal.mass_tolerance**2)
        free = np.log(np.where(level.value > 0.0, level.value, np.nan))
    found = mixture_posterior(free, sigma, LEVEL_FREE, LEVEL_ODDS, LEVEL_ALIKE)
    known = np.isfinite(found.mean)
    last = np.maximum.accumulate(np.where(known, np.arange(known.size), -1))
    held = np.where(last >= 0, found.mean[np.maximum(last, 0)], 0.0)
    return np.exp(held), np.where(known, found.sigma, LEVEL_FREE)


def _axles(
    plan: Plan, s: Signals, forces: BrakeBalance, level: PadLevel, answer: PadRatio, b: Blocks
) -> tuple[AxleEstimate, AxleEstimate]:
    """Level and ratio to pad friction, torque and normalised force of each axle."""
    car = plan.nominal
    at = np.searchsorted(b.end, s.time, side="right") - 1  # the last complete block
    rho, sigma = _held(answer.log_ratio, at), _held(answer.sigma, at)
    theta, sigma_level = _level_weighed(plan, s, level)
    B_f, B_r = brake_forces(car, np.maximum(s.p_f, 1.0), np.maximum(s.p_r, 1.0))
    phi_0 = B_f / (B_f + B_r)
    half = np.exp(0.5 * rho)
    phi = B_f * half / (B_f * half + B_r / half)
    out = []
    road = forces.balance
    for axle, p, share, share_0, lever, moment, load in (
        (car.front, s.p_f, phi, phi_0, 1.0 - phi, road.moment_f, road.load_f),
        (car.rear, s.p_r, 1.0 - phi, 1.0 - phi_0, phi, road.moment_r, road.load_r),
    ):
        mu = axle.pad_friction * theta * share / share_0
        # d ln(share)/d rho is the other axle's share; a factor of e^5 either way is no answer
        spread = np.minimum(1.96 * np.sqrt(sigma_level**2 + (lever * sigma) ** 2), 5.0)
        torque = mu * axle.torque_gain * np.maximum(p, 0.0)
        brake = 2.0 * torque / axle.rolling_radius
        F = (np.nan_to_num(brake) + moment) / smoothed(s, load)
        out.append(AxleEstimate(mu, mu * np.exp(-spread), mu * np.exp(spread), torque, F))
    return out[0], out[1]


def _slips(s: Signals) -> tuple[Array, Array] | None:
    """Slips (19), (20) of the axles [1] with the rolling radii of the lead-in; None without v."""
    if s.v is None:
        return None
    out = []
    for omega in (s.omega_f, s.omega_r):
        radius = np.mean(s.v[s.lead_in]) / np.mean(omega[s.lead_in])
        out.append(1.0 - radius * omega / np.maximum(s.v, 0.5))
    return out[0], out[1]


def _valid(
    plan: Plan, log: Log, s: Signals, front: AxleEstimate, rear: AxleEstimate, active: Mask
) -> Mask:
    """Where the estimator stands behind its answer, see `Gates`."""
    g = plan.gates
    ok = active & (np.maximum(s.p_f, s.p_r) > g.pressure) & (s.speed > g.speed)
    ok &= _since(s.time, ~active) > g.settle
    ok &= _since(s.time, _locked(log, s, g)) > g.recover
    top = plan.table.tyre.force[-1]
    with np.errstate(invalid="ignore"):
        for axle, width in ((front, g.interval_f), (rear, g.interval_r)):
            ok &= axle.upper - axle.lower < 2.0 * width * axle.pad_friction
            ok &= axle.normalised_force < top
    if "steering" in log:
        ok &= np.abs(log["steering"]) < g.steering
    return np.asarray(ok & np.isfinite(front.pad_friction))


def _since(time: Array, event: Mask) -> Array:
    """Time since the event last held [s]; infinite before its first."""
    return time - np.maximum.accumulate(np.where(event, time, -np.inf))


def _locked(log: Log, s: Signals, g: Gates) -> Mask:
    """Where a wheel departs from the fastest one as only ABS or a locked wheel does."""
    wheels = np.stack([log[f"omega_{w}"] for w in WHEELS])
    fastest = wheels.max(axis=0)
    apart = fastest - wheels.min(axis=0) > g.lock * np.maximum(fastest, 1.0)
    return np.asarray(apart & (s.speed > g.speed))
