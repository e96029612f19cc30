"""CSV of calibration values in the style of INCA: one block per object, with empty lines between.

The first line gives version, separator, decimal point, mark of a comment and quotes. A curve over a
shared axis names it and repeats its points, for readers without shared axes. The format is the one
that public readers expect; it was not tested with INCA itself.
"""

from collections.abc import Iterator

from calib.exports.dataset import Axis, Curve, Dataset, Scalar
from calib.exports.dcm import FUNCTION
from calib.exports.labels import printable

HEAD = 'CALIBRATION VALUES V2.1;.;*;""'


def write_inca_csv(data: Dataset) -> bytes:
    """CSV file of ``data``, UTF-8 with CR LF."""
    function = f"{data.prefix}_{FUNCTION}"
    lines = [HEAD, ""]
    lines += [f"* {key}: {printable(value)}" for key, value in data.facts().items()]
    lines += ["", "FUNCTION_HDR;;", f';"{function}"']
    for axis in data.axes:
        if axis.shared:
            lines += ["", *_axis(axis)]
    for curve in data.curves:
        lines += ["", *_curve(curve, data.axis(curve.axis)), f'FUNCTION;;"{function}"']
    for scalar in data.scalars:
        lines += ["", *_scalar(scalar), f'FUNCTION;;"{function}"']
    return ("\r\n".join(lines) + "\r\n").encode()


def _axis(axis: Axis) -> Iterator[str]:
    yield f";{axis.label}"
    yield f"AXIS_PTS;{_unit(axis.unit)};{_numbers(axis.values.tolist())}"


def _curve(curve: Curve, axis: Axis) -> Iterator[str]:
    yield f";{curve.label}"
    yield f"CURVE;{axis.label if axis.shared else ''};"
    yield f"X_AXIS_PTS;{_unit(axis.unit)};{_numbers(axis.values.tolist())}"
    yield f";{_unit(curve.unit)};{_numbers(curve.values.tolist())}"


def _scalar(scalar: Scalar) -> Iterator[str]:
    yield f";{scalar.label}"
    yield f"VALUE;{_unit(scalar.unit)};{scalar.value!r}"


def _unit(unit: str) -> str:
    return f'"[{unit}]"'


def _numbers(values: list[float]) -> str:
    return ";".join(repr(v) for v in values)
