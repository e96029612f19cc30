"""Whether the axles of a log are those of its table, or their wheel speeds are swapped.

The front wheels must slip more than the rear while braking. Where they slip less, the wheel speeds
are swapped, a motor brakes the rear wheels, or the front pads are weak. The estimate tells weak
pads: with them the rear pads keep their friction.

    eta falls    rear pads as on the ramp     weak front pads: estimated
                 rear pads stronger           refused
"""

import numpy as np

from calib.checks.gates import bitten, eta_rise
from calib.checks.swapped import what_to_check
from calib.errors import LogError
from calib.estimation.estimator import Estimate
from calib.logs.log import Log
from calib.signals.axle_signals import signals
from calib.signals.blocks import blocks
from calib.signals.one_axle import braked_alone
from calib.table.table import Table

REVERSED = 0.5
"""Share of the table's rise of eta by which eta must fall for the axles to count as reversed."""

GAIN = 1.1
"""Friction of the rear pads over that on the ramp [1] that no weak front pads explain.

Swapped wheel speeds need 1.2 or more, beside weak front pads the rear ones keep theirs
(`tests/studies/weak_pads.py`)."""


def require_same_axles(table: Table, log: Log, e: Estimate) -> None:
    """Raise LogError if the log clearly has its axles swapped, or a motor brakes the rear wheels.

    Weak front pads reverse the slip of the axles too. They are told by ``e``, the estimate of the
    log: with them the rear pads keep their friction. Where all pads are weak and the axles are
    swapped as well, it cannot be told.
    """
    fall = _reversed_slip(table, log)
    if fall is None:
        return
    rise, expected = fall
    said = f"the front wheels slip less than the rear while braking: eta {100 * rise:+.2f} %"
    if e.valid.any():
        gain = float(np.median(e.rear.change[e.valid]))
        if float(np.median(e.rear.change_lower[e.valid])) < GAIN:
            return
        said += f", as if the rear pads had {gain:.2g} times their friction on the ramp"
    raise LogError(
        said,
        where=log.source,
        expected=f"about {100 * expected:+.2f} % by the table of {table.name}",
        do=what_to_check("rear", mirrored=-1.5 < rise / expected < -0.5),
    )


def _reversed_slip(table: Table, log: Log) -> tuple[float, float] | None:
    """Rise of eta under braking and what the table expects [1], if it clearly falls; else None."""
    b = blocks(signals(log, table.vehicle))
    if braked_alone(b.p_f, b.p_r) == "r":
        return None  # eta falls, as it must
    known = (b.z > 0.05) & (b.z < table.paper.z[-1])
    braked = known & (b.end > bitten(b)) & (b.speed > 5.0)
    rise, error = eta_rise(b, braked)
    if not np.isfinite(rise):
        return None
    expected = float(np.median(np.interp(b.z[braked], table.paper.z, table.paper.eta))) - 1.0
    clear = expected > 0.0 and rise + 4.0 * error < -REVERSED * expected
    return (rise, expected) if clear else None
