"""Whether the axles of a log are those of its table, or their wheel speeds are swapped.

The front wheels must slip more than the rear while braking. Where they slip less, the wheel speeds
are swapped, a motor brakes the rear wheels, or the front pads are weak.

    eta rises    as the table says      the axles are right
    else         weighed                the log as given against the log with its axles exchanged
    eta falls    exchanged by far       refused

On a car near ideal balance eta hardly rises. What tells the axles there is how eta goes with the
deceleration over the whole stop, and whether the pads are those of the ramp
(`calib.estimation.exchanged`).
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from calib.base.errors import LogError
from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning
from calib.estimation.estimator import Estimate
from calib.estimation.exchanged import Exchanged, exchanged
from calib.estimation.gates import LOCKS
from calib.estimation.settings import SETTINGS
from calib.logs.log import Log
from calib.run.blocks import Blocks, braked_alone
from calib.run.gates import bitten, eta_rise
from calib.run.limits import LIMITS
from calib.run.wheels import CORRECT, Crossed, WheelParts, crossed_diagonal, what_to_check
from calib.table.budget import front_share
from calib.table.table import Table

SWAPPED = "front and rear wheel speeds that are swapped"


class Rise(NamedTuple):
    """Rise of ``eta`` under braking with its standard ``error``, and that of the table, all [1]."""

    eta: float
    error: float
    expected: float


def judge_axles(table: Table, log: Log, e: Estimate) -> Exchanged | None:
    """Weigh the log against itself with its axles exchanged; None where eta alone tells them.

    None, too, where the pads are those of the ramp as the log is given, and far from them with its
    axles exchanged. ``e`` is the estimate of the log. Raises LogError if the log clearly has its
    axles swapped, or a motor brakes the rear wheels.
    """
    r = _rise(table, e.blocks)
    right = (
        r is not None
        and r.expected > SETTINGS.eta_rises
        and r.eta - 4.0 * r.error > SETTINGS.axles_reversed * r.expected
    )
    other = None if right else exchanged(e)
    if other is None:
        return None
    given, swapped = map(abs, other.log_pad_ratio)
    if given < SETTINGS.ratio_kept and swapped > SETTINGS.ratio_apart:
        return None
    if float(np.mean(e.refused[LOCKS][e.braked])) > SETTINGS.at_limit:
        return None
    falls = (
        r is not None
        and r.expected > 0.0
        and r.eta + 4.0 * r.error < -SETTINGS.axles_reversed * r.expected
    )
    if r is not None and falls and other.log_odds > SETTINGS.axles_sure:
        raise LogError(
            "the front wheels slip less than the rear while braking: "
            f"eta {100 * r.eta:+.2f} %, as no pads of a stop make it",
            where=log.source,
            expected=f"about {100 * r.expected:+.2f} % by the table of {table.name}",
            do=what_to_check("rear"),
        )
    return other


def axles_warnings(log: str, e: Estimate, other: Exchanged | None) -> Iterator[PlausibilityWarning]:
    """A warning where swapped wheel speeds are possible and would make the pads others."""
    if other is None or other.log_odds < SETTINGS.axles_doubt:
        return
    if other.log_odds < SETTINGS.axles_sure and _holds(e, other):
        return
    yield PlausibilityWarning(
        "axles_exchanged",
        log,
        other.log_odds,
        (None, SETTINGS.axles_doubt),
        (
            SWAPPED,
            "pads or tyres of one axle that changed since the ramp, such as weak front pads",
            "wheel speeds that are not smooth: a tone ring out of true",
        ),
        "compare the columns of the wheel speeds with the car, and correct them with a channel "
        "map; if they are right, look at the pads of both axles",
    )


class _CrossedStop(NamedTuple):
    """The two wheels of a diagonal that a stop has exchanged.

    ``sure`` by `eta_rises` and `brakes_kept`; ``z`` deceleration of the stop [1].
    """

    found: Crossed
    sure: bool
    z: float


def crossed_wheels(table: Table, e: Estimate, parts: WheelParts | None) -> _CrossedStop | None:
    """A front and a rear wheel of one diagonal that changed places, None where nothing says so.

    Those of one side are refused before a stop is estimated, see `calib.run.wheels`.
    """
    r = _rise(table, e.blocks)
    found = crossed_diagonal(parts, r.expected) if r is not None else None
    if r is None or parts is None or found is None:
        return None
    return _CrossedStop(
        found, r.expected > SETTINGS.eta_rises and _level(e) > SETTINGS.brakes_kept, parts.z
    )


def _level(e: Estimate) -> float:
    """Brake force of both axles over that of the pads of the ramp [1], median of the braking."""
    of = e.valid if e.valid.any() else e.braked
    share = front_share(e.plan.table.vehicle, e.plan.table.calibration.pad_log_ratio.value)
    return float(
        np.median((share * e.best.change_f.value + (1.0 - share) * e.best.change_r.value)[of])
    )


def crossed_warnings(log: str, crossed: _CrossedStop | None) -> Iterator[PlausibilityWarning]:
    """A warning for a front and a rear wheel that changed places."""
    if crossed is None:
        return
    found, least = crossed.found, LIMITS.crossed_least * crossed.z
    yield PlausibilityWarning(
        "wheels_crossed",
        log,
        found.part,
        (-least, least),
        (f"{found}", "weak front pads, in a bend that begins with the braking"),
        CORRECT,
    )


def _holds(e: Estimate, other: Exchanged) -> bool:
    """Whether the interval of the pads' ratio holds what the log says with its axles exchanged."""
    as_given, swapped = other.log_pad_ratio
    return abs(swapped - as_given) < Z95 * other.sigma


def _rise(table: Table, b: Blocks) -> Rise | None:
    """Rise of eta under braking, None where the run does not tell it or the rear brakes alone."""
    if braked_alone(b.p_f, b.p_r) == "r":
        return None  # eta falls, as it must
    known = (b.z > 0.05) & (b.z < table.paper.z[-1])
    braked = known & (b.end > bitten(b)) & (b.speed > 5.0)
    rise, error = eta_rise(b, braked)
    if not np.isfinite(rise):
        return None
    expected = float(np.median(np.interp(b.z[braked], table.paper.z, table.paper.eta))) - 1.0
    return Rise(rise, error, expected)
