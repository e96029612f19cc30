"""Estimate pads and torques of one log, causally and at the rate of the log.

log -> known effects out -> signals -> step of the table -> pad friction, torque, intervals
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.errors import LogError
from calib.base.extras import need
from calib.base.viewable import Viewable
from calib.car.braking import BITE
from calib.car.effects.combined import sensed
from calib.car.effects.effect import Pair
from calib.car.effects.effects import Effects
from calib.car.mass import with_mass
from calib.car.vehicle import Vehicle
from calib.estimation.constants import Constants
from calib.estimation.known import as_driven, known_effects, nominal_car
from calib.estimation.online import online, rows_of
from calib.estimation.readout import UNITS, Readout, read_out
from calib.estimation.reasons import Reason, disturbances
from calib.logs.log import Log
from calib.run.axle_signals import Signals, eta_of
from calib.run.blocks import samples_of_block
from calib.run.brake_response import BrakeBalance, brake_balance
from calib.run.filters import low_pass
from calib.run.known_effects import CorrectedRun
from calib.run.noise import SensorNoise, worst_noise
from calib.run.run import Run
from calib.store.version import Stored, table_in
from calib.table.table import Table

if TYPE_CHECKING:
    import pandas as pd

_SMOOTH = 0.1  # time constant of the low pass on an axle load [s]: pads change more slowly

COLUMNS = {
    "time": "s",
    **dict.fromkeys(("z", "eta", "normalised_force_f", "normalised_force_r"), "1"),
    **UNITS,
    **{f"ecu_{name}": unit for name, unit in UNITS.items()},
    "ecu_reason": "1",
}
"""Columns of an estimate in their order, with their units; ``ecu_`` marks answers without v."""


@dataclass(frozen=True)
class Estimate(Viewable):
    """The estimate of one log, at the rate of the log, with the inputs of the estimate."""

    table: Table  # with the car as driven
    car: Vehicle  # with nominal pads and all known effects
    run: Run  # log with its gaps filled
    corrected: CorrectedRun  # log without known effects, and their factors on the pad friction
    signals: Signals  # of ``corrected``
    forces: BrakeBalance  # of ``signals``
    noise: SensorNoise
    best: Readout  # answer by all channels
    ecu: Readout  # answer without v
    unfit: tuple[str, ...] = ()  # reasons why no sample counts

    def __repr__(self) -> str:
        return f"Estimate: {self.time.size} samples, {np.count_nonzero(self.valid)} valid"

    @property
    def time(self) -> Array:
        """Clock of the log [s] (n,)."""
        return self.signals.time

    @cached_property
    def bites(self) -> Mask:
        """Samples (n,) in which the pads bite."""
        return np.maximum(self.signals.p_f, self.signals.p_r) > BITE

    @property
    def braked(self) -> Mask:
        """Samples (n,) with enough pressure for a pad level."""
        return np.maximum(self.signals.p_f, self.signals.p_r) > Constants.least_pressure

    @property
    def valid(self) -> Mask:
        """Samples in which the model holds (n,)."""
        return self.best.valid & (not self.unfit)

    @property
    def ecu_valid(self) -> Mask:
        """Samples in which the ECU is valid (n,); none if the run does not count."""
        return self.ecu.valid & (not self.unfit)

    @property
    def refused(self) -> dict[str, Mask]:
        """Samples (n,) in which the pads bite and the ECU has no valid answer, by reason."""
        refused = dict.fromkeys(self.unfit, self.bites)
        for reason in Reason:
            if reason is not Reason.VALID:
                refused[reason.words] = self.bites & (self.ecu.step.reason == reason)
        return refused

    @property
    def zeros(self) -> tuple[float, float]:
        """Eta (22) and slip [1] before the first bite; without a lead-in by the car's radii."""
        # the sample before the first bite; the last one (-1) without a bite, or if the log begins
        # braked, when a zero can only have been read later
        step, last = self.best.step, int(np.argmax(self.bites)) - 1
        return float(step.zero_eta[last]), float(step.zero_slip[last])

    @property
    def eta(self) -> Array:
        """Eta (22) over its zero [1] (n,)."""
        return eta_of(self.signals.omega_f, self.signals.omega_r) / self.zeros[0]

    @property
    def slips(self) -> Pair | None:
        """Slips (19), (20) of the axles [1] (n,) without their zeros; None without v."""
        if self.signals.v is None:
            return None
        radius = self.car.front.rolling_radius / (1.0 - self.zeros[1])  # of rolling without slip
        rim_over_v = radius * self.signals.omega_f / np.maximum(self.signals.v, 0.5)
        return 1.0 - rim_over_v, 1.0 - rim_over_v * self.eta

    @cached_property
    def normalised(self) -> Pair:
        """F_x/F_z of the axles [1] (n,) over the quasi-static load (6), (7)."""
        road, step = self.forces.balance, self.signals.sample_time
        brake_f = 2.0 * self.best.torque_f.value / self.car.front.rolling_radius
        brake_r = 2.0 * self.best.torque_r.value / self.car.rear.rolling_radius
        return (
            (brake_f + road.drag_f) / low_pass(road.load_f, step, _SMOOTH),
            (brake_r + road.drag_r) / low_pass(road.load_r, step, _SMOOTH),
        )

    def columns(self) -> dict[str, Array | Mask | Index]:
        """Return the columns (n,) by the names of `COLUMNS`; both wheels of an axle are equal."""
        best, ecu = self.best.columns() | {"valid": self.valid}, self.ecu.columns()
        motion = self.time, self.signals.z, self.eta, *self.normalised
        columns = *motion, *best.values(), *ecu.values(), self.ecu.step.reason
        return dict(zip(COLUMNS, columns, strict=True))

    def to_frame(self) -> "pd.DataFrame":
        """Return `columns` as a frame with units in ``attrs["units"]``, by the extra `frames`."""
        frame: pd.DataFrame = need("pandas", "frames").DataFrame(self.columns())
        frame.attrs["units"] = dict(COLUMNS)
        return frame


