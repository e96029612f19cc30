"""A stop with the answer of its ECU, pads first, as in Figs. 13 to 16; with truth as in 9 to 11."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from calib.base.names import AXLE_NAMES
from calib.base.plain import plain, plus_minus
from calib.car.forces import brake_torque
from calib.car.vehicle import Vehicle
from calib.estimation.estimator import Estimate
from calib.estimation.metrics import Truth, truth_of
from calib.estimation.validate import Validation
from calib.logs.log import Log
from calib.run.filters import runs
from calib.show.facts import Picture
from calib.show.judged import UNKNOWN, broken, pads, word
from calib.show.panel import Line, Mark, Panel
from calib.show.result import StoredResult
from calib.show.sheet import Sheet
from calib.show.style import (
    BODY,
    DASH_DOT,
    ETA,
    FRONT,
    IDENTIFIED,
    MEAN,
    REAR,
    SHADE,
    TRUTH,
    Array,
    Mask,
    Stroke,
    reach,
    smooth,
)
from calib.table.table import Table

_STROKES = {"f": FRONT, "r": REAR}
_BEFORE: Stroke = {"linestyle": DASH_DOT, "linewidth": 0.9}
"""Look of the pads of the ramp, or of a vehicle file, in the colour of the axle."""
_PADS, _FORCE = "pad friction [1]", "force over load [1]"
_GREY = "Grey: no valid answer"
_ENDS = ("", "_lower", "_upper")
_SLIP_MEAN = 0.3
"""Window of the mean of slip [s]; longer, as slip is a difference of two nearly equal speeds."""
_LEAST = 0.05
"""Shortest time without a valid answer that is told [s]."""

_Values = Mapping[str, Any]
"""Columns of an estimate, (n,) each."""
_Lines = Sequence[Line]
_Over = Callable[..., Panel]


def of_result(result: StoredResult) -> Sheet:
    """The sheet of a stored result."""
    values, valid = result.values, result.valid
    means = [UNKNOWN, UNKNOWN]
    if valid.any():  # as the validation counts them
        known = {name: column[valid] for name, column in values.items()}
        means = [_mean(*(known[f"ecu_pad_friction_{x}{end}"] for end in _ENDS)) for x in _STROKES]
    over = _over(values["time"], valid)
    panels = [_pads(values, valid, over), *_signals(values, valid, over)]
    note = f"Result {result.name}, digest {result.digest[:16]}. Bands are 95 %. {_GREY}."
    return _sheet("stop", result.name, panels, note, [_in_words(means)])


def of_validation(
    table: Table, name: str, log: Log, result: Validation, vehicle: Vehicle | None = None
) -> Sheet:
    """The sheet of the ``result`` on ``log`` with the table ``name``.

    Beside the estimate are the pads of the ramp, or those of ``vehicle``.
    """
    e, values = result.estimate, result.estimate.columns()
    valid = _counts(e)
    over = _over(e.time, valid)
    panels = [
        _pads(values, valid, over, _other_pads(e, vehicle)),
        *_signals(values, valid, over, _other_torques(e, vehicle), _slips(e)),
    ]
    lost = {why: log.sample_time * np.count_nonzero(x) for why, x in e.refused.items()}
    refused = [f"{lasts:.1f}\u00a0s {why}" for why, lasts in lost.items() if lasts >= _LEAST]
    warned = ", ".join(plain(warning.code).name for warning in result.all_warnings)
    notes = (
        f"Table {name}, digest {table.digest[:16]}. Bands are 95 %.",
        f"{_GREY}{': ' * bool(refused)}{', '.join(refused)}.",
        *([f"Warnings, which brake-cal validate explains: {warned}."] if warned else ()),
    )
    told = [
        word(result),
        *broken(result),
        _in_words([pads(result.figures, x, "ecu_") for x in _STROKES]),
    ]
    kind = "stop" if truth_of(e) is None else "simulation"
    return _sheet(kind, log.name, panels, " ".join(notes), told)


def pads_over_time(result: Validation) -> Picture:
    """Pad friction of both axles of a stop, for a page."""

    def made() -> Sheet:
        e = result.estimate
        valid = _counts(e)
        panel = _pads(e.columns(), valid, _over(e.time, valid), _other_pads(e, None))
        return Sheet("stop", result.log, (panel,))

    return Picture(f"{result.log}: pad friction with its 95 % band; grey: no valid answer.", made)


def _sheet(kind: str, name: str, panels: list[Panel], note: str, told: Sequence[str]) -> Sheet:
    """One panel a row. Pads, which are the answer, have most room."""
    text = "; ".join(told)
    return Sheet(
        kind=kind,
        name=name,
        panels=tuple(panels),
        heights=(1.2, *(0.85,) * (len(panels) - 1)),
        title=f"{kind.capitalize()} {name}",
        note=note,
        result=text[0].upper() + text[1:],
    )


def _counts(e: Estimate) -> Mask:
    """Where the ECU has a valid answer to a run that counts (n,)."""
    return e.ecu.valid & (not e.unfit)


def _over(time: Array, valid: Mask) -> _Over:
    """The maker of a panel over ``time`` (n,), grey where it is not ``valid``."""
    last = time.size - 1
    grey = [Mark(time[a], time[min(b, last)], {"color": SHADE}) for a, b in runs(~valid)]
    return partial(Panel, x="time [s]", marks=grey, xlim=(time[0], time[-1]), columns=2)


def _in_words(means: Iterable[str]) -> str:
    told = (f"{x} {mean}" for x, mean in zip(AXLE_NAMES.values(), means, strict=True))
    return f"pad friction {', '.join(told)} (95 %)"


def _mean(mu: Array, lower: Array, upper: Array) -> str:
    mean = float(np.mean(mu))
    return plus_minus(mean, mean * float(np.median(0.5 * (upper - lower) / mu)))


def _pads(values: _Values, valid: Mask, over: _Over, beside: _Lines = ()) -> Panel:
    """Panel (d) and Fig. 9: the valid estimates with their intervals over the pads as they were."""
    lines, ends = [], []
    for line in beside:  # they may leave the panel, but widen it so far
        known = np.asarray(line.y)[np.isfinite(line.y)]
        ends.append(np.percentile(known, [2, 98]) if known.size else known)
    for axle, look in _STROKES.items():
        pad, lower, upper = (
            np.where(valid, values[f"ecu_pad_friction_{axle}{end}"], np.nan) for end in _ENDS
        )
        thick, label = {**look, "linewidth": 1.8}, f"{AXLE_NAMES[axle]}, with 95 % band"
        lines.append(Line(values["time"], pad, thick, label, (lower, upper)))
        ends += [lower, upper]
    return over("pads", "Pad friction", y=_PADS, lines=[*lines, *beside], ylim=reach(*ends))


def _before(e: Estimate, vehicle: Vehicle | None) -> list[tuple[str, float]]:
    """Pad friction of both axles [1] on the ramp or in the file of a ``vehicle``, and in words."""
    then = e.table.calibration
    whose, both = "on the ramp", (then.pad_friction_f.value, then.pad_friction_r.value)
    if vehicle is not None:
        whose, both = "by the file", (vehicle.front.pad_friction, vehicle.rear.pad_friction)
    return [(f"{x} {whose}", mu) for x, mu in zip(AXLE_NAMES.values(), both, strict=True)]


def _other_pads(e: Estimate, vehicle: Vehicle | None) -> list[Line]:
    """Pads by the speed, which no ECU has, as they were before the stop, and the true ones."""
    by_v = zip((e.best.pads_f, e.best.pads_r), AXLE_NAMES.values(), _STROKES.values(), strict=True)
    lines = [
        Line(
            e.time,
            np.where(e.valid, x.value, np.nan),
            {**look, "linewidth": 0.9},
            f"{name}, with v",
        )
        for x, name, look in by_v
        if e.read.v is not None
    ]
    ends = e.time[[0, -1]]
    lines += [
        Line(ends, [mu, mu], {**_BEFORE, "color": look["color"]}, f"{whose}, {mu:.3f}")
        for (whose, mu), look in zip(_before(e, vehicle), _STROKES.values(), strict=True)
    ]
    return lines + _true(e, lambda truth: [smooth(e.time, mu) for mu in truth.pad_friction])


def _true(e: Estimate, of: Callable[[Truth], Iterable[Array]]) -> list[Line]:
    """What is true of both axles, where it is known."""
    truth = truth_of(e)
    both = zip(of(truth) if truth else (), ("truth", ""), strict=False)
    return [Line(e.time, y, TRUTH, label) for y, label in both]


def _other_torques(e: Estimate, vehicle: Vehicle | None) -> list[Line]:
    """What the pads as they were would make of the pressure, and the true torques [kN m]."""
    lines, axles = [], ((e.car.front, e.read.p_f, FRONT), (e.car.rear, e.read.p_r, REAR))
    for (whose, mu), (axle, p, of) in zip(_before(e, vehicle), axles, strict=True):
        torque = 2.0 * brake_torque(axle, mu, np.maximum(p, 0.0)) / 1e3
        look = {**_BEFORE, "color": of["color"]}
        lines.append(Line(e.time, torque, look, whose.replace(" ", " pads ", 1), mean=MEAN))
    return lines + _true(e, lambda truth: 2.0 * truth.torque / 1e3)


def _slips(e: Estimate) -> list[Line]:
    """Slip of both axles [%]; none without v."""
    told = zip(e.slips or (), AXLE_NAMES.values(), _STROKES.values(), strict=False)
    return [
        Line(e.time, 100.0 * s, look, f"{name} slip", mean=_SLIP_MEAN) for s, name, look in told
    ]


def _signals(
    values: _Values, valid: Mask, over: _Over, torques: _Lines = (), slips: _Lines = ()
) -> list[Panel]:
    """Torques, forces and slip, from which the pads follow, over other lines."""
    time, forces, brakes = values["time"], [], []
    for axle, look in _STROKES.items():
        name = AXLE_NAMES[axle]
        forces.append(Line(time, values[f"normalised_force_{axle}"], look, name, mean=MEAN))
        torque = 2.0 * values[f"ecu_brake_torque_{axle}l"] / 1e3
        brakes.append(Line(time, torque, look, name, mean=MEAN))
    z = Line(time, values["z"], BODY, "deceleration over g", mean=MEAN)
    eta = Line(time, 100.0 * (values["eta"] - 1.0), IDENTIFIED, "\u03b7 - 1", mean=_SLIP_MEAN)
    return [
        over("axle-torques", "Brake torque", y="axle torque [kN m]", lines=[*brakes, *torques]),
        over("normalised-forces", "Force over load", y=_FORCE, lines=[*forces, z], columns=3),
        over("slip", "Slip", y=f"slip, {ETA}", lines=[*slips, eta], where=valid, columns=3),
    ]
