"""What the intervals of the pads are made of, as bars."""

from typing import TYPE_CHECKING

import numpy as np

from calib.plots.style import FRONT, REAR
from calib.table.budget import AxleBudget

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Pair = tuple[AxleBudget, AxleBudget]
"""Budgets of the front and the rear pads."""


def bars(ax: "Axes", axles: Pair) -> None:
    """One pair of bars for each part, the largest on top, and one for all of them together.

    Beside each pair its two numbers, front first.
    """
    sizes = [{"all": axle.sigma, **axle.relative} for axle in axles]
    names = dict.fromkeys(name for size in sizes for name in size)
    values = 100.0 * np.array([[size.get(name, 0.0) for name in names] for size in sizes])
    order = np.argsort(-values.max(axis=0), kind="stable")
    rows = np.arange(order.size)
    for value, stroke, word, shift, hatch in (
        (values[0, order], FRONT, "front", -0.2, ""),
        (values[1, order], REAR, "rear", 0.2, "////"),
    ):
        look = {"facecolor": stroke["color"], "alpha": 0.75, "hatch": hatch, "edgecolor": "white"}
        ax.barh(rows + shift, value, 0.4, label=word, linewidth=0.0, **look)
    for row, (front, rear) in enumerate(values[:, order].T.tolist()):
        text = f" {front:.1f} / {rear:.1f}"
        ax.text(max(front, rear), row, text, va="center", fontsize=6.5)
    listed = list(names)
    ax.set_yticks(rows, [listed[i].replace("_", " ") for i in order])
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")
    ax.axhline(0.5, color="#7A7A7A", linewidth=0.6)
    ax.set_xlim(right=1.2 * float(values.max()))
    ax.set(xlabel="standard deviation; squares add up to that of all [%]")
