"""Prior and posterior of each quantity that a fit draws, and the correlation of pads and tyres.

prior      |=========|      95 % interval for any car, by `calib.car.beliefs`: from -1 to 1
posterior     |-o-|         95 % interval of the draws of the table, on the same axis
"""

from typing import NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.car.beliefs import CAR, Belief
from calib.fitting.ensemble import ensemble_of
from calib.fitting.pads import pad_ratio_prior
from calib.show.panel import Line, Mark, Panel
from calib.show.style import FRONT, NOMINAL, SHADE, Array, dots
from calib.table.table import Table

_AXIS_END = 2.1
"""End of the axis, in 95 % half widths of a prior [1]."""


class _Quantity(NamedTuple):
    """A quantity with its prior, and its ``draws`` (n,) from the posterior."""

    name: str
    draws: Array
    prior: Belief


def quantities(table: Table) -> list[_Quantity]:
    """Return the quantities of a fit, pads and tyres first; ratios, grip and cg are logarithms."""
    e = ensemble_of(table.vehicle, table.draws)
    pad_sigma = pad_ratio_prior(table.vehicle, bench=None).sigma  # by the tolerances of the file
    pads = CAR.log_pad_ratio._replace(sigma=pad_sigma)
    compliance = 0.5 * (e.compliance_f + e.compliance_r)
    # ln of the ratio of two compliances near the usual one, to first order
    tyre_ratio = (e.compliance_f - e.compliance_r) / CAR.compliance.mean
    return [
        _Quantity("pad ratio", e.log_pad_ratio, pads),
        _Quantity("tyre ratio", tyre_ratio, CAR.log_tyre_ratio),
        _Quantity("tyre compliance", compliance, CAR.compliance),
        _Quantity("stiffness over load", e.load_exponent, CAR.load_exponent),
        _Quantity("grip of the road", np.log(e.peak), CAR.peak),
        _Quantity("grip over load", e.peak_load_exponent, CAR.peak_load_exponent),
        _Quantity("radius over load", e.radius_load, CAR.radius_load),
        _Quantity("cg to front axle", np.log(e.cg_to_front_axle), CAR.cg_to_front_axle),
        _Quantity("cg height", np.log(e.cg_height), CAR.cg_height),
    ]


def forest(table: Table) -> Panel:
    """Return the panel with prior and posterior of each quantity, and the ratio of their widths."""
    rows = quantities(table)[::-1]
    lines, texts = list[Line](), []
    for i, quantity in enumerate(rows):
        prior = quantity.prior
        scaled = (quantity.draws - prior.mean) / (Z95 * prior.sigma)  # in half widths of the prior
        low, middle, high = np.quantile(scaled, [0.025, 0.5, 0.975])
        label = "" if i else "posterior, 95 %"
        lines.append(Line([low, high], [i, i], FRONT, label))
        lines.append(Line([middle], [i], dots(FRONT, 4.0)))
        share = 0.5 * (high - low)  # width of the posterior over that of the prior, which is 2
        texts.append((f"{100.0 * share:.0f} % left", _AXIS_END, i + 0.25))
    return Panel(
        "posterior",
        "Prior and posterior",
        "in 95 % half widths of the prior [1]",
        "",
        lines,
        [Mark(-1.0, 1.0, {"color": SHADE}, "prior, 95 %")],
        texts,
        xlim=(-_AXIS_END, _AXIS_END),
        ylim=(-0.6, len(rows) - 0.4),
        yticks=[quantity.name for quantity in rows],
        columns=2,
    )


def pairs(table: Table) -> Panel:
    """Return the panel with the draws of pad and tyre ratio; a ramp without v tells their sum."""
    pad, tyre, *_ = quantities(table)
    look = dots(NOMINAL, 2.0, alpha=0.6, rasterized=True)
    lines = [Line(100.0 * pad.draws, 100.0 * tyre.draws, look)]
    correlation = float(np.corrcoef(pad.draws, tyre.draws)[0, 1])
    return Panel(
        "pairs",
        f"Pads against tyres, correlation {correlation:.2f}",
        "ln of front over rear pads, less that of the file [%]",
        "front less rear compliance, over the usual one [%]",
        lines,
    )
