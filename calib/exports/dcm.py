"""DCM, the conservation format 2.0 of ETAS: a text format with German keywords.

    KONSERVIERUNG_FORMAT 2.0
    STUETZSTELLENVERTEILUNG  an axis that curves share
    GRUPPENKENNLINIE         a curve over such an axis, which it names after *SSTX and repeats
    KENNLINIE                a curve with an axis of its own
    FESTWERT                 a scalar

The format has no range, no digest and no end mark: ranges and the facts of the table are comments.
The number of objects is among the facts, so that a file cut off between two objects is detected.
Every number is written so that it reads back to the last bit.
"""

from collections.abc import Iterator

from calib.exports.dataset import Axis, Curve, Dataset, Scalar, span
from calib.exports.labels import printable

PER_LINE = 6
"""Numbers on one line of an array."""

FUNCTION = "brake_torque"
"""Name of the function that the objects belong to."""


def write_dcm(data: Dataset) -> bytes:
    """DCM file of ``data``, UTF-8."""
    lines = ['* encoding="UTF-8"', "* DCM written by brake-cal"]
    lines += [f"* {key}: {printable(value)}" for key, value in data.facts().items()]
    function = f"{data.prefix}_{FUNCTION}"
    lines += ["", "KONSERVIERUNG_FORMAT 2.0", "", "FUNKTIONEN"]
    lines += [f"  FKT {function} {_text(str(data.version))} {_text(data.id)}", "END"]
    for axis in data.axes:
        if axis.shared:
            lines += ["", *_distribution(axis, function)]
    for curve in data.curves:
        lines += ["", *_curve(curve, data.axis(curve.axis), function)]
    for scalar in data.scalars:
        lines += ["", *_scalar(scalar, function)]
    return ("\n".join(lines) + "\n").encode()


def _distribution(axis: Axis, function: str) -> Iterator[str]:
    yield f"STUETZSTELLENVERTEILUNG {axis.label} {len(axis.values)}"
    yield f"* {span(axis.values)}, strictly increasing"
    yield f"  LANGNAME {_text(axis.meaning)}"
    yield f"  FUNKTION {function}"
    yield f"  EINHEIT_X {_text(axis.unit)}"
    yield from _numbers("ST/X", axis.values.tolist())
    yield "END"


def _curve(curve: Curve, axis: Axis, function: str) -> Iterator[str]:
    kind = "GRUPPENKENNLINIE" if axis.shared else "KENNLINIE"
    yield f"{kind} {curve.label} {len(curve.values)}"
    yield f"* {span(curve.values)}; clamped beyond the ends of its axis"
    yield f"  LANGNAME {_text(curve.meaning)}"
    yield f"  FUNKTION {function}"
    yield f"  EINHEIT_X {_text(axis.unit)}"
    yield f"  EINHEIT_W {_text(curve.unit)}"
    if axis.shared:
        yield f"*SSTX {axis.label}"
    yield from _numbers("ST/X", axis.values.tolist())
    yield from _numbers("WERT", curve.values.tolist())
    yield "END"


def _scalar(scalar: Scalar, function: str) -> Iterator[str]:
    yield f"FESTWERT {scalar.label}"
    if scalar.sigma is not None:
        yield f"* one standard deviation {scalar.sigma!r}"
    yield f"  LANGNAME {_text(scalar.meaning)}"
    yield f"  FUNKTION {function}"
    yield f"  EINHEIT_W {_text(scalar.unit)}"
    yield f"  WERT {scalar.value!r}"
    yield "END"


def _numbers(word: str, values: list[float]) -> Iterator[str]:
    for i in range(0, len(values), PER_LINE):
        yield f"  {word} " + " ".join(repr(v) for v in values[i : i + PER_LINE])


def _text(text: str) -> str:
    """A quoted text; the format has no escapes."""
    plain = printable(text).replace('"', "'").replace("\\", "/")
    return f'"{plain}"'
