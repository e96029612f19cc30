"""The ramps among the runs of a fit, ready to fit: blocks, and the forces of the axles.

The pads' pressure gives the forces of both axles up to a common scale and the pads' ratio; the
scale follows from the sum of forces.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
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
    """What a fit takes as given. Those that decide a table's numbers are in its provenance."""

    min_speed: float = 5.0
    """Below this v [m/s] the clock offset and the noise of v swallow the slip."""
    outlier: float = 4.0
    """Residuals past this many sigma are named: of 500 blocks of noise one in 30 runs has one."""
    fastest: float = 0.5
    """A block takes no part while the pressure changes the deceleration faster than this [g/s]: the
    lag of pads, lines and body then moves eta by as much as its signal. A ramp to 0.6 g within 3 s
    has 0.2, a pedal that is let go at its end 1 to 3."""
    late: float = 0.15
    """Time [s] for which blocks are left out after such a change, too."""
    disturbance_of_eta: float = 0.12
    """Departure of eta from its smooth course, divided by its range on the ramp, from which on
    something else acts: a gear shift of 240 N m moves it by a third of the range, a bump by all."""
    disturbance_of_force: float = 0.03
    """Likewise of the demanded brake force, divided by its largest value."""
    disturbance_gate: float = 6.0
    """How many times the usual scatter both must stand out."""
    fewest_blocks: int = 20
    """With fewer braked blocks no disturbance is looked for. As many must be left below the top of
    the ramp without the disturbed ones, and a fifth of this number must be calm on either side."""
    disturbance_share: float = 0.3
    """If more than this share of the braked blocks stands out, it is the car and no disturbance."""
    flat: float = 0.1
    """The curve eta(z) is not read backwards where its slope is below this share of its first one:
    there an error of eta moves D ten times as far as it should."""
    rows: int = 61
    """Rows of a look-up: linear interpolation between them errs by less than 1e-4 in D."""
    min_count: int = 3
    """Blocks that a cell needs to count as measured: two may be one disturbance."""


SETTINGS = _FitSettings()

_ZEROED = 3.0
"""Time before the bite over which eta and slip are zeroed [s]."""


@dataclass(frozen=True)
class RampRun:
    """One ramp, ready to fit: blocks, what they say, and what is known beforehand. SI, shapes (k,).

    ``load_f`` front axle load [N]; ``drag_f``, ``drag_r`` what slows the wheels besides
    the brake, inertia included, as a force at the road [N]; ``brake_sum`` brake force of both axles
    that the deceleration demands [N]; ``slip`` measured mean slip [1], None without v; ``use``
    blocks that take part; ``accelerometer`` the correction of z, with what is left open, None
    where z is exact; ``only`` the axle that brakes alone, None where both do; ``left_out`` blocks
    of the braking in which something else acts, see `calib.fitting.disturbances`.
    """

    name: str
    blocks: Blocks
    noise: SensorNoise
    load_f: Array
    drag_f: Array
    drag_r: Array
    brake_sum: Array
    slip: Array | None
    use: NDArray[np.bool_]
    accelerometer: Accelerometer | None = None
    only: Axle | None = None
    left_out: NDArray[np.bool_] | None = None

    @cached_property
    def braked(self) -> NDArray[np.bool_]:
        """Blocks that take part and in which a brake bites (k,)."""
        return self.use & (np.maximum(self.blocks.p_f, self.blocks.p_r) > BITE)

    def log_odds(self, p_f: Array, p_r: Array) -> Array:
        """ln of the front pressure over the rear one [1], infinite where one axle brakes alone."""
        alone = {"f": np.inf, "r": -np.inf, None: 0.0}[self.only]
        return np.asarray(np.log(np.maximum(p_f, 1.0) / np.maximum(p_r, 1.0)) + alone)

    def quasi_static(self, vehicle: Vehicle) -> Array:
        """Deceleration [1] (k,) that gives a rigid car without effects the same axle loads."""
        moved = self.load_f * vehicle.wheelbase / vehicle.weight - vehicle.cg_to_rear_axle
        return np.asarray(moved / vehicle.cg_height)

    @cached_property
    def rolling(self) -> NDArray[np.int64]:
        """The last blocks of the lead-in that take part: where eta and slip are zero."""
        lead = np.flatnonzero(self.blocks.lead_in & self.use)
        return lead[-round(_ZEROED / self.blocks.length) :]

    @cached_property
    def braking(self) -> Array:
        """Brake force of both axles [N] (k,): ``brake_sum`` less its mean on the lead-in.

        No brake acts there: that mean is the offset of a_x, the slope and other resistances.
        """
        zero = np.mean(self.brake_sum[self.rolling]) if self.rolling.size else 0.0
        return np.asarray(self.brake_sum - zero)

    def since_rolling(self, measured: Array) -> Array:
        """Eta [1] (k,) less what it was on the lead-in: what the brakes did to it.

        Wheels of two sizes differ by per cents, which is no slip.
        """
        return np.asarray(measured - np.mean(measured[self.rolling]))


