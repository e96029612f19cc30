"""Whether something limits the rear pressure of a ramp: a valve missing in the vehicle file.

p_r |        .-'   p_k + s (p - p_k)        one p_mc for both axles: nobody measured p_r
|     .-'
|   /
| /            the pads' ratio would bend at p_k, which no tyre of the ensemble does
+---+---------> p_mc
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from calib.base.units import from_si
from calib.base.warning import Measured
from calib.car.effects.line import limited
from calib.car.vehicle import Vehicle
from calib.fitting.posterior import Posterior, posterior
from calib.model.ramp import RampRun
from calib.table.table import Value

VALVE = "rear_proportioning"

_KNEES = (15e5, 20e5, 25e5, 30e5, 35e5)  # of usual valves [Pa]
_SLOPE = 0.4  # of the rear pressure above the knee, of a usual valve [1]
_REACH = 0.85  # share of the highest pressure of a ramp below which a knee must be to show
_DOUBT = (
    1.2  # misfit from which a knee is asked for: 1.0 to 1.3 without a valve, up to 2.8 with one
)
_DRAWS = 512  # enough for a misfit


def rear_valve(
    car: Vehicle, found: Posterior, runs: list[RampRun], ratio: Value
) -> Iterator[Measured]:
    """By how much the mean square that is left of the ramps falls with a knee of the rear pressure.

    ``found`` the ensemble of ``runs`` without one, ``ratio`` as `posterior` has it. Not asked where
    a valve is declared or the pressures of both axles are logged.
    """
    measured = any(not np.array_equal(run.blocks.p_f, run.blocks.p_r) for run in runs)
    if found.misfit < _DOUBT or measured or VALVE in car.effects:
        return
    highest = max(float(np.max(run.blocks.p_r[run.use])) for run in runs)
    left = {}
    for knee in _KNEES:
        if knee < _REACH * highest:
            try:
                left[knee] = posterior(car, [_limited(r, knee) for r in runs], ratio, _DRAWS).misfit
            except ValueError:  # no tyre carries these forces
                continue
    if left:
        knee = min(left, key=left.__getitem__)
        bar = f"{from_si(knee, 'bar', 'Pa'):g}"
        fall = found.misfit**2 - left[knee] ** 2
        yield Measured("rear_pressure_limited", fall, words={"bar": bar})


def _limited(run: RampRun, knee: float) -> RampRun:
    """The run with a usual valve of that ``knee`` [Pa] at the rear axle."""
    return replace(run, blocks=replace(run.blocks, p_r=limited(run.blocks.p_r, knee, _SLOPE)))
