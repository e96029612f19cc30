"""Data of the figures of a stop, from a validation of a log or from a stored result.

Values that the source does not have are None or empty, and are not drawn.
"""

from dataclasses import dataclass, field

import numpy as np

from calib.base.names import WHEELS
from calib.base.plain import plain, plus_minus
from calib.car import forces
from calib.car.braking import BITE
from calib.car.vehicle import Axle, Vehicle
from calib.estimation.axle_estimate import AxleEstimate
from calib.estimation.estimator import Estimate
from calib.estimation.plan import calibrated
from calib.estimation.validate import Validation
from calib.logs.log import Log
from calib.show.judged import broken, pads, word
from calib.show.result import StoredResult
from calib.show.style import Array, Mask
from calib.table.table import Table


@dataclass(frozen=True)
class AxleTrace:
    """One axle over time, shapes (n,).

    ``force`` F [1]; ``pad`` friction with its 95 % interval ``lower``, ``upper`` [1]; ``torque`` of
    the axle [N m]; ``nominal`` pad friction [1] and ``nominal_torque`` of the axle [N m]; ``slip``
    [1]; ``baselines`` pad friction by other methods; ``true_pad`` [1] and ``true_torque`` of the
    axle [N m] of a simulation.
    """

    force: Array
    pad: Array
    lower: Array
    upper: Array
    torque: Array
    nominal: float | None = None
    nominal_torque: Array | None = None
    slip: Array | None = None
    baselines: dict[str, Array] = field(default_factory=dict)
    true_pad: Array | None = None
    true_torque: Array | None = None


_OF_TABLE, _OF_VEHICLE = "of the table", "of the vehicle file"
"""Whose pads the nominal ones are."""


@dataclass(frozen=True)
class StopTrace:
    """A stop over ``time`` [s], shapes (n,).

    ``z``, ``eta`` [1]; ``front``, ``rear``; ``valid`` whether the estimate can be used;
    ``wheels`` [rad/s] by wheel; ``v_wheel`` reference speed over the rolling radius [rad/s];
    ``changes`` of surface and begin and end of ``bumps`` [s]; ``notes`` in words.
    ``refused`` where the estimate cannot be used, by reason, (n,) each; ``pads`` of both axles in
    words, mean and half width of the 95 % interval [1], None where nothing is valid;
    ``verdict`` in words, empty where none was given; ``nominal_of`` says whose the nominal
    pads are: of the table, as found on its ramp, unless a vehicle file was given.
    """

    name: str
    time: Array
    z: Array
    eta: Array
    front: AxleTrace
    rear: AxleTrace
    valid: Mask
    wheels: dict[str, Array] = field(default_factory=dict)
    v_wheel: Array | None = None
    changes: tuple[float, ...] = ()
    bumps: tuple[tuple[float, float], ...] = ()
    notes: tuple[str, ...] = ()
    refused: dict[str, Mask] = field(default_factory=dict)
    pads: tuple[str | None, str | None] = (None, None)
    verdict: str = ""
    nominal_of: str = _OF_VEHICLE

    @property
    def has_truth(self) -> bool:
        """Whether the log has the true torques, as that of a simulation."""
        return self.front.true_torque is not None


def from_validation(
    table: Table, name: str, log: Log, result: Validation, vehicle: Vehicle | None = None
) -> StopTrace:
    """Trace of the ``result`` on ``log`` with the table ``name`` and ``vehicle``."""
    car, estimate = vehicle or calibrated(table), result.estimate
    front = _axle(car.front, estimate.front, estimate, 0, log)
    rear = _axle(car.rear, estimate.rear, estimate, 1, log)
    warned = ", ".join(plain(warning.code).name for warning in result.all_warnings)
    return StopTrace(
        name=log.name,
        time=estimate.time,
        z=estimate.z,
        eta=estimate.eta,
        front=front,
        rear=rear,
        valid=estimate.valid,
        wheels={w: log[f"omega_{w}"] for w in WHEELS},
        v_wheel=log["v"] / car.rear.rolling_radius if "v" in log else None,
        changes=estimate.split.changes,
        bumps=estimate.split.bumps,
        notes=(
            f"Estimator with table {name}, digest {table.digest[:16]}.",
            *estimate.notes,
            *([f"Warnings, which brake-cal validate explains: {warned}."] if warned else ()),
        ),
        refused={_NOT_BRAKED: ~estimate.braked, **estimate.refused},
        pads=(pads(result.figures, "f"), pads(result.figures, "r")),
        verdict="; ".join([word(result), *broken(result)]),
        nominal_of=_OF_TABLE if vehicle is None else _OF_VEHICLE,
    )


