"""The page of a diagnosis: its facts, with the search, the gap and the replays of the hold-outs.

Replays use the pressure and the first speed only. Drawn is replay less measurement, as its mean
over 0.1 s; the noise of the sensor is the band around zero.
"""

import math
from collections.abc import Iterable
from dataclasses import replace
from string import ascii_uppercase

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import WHEELS
from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.proof.unexplained import Unexplained
from calib.diagnosis.replays.gap import CHANNELS, UNITS
from calib.diagnosis.undecided import Confusion
from calib.show.diagnosis import ERROR, KINDS, NO_GAP, facts, outcome
from calib.show.facts import Facts, Picture, Table
from calib.show.numbers import estimate, in_shown, listed, spaced, with_unit
from calib.show.sheet import Line, Panel, Sheet
from calib.show.style import BODY, FRONT, REAR, Stroke, as_text, reach, smooth

_SPEED = "Speed of the open-loop replays less the measured one."
_LARGEST = "Replay less measurement of {}, the log with the largest gap; the band is the noise."
_BASE = (
    "Base parameters as re-identified. How sure the pads are is what it is in a fit: a tyre's own "
    "form, what a log has of its own and the tolerance of the mass count."
)
_NOISE: Stroke = {"color": BODY["color"], "linewidth": 0.6}

_CLOCK = 0.02
"""Step between drawn points [s]; a curve is smoothed over a longer time."""

_PAUSE = 0.6
"""Space between two logs on one axis [s]."""

_LETTERS = 30
"""Letters of a name that the smallest panel has room for."""


def report(found: Diagnosis, title: str) -> Facts:
    """The facts of a diagnosis of the car ``title``, with everything that they rest on."""
    drawn, told = sheet(found, title), facts(found, title)
    parts = [
        *told.parts,
        *([_confusion(found.confusion)] if found.confusion else []),
        *([_unexplained(found.unexplained)] if found.unexplained else []),
        _search(found),
        _gap(found, drawn),
        Facts("Base parameters", tables=[_base(found)]),
    ]
    caption = f"{_SPEED} {_numbered(found)}".rstrip()
    return replace(told, pictures=[Picture(caption, drawn, ("speed",))], parts=parts)


def _search(found: Diagnosis) -> Facts:
    """What each step added, what that brought, and what it left."""
    first = found.steps[0]
    rows = [("nothing", f"{first.innovation:.3f}", "", "", "")]
    for now in found.steps[1:]:
        what = [listed(now.added)] if now.added else []
        what += [f"without {listed(now.removed)}"] if now.removed else []
        name, gain = ", ".join(what) or "the same, fitted anew", f"{0.0 - now.innovation_gain:+.3f}"
        odds = (f"{now.calibration:.0f}", f"{now.holdout:.0f}")
        rows.append((name, f"{now.innovation:.3f}", gain, *odds))
    heads = ("added", "unexplained error", "change", "log odds, searched", "log odds, hold-outs")
    caption = f"The search: {ERROR}, and ln of the odds that each step gains."
    return Facts(
        "Effects that were tried",
        headline="Every effect of the catalogue, with pads and tyres fitted again each time.",
        tables=[Table(heads, rows, caption)],
    )


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
            Table(("explanation", "unexplained error", "behind A"), rows, alike),
            Table(("which", "here", "drive", "there"), drives, apart),
        ],
    )


def _unexplained(found: Unexplained) -> Facts:
    """The empirical term point by point, and other terms that explain a part of the gap."""
    term, unit = found.term, DRIVERS[found.term.driver]
    on = "brake torque" if term.on_brakes else "force over weight"
    points = [
        (f"{in_shown(knot, unit):.3g}", f"{100.0 * value:+.2f} %")
        for knot, value in zip(term.knots, term.values, strict=True)
    ]
    others = [
        (spaced(place), driver, f"{100.0 * share:.0f} %")
        for place, driver, share in found.runners_up
    ]
    heads = (f"{term.driver} [{with_unit('', unit).strip() or '1'}]", f"change of {on}")
    shares = "Other places and drivers, by the share of the gap that they explain."
    return Facts(
        "What no effect explains",
        tables=[
            Table(heads, points, f"The empirical term on the {spaced(term.place)}."),
            Table(("place", "depends on", "explained"), others, shares),
        ],
    )


