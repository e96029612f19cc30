"""Finding what is drawn in a panel."""

import numpy as np


def panel(sheet, name):
    """The panel of that name."""
    (match,) = [one for one in sheet.panels if one.name == name]
    return match


def line(panel, label):
    """x and y of the one line of that label."""
    (match,) = [one for one in panel.lines if one.label == label]
    return np.asarray(match.x), np.asarray(match.y)


def labels(panel):
    """Labels of the lines."""
    return {one.label for one in panel.lines}
