"""Brake torque of the axles and of both together in a stop, with 95 % bounds and error, as text."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from calib.base.arrays import Mask
from calib.base.names import AXLE_NAMES
from calib.base.plain import NBSP
from calib.base.units import BAR
from calib.estimation.metrics import truth_of
from calib.estimation.readout import ENDS, Bounded
from calib.estimation.validate import NONE, REFERENCE, TRUTH, Validation
from calib.table.table import Table

Columns = Mapping[str, Any]
"""Columns of an estimate by their names, (n,) each, as `calib.estimation.estimator` has them."""
SIDES = (*AXLE_NAMES.values(), "total")
"""What has a brake torque: front axle, rear axle, and both together."""
UNKNOWN = "not known"
UNIT = f"N{NBSP}m"
HEADS = tuple(f"{side} [{UNIT}]" for side in SIDES)
_COLUMN_FACTORS = {"fl": 2.0, "rl": 2.0, "sum": 1.0}
"""For each of the `SIDES`, part of its column's name and a factor: an axle has two wheels."""
AGAINST = {TRUTH: "the truth", REFERENCE: "the estimate with v", NONE: "nothing"}
"""What the torques of an ECU are compared with, in words."""


def torques(columns: Columns, prefix: str = "ecu_") -> list[Bounded]:
    """Return the torques of the `SIDES` [N m] (n,) with their bounds.

    The ``prefix`` of the columns is "ecu_" for the ECU, "" for the best estimate.
    """
    return [
        Bounded(*(factor * columns[f"{prefix}brake_torque_{part}{end}"] for end in ENDS))
        for part, factor in _COLUMN_FACTORS.items()
    ]


def means(columns: Columns, valid: Mask, prefix: str = "ecu_") -> list[str]:
    """Return mean torques of the `SIDES` over ``valid`` samples (n,), with their 95 % intervals."""
    return [_mean(torque, valid) for torque in torques(columns, prefix)]


def ecu_means(result: Validation) -> list[str]:
    """Return the `means` of the ECU over the valid samples of a stop."""
    return means(result.estimate.columns(), result.estimate.ecu_valid)


def _mean(torque: Bounded, valid: Mask) -> str:
    value, lower, upper = (values[valid] for values in torque)
    if not np.sum(value) > 0.0:  # no valid sample, or none that brakes
        return UNKNOWN
    half_width = 0.5 * float(np.mean(upper - lower))
    return f"{np.mean(value):.0f}{NBSP}±{NBSP}{half_width:.0f}"


def in_words(texts: list[str]) -> str:
    """Return the ``texts`` of the `SIDES` in one phrase; "" where a torque is not known."""
    if UNKNOWN in texts:
        return ""
    named = ", ".join(f"{side} {text}" for side, text in zip(SIDES, texts, strict=True))
    return f"brake torque {named} {UNIT} (95{NBSP}%)"


def per_bar(table: Table) -> list[str]:
    """Return the brake torque per bar of each axle on the ramp [N m], with its 95 % interval."""
    car, ramp, texts = table.vehicle, table.calibration, []
    for axle, pad in ((car.front, ramp.pad_friction_f), (car.rear, ramp.pad_friction_r)):
        per_friction = 2.0 * BAR * axle.torque_gain  # two wheels, at a pad friction of 1
        half_width = per_friction * (pad.ci95[1] - pad.value)
        texts.append(f"{per_friction * pad.value:.1f}{NBSP}±{NBSP}{half_width:.1f}")
    return texts


class _TorqueErrors(NamedTuple):
    """Relative rms errors of the torques of the `SIDES` [1], () if not known.

    ``against``, a key of `AGAINST`, says what the torques are compared with.
    """

    against: str
    values: tuple[float, ...] = ()

    @property
    def texts(self) -> list[str]:
        return [f"{100.0 * error:.1f}{NBSP}%" for error in self.values]

    @property
    def of_axles(self) -> str:
        """Errors of both axles as text; the total is left out, as its errors can cancel."""
        return " / ".join(self.texts[:2]) if self.values else UNKNOWN

    @property
    def in_words(self) -> list[str]:
        """The errors of both axles in a phrase; [] if not known."""
        phrase = f"error front / rear {self.of_axles} against {AGAINST[self.against]}"
        return [phrase] if self.values else []


_ERRORS = ("ecu_torque_error_f", "ecu_torque_error_r", "ecu_level_error")
"""Keys of the metrics that are the errors of the `SIDES` against the truth."""


def errors(result: Validation) -> _TorqueErrors:
    """Return the errors of the ECU's torques in a stop."""
    estimate = result.estimate
    compared = estimate.ecu_valid & estimate.valid & (estimate.run.blocks.v is not None)
    return errors_in(result.figures, estimate.columns(), compared)


def errors_in(
    figures: Mapping[str, float | None], columns: Columns, compared: Mask
) -> _TorqueErrors:
    """Return the errors of the ECU's torques: against the truth if the ``figures`` have them.

    Otherwise the reference is the estimate with v, over the ``compared`` samples (n,), in which the
    ECU and that estimate are valid.
    """
    against_truth = tuple(x for x in (figures.get(key) for key in _ERRORS) if x is not None)
    if len(against_truth) == len(SIDES):
        return _TorqueErrors(TRUTH, against_truth)
    if not compared.any():
        return _TorqueErrors(NONE)
    values = []
    for ecu, best in zip(torques(columns), torques(columns, prefix=""), strict=True):
        error, reference = (ecu.value - best.value)[compared], best.value[compared]
        values.append(float(np.sqrt(np.sum(error**2) / np.sum(reference**2))))
    return _TorqueErrors(REFERENCE, tuple(values))


def true_means(result: Validation, samples: Mask) -> list[str]:
    """Return the mean true torques of the `SIDES` over ``samples`` (n,); [] where not known."""
    truth = truth_of(result.estimate)
    if truth is None or not samples.any():
        return []
    axles = 2.0 * truth.torque[:, samples].mean(axis=1)  # front and rear, two wheels each
    return [f"{value:.0f}" for value in (*axles, axles.sum())]
