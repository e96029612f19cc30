"""A simulation, where the truth is known: Figs. 9 to 11, and the error of each torque."""

import numpy as np

from calib.show.sheet import Panel, Sheet
from calib.show.stop import frame, note, pad, result_of, stop_panels
from calib.show.style import (
    FRONT,
    LAW,
    NOMINAL,
    REAR,
    TRUTH,
    Array,
    Axes,
    Stroke,
    noisy,
    smooth,
    view,
    zero,
)
from calib.show.trace import AxleTrace, StopTrace

_BASELINE = "gradient_difference"
"""The paper's law with D(eta) for its look-up."""
METHODS = {_BASELINE: (r"gradient law on $D(\eta)$", LAW)}


def sheet(trace: StopTrace) -> Sheet:
    """Return the sheet of a simulated stop; the panels of `calib.show.stop` go with it by name.

    The trace must have truth (`Trace.has_truth`).
    """
    front = _panels(trace, trace.front, FRONT, "front", "10")
    rear = _panels(trace, trace.rear, REAR, "rear", "11")
    return Sheet(
        kind="simulation",
        name=trace.name,
        title=f"Simulation {trace.name}",
        note=note(trace),
        panels=(*front, *rear, *stop_panels(trace)),
        rows=tuple((f.name, r.name) for f, r in zip(front, rear, strict=True)),
        result=result_of(trace),
    )


def _panels(
    trace: StopTrace, axle: AxleTrace, stroke: Stroke, word: str, number: str
) -> tuple[Panel, ...]:
    """The three panels of one axle; ``number`` is that of its torque figure in the paper."""
    name, of = word.capitalize(), (trace, axle, stroke)
    left = f"{name} left brake torque"
    return (
        Panel(f"compensation-{word}", f"{name} pad friction (Fig. 9)", pad, (*of, METHODS), 2),
        Panel(f"torque-{word}-left", f"{left} (Fig. {number})", torque, of),
        Panel(f"error-{word}-left", f"{left}, error", error, of),
    )


def torque(ax: Axes, trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Figs. 10 and 11: the left wheel's torque, true, with nominal pads and compensated."""
    if axle.nominal_torque is not None:
        noisy(ax, trace.time, 0.5 * axle.nominal_torque, NOMINAL, "uncompensated")
    noisy(ax, trace.time, axle.wheel_torque, {**stroke, "linewidth": 1.7}, "compensated")
    if axle.true_wheel_torque is not None:
        ax.plot(trace.time, axle.true_wheel_torque, label="truth", **TRUTH)
    frame(ax, trace, "wheel torque [N m]")


def error(ax: Axes, trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Error of the torques of the left wheel, at valid samples."""
    true, law = axle.true_wheel_torque, axle.baselines.get(_BASELINE)
    if true is None:
        return
    nominal = None if axle.nominal_torque is None else 0.5 * axle.nominal_torque
    by_law = None if law is None else law / axle.pad * axle.wheel_torque
    zero(ax)
    curves = []
    for found, line, label in (
        (nominal, NOMINAL, "uncompensated"),
        (by_law, LAW, "gradient law"),
        (axle.wheel_torque, {**stroke, "linewidth": 1.7}, "compensated"),
    ):
        if found is not None:
            curves.append(smooth(trace.time, relative(found, true, trace)))
            ax.plot(trace.time, curves[-1], label=label, **line)
    view(ax, *curves, zero=True)
    frame(ax, trace, "torque error [%]")


def relative(found: Array, true: Array, trace: StopTrace) -> Array:
    """Relative error of ``found`` [%] (n,); NaN where not valid or where ``true`` is near zero."""
    known = trace.valid & (true > 0.0)
    return np.where(known, 100.0 * (found / np.where(known, true, 1.0) - 1.0), np.nan)
