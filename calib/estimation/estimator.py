r"""The estimator on one log: causal, at the log's own rate, what an ECU would give.

    log -> known effects out -> signals -> step of the table -> pad friction, torque, intervals

The step is in `calib.estimation.step`; what the paper argues with, `calib.estimation.baselines`,
starts from the same.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import WHEELS
from calib.car.balance import ForceBalance
from calib.car.braking import BITE
from calib.car.effects.combined import sensed
from calib.car.effects.effect import Pair
from calib.car.effects.effects import Effects
from calib.car.forces import speed_ratio
from calib.car.mass import weighed
from calib.car.vehicle import Vehicle
from calib.estimation.constants import Constants
from calib.estimation.known import known_effects, known_slips, nominal_car
from calib.estimation.readout import UNITS, Readout, read_out
from calib.estimation.reasons import Reason, disturbances
from calib.logs.log import Log
from calib.model.known_effects import CorrectedRun, remove_known_effects
from calib.run.axle_signals import Signals, eta_of, rolling_radii, signals
from calib.run.blocks import Blocks, block_balance, blocks
from calib.run.brake_response import BrakeBalance, brake_balance
from calib.run.filters import low_pass
from calib.run.lateral import lateral
from calib.run.noise import SensorNoise, aged, lead_in_noise, worst_noise
from calib.table.generation import require_maps
from calib.table.table import Table

if TYPE_CHECKING:
    import pandas as pd

_SMOOTH = 0.1  # time constant of the causal filter on a load [s], short against the change of a pad


COLUMNS = {
    "time": "s",
    **dict.fromkeys(("z", "eta", "normalised_force_f", "normalised_force_r"), "1"),
    **UNITS,
    **{f"ecu_{name}": unit for name, unit in UNITS.items()},
    "ecu_reason": "1",
}
"""Columns of an estimate as a table and as a file, in their order, with their units.

