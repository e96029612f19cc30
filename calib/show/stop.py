"""A stop with its estimate: the panels of Figs. 13 to 16, and with truth those of Figs. 9 to 11."""

import numpy as np

from calib.estimation.validate import Validation
from calib.logs.clock import step_of
from calib.run.filters import runs
from calib.show.sheet import Panel, Sheet
from calib.show.style import (
    BODY,
    DASH_DOT,
    DOTTED,
    FRONT,
    IDENTIFIED,
    LAW,
    LEVEL,
    NOMINAL,
    REAR,
    TRUTH,
    WHEEL_STROKES,
    Array,
    Axes,
    Mask,
    Stroke,
    band,
    lines,
    noisy,
    shade,
    smooth,
    stripe,
    view,
)
from calib.show.trace import AxleTrace, StopTrace

WHY = "Where the estimate is valid, and why not"
_SHADED = "Grey: the sample is not valid, and no estimate is drawn."
CHANGED = "Dotted vertical line: a change of surface was detected."
_BUMPS = "Striped: wheels or a_x are thrown about, as over a bump; left out of the split."
_RATIO: Stroke = {"color": "#009E73", "linestyle": DASH_DOT}
_SLIP_MEAN = 0.3
"""Window of the mean of slip [s]; longer, as slip is a difference of two nearly equal speeds."""
BASELINES: dict[str, tuple[str, Stroke]] = {
    "mean_gain": ("one mean gain, [16]", LEVEL),
    "gradient_paper": ("gradient law, paper look-up", LAW),
    "rls_tyre": ("least squares, tyre look-up", {"color": "#E69F00", "linestyle": DOTTED}),
}
"""Methods that can be drawn beside the estimate: one of each kind, so that it stays visible."""
_NOMINALS = {"front": DASH_DOT, "rear": DOTTED}
_LEAST = 0.02
"""Share of the log from which a reason for not being valid is drawn."""
_EVERY = 5
"""Samples between two points of a drawn line: 25 ms at 200 Hz, less than the window of its mean."""


def sheet(trace: StopTrace) -> Sheet:
    """Return the sheet of one stop. Panels for which the source has no data are left out."""
    panels = _panels(trace)
    names = [panel.name for panel in panels]
    rows = [(names[i], names[min(i + 1, len(names) - 1)]) for i in range(0, len(names), 2)]
    return Sheet(
        kind="simulation" if trace.has_truth else "stop",
        name=trace.name,
        title=f"{'Simulation' if trace.has_truth else 'Stop'} {trace.name}",
        note=_note(trace),
        panels=panels,
        rows=tuple(rows),
        result=_result_of(trace),
    )


def _result_of(trace: StopTrace) -> str:
    """Verdict and pads in words."""
    front, rear = ("none" if found is None else found for found in trace.pads)
    words = f"pad friction front {front}, rear {rear} (95 %)"
    words = f"{trace.verdict}; {words}" if trace.verdict else words
    return words[0].upper() + words[1:]


def _note(trace: StopTrace) -> str:
    """Note of the page: source of the data and meaning of the marks."""
    changed = (CHANGED,) if trace.changes else ()
    bumps = (_BUMPS,) if trace.bumps else ()
    return " ".join((*trace.notes, _SHADED, *changed, *bumps, "Bands are 95 %."))


def _panels(trace: StopTrace) -> tuple[Panel, ...]:
    """Panels of a stop in the order of Fig. 13."""
    front, rear, of = trace.front, trace.rear, (trace,)
    ratio = "Speed ratio" if front.slip is None else "Slip and speed ratio"
    pad_f, pad_r = (
        word if pads is None else f"{word}: {pads}"
        for word, pads in zip(("Front pad friction", "Rear pad friction"), trace.pads, strict=True)
    )
    found = (
        (trace.wheels, Panel("wheel-speeds", "Wheel speeds", _wheel_speeds, of, 5)),
        (True, Panel("deceleration", "Deceleration", deceleration, of)),
        (True, Panel("normalised-forces", "Normalised forces", _normalised_forces, of)),
        (True, Panel("slip", ratio, slip, of)),
        (True, Panel("pad-front", pad_f, pad, (trace, front, FRONT), 2)),
        (True, Panel("pad-rear", pad_r, pad, (trace, rear, REAR), 2)),
        (True, Panel("axle-torques", "Axle brake torques", _axle_torques, of, 2)),
        (trace.has_truth, Panel("error", "Error of the torques", error, of, 2)),
        (trace.refused, Panel("validity", WHY, validity, of)),
    )
    return tuple(panel for there, panel in found if there)


