"""Brake torque of a stop: of each axle and of both together, with 95 % bounds, and its error."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import AXLE_NAMES
from calib.base.plain import NBSP
from calib.base.units import BAR
from calib.estimation.metrics import truth_of
from calib.estimation.readout import Bounded
from calib.estimation.validate import NONE, REFERENCE, TRUTH, Validation
from calib.table.table import Table

Columns = Mapping[str, Any]
"""Columns of an estimate by their names, (n,) each."""
SIDES = (*AXLE_NAMES.values(), "total")
"""An answer has a torque of the front, of the rear axle and of both."""
NOT_KNOWN = "not known"
UNIT = f"N{NBSP}m"
HEADS = tuple(f"{side} [{UNIT}]" for side in SIDES)
_WHEELS = {"fl": 2.0, "rl": 2.0, "sum": 1.0}
"""Columns of the `SIDES`, and how many times each counts: an axle has two wheels."""
AGAINST = {TRUTH: "the truth", REFERENCE: "the estimate with v", NONE: "nothing"}
"""What the torques of an ECU are compared with, in words."""
ENDS = ("", "_lower", "_upper")
"""Endings of the columns of a value and of its bounds."""


def torques(columns: Columns, prefix: str = "ecu_") -> list[Bounded]:
    """Torques of the `SIDES` [N m], (n,) each; ``prefix`` is empty for the best estimate."""
    return [
        Bounded(*(count * columns[f"{prefix}brake_torque_{part}{end}"] for end in ENDS))
        for part, count in _WHEELS.items()
    ]


def valid_samples(r: Validation) -> Mask:
    """Samples (n,) in which the ECU has a valid answer to a run that counts."""
    return r.estimate.ecu.valid & (not r.estimate.unfit)


def means(columns: Columns, valid: Mask, prefix: str = "ecu_") -> list[str]:
    """Mean torques of the `SIDES` over the ``valid`` samples, each with its 95 % interval."""
    return [_mean(*(x[valid] for x in torque)) for torque in torques(columns, prefix)]


def ecu_means(r: Validation) -> list[str]:
    """Mean torques of the ECU in a stop."""
    return means(r.estimate.columns(), valid_samples(r))


def _mean(value: Array, lower: Array, upper: Array) -> str:
    total = float(np.sum(value))
    if not total > 0.0:
        return NOT_KNOWN
    half = float(np.sum(upper - lower)) / (2.0 * value.size)
    return f"{total / value.size:.0f}{NBSP}±{NBSP}{half:.0f}"


def in_words(texts: list[str]) -> str:
    """Torques of the `SIDES` in one phrase; "" where none is known."""
    if NOT_KNOWN in texts:
        return ""
    named = ", ".join(f"{side} {text}" for side, text in zip(SIDES, texts, strict=True))
    return f"brake torque {named} {UNIT} (95{NBSP}%)"


def per_bar(table: Table) -> list[str]:
    """Torques of the axles per bar on the ramp [N m], each with its 95 % interval."""
    car, cal = table.vehicle, table.calibration
    axles = (car.front, cal.pad_friction_f), (car.rear, cal.pad_friction_r)
    gains = [(2.0 * BAR * axle.torque_gain, pad) for axle, pad in axles]
    return [
        f"{gain * pad.value:.1f}{NBSP}±{NBSP}{gain * (pad.ci95[1] - pad.value):.1f}"
        for gain, pad in gains
    ]


class _TorqueErrors(NamedTuple):
    """Relative rms errors of the torques of the `SIDES` [1], ``against`` a key of `AGAINST`."""

    against: str
    values: tuple[float, ...] = ()

    @property
    def texts(self) -> list[str]:
        """The errors of the `SIDES`."""
        return [f"{100.0 * x:.1f}{NBSP}%" for x in self.values]

    @property
    def of_axles(self) -> str:
        """The errors of both axles; that of the total shows no wrong split and no wrong mass."""
        return " / ".join(self.texts[:2]) or NOT_KNOWN


_ERRORS = ("ecu_torque_error_f", "ecu_torque_error_r", "ecu_level_error")


def errors(r: Validation) -> _TorqueErrors:
    """Errors of the ECU's torques in a stop, against the truth, or else against v."""
    against_truth = tuple(x for x in map(r.figures.get, _ERRORS) if x is not None)
    if len(against_truth) == len(SIDES):
        return _TorqueErrors(TRUTH, against_truth)
    valid = valid_samples(r) & r.estimate.valid
    if r.estimate.blocks.v is None or not valid.any():
        return _TorqueErrors(NONE)
    columns = r.estimate.columns()
    pairs = zip(torques(columns), torques(columns, ""), strict=True)
    ends = ((ecu.value[valid], best.value[valid]) for ecu, best in pairs)
    values = (float(np.sqrt(np.sum((a - b) ** 2) / np.sum(b**2))) for a, b in ends)
    return _TorqueErrors(REFERENCE, tuple(values))


def true_means(r: Validation, samples: Mask) -> list[str]:
    """Means of the true torques of the `SIDES` over some samples; empty where none is known."""
    truth = truth_of(r.estimate)
    if truth is None or not samples.any():
        return []
    axles = 2.0 * truth.torque[:, samples].mean(axis=1)
    return [f"{value:.0f}" for value in (*axles, axles.sum())]
