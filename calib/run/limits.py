"""What `check` asks of a log: `base/log_limits.csv`, each number with its unit and its reason."""

import json
from typing import TYPE_CHECKING

from calib.base.plain import rows


class _LogLimits:
    """The numbers by their names, and three ranges."""

    rates: tuple[float, float]
    wheel_radius: tuple[float, float]
    tyre_radius: tuple[float, float]

    def __init__(self) -> None:
        vars(self).update({row["name"]: _read(row["value"]) for row in rows("log_limits.csv")})

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> float: ...


def _read(value: str) -> float | tuple[float, ...]:
    number = json.loads(value)
    return tuple(number) if isinstance(number, list) else number


LIMITS = _LogLimits()
