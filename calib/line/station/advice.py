"""Default limits, the reasons for them, and the next step where one is not held.

Every limit has a next step, so that the operator knows what to do with the car.
"""

from dataclasses import dataclass

from calib.car.plausible import LEAST_FRONT_BIASED, UNCONTROLLED
from calib.estimation.limits import DEFAULTS, Limit
from calib.estimation.validate import DEPARTURE_F, DEPARTURE_R


@dataclass(frozen=True)
class Advice:
    """Default ``limit``, the ``reason`` for it, and the ``action`` where it is not held."""

    limit: Limit
    unit: str
    reason: str
    action: str


def _row(
    figure: str, fail: tuple[float | None, float | None], warn: tuple[float | None, float | None],
    unit: str, reason: str, action: str, *, required: bool = False,
) -> Advice:  # fmt: skip
    return Advice(Limit(figure, *fail, *warn, required), unit, reason, action)


def _as_validate(figure: str, reason: str, action: str) -> Advice:
    """One limit for a stop, whichever command judges it."""
    limit = next(limit for limit in DEFAULTS if limit.figure == figure)
    return Advice(limit, "1", reason, action)


_DRIVE_RAMP = (
    "Drive the ramp again: a second of coasting, then pressure rising over 3 to 8 s to 0.5 g."
)
_PADS = "Look at pads, discs and calipers of the car, and whether the vehicle file is of this model"
_SAME = "Drive two stops again with warm, dry pads on one road; if they still differ, look at"
_RARE = (
    "one good car in 370 is farther away; only a golden table made by tables merge knows its fleet"
)