Those with ``ecu_`` are what the table gives without a speed; ``ecu_reason`` is a
`calib.estimation.reasons.Reason`.
"""


@dataclass(frozen=True)
class Estimate:
    """The estimator's answer on one log, at its rate, and what it started from.

    ``table`` with the car as it is driven, ``car`` the same with the nominal pads and all known
    effects; ``ran`` the log, known effects taken out, with what they did to the pad friction, which
    is given without them; ``read`` its signals with their balance of ``forces``, ``blocks`` their
    means with that of the ``road``; ``noise`` of the sensors; ``best`` what the step makes of all
    channels, ``ecu`` without a speed; ``unfit`` why no sample of the run counts, if so.
    """

    table: Table
    car: Vehicle
    ran: CorrectedRun
    read: Signals
    forces: BrakeBalance
    blocks: Blocks
    road: ForceBalance
    noise: SensorNoise
    best: Readout
    ecu: Readout
    unfit: tuple[str, ...] = ()

    def __repr__(self) -> str:
        text = f"Estimate: {self.time.size} samples, {np.count_nonzero(self.valid)} valid"
        for i in np.flatnonzero(self.valid)[-1:]:
            for axle, x in (("front", self.best.pads_f), ("rear", self.best.pads_r)):
                text += f"; {axle} pads {x.value[i]:.3f} ({x.lower[i]:.3f} to {x.upper[i]:.3f})"
        return text

    @property
    def time(self) -> Array:
        """Clock of the log [s] (n,)."""
        return self.read.time

    @property
    def braked(self) -> Mask:
        """Samples (n,) with a pressure at which a pad level means something."""
        return np.maximum(self.read.p_f, self.read.p_r) > Constants.least_pressure

    @property
    def valid(self) -> Mask:
        """Samples in which the model holds (n,)."""
        return self.best.valid & (not self.unfit)

    @property
    def refused(self) -> dict[str, Mask]:
        """Samples in which the pads bite and the model does not hold, (n,) each, by reason."""
        bites = np.maximum(self.read.p_f, self.read.p_r) > BITE
        reasons = (reason for reason in Reason if reason is not Reason.VALID)
        shown = {reason.words: bites & (self.best.step.reason == reason) for reason in reasons}
        return dict.fromkeys(self.unfit, bites) | shown

    @cached_property
    def driven(self) -> Pair:
        """Slips (k,) of the axles at the blocks by known effects, see `known_slips`."""
        return known_slips(self.table, self.road)

    @cached_property
    def eta_zero(self) -> float:
        """eta - 1 (22) on the lead-in [1], less what known effects do to it: the radii of the day.

        Without a lead-in that of the radii of the car, within one per cent.
        """
        b = self.blocks
        if not b.lead_in.any():
            return self.car.front.rolling_radius / self.car.rear.rolling_radius - 1.0
        eta = b.eta / speed_ratio(*self.driven)
        density = math.sqrt(2.0) * self.noise.omega / np.maximum(b.omega_f, 1.0)
        # radii walk: the last seconds count most
        weights = aged(b.end, b.lead_in, density)[b.lead_in] ** -2.0
        return float(np.average(eta[b.lead_in], weights=weights)) - 1.0

    @property
    def eta(self) -> Array:
        """Eta (22) with its zero taken out [1] (n,)."""
        return eta_of(self.read.omega_f, self.read.omega_r) / (1.0 + self.eta_zero)

    @property
    def slips(self) -> Pair | None:
        """Slips (19), (20) of the axles [1] (n,) with the radii of the lead-in; None without v."""
        s, radii = self.read, rolling_radii(self.read)
        if s.v is None or radii is None:
            return None
        free_f, free_r = (
            radius * (1.0 - float(np.mean(slip[self.blocks.lead_in])))
            for radius, slip in zip(radii, self.driven, strict=True)
        )
        v = np.maximum(s.v, 0.5)
        return 1.0 - free_f * s.omega_f / v, 1.0 - free_r * s.omega_r / v

    @cached_property
    def normalised(self) -> Pair:
        """F_x/F_z of the axles [1] (n,) over the quasi-static load (6), (7)."""
        road, step = self.forces.balance, self.read.sample_time
        brake_f = 2.0 * self.best.torque_f.value / self.car.front.rolling_radius
        brake_r = 2.0 * self.best.torque_r.value / self.car.rear.rolling_radius
        return (
            (brake_f + road.moment_f) / low_pass(road.load_f, step, _SMOOTH),
            (brake_r + road.moment_r) / low_pass(road.load_r, step, _SMOOTH),
        )

    def columns(self) -> dict[str, Array | Mask | Index]:
        """The samples by the names of `COLUMNS`, (n,) each; those of both wheels are the same."""
        return {
            "time": self.time,
            "z": self.read.z,
            "eta": self.eta,
            "normalised_force_f": self.normalised[0],
            "normalised_force_r": self.normalised[1],
            **(self.best.columns() | {"valid": self.valid}),
            **{f"ecu_{name}": x for name, x in self.ecu.columns().items()},
            "ecu_reason": self.ecu.step.reason,
        }

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
    known = table.vehicle.effects.with_(vehicle.effects if vehicle else Effects())
    car = weighed(replace(table.vehicle, effects=known), mass)
    ran, read, means, road = seen = _seen(table, car, log)
    used = replace(table, vehicle=ran.vehicle)
    nominal = nominal_car(used, vehicle)
    slip = np.interp(read.z, table.tyre.force, table.tyre.slip)
    bend = lateral(ran.log, read, car.track_width, slip=slip, height=car.cg_height)
    disturbed = disturbances(ran.log, read, bend)
    noise = worst_noise([SensorNoise(**table.noise), lead_in_noise(ran.log, read)])
    as_ecu, own, of, at = _seen_by_ecu(table, car, log) or seen
    factors = as_ecu.factor_f / ran.factor_f, as_ecu.factor_r / ran.factor_r
    handed_out, quiet = replace(exported or table, vehicle=ran.vehicle), SensorNoise(**table.noise)
    return Estimate(
        table=used,
        car=replace(nominal, effects=car.effects),
        ran=ran,
        read=read,
        forces=brake_balance(nominal, known_effects(used), read),
        blocks=means,
        road=road,
        noise=noise,
        best=read_out(used, noise, read, means, road, disturbed),
        ecu=read_out(handed_out, quiet, own, of, at, disturbed, factors, with_v=False),
    )


_Seen = tuple[CorrectedRun, Signals, Blocks, ForceBalance]
"""A log, known effects taken out, its signals, their means and the balance of these."""


def _seen(table: Table, car: Vehicle, log: Log) -> _Seen:
    """The log of a ``car`` with known effects."""
    ran = remove_known_effects(car, log)
    read = signals(ran.log, ran.vehicle)
    means, effects = blocks(read), known_effects(replace(table, vehicle=ran.vehicle))
    return ran, read, means, block_balance(ran.vehicle, effects, means)


def _seen_by_ecu(table: Table, car: Vehicle, log: Log) -> _Seen | None:
    """The same by the pressure of the master cylinder alone, and the effects that an ECU knows.

    None where these are all.
    """
    wheels, own = {f"p_{w}" for w in WHEELS}, sensed(car.effects)
    if wheels.isdisjoint(log.channels) and own == car.effects:
        return None
    channels = {name: x for name, x in log.channels.items() if name not in wheels}
    return _seen(table, replace(car, effects=own), replace(log, channels=channels))
