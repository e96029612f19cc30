"""A stop with its estimate: the panels of Figs. 13 to 16."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.plots.budget import bars
from calib.plots.sheet import Panel, Sheet
from calib.plots.style import (
    BODY,
    DASH_DOT,
    DASHED,
    DOTTED,
    FRONT,
    LAW,
    LEVEL,
    NOMINAL,
    REAR,
    TRUTH,
    Stroke,
    band,
    noisy,
    shade,
    smooth,
    stripe,
    view,
)
from calib.plots.trace import AxlePads, AxleTrace, StopTrace
from calib.plots.validity import validity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

VALIDITY, MADE_OF = "validity", "budget"
BUDGET = "What the pads' uncertainty is made of"
WHY = "Where the estimate is valid, and why not"
SHADED = "Grey: the sample is not valid, and no estimate is drawn."
CHANGED = "Dotted vertical line: a change of surface was detected."
BUMPS = "Striped: wheels or a_x are thrown about, as over a bump; left out of the split."
WHEEL_STROKES: dict[str, Stroke] = {
    "fl": {"color": "#0072B2", "linestyle": "-"},
    "fr": {"color": "#56B4E9", "linestyle": DASH_DOT},
    "rl": {"color": "#D55E00", "linestyle": DASHED},
    "rr": {"color": "#E69F00", "linestyle": DOTTED},
}
RATIO: Stroke = {"color": "#009E73", "linestyle": DASH_DOT}
SLIP_MEAN = 0.3
"""Window of the mean of slip [s]; longer, as slip is a difference of two nearly equal speeds."""
BASELINES: dict[str, tuple[str, Stroke]] = {
    "mean_gain": ("one mean gain, [16]", LEVEL),
    "gradient_paper": ("gradient law, paper look-up", LAW),
    "rls_tyre": ("least squares, tyre look-up", {"color": "#E69F00", "linestyle": DOTTED}),
}
"""Methods that can be drawn beside the estimate: one of each kind, so that it stays visible."""


def sheet(trace: StopTrace) -> Sheet:
    """Return the sheet of one stop. Panels for which the source has no data are left out."""
    panels = stop_panels(trace)
    names = [panel.name for panel in panels if panel.name not in (VALIDITY, MADE_OF)]
    rows = [(names[i], names[i + 1]) for i in range(0, len(names) - 1, 2)]
    if len(names) % 2:
        rows.append((names[-1], names[-1]))
    last = [panel.name for panel in panels if panel.name in (VALIDITY, MADE_OF)]
    rows += [(last[0], last[-1])] if last else []
    return Sheet(
        kind="stop",
        name=trace.name,
        title=f"Stop {trace.name}",
        note=note(trace),
        panels=panels,
        rows=tuple(rows),
        result=result_of(trace),
    )


def result_of(trace: StopTrace) -> str:
    """Verdict and pads in words."""
    pads = [
        f"{axle} {'none' if found is None else found}"
        for axle, found in zip(("front", "rear"), trace.pads, strict=True)
    ]
    said = f"pad friction {', '.join(pads)} (95 %)"
    words = f"{trace.verdict}; {said}" if trace.verdict else said
    return words[0].upper() + words[1:]


def note(trace: StopTrace) -> str:
    """Note of the page: source of the data and meaning of the marks."""
    changed = (CHANGED,) if trace.changes else ()
    bumps = (BUMPS,) if trace.bumps else ()
    return " ".join((*trace.notes, SHADED, *changed, *bumps, "Bands are 95 %."))


def stop_panels(trace: StopTrace) -> tuple[Panel, ...]:
    """Panels of a stop in the order of Fig. 13."""
    front, rear = trace.front, trace.rear
    speeds = Panel("wheel-speeds", "Wheel speeds", lambda ax: wheel_speeds(ax, trace), 5)
    total = Panel("force-sum", "Sum of forces", lambda ax: force_sum(ax, trace))
    made_of = trace.budget
    known_slip = front.slip is not None
    return (
        *((speeds,) if trace.wheels else ()),
        Panel("deceleration", "Deceleration", lambda ax: deceleration(ax, trace)),
        Panel("normalised-forces", "Normalised forces", lambda ax: normalised_forces(ax, trace)),
        Panel(
            "slip",
            "Slip and speed ratio" if known_slip else "Speed ratio",
            lambda ax: slip(ax, trace),
        ),
        Panel(
            "pad-front",
            _titled("Front pad friction", trace.pads[0]),
            lambda ax: pad(ax, trace, front, FRONT),
            columns=2,
        ),
        Panel(
            "pad-rear",
            _titled("Rear pad friction", trace.pads[1]),
            lambda ax: pad(ax, trace, rear, REAR),
            2,
        ),
        Panel("axle-torques", "Axle brake torques", lambda ax: axle_torques(ax, trace), 2),
        *((total,) if trace.force_sum is not None else ()),
        *((Panel(VALIDITY, WHY, lambda ax: validity(ax, trace)),) if trace.refused else ()),
        *((Panel(MADE_OF, BUDGET, lambda ax: bars(ax, made_of)),) if made_of else ()),
    )


def _titled(title: str, pads: AxlePads | None) -> str:
    return title if pads is None else f"{title}: {pads}"


def frame(ax: "Axes", trace: StopTrace, ylabel: str) -> None:
    """Shade, mark and label an axis over time."""
    shade(ax, trace.time, ~trace.valid)
    for start, end in trace.bumps:
        stripe(ax, start, end)
    for time in trace.changes:
        ax.axvline(time, color=BODY["color"], linestyle=DOTTED, linewidth=1.0)
    ax.set(xlabel="time [s]", ylabel=ylabel)
    ax.set_xlim(trace.time[0], trace.time[-1])


def wheel_speeds(ax: "Axes", trace: StopTrace) -> None:
    """Wheel speeds, panel (a)."""
    if trace.v_wheel is not None:  # first, so that it is drawn below the wheels
        ax.plot(trace.time, trace.v_wheel, label="$V/R$", linewidth=1.0, **BODY)
    for wheel, omega in trace.wheels.items():
        ax.plot(trace.time, omega, label=wheel, linewidth=1.0, **WHEEL_STROKES[wheel])
    frame(ax, trace, "wheel speed [rad/s]")


def deceleration(ax: "Axes", trace: StopTrace) -> None:
    """Deceleration, panel (b)."""
    noisy(ax, trace.time, trace.z, BODY, "$z = -a_x/g$")
    view(ax, smooth(trace.time, trace.z), zero=True)
    frame(ax, trace, "deceleration [g]")


def normalised_forces(ax: "Axes", trace: StopTrace) -> None:
    """Normalised forces, panel (c)."""
    noisy(ax, trace.time, trace.front.force, FRONT, "front $F_f$")
    noisy(ax, trace.time, trace.rear.force, REAR, "rear $F_r$")
    both = [smooth(trace.time, axle.force) for axle in (trace.front, trace.rear)]
    view(ax, *both, zero=True)
    frame(ax, trace, "normalised force [1]")


def slip(ax: "Axes", trace: StopTrace) -> None:
    """Slips where v is known, and eta, which needs the wheel speeds only."""
    shown = []
    for values, stroke, label in (
        (trace.front.slip, FRONT, "front slip"),
        (trace.rear.slip, REAR, "rear slip"),
        (trace.eta - 1.0, RATIO, r"$\eta - 1$, zeroed"),
    ):
        if values is not None:
            noisy(ax, trace.time, 100.0 * values, stroke, label, SLIP_MEAN)
            shown.append(100.0 * smooth(trace.time, values, SLIP_MEAN)[trace.valid])
    view(ax, *shown, zero=True)
    frame(ax, trace, r"slip, $\eta - 1$ [%]" if len(shown) > 1 else r"$\eta - 1$ [%]")


def pad(ax: "Axes", trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Panel (d), one axle: the estimate with its interval, truth, nominal, and other methods."""
    for name, (label, thin) in BASELINES.items():
        if name in axle.baselines:
            ax.plot(trace.time, held(trace, axle.baselines[name]), label=label, **thin)
    pad_estimate(ax, trace, axle, stroke)
    _view_pads(
        ax, trace, axle, [axle.baselines[name] for name in BASELINES if name in axle.baselines]
    )
    frame(ax, trace, "pad friction [1]")


