"""Numbers by which a log is looked at: `base/log_limits.csv`, each with its unit and its reason."""

from typing import TYPE_CHECKING

from calib.base.plain import rows


class _LogLimits:
    """The numbers by their names."""

    def __init__(self) -> None:
        vars(self).update({row["name"]: float(row["value"]) for row in rows("log_limits.csv")})

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> float: ...


LIMITS = _LogLimits()