ADVICE: tuple[Advice, ...] = (
    _row("ramp_deceleration", (0.35, None), (0.40, None), "g",
         "the table ends where the ramp ends; beyond it an ECU uses the end value",
         "Drive the ramp again, up to 0.4 g or more.", required=True),
    _row("measured_share", (0.50, None), (0.55, None), "1",
         "rows that were not measured are interpolated", _DRIVE_RAMP, required=True),
    _row("band_width", (None, 0.80), (None, 0.60), "1",
         "without v pads and tyres can hardly be told apart: 0.6; with v usually 0.35",
         "Drive a second ramp and give it with --ramp; log the wheel speeds with a finer step.",
         required=True),
    _row("ramp_eta_zero", (-0.010, 0.010), (-0.005, 0.005), "1",
         "it is zeroed, but tyres of one type differ by a few mm in radius at most",
         "Check tyre pressures and sizes on both axles."),
    _row("pad_scale", (0.80, 1.20), (0.88, 1.13), "1",
         "pads of one grade scatter by 10 %; 20 % means another pad, piston or disc",
         f"{_PADS}: both axles brake harder or softer than it says.", required=True),
    _row("pad_ratio", (0.80, 1.25), (0.90, 1.12), "1",
         "different pads on the axles change the distribution and the front bias",
         f"{_PADS}: one axle brakes out of proportion to the other."),
    _row("side_difference_f", (-0.20, 0.20), (-0.10, 0.10), "1",
         "in-service inspection rejects 30 % across an axle; a new car starts well below",
         "Look at the front calipers and pads, left against right, and drive straight on a level "
         "lane: a bend looks the same."),
    _row("side_difference_r", (-0.25, 0.25), (-0.15, 0.15), "1",
         "as at the front; rear slip is smaller, so the value is less exact",
         "Look at the rear calipers and the parking brake, left against right."),
    _row("front_biased_up_to", (LEAST_FRONT_BIASED, None), (UNCONTROLLED, None), "g",
         "beyond it the rear axle locks first; cars with control of the rear pressure have 0.4 or "
         "more by design, see vehicle check; a car without it should fail below 0.5",
         "Look at the rear brakes: they brake too hard for their load. Do not release the car.",
         required=True),
    _row("repeatability_f", (None, 0.15), (None, DEPARTURE_F), "1",
         "stops with the same pads must agree; this is not so with wet pads or another load",
         f"{_SAME} the front calipers."),
    _row("repeatability_r", (None, 0.30), (None, DEPARTURE_R), "1",
         "as at the front, with a weaker signal",
         f"{_SAME} the rear calipers."),
    _row("golden_distance", (None, 0.30), (None, 0.20), "1",
         "cars of one model on one track agree within their bands",
         "Compare with brake-cal tables diff: other tyres, a wet track or other brakes?"),
    _row("golden_bands", (None, 4.0), (None, 2.5), "1",
         "above 1 the difference is significant, but need not be large",
         "Compare with brake-cal tables diff: other tyres, a wet track or other brakes?"),
    _row("golden_pads_f", (-0.25, 0.25), (-0.15, 0.15), "1",
         "pads of one grade scatter by 10 % from car to car",
         "Look at the front pads and calipers, the scale of p_mc and the load of the car."),
    _row("golden_pads_r", (-0.25, 0.25), (-0.15, 0.15), "1",
         "as at the front",
         "Look at the rear pads and calipers, the scale of p_mc and the load of the car."),
    _row("golden_stiffness", (-0.40, 0.60), (-0.25, 0.35), "1",
         "tyres of one type on one track agree within their bands; a wet track is softer",
         "Look at type and pressure of the tyres, the track, and the wheel speed sensors."),
    _row("golden_sigma_d", (None, None), (-3.0, 3.0), "sigma", _RARE,
         "Compare with brake-cal tables diff: other tyres, a wet track or other brakes?"),
    _row("golden_sigma_level", (None, None), (-3.0, 3.0), "sigma", _RARE,
         "Look at pads, the scale of p_mc and the load of the car."),
    _row("golden_sigma_ratio", (None, None), (-3.0, 3.0), "sigma", _RARE,
         "Look at the pads and calipers of one axle against those of the other."),
    _row("golden_sigma_stiffness", (None, None), (-3.0, 3.0), "sigma", _RARE,
         "Look at type and pressure of the tyres, the track, and the wheel speed sensors."),
    _row("valid_share", (0.70, None), (0.80, None), "1",
         "an estimator whose samples are seldom valid is of no use",
         "Look at this stop with brake-cal check and brake-cal plot, and drive it again.",
         required=True),
    _row("covered_share", (0.50, None), (0.80, None), "1",
         "beyond the table the estimate uses its end values",
         "Drive a ramp that goes as far as the stops do."),
    _as_validate("interval_f",
         "0.12 for the pads, 0.06 for a mass known to 3 %, 0.05 for the pads' ratio in the ramp",
         "Drive a longer stop; check the noise of the wheel speeds with brake-cal check."),
    _as_validate("interval_r",
         "the rear has a smaller slip, so its interval is wider",
         "Drive a longer stop; check the noise of the wheel speeds with brake-cal check."),
    _row("pad_friction_drift_f", (None, 0.10), (None, 0.07), "1",
         "pads do not change within a stop unless they fade or dry, or the model is wrong",
         "Find what changes with brake-cal diagnose: fade, wet pads, drag."),
    _row("pad_friction_drift_r", (None, 0.20), (None, 0.14), "1",
         "as in front",
         "Find what changes with brake-cal diagnose: fade, wet pads, drag."),
    _row("innovation_colour", (None, 0.80), (None, 0.40), "1",
         "correlated errors must be much smaller than the stated sigma; good cars are below 0.3",
         "Look for the cause with brake-cal diagnose."),
    _row("innovation_rms", (None, 2.0), (None, 1.3), "1",
         "1 is as expected; 2 means that the intervals are half as wide as they should be",
         "Check the wheel speed sensors; look for the cause with brake-cal diagnose."),
    _row("eta_zero", (-0.010, 0.010), (-0.005, 0.005), "1",
         "as in the ramp", "Check tyre pressures and sizes on both axles."),
)  # fmt: skip
"""One row for each metric that is judged by default: first of the car, then of each stop."""

BY_FIGURE: dict[str, Advice] = {row.limit.figure: row for row in ADVICE}
LIMITS: tuple[Limit, ...] = tuple(row.limit for row in ADVICE)
"""The limits of a car when the user gives none."""


def action(figure: str) -> str:
    """What to do where the metric ``figure`` fails, in one or two sentences."""
    row = BY_FIGURE.get(figure)
    return row.action if row else "Look at the log with brake-cal check and brake-cal plot."


def reason(figure: str) -> str:
    """The reason for the default limit of the metric ``figure``."""
    row = BY_FIGURE.get(figure)
    return row.reason if row else "no limit by default"
