r"""The estimator on one log: causal, at the log's own rate, what an ECU would give.

    log -> known effects out -> signals -> step of the table -> pad friction, torque, intervals
                                       \-> baselines, shown beside it

The step is in `calib.estimation.step`; beside it stand the paper's law and what the paper argues
with, see `calib.estimation.baselines`.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.car.braking import BITE
from calib.car.effects.combined import sensed
from calib.car.vehicle import Vehicle
from calib.estimation.baselines import BaselineRun, baselines
from calib.estimation.constants import Constants
from calib.estimation.plan import Plan, plan_for, with_effects, with_pads
from calib.estimation.readout import Readout, read_out
from calib.estimation.reasons import Reason, disturbances
from calib.estimation.zeros import known_slips, zero_of_eta, zeroed_slips
from calib.logs.log import Log
from calib.model.known_effects import CorrectedRun, remove_known_effects
from calib.model.sensors import judge_accelerometer
from calib.run.accelerometer import Accelerometer
from calib.run.axle_signals import Signals, eta_of, signals
from calib.run.blocks import Blocks, blocks
from calib.run.brake_response import BrakeBalance, BrakeResponse, brake_balance, brake_response
from calib.run.filters import low_pass
from calib.run.lateral import lateral
from calib.run.noise import SensorNoise
from calib.table.generation import require_maps
from calib.table.table import Table

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Index = NDArray[np.int64]
Pair = tuple[Array, Array]

_SMOOTH = 0.1  # time constant of the causal filter on a load [s], short against the change of a pad

_PADS = ("pad_friction_f", "pad_friction_r")
_TORQUES = ("brake_torque_fl", "brake_torque_fr", "brake_torque_rl", "brake_torque_rr")
_CHANGES = ("pad_change_f", "pad_change_r")


def _with_bounds(*names: str) -> list[str]:
    return [f"{name}{end}" for name in names for end in ("", "_lower", "_upper")]


_OUT = {
    **dict.fromkeys(_with_bounds(*_PADS), "1"),
    **dict.fromkeys(_with_bounds(*_TORQUES), "N*m"),
    "valid": "1",
    **dict.fromkeys(_with_bounds(*_CHANGES, "pad_level", "pad_ratio"), "1"),
    **dict.fromkeys(_with_bounds("brake_torque_sum"), "N*m"),
}

COLUMNS = {
    **dict.fromkeys(("time",), "s"),
    **dict.fromkeys(("z", "eta", "normalised_force_f", "normalised_force_r"), "1"),
    **_OUT,
    **{f"ecu_{name}": unit for name, unit in _OUT.items()},
    "ecu_reason": "1",
}
"""Columns of an estimate as a table and as a file, in their order, with their units.

