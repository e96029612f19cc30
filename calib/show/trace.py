"""Data of the figures of a stop, from a validation of a log or from a stored result.

Values that the source does not have are None or empty, and are not drawn.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from calib.base.names import WHEELS
from calib.base.plain import plain, plus_minus
from calib.car import forces
from calib.car.balance import force_balance
from calib.car.braking import BITE
from calib.car.vehicle import Axle, Vehicle
from calib.estimation.axle_estimate import AxleEstimate
from calib.estimation.estimator import Estimate
from calib.estimation.plan import calibrated, known_resistance
from calib.estimation.validate import Validation
from calib.logs.log import Log
from calib.show.judged import broken, pads, word
from calib.show.result import StoredResult
from calib.show.style import Array, Mask
from calib.table.budget import AxleBudget
from calib.table.table import Table


@dataclass(frozen=True)
class AxleTrace:
    """One axle over time, shapes (n,).

    ``force`` F [1]; ``pad`` friction with its 95 % interval ``lower``, ``upper`` [1]; ``torque`` of
    the axle [N m]; ``wheel_torque`` of its left wheel [N m]; ``nominal`` pad friction [1] and
    ``nominal_torque`` of the axle [N m]; ``slip`` [1]; ``baselines`` pad friction by other methods;
    ``true_pad`` [1] and ``true_wheel_torque`` [N m] of a simulation.
    """

    force: Array
    pad: Array
    lower: Array
    upper: Array
    torque: Array
    wheel_torque: Array
    nominal: float | None = None
    nominal_torque: Array | None = None
    slip: Array | None = None
    baselines: dict[str, Array] = field(default_factory=dict)
    true_pad: Array | None = None
    true_wheel_torque: Array | None = None


_OF_TABLE, _OF_VEHICLE = "of the table", "of the vehicle file"
"""Whose pads the nominal ones are."""


@dataclass(frozen=True)
class StopTrace:
    """A stop over ``time`` [s], shapes (n,).

    ``z``, ``eta`` [1]; ``front``, ``rear``; ``valid`` whether the estimate can be used;
    ``wheels`` [rad/s] by wheel; ``v_wheel`` reference speed over the rolling radius [rad/s];
    ``force_sum`` force of tyres and air with the compensated pads, ``force_sum_nominal`` with the
    nominal ones, ``inertia`` M z g, all [N]; ``changes`` of surface and begin and end of
    ``bumps`` [s]; ``notes`` in words.
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
    force_sum: Array | None = None
    force_sum_nominal: Array | None = None
    inertia: Array | None = None
    changes: tuple[float, ...] = ()
    bumps: tuple[tuple[float, float], ...] = ()
    notes: tuple[str, ...] = ()
    budget: tuple[AxleBudget, AxleBudget] | None = None
    refused: dict[str, Mask] = field(default_factory=dict)
    pads: tuple[str | None, str | None] = (None, None)
    verdict: str = ""
    nominal_of: str = _OF_VEHICLE

    @property
    def has_truth(self) -> bool:
        """Whether the log has the true torques, as that of a simulation."""
        return self.front.true_wheel_torque is not None


def from_validation(
    table: Table, name: str, log: Log, result: Validation, vehicle: Vehicle | None = None
) -> StopTrace:
    """Trace of the ``result`` on ``log`` with the table ``name`` and ``vehicle``."""
    car, estimate = vehicle or calibrated(table), result.estimate
    front = _axle(car.front, estimate.front, estimate, 0, log)
    rear = _axle(car.rear, estimate.rear, estimate, 1, log)
    e, known = estimate, known_resistance(table).effects
    body = force_balance(car, known, e.time, e.speed, e.z, e.pressure_f).body
    total = _force_sum(car, estimate.z, front, rear) + body
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
        force_sum=total,
        force_sum_nominal=total + _nominal_excess(car, front, rear),
        inertia=car.weight * estimate.z,
        changes=estimate.split.changes,
        bumps=estimate.split.bumps,
        budget=result.budget,
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
    """Trace of a stored result; ``vehicle`` adds the sum of forces and the nominal pads."""
    trace = StopTrace(
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
    if vehicle is None:
        return trace
    total = _force_sum(vehicle, trace.z, trace.front, trace.rear)
    return replace(
        trace,
        force_sum=total,
        force_sum_nominal=total + _nominal_excess(vehicle, trace.front, trace.rear),
        inertia=vehicle.weight * trace.z,
        notes=(*trace.notes, "The sum of forces is without air drag."),
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
    left = ("fl", "rl")[i]
    held = np.maximum(pressure, 0.0)
    return AxleTrace(
        force=found.normalised_force,
        pad=found.pad_friction,
        lower=found.lower,
        upper=found.upper,
        torque=2.0 * found.torque,
        wheel_torque=found.torque,
        nominal=axle.pad_friction,
        nominal_torque=2.0 * forces.brake_torque(axle, axle.pad_friction, held),
        slip=(estimate.slip_f, estimate.slip_r)[i],
        baselines={n: pads[i] for n, pads in estimate.baselines.items() if n != "nominal"},
        true_pad=_true_pad(axle, log, "fr"[i], estimate),
        true_wheel_torque=log.truth.get(f"true_Tb_{left}"),
    )


def _true_pad(axle: Axle, log: Log, side: str, estimate: Estimate) -> Array | None:
    """Pad friction of the simulation: logged, or from the axle's torques while braked.

    Without the factors of known effects, as in the estimate.
    """
    pressure, factor = estimate.pressure_r, estimate.factor_r
    if side == "f":
        pressure, factor = estimate.pressure_f, estimate.factor_f
    if f"true_mu_pad_{side}" in log.truth:
        return np.asarray(log.truth[f"true_mu_pad_{side}"] / factor)
    if f"true_Tb_{side}l" not in log.truth or f"true_Tb_{side}r" not in log.truth:
        return None
    torque = 0.5 * (log.truth[f"true_Tb_{side}l"] + log.truth[f"true_Tb_{side}r"])
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
        wheel_torque=left,
        nominal=axle.pad_friction if axle else None,
        # torque is proportional to friction at the same pressure, (2)
        nominal_torque=(left + right) * (axle.pad_friction / pad) if axle else None,
    )


def _force_sum(vehicle: Vehicle, z: Array, front: AxleTrace, rear: AxleTrace) -> Array:
    """Sum of the tyre forces [N] from the normalised forces, (17)."""
    load_f, load_r = forces.axle_loads(vehicle, z)
    return front.force * load_f + rear.force * load_r


def _nominal_excess(vehicle: Vehicle, front: AxleTrace, rear: AxleTrace) -> Array:
    """Brake force at the road [N] that nominal pads give beyond the compensated ones."""
    excess = np.zeros_like(front.torque)
    for axle, side in ((vehicle.front, front), (vehicle.rear, rear)):
        if side.nominal_torque is not None:
            excess = excess + (side.nominal_torque - side.torque) / axle.rolling_radius
    return excess
