"""Metrics of an estimate: errors against the truth of the log if known, else consistency.

Two answers are scored alike: the best answer, by all channels, and the answer of an ECU without v,
whose metrics begin with ``ecu_``. At the end: errors of other methods, and variances by cause.
"""

from typing import Any, NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.plain import finite_or_none, meanings
from calib.car.balance import front_share
from calib.car.braking import MOVING
from calib.estimation.baselines import METHODS
from calib.estimation.estimator import Estimate
from calib.estimation.readout import Bounded, Readout
from calib.table.budget import Parts, deviations

METRICS: dict[str, str] = meanings("stop")  # all metrics of a validation, with their meanings
Figures = dict[str, float | None]
_FEWEST = 30  # least number of samples of a mean


class Truth(NamedTuple):
    """Truth of front and rear axle, (2, n) each."""

    pad_friction: Array  # [1], NaN where not known
    torque: Array  # mean of the left and the right wheel [N m]


def truth_of(e: Estimate) -> Truth | None:
    """Return the truth of both axles if the log has the torque of its wheels, else None."""
    channels, car = e.corrected.log.truth, e.car
    if "true_Tb_fl" not in channels or "true_Tb_rl" not in channels:
        return None
    wheels = np.array([[channels[f"true_Tb_{axle}{side}"] for side in "lr"] for axle in "fr"])
    torque = 0.5 * (wheels[:, 0] + wheels[:, 1])
    # without truth channels of the pads, their friction follows from (2) with the car's geometry
    p = np.array([e.signals.p_f, e.signals.p_r])
    gain = np.array([[car.front.torque_gain], [car.rear.torque_gain]])
    pads = torque / (gain * np.where(p > 1e5, p, np.nan))
    for i, (axle, factor) in enumerate((("f", e.corrected.factor_f), ("r", e.corrected.factor_r))):
        if f"true_mu_pad_{axle}" in channels:
            pads[i] = channels[f"true_mu_pad_{axle}"] / factor
    return Truth(np.where(pads > 0.0, pads, np.nan), torque)


_SIDES = ("f", "r", "level")  # an answer is scored for each axle and for both together
_SHORTER = {
    "pad_friction_level": "pad_level",
    "torque_error_level": "level_error",
    "ecu_truth": "true",
}
"""`score` composes the name of a metric; these parts of the name are shorter in its key."""


def score(e: Estimate) -> Figures:
    """Return all `METRICS` of one log, None for those that the log cannot give."""
    truth, counted = truth_of(e), counted_samples(e)
    valid, by_ecu = e.valid & counted, e.ecu_valid & counted
    figures: dict[str, Any] = {
        "eta_zero": e.car.radius_mismatch(e.zeros[0] - 1.0),
        "valid_share": share(valid, counted),
        "ecu_valid_share": share(by_ecu, counted),
    }
    # innovations of blocks above 3 m/s after the lead-in
    b = e.run.blocks
    innovation = e.best.step.innovation[np.searchsorted(e.time, b.end)]
    innovation = innovation[np.isfinite(innovation) & ~b.lead_in & (b.speed > MOVING)]
    if innovation.size > 10:
        figures["innovation_rms"] = _rms(innovation)
        figures["innovation_colour"] = np.mean(innovation[1:] * innovation[:-1])
    # torques of the best answer count wherever the brakes bite, those of the ECU where it is valid
    bites = counted & np.isfinite(e.best.pads_f.value)
    answers = ("", e.best, valid, bites), ("ecu_", e.ecu, by_ecu, by_ecu)
    for prefix, answer, use_pads, use_torques in answers:
        for metric, values in _of_answer(answer, truth, use_pads, use_torques).items():
            for side, value in zip(_SIDES, values, strict=True):
                figures[f"{prefix}{metric}_{side}"] = value
    if valid.any():
        covered = np.maximum(*e.normalised) <= e.table.tyre.force[-1]
        figures["covered_share"] = share(covered, valid)
    if "inside_f" in figures:
        figures["truth_in_interval"] = 0.5 * (figures["inside_f"] + figures["inside_r"])
    comparable = valid & by_ecu
    if e.run.blocks.v is not None and comparable.any():
        figures["ecu_reference_f"] = departure(e.ecu.pads_f, e.best.pads_f, comparable)
        figures["ecu_reference_r"] = departure(e.ecu.pads_r, e.best.pads_r, comparable)
    for part, shorter in _SHORTER.items():
        figures = {name.replace(part, shorter): value for name, value in figures.items()}
    return {key: finite_or_none(figures.get(key)) for key in METRICS}


def counted_samples(e: Estimate) -> Mask:
    """Return the braked samples above 3 m/s (n,), to which shares refer."""
    return e.braked & (e.signals.speed > MOVING)


def share(part: Mask, whole: Mask) -> float:
    """Return the share of ``part`` in the ``whole`` [1]; 0 of nothing, which must not pass."""
    return float(np.sum(part & whole)) / max(float(np.sum(whole)), 1.0)