def _frame(ax: Axes, trace: StopTrace, ylabel: str) -> None:
    """Shade, mark and label an axis over time."""
    shade(ax, trace.time, ~trace.valid)
    for start, end in trace.bumps:
        stripe(ax, start, end)
    for time in trace.changes:
        ax.axvline(time, color=BODY["color"], linestyle=DOTTED, linewidth=1.0)
    ax.set(xlabel="time [s]", ylabel=ylabel)
    ax.set_xlim(trace.time[0], trace.time[-1])


def _wheel_speeds(ax: Axes, trace: StopTrace) -> None:
    """Wheel speeds, panel (a)."""
    if trace.v_wheel is not None:  # first, so that it is drawn below the wheels
        ax.plot(trace.time, trace.v_wheel, label="$V/R$", linewidth=1.0, **BODY)
    for wheel, omega in trace.wheels.items():
        ax.plot(trace.time, omega, label=wheel, linewidth=1.0, **WHEEL_STROKES[wheel])
    _frame(ax, trace, "wheel speed [rad/s]")


def deceleration(ax: Axes, trace: StopTrace) -> None:
    """Deceleration, panel (b)."""
    lines(ax, trace.time, [(trace.z, BODY, "$z = -a_x/g$")])
    _frame(ax, trace, "deceleration [g]")


def _normalised_forces(ax: Axes, trace: StopTrace) -> None:
    """Normalised forces, panel (c)."""
    front, rear = trace.front.force, trace.rear.force
    lines(ax, trace.time, [(front, FRONT, "front $F_f$"), (rear, REAR, "rear $F_r$")])
    _frame(ax, trace, "normalised force [1]")


def slip(ax: Axes, trace: StopTrace) -> None:
    """Slips where v is known, and eta, which needs the wheel speeds only."""
    slips = [None if axle.slip is None else 100.0 * axle.slip for axle in (trace.front, trace.rear)]
    rows = [
        (slips[0], FRONT, "front slip"),
        (slips[1], REAR, "rear slip"),
        (100.0 * (trace.eta - 1.0), _RATIO, r"$\eta - 1$, zeroed"),
    ]
    lines(ax, trace.time, rows, _SLIP_MEAN, trace.valid)
    ratio = r"$\eta - 1$ [%]"
    _frame(ax, trace, ratio if trace.front.slip is None else f"slip, {ratio}")


