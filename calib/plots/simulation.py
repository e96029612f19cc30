"""A simulation, where the truth is known: Figs. 9 to 11, and the error of each torque."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.plots.sheet import Panel, Sheet
from calib.plots.stop import frame, held, note, pad_estimate, result_of, stop_panels
from calib.plots.style import BODY, FRONT, LAW, NOMINAL, REAR, TRUTH, Stroke, noisy, smooth, view
from calib.plots.trace import AxleTrace, StopTrace

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

BASELINE = "gradient_difference"
"""The paper's law with D(eta) for its look-up."""


def sheet(trace: StopTrace) -> Sheet:
    """Return the sheet of a simulated stop; the panels of `calib.plots.stop` go with it by name.

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
    name = word.capitalize()
    return (
        Panel(
            f"compensation-{word}",
            f"{name} pad friction (Fig. 9)",
            lambda ax: compensation(ax, trace, axle, stroke),
            columns=2,
        ),
        Panel(
            f"torque-{word}-left",
            f"{name} left brake torque (Fig. {number})",
            lambda ax: torque(ax, trace, axle, stroke),
        ),
        Panel(
            f"error-{word}-left",
            f"{name} left brake torque, error",
            lambda ax: error(ax, trace, axle, stroke),
        ),
    )


def compensation(ax: "Axes", trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Fig. 9, one axle: truth, nominal, the estimate with its interval, and the gradient law."""
    curves = [axle.lower, axle.upper]
    if BASELINE in axle.baselines:
        law = held(trace, axle.baselines[BASELINE])
        ax.plot(trace.time, law, label=r"gradient law on $D(\eta)$", **LAW)
        curves.append(axle.baselines[BASELINE])
    pad_estimate(ax, trace, axle, stroke)
    if axle.true_pad is not None:
        curves.append(axle.true_pad)
    nominal = [] if axle.nominal is None else [np.array([axle.nominal])]
    view(ax, *(values[trace.valid] for values in curves), *nominal)
    frame(ax, trace, "pad friction [1]")


def torque(ax: "Axes", trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Figs. 10 and 11: the left wheel's torque, true, with nominal pads and compensated."""
    if axle.nominal_torque is not None:
        noisy(ax, trace.time, 0.5 * axle.nominal_torque, NOMINAL, "uncompensated")
    noisy(ax, trace.time, axle.wheel_torque, {**stroke, "linewidth": 1.7}, "compensated")
    if axle.true_wheel_torque is not None:
        ax.plot(trace.time, axle.true_wheel_torque, label="truth", **TRUTH)
    frame(ax, trace, "wheel torque [N m]")


def error(ax: "Axes", trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Error of the torques of the left wheel, at valid samples."""
    true = axle.true_wheel_torque
    if true is None:
        return
    shown = [("compensated", axle.wheel_torque, {**stroke, "linewidth": 1.7})]
    if BASELINE in axle.baselines:
        shown.insert(
            0, ("gradient law", axle.baselines[BASELINE] / axle.pad * axle.wheel_torque, LAW)
        )
    if axle.nominal_torque is not None:
        shown.insert(0, ("uncompensated", 0.5 * axle.nominal_torque, NOMINAL))
    ax.axhline(0.0, color=BODY["color"], linewidth=0.6)
    curves = [smooth(trace.time, relative(found, true, trace)) for _, found, _ in shown]
    for curve, (label, _, line) in zip(curves, shown, strict=True):
        ax.plot(trace.time, curve, label=label, **line)
    view(ax, *curves, zero=True)
    frame(ax, trace, "torque error [%]")


def relative(found: Array, true: Array, trace: StopTrace) -> Array:
    """Relative error of ``found`` [%] (n,); NaN where not valid or where ``true`` is near zero."""
    known = trace.valid & (true > 0.0)
    return np.where(known, 100.0 * (found / np.where(known, true, 1.0) - 1.0), np.nan)
