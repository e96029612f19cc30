"""A stop over time: the brake torques that an ECU estimates, then pads, forces and slip.

    an estimate or a stored result --> _Stop --> a sheet, Figs. 9 to 16 of the paper

The time axis is the braking, with `_AROUND` before the first bite and after the last release.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from calib.base.names import AXLE_NAMES
from calib.base.plain import NBSP
from calib.car.effects.effect import Pair
from calib.car.vehicle import Vehicle
from calib.estimation.estimator import Estimate
from calib.estimation.metrics import Truth, truth_of
from calib.estimation.readout import ENDS
from calib.estimation.reasons import Reason
from calib.estimation.validate import Validation
from calib.run.filters import true_intervals
from calib.show import style
from calib.show.facts import Picture
from calib.show.judged import broken_limits, verdict_word, warning_note
from calib.show.map import map_panels
from calib.show.panel import Line, Mark, Panel
from calib.show.result import StoredResult
from calib.show.sheet import Sheet
from calib.show.style import Array, Mask, Stroke
from calib.show.torque import SIDES, Columns, errors, in_words, means, torques
from calib.table.table import Table

_STROKES = {"f": style.FRONT, "r": style.REAR}
_TOTAL: Stroke = {**style.IDENTIFIED, "linestyle": style.LONG}
_BEFORE: Stroke = {"linestyle": style.DASH_DOT, "linewidth": 0.9}
"""Look of the pads before the stop, in the colour of the axle."""
_SLIP_MEAN = 0.3
"""Window of the mean of slip [s]: long, since slip is the difference of nearly equal speeds."""
_SHORTEST = 0.05
"""Shortest time without a valid estimate whose reason is named [s]."""
_BRAKED, _AROUND = 0.02, 0.5
"""Share of the largest torque above which a sample is braked; time drawn before and after [s]."""
_GREYS = ("#EFEFEF", "#DEDEDE", "#CFCFCF")
"""Shades of the reasons for no valid estimate, the longest first; the last for all others."""


class _Invalid(NamedTuple):
    """Samples without a valid estimate for one reason."""

    reason: str
    samples: Mask  # (n,)
    duration: float  # of those in the picture [s]


@dataclass(frozen=True)
class _Stop:
    """A stop of n samples to draw."""

    columns: Columns  # of an estimate or of a stored result
    valid: Mask  # samples (n,) in which the estimate of the ECU counts
    source: str  # where the ``pads`` are from, in words
    pads: Sequence[float]  # front and rear pad friction before the stop [1]; () if not known
    truth: Truth | None = None  # None if not known
    slips: Pair | None = None  # of the front and the rear axle [1], (n,) each; None if not known

    @property
    def time(self) -> Array:
        """Clock of the log [s] (n,)."""
        return np.asarray(self.columns["time"])

    @cached_property
    def in_picture(self) -> Mask:
        """Samples of the braking (n,) and `_AROUND` around it; all samples if nothing brakes."""
        torque, time = np.asarray(self.columns["ecu_brake_torque_sum"]), self.time
        braked = time[torque > _BRAKED * np.max(torque)]
        first, last = (braked[0], braked[-1]) if braked.size else (time[0], time[-1])
        return np.asarray((time >= first - _AROUND) & (time <= last + _AROUND))

    @cached_property
    def invalid(self) -> list[_Invalid]:
        """Samples without a valid estimate, by reason; the longest duration first."""
        if self.valid.any():
            number = np.asarray(self.columns["ecu_reason"])
            samples = {reason.words: ~self.valid & (number == reason) for reason in Reason}
        else:
            samples = {"no sample of this run counts": ~self.valid}
        step = float(np.median(np.diff(self.time)))
        invalid = [
            _Invalid(reason, mask, step * np.count_nonzero(mask & self.in_picture))
            for reason, mask in samples.items()
            if mask.any()
        ]
        return sorted(invalid, key=lambda entry: -entry.duration)

    @property
    def on_map(self) -> Pair:
        """eta - 1 and z [1] of the m valid samples, (m,) each: means over `_SLIP_MEAN`."""
        eta, z = (style.smooth(self.time, self.columns[name], _SLIP_MEAN) for name in ("eta", "z"))
        return eta[self.valid] - 1.0, z[self.valid]

    def where_valid(self, name: str) -> Array:
        """Return a column (n,), NaN where the ECU has no valid estimate."""
        return np.where(self.valid, self.columns[name], np.nan)


def of_result(result: StoredResult) -> Sheet:
    """Return the sheet of a stored result, which knows neither map nor true values."""
    stop = _Stop(result.values, result.valid, "on the ramp", result.ramp_pads)
    return _sheet("stop", result.name, stop, result.note, result.verdict)


def of_estimate(estimate: Estimate) -> Sheet:
    """Return the sheet of an estimate, which has no verdict."""
    return _sheet("stop", estimate.run.log.name, _stop_of(estimate), "", [], estimate.table)


def of_validation(result: Validation, name: str = "", vehicle: Vehicle | None = None) -> Sheet:
    """Return the sheet of a stop judged with the table ``name``; ``vehicle`` as in `_stop_of`."""
    stop, table = _stop_of(result.estimate, vehicle), result.estimate.table
    titles = warning_note(warning.title for warning in result.all_warnings)
    note = f"Table {name or table.name}, digest {table.digest[:16]}.{titles}"
    verdict = [verdict_word(result), *broken_limits(result.judgements), *errors(result).in_words]
    kind = "stop" if stop.truth is None else "simulation"
    return _sheet(kind, result.log, stop, note, verdict, table)


def torque_and_pads(result: Validation) -> Picture:
    """Return the picture of a page with brake torque and pad friction of a stop."""

    def draw() -> Sheet:
        stop = _stop_of(result.estimate)
        return Sheet("stop", result.log, (_torque_panel(stop), _pad_panel(stop)))

    return Picture(f"{result.log}: what the ECU makes of it; bands are 95 %.", draw)


def stops_on_map(results: Sequence[Validation]) -> Picture:
    """Return the picture of a page with the map of the table and all stops on the map."""

    def draw() -> Sheet:
        table = results[0].estimate.table
        places = {result.log: _stop_of(result.estimate).on_map for result in results}
        return Sheet("stops", table.name, map_panels(table, places)[:1])

    return Picture("Where the stops are on the map that the ECU looks up.", draw)


def _stop_of(e: Estimate, vehicle: Vehicle | None = None) -> _Stop:
    """Return an estimate as a stop, with the pads of ``vehicle``, or of the ramp for None."""
    ramp = e.table.calibration
    source, pads = "on the ramp", (ramp.pad_friction_f.value, ramp.pad_friction_r.value)
    if vehicle is not None:
        source, pads = "by the file", (vehicle.front.pad_friction, vehicle.rear.pad_friction)
    return _Stop(e.columns(), e.ecu_valid, source, pads, truth_of(e), e.slips)


def _sheet(
    kind: str, name: str, stop: _Stop, note: str, verdict: Sequence[str], table: Table | None = None
) -> Sheet:
    """Return the sheet of a stop, with the map of the ``table`` if there is one.

    The first text of ``verdict`` goes into the title, the others into the result.
    """
    panels = [_torque_panel(stop), _pad_panel(stop), _force_panel(stop), _slip_panel(stop)]
    rows = [(panel.name,) * 2 for panel in panels]
    if table is not None:
        panels.append(map_panels(table, {name: stop.on_map})[0])
        rows[2:] = ("normalised-forces", "map"), ("slip", "map")  # beside the last two panels
    named = [entry for entry in stop.invalid if entry.duration >= _SHORTEST]
    reasons = ", ".join(f"{entry.duration:.1f}{NBSP}s {entry.reason}" for entry in named)
    grey = f" Grey, no valid answer: {reasons}." if reasons else ""
    answer = in_words(means(stop.columns, stop.valid)) or "no valid answer"
    return Sheet(
        kind=kind,
        name=name,
        panels=tuple(panels),
        rows=tuple(rows),
        heights=(1.2, 1.0, 0.8, 0.8),
        title=": ".join([f"{kind.capitalize()} {name}", *verdict[:1]]),
        note=f"{note} Bands are 95 %.{grey}".strip(),
        result="; ".join([answer[0].upper() + answer[1:], *verdict[1:]]),
    )


def _panel(
    stop: _Stop, labels: Sequence[str], lines: Sequence[Line], in_view: Iterable[Array] = ()
) -> Panel:
    """Return a panel over time; its y axis spans the values ``in_view``, (n,) each.

    ``labels`` are name, title and y axis. Samples without a valid estimate are grey; the legend of
    the torques names the reasons.
    """
    (name, title, y), marks = labels, list[Mark]()
    for i, (reason, samples, duration) in enumerate(stop.invalid):
        look: Stroke = {"color": _GREYS[min(i, len(_GREYS) - 1)]}
        is_named = name == "axle-torques" and duration >= _SHORTEST
        label = f"not valid: {reason}" if is_named else ""
        for start, end in true_intervals(samples):
            last = stop.time[min(end, stop.time.size - 1)]
            marks.append(Mark(stop.time[start], last, look, label))
            label = ""  # the legend names a reason once
    time = stop.time[stop.in_picture]
    in_picture = (np.asarray(values)[stop.in_picture] for values in in_view)
    ylim = style.axis_ends(*in_picture, with_zero=name != "pads")
    return Panel(name, title, "time [s]", y, lines, marks,
                 xlim=(time[0], time[-1]), ylim=ylim, columns=2)  # fmt: skip


def _torque_panel(stop: _Stop) -> Panel:
    """Return the panel of torques: of the ECU, of the pads before the stop, and of the truth."""
    lines, answers = list[Line](), torques(stop.columns)
    for side, look, torque in zip(SIDES, (style.FRONT, style.REAR, _TOTAL), answers, strict=True):
        low, high = (
            style.smooth(stop.time, np.where(stop.valid, end / 1e3, np.nan)) for end in torque[1:]
        )
        label = f"{side}, with 95 % band"
        lines.append(Line(stop.time, torque.value / 1e3, look, label, (low, high), style.MEAN))
    for (axle, look), torque, pad in zip(_STROKES.items(), answers, stop.pads, strict=False):
        per_friction = torque.value / np.asarray(stop.columns[f"ecu_pad_friction_{axle}"])
        mean = style.smooth(stop.time, pad * per_friction / 1e3)
        label = f"{AXLE_NAMES[axle]} pads {stop.source}"
        lines.append(Line(stop.time, mean, {**_BEFORE, "color": look["color"]}, label))
    if stop.truth:
        front, rear = 2.0 * stop.truth.torque / 1e3  # two wheels on each axle
        true = zip((front, rear, front + rear), ("truth", "", ""), strict=True)
        lines += [Line(stop.time, y, style.TRUTH, label) for y, label in true]
    in_view = [np.asarray(line.y) for line in lines]
    in_view += [bound for line in lines for bound in line.band or ()]
    title = "Brake torque of the axles and of both"
    return _panel(stop, ("axle-torques", title, "brake torque [kN m]"), lines, in_view)


def _pad_panel(stop: _Stop) -> Panel:
    """Return the panel of the pads (Fig. 9): of the ECU, the best estimate, the ramp, the truth."""
    lines, thin_lines, in_view = list[Line](), list[Line](), list[Array]()
    for axle, look in _STROKES.items():
        pad, low, high = (stop.where_valid(f"ecu_pad_friction_{axle}{end}") for end in ENDS)
        thick, label = {**look, "linewidth": 1.8}, f"{AXLE_NAMES[axle]}, with 95 % band"
        lines.append(Line(stop.time, pad, thick, label, (low, high)))
        in_view += [low, high]
        best = stop.where_valid(f"pad_friction_{axle}")
        if not np.array_equal(best, pad, equal_nan=True):
            thin = {**look, "linewidth": 0.9}
            thin_lines.append(Line(stop.time, best, thin, f"{AXLE_NAMES[axle]}, best estimate"))
    for (axle, look), mu in zip(_STROKES.items(), stop.pads, strict=False):
        label = f"{AXLE_NAMES[axle]} {stop.source}, {mu:.3f}"
        thin = {**_BEFORE, "color": look["color"]}
        thin_lines.append(Line(stop.time[[0, -1]], [mu, mu], thin, label))
        in_view.append(np.full(stop.time.size, mu))
    for i, mu in enumerate(stop.truth.pad_friction if stop.truth else ()):
        true = style.smooth(stop.time, mu)
        thin_lines.append(Line(stop.time, true, style.TRUTH, "" if i else "truth"))
        in_view.append(true)
    labels = "pads", "Pad friction", "pad friction [1]"
    return _panel(stop, labels, [*lines, *thin_lines], in_view)


def _force_panel(stop: _Stop) -> Panel:
    lines = [
        Line(stop.time, stop.columns[key], look, label, mean=style.MEAN)
        for key, look, label in (
            ("normalised_force_f", style.FRONT, "front"),
            ("normalised_force_r", style.REAR, "rear"),
            ("z", style.BODY, "deceleration over g"),
        )
    ]
    labels = "normalised-forces", "Force over load, best estimate", "force over load [1]"
    return _panel(stop, labels, lines, [line.line_values for line in lines])


def _slip_panel(stop: _Stop) -> Panel:
    """Return the panel of eta - 1, and of the slip of the axles if v is known."""
    curves = list[tuple[str, Array, Stroke]]()
    if stop.slips is not None:
        names = [f"{axle} slip" for axle in AXLE_NAMES.values()]
        curves += zip(names, stop.slips, _STROKES.values(), strict=True)
    curves.append(("\u03b7 - 1", np.asarray(stop.columns["eta"]) - 1.0, style.IDENTIFIED))
    lines = [
        Line(stop.time, 100.0 * values, look, name, mean=_SLIP_MEAN)
        for name, values, look in curves
    ]
    samples = stop.valid if stop.valid.any() else stop.in_picture
    # a y axis without the lowest and the highest 0.5 % of the valid values
    ends = [np.quantile(np.asarray(line.y)[samples], [0.005, 0.995]) for line in lines]
    panel = _panel(stop, ("slip", "Slip", f"slip, {style.ETA}"), lines)
    return replace(panel, ylim=style.axis_ends(np.zeros(1), *ends))