def held(trace: StopTrace, values: Array) -> Array:
    """``values`` (n,), NaN where the estimate is not valid."""
    return np.where(trace.valid, values, np.nan)


def pad_estimate(ax: "Axes", trace: StopTrace, axle: AxleTrace, stroke: Stroke) -> None:
    """Draw the estimate with its interval, the nominal pad and the truth, as far as known."""
    band(ax, trace.time, held(trace, axle.lower), held(trace, axle.upper), stroke)
    label = r"estimate $\mu_{p,c}$, 95 %"
    ax.plot(trace.time, held(trace, axle.pad), label=label, **{**stroke, "linewidth": 1.7})
    if axle.nominal is not None:
        ax.axhline(axle.nominal, label=rf"$\mu_{{p,n}}$ {trace.nominal_of}", **NOMINAL)
    if axle.true_pad is not None:
        ax.plot(trace.time, smooth(trace.time, axle.true_pad), label="truth", **TRUTH)


def _view_pads(ax: "Axes", trace: StopTrace, axle: AxleTrace, baselines: list[Array]) -> None:
    """Range of y by the valid samples; baselines may leave it, but widen it up to a limit."""
    valid = trace.valid
    core = [axle.lower[valid], axle.upper[valid]] if valid.any() else [np.array([0.0, 1.0])]
    core += [np.array([axle.nominal])] if axle.nominal is not None else []
    core += [axle.true_pad[valid]] if axle.true_pad is not None else []
    thin = [np.nanpercentile(r[valid], [5, 95]) for r in baselines if np.isfinite(r[valid]).any()]
    view(ax, *core, *thin)