def pad(ax: Axes, trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Panel (d) and Fig. 9, one axle: the estimate with its interval, truth, nominal, others.

    The valid samples set the range of y; other methods may leave it, but widen it to a limit.
    """
    shown = []
    for name, (label, thin) in BASELINES.items():
        if (values := axle.baselines.get(name)) is not None:
            ax.plot(trace.time, _held(trace, values), label=label, **thin)
            if np.isfinite(values[trace.valid]).any():
                shown.append(np.nanpercentile(values[trace.valid], [5, 95]))
    band(ax, trace.time, _held(trace, axle.lower), _held(trace, axle.upper), stroke)
    label = r"estimate $\mu_{p,c}$, 95 %"
    ax.plot(trace.time, _held(trace, axle.pad), label=label, **{**stroke, "linewidth": 1.7})
    if axle.nominal is not None:
        ax.axhline(axle.nominal, label=rf"$\mu_{{p,n}}$ {trace.nominal_of}", **NOMINAL)
        shown.append(np.array([axle.nominal]))
    if axle.true_pad is not None:
        ax.plot(trace.time, smooth(trace.time, axle.true_pad), label="truth", **TRUTH)
        shown.append(axle.true_pad[trace.valid])
    view(ax, axle.lower[trace.valid], axle.upper[trace.valid], *shown)
    _frame(ax, trace, "pad friction [1]")


def _held(trace: StopTrace, values: Array) -> Array:
    """``values`` (n,), NaN where the estimate is not valid."""
    return np.where(trace.valid, values, np.nan)


def _axle_torques(ax: Axes, trace: StopTrace) -> None:
    """Panel (e), Figs. 10 and 11: per axle, with nominal pads, compensated and true."""
    for axle, stroke, word in ((trace.front, FRONT, "front"), (trace.rear, REAR, "rear")):
        noisy(ax, trace.time, axle.torque / 1e3, stroke, f"{word} compensated")
        if axle.nominal_torque is not None:
            thin = {"color": stroke["color"], "linestyle": _NOMINALS[word], "linewidth": 0.9}
            label = f"{word}, pads {trace.nominal_of}"
            noisy(ax, trace.time, axle.nominal_torque / 1e3, thin, label)
        if axle.true_torque is not None:
            ax.plot(trace.time, axle.true_torque / 1e3, label=f"{word} truth", **TRUTH)
    _frame(ax, trace, "axle torque [kN m]")


def error(ax: Axes, trace: StopTrace) -> None:
    """Error of each axle's torque, compensated and with nominal pads, where it is valid."""
    rows = []
    for axle, stroke, word in ((trace.front, FRONT, "front"), (trace.rear, REAR, "rear")):
        thin = {"color": stroke["color"], "linestyle": _NOMINALS[word], "linewidth": 0.9}
        for found, look, of in (
            (axle.torque, stroke, "compensated"),
            (axle.nominal_torque, thin, "nominal"),
        ):
            if found is not None and axle.true_torque is not None:
                off = relative(found, axle.true_torque, trace.valid)
                rows.append((off, look, f"{word} {of}"))
    lines(ax, trace.time, rows)
    _frame(ax, trace, "torque error [%]")


def relative(found: Array, true: Array, valid: Mask) -> Array:
    """Relative error of ``found`` [%] (n,); NaN where not valid or where ``true`` is near zero."""
    known = valid & (true > 0.0)
    return np.where(known, 100.0 * (found / np.where(known, true, 1.0) - 1.0), np.nan)


def validity(ax: Axes, trace: StopTrace) -> None:
    """When the estimate is valid, and each reason why it is not, as bars over time."""
    step = step_of(trace.time)
    reasons = {why: mask for why, mask in trace.refused.items() if np.mean(mask) >= _LEAST}
    rows = {"valid": trace.valid, **reasons}
    for place, (word, mask) in enumerate(rows.items()):
        spans = [(trace.time[a], (b - a) * step) for a, b in runs(mask)]
        colour = NOMINAL["color"] if place else IDENTIFIED["color"]
        ax.broken_barh(spans, (place, 0.34), color=colour, lw=0.0)
        lasts = f" {word}: {step * np.count_nonzero(mask):.1f} s"
        ax.text(trace.time[0], place - 0.08, lasts, fontsize=7.0, va="bottom")
    ax.set_ylim(len(rows) - 0.4, -0.7)
    ax.set_yticks([])
    ax.set(xlabel="time [s]")
    ax.set_xlim(trace.time[0], trace.time[-1])


def pads_over_time(ax: Axes, result: Validation) -> None:
    """Pad friction of both axles over time with its 95 % band where it is valid; else grey."""
    e = result.estimate
    shade(ax, e.time, ~e.valid)
    curves = []
    for axle, stroke, word in ((e.front, FRONT, "front"), (e.rear, REAR, "rear")):
        good, lower, upper = (
            np.where(e.valid, x, np.nan) for x in (axle.pad_friction, axle.lower, axle.upper)
        )
        line, low, high = (x[::_EVERY] for x in (smooth(e.time, good), lower, upper))
        band(ax, e.time[::_EVERY], low, high, stroke)
        ax.plot(e.time[::_EVERY], line, label=word, **stroke)
        curves += [line, low, high]
    view(ax, *curves, zero=True)
    ax.set(xlabel="time [s]", ylabel="pad friction [1]")
