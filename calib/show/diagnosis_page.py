"""The page of a diagnosis: its facts, with the search, the gap and the replays of the hold-outs.

Replays use the pressure and the first speed only. Drawn is replay less measurement, as its mean
over 0.1 s; the noise of the sensor is the band around zero.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from string import ascii_uppercase

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import WHEELS
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.replays.gap import CHANNELS, UNITS
from calib.diagnosis.undecided import Confusion
from calib.show.diagnosis import INNOVATION, KINDS, head, outcome
from calib.show.facts import Facts, Picture, Table
from calib.show.numbers import estimate, in_shown, listed, spaced, with_unit
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, FRONT, IDENTIFIED, NOMINAL, Stroke, as_text, reach, smooth

_SPEED = "Speed of the open-loop replays of the hold-outs less the measured one."
_LARGEST = "Replay less measurement of {}, the log with the largest gap; the band is the noise."
_GAP = "By log and channel, in units of the noise, which is taken out."
_SEARCH = "What each step of the search added, what it left, and ln of the odds that it gained."
_BASE = (
    "Base parameters from all calibration logs. The pads' intervals count the mass, a tyre's own "
    "form and what each log has of its own. Those of a fit are wider, most in the rear: it has its "
    "ramps alone, and counts axle loads and unlike tyres too."
)
_NOISE: Stroke = {"color": BODY["color"], "linewidth": 0.6}

_CLOCK = 0.02
"""Step between drawn points [s]; a curve is smoothed over a longer time."""

_PAUSE = 0.6
"""Space between two logs on one axis [s]."""

_LETTERS = 30
"""Letters of a name that the smallest panel has room for."""


def facts(found: Diagnosis) -> Facts:
    """A diagnosis with everything that it rests on."""
    told = head(found)
    parts = [
        *told.parts,
        *([_confusion(found.confusion)] if found.confusion else []),
        *([_unexplained(found)] if found.unexplained else []),
        _gap(found),
        Facts("What it rests on", tables=[_search(found), _base(found)]),
    ]
    return replace(told, pictures=[_picture(found, _SPEED, "speed")], parts=parts)


def _picture(found: Diagnosis, caption: str, *names: str) -> Picture:
    return Picture(caption, lambda: sheet(found), names)


def _search(found: Diagnosis) -> Table:
    """What each step added, what it left, and what that brought."""
    rows = [("nothing", f"{found.steps[0].innovation:.3f}", "", "")]
    for now in found.steps[1:]:
        what = [listed(now.added)] if now.added else []
        what += [f"without {listed(now.removed)}"] if now.removed else []
        name = ", ".join(what) or "the same, fitted anew"
        rows.append((name, f"{now.innovation:.3f}", f"{now.calibration:.0f}", f"{now.holdout:.0f}"))
    return Table(("added", INNOVATION, "log odds, searched", "log odds, hold-outs"), rows, _SEARCH)


def _confusion(found: Confusion) -> Facts:
    """The set, and the drive for each pair; explanations are called A, B ..."""
    letters = ascii_uppercase
    rows = [
        (f"{letters[i]}: {listed(one.effects)}", f"{one.innovation:.3f}",
         f"{one.behind:+.4f}" if i else "")
        for i, one in enumerate(found.explanations)
    ]  # fmt: skip
    drives = [
        (" or ".join(letters[i] for i in pair.between), f"{pair.apart_in_logs:.0f} sigma",
         pair.drive, f"{pair.apart_in_drive:.0f} sigma")
        for pair in found.pairs
    ]  # fmt: skip
    alike = "Explanations that fit these logs alike."
    apart = "How far these logs tell each two of them apart, and the drive that would."
    return Facts(
        "What these logs cannot tell apart",
        tables=[
            Table(("explanation", INNOVATION, "behind A"), rows, alike),
            Table(("which", "here", "drive", "there"), drives, apart),
        ],
    )


def _unexplained(found: Diagnosis) -> Facts:
    """The empirical term, and other terms that explain a part of the gap."""
    left = found.unexplained
    others = [
        (spaced(place), driver, f"{100.0 * share:.0f} %")
        for place, driver, share in (left.runners_up if left else ())
    ]
    shares = "Other places and drivers, by the share of the gap that they explain."
    table = Table(("place", "depends on", "explained"), others, shares)
    picture = _picture(found, "An empirical term: what it adds, by what it depends on.", "term")
    return Facts("What no effect explains", tables=[table], pictures=[picture])


def _gap(found: Diagnosis) -> Facts:
    """The gap of the hold-outs by log and channel, in units of the noise of each channel."""
    both, gap = _added(found), found.gap
    rows: list[tuple[str, ...]] = []
    for i, log in enumerate(gap.logs, 1):
        ends = [gap.of(log, channel) for channel in (None, *CHANNELS)]
        told = (f"{a:.1f} to {b:.1f}" if both else f"{a:.1f}" for a, b in ends)
        rows.append((f"{i} {log}", *told))
    noises = (f"{x:.4f} {UNITS[name]}" for name, x in zip(CHANNELS, gap.noise, strict=True))
    rows.append(("noise", "1", *noises))
    name = found.measured[_worst(found)].name
    return Facts(
        "The gap on the hold-outs" + ", before to after" * both,
        tables=[Table(("log", "all", *CHANNELS), rows, _GAP)],
        pictures=[_picture(found, _LARGEST.format(name), "acceleration", "split")],
    )


def _base(found: Diagnosis) -> Table:
    """The re-identified base parameters, beside those of the vehicle file."""
    car = found.model_before.vehicle
    nominal = {"pad_friction_f": car.front.pad_friction, "pad_friction_r": car.rear.pad_friction}
    rows = [
        (spaced(name), *estimate(x), f"{nominal[name]:g}" if name in nominal else "")
        for name, x in found.base.items()
    ]
    heads = ("parameter", "value", "95 % interval", "vehicle file")
    return Table(heads, rows, _BASE)


def sheet(found: Diagnosis) -> Sheet:
    """Return the sheet of a diagnosis."""
    logs, name = range(len(found.measured)), found.model_before.vehicle.name
    worst = _worst(found)
    weights, words = _split_of(found)
    panels = (
        _errors("speed", "Speed", found, logs, {"v": 1.0}, "v [m/s]"),
        _errors("acceleration", "Acceleration", found, [worst], {"a_x": 1.0}, "a_x [m/s\u00b2]"),
        _errors("split", f"Wheel speeds, {words}", found, [worst], weights, "[rad/s]"),
        *([_term(found.unexplained.term)] if found.unexplained else []),
    )
    return Sheet(
        kind="diagnosis",
        name=name,
        panels=panels,
        rows=(("speed",) * 2, ("acceleration", "split")),
        title=f"Diagnosis of {name}: {KINDS[outcome(found)][0]}",
        note=(
            "Replays are open loop: pressure and first speed only. Before: pads and tyre "
            "re-identified, no effect added. After: with all that was added. The band is 95 % of "
            "the noise of single samples."
        ),
    )


def _added(found: Diagnosis) -> bool:
    """Whether replays after the diagnosis are others than before."""
    return found.gap.before != found.gap.after


def _worst(found: Diagnosis) -> int:
    """The place of the hold-out with the largest gap."""
    gaps = [found.gap.of(log)[0] for log in found.gap.logs]
    return gaps.index(max(gaps))


def _term(term: EmpiricalTerm) -> Panel:
    """What the empirical term adds, over what it depends on."""
    unit = DRIVERS[term.driver]
    x = f"{term.driver} [{with_unit('', unit).strip() or '1'}]"
    y = f"change of {'brake torque' if term.on_brakes else 'force over weight'} [%]"
    knots = [in_shown(knot, unit) for knot in term.knots]
    line = Line(knots, [100.0 * value for value in term.values], {**FRONT, "marker": "."})
    return Panel("term", f"On the {spaced(term.place)}", x, y, [line])


def _split_of(found: Diagnosis) -> tuple[dict[str, float], str]:
    """Weights and words of the wheel speed difference that shows the effect: axles or sides."""
    channels = {effect.where.channel for effect in found.effects}
    for axle in ("front", "rear"):
        if f"{axle}_sides" in channels:
            left, right = (f"omega_{axle[0]}{side}" for side in "lr")
            return {left: 1.0, right: -1.0}, f"{axle}, left less right"
    weights = {"f": 0.5, "r": -0.5}
    return {f"omega_{wheel}": weights[wheel[0]] for wheel in WHEELS}, "front less rear"


def _errors(
    name: str,
    title: str,
    found: Diagnosis,
    logs: Sequence[int],
    weights: dict[str, float],
    unit: str,
) -> Panel:
    """Replay less measurement of a weighted sum of channels, one log after another.

    A log has its number among the hold-outs and as much of its name as its part of the axis has
    room for: a text that is longer covers the next one, and the axes shrink to give it room.
    """
    noise = sum((w * found.gap.noise[CHANNELS.index(c)]) ** 2 for c, w in weights.items())
    half, start, names = Z95 * math.sqrt(noise), 0.0, []
    lines: list[Line] = []
    replays = [("after", found.after, IDENTIFIED), ("before", found.before, NOMINAL)]
    if not _added(found):
        replays = [("replay", found.before, NOMINAL)]
    whole = sum(float(found.measured[i].time[-1] - found.measured[i].time[0]) for i in logs)
    for i in logs:
        measured, first = found.measured[i], not lines
        end = start + float(measured.time[-1] - measured.time[0])
        band = np.full(2, -half), np.full(2, half)
        lines.append(Line([start, end], [0.0, 0.0], _NOISE, "noise, 95 %" * first, band))
        for when, sims, stroke in replays:
            n = min(sims[i].time.size, measured.time.size)
            off = sum(w * (sims[i][c][:n] - measured[c][:n]) for c, w in weights.items())
            time = measured.time[:n] - measured.time[0]
            every = max(1, round(_CLOCK / measured.sample_time))
            shown = smooth(time, np.asarray(off))[::every]
            lines.append(Line(start + time[::every], shown, stroke, when * first))
        room = min(_LETTERS, int(2 * _LETTERS * (end - start) / whole))
        names.append((as_text(f"{i + 1} {measured.name}"[:room]), start))
        start = end + _PAUSE
    drawn = [np.asarray(line.y) for line in lines]
    ends = reach(*drawn, np.array([-half, half]), margin=0.2) or (-half, half)
    texts = [(text, at, ends[1]) for text, at in names]
    x = "time, one log after another [s]" if len(logs) > 1 else "time [s]"
    return Panel(name, title, x, f"replay less measured {unit}", lines, texts=texts, ylim=ends)