def sort_runs(runs: Sequence[Run]) -> tuple[list[Run], list[Run], list[Run]]:
    """Ramps, coasts and stops, in the order of the digests of their logs.

    A log without braking is a coast. One that brakes too fast for a ramp, by the rule `ramp_rise`,
    is a stop, if another log brakes as slowly as a ramp. The order of the command line must not
    change a bit of the table. Raises LogError for a log that will not do, that is not of this
    vehicle, or that is there twice.
    """
    refuse_copies([run.log for run in runs])
    ordered = sorted(runs, key=lambda item: item.log.digest)
    coasts = [run for run in ordered if not run.events]
    braked = [run for run in ordered if run.events]
    reasons = {run: unusable(run, FIT if run.events else COAST, (REFUSE,)) for run in ordered}
    fast = [run for run in braked if any(one.code == "ramp_rise" for one in reasons[run])]
    stops = fast if len(fast) < len(braked) else []
    reasons |= {run: unusable(run, VALIDATE) for run in stops}
    ramps = [run for run in braked if run not in stops]
    purposes = dict.fromkeys(coasts, COAST) | dict.fromkeys(ramps, FIT)
    if every := [(one, run) for run in ordered for one in reasons[run]]:
        # a mistake that all logs share may show itself in one of them alone
        first = unexplained(one for one, _ in every)[0]
        run = next(run for one, run in every if one is first)
        require_none(reasons[run], run, purposes.get(run, VALIDATE))
    if not ramps:
        raise LogError(
            "none of the logs holds a braking",
            where=", ".join(run.log.source for run in runs),
            expected="at least one ramp: 1 s unbraked, then pressure rising over 3 to 8 s",
        )
    if all(run.alone for run in ramps):
        raise LogError(
            "on every ramp one axle brakes alone, so there is no curve over eta",
            where=", ".join(run.log.source for run in ramps),
            expected="at least one ramp with both axles; ramps with one axle serve in addition",
        )
    return ramps, coasts, stops


def prepare(run: Run, effects: Effects, accelerometer: Accelerometer | None = None) -> RampRun:
    """Loads, resistances and the demanded brake force of each block of a ramp.

    ``effects`` known of body and wheels; z is put right by the ``accelerometer``, if given.

    A block in which an axle would lift holds a glitch of a_x: it has no loads and no part. Nor has
    one between the lead-in and the bite, or after a release: nobody knows whether the pads touch;
    nor one so long before the bite that its radii are forgotten (`calib.run.noise`); nor one in
    which the pressure changes fast, as when the pedal is let go.
    """
    vehicle, b, noise = run.car, run.felt(accelerometer), run.noise
    forces = block_balance(vehicle, effects, b)
    stands = np.minimum(forces.load_f, forces.load_r) > 0.0
    # the last blocks of a stop hold the jerk at standstill
    use = (b.speed > SETTINGS.min_speed) & (b.end < b.end[-1] - 0.1) & stands
    use &= b.lead_in | (np.maximum(b.p_f, b.p_r) > BITE)
    load_f = np.where(stands, forces.load_f, np.nan)
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
    turning = np.maximum(b.omega_f, 1.0)  # [rad/s]; what turns slower takes no part
    eta_density = np.asarray(np.sqrt(2.0) * noise.omega / turning)  # [s^0.5]
    is_zeroed = np.isfinite(sigma_growth(b.end, b.lead_in, eta_density))
    if ramp.slip is not None:
        speed = np.maximum(b.speed, SETTINGS.min_speed)  # slower blocks take no part
        slip_density = np.asarray(np.hypot(noise.v / speed, noise.omega / turning))
        is_zeroed |= np.isfinite(sigma_growth(b.end, b.lead_in, slip_density))
    # the pressure changes slowly enough, and has just before
    B_f, B_r = nominal_forces(vehicle, ramp, 0.0)
    rate = np.abs(np.gradient((B_f + B_r) / vehicle.weight, b.end))
    steady = time_since(b.end, rate > SETTINGS.fastest) > SETTINGS.late
    return replace(ramp, use=ramp.use & is_zeroed & (b.lead_in | steady))


def pad_scale(run: RampRun, B_f: Array, B_r: Array) -> float:
    """Common factor on the brake forces that makes their sum the demanded one, least squares."""
    total = (B_f + B_r)[run.braked]
    return float(total @ run.braking[run.braked] / (total @ total))


def nominal_forces(vehicle: Vehicle, run: RampRun, log_ratio: Array | float) -> tuple[Array, Array]:
    """Brake forces [N] of the blocks with nominal pads at a pad ratio; a released axle has none."""
    b = run.blocks
    biting = np.maximum(b.p_f, b.p_r) > 0.5 * BITE
    p_f, p_r = (p * (biting & (run.only in (None, a))) for a, p in (("f", b.p_f), ("r", b.p_r)))
    return brake_forces(vehicle, p_f, p_r, log_ratio)
