"""Find the column of the time."""

import numpy as np

from calib.checks.rules import RATES
from calib.logs.channel_map import Mapping
from calib.suggest.physics import ColumnClock
from calib.suggest.proposal import LIKELY, SURE, Doubt, Proposal
from calib.suggest.series import Series
from calib.suggest.words import TIME, words

SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
"""Possible units of a time column without a unit [s]; the sample rate decides between them."""


def find_clock(series: list[Series]) -> tuple[Proposal | None, ColumnClock | None, list[Doubt]]:
    """Find the time column: increasing, named as a time, with a unit of time.

    A missing unit follows from the rate: of seconds, milliseconds and microseconds only one gives
    40 Hz to 1 kHz. Nothing is proposed if no column, or more than one, fits.
    """
    running = [s for s in series if _runs(s) and (s.si == "s" or s.si is None)]
    named = [s for s in running if TIME & set(words(s.name))]
    exact = [s for s in named if s.name == "time"]
    fit = exact or named
    if len(fit) > 1:
        do = "choose one: --take time=NAME"
        return None, None, [_doubt(fit, "more than one column is a time", do)]
    if not fit:
        candidates = [s for s in running if s.si == "s"] or running
        do = "choose one and give its unit: --take 'time=NAME [s]'"
        return None, None, [_doubt(candidates, "no column is named a time", do)]
    return _proposal(fit[0])


def _runs(series: Series) -> bool:
    return bool(series.values.size > 1 and np.all(np.diff(series.values) > 0.0))


def _doubt(candidates: list[Series], why: str, do: str) -> Doubt:
    return Doubt("time", tuple(s.name for s in candidates), why, do)


def _proposal(series: Series) -> tuple[Proposal | None, ColumnClock | None, list[Doubt]]:
    step = float(np.median(np.diff(series.values)))
    if series.si == "s":
        reasons = ("name", f"unit {series.column.unit}", "increasing")
        found = Proposal("time", Mapping(series.name), SURE, reasons)
        return found, ColumnClock(series.values, step), []
    for unit, scale in SCALES.items():
        if RATES[0] <= 1.0 / (step * scale) <= RATES[1]:
            reasons = ("name", "increasing", f"only {unit} gives a rate of 40 Hz to 1 kHz")
            found = Proposal("time", Mapping(series.name, unit), LIKELY, reasons)
            return found, ColumnClock(series.values * scale, step * scale), []
    do = "give the unit: --take 'time=NAME [s]'"
    return None, None, [_doubt([series], f"no unit, and steps of {step:.4g}", do)]
