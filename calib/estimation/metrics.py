"""Metrics of an estimate: errors against truth where the log has it, else its consistency.

Those with ``ecu_`` are of what the table gives without a reference speed, over the samples that it
calls valid: what is handed out. The others are of the best estimate, of all channels.

Constancy of the pad friction within a stop, whiteness of the innovation and coverage of the table
can be computed for any log. The force sum is reported but never judged: with (18) it equals M a_x
for any table.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.plain import meanings
from calib.car.vehicle import Axle, Vehicle
from calib.estimation.estimator import Estimate
from calib.estimation.readout import Bounded
from calib.logs.log import Log

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

METRICS: dict[str, str] = meanings("stop")
"""Every metric of a validation, with its meaning."""

_FEWEST = 30
"""Least number of samples of a mean."""


@dataclass(frozen=True)
class _AxleTruth:
    """Truth of one axle: pad friction [1], torque of one wheel [N m], tyre force [N] or None.

    Pad friction is NaN where there is none to compare with.
    """

    pad_friction: Array
    torque: Array
    force: Array | None


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
        ("f", vehicle.front, estimate.pressure_f, estimate.factor_f),
        ("r", vehicle.rear, estimate.pressure_r, estimate.factor_r),
    ):
        torque = 0.5 * (log.truth[f"true_Tb_{side}l"] + log.truth[f"true_Tb_{side}r"])
        known = log.truth.get(f"true_mu_pad_{side}")
        if known is not None:
            pads = known / factor
        else:
            pads = torque / (axle.torque_gain * np.where(p > 1e5, p, np.nan))
        pads = np.where(pads > 0.0, pads, np.nan)
        left, right = (log.truth.get(f"true_Fx_{side}{k}") for k in "lr")
        force = None if left is None or right is None else np.abs(left + right)
        out.append(_AxleTruth(pads, torque, force))
    return out[0], out[1]


def score(log: Log, vehicle: Vehicle, estimate: Estimate) -> dict[str, float | None]:
    """All `METRICS` of one log; None where the log cannot give one."""
    figures: dict[str, float | None] = dict.fromkeys(METRICS)
    figures |= consistency(vehicle, estimate) | of_ecu(estimate)
    truth = truth_of(log, vehicle, estimate)
    if truth is not None:
        figures |= ecu_errors(estimate, truth)
        if estimate.valid.any():
            figures |= accuracy(vehicle, estimate, truth)
    return figures


def consistency(vehicle: Vehicle, e: Estimate) -> dict[str, float | None]:
    """Metrics that need no truth."""
    counted = _counted(e)
    valid = e.valid & counted
    out: dict[str, float | None] = {
        # 0, not None: a stop in which nothing can be judged must not pass
        "valid_share": _share(valid, counted) or 0.0,
        "covered_share": _share(valid & e.covered, valid),
        "eta_zero": vehicle.radius_mismatch(e.eta_zero),
        "force_sum_error": force_sum_error(vehicle, e),
    }
    for side, pads in (("f", e.best.pads_f), ("r", e.best.pads_r)):
        mu = pads.value[valid]
        if mu.size >= _FEWEST:
            third = mu.size // 3
            drift = np.mean(mu[-third:]) / np.mean(mu[:third]) - 1.0
            width = 0.5 * (pads.upper - pads.lower)[valid] / mu
            out[f"pad_friction_{side}"] = float(np.mean(mu))
            out[f"pad_friction_drift_{side}"] = abs(float(drift))
            out[f"interval_{side}"] = float(np.median(width))
    if np.count_nonzero(valid) >= _FEWEST:
        out["pad_level"], out["interval_level"] = _mean_and_width(e.best.level, valid)
    innovation = e.best.innovation[~e.blocks.lead_in & (e.blocks.speed > 3.0)]
    innovation = innovation[np.isfinite(innovation)]
    if innovation.size > 10:
        out["innovation_rms"] = float(np.sqrt(np.mean(innovation**2)))
        centred = innovation - np.mean(innovation)
        out["innovation_lag1"] = float(centred[1:] @ centred[:-1] / (centred @ centred))
        out["innovation_colour"] = float(np.mean(innovation[1:] * innovation[:-1]))
    return out


def _counted(e: Estimate) -> Mask:
    """Braked samples above 3 m/s, of which the shares are."""
    return e.braked & (e.speed > 3.0)


def _told(e: Estimate) -> Mask:
    """Samples for which the ECU has a valid answer."""
    return e.ecu.valid & _counted(e)


def of_ecu(e: Estimate) -> dict[str, float | None]:
    """Metrics of what is handed out that need no truth."""
    told, ecu, best = _told(e), e.ecu, e.best
    out: dict[str, float | None] = {"ecu_valid_share": _share(told, _counted(e)) or 0.0}
    if np.count_nonzero(told) < _FEWEST:
        return out
    for name, side, x in (
        ("pad_friction_f", "f", ecu.pads_f),
        ("pad_friction_r", "r", ecu.pads_r),
        ("pad_level", "level", ecu.level),
    ):
        out[f"ecu_{name}"], out[f"ecu_interval_{side}"] = _mean_and_width(x, told)
    both = told & e.valid
    if e.blocks.v is not None and both.any():
        out["ecu_reference_f"] = departure(ecu.pads_f, best.pads_f, both)
        out["ecu_reference_r"] = departure(ecu.pads_r, best.pads_r, both)
    return out


def _mean_and_width(x: Bounded, valid: Mask) -> tuple[float, float]:
    """Mean of a quantity, and the median half width of its interval, relative [1]."""
    mean, half = x.value[valid], 0.5 * (x.upper - x.lower)[valid]
    return float(np.mean(mean)), float(np.median(half / mean))


def departure(ecu: Bounded, best: Bounded, valid: Mask) -> float:
    """Rms of ln(ecu/best) over the standard deviation of this difference [1].

    Both answers are means over the same draws of the ramp; the second one has seen v, too. Then by
    the law of total variance

        var(best - ecu) = var(truth given what the ECU sees) - var(truth given v, too)

    since best - ecu and truth - best are uncorrelated: what is common, the errors of the ramp,
    drops out. With it the consistency can show that v and the maps contradict each other, and
    cannot show that the ramp was wrong.

    Bounds are those of medians, from two maps between cells, and v need not narrow them. So the
    spread is at least half of the ECU's own: a difference that small against the interval
    that is handed out does no harm. Not to be read where v is wrong: then ``best`` is.
    """
    own, other = ecu.sigma[valid], best.sigma[valid]
    spread = np.sqrt(np.maximum(own**2 - other**2, (0.5 * own) ** 2))
    return _rms(np.log(ecu.value / best.value)[valid] / spread)


def ecu_errors(e: Estimate, truth: tuple[_AxleTruth, _AxleTruth]) -> dict[str, float | None]:
    """Metrics of what is handed out against truth, over the valid samples of the ECU.

    The normalised errors are over the sigma of each sample. Samples of a stop share their error, so
    it is one draw: one stop in 22 is beyond 2, and one in 370 beyond 3. None without a sample in
    which the truth is known and positive.
    """
    ecu = e.ecu
    total = 2.0 * (truth[0].torque + truth[1].torque)
    with np.errstate(divide="ignore", invalid="ignore"):
        level = ecu.level.value * total / ecu.torque_sum.value
    out: dict[str, float | None] = {}
    for side, name, x, true, torque, true_torque in (
        ("f", "torque_error_f", ecu.pads_f, truth[0].pad_friction, ecu.torque_f, truth[0].torque),
        ("r", "torque_error_r", ecu.pads_r, truth[1].pad_friction, ecu.torque_r, truth[1].torque),
        ("level", "level_error", ecu.level, level, ecu.torque_sum, total),
    ):
        known = _told(e) & np.isfinite(true) & (true > 0.0)
        if not known.any():
            continue
        rest = np.log(x.value[known] / true[known]) / x.sigma[known]
        mean = "true_pad_level" if side == "level" else f"true_pad_friction_{side}"
        out[mean] = float(np.mean(true[known]))
        error = _rms((torque.value - true_torque)[known])
        out[f"ecu_{name}"] = _ratio(error, _rms(true_torque[known]))
        out[f"ecu_normalised_error_{side}"] = _rms(rest)
    return out


def _share(part: Mask, whole: Mask) -> float | None:
    return float(np.sum(part) / np.sum(whole)) if whole.any() else None


def force_sum_error(vehicle: Vehicle, e: Estimate) -> float | None:
    """Rms of (F_xf + F_xr)/(M a_x) - 1 over valid samples: Fig. 13(f). It validates nothing."""
    slowing = e.valid & (e.z > 0.0)
    if not slowing.any():
        return None
    total = sum(
        2.0 * torque.value / axle.rolling_radius
        for torque, axle in ((e.best.torque_f, vehicle.front), (e.best.torque_r, vehicle.rear))
    )
    error = np.asarray(total)[slowing] / (vehicle.weight * e.z[slowing]) - 1.0
    return float(np.sqrt(np.mean(error**2)))


def accuracy(
    vehicle: Vehicle, e: Estimate, truth: tuple[_AxleTruth, _AxleTruth]
) -> dict[str, float | None]:
    """Metrics against truth, over the braked samples above 3 m/s or the valid ones, see `METRICS`.

    None where the truth is zero throughout, as no relative error exists.
    """
    from calib.car.forces import axle_loads

    valid = e.valid
    braked = _counted(e) & np.isfinite(e.best.pads_f.value)
    out: dict[str, float | None] = {}
    inside, own, nominal = [], [], []
    loads = axle_loads(vehicle, e.z)
    best = e.best
    for i, (side, pads, torque, force, axle) in enumerate(
        (
            ("f", best.pads_f, best.torque_f, e.force_f, vehicle.front),
            ("r", best.pads_r, best.torque_r, e.force_r, vehicle.rear),
        )
    ):
        t = truth[i]
        error = pads.value / t.pad_friction - 1.0
        scale = float(np.sqrt(np.mean(t.torque[braked] ** 2)))
        out[f"torque_error_{side}"] = _ratio(_rms((torque.value - t.torque)[braked]), scale)
        out[f"pad_friction_bias_{side}"] = abs(float(np.mean(error[valid])))
        last = np.flatnonzero(braked)[-1]
        out[f"final_error_{side}"] = abs(float(error[last]))
        if t.force is not None:
            F = t.force / loads[i]
            out[f"normalised_force_rmse_{side}"] = _rms((force - F)[braked])
        inside.append(((t.pad_friction >= pads.lower) & (t.pad_friction <= pads.upper))[valid])
        own.append((torque.value - t.torque)[braked])
        nominal.append((_nominal_torque(e, side, axle) - t.torque)[braked])
    out["truth_in_interval"] = float(np.mean(np.concatenate(inside)))
    out["gain_over_nominal"] = _ratio(_rms(np.concatenate(nominal)), _rms(np.concatenate(own)))
    return {name: x if x is not None and np.isfinite(x) else None for name, x in out.items()}


def _ratio(a: float, b: float) -> float | None:
    return a / b if b > 0.0 else None


def _nominal_torque(e: Estimate, side: str, axle: Axle) -> Array:
    mu = e.baselines["nominal"][0 if side == "f" else 1]
    return mu * axle.torque_gain * (e.pressure_f if side == "f" else e.pressure_r)


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


def baseline_errors(
    vehicle: Vehicle, e: Estimate, truth: tuple[_AxleTruth, _AxleTruth]
) -> dict[str, tuple[float, float]]:
    """Rms relative error of the pad friction of each method, front and rear, over valid samples."""
    methods: dict[str, tuple[Array, Array]] = {
        "kalman": (e.best.pads_f.value, e.best.pads_r.value),
        "ecu": (e.ecu.pads_f.value, e.ecu.pads_r.value),
        **e.baselines,
    }
    return {
        name: (
            _rms((front / truth[0].pad_friction - 1.0)[e.valid]),
            _rms((rear / truth[1].pad_friction - 1.0)[e.valid]),
        )
        for name, (front, rear) in methods.items()
    }
