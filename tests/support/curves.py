"""The data set of a version without its maps, for tests of curves and scalars alone."""

from dataclasses import replace

from calib.exports.build import build
from calib.exports.dataset import Dataset
from calib.store.version import Stored


def built(stored: Stored, *arguments, **options) -> Dataset:
    """The data set as of `build`, which takes the same arguments."""
    data = build(stored, *arguments, **options)
    axes = {axis.label for one in data.curves for axis in one.axes}
    return replace(data, maps=(), axes=tuple(one for one in data.axes if one.label in axes))
