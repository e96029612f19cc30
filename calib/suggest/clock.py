"""Find the column of the time."""

from collections.abc import Mapping as Named
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.logs.channel_map import Mapping
from calib.logs.clock import step_of
from calib.run.limits import LIMITS
from calib.suggest.physics import ColumnClock
from calib.suggest.proposal import LIKELY, SURE, Doubt, Proposal
from calib.suggest.series import Series
from calib.suggest.words import TIME, words

SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
"""Possible units of a time column without a unit [s]; the sample rate decides between them."""

REPEATED = 0.01
"""Largest share of rows that repeat the time of the row before them [1]."""


def find_clock(
    series: list[Series], with_gaps: Sequence[Series], refused: Named[str, str]
) -> tuple[Proposal | None, ColumnClock | None, list[Doubt]]:
    """Find the time column: not decreasing, named as a time, with a unit of time.

    A missing unit follows from the rate: of seconds, milliseconds and microseconds only one gives
    40 Hz to 1 kHz. Nothing is proposed if no column, or more than one, fits. The clock has the
    rows that `rising` gives. Columns in ``with_gaps`` have no value in some rows; for the names in
    ``refused`` there are no values at all, with the reason.
    """
    running = [s for s in series if s.si in ("s", None) and _runs(s)]
    named = [s for s in running if TIME & set(words(s.name))]
    exact = [s for s in named if s.name == "time"]
    fit = exact or named
    if len(fit) > 1:
        do = "choose one: --take time=NAME"
        return None, None, [_doubt(fit, "more than one column is a time", do)]
    if not fit:
        for s in [s for s in (*series, *with_gaps) if s.si in ("s", None)]:
            if TIME & set(words(s.name)):
                why = f"{s.name} is named a time, but {_disorder(s.values)}"
                return None, None, [_doubt([s], why, "correct the log, or export it again")]
        for name, why in refused.items():
            if TIME & set(words(name)):
                do = "export the log again, with a time for each row"
                return None, None, [Doubt("time", (name,), why, do)]
        candidates = [s for s in running if s.si == "s"] or running
        do = "choose one and give its unit: --take 'time=NAME [s]'"
        do = do if candidates else "export the log again, with its time"
        return None, None, [_doubt(candidates, "no column is named a time", do)]
    return _proposal(fit[0])


def rising(time: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Mask of the rows that do not repeat the time before them, shape (n,)."""
    return np.append(True, np.diff(time) > 0.0) if time.size else np.zeros(0, bool)


def _runs(series: Series) -> bool:
    """Whether the values rise, with `REPEATED` of the rows repeating the one before at most."""
    steps = np.diff(series.values)
    few = np.count_nonzero(steps == 0.0) <= REPEATED * series.values.size
    return bool(steps.size and np.all(steps >= 0.0) and few)


def _disorder(time: NDArray[np.float64]) -> str:
    """What keeps a column from being a time, in words."""
    missing = np.flatnonzero(np.isnan(time))
    if missing.size:
        return f"has no value in {missing.size} rows, first in row {missing[0] + 1}"
    steps = np.diff(time)
    back = np.flatnonzero(steps < 0.0)
    if back.size:
        return f"goes back in {back.size} rows, first in row {back[0] + 2}"
    same = np.flatnonzero(steps == 0.0)
    return f"repeats a time in {same.size} rows, first in row {same[0] + 2}"


def _increasing(time: NDArray[np.float64]) -> str:
    if rising(time).all():
        return "increasing"
    return f"increasing, but {_disorder(time)}: the log is refused until they are deleted"


def _doubt(candidates: list[Series], why: str, do: str) -> Doubt:
    return Doubt("time", tuple(s.name for s in candidates), why, do)


def _proposal(series: Series) -> tuple[Proposal | None, ColumnClock | None, list[Doubt]]:
    time = series.values[rising(series.values)]
    step, order = step_of(time), _increasing(series.values)
    if series.si == "s":
        reasons = ("name", f"unit {series.column.unit}", order)
        found = Proposal("time", Mapping(series.name), SURE, reasons)
        return found, ColumnClock(time, step), []
    for unit, scale in SCALES.items():
        if LIMITS.rates[0] <= 1.0 / (step * scale) <= LIMITS.rates[1]:
            reasons = ("name", order, f"only {unit} gives a rate of 40 Hz to 1 kHz")
            found = Proposal("time", Mapping(series.name, unit), LIKELY, reasons)
            return found, ColumnClock(time * scale, step * scale), []
    do = "give the unit: --take 'time=NAME [s]'"
    return None, None, [_doubt([series], f"no unit, and steps of {step:.4g}", do)]
