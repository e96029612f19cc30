"""Finding what is drawn in a panel."""

import numpy as np


def panel(sheet, name):
    """The panel of that name."""
    (found,) = [one for one in sheet.panels if one.name == name]
    return found


def line(panel, label):
    """x and y of the one line of that label."""
    (found,) = [one for one in panel.lines if one.label == label]
    return np.asarray(found.x), np.asarray(found.y)


def labels(panel):
    """Labels of the lines."""
    return {one.label for one in panel.lines}
