"""When the estimate of a stop is valid, and why not.

valid                      ==============
the brakes are released    ====
the car is slow                          ==
"""

from typing import TYPE_CHECKING

import numpy as np

from calib.logs.clock import step_of
from calib.plots.style import IDENTIFIED, NOMINAL
from calib.plots.trace import StopTrace
from calib.signals.filters import runs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEAST = 0.02
"""Share of the log from which a reason is drawn."""


def validity(ax: "Axes", trace: StopTrace) -> None:
    """When the estimate is valid, and each reason why it is not, as bars over time."""
    step = step_of(trace.time)
    reasons = {why: mask for why, mask in trace.refused.items() if np.mean(mask) >= LEAST}
    rows = {"valid": trace.valid, **reasons}
    for place, (word, mask) in enumerate(rows.items()):
        spans = [(trace.time[a], (b - a) * step) for a, b in runs(mask)]
        colour = NOMINAL["color"] if place else IDENTIFIED["color"]
        ax.broken_barh(spans, (place, 0.34), color=colour, lw=0.0)
        lasts = f" {word}: {step * np.count_nonzero(mask):.1f} s"
        ax.text(trace.time[0], place - 0.08, lasts, fontsize=7.0, va="bottom")
    ax.set_ylim(len(rows) - 0.4, -0.7)
    ax.set_yticks([])
    ax.set(xlabel="time [s]")
    ax.set_xlim(trace.time[0], trace.time[-1])