Those with ``ecu_`` are what the table gives without a speed; ``ecu_reason`` is a
`calib.estimation.reasons.Reason`.
"""


@dataclass(frozen=True)
class Estimate:
    """The estimator's answer on one log, at its rate.

    ``plan`` what it started from, ``read`` the signals, known effects taken out, with their means
    over ``blocks`` and their balance of ``forces``; ``eta`` zeroed (22) [1]; ``z`` [1];
    ``force_f``, ``force_r`` F_x/F_z [1]; ``braked`` pads bite; ``baselines`` pad friction (front,
    rear) by method name; ``eta_zero`` what was zeroed [1]; ``factor_f``, ``factor_r`` what known
    effects did to the pad friction, which is given without them [1]; ``notes`` name the baselines
    left out; ``best`` what the step makes of all channels, ``ecu`` without a speed; ``unfit`` why
    no sample of the run counts, where that is so.
    """

    plan: Plan
    read: Signals
    forces: BrakeBalance
    time: Array
    z: Array
    eta: Array
    speed: Array
    force_f: Array
    force_r: Array
    braked: Mask
    baselines: dict[str, tuple[Array, Array]]
    best: Readout
    ecu: Readout
    blocks: Blocks
    eta_zero: float
    pressure_f: Array
    pressure_r: Array
    slip_f: Array | None = None
    slip_r: Array | None = None
    factor_f: Array | float = 1.0
    factor_r: Array | float = 1.0
    notes: tuple[str, ...] = field(default=())
    unfit: tuple[str, ...] = ()

    def __repr__(self) -> str:
        count = f"Estimate: {self.time.size} samples, {np.count_nonzero(self.valid)} valid"
        if not self.valid.any():
            return count
        last = int(np.flatnonzero(self.valid)[-1])
        pads = [
            f"{name} {pads.value[last]:.3f} (95 % {pads.lower[last]:.3f} to {pads.upper[last]:.3f})"
            for name, pads in (("front", self.best.pads_f), ("rear", self.best.pads_r))
        ]
        return f"{count}; pad friction at {self.time[last]:.2f} s: {', '.join(pads)}"

    @property
    def valid(self) -> Mask:
        """Samples in which the model holds (n,)."""
        return self.best.valid & (not self.unfit)

    @property
    def refused(self) -> dict[str, Mask]:
        """Samples in which the pads bite and the model does not hold, (n,) each, by reason."""
        bites = np.maximum(self.pressure_f, self.pressure_r) > BITE
        reasons = [one for one in Reason if one is not Reason.VALID]
        of_run = dict.fromkeys(self.unfit, bites)
        return of_run | {one.words: bites & (self.best.step.reason == one) for one in reasons}

    @property
    def telling(self) -> Mask:
        """The valid samples (n,); without any, those in which the pads bite."""
        return self.valid if self.valid.any() else self.braked

    @cached_property
    def response(self) -> BrakeResponse | None:
        """How the brakes answered the pressure over the whole run; None if it tells too little."""
        return brake_response(self.read, self.forces)

    @cached_property
    def accelerometer(self) -> Accelerometer:
        """Scale and offset of the accelerometer over the whole run, by speed and resistance."""
        plan = self.plan
        return judge_accelerometer(plan.nominal, plan.known, self.blocks, plan.noise)

    def columns(self) -> dict[str, Array | Mask | Index]:
        """The samples by the names of `COLUMNS`, (n,) each.

        Pad friction and its bounds are per axle, torque is per wheel: both wheels of an axle have
        the same.
        """
        values: dict[str, Array | Mask | Index] = {
            "time": self.time,
            "z": self.z,
            "eta": self.eta,
            "normalised_force_f": self.force_f,
            "normalised_force_r": self.force_r,
            "valid": self.valid,
            **self.best.columns(),
            **{f"ecu_{name}": x for name, x in self.ecu.columns().items()},
            "ecu_valid": self.ecu.valid,
            "ecu_reason": self.ecu.step.reason,
        }
        return {name: values[name] for name in COLUMNS}

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
    *,
    mass: float | None = None,
    with_laws: bool = True,
    read: Signals | None = None,
    exported: Table | None = None,
) -> Estimate:
    """Run the estimator with a table on a log.

    Parameters
    ----------
    table : what the car was calibrated to. Its known effects are taken out of the log first, see
        `calib.model.known_effects`.
    log : the run, with an unbraked lead-in in which eta is zeroed.
    vehicle : the nominal pads if they are not the table's, and known effects beside or instead of
        the table's.
    mass : of the car in this log [kg], if it is not that of the table's vehicle.
    with_laws : without, the only baseline is nominal pads.
    read : `signals` of the log with the table's vehicle, where they are known.
    exported : the table as an ECU reads it, of which ``ecu`` then is, see `calib.table.exported`.

    Raises StoreError for a table without maps.

    Without a lead-in the radii are those of the vehicle, within one per cent: eta says little then.

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
    require_maps(table)
    car = with_effects(table, vehicle, mass)
    ran = remove_known_effects(car, log)
    used = replace(table, vehicle=ran.vehicle)
    nominal = None if vehicle is None else with_pads(ran.vehicle, vehicle)
    radius = ran.vehicle.rear.rolling_radius
    if read is None or ran.log is not log or radius != table.vehicle.rear.rolling_radius:
        read = signals(ran.log, nominal or ran.vehicle)
    plan = plan_for(used, ran.log, read, nominal)
    forces = brake_balance(plan.nominal, plan.known.effects, read)
    cornering = _cornering(table, plan.nominal, ran.log, read, forces)
    disturbed = disturbances(ran.log, read, cornering)
    filed = with_pads(ran.vehicle, table.vehicle)
    means = blocks(read)
    best = read_out(table, filed, plan.known, plan.noise, read, means, disturbed)
    own, (as_ecu, taken_out) = SensorNoise(**table.noise), _as_ecu(car, log, read, ran)
    of = means if as_ecu is read else blocks(as_ecu)
    by_ecu = replace(plan.known, effects=sensed(plan.known.effects))
    factors = taken_out.factor_f / ran.factor_f, taken_out.factor_r / ran.factor_r
    ecu = read_out(
        exported or table, filed, by_ecu, own, as_ecu, of, disturbed, factors, with_v=False
    )
    driven = known_slips(used, ran.vehicle, forces.balance)
    zero = zero_of_eta(read, driven, plan.noise, plan.nominal)
    eta = eta_of(read.omega_f, read.omega_r) / (1.0 + zero)
    run = BaselineRun(used, plan.nominal, car.effects, ran.log, read, forces, eta)
    others, notes = baselines(run, laws=with_laws)
    normalised = _normalised(plan, read, forces, best)
    slips = zeroed_slips(read, driven, plan.noise)
    return Estimate(
        plan=plan,
        read=read,
        forces=forces,
        time=read.time,
        z=read.z,
        eta=eta,
        speed=read.speed,
        force_f=normalised[0],
        force_r=normalised[1],
        braked=np.maximum(read.p_f, read.p_r) > Constants.least_pressure,
        baselines=others,
        best=best,
        ecu=ecu,
        blocks=means,
        eta_zero=zero,
        pressure_f=read.p_f,
        pressure_r=read.p_r,
        slip_f=slips[0] if slips else None,
        slip_r=slips[1] if slips else None,
        factor_f=ran.factor_f,
        factor_r=ran.factor_r,
        notes=notes,
    )


