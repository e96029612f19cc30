r"""Whether the top of a ramp may be believed: near their peak tyres yield more than a curve says.

    fit without the top of N   --> pads' ratio, sigma    \\
         | start                                          > apart, though the top made it no surer?
    fit of all blocks          --> pads' ratio, sigma    /      then without the top

The idea is that of Hausman (Econometrica 46, 1978): of two fits of which one uses more data, that
one is surer, and both agree. Where more data move the answer and leave it as unsure as it was, they
do not follow the model. On a wet road the peak may be at 0.6, and a ramp to 0.55 g bends the curve
more than a cubic can: the fit takes that for pads of another ratio.
"""

from dataclasses import replace

import numpy as np

from calib.car.vehicle import Vehicle
from calib.fitting.identify import Identified, identify
from calib.model.ramp import RampRun, nominal_forces
from calib.model.resistance import Resistance
from calib.model.settings import SETTINGS
from calib.table.table import Value


def identify_below_the_peak(
    vehicle: Vehicle, runs: list[RampRun], known: Resistance, stated: Value | None = None
) -> tuple[Identified, list[RampRun]]:
    """The fit of all runs together, `identify`; without their tops where these are not believed.

    It starts where the fit without the tops ended: from afar, a top that bends more than a cubic
    leads to pads of a third of their ratio, and to tyres of three times the other axle's stiffness.
    ``stated`` as `identify` has it.
    """
    lower = [_without_top(vehicle, run) for run in runs]
    if min(np.count_nonzero(run.braked) for run in lower) < SETTINGS.fewest_blocks:
        return identify(vehicle, runs, known, stated=stated)
    below, of_lower = identify(vehicle, lower, known, stated=stated)
    found, of_all = identify(vehicle, runs, known, below, stated)
    return (below, of_lower) if _misled(found, below) else (found, of_all)


def _without_top(vehicle: Vehicle, run: RampRun) -> RampRun:
    """A ramp less its highest forces; one with one axle only as it is."""
    if run.only is not None:
        return run
    force = sum(nominal_forces(vehicle, run, 0.0), np.zeros(run.use.size))
    use = run.use & (force <= SETTINGS.top * float(np.max(force[run.use])))
    return replace(run, use=use, believed_up_to=float(np.max(run.blocks.z[use])))


def _misled(found: Identified, below: Identified) -> bool:
    """Whether the tops move the ratio of the pads, and make it no surer."""
    name = "log_pad_ratio"
    apart = abs(found.posterior.value(name) - below.posterior.value(name))
    sigma = below.posterior.sigma(name)
    return apart > SETTINGS.top_apart * sigma and sigma < SETTINGS.top_surer * (
        found.posterior.sigma(name)
    )
