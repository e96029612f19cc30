"""How an estimate stands to the pads of the plant, at the samples that it calls valid."""

from dataclasses import dataclass

import numpy as np

from calib.estimation.estimator import Estimate
from calib.logs.log import Log


@dataclass(frozen=True)
class AgainstTruth:
    """One axle at the valid samples, one value each: whether the 95 % interval holds the true pad
    friction, the relative error [1] and the half width of the interval over the estimate [1]."""

    held: np.ndarray
    error: np.ndarray
    half_width: np.ndarray


def truths_of(log: Log) -> tuple[np.ndarray, np.ndarray]:
    """The plant's pad friction at each sample, front and rear [1]."""
    return log.truth["true_mu_pad_f"], log.truth["true_mu_pad_r"]


def against_truth(
    e: Estimate, truths: tuple[np.ndarray, np.ndarray]
) -> tuple[AgainstTruth, AgainstTruth]:
    """Front and rear."""
    front, rear = (
        AgainstTruth(
            ((truth >= axle.lower) & (truth <= axle.upper))[e.valid],
            (axle.pad_friction / truth - 1.0)[e.valid],
            (0.5 * (axle.upper - axle.lower) / axle.pad_friction)[e.valid],
        )
        for axle, truth in zip((e.front, e.rear), truths, strict=True)
    )
    return front, rear


def mean(values: np.ndarray) -> float:
    """The mean; nan where no sample is valid."""
    return float(np.mean(values)) if values.size else float("nan")
