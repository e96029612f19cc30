"""Metrics of an estimate: errors against truth where the log has it, else its consistency.

Two answers are scored by the same functions: the best one, of all channels, and with ``ecu_``
before its metrics what the table gives without a reference speed, which is handed out.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.plain import meanings
from calib.car.braking import MOVING
from calib.car.vehicle import Vehicle
from calib.estimation.estimator import Estimate
from calib.estimation.readout import Bounded, Readout
from calib.logs.log import Log

METRICS: dict[str, str] = meanings("stop")
"""Every metric of a validation, with its meaning."""

Figures = dict[str, float | None]

_FEWEST = 30
"""Least number of samples of a mean."""


@dataclass(frozen=True)
class _AxleTruth:
    """Truth of one axle, (n,): pad friction [1], torque of one wheel [N m].

    Pad friction is NaN where there is none to compare with.
    """

    pad_friction: Array
    torque: Array


def truth_of(
    log: Log, vehicle: Vehicle, estimate: Estimate
) -> tuple[_AxleTruth, _AxleTruth] | None:
    """Truth of both axles where the log has wheel torques; None otherwise.

    Without a truth channel for the pads it follows from (2) with the vehicle's geometry.
    """
    if "true_Tb_fl" not in log.truth or "true_Tb_rl" not in log.truth:
        return None
    out = []
    for side, axle, p, factor in (
        ("f", vehicle.front, estimate.read.p_f, estimate.ran.factor_f),
        ("r", vehicle.rear, estimate.read.p_r, estimate.ran.factor_r),
    ):
        torque = 0.5 * (log.truth[f"true_Tb_{side}l"] + log.truth[f"true_Tb_{side}r"])
        known = log.truth.get(f"true_mu_pad_{side}")
        if known is not None:
            pads = known / factor
        else:
            pads = torque / (axle.torque_gain * np.where(p > 1e5, p, np.nan))
        out.append(_AxleTruth(np.where(pads > 0.0, pads, np.nan), torque))
    return out[0], out[1]


class _Quantity(NamedTuple):
    """What an answer says of one axle ("f", "r") or of both ("level"), beside the truth, (n,).

    ``x`` pad friction or pad level [1]; ``torque`` of a wheel, or of all [N m].
    """

    x: Bounded
    torque: Array
    true: Array | None = None
    true_torque: Array | None = None


_NAMES = {
    "pad_friction_level": "pad_level",
    "ecu_pad_friction_level": "ecu_pad_level",
    "ecu_torque_error_level": "ecu_level_error",
    "ecu_truth_f": "true_pad_friction_f",
    "ecu_truth_r": "true_pad_friction_r",
    "ecu_truth_level": "true_pad_level",
}
"""Names that are not that of the quantity behind that of the answer."""


def score(log: Log, vehicle: Vehicle, e: Estimate) -> Figures:
    """All `METRICS` of one log; None where the log cannot give one."""
    truth, counted = truth_of(log, vehicle, e), counted_samples(e)
    figures: Figures = {"eta_zero": vehicle.radius_mismatch(e.eta_zero), **_innovation(e)}
    if (e.valid & counted).any():
        covered = np.maximum(*e.normalised) <= e.table.tyre.force[-1]
        figures["covered_share"] = share(e.valid & counted & covered, e.valid & counted)
    # torques of the best answer count wherever the brakes bite, those of the ECU where it is valid
    for of, answer, valid, told in (
        ("", e.best, e.valid & counted, counted & np.isfinite(e.best.pads_f.value)),
        ("ecu_", e.ecu, e.ecu.valid & counted, e.ecu.valid & counted),
    ):
        figures[f"{of}valid_share"] = share(valid, counted)
        for side, quantity in _quantities(answer, truth).items():
            for name, value in _of_quantity(quantity, valid, told).items():
                key = f"{of}{name}_{side}"
                figures[_NAMES.get(key, key)] = value
    both = e.valid & e.ecu.valid & counted
    if e.blocks.v is not None and both.any():
        figures["ecu_reference_f"] = departure(e.ecu.pads_f, e.best.pads_f, both)
        figures["ecu_reference_r"] = departure(e.ecu.pads_r, e.best.pads_r, both)
    if truth is not None and (e.valid & counted).any():
        inside = [figures.get(f"inside_{side}") or 0.0 for side in "fr"]
        figures["truth_in_interval"] = float(np.mean(inside))
    return {name: figures.get(name) for name in METRICS}


def counted_samples(e: Estimate) -> Mask:
    """Braked samples above 3 m/s (n,), of which the shares are."""
    return e.braked & (e.read.speed > MOVING)


def _quantities(of: Readout, truth: tuple[_AxleTruth, _AxleTruth] | None) -> dict[str, _Quantity]:
    front, rear = (of.pads_f, of.torque_f.value), (of.pads_r, of.torque_r.value)
    both = of.level, of.torque_sum.value
    if truth is None:
        return {"f": _Quantity(*front), "r": _Quantity(*rear), "level": _Quantity(*both)}
    total = 2.0 * (truth[0].torque + truth[1].torque)
    with np.errstate(divide="ignore", invalid="ignore"):
        level = of.level.value * total / of.torque_sum.value
    return {
        "f": _Quantity(*front, truth[0].pad_friction, truth[0].torque),
        "r": _Quantity(*rear, truth[1].pad_friction, truth[1].torque),
        "level": _Quantity(*both, level, total),
    }


def _of_quantity(q: _Quantity, valid: Mask, told: Mask) -> Figures:
    """Its metrics over the ``valid`` samples; torques, and the last error, of those ``told``."""
    out: Figures = {}
    x = q.x.value[valid]
    if x.size >= _FEWEST:
        third = x.size // 3
        out = {
            "pad_friction": float(np.mean(x)),
            "pad_friction_drift": abs(float(np.mean(x[-third:]) / np.mean(x[:third]) - 1.0)),
            "interval": float(np.median(0.5 * (q.x.upper - q.x.lower)[valid] / x)),
        }
    true, true_torque = q.true, q.true_torque
    if true is None or true_torque is None or not valid.any():
        return out
    scale = _rms(true_torque[told])
    with np.errstate(divide="ignore", invalid="ignore"):
        over = q.x.value / true
        found = {
            "torque_error": _rms((q.torque - true_torque)[told]) / (scale or np.nan),
            "pad_friction_bias": abs(np.mean(over[valid] - 1.0)),
            "final_error": abs(over[told][-1] - 1.0),
            "inside": np.mean(((true >= q.x.lower) & (true <= q.x.upper))[valid]),
        }
        rest, known = q.x.deviations(true), valid & np.isfinite(true) & (true > 0.0)
    if known.any():
        found |= {"normalised_error": _rms(rest[known]), "truth": np.mean(true[known])}
    return out | {name: float(value) for name, value in found.items() if np.isfinite(value)}


def _innovation(e: Estimate) -> Figures:
    """Size and colour of the errors of prediction, of blocks above 3 m/s after the lead-in."""
    of_blocks = e.best.step.innovation[e.blocks.samples - 1 :: e.blocks.samples]
    told = of_blocks[~e.blocks.lead_in & (e.blocks.speed > MOVING)]
    told = told[np.isfinite(told)]
    if told.size <= 10:
        return {}
    colour = float(np.mean(told[1:] * told[:-1]))
    return {"innovation_rms": _rms(told), "innovation_colour": colour}


def departure(ecu: Bounded, best: Bounded, valid: Mask) -> float:
    """Rms of ln(ecu/best) over the standard deviation of this difference [1].

    Both are means over the same draws of the ramp; the second one has seen v, too. So

        var(best - ecu) = var(truth given what the ECU sees) - var(truth given v, too)

    and the errors of the ramp, which both share, drop out: it can show that v and the maps
    contradict each other, not that the ramp was wrong. Bounds are those of medians between cells,
    and v need not narrow them: the spread is at least half of the ECU's own, as a difference that
    is small against the interval that is handed out does no harm.
    """
    own, other = ecu.sigma[valid], best.sigma[valid]
    spread = np.sqrt(np.maximum(own**2 - other**2, (0.5 * own) ** 2))
    return _rms(np.log(ecu.value / best.value)[valid] / spread)


def share(part: Mask, whole: Mask) -> float:
    """Share of a part of the ``whole`` [1]; 0 of nothing, which must not pass."""
    return float(np.sum(part)) / max(float(np.sum(whole)), 1.0)


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


def baseline_errors(
    e: Estimate,
    truth: tuple[_AxleTruth, _AxleTruth] | None,
    others: dict[str, tuple[Array, Array]],
) -> dict[str, tuple[float, float]]:
    """Rms relative error of the pad friction of each method, front and rear, over valid samples.

    ``others`` the pad friction of those beside the estimate (n,), front and rear.

    Without a truth it is against the best estimate, where that has seen v; else there are none.
    """
    best = e.best.pads_f.value, e.best.pads_r.value
    methods = {"ecu": (e.ecu.pads_f.value, e.ecu.pads_r.value), **others}
    if truth is not None:
        methods = {"estimate": best, **methods}
    true = np.array(best if truth is None else [axle.pad_friction for axle in truth])
    known = e.valid & np.isfinite(true).all(axis=0)
    if not known.any() or (truth is None and e.blocks.v is None):
        return {}
    errors = {name: (np.array(pads) / true - 1.0)[:, known] for name, pads in methods.items()}
    return {name: (_rms(front), _rms(rear)) for name, (front, rear) in errors.items()}
