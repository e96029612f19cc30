"""A stop with its estimate: the panels of Figs. 13 to 16, and with truth the lines of 9 to 11."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from calib.base.names import WHEELS
from calib.base.plain import plain, plus_minus
from calib.car.forces import brake_torque
from calib.car.vehicle import Vehicle
from calib.estimation.estimator import Estimate
from calib.estimation.metrics import truth_of
from calib.estimation.plan import calibrated
from calib.estimation.validate import Validation
from calib.logs.clock import step_of
from calib.logs.log import Log
from calib.run.filters import runs
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
    as_text,
    reach,
    smooth,
)
from calib.table.table import Table

_TIME = "time [s]"
_CHANGED: Stroke = {"color": BODY["color"], "linestyle": DOTTED, "linewidth": 1.0}
_BUMP: Stroke = {"facecolor": "none", "edgecolor": "#B0B0B0", "hatch": "////"}
_SHADED = "Grey: the sample is not valid, and no estimate is drawn."
_MARKED = (
    "Dotted vertical line: a change of surface was detected. Striped: wheels or a_x are thrown "
    "about, as over a bump; left out of the split."
)
_RATIO: Stroke = {"color": "#009E73", "linestyle": DASH_DOT}
_SLIP_MEAN = 0.3
"""Window of the mean of slip [s]; longer, as slip is a difference of two nearly equal speeds."""
BASELINES: dict[str, tuple[str, Stroke]] = {
    "mean_gain": ("one mean gain, [16]", LEVEL),
    "gradient_paper": ("gradient law, paper look-up", LAW),
    "rls_tyre": ("least squares, tyre look-up", {"color": "#E69F00", "linestyle": DOTTED}),
}
"""Methods that can be drawn beside the estimate: one of each kind, so that it stays visible."""
_AXLES = (("f", "front", FRONT), ("r", "rear", REAR))
_LEAST = 0.02
"""Share of the log from which a reason for not being valid is drawn."""
_EVERY = 5
"""Samples between two points of a drawn line: 25 ms at 200 Hz, less than the window of its mean."""


def of_result(result: StoredResult) -> Sheet:
    """The sheet of a stored result."""
    means: list[str | None] = [None, None]
    if result.valid.any():
        means = [_mean_pads(result, side) for side in "fr"]
    panels = _panels(result.values, result.valid, means)
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
    table: Table, name: str, log: Log, result: Validation, vehicle: Vehicle | None = None
) -> Sheet:
    """The sheet of the ``result`` on ``log`` with the table ``name`` and ``vehicle``."""
    e, split = result.estimate, result.estimate.split
    car = vehicle or calibrated(table)
    means = [pads(result.figures, side) for side in "fr"]
    more = _beside(e, log, car, "of the table" if vehicle is None else "of the vehicle file")
    marks = [Mark(time, time, _CHANGED) for time in split.changes]
    marks += [Mark(start, end, _BUMP) for start, end in split.bumps]
    inner = _panels(e.columns(), e.valid, means, more, marks)
    panels = (_wheel_speeds(e, log, car, inner[0].marks), *inner, _validity(e))
    kind = "stop" if truth_of(log, car, e) is None else "simulation"
    warned = ", ".join(plain(warning.code).name for warning in result.all_warnings)
    notes = (
        f"Estimator with table {name}, digest {table.digest[:16]}.",
        *e.notes,
        *([f"Warnings, which brake-cal validate explains: {warned}."] if warned else ()),
        _SHADED,
        *([_MARKED] if marks else ()),
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


def _pairs(panels: Sequence[Panel]) -> tuple[tuple[str, str], ...]:
    """Rows of two; a last one alone is as wide as both."""
    names = [panel.name for panel in panels]
    return tuple(zip(names[::2], [*names[1::2], names[-1]], strict=False))


def _in_words(means: Sequence[str | None]) -> str:
    front, rear = ("none" if mean is None else mean for mean in means)
    return f"pad friction front {front}, rear {rear} (95 %)"


def _mean_pads(result: StoredResult, side: str) -> str:
    """As the validation counts them, over the valid samples."""
    columns = (result[f"pad_friction_{side}{end}"] for end in ("", "_lower", "_upper"))
    mu, lower, upper = (values[result.valid] for values in columns)
    mean = float(np.mean(mu))
    return plus_minus(mean, mean * float(np.median(0.5 * (upper - lower) / mu)))


def _panels(
    values: Mapping[str, Any],
    valid: Mask,
    means: Sequence[str | None],
    more: Mapping[str, Sequence[Line]] | None = None,
    marks: Sequence[Mark] = (),
) -> list[Panel]:
    """Panels of a stop in the order of Fig. 13, with ``more`` lines by the names of the panels."""
    time, more = values["time"], more or {}
    over: dict[str, Any] = {
        "marks": (*_not_valid(time, valid), *marks),
        "xlim": (time[0], time[-1]),
    }
    forces = [
        Line(time, values[f"normalised_force_{side}"], stroke, f"{axle} $F_{side}$", mean=MEAN)
        for side, axle, stroke in _AXLES
    ]
    torques = [
        Line(
            time, sum(values[f"brake_torque_{side}{hand}"] for hand in "lr") / 1e3, stroke,
            f"{axle} compensated", mean=MEAN,
        )
        for side, axle, stroke in _AXLES
    ]  # fmt: skip
    z = Line(time, values["z"], BODY, "$z = -a_x/g$", mean=MEAN)
    ratio = 100.0 * (values["eta"] - 1.0)
    eta = Line(time, ratio, _RATIO, r"$\eta - 1$, zeroed", mean=_SLIP_MEAN)
    slips, unit = more.get("slip", ()), r"$\eta - 1$ [%]"
    title, slip_unit = ("Slip and speed ratio", f"slip, {unit}") if slips else ("Speed ratio", unit)
    torques += more.get("axle-torques", ())
    return [
        Panel("deceleration", "Deceleration", _TIME, "deceleration [g]", [z], **over),
        Panel("normalised-forces", "Normalised forces", _TIME, "normalised force [1]", forces,
              **over),
        Panel("slip", title, _TIME, slip_unit, [*slips, eta], where=valid, **over),
        *(
            _pad(axle, values, valid, mean, stroke, more.get(f"pad-{axle}", ()), over)
            for mean, (_, axle, stroke) in zip(means, _AXLES, strict=True)
        ),
        Panel("axle-torques", "Axle brake torques", _TIME, "axle torque [kN m]", torques,
              columns=2, **over),
    ]  # fmt: skip


def _pad(
    axle: str,
    values: Mapping[str, Any],
    valid: Mask,
    mean: str | None,
    stroke: Stroke,
    more: Sequence[Line],
    over: dict[str, Any],
) -> Panel:
    """Panel (d) and Fig. 9, one axle: the estimate with its interval, truth, nominal, others.

    The valid samples set the range of y; other methods may leave it, but widen it to a limit.
    """
    columns = (values[f"pad_friction_{axle[0]}{end}"] for end in ("", "_lower", "_upper"))
    pad, lower, upper = (np.where(valid, x, np.nan) for x in columns)
    look: Stroke = {**stroke, "linewidth": 1.7}
    label = r"estimate $\mu_{p,c}$, 95 %"
    lines = [*more, Line(values["time"], pad, look, label, (lower, upper))]
    known = [y[valid & np.isfinite(y)] for y in (np.asarray(line.y) for line in more)]
    wide = [np.percentile(y, [5, 95]) for y in known if y.size]
    title = f"{axle.capitalize()} pad friction{f': {mean}' if mean else ''}"
    height = reach(lower, upper, *wide)
    return Panel(
        f"pad-{axle}", title, _TIME, "pad friction [1]", lines, ylim=height, columns=2, **over
    )


def _beside(e: Estimate, log: Log, car: Vehicle, whose: str) -> dict[str, list[Line]]:
    """What a log has beside the estimate, by panel: slips, other methods, nominal pads, truth."""
    found: dict[str, list[Line]] = {"slip": [], "axle-torques": []}
    truth, time = truth_of(log, car, e), e.time
    for i, (_, name, stroke) in enumerate(_AXLES):
        axle, pressure = (car.front, car.rear)[i], np.maximum((e.pressure_f, e.pressure_r)[i], 0.0)
        slip = (e.slip_f, e.slip_r)[i]
        if slip is not None:
            label = f"{name} slip"
            found["slip"].append(Line(time, 100.0 * slip, stroke, label, mean=_SLIP_MEAN))
        held = [
            Line(time, np.where(e.valid, e.baselines[key][i], np.nan), look, label)
            for key, (label, look) in BASELINES.items()
            if key in e.baselines
        ]
        nominal = np.full(time.size, axle.pad_friction)
        held.append(Line(time, nominal, NOMINAL, rf"$\mu_{{p,n}}$ {whose}"))
        thin: Stroke = {"color": stroke["color"], "linestyle": DASH_DOT, "linewidth": 0.9}
        torque = 2.0 * brake_torque(axle, axle.pad_friction, pressure) / 1e3
        torques = [Line(time, torque, thin, f"{name}, pads {whose}", mean=MEAN)]
        if truth is not None:
            true = truth[i]
            held.append(Line(time, smooth(time, true.pad_friction), TRUTH, "truth"))
            torques.append(Line(time, 2.0 * true.torque / 1e3, TRUTH, f"{name} truth"))
        found[f"pad-{name}"] = held
        found["axle-torques"] += torques
    return found


def _not_valid(time: Array, valid: Mask) -> list[Mark]:
    last = time.size - 1
    spans = [(time[a], time[min(b, last)]) for a, b in runs(~valid)]
    return [Mark(start, end, {"color": SHADE}) for start, end in spans]


def _wheel_speeds(e: Estimate, log: Log, car: Vehicle, marks: Sequence[Mark]) -> Panel:
    lines = []
    if "v" in log:  # first, so that it is drawn below the wheels
        lines.append(Line(e.time, log["v"] / car.rear.rolling_radius, BODY, "$V/R$"))
    lines += [Line(e.time, log[f"omega_{w}"], WHEEL_STROKES[w], w) for w in WHEELS]
    ends, unit = (e.time[0], e.time[-1]), "wheel speed [rad/s]"
    return Panel("wheel-speeds", "Wheel speeds", _TIME, unit, lines, marks, xlim=ends, columns=5)


def _validity(e: Estimate) -> Panel:
    """When the estimate is valid, and each reason why it is not, as bars over time."""
    reasons = {"the brakes are released": ~e.braked, **e.refused}
    rows = {"valid": e.valid, **{why: x for why, x in reasons.items() if np.mean(x) >= _LEAST}}
    lines, texts = [], []
    for place, (why, mask) in enumerate(rows.items()):
        colour = (NOMINAL if place else IDENTIFIED)["color"]
        bar: Stroke = {"color": colour, "linewidth": 6.0, "solid_capstyle": "butt"}
        lines.append(Line(e.time, np.where(mask, float(place), np.nan), bar))
        lasts = step_of(e.time) * np.count_nonzero(mask)
        texts.append((f"{why}: {lasts:.1f} s", e.time[0], float(place)))
    title, ends = "Where the estimate is valid, and why not", (e.time[0], e.time[-1])
    height, blank = (len(rows) - 0.2, -0.5), (" ",) * len(rows)
    return Panel(
        "validity", title, _TIME, "", lines, texts=texts, xlim=ends, ylim=height, yticks=blank
    )


def pads_over_time(result: Validation, name: str) -> Panel:
    """Pad friction of both axles over time with its 95 % band where it is valid; else grey."""
    e = result.estimate
    time, lines = e.time[::_EVERY], []
    for axle, (_, word_of, stroke) in zip((e.front, e.rear), _AXLES, strict=True):
        good, lower, upper = (
            np.where(e.valid, x, np.nan) for x in (axle.pad_friction, axle.lower, axle.upper)
        )
        line, low, high = (x[::_EVERY] for x in (smooth(e.time, good), lower, upper))
        lines.append(Line(time, line, stroke, word_of, (low, high)))
    height = reach(*(end for line in lines for end in line.band or ()), zero=True)
    marks = _not_valid(e.time, e.valid)
    return Panel(
        name, as_text(result.log), _TIME, "pad friction [1]", lines, marks, ylim=height, columns=2
    )
