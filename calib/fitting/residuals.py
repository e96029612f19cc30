"""What an ensemble leaves of the eta and the slip of a ramp, block by block, over their noise.

A ramp that no draw carries, or that all leave far more of than the sensors err by, makes no table,
but where a valve of the rear pressure, missing in the vehicle file, explains it:

    p_r |        .-'   p_k + s (p - p_k)        one p_mc for both axles: nobody measured p_r
        |     .-'
        |   /
        | /            the pads' ratio would bend at p_k, which no tyre of the ensemble does
        +---+---------> p_mc
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.units import from_si
from calib.base.warning import Measured, PlausibilityWarning, judged
from calib.car.effects.line import limited
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble
from calib.fitting.known import Known
from calib.fitting.posterior import Posterior, posterior
from calib.fitting.regression import Regression
from calib.model.ramp import RampRun
from calib.table.table import Value

_SOME = 64  # draws whose median is taken: it is known far better than a block

_MOST = 3.0
"""Root mean square of the residuals of eta past which a ramp is not explained: foreign tyres leave
0.5 to 1.4, a wheel speed that is held for 0.1 s, and moves the ratio of the pads by a sixth, 5."""

_KNEES = (15e5, 20e5, 25e5, 30e5, 35e5)  # of usual valves [Pa]
_SLOPE = 0.4  # of the rear pressure above the knee, of a usual valve [1]
_REACH = 0.85  # share of the highest pressure of a ramp below which a knee must be to show
_DOUBT = 1.2  # misfit past which a knee is asked for: 1.0 to 1.3 without a valve, to 2.8 with one
_DRAWS = 512  # enough for a misfit

Residuals = list[tuple[Array, Array]]
"""Of eta and of slip of each run, see `residuals`."""


def explained(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    known: Sequence[Known],
    refused: Callable[..., LogError],
) -> tuple[Posterior, Residuals, tuple[PlausibilityWarning, ...]]:
    """The ensemble of the ramps, ``ratio`` known of the pads before, and its `residuals` of each.

    With a warning where a valve of the rear pressure explains them better; what ``refused`` makes
    of the reason is raised where nothing does.
    """
    try:
        found = posterior(car, runs, ratio, known=known)
    except ValueError as error:
        raise refused(
            "no tyre carries the forces of the ramps",
            expected="no wheel near its limit, and mass, axle loads and radii of this car",
            do="end the ramp before ABS works or a wheel locks; look at it with `brake-cal check`",
        ) from error
    left = [residuals(car, found, run) for run in runs]
    worst = max(float(np.sqrt(np.mean(eta**2))) for eta, _ in left if eta.size)
    valve = judged(", ".join(run.name for run in runs), _valve(car, found, runs, ratio))
    if worst > _MOST and not valve:
        raise refused(
            f"no tyre explains eta: it is left {worst:.1f} times what the wheel speeds err by",
            expected=f"up to {_MOST:.0f} times",
            do="look at the wheel speeds with `brake-cal check`: one may be late, or coarse",
        )
    return found, left, valve


def residuals(car: Vehicle, e: Ensemble, run: RampRun) -> tuple[Array, Array]:
    """Of eta and of slip, over their sigma, at the braked blocks (k,); no slip without v.

    Of a ramp with one axle only nothing: its forces are another's.
    """
    none = np.empty(0)
    if run.only is not None:
        return none, none
    of = Regression(car, [run], most=None)
    sigma = np.linalg.norm(np.hstack([of.errors["noise"], of.errors["tyres"]]), axis=1)
    lasting = np.hstack([of.errors["zeros"], of.errors["accelerometer"]])
    left = of.left(e.take(np.linspace(0, e.size - 1, _SOME).astype(np.int64)))
    left -= left @ of.white.T @ of.white @ lasting @ lasting.T  # as far as the run tells them
    eta, slip = np.split(np.median(left, axis=0) / sigma, 2)
    return eta, none if run.slip is None else slip


def _valve(car: Vehicle, found: Posterior, runs: list[RampRun], ratio: Value) -> Iterator[Measured]:
    """By how much the mean square that is left of the ramps falls with a knee of the rear pressure.

    Not asked where a valve is declared or the pressures of both axles are logged.
    """
    measured = any(not np.array_equal(run.blocks.p_f, run.blocks.p_r) for run in runs)
    if found.misfit < _DOUBT or measured or "rear_proportioning" in car.effects:
        return
    highest, left = max(float(np.max(run.blocks.p_r[run.use])) for run in runs), {}
    for knee in (knee for knee in _KNEES if knee < _REACH * highest):
        behind = [
            replace(run, blocks=replace(run.blocks, p_r=limited(run.blocks.p_r, knee, _SLOPE)))
            for run in runs
        ]
        with suppress(ValueError):  # no tyre carries these forces
            left[knee] = posterior(car, behind, ratio, _DRAWS).misfit
    if left:
        knee = min(left, key=left.__getitem__)
        words = {"bar": f"{from_si(knee, 'bar', 'Pa'):g}"}
        yield Measured("rear_pressure_limited", found.misfit**2 - left[knee] ** 2, words=words)
