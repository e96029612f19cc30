"""Whether something limits the rear pressure of a ramp: a valve missing in the vehicle file.

    p_r |        .-'   p_k + s (p - p_k)        one p_mc for both axles: nobody measured p_r
        |     .-'
        |   /
        | /            the pads' ratio would bend at p_k; tyre, clock and pads imitate that
        +---+---------> p_mc

A fit follows such a ramp closely, with a tyre and a clock that no car has. So the ramp is fitted
with some knees, and what tyre, clock and pads must be for it counts as much as the residuals.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from calib.base.units import from_si
from calib.base.warning import PlausibilityWarning
from calib.car.effects.line import limited
from calib.car.vehicle import Vehicle
from calib.fitting.identify import Identified, misfits
from calib.model.parameters import priors_with
from calib.model.ramp import RampRun
from calib.model.resistance import Resistance
from calib.model.settings import SETTINGS
from calib.table.table import Value

VALVE = "rear_proportioning"


def rear_valve_warnings(
    vehicle: Vehicle,
    found: Identified,
    runs: list[RampRun],
    known: Resistance,
    stated: Value | None = None,
) -> Iterator[PlausibilityWarning]:
    """A warning where a knee of the rear pressure explains the ramps clearly better.

    ``found`` the fit of ``runs`` without one. Not asked where the fit needs nothing unlikely, or
    where a valve is declared or the pressures of both axles are logged. ``stated`` as
    `calib.fitting.identify.identify` has it.
    """
    mean = zip(found.mean, priors_with(stated), strict=True)
    unlikely = sum(((value - prior.mean) / prior.sigma) ** 2 for value, prior in mean)
    measured = any(not np.array_equal(run.blocks.p_f, run.blocks.p_r) for run in runs)
    if unlikely < SETTINGS.valve_doubt or measured or VALVE in vehicle.effects:
        return
    highest = max(float(np.max(run.blocks.p_r[run.use])) for run in runs)
    knees = [knee for knee in SETTINGS.valve_knees if knee < SETTINGS.valve_reach * highest]
    if not knees:
        return
    tried = [[_limited(run, knee) for run in runs] for knee in knees]
    without, *with_knee = misfits(vehicle, [runs, *tried], known, stated)
    loss, knee = min(zip(with_knee, knees, strict=True))
    fall = without - loss
    if fall > SETTINGS.valve_gain:
        yield PlausibilityWarning(
            "rear_pressure_limited",
            ", ".join(run.name for run in runs),
            fall,
            (0.0, SETTINGS.valve_gain),
            (
                f"a valve or a control unit that limits the rear pressure, from some "
                f"{from_si(knee, 'bar', 'Pa'):g} bar on",
                "rear pads that lose friction with pressure or heat",
            ),
            "log the pressures of the rear wheels, or declare rear_proportioning in the vehicle "
            "file (`brake-cal diagnose` finds its knee)",
        )


def _limited(run: RampRun, knee: float) -> RampRun:
    """The run with a usual valve of that ``knee`` [Pa] at the rear axle."""
    p_r = limited(run.blocks.p_r, knee, SETTINGS.valve_slope)
    return replace(run, blocks=replace(run.blocks, p_r=p_r))
