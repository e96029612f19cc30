"""A result of `validate --out` as it is read back."""

import numpy as np

from calib.show.result import COLUMNS, StoredResult


def made_result() -> StoredResult:
    """Pads of 0.4 and 100 N m on each wheel, all along 0.4 s."""
    n = 40
    values = dict.fromkeys(COLUMNS, np.full(n, 0.4)) | {"time": 0.01 * np.arange(n)}
    values |= {f"brake_torque_{w}": np.full(n, 100.0) for w in ("fl", "fr", "rl", "rr")}
    return StoredResult("stop", "ab" * 32, values, np.ones(n, bool))