_NOT_BRAKED = "the brakes are released"
"""The reason beside those of the estimator."""


def from_result(result: StoredResult, vehicle: Vehicle | None = None) -> StopTrace:
    """Trace of a stored result; ``vehicle`` adds the nominal pads."""
    return StopTrace(
        name=result.name,
        time=result["time"],
        z=result["z"],
        eta=result["eta"],
        front=_stored_axle(result, "f", vehicle),
        rear=_stored_axle(result, "r", vehicle),
        valid=result.valid,
        notes=(f"Result {result.name}, digest {result.digest[:16]}.",),
        pads=(_mean_pads(result, "f"), _mean_pads(result, "r")),
    )


def _mean_pads(result: StoredResult, side: str) -> str | None:
    """As the validation counts them; None without a valid sample."""
    held = result.valid
    if not held.any():
        return None
    mu = result[f"pad_friction_{side}"][held]
    lower, upper = (result[f"pad_friction_{side}_{end}"][held] for end in ("lower", "upper"))
    mean = float(np.mean(mu))
    return plus_minus(mean, mean * float(np.median(0.5 * (upper - lower) / mu)))


def _axle(axle: Axle, found: AxleEstimate, estimate: Estimate, i: int, log: Log) -> AxleTrace:
    pressure = (estimate.pressure_f, estimate.pressure_r)[i]
    factor = (estimate.factor_f, estimate.factor_r)[i]
    left, right = (log.truth.get(f"true_Tb_{'fr'[i]}{hand}") for hand in "lr")
    true = None if left is None or right is None else left + right
    true_pad = None if true is None else _true_pad(axle, 0.5 * true, pressure)
    logged = log.truth.get(f"true_mu_pad_{'fr'[i]}")
    held = np.maximum(pressure, 0.0)
    return AxleTrace(
        force=found.normalised_force,
        pad=found.pad_friction,
        lower=found.lower,
        upper=found.upper,
        torque=2.0 * found.torque,
        nominal=axle.pad_friction,
        nominal_torque=2.0 * forces.brake_torque(axle, axle.pad_friction, held),
        slip=(estimate.slip_f, estimate.slip_r)[i],
        baselines={n: pads[i] for n, pads in estimate.baselines.items() if n != "nominal"},
        # without the factors of known effects, as in the estimate
        true_pad=true_pad if logged is None else logged / factor,
        true_torque=true,
    )


def _true_pad(axle: Axle, torque: Array, pressure: Array) -> Array:
    """Pad friction by the true torque of a wheel [N m], while braked."""
    biting = pressure > BITE
    pad = forces.pad_friction(axle, torque, np.where(biting, pressure, 1.0))
    return np.where(biting, pad, np.nan)


def _stored_axle(result: StoredResult, side: str, vehicle: Vehicle | None) -> AxleTrace:
    axle = vehicle and (vehicle.front if side == "f" else vehicle.rear)
    left, right = (result[f"brake_torque_{side}{hand}"] for hand in "lr")
    pad = result[f"pad_friction_{side}"]
    return AxleTrace(
        force=result[f"normalised_force_{side}"],
        pad=pad,
        lower=result[f"pad_friction_{side}_lower"],
        upper=result[f"pad_friction_{side}_upper"],
        torque=left + right,
        nominal=axle.pad_friction if axle else None,
        # torque is proportional to friction at the same pressure, (2)
        nominal_torque=(left + right) * (axle.pad_friction / pad) if axle else None,
    )