NOMINALS = {"front": DASH_DOT, "rear": DOTTED}


def axle_torques(ax: "Axes", trace: StopTrace) -> None:
    """Panel (e): per axle, with nominal pads and compensated."""
    of = trace.nominal_of
    for axle, stroke, word in ((trace.front, FRONT, "front"), (trace.rear, REAR, "rear")):
        noisy(ax, trace.time, axle.torque / 1e3, stroke, f"{word} compensated")
        if axle.nominal_torque is not None:
            thin = {"color": stroke["color"], "linestyle": NOMINALS[word], "linewidth": 0.9}
            noisy(ax, trace.time, axle.nominal_torque / 1e3, thin, f"{word}, pads {of}")
    frame(ax, trace, "axle torque [kN m]")


def force_sum(ax: "Axes", trace: StopTrace) -> None:
    """Sum of forces, panel (f). With (18) it is right for any table, so it validates nothing."""
    if trace.force_sum is None or trace.inertia is None:
        return
    noisy(ax, trace.time, trace.inertia / 1e3, BODY, "$M_v |a_x|$")
    compensated = {**LEVEL, "linewidth": 1.3}
    noisy(ax, trace.time, trace.force_sum / 1e3, compensated, "compensated")
    sums = [trace.inertia, trace.force_sum]
    if trace.force_sum_nominal is not None:
        ax.plot(
            trace.time,
            smooth(trace.time, trace.force_sum_nominal) / 1e3,
            label=f"pads {trace.nominal_of}",
            **NOMINAL,
        )
        sums.append(trace.force_sum_nominal)
    view(ax, *(smooth(trace.time, s) / 1e3 for s in sums), zero=True)
    ax.set_ylim(top=ax.get_ylim()[1] * 1.14)  # space for the text below
    ax.text(
        0.5,
        0.985,
        "true for any table: no validation",
        transform=ax.transAxes,
        ha="center",
        va="top",
        fontsize=7.5,
        fontweight="bold",
        color="#8A0000",
    )
    frame(ax, trace, "force [kN]")
