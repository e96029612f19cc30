"""Ramps with one axle only: which there are, and what they bought.

Per ramp only force share over stiffness is seen of each axle. An axle that brakes alone has a known
share, so it shows its tyres' stiffness; and its pads' level, against that of both axles, shows the
pads' ratio.
"""

from collections.abc import Iterator

import numpy as np

from calib.base.names import AXLE_NAMES
from calib.fitting.ensemble import Ensemble
from calib.model.ramp import RampRun


def with_both_axles(runs: list[RampRun]) -> list[RampRun]:
    """The normal ramps: the curves over eta are theirs alone."""
    return [run for run in runs if run.only is None]


def bought(runs: list[RampRun], found: Ensemble, without: Ensemble | None) -> Iterator[str]:
    """How well the ratios of pads and tyres are known with and ``without`` ramps of one axle."""
    alone = [f"{run.name} ({AXLE_NAMES[run.only]} axle only)" for run in runs if run.only]
    if without is None:
        return
    pads = [100.0 * float(np.std(e.log_pad_ratio)) for e in (found, without)]
    tyres = [
        100.0 * float(np.std(np.log(e.compliance_f / e.compliance_r))) for e in (found, without)
    ]
    yield (
        f"{', '.join(alone)}: pads' ratio known to {pads[0]:.1f} % ({pads[1]:.1f} % without), "
        f"tyres' ratio to {tyres[0]:.1f} % ({tyres[1]:.1f} %), one sigma"
    )
