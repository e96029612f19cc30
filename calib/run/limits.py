"""Numbers by which a log is looked at: `base/log_limits.csv`, each with its unit and its reason."""

import json
from typing import TYPE_CHECKING

from calib.base.plain import rows


class _LogLimits:
    """The numbers by their names; counts are whole ones."""

    def __init__(self) -> None:
        vars(self).update({row["name"]: json.loads(row["value"]) for row in rows("log_limits.csv")})

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> float: ...


LIMITS = _LogLimits()
