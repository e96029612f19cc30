"""The page of a diagnosis: its facts, with the search, the gap and the replays of the hold-outs.

Replays use the pressure and the first speed only. Drawn is replay less measurement, as its mean
over 0.1 s; the noise of the sensor is the band around zero.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from calib.base.intervals import Z95
from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnose import Diagnosis
from calib.diagnosis.proof.gap import UNITS, ChannelGap, Gap
from calib.diagnosis.proof.unexplained import UnexplainedTerm
from calib.diagnosis.undecided.confusion import Confusion
from calib.diagnosis.written.course import changes
from calib.logs.log import Log
from calib.show.diagnosis import ERROR, NO_GAP, facts, heading
from calib.show.facts import Facts, Picture, Table
from calib.show.numbers import estimate, in_shown, listed, percent, spaced, unit_shown
from calib.show.sheet import Panel, Sheet
from calib.show.style import FRONT, REAR, SHADE, Array, Axes, Stroke, smooth, view, zero

_BASE = {
    "pad_friction_f": "pad friction, front",
    "pad_friction_r": "pad friction, rear",
    "tyre_stiffness": "slip stiffness of the tyres, over load",
    "tyre_peak": "peak of the tyres, over load",
    "rolling_radius": "rolling radii, over those of the vehicle file",
}
_SPEED = "Speed of the open-loop replays less the measured one."
_LARGEST = "Replay less measurement of the log with the largest gap; the band is the noise."
BEFORE: Stroke = {**REAR, "linewidth": 1.4}
AFTER: Stroke = {**FRONT, "linewidth": 1.4}

_CLOCK = 0.02
"""Step between drawn points [s]; a curve is smoothed over a longer time."""

_PAUSE = 0.6
"""Space between two logs on one axis [s]."""

_AXLES = {"omega_fl": 0.5, "omega_fr": 0.5, "omega_rl": -0.5, "omega_rr": -0.5}
_FRONT_SIDES = {"omega_fl": 1.0, "omega_fr": -1.0}
_REAR_SIDES = {"omega_rl": 1.0, "omega_rr": -1.0}


def report(found: Diagnosis, title: str) -> Facts:
    """The facts of a diagnosis of the car ``title``, with everything that they rest on."""
    drawn, told = sheet(found, title), facts(found, title)
    when = ("after",) if found.verdict == NO_GAP else ("before", "after")
    parts = [
        *told.parts,
        *([_confusion(found.confusion)] if found.confusion else []),
        *([_unexplained(found.unexplained)] if found.unexplained else []),
        _search(found),
        _gap(found, drawn, when),
        Facts("Base parameters", tables=[_base(found)]),
    ]
    return replace(told, pictures=[Picture(_SPEED, drawn, ("speed",))], parts=parts)


def _search(found: Diagnosis) -> Facts:
    """What each step added, what that brought, and what it left."""
    first = found.steps[0]
    rows = [("nothing", f"{first.innovation:.3f}", "", f"{first.left:.2f}", "")]
    for change in changes(found.steps):
        what = [listed(change.added)] if change.added else []
        what += [f"without {listed(change.removed)}"] if change.removed else []
        now, name = change.step, ", ".join(what) or "the same, fitted anew"
        gain, fall = f"{0.0 - change.gain:+.3f}", f"{0.0 - change.fall:+.2f}"
        rows.append((name, f"{now.innovation:.3f}", gain, f"{now.left:.2f}", fall))
    heads = ("added", "unexplained error", "change", "left in replays", "change")
    caption = f"The search: {ERROR}, and lasting errors of the replays over the noise."
    return Facts(
        "Effects that were tried",
        headline="Every effect of the catalogue, with pads and tyres fitted again each time.",
        tables=[Table(heads, rows, caption)],
    )


def _confusion(found: Confusion) -> Facts:
    """The set as a matrix, and the drive for each pair; explanations are called A, B ..."""
    letters = [chr(ord("A") + i) for i in range(len(found.explanations))]
    best = found.explanations[0].innovation
    rows = []
    for i, explanation in enumerate(found.explanations):
        far = ["" if i == j else f"{found.pair(i, j).apart:.0f}" for j in range(len(letters))]
        name, left = f"{letters[i]}: {listed(explanation.names)}", explanation.innovation
        rows.append((name, f"{left:.3f}", f"{left - best:+.4f}" if i else "", *far))
    drives = [
        (f"{letters[pair.one]} or {letters[pair.other]}", pair.drive, f"{pair.sigma:.0f} sigma")
        for pair in found.pairs
    ]
    heads = ("explanation", "unexplained error", "behind A", *(f"to {x}" for x in letters))
    alike = "Explanations that fit these logs alike, and their distances [sigma]."
    apart = "The drive that tells each two of them apart, and their distance in it."
    tables = [Table(heads, rows, alike), Table(("which", "drive", "apart"), drives, apart)]
    return Facts("What these logs cannot tell apart", tables=tables)


def _unexplained(found: UnexplainedTerm) -> Facts:
    """The empirical term point by point, and other terms that explain a part of the gap."""
    term, unit = found.term, DRIVERS[found.term.driver]
    on = "brake torque" if term.on_brakes else "force over weight"
    points = [
        (f"{in_shown(knot, unit):.3g}", f"{100.0 * value:+.2f} %")
        for knot, value in zip(term.knots, term.values, strict=True)
    ]
    others = [(spaced(place), driver, percent(share)) for place, driver, share in found.runners_up]
    heads = (f"{term.driver} [{unit_shown(unit) or '1'}]", f"change of {on}")
    shares = "Other places and drivers, by the share of the gap that they explain."
    return Facts(
        "What no effect explains",
        tables=[
            Table(heads, points, f"The empirical term on the {spaced(term.place)}."),
            Table(("place", "depends on", "explained"), others, shares),
        ],
    )


def _gap(found: Diagnosis, drawn: Sheet, when: tuple[str, ...]) -> Facts:
    """The gap of the hold-outs by log and channel, in units of the noise of each channel."""
    early = [
        f"{log.name}, {word}: {sim.notes[-1]}"
        for word, sims in (("before", found.before), ("after", found.after))
        for sim, log in zip(sims, found.measured, strict=True)
        if sim.time.size < log.time.size and sim.notes and "slower than" not in sim.notes[-1]
    ]
    heads = ("log, channel", *when, *(("closed",) if len(when) > 1 else ()), "noise")
    caption = "Gap by log and channel, noise taken out, in units of the sensor's noise."
    return Facts(
        "The gap on the hold-outs",
        tables=[Table(heads, _by_log(found.gap, when), caption)],
        notes=early,
        pictures=[Picture(_LARGEST, drawn, ("acceleration", "split"))],
    )


def _by_log(gap: Gap, when: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Each log with all channels together, then channel by channel."""
    rows = []
    for log, (before, after) in gap.by_log.items():
        rows.append((log, *_cells(ChannelGap(before, after, 1.0), when), ""))
        for name, channel in gap.cells[log].items():
            cells = _cells(channel, when)
            rows.append((f"{log}, {name}", *cells, f"{channel.noise:.4f} {UNITS[name]}"))
    return rows


