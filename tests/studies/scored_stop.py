"""An estimate against the truth of its stop, over all braked samples, whether it calls them valid.

Counted are the samples from 0.3 s after the first bite on, above 2 bar and 3 m/s. A sample without
an answer is one of ``answered``; errors and coverage are those of the others. All figures are means
over the samples, but the half widths, which are medians.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from calib.base.arrays import Array
from calib.base.names import WHEELS, G
from calib.car.vehicle import Vehicle
from calib.logs.log import Log

BITE, SETTLED, SLOW = 2e5, 0.3, 3.0
"""Pressure [Pa] and speed [m/s] below which nothing is counted, and the time after the bite [s]."""

DECELERATIONS = {"< .2 g": (0.0, 0.2), ".2-.4 g": (0.2, 0.4), "> .4 g": (0.4, np.inf)}
"""By the brakes' own part of it [g]."""

QUANTITIES = ("level", "ratio", "front", "rear", "torque")


@dataclass(frozen=True)
class Truth:
    """The true brakes of a stop, (n,) each.

    ``counted`` samples; ``quantities`` by name: torque over that of nominal pads, ratio of the pad
    frictions, friction of each axle [1], torque of all four brakes [N m]; ``braking``: deceleration
    by the brakes [g].
    """

    time: Array
    counted: np.ndarray
    quantities: dict[str, Array]
    braking: Array

    @classmethod
    def of_stop(cls, log: Log, car: Vehicle) -> "Truth":
        """Read ``true_Tb_*`` and ``true_mu_pad_*``; a log without the latter has them by torque
        over pressure."""
        p = log["p_mc"]
        bitten = log.time[np.argmax(p > BITE)]
        speed = log["v"] if "v" in log else car.rear.rolling_radius * log["omega_rl"]
        torques = {w: log.truth[f"true_Tb_{w}"] for w in WHEELS}
        pads = {}
        for side, axle in (("f", car.front), ("r", car.rear)):
            mean = 0.5 * (torques[f"{side}l"] + torques[f"{side}r"])
            by_torque = mean / (axle.torque_gain * np.maximum(p, BITE))
            pads[side] = log.truth.get(f"true_mu_pad_{side}", by_torque)
        total = np.sum(list(torques.values()), axis=0)
        return cls(
            time=log.time,
            counted=(p > BITE) & (log.time > bitten + SETTLED) & (speed > SLOW),
            quantities={
                "level": level(car, pads["f"], pads["r"]),
                "ratio": pads["f"] / np.where(pads["r"] > 0.0, pads["r"], np.nan),
                "front": pads["f"],
                "rear": pads["r"],
                "torque": total,
            },
            braking=total / (car.front.rolling_radius * car.mass * G),
        )


def level(car: Vehicle, front: Array, rear: Array) -> Array:
    """Return the torque of pads (n,) over that of nominal pads at the same pressure [1]."""
    gain_f, gain_r = car.front.torque_gain, car.rear.torque_gain
    nominal = gain_f * car.front.pad_friction + gain_r * car.rear.pad_friction
    return (gain_f * front + gain_r * rear) / nominal


def answer(frame: pd.DataFrame, prefix: str, car: Vehicle) -> dict[str, tuple[Array, Array, Array]]:
    """Return value and 95 % bounds of each of `QUANTITIES`, (n,); bounds without column are NaN.

    ``frame`` is that of an estimate, ``prefix`` of its columns "" or "ecu_".
    """

    def column(name: str) -> Array | None:
        full_name = f"{prefix}{name}"
        return np.asarray(frame[full_name], dtype=float) if full_name in frame else None

    def bounded(name: str, value: Array | None = None) -> tuple[Array, Array, Array]:
        values = column(name)
        middle = value if values is None else values
        nothing = np.full(len(frame), np.nan)
        low, high = column(f"{name}_lower"), column(f"{name}_upper")
        return middle, nothing if low is None else low, nothing if high is None else high

    front, rear = bounded("pad_friction_f"), bounded("pad_friction_r")
    total = np.sum([column(f"brake_torque_{w}") for w in WHEELS], axis=0)
    return {
        "level": bounded("pad_level", level(car, front[0], rear[0])),
        "ratio": bounded("pad_ratio", front[0] / rear[0]),
        "front": front,
        "rear": rear,
        "torque": bounded("brake_torque_sum", total),
    }


def estimators(columns: Iterable[str]) -> dict[str, str]:
    """Return the prefixes of an estimate's columns by the names of its estimators.

    ``best`` has a ``pad_level``, ``today`` is an older one without, ``ecu`` that of an ECU.
    """
    prefixes = {"best" if "pad_level" in columns else "today": "", "ecu": "ecu_"}
    return {name: x for name, x in prefixes.items() if f"{x}pad_friction_f" in columns}


def scored(
    frame: pd.DataFrame, prefix: str, car: Vehicle, truth: Truth
) -> Iterator[dict[str, float | str]]:
    """Return figures of an estimator on a stop: of all counted samples, then by deceleration."""
    answers = answer(frame, prefix, car)
    valid = np.asarray(frame[f"{prefix}valid"], dtype=bool)
    every = {"all": (0.0, np.inf), **DECELERATIONS}
    for name, (low, high) in every.items():
        counted = truth.counted & (truth.braking >= low) & (truth.braking < high)
        if counted.any():
            yield {"deceleration": name, **figures(answers, valid, truth, counted)}


def figures(
    answers: dict[str, tuple[Array, Array, Array]], valid: Array, truth: Truth, counted: Array
) -> dict[str, float]:
    """Return figures of the ``counted`` samples (n,).

    They are the shares answered and valid; for each of `QUANTITIES` the mean square and the mean of
    the relative error, the half width over the value, and the share of all and of valid samples
    whose bounds hold the truth [1]. A figure without samples is NaN.
    """
    values = np.array([value for name in ("front", "rear") for value in answers[name]])
    answered = counted & np.isfinite(values).all(axis=0) & np.isfinite(answers["torque"][0])
    out = {
        "samples": float(counted.sum()),
        "answered": float(answered.sum() / counted.sum()),
        "valid": float((valid & counted).sum() / counted.sum()),
    }
    for name, (value, low, high) in answers.items():
        true = truth.quantities[name]
        error = value[answered] / true[answered] - 1.0
        has_bounds = bool(np.isfinite(low[answered]).any())
        inside = (low <= true) & (true <= high)
        out[f"square {name}"] = mean(error**2)
        out[f"bias {name}"] = mean(error)
        out[f"held {name}"] = mean(inside[answered]) if has_bounds else np.nan
        out[f"held valid {name}"] = mean(inside[answered & valid]) if has_bounds else np.nan
        half = 0.5 * (high - low)[answered] / value[answered]
        out[f"half {name}"] = float(np.median(half)) if has_bounds else np.nan
    return out


def mean(values: Array) -> float:
    """Return the mean; NaN without values, and without a warning."""
    return float(np.mean(values)) if values.size else np.nan
