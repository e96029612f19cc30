"""Tolerances of metrics, as ranges in a limits file."""

from collections.abc import Collection

from calib.base.errors import LimitsError
from calib.estimation.limits import Limit


def tolerances(
    limits: tuple[Limit, ...], metrics: Collection[str], where: object = None
) -> dict[str, float]:
    """Width USL - LSL of the tolerance of each of the ``metrics`` with a limit, in its unit.

    Raises LimitsError for one that has no two ends; ``where`` names the file.
    """
    out = {}
    for limit in limits:
        if limit.figure not in metrics:
            continue
        if limit.low is None or limit.high is None or not limit.low < limit.high:
            raise LimitsError(
                f"{limit.figure} is the tolerance of a metric and needs two ends that are apart",
                where=where,
                expected=f"{limit.figure} = {{ min = LOW, max = HIGH }}",
            )
        out[limit.figure] = limit.high - limit.low
    return out
