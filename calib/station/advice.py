"""Limits by default, why they stand where they stand, and what to do where one is not held.

A limit that is not met must name a next step: whoever stands at the line has a car to move.
"""

from dataclasses import dataclass

from calib.validation.limits import Limit


@dataclass(frozen=True)
class Advice:
    """``limit`` by default, the ``reason`` for it, and the ``action`` where it is not held."""

    limit: Limit
    unit: str
    reason: str
    action: str


def _row(
    figure: str, fail: tuple[float | None, float | None], warn: tuple[float | None, float | None],
    unit: str, reason: str, action: str, *, required: bool = False,
) -> Advice:  # fmt: skip
    return Advice(Limit(figure, *fail, *warn, required), unit, reason, action)


_DRIVE_RAMP = "Drive the ramp again: a second of coasting, then pressure rising over 5 s to 0.5 g."
_PADS = "Look at pads, discs and calipers of the car, and whether the vehicle file is of this model"
_SAME = "Drive two stops again with warm, dry pads on one road; if they still differ, look at"

ADVICE: tuple[Advice, ...] = (
    _row("ramp_deceleration", (0.35, None), (0.40, None), "g",
         "the table ends where the ramp ends, and an ECU clamps beyond",
         "Drive the ramp again, up to 0.4 g or more.", required=True),
    _row("measured_share", (0.60, None), (0.75, None), "1",
         "rows that were not seen are drawn between their neighbours", _DRIVE_RAMP, required=True),
    _row("band_width", (None, 0.30), (None, 0.20), "1",
         "the rear force errs by about twice the band of D",
         "Drive a second ramp and give it with --ramp; log the wheel speeds finer.",
         required=True),
    _row("ramp_eta_zero", (-0.010, 0.010), (-0.005, 0.005), "1",
         "it is zeroed, but tyres of one kind do not differ by more than a few mm in radius",
         "Check tyre pressures and sizes on both axles."),
    _row("pad_scale", (0.80, 1.20), (0.90, 1.10), "1",
         "pads of one grade scatter by a few percent; 20 % are another pad, piston or disc",
         f"{_PADS}: both axles brake harder or softer than it says.", required=True),
    _row("pad_ratio", (0.80, 1.25), (0.90, 1.12), "1",
         "one axle with other pads than the other changes the distribution and the front bias",
         f"{_PADS}: one axle brakes out of proportion to the other."),
    _row("side_difference_f", (-0.20, 0.20), (-0.10, 0.10), "1",
         "in-service inspection rejects 30 % across an axle; a new car starts well below",
         "Look at the front calipers and pads, left against right, and drive straight on a level "
         "lane: a bend looks the same."),
    _row("side_difference_r", (-0.25, 0.25), (-0.15, 0.15), "1",
         "as in front; rear slip is smaller, so it is seen less well",
         "Look at the rear calipers and the parking brake, left against right."),
    _row("front_biased_up_to", (0.50, None), (0.60, None), "g",
         "beyond it the rear axle locks first, and the sign of eta - 1 turns",
         "Look at the rear brakes: they brake too hard for their load. Hold the car back.",
         required=True),
    _row("repeatability_f", (None, 0.15), (None, 0.08), "1",
         "stops with the same pads must agree; wet pads or another load do not count as the same",
         f"{_SAME} the front calipers."),
    _row("repeatability_r", (None, 0.20), (None, 0.12), "1",
         "as in front, with a weaker signal",
         f"{_SAME} the rear calipers."),
    _row("golden_distance", (None, 0.30), (None, 0.20), "1",
         "cars of one model on one track lie within their bands of each other",
         "Compare with brake-cal tables diff: other tyres, a wet track or other brakes?"),
    _row("golden_bands", (None, 4.0), (None, 2.5), "1",
         "beyond 1 the difference is resolved, which is no harm yet",
         "Compare with brake-cal tables diff: other tyres, a wet track or other brakes?"),
    _row("valid_share", (0.70, None), (0.80, None), "1",
         "an estimator that seldom stands behind its answer is of no use",
         "Look at this stop with brake-cal check and brake-cal plot, and drive it again.",
         required=True),
    _row("covered_share", (0.50, None), (0.80, None), "1",
         "beyond the table the answer rests on the clamped ends",
         "Drive a ramp that goes as far as the stops do."),
    _row("interval_f", (None, 0.10), (None, 0.08), "1",
         "an answer to 10 % is what a warning of worn pads needs",
         "Drive a longer stop; check the noise of the wheel speeds with brake-cal check."),
    _row("interval_r", (None, 0.25), (None, 0.20), "1",
         "the rear is seen through a smaller slip",
         "Drive a longer stop; check the noise of the wheel speeds with brake-cal check."),
    _row("pad_friction_drift_f", (None, 0.10), (None, 0.07), "1",
         "pads do not change within a stop unless they fade, dry up, or the model is wrong",
         "Find what changes with brake-cal diagnose: fade, wet pads, drag."),
    _row("pad_friction_drift_r", (None, 0.20), (None, 0.14), "1",
         "as in front",
         "Find what changes with brake-cal diagnose: fade, wet pads, drag."),
    _row("innovation_colour", (None, 0.80), (None, 0.40), "1",
         "what is not white must stay well within the promised sigma; good cars stay below 0.3",
         "Look for the cause with brake-cal diagnose."),
    _row("innovation_rms", (None, 2.0), (None, 1.3), "1",
         "1 is as promised; 2 means that the intervals are half as wide as they should be",
         "Check the wheel speed sensors; look for the cause with brake-cal diagnose."),
    _row("eta_zero", (-0.010, 0.010), (-0.005, 0.005), "1",
         "as in the ramp", "Check tyre pressures and sizes on both axles."),
)  # fmt: skip
"""One row a figure that is judged by default, those of the car first, then those of each stop."""

BY_FIGURE: dict[str, Advice] = {row.limit.figure: row for row in ADVICE}
LIMITS: tuple[Limit, ...] = tuple(row.limit for row in ADVICE)
"""What a car must hold when the user gives no limits."""


def action(figure: str) -> str:
    """What to do where ``figure`` fails; one sentence or two."""
    row = BY_FIGURE.get(figure)
    return row.action if row else "Look at the log with brake-cal check and brake-cal plot."


def reason(figure: str) -> str:
    """Why the default limit of ``figure`` stands where it stands."""
    row = BY_FIGURE.get(figure)
    return row.reason if row else "no limit by default"
