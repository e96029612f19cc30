"""%GRR of all metrics of a gauge study as one row of cells, and one of their tolerances.

of the cars       [ 12 ][ 8 ][ the cars do not differ ]
of the tolerance  [ 20 ][   ][           15           ]
"""

from typing import TYPE_CHECKING

from calib.gauge.study import GOOD_GRR, GaugeResult, GaugeStudy, GaugeVerdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLES = {
    "pad_scale": "pad level",
    "pad_friction_f": "front pads",
    "pad_friction_r": "rear pads",
    "eta_zero": r"zero of $\eta$",
    "slip_stiffness": "slip stiffness",
    "difference": "$D$",
    "f1": "$f_1$",
    "f2": "$f_2$",
}
"""The metrics in words; another one has its own name."""
HEAT = {
    GaugeVerdict.GOOD: "#BFE3D6",
    GaugeVerdict.MARGINAL: "#F3E3A9",
    GaugeVerdict.BAD: "#F0B08C",
    GaugeVerdict.ALIKE: "#D9D9D9",
    GaugeVerdict.NOT_JUDGED: "#FFFFFF",
}
"""Colours of the verdicts; each cell says its verdict in words too."""


def title_of(result: GaugeResult) -> str:
    """The metric in words."""
    return TITLES.get(result.name, result.name.replace("_", " "))


def heat(ax: "Axes", found: GaugeStudy) -> None:
    """One cell for each metric with %GRR and ndc; below it %GRR of its tolerance, where known."""
    rows = {"of the cars": _of_cars}
    if any(_tolerance(result) is not None for result in found.results):
        rows["of the tolerance"] = _of_tolerance
    for j, cell in enumerate(rows.values()):
        for i, result in enumerate(found.results):
            text, verdict = cell(result)
            _fill(ax, i, j, HEAT[verdict])
            ax.text(i, j, text, ha="center", va="center", fontsize=7.0)
    ax.set_xlim(-0.5, len(found.results) - 0.5)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    names = [f"{title_of(result)}\n{_short(result)}" for result in found.results]
    ax.set_xticks(range(len(found.results)), names)
    ax.set_yticks(range(len(rows)), list(rows))
    ax.tick_params(length=0)
    ax.grid(visible=False)
    ax.spines[:].set_visible(False)


def _fill(ax: "Axes", i: int, j: int, colour: str) -> None:
    from matplotlib.patches import Rectangle

    ax.add_patch(Rectangle((i - 0.48, j - 0.46), 0.96, 0.92, color=colour, linewidth=0.0))


def _short(result: GaugeResult) -> str:
    return "no verdict" if result.verdict == GaugeVerdict.ALIKE else result.verdict


def _tolerance(result: GaugeResult) -> float | None:
    return None if result.gauge is None else result.gauge.tolerance


def _of_cars(result: GaugeResult) -> tuple[str, GaugeVerdict]:
    gauge = result.gauge
    if gauge is None:
        return "repeats do\nnot scatter", GaugeVerdict.NOT_JUDGED
    if not gauge.cars_differ:
        return "the cars\ndo not differ", GaugeVerdict.ALIKE
    text = f"{100.0 * gauge.grr:.0f} %\nndc {gauge.categories}"
    return text, _colour(result, gauge.grr, ("grr", "ndc"))


def _of_tolerance(result: GaugeResult) -> tuple[str, GaugeVerdict]:
    share = _tolerance(result)
    if share is None:
        return "not known", GaugeVerdict.NOT_JUDGED
    return f"{100.0 * share:.0f} %", _colour(result, share, ("grr_of_tolerance",))


def _colour(result: GaugeResult, share: float, figures: tuple[str, ...]) -> GaugeVerdict:
    """The verdict of one cell: by its own limits."""
    if any(j.passed is False for j in result.judgements if j.figure in figures):
        return GaugeVerdict.BAD
    return GaugeVerdict.GOOD if share <= GOOD_GRR else GaugeVerdict.MARGINAL
