"""Finding what was drawn in a pair of axes."""

import numpy as np
from matplotlib.figure import Figure


def axes():
    return Figure().subplots()


def line(ax, label):
    """x and y of the one line of that label."""
    (found,) = [one for one in ax.get_lines() if one.get_label() == label]
    return found.get_xdata(), found.get_ydata()


def labels(ax):
    return ax.get_legend_handles_labels()[1]


def drawn(ax, x, y):
    """Whether some line of ``ax`` goes through exactly these points."""
    return any(
        np.array_equal(one.get_xdata(), x) and np.array_equal(one.get_ydata(), y, equal_nan=True)
        for one in ax.get_lines()
    )