def _of_answer(
    answer: Readout, truth: Truth | None, valid: Mask, counted: Mask
) -> dict[str, Array]:
    """Return metrics by side (3,): of pads over ``valid`` samples, of torques over ``counted``."""
    metrics: dict[str, Array] = {}
    pads = np.array([answer.pads_f, answer.pads_r, answer.level])  # (side, value and bounds, n)
    at_valid = pads[..., valid]
    x = Bounded(at_valid[:, 0], at_valid[:, 1], at_valid[:, 2])  # (side, n valid) each
    third = x.value.shape[1] // 3  # samples in a third of the stop
    if 3 * third >= _FEWEST:
        first, last = x.value[:, :third].mean(axis=1), x.value[:, -third:].mean(axis=1)
        metrics["pad_friction"] = x.value.mean(axis=1)
        metrics["pad_friction_drift"] = np.abs(last / first - 1.0)
        metrics["interval"] = np.median(0.5 * (x.upper - x.lower) / x.value, axis=1)
    if truth is None or not valid.any():
        return metrics
    torque = np.array([answer.torque_f.value, answer.torque_r.value, answer.torque_sum.value])
    true_torque = np.vstack([truth.torque, 2.0 * truth.torque.sum(axis=0)])
    with np.errstate(divide="ignore", invalid="ignore"):
        level = answer.level.value * true_torque[2] / torque[2]
        true_pads = np.vstack([truth.pad_friction, level])
        true = true_pads[:, valid]
        comparable = np.isfinite(true) & (true > 0.0)
        errors = np.where(comparable, x.deviations(true), 0.0)
        count = comparable.sum(axis=1)
        error = _rms((torque - true_torque)[:, counted])
        last = np.flatnonzero(counted)[-1]
        return metrics | {
            "torque_error": error / _rms(true_torque[:, counted]),
            "pad_friction_bias": np.abs((x.value / true - 1.0).mean(axis=1)),
            "final_error": np.abs(pads[:, 0, last] / true_pads[:, last] - 1.0),
            "inside": ((true >= x.lower) & (true <= x.upper)).mean(axis=1),
            "normalised_error": np.sqrt(np.square(errors).sum(axis=1) / count),
            "truth_pad_friction": np.where(comparable, true, 0.0).sum(axis=1) / count,
        }


def departure(ecu: Bounded, best: Bounded, valid: Mask) -> float:
    """Return the rms of ln(ecu/best) over its standard deviation [1], at ``valid`` samples.

    Both answers are means over the same draws of the ramp, and ``best`` knows v as well. So

        var(ln best - ln ecu) = var(ln truth | channels of the ECU) - var(ln truth | v as well)

    and common errors of the ramp cancel. The standard deviation counts as at least half of the
    ECU's, since interpolated bounds need not get narrower by v.
    """
    of_ecu, of_best = ecu.sigma[valid], best.sigma[valid]
    spread = np.sqrt(np.maximum(of_ecu**2 - of_best**2, (0.5 * of_ecu) ** 2))
    return float(_rms(np.log(ecu.value / best.value)[valid] / spread))


def _rms(x: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(np.square(x), axis=-1)))


def baseline_errors(e: Estimate) -> dict[str, tuple[float, float]]:
    """Return the rms relative error of front and rear pad friction by method, at valid samples.

    Without a truth the errors are those against the best estimate, and there are none without v.
    A method that gives NaN is left out.
    """
    truth = truth_of(e)
    best, ecu = ((x.pads_f.value, x.pads_r.value) for x in (e.best, e.ecu))
    true = np.array(best) if truth is None else truth.pad_friction
    comparable = e.valid & np.isfinite(true).all(axis=0)
    if not comparable.any() or (truth is None and e.run.blocks.v is None):
        return {}
    methods = {"ecu": ecu} if truth is None else {"estimate": best, "ecu": ecu}
    methods |= {name: method(e) for name, method in METHODS.items()}
    errors = {name: _rms((np.array(x) / true - 1.0)[:, comparable]) for name, x in methods.items()}
    return {name: (float(x[0]), float(x[1])) for name, x in errors.items() if np.isfinite(x).all()}


def budget(e: Estimate) -> tuple[Parts, Parts] | None:
    """Return the standard deviation of front and of rear pads by cause; None without valid samples.

        ln mu = ln level + lever ln ratio     lever: brake share of the other axle; rear: negative

    Causes of errors of the level: mass and resistance, accelerometer, noise. Causes of errors of
    the ratio: eta, tyres and pads on the ramp, and changes in the stop. The squares add up to the
    variance at the valid sample with the median interval of the axle.
    """
    if not e.valid.any():
        return None
    return _of_axle(e, e.best.pads_f, 0), _of_axle(e, e.best.pads_r, 1)


def _of_axle(e: Estimate, pads: Bounded, axle: int) -> Parts:
    """Return the budget of the ``pads`` of an axle, 0 for the front one and 1 for the rear one."""
    step, draws = e.best.step, e.table.draws
    order = np.argsort(np.where(e.valid, pads.upper / pads.lower, np.inf), kind="stable")
    i = order[(np.count_nonzero(e.valid) - 1) // 2]  # the median, the narrower of two
    front = front_share(e.table.vehicle, float(step.ratio[0, i]))
    squared_lever = (1.0 - front, front)[axle] ** 2
    ramp = squared_lever * np.var(draws.log_pad_ratio)
    total, level = (x.sigma[i] ** 2 for x in (pads, e.best.level))
    # the last cause of level and of ratio takes the remainder of the variance
    of_level = ("accelerometer", step.accelerometer[i]), ("noise", step.noise[i]), ("mass", np.inf)
    of_ratio = ("zeros", squared_lever * step.zeros[i]), ("tyres", ramp), ("unlike_pads", np.inf)
    variances = {}
    for variance, causes in ((level, of_level), (total - level, of_ratio)):
        unexplained = max(float(variance), 0.0)
        for part, known in causes:
            variances[part] = min(float(known), unexplained)
            unexplained -= variances[part]
    return deviations(variances)