def _cells(channel: ChannelGap, when: tuple[str, ...]) -> list[str]:
    """The gap over the noise, before and after, and the share that is closed."""
    cells = [f"{getattr(channel, key) / channel.noise:.2f}" for key in when]
    if len(when) == 1:
        return cells
    if channel.closed is None or channel.within_noise:  # the share of such a gap says nothing
        return [*cells, "within noise"]
    return [*cells, percent(channel.closed) + ", worse" * (channel.closed < 0.0)]


def _base(found: Diagnosis) -> Table:
    """The re-identified base parameters, beside those of the vehicle file."""
    car = found.model_before.vehicle
    nominal = {"pad_friction_f": car.front.pad_friction, "pad_friction_r": car.rear.pad_friction}
    rows = [
        (_BASE.get(name, name), *estimate(x), f"{nominal[name]:g}" if name in nominal else "")
        for name, x in found.base.items()
    ]
    heads = ("parameter", "value", "95 % interval", "vehicle file")
    return Table(heads, rows, "Base parameters as re-identified.")


@dataclass(frozen=True)
class _Replay:
    """A hold-out with its replays; ``noise`` of its channels by name, in their units."""

    measured: Log
    before: Log
    after: Log
    noise: dict[str, float]

    def curves(self, weights: dict[str, float]) -> Iterator[tuple[str, Array, Array]]:
        """Before and after: time [s] and weighted sum of replay less measurement, smoothed."""
        for when, sim in (("before", self.before), ("after", self.after)):
            n = min(sim.time.size, self.measured.time.size)
            time = self.measured.time[:n] - self.measured.time[0]
            off = sum(w * (sim[c][:n] - self.measured[c][:n]) for c, w in weights.items())
            every = max(1, round(_CLOCK / self.measured.sample_time))
            yield when, time[::every], smooth(time, np.asarray(off))[::every]

    def band(self, weights: dict[str, float]) -> float:
        """Half width of the 95 % band of the sensors' noise in a weighted sum."""
        return Z95 * float(np.sqrt(sum((w * self.noise[c]) ** 2 for c, w in weights.items())))