def estimate(
    table: Table | Stored,
    log: Log,
    vehicle: Vehicle | None = None,
    *,
    mass: float | None = None,
    exported: Table | None = None,
) -> Estimate:
    """Run the estimator with a table on a log.

    Parameters
    ----------
    table : the fitted table, or a version of it in a store. Its known effects are taken out of
        the log first, see `calib.run.known_effects`.
    log : the run. Without an unbraked lead-in, in which eta is zeroed, the radii are those of the
        vehicle within one per cent, and eta says little.
    vehicle : nominal pads, if they are not the table's, and known effects, which are added to the
        table's and take precedence.
    mass : mass of the car in this log [kg], if not that of the table's vehicle.
    exported : the table as an ECU reads it, for `Estimate.ecu`, see `calib.table.exported`.

    Raises StoreError for a table without maps, LogError for a log without a block.

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
    table = table_in(table)
    return estimate_run(table, run_of(table, log, vehicle, mass), vehicle, exported)


def run_of(
    table: Table, log: Log, vehicle: Vehicle | None = None, mass: float | None = None
) -> Run:
    """Return the run of a log with the table's car and known effects, arguments as `estimate`."""
    effects = table.vehicle.effects.with_(vehicle.effects if vehicle else Effects())
    return Run(log, with_mass(replace(table.vehicle, effects=effects), mass))


def estimate_run(
    table: Table, run: Run, vehicle: Vehicle | None = None, exported: Table | None = None
) -> Estimate:
    """Run the estimator on a run by `run_of`; the other arguments are as in `estimate`."""
    log, car = run.log, run.vehicle
    assert car is not None
    if log.time.size < max(2, samples_of_block(log.sample_time)):
        raise LogError("the log is shorter than a block of 50 ms", where=log.source)
    filled, rows = _filled(run)
    used = as_driven(table, filled.car)  # known effects that are taken out are not on this car
    nominal = nominal_car(used, vehicle)
    corrected, signals = filled.corrected, filled.signals
    disturbed = np.full(signals.time.size, int(Reason.FAULT))  # in gaps
    disturbed[rows] = disturbances(used, corrected.log, signals)[rows]
    noise = worst_noise([SensorNoise(**table.noise), filled.lead_in_noise])
    best = read_out(used, noise, signals, filled.blocks, disturbed)
    if rows.size < signals.time.size:  # leave out the samples in gaps
        best, corrected, signals = best.take(rows), corrected.take(rows), signals.take(rows)
    car_of_ecu = replace(car, effects=sensed(car.effects))  # with what an ECU can take out
    ecu = online(exported or table, car_of_ecu, log)
    return Estimate(
        table=used,
        car=replace(nominal, effects=car.effects),  # with all known effects
        run=filled,
        corrected=corrected,
        signals=signals,
        forces=brake_balance(nominal, known_effects(used), signals),
        noise=noise,
        best=best,
        # the known effects on the pads are taken out, as in ``best``
        ecu=ecu.with_pads(1.0 / corrected.factor_f, 1.0 / corrected.factor_r),
    )


def _filled(run: Run) -> tuple[Run, Index]:
    """Return the run with its gaps filled linearly (m,), and the rows of its own samples (n,)."""
    rows = rows_of(run.log)
    if rows.size > rows[-1]:
        return run, rows
    all_rows = np.arange(rows[-1] + 1)
    channels = {name: np.interp(all_rows, rows, x) for name, x in run.log.channels.items()}
    return replace(run, log=replace(run.log, channels=channels)), rows
