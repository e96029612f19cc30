"""Ramps with one axle only: which there are, and what they bought.

Per ramp only force share over stiffness is seen of each axle. An axle that brakes alone has a known
share, so it shows its tyres' stiffness; and its pads' level, against that of both axles, shows the
pads' ratio.
"""

from collections.abc import Iterator

from calib.base.names import AXLE_NAMES
from calib.car.vehicle import Vehicle
from calib.fitting.identify import Identified, identify_once
from calib.model.ramp import RampRun
from calib.model.resistance import Resistance
from calib.table.table import Value


def with_both_axles(runs: list[RampRun]) -> list[RampRun]:
    """The normal ramps: the curves over eta are theirs alone."""
    return [run for run in runs if run.only is None]


def bought(
    vehicle: Vehicle,
    found: Identified,
    runs: list[RampRun],
    known: Resistance,
    stated: Value | None = None,
) -> Iterator[str]:
    """How well the ratios of pads and tyres are known with and without ramps of one axle.

    ``stated`` as `calib.fitting.identify.identify` has it.
    """
    alone = [f"{run.name} ({AXLE_NAMES[run.only]} axle only)" for run in runs if run.only]
    if not alone:
        return
    without = identify_once(vehicle, with_both_axles(runs), known, stated=stated).posterior
    pads, tyres = (
        [100.0 * posterior.sigma(name) for posterior in (found.posterior, without)]
        for name in ("log_pad_ratio", "log_tyre_ratio")
    )
    yield (
        f"{', '.join(alone)}: pads' ratio known to {pads[0]:.1f} % ({pads[1]:.1f} % without), "
        f"tyres' ratio to {tyres[0]:.1f} % ({tyres[1]:.1f} %), one sigma"
    )
