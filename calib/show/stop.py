"""A stop with its estimate: the panels of Figs. 13 to 16, and with truth the lines of 9 to 11."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from calib.base.names import WHEELS
from calib.base.plain import plain, plus_minus
from calib.car.effects.effect import Pair
from calib.car.forces import brake_torque
from calib.car.vehicle import Vehicle
from calib.estimation.baselines import METHODS
from calib.estimation.estimator import Estimate
from calib.estimation.metrics import truth_of
from calib.estimation.validate import Validation
from calib.logs.log import Log
from calib.run.filters import runs
from calib.show.facts import Picture
from calib.show.judged import broken, pads, word
from calib.show.result import StoredResult
from calib.show.sheet import Line, Mark, Panel, Sheet
from calib.show.style import (
    BODY,
    DASH_DOT,
    DOTTED,
    FRONT,
    IDENTIFIED,
    LAW,
    LEVEL,
    MEAN,
    NOMINAL,
    REAR,
    SHADE,
    TRUTH,
    WHEEL_STROKES,
    Array,
    Mask,
    Stroke,
    reach,
    smooth,
)
from calib.table.table import Table

_TIME = "time [s]"
_SHADED = "Grey: the sample is not valid, and no estimate is drawn."
_RATIO: Stroke = {"color": "#009E73", "linestyle": DASH_DOT}
_ECU = 0.7
"""Width of the line of what an ECU without a speed makes of the table."""
_SLIP_MEAN = 0.3
"""Window of the mean of slip [s]; longer, as slip is a difference of two nearly equal speeds."""
BASELINES: dict[str, tuple[str, Stroke]] = {
    "mean_gain": ("one mean gain, [16]", LEVEL),
    "gradient_paper": ("gradient law, curves", LAW),
    "gradient_map": ("gradient law, map", {"color": "#E69F00", "linestyle": DOTTED}),
}
"""Methods that can be drawn beside the estimate: few, so that it stays visible."""
_ENDS = ("", "_lower", "_upper")
_AXLES = (("f", "front", FRONT), ("r", "rear", REAR))
_EVERY = 5
"""Samples between two points of a line on a page: 25 ms at 200 Hz."""


def of_result(result: StoredResult) -> Sheet:
    """The sheet of a stored result."""
    valid, means = result.valid, ("none", "none")
    if valid.any():
        means = (_mean_pads(result, "f"), _mean_pads(result, "r"))
    panels = _panels(result.values, valid, means, _over(result.values["time"], valid))
    return Sheet(
        kind="stop",
        name=result.name,
        panels=tuple(panels),
        rows=_pairs(panels),
        title=f"Stop {result.name}",
        note=f"Result {result.name}, digest {result.digest[:16]}. {_SHADED} Bands are 95 %.",
        result=_in_words(means).capitalize(),
    )


def of_validation(
    table: Table,
    name: str,
    log: Log,
    result: Validation,
    vehicle: Vehicle | None = None,
    *,
    compare: bool = True,
) -> Sheet:
    """The sheet of the ``result`` on ``log`` with the table ``name`` and ``vehicle``.

    With ``compare`` the `BASELINES` are drawn, too.
    """
    e, car = result.estimate, result.estimate.car
    means = _means(result)
    over = _over(e.time, e.valid)
    others = {key: METHODS[key](e) for key in BASELINES} if compare else {}
    more = _beside(e, others, "of the table" if vehicle is None else "of the vehicle file")
    wheels = [Line(e.time, log[f"omega_{w}"], WHEEL_STROKES[w], w) for w in WHEELS]
    if "v" in log:  # first, so that it is drawn below the wheels
        wheels.insert(0, Line(e.time, log["v"] / car.rear.rolling_radius, BODY, "$V/R$"))
    panels = (
        over("wheel-speeds", "Wheel speeds", y="wheel speed [rad/s]", lines=wheels, columns=5),
        *_panels(e.columns(), e.valid, means, over, more),
    )
    kind = "stop" if truth_of(e) is None else "simulation"
    lost = {why: log.sample_time * np.count_nonzero(x) for why, x in e.refused.items()}
    refused = {why: lasts for why, lasts in lost.items() if lasts >= 0.05}
    warned = ", ".join(plain(warning.code).name for warning in result.all_warnings)
    notes = (
        f"Estimator with table {name}, digest {table.digest[:16]}.",
        *([f"Warnings, which brake-cal validate explains: {warned}."] if warned else ()),
        _SHADED,
        *(
            f"Not valid for {lasts:.1f}\u00a0s: {why}."
            for why, lasts in refused.items()
            if lasts >= 0.05
        ),
    )
    told = "; ".join([word(result), *broken(result), _in_words(means)])
    return Sheet(
        kind=kind,
        name=log.name,
        panels=panels,
        rows=_pairs(panels),
        title=f"{kind.capitalize()} {log.name}",
        note=" ".join((*notes, "Bands are 95 %.")),
        result=told[0].upper() + told[1:],
    )


def pads_over_time(result: Validation) -> Picture:
    """Pad friction of both axles of a stop, for a page."""
    part = {name: values[::_EVERY] for name, values in result.estimate.columns().items()}
    valid = np.asarray(part["valid"], bool)
    panels = _panels(part, valid, _means(result), _over(result.estimate.time[::_EVERY], valid))
    caption = f"{result.log}: pad friction with its 95 % band; grey: not valid."
    return Picture(caption, Sheet("stop", result.log, tuple(panels)), ("pad-front", "pad-rear"))


def _means(result: Validation) -> tuple[str, str]:
    """Pad friction of both axles in words."""
    return pads(result.figures, "f") or "none", pads(result.figures, "r") or "none"


def _over(time: Array, valid: Mask) -> Callable[..., Panel]:
    """The maker of a panel over ``time`` (n,), grey where it is not ``valid``."""
    last = time.size - 1
    grey = [Mark(time[a], time[min(b, last)], {"color": SHADE}) for a, b in runs(~valid)]
    return partial(Panel, x=_TIME, marks=grey, xlim=(time[0], time[-1]))


def _pairs(panels: Sequence[Panel]) -> tuple[tuple[str, str], ...]:
    """Rows of two; a last one alone is as wide as both."""
    names = [panel.name for panel in panels]
    return tuple(zip(names[::2], [*names[1::2], names[-1]], strict=False))


def _in_words(means: tuple[str, str]) -> str:
    return f"pad friction front {means[0]}, rear {means[1]} (95 %)"


def _mean_pads(result: StoredResult, side: str) -> str:
    """As the validation counts them, over the valid samples."""
    columns = (result.values[f"pad_friction_{side}{end}"] for end in ("", "_lower", "_upper"))
    mu, lower, upper = (values[result.valid] for values in columns)
    mean = float(np.mean(mu))
    return plus_minus(mean, mean * float(np.median(0.5 * (upper - lower) / mu)))


def _panels(
    values: Mapping[str, Any],
    valid: Mask,
    means: tuple[str, str],
    over: Callable[..., Panel],
    more: Mapping[str, Sequence[Line]] | None = None,
) -> list[Panel]:
    """Panels of a stop in the order of Fig. 13, with ``more`` lines by the names of the panels."""
    time, more = values["time"], more or {}
    forces, torques, of_pads = [], [], []
    for mean, (side, axle, stroke) in zip(means, _AXLES, strict=True):
        force, label = values[f"normalised_force_{side}"], f"{axle} $F_{side}$"
        forces.append(Line(time, force, stroke, label, mean=MEAN))
        torque = (values[f"brake_torque_{side}l"] + values[f"brake_torque_{side}r"]) / 1e3
        torques.append(Line(time, torque, stroke, f"{axle} compensated", mean=MEAN))
        beside = more.get(f"pad-{axle}", ())
        lines, ends = _bounded(f"pad_friction_{side}", values, valid, stroke, beside)
        title, unit = f"{axle.capitalize()} pad friction: {mean}", "pad friction [1]"
        of_pads.append(over(f"pad-{axle}", title, y=unit, lines=lines, ylim=ends, columns=2))
    z = Line(time, values["z"], BODY, "$z = -a_x/g$", mean=MEAN)
    ratio = 100.0 * (values["eta"] - 1.0)
    eta = Line(time, ratio, _RATIO, r"$\eta - 1$, zeroed", mean=_SLIP_MEAN)
    slips = [*more.get("slip", ()), eta]
    torques += more.get("axle-torques", ())
    levels = []
    if "pad_level" in values:
        lines, ends = _bounded("pad_level", values, valid, IDENTIFIED, ())
        title = "Brake torque over that of the file's pads"
        levels = [over("pad-level", title, y="pad level [1]", lines=lines, ylim=ends, columns=2)]
    return [
        over("deceleration", "Deceleration", y="deceleration [g]", lines=[z]),
        over("normalised-forces", "Normalised forces", y="normalised force [1]", lines=forces),
        over("slip", "Slip and speed ratio", y=r"slip, $\eta - 1$ [%]", lines=slips, where=valid),
        *of_pads,
        *levels,
        over("axle-torques", "Axle brake torques", y="axle torque [kN m]", lines=torques,
             columns=2),
    ]  # fmt: skip


def _bounded(
    name: str, values: Mapping[str, Any], valid: Mask, stroke: Stroke, more: Sequence[Line]
) -> tuple[list[Line], tuple[float, float] | None]:
    """Panel (d) and Fig. 9, one axle, or both: the estimate with its interval over others.

    Beside it what an ECU makes of the table, thin; then the ends of y. The valid samples set them;
    other methods may leave the panel, but widen it to a limit.
    """
    pad, lower, upper = (np.where(valid, values[f"{name}{end}"], np.nan) for end in _ENDS)
    look: Stroke = {**stroke, "linewidth": 1.7}
    label = r"estimate $\mu_{p,c}$, 95 %" if name != "pad_level" else "estimate, 95 %"
    estimate = Line(values["time"], pad, look, label, (lower, upper))
    if "ecu_valid" in values:
        of_ecu = np.where(np.asarray(values["ecu_valid"], bool), values[f"ecu_{name}"], np.nan)
        thin: Stroke = {**stroke, "linewidth": _ECU}
        more = (*more, Line(values["time"], of_ecu, thin, "ECU, without $v$"))
    known = [y[valid & np.isfinite(y)] for y in (np.asarray(line.y) for line in more)]
    wide = [np.percentile(y, [5, 95]) for y in known if y.size]
    return [*more, estimate], reach(lower, upper, *wide)


def _beside(e: Estimate, others: Mapping[str, Pair], whose: str) -> dict[str, list[Line]]:
    """What a log has beside the estimate, by panel: slips, other methods, nominal pads, truth."""
    found = dict[str, list[Line]](slip=[], **{"axle-torques": []})
    car = e.car
    truth, time, slips = truth_of(e), e.time, e.slips
    for i, (_, name, stroke) in enumerate(_AXLES):
        axle, pressure = (car.front, car.rear)[i], np.maximum((e.read.p_f, e.read.p_r)[i], 0.0)
        if slips is not None:
            label = f"{name} slip"
            found["slip"].append(Line(time, 100.0 * slips[i], stroke, label, mean=_SLIP_MEAN))
        held = [
            Line(time, np.where(e.valid, others[key][i], np.nan), look, label)
            for key, (label, look) in BASELINES.items()
            if key in others
        ]
        nominal = np.full(time.size, axle.pad_friction)
        held.append(Line(time, nominal, NOMINAL, rf"$\mu_{{p,n}}$ {whose}"))
        thin: Stroke = {"color": stroke["color"], "linestyle": DASH_DOT, "linewidth": 0.9}
        torque = 2.0 * brake_torque(axle, axle.pad_friction, pressure) / 1e3
        torques = [Line(time, torque, thin, f"{name}, pads {whose}", mean=MEAN)]
        if truth is not None:
            held.append(Line(time, smooth(time, truth.pad_friction[i]), TRUTH, "truth"))
            torques.append(Line(time, 2.0 * truth.torque[i] / 1e3, TRUTH, f"{name} truth"))
        found[f"pad-{name}"] = held
        found["axle-torques"] += torques
    return found