def sheet(found: Diagnosis, name: str) -> Sheet:
    """Return the sheet of a diagnosis; ``name`` is that of the vehicle."""
    logs = _replays_of(found)
    worst = max(logs, key=lambda log: found.gap.by_log[log.measured.name][0])
    weights, words = _split_of(found)
    same = found.verdict == "no_gap"
    speed, a_x = {"v": 1.0}, {"a_x": 1.0}
    panels = [
        Panel("speed", "Speed", errors, (logs, speed, "$v$ [m/s]", same)),
        Panel("acceleration", "Acceleration", errors, ([worst], a_x, "$a_x$ [m/s$^2$]", same)),
        Panel("split", f"Wheel speeds, {words}", errors, ([worst], weights, "[rad/s]", same)),
    ]
    return Sheet(
        kind="diagnosis",
        name=name,
        title=f"Diagnosis of {name}: {heading(found)}",
        note=(
            "Replays are open loop: pressure and first speed only. Before: pads and tyre "
            "re-identified, no effect added. After: with all that was added. The band is 95 % of "
            "the noise of single samples."
        ),
        panels=tuple(panels),
        rows=(("speed",) * 2, ("acceleration", "split")),
    )


def _replays_of(found: Diagnosis) -> list[_Replay]:
    """Hold-outs with their replays, in their order."""
    noise = {name: channel.noise for name, channel in found.gap.by_channel.items()}
    together = zip(found.measured, found.before, found.after, strict=True)
    return [_Replay(measured, before, after, noise) for measured, before, after in together]


def _split_of(found: Diagnosis) -> tuple[dict[str, float], str]:
    """Weights and words of the wheel speed difference that shows the effect: axles or sides."""
    channels = {effect.where.channel for effect in found.effects}
    if "front_sides" in channels:
        return _FRONT_SIDES, "front, left less right"
    if "rear_sides" in channels:
        return _REAR_SIDES, "rear, left less right"
    return _AXLES, "front less rear"


def errors(
    ax: Axes, logs: list[_Replay], weights: dict[str, float], ylabel: str, same: bool
) -> None:
    """Replay less measurement of a weighted sum of channels, one log after another.

    ``same``: there is only one replay, as nothing was added.
    """
    start, shown = 0.0, []
    across = ax.get_xaxis_transform()
    for i, log in enumerate(logs):
        end = start + float(log.measured.time[-1] - log.measured.time[0])
        half = log.band(weights)
        label = None if i else "noise, 95 %"
        span: Stroke = {"color": SHADE, "linewidth": 0.0, "zorder": 0}
        ax.fill_between((start, end), -half, half, label=label, **span)
        shown.append(np.array([-half, half]))
        for when, time, off in log.curves(weights):
            if when == "after" or not same:
                word = "replay" if same else when
                stroke = BEFORE if when == "before" else AFTER
                ax.plot(start + time, off, label=None if i else word, **stroke)
                shown.append(off)
        ax.text(start, 0.02, log.measured.name, transform=across, fontsize=7.0, va="bottom")
        start = end + _PAUSE
    zero(ax)
    view(ax, *shown, zero=True, margin=0.15)
    low, high = ax.get_ylim()
    ax.set_ylim(low - 0.12 * (high - low), high)  # room for the names of the logs
    ax.set(xlabel="time, one log after another [s]", ylabel=f"replay less measured {ylabel}")
