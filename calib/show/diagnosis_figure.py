"""A diagnosis: the hold-outs replayed before and after.

Replays use the pressure and the first speed only. Drawn is replay less measurement, as its mean
over 0.1 s; the noise of the sensor is the band around zero.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from calib.base.intervals import Z95
from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnose import Diagnosis
from calib.diagnosis.proof.unexplained import UnexplainedTerm
from calib.logs.log import Log
from calib.show.diagnosis import heading
from calib.show.numbers import in_shown, spaced, unit_shown
from calib.show.sheet import Panel, Sheet
from calib.show.style import (
    FRONT,
    REAR,
    SHADE,
    Array,
    Axes,
    Stroke,
    smooth,
    view,
    zero,
)

BEFORE: Stroke = {**REAR, "linewidth": 1.4}
AFTER: Stroke = {**FRONT, "linewidth": 1.4}

CLOCK = 0.02
"""Step between drawn points [s]; a curve is smoothed over a longer time."""

PAUSE = 0.6
"""Space between two logs on one axis [s]."""

AXLES = {"omega_fl": 0.5, "omega_fr": 0.5, "omega_rl": -0.5, "omega_rr": -0.5}
_FRONT_SIDES = {"omega_fl": 1.0, "omega_fr": -1.0}
_REAR_SIDES = {"omega_rl": 1.0, "omega_rr": -1.0}


@dataclass(frozen=True)
class Replay:
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
            every = max(1, round(CLOCK / self.measured.sample_time))
            yield when, time[::every], smooth(time, np.asarray(off))[::every]

    def band(self, weights: dict[str, float]) -> float:
        """Half width of the 95 % band of the sensors' noise in a weighted sum."""
        return Z95 * float(np.sqrt(sum((w * self.noise[c]) ** 2 for c, w in weights.items())))


def sheet(found: Diagnosis, name: str) -> Sheet:
    """Return the sheet of a diagnosis; ``name`` is that of the vehicle."""
    logs = replays_of(found)
    worst = max(logs, key=lambda log: found.gap.by_log[log.measured.name][0])
    weights, words = split_of(found)
    same = found.verdict == "no_gap"
    speed, a_x = {"v": 1.0}, {"a_x": 1.0}
    panels = [
        Panel("speed", "Speed", errors, (logs, speed, "$v$ [m/s]", same)),
        Panel("acceleration", "Acceleration", errors, ([worst], a_x, "$a_x$ [m/s$^2$]", same)),
        Panel("split", f"Wheel speeds, {words}", errors, ([worst], weights, "[rad/s]", same)),
    ]
    rows: list[tuple[str, ...]] = [("speed",) * 2, ("acceleration", "split")]
    if (left := found.unexplained) is not None:
        title = f"Empirical term on the {spaced(left.term.place)} over {left.term.driver}"
        panels.append(Panel("term", title, empirical, (left,)))
        rows.append(("term",) * 2)
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
        rows=tuple(rows),
    )


def replays_of(found: Diagnosis) -> list[Replay]:
    """Hold-outs with their replays, in their order."""
    noise = {name: channel.noise for name, channel in found.gap.by_channel.items()}
    together = zip(found.measured, found.before, found.after, strict=True)
    return [Replay(measured, before, after, noise) for measured, before, after in together]


def split_of(found: Diagnosis) -> tuple[dict[str, float], str]:
    """Weights and words of the wheel speed difference that shows the effect: axles or sides."""
    channels = {effect.where.channel for effect in found.effects}
    if "front_sides" in channels:
        return _FRONT_SIDES, "front, left less right"
    if "rear_sides" in channels:
        return _REAR_SIDES, "rear, left less right"
    return AXLES, "front less rear"


def errors(
    ax: Axes, logs: list[Replay], weights: dict[str, float], ylabel: str, same: bool
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
        start = end + PAUSE
    zero(ax)
    view(ax, *shown, zero=True, margin=0.15)
    low, high = ax.get_ylim()
    ax.set_ylim(low - 0.12 * (high - low), high)  # room for the names of the logs
    ax.set(xlabel="time, one log after another [s]", ylabel=f"replay less measured {ylabel}")


def empirical(ax: Axes, found: UnexplainedTerm) -> None:
    """The term that was added for an unknown cause, over its driver."""
    term = found.term
    unit = DRIVERS[term.driver]
    x = np.array([in_shown(knot, unit) for knot in term.knots])
    ax.plot(x, 100.0 * np.array(term.values), marker="o", markersize=4.0, **AFTER)
    zero(ax)
    on = "brake torque" if term.on_brakes else "force over weight"
    driver = {"time": "time since the bite", "temperature": "disc temperature"}
    word = driver.get(term.driver, term.driver)
    ax.set(xlabel=f"{word} [{unit_shown(unit) or '1'}]", ylabel=f"change of {on} [%]")
