"""Bad input as the library refuses it."""

from collections.abc import Callable, Iterable
from typing import Any

import pytest

from calib.base.errors import BrakeCalError, InputError
from calib.base.warning import REFUSE, WARN, Measured, rule_warnings
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import unusable
from calib.run.run import Run


def refusal(
    act: Callable[..., object],
    *arguments: Any,
    kind: type[BrakeCalError] | tuple[type[BrakeCalError], ...] = InputError,
    names: object = "",
    **options: Any,
) -> str:
    """What is said of input that ``act`` refuses with an error of ``kind`` that ``names`` it."""
    with pytest.raises(kind) as error:
        act(*arguments, **options)
    assert error.value.exit_code == 3
    assert str(names) in str(error.value)
    return str(error.value)


def why_not(log: Log, purpose: str, vehicle: Vehicle | None = None) -> list[str]:
    """Codes of the rules by which a log is of no use for a purpose."""
    return [one.code for one in unusable(Run(log, vehicle), purpose)]


def broken(figures: Iterable[Callable[[Evidence], Iterable[Measured]]], evidence: Evidence) -> list:
    """What the rules of a fit say of some figures, whether they warn or refuse."""
    measured = (m for figure in figures for m in figure(evidence))
    return list(rule_warnings("log", measured, "fit", (REFUSE, WARN)))