def _as_ecu(
    car: Vehicle, log: Log, read: Signals, ran: CorrectedRun
) -> tuple[Signals, CorrectedRun]:
    """The signals by the pressure of the master cylinder alone, with the effects taken out that an
    ECU knows; ``read`` and ``ran`` themselves where these are all.
    """
    wheels = {f"p_{w}" for w in WHEELS}
    own = sensed(car.effects)
    if wheels.isdisjoint(log.channels) and own == car.effects:
        return read, ran
    channels = {name: x for name, x in log.channels.items() if name not in wheels}
    taken_out = remove_known_effects(replace(car, effects=own), replace(log, channels=channels))
    return signals(taken_out.log, taken_out.vehicle), taken_out


def _normalised(plan: Plan, s: Signals, forces: BrakeBalance, best: Readout) -> Pair:
    """F_x/F_z of both axles [1] over the quasi-static load (6), (7)."""
    (front, rear), road = (plan.nominal.front, plan.nominal.rear), forces.balance
    brake_f, brake_r = (
        2.0 * torque.value / axle.rolling_radius
        for torque, axle in ((best.torque_f, front), (best.torque_r, rear))
    )
    return (
        (brake_f + road.moment_f) / low_pass(road.load_f, s.sample_time, _SMOOTH),
        (brake_r + road.moment_r) / low_pass(road.load_r, s.sample_time, _SMOOTH),
    )


def _cornering(table: Table, car: Vehicle, log: Log, s: Signals, forces: BrakeBalance) -> Array:
    """Lateral acceleration [m/s^2] (n,); the rear wheels slip as on the road of the ramp."""
    road, total = forces.balance, forces.nominal_f + forces.nominal_r
    share = np.divide(forces.nominal_r, total, out=np.zeros_like(total), where=total > 0.0)
    slip = np.interp(share * road.demanded / road.load_r, table.tyre.force, table.tyre.slip)
    return lateral(log, s, car.track_width, slip=slip, height=car.cg_height)
