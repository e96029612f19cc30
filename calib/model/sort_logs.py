"""Ramps and coasts among the runs of a fit, and which of them will do."""

from collections.abc import Sequence

from calib.base.errors import LogError
from calib.plausibility.rules import COAST, FIT, require
from calib.run.run import Run
from calib.run.same_run import refuse_copies


def sort_runs(runs: Sequence[Run]) -> tuple[list[Run], list[Run]]:
    """Ramps and coasts, in the order of the digests of their logs.

    The order of the command line must not change a bit of the table. Raises LogError for a log
    that will not do, that is not of this vehicle, or that is there twice.
    """
    refuse_copies([run.log for run in runs])
    ramps: list[Run] = []
    coasts: list[Run] = []
    for run in sorted(runs, key=lambda item: item.log.digest):
        coasting = not run.events
        require(run, COAST if coasting else FIT)
        (coasts if coasting else ramps).append(run)
    if not ramps:
        raise LogError(
            "none of the logs holds a braking",
            where=", ".join(run.log.source for run in runs),
            expected="at least one ramp: 1 s unbraked, then pressure rising over 3 to 8 s",
        )
    if all(run.only for run in ramps):
        raise LogError(
            "on every ramp one axle brakes alone, so there is no curve over eta",
            where=", ".join(run.log.source for run in ramps),
            expected="at least one ramp with both axles; ramps with one axle serve in addition",
        )
    return ramps, coasts
