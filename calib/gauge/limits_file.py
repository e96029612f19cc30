"""Limits and tolerances of a gauge study from a limits file.

schema = 1
[limits]
grr = { max = 0.3 }                        %GRR of every metric, as a share
pad_scale = { min = 0.8, max = 1.2 }       the tolerance of a metric
pad_scale_grr_of_tolerance = { max = 0.2 }
"""

from pathlib import Path

from calib.gauge.study import DEFAULTS, METRICS, known_limits
from calib.gauge.tolerance import tolerances
from calib.validation.limits import Limit
from calib.validation.limits_file import read_limits


def read_gauge_limits(path: Path | None) -> tuple[Limit, ...]:
    """The limits of a file; the `DEFAULTS` without one. Raises LimitsError for a bad file."""
    if path is None:
        return DEFAULTS
    limits = read_limits(path, known_limits())
    tolerances(limits, METRICS, path)
    return limits
