"""Limits and tolerances of a gauge study from a limits file.

schema = 1
[limits]
grr = { max = 0.3 }                        %GRR of every metric, as a share
pad_scale = { min = 0.8, max = 1.2 }       the tolerance of a metric
pad_scale_grr_of_tolerance = { max = 0.2 }
"""

from pathlib import Path

from calib.estimation.limits import Limit
from calib.estimation.limits_file import read_limits
from calib.line.gauge.study import DEFAULTS, METRICS, known_limits
from calib.line.gauge.tolerance import tolerances


def read_gauge_limits(path: Path | None) -> tuple[Limit, ...]:
    """The limits of a file; the `DEFAULTS` without one. Raises LimitsError for a bad file."""
    if path is None:
        return DEFAULTS
    limits = read_limits(path, known_limits())
    tolerances(limits, METRICS, path)
    return limits
