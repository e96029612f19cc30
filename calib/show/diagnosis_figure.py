"""The picture of a diagnosis: open-loop replays of the hold-outs less what was measured.

A replay uses the pressure and the first speed of its log only. Lines are means over 0.1 s.
"""

import math
from collections.abc import Sequence

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import WHEELS
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.replays import CHANNELS
from calib.run.filters import samples_in
from calib.show.numbers import spaced, to_printed, with_unit
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, FRONT, IDENTIFIED, NOMINAL, Stroke, as_text, axis_ends, smooth

_NOISE: Stroke = {"color": BODY["color"], "linewidth": 0.6}
_STEP, _PAUSE = 0.02, 0.6
"""Step between drawn points, below the window of the mean; space between two logs [s]."""
_LETTERS = 30
"""Letters of a name that fit into half of the smallest panel."""


def diagnosis_sheet(diagnosis: Diagnosis) -> Sheet:
    """Return the sheet of a diagnosis: v of all hold-outs, a_x and wheel speeds of the worst."""
    name = diagnosis.model_before.vehicle.name
    logs, worst_log = range(len(diagnosis.measured)), [worst(diagnosis)]
    weights, words = _split_of(diagnosis)
    a_x = "acceleration", "Acceleration", "a_x [m/s\u00b2]"
    panels = (
        _errors(diagnosis, ("speed", "Speed", "v [m/s]"), logs, {"v": 1.0}),
        _errors(diagnosis, a_x, worst_log, {"a_x": 1.0}),
        _errors(diagnosis, ("split", f"Wheel speeds, {words}", "[rad/s]"), worst_log, weights),
        *([_term(diagnosis.unexplained.term)] if diagnosis.unexplained else []),
    )
    return Sheet(
        kind="diagnosis",
        name=name,
        panels=panels,
        rows=(("speed",) * 2, ("acceleration", "split")),
        title=f"Diagnosis of {name}",
        note=(
            "Replays are open loop: pressure and first speed only. Before: pads and tyre "
            "re-identified, no effect added. After: with all that was added. The band is 95 % of "
            "the noise of single samples."
        ),
    )


def has_changed(diagnosis: Diagnosis) -> bool:
    """Return whether the diagnosis changed the replays."""
    return diagnosis.gap.rms_before != diagnosis.gap.rms_after


def worst(diagnosis: Diagnosis) -> int:
    """Return the index of the hold-out with the largest gap."""
    gaps = [diagnosis.gap.rms(log)[0] for log in diagnosis.gap.logs]
    return gaps.index(max(gaps))


def _term(term: EmpiricalTerm) -> Panel:
    """Return the panel of an empirical term over its driver, the quantity that it depends on."""
    unit = DRIVERS[term.driver]
    x = f"{term.driver} [{with_unit('', unit).strip() or '1'}]"
    y = f"change of {'brake torque' if term.on_brakes else 'force over weight'} [%]"
    knots = [to_printed(knot, unit) for knot in term.knots]
    line = Line(knots, [100.0 * value for value in term.values], {**FRONT, "marker": "."})
    return Panel("term", f"On the {spaced(term.place)}", x, y, [line])


def _split_of(diagnosis: Diagnosis) -> tuple[dict[str, float], str]:
    """Return the weights of the wheel speeds in the difference to draw, and its name.

    It is the difference of the sides of an axle if a named effect acts there, else of the axles.
    """
    channels = {effect.where.channel for effect in diagnosis.effects}
    for axle in ("front", "rear"):
        if f"{axle}_sides" in channels:
            left, right = (f"omega_{axle[0]}{side}" for side in "lr")
            return {left: 1.0, right: -1.0}, f"{axle}, left less right"
    weights = {"f": 0.5, "r": -0.5}
    return {f"omega_{wheel}": weights[wheel[0]] for wheel in WHEELS}, "front less rear"


def _errors(
    diagnosis: Diagnosis, labels: Sequence[str], logs: Sequence[int], weights: dict[str, float]
) -> Panel:
    """Return a panel with replay less measurement of a sum of channels with ``weights``.

    ``labels`` are name, title and unit. The ``logs``, by their indices, stand one after another,
    each below its number and name.
    """
    name, title, unit = labels
    noises = [w * diagnosis.gap.noise[CHANNELS.index(channel)] for channel, w in weights.items()]
    half, start = Z95 * math.hypot(*noises), 0.0
    band = np.full(2, -half), np.full(2, half)
    lines, names = list[Line](), []
    replays = [
        ("after", diagnosis.replays_after, IDENTIFIED),
        ("before", diagnosis.replays_before, NOMINAL),
    ]
    if not has_changed(diagnosis):
        replays = [("replay", diagnosis.replays_before, NOMINAL)]
    duration = sum(float(np.ptp(diagnosis.measured[i].time)) for i in logs)
    for i in logs:
        measured = diagnosis.measured[i]
        is_first = not lines  # the legend names the lines of the first log only
        end = start + float(measured.time[-1] - measured.time[0])
        label = "noise, 95 %" if is_first else ""
        lines.append(Line([start, end], [0.0, 0.0], _NOISE, label, band))
        for word, logs_of_replay, stroke in replays:
            replay = logs_of_replay[i]
            n = min(replay.time.size, measured.time.size)
            error = sum(w * (replay[c][:n] - measured[c][:n]) for c, w in weights.items())
            time = measured.time[:n] - measured.time[0]
            stride = samples_in(_STEP, measured.sample_time)
            mean = smooth(time, np.asarray(error))[::stride]
            lines.append(Line(start + time[::stride], mean, stroke, word if is_first else ""))
        letters = int(2 * _LETTERS * (end - start) / duration)  # by the share of the panel
        names.append((as_text(f"{i + 1} {measured.name}"[: min(letters, _LETTERS)]), start))
        start = end + _PAUSE
    values = [np.asarray(line.y) for line in lines]
    ends = axis_ends(*values, np.array([-half, half]), margin=0.2) or (-half, half)
    texts = [(text, x, ends[1]) for text, x in names]
    x = "time, one log after another [s]" if len(logs) > 1 else "time [s]"
    return Panel(name, title, x, f"replay less measured {unit}", lines, texts=texts, ylim=ends)
