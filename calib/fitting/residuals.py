"""What an ensemble leaves of the eta and the slip of a ramp, block by block, over their noise.

A ramp that no draw carries, or that all leave far more of than the sensors err by, makes no table.
"""

from collections.abc import Sequence

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.warning import PlausibilityWarning, judged
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble
from calib.fitting.known import Known
from calib.fitting.posterior import Posterior, posterior
from calib.fitting.rear_valve import rear_valve
from calib.fitting.regression import Regression
from calib.model.ramp import RampRun
from calib.table.table import Value

_SOME = 64  # draws whose median is taken: it is known far better than a block

_MOST = 3.0
"""Root mean square of the residuals of eta past which a ramp is not explained: foreign tyres leave
0.5 to 1.4, a wheel speed that is held for 0.1 s, and moves the ratio of the pads by a sixth, 5."""

Residuals = list[tuple[Array, Array]]
"""Of eta and of slip of each run, see `residuals`."""


def explained(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    sources: str,
    warnings: tuple[PlausibilityWarning, ...],
    known: Sequence[Known],
) -> tuple[Posterior, Residuals, tuple[PlausibilityWarning, ...]]:
    """The ensemble of the ramps, ``ratio`` known of the pads before, and what it leaves of them.

    With a warning where a valve of the rear pressure explains them better; LogError, with the
    ``sources`` of the ramps, where nothing does.
    """
    lines = tuple(map(str, warnings))
    try:
        found = posterior(car, runs, ratio, known=known)
    except ValueError as error:
        raise LogError(
            "no tyre carries the forces of the ramps",
            where=sources,
            expected="no wheel near its limit, and mass, axle loads and radii of this car",
            do="end the ramp before ABS works or a wheel locks; look at it with `brake-cal check`",
            lines=lines,
        ) from error
    left = [residuals(car, found, run) for run in runs]
    worst = max(float(np.sqrt(np.mean(eta**2))) for eta, _ in left if eta.size)
    valve = tuple(judged(", ".join(run.name for run in runs), rear_valve(car, found, runs, ratio)))
    if worst > _MOST and not valve:
        raise LogError(
            f"no tyre explains eta: it is left {worst:.1f} times what the wheel speeds err by",
            where=sources,
            expected=f"up to {_MOST:.0f} times",
            do="look at the wheel speeds with `brake-cal check`: one may be late, or coarse",
            lines=lines,
        )
    return found, left, valve


def residuals(car: Vehicle, e: Ensemble, run: RampRun) -> tuple[Array, Array]:
    """Of eta and of slip, over their sigma, at the blocks `told` (k,); no slip without v.

    Of a ramp with one axle only nothing: its forces are another's.
    """
    none = np.empty(0)
    if run.only is not None:
        return none, none
    some = e.take(np.linspace(0, e.size - 1, _SOME).astype(np.int64))
    of = Regression(car, [run], most=None)
    linear = np.stack([some.compliance_f, some.compliance_r, some.radius_load], axis=1)
    sigma = np.linalg.norm(np.hstack([of.errors["noise"], of.errors["tyres"]]), axis=1)
    lasting = np.hstack([of.errors["zeros"], of.errors["accelerometer"]])
    left = of.left(some, linear)
    left -= left @ of.white.T @ of.white @ lasting @ lasting.T  # as far as the run tells them
    eta, slip = np.split(np.median(left, axis=0) / sigma, 2)
    return eta, none if run.slip is None else slip