def _gap(found: Diagnosis, drawn: Sheet) -> Facts:
    """The gap of the hold-outs by log and channel, in units of the noise of each channel."""
    rows: list[tuple[str, ...]] = []
    gap = found.gap
    for log in gap.logs:
        ends = [gap.of(log, channel) for channel in (None, *CHANNELS)]
        rows.append((log, *(f"{a:.2f} to {b:.2f}" for a, b in ends)))
    noises = (f"{x:.4f} {UNITS[name]}" for name, x in zip(CHANNELS, gap.noise, strict=True))
    rows.append(("noise", "1", *noises))
    caption = "Gap by log and channel before and after, in units of the noise, which is taken out."
    name = found.measured[_worst(found)].name
    return Facts(
        "The gap on the hold-outs",
        tables=[Table(("log", "all", *CHANNELS), rows, caption)],
        pictures=[Picture(_LARGEST.format(name), drawn, ("acceleration", "split"))],
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


def sheet(found: Diagnosis, name: str) -> Sheet:
    """Return the sheet of a diagnosis; ``name`` is that of the vehicle."""
    logs = range(len(found.measured))
    worst = _worst(found)
    weights, words = _split_of(found)
    panels = (
        _errors("speed", "Speed", found, logs, {"v": 1.0}, "$v$ [m/s]"),
        _errors("acceleration", "Acceleration", found, [worst], {"a_x": 1.0}, "$a_x$ [m/s$^2$]"),
        _errors("split", f"Wheel speeds, {words}", found, [worst], weights, "[rad/s]"),
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
            f"the noise of single samples. {as_text(_numbered(found))}"
        ).rstrip(),
    )


def _worst(found: Diagnosis) -> int:
    """The place of the hold-out with the largest gap."""
    gaps = [found.gap.of(log)[0] for log in found.gap.logs]
    return gaps.index(max(gaps))


def _labels(found: Diagnosis) -> list[str]:
    """What each hold-out is called in a picture: its name, or its number where names have no room.

    A text that is longer than its part of the axis covers the next one, and the axes shrink to
    give it room.
    """
    lasts = [float(log.time[-1] - log.time[0]) for log in found.measured]
    names = [as_text(log.name) for log in found.measured]
    room = [min(_LETTERS, 2 * _LETTERS * last / sum(lasts)) for last in lasts]
    if all(len(name) <= most for name, most in zip(names, room, strict=True)):
        return names
    return [str(i + 1) for i in range(len(names))]


def _numbered(found: Diagnosis) -> str:
    """The names behind the numbers of the hold-outs, empty where pictures have the names."""
    labels, names = _labels(found), [log.name for log in found.measured]
    if labels == [as_text(name) for name in names]:
        return ""
    pairs = (f"{label} {name}" for label, name in zip(labels, names, strict=True))
    return f"Logs: {', '.join(pairs)}."


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
    logs: Iterable[int],
    weights: dict[str, float],
    unit: str,
) -> Panel:
    """Replay less measurement of a weighted sum of channels, one log after another."""
    noise = sum((w * found.gap.noise[CHANNELS.index(c)]) ** 2 for c, w in weights.items())
    half, start, texts = Z95 * math.sqrt(noise), 0.0, []
    lines: list[Line] = []
    replays = (("after", found.after, FRONT), ("before", found.before, REAR))
    for i in logs:
        measured, first = found.measured[i], not lines
        end = start + float(measured.time[-1] - measured.time[0])
        ends, band = [start, end], (np.full(2, -half), np.full(2, half))
        lines.append(Line(ends, [0.0, 0.0], _NOISE, "noise, 95 %" * first, band))
        for when, sims, stroke in replays[: 1 if found.verdict == NO_GAP else 2]:
            n = min(sims[i].time.size, measured.time.size)
            off = sum(w * (sims[i][c][:n] - measured[c][:n]) for c, w in weights.items())
            time = measured.time[:n] - measured.time[0]
            every = max(1, round(_CLOCK / measured.sample_time))
            shown = smooth(time, np.asarray(off))[::every]
            lines.append(Line(start + time[::every], shown, stroke, when * first))
        texts.append((_labels(found)[i], start, -half))
        start = end + _PAUSE
    height = reach(*(np.asarray(line.y) for line in lines), np.array([-half, half]), margin=0.2)
    x, y = "time, one log after another [s]", f"replay less measured {unit}"
    return Panel(name, title, x, y, lines, texts=texts, ylim=height)
