"""Sort the runs of a fit, and prepare each ramp: its blocks, and the forces of its axles.

    runs --sort_runs--> ramps, coasts, stops        a ramp or stop --prepare--> RampRun

The brake pressure gives the forces of both axles up to two unknowns: a common scale of the pads,
and the ratio of front to rear pads. The scale follows from the sum of forces, see `pad_scale`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.errors import LogError
from calib.base.warning import REFUSE, unexplained
from calib.car.balance import brake_forces
from calib.car.braking import BITE
from calib.car.effects.effects import Effects
from calib.car.forces import mean_slip
from calib.car.vehicle import Vehicle
from calib.plausibility.rules import COAST, FIT, VALIDATE, require_none, unusable
from calib.run.accelerometer import Accelerometer
from calib.run.blocks import Axle, Blocks, block_balance
from calib.run.filters import time_since
from calib.run.noise import SensorNoise, sigma_growth
from calib.run.run import Run
from calib.run.same_run import refuse_copies


@dataclass(frozen=True)
class _FitSettings:
    """Constants of a fit."""

    min_speed: float = 5.0
    """Below this v [m/s] the clock offset and the noise of v swallow the slip."""
    outlier: float = 4.0
    """Residuals past this many sigma are outliers: 500 blocks of noise have one in 30 runs."""
    fastest: float = 0.5
    """Blocks take no part while the pressure changes the deceleration faster than this [g/s]: lags
    then move eta as much as braking does. A ramp to 0.6 g in 3 s has 0.2 g/s, a release 1 to 3."""
    late: float = 0.15
    """Time after a change faster than ``fastest`` for which blocks take no part either [s]."""
    disturbance_of_eta: float = 0.12
    """A block is disturbed if eta departs from its smooth course by more than this share of the
    range of eta: a gear shift of 240 N m moves eta by a third of the range, a bump by all of it."""
    disturbance_of_force: float = 0.03
    """The same of the demanded brake force, as a share of its largest value."""
    disturbance_gate: float = 6.0
    """A departure of eta or force below this many of its standard deviations is no disturbance."""
    fewest_blocks: int = 20
    """Disturbances are looked for from this number of braked blocks on. A fifth of this number must
    be calm before a disturbance, after it, and at a larger brake force."""
    disturbance_share: float = 0.3
    """If a larger share of the braked blocks is disturbed, the cause is the car: all take part."""
    flat: float = 0.1
    """z is not read from the curve eta(z) where its slope is below this share of the first slope:
    there an error of eta counts ten times."""
    rows: int = 61
    """Rows of a look-up: linear interpolation between them errs by less than 1e-4 in D."""
    min_count: int = 3
    """Blocks that a cell needs to count as measured: two may be one disturbance."""


SETTINGS = _FitSettings()

_ZERO_TIME = 3.0  # time before the bite over which eta and slip are zeroed [s]


@dataclass(frozen=True)
class RampRun:
    """One ramp or stop, ready to fit: signals and forces of its k blocks. SI, shapes (k,)."""

    name: str  # of the log
    blocks: Blocks  # means of the signals
    noise: SensorNoise
    load_f: Array  # front axle load [N]
    drag_f: Array  # forces at the front wheels besides the brake, as in `ForceBalance` [N]
    drag_r: Array  # the same of the rear wheels [N]
    brake_sum: Array  # brake force of both axles that the deceleration demands [N]
    slip: Array | None  # measured mean slip [1], None without v
    use: Mask  # blocks that take part in a fit
    accelerometer: Accelerometer | None = None  # correction of z, None where z is exact
    only: Axle | None = None  # the axle that brakes alone, None where both axles brake
    left_out: Mask | None = None  # disturbed blocks, None before `calib.fitting.disturbances`

    @cached_property
    def braked(self) -> Mask:
        """Blocks that take part and in which a brake bites (k,)."""
        return self.use & (np.maximum(self.blocks.p_f, self.blocks.p_r) > BITE)

    def log_odds(self, p_f: Array, p_r: Array) -> Array:
        """ln of front over rear pressure [1], infinite where one axle brakes alone."""
        if self.only is not None:
            return np.full_like(p_f, np.inf if self.only == "f" else -np.inf)
        return np.asarray(np.log(np.maximum(p_f, 1.0) / np.maximum(p_r, 1.0)))

    def quasi_static(self, vehicle: Vehicle) -> Array:
        """Deceleration [1] (k,) at which a car without effects has these axle loads, by (6)."""
        lever = self.load_f * vehicle.wheelbase / vehicle.weight  # l_r + h z [m]
        return np.asarray((lever - vehicle.cg_to_rear_axle) / vehicle.cg_height)

    @cached_property
    def rolling(self) -> Index:
        """Indices of the last usable blocks of the lead-in: eta and slip are zeroed there."""
        lead = np.flatnonzero(self.blocks.lead_in & self.use)
        return lead[-round(_ZERO_TIME / self.blocks.length) :]

    @cached_property
    def brake_rise(self) -> Array:
        """Brake force of both axles [N] (k,): ``brake_sum`` less its mean on the lead-in.

        No brake acts there: the mean is the offset of a_x, the slope and other resistances.
        """
        zero = np.mean(self.brake_sum[self.rolling]) if self.rolling.size else 0.0
        return np.asarray(self.brake_sum - zero)


def sort_runs(runs: Sequence[Run]) -> tuple[list[Run], list[Run], list[Run]]:
    """Return ramps, coasts and stops among the ``runs``, each sorted by the digests of the logs.

    A log without braking is a coast. A log that brakes too fast for a ramp, by the rule
    `ramp_rise`, is a stop, if another log brakes as slowly as a ramp. Raises LogError for a log
    that cannot be used, that is not of this vehicle, or that is given twice.
    """
    refuse_copies([run.log for run in runs])
    # the order of the command line must not change a bit of the table
    ordered = sorted(runs, key=lambda run: run.log.digest)
    coasts = [run for run in ordered if not run.events]
    braked = [run for run in ordered if run.events]
    purposes = {run: FIT if run.events else COAST for run in ordered}
    reasons = {run: unusable(run, purposes[run], (REFUSE,)) for run in ordered}
    fast = [run for run in braked if any(reason.code == "ramp_rise" for reason in reasons[run])]
    stops = fast if len(fast) < len(braked) else []  # a fit needs one ramp
    purposes |= dict.fromkeys(stops, VALIDATE)  # judged again, as hold-outs
    reasons |= {run: unusable(run, VALIDATE) for run in stops}
    ramps = [run for run in braked if run not in stops]
    all_reasons = [reason for run in ordered for reason in reasons[run]]
    if all_reasons:
        # a mistake that all logs share is reported once, for the log that shows its cause
        cause = unexplained(all_reasons)[0]
        flawed = next(run for run in ordered if any(reason is cause for reason in reasons[run]))
        require_none(reasons[flawed], flawed, purposes[flawed])
    if not ramps:
        where = ", ".join(run.log.source for run in runs)
        expected = "at least one ramp: 1 s unbraked, then pressure rising over 3 to 8 s"
        raise LogError("none of the logs holds a braking", where=where, expected=expected)
    if all(run.alone for run in ramps):
        flaw = "on every ramp one axle brakes alone, so there is no curve over eta"
        where = ", ".join(run.log.source for run in ramps)
        expected = "at least one ramp with both axles; ramps with one axle serve in addition"
        raise LogError(flaw, where=where, expected=expected)
    return ramps, coasts, stops


def prepare(run: Run, effects: Effects, accelerometer: Accelerometer | None = None) -> RampRun:
    """Return the blocks of a ramp with their loads, resistances and demanded brake forces.

    ``effects`` are the known effects of body and wheels; the ``accelerometer`` corrects z.
    These blocks take no part in a fit:
    * blocks in which an axle would lift, by a glitch of a_x: their loads are NaN;
    * blocks between the lead-in and the bite, and after a release: the pads may touch;
    * blocks of the lead-in that are too old for the zeros of eta and slip (`calib.run.noise`);
    * blocks in which, or just before which, the pressure changes fast.
    """
    vehicle, b, noise = run.car, run.felt(accelerometer), run.noise
    forces = block_balance(vehicle, effects, b)
    is_on_road = np.minimum(forces.load_f, forces.load_r) > 0.0
    # the last blocks of a stop hold the jerk at standstill
    use = (b.speed > SETTINGS.min_speed) & (b.end < b.end[-1] - 0.1) & is_on_road
    use &= b.lead_in | (np.maximum(b.p_f, b.p_r) > BITE)
    load_f = np.where(is_on_road, forces.load_f, np.nan)
    ramp = RampRun(
        name=run.log.name,
        blocks=b,
        noise=noise,
        load_f=load_f,
        drag_f=forces.drag_f,
        drag_r=forces.drag_r,
        brake_sum=forces.demanded,
        slip=None if b.v is None else mean_slip(vehicle, load_f, b.omega_f, b.omega_r, b.v),
        use=np.asarray(use),
        accelerometer=accelerometer,
        only=run.alone,
    )
    # noise densities of eta and slip [s^0.5], without a division by zero at rest
    omega = np.maximum(b.omega_f, 1.0)
    eta_density = np.asarray(np.sqrt(2.0) * noise.omega / omega)
    is_recent = np.isfinite(sigma_growth(b.end, b.lead_in, eta_density))
    if ramp.slip is not None:
        speed = np.maximum(b.speed, SETTINGS.min_speed)
        slip_density = np.asarray(np.hypot(noise.v / speed, noise.omega / omega))
        is_recent |= np.isfinite(sigma_growth(b.end, b.lead_in, slip_density))
    B_f, B_r = nominal_forces(vehicle, ramp, 0.0)
    rate = np.abs(np.gradient((B_f + B_r) / vehicle.weight, b.end))  # [g/s]
    is_steady = time_since(b.end, rate > SETTINGS.fastest) > SETTINGS.late
    return replace(ramp, use=ramp.use & is_recent & (b.lead_in | is_steady))


def pad_scale(run: RampRun, B_f: Array, B_r: Array) -> float:
    """Factor [1] on brake forces [N] (k,) that fits their sum to the demand, by least squares."""
    total = (B_f + B_r)[run.braked]
    return float(total @ run.brake_rise[run.braked] / (total @ total))


def nominal_forces(vehicle: Vehicle, run: RampRun, log_ratio: Array | float) -> tuple[Array, Array]:
    """Brake forces [N] of front and rear axle, (k,) each, with nominal pads.

    ``log_ratio`` is ln of the ratio of front to rear pads over that of the file [1]. The force is
    0 without pressure, and where the other axle brakes alone.
    """
    b = run.blocks
    is_pressed = np.maximum(b.p_f, b.p_r) > 0.5 * BITE
    p_f = 0.0 * b.p_f if run.only == "r" else b.p_f * is_pressed
    p_r = 0.0 * b.p_r if run.only == "f" else b.p_r * is_pressed
    return brake_forces(vehicle, p_f, p_r, log_ratio)
