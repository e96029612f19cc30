"""The page of a diagnosis: its facts, with the search, the gap and the replays of the hold-outs."""

from dataclasses import replace

from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnose import Diagnosis
from calib.diagnosis.proof.gap import UNITS, ChannelGap, Gap
from calib.diagnosis.proof.unexplained import UnexplainedTerm
from calib.diagnosis.undecided.confusion import Confusion
from calib.diagnosis.written.course import changes
from calib.show import diagnosis_figure as figures
from calib.show.diagnosis import ERROR, NO_GAP, facts
from calib.show.facts import Facts, Picture, Table
from calib.show.numbers import estimate, in_shown, listed, percent, spaced, unit_shown
from calib.show.sheet import Sheet

BASE = {
    "pad_friction_f": "pad friction, front",
    "pad_friction_r": "pad friction, rear",
    "tyre_stiffness": "slip stiffness of the tyres, over load",
    "tyre_peak": "peak of the tyres, over load",
    "rolling_radius": "rolling radii, over those of the vehicle file",
}
LARGEST = "Replay less measurement of the log with the largest gap; the band is the noise."
MEASURED = (
    "The gap is that of the hold-outs alone, replayed from their pressures and first speed. An "
    "effect is named if it explains nearly all of the excess of the calibration logs over their "
    "noise, and if the hold-outs get better with it.",
    "Pads and tyres differ from car to car and day to day: they are identified, and no effect.",
    "Beside this page: diagnosis.json (all numbers), model.toml (for brake-cal simulate --model), "
    "and the replays in sim/before and sim/after.",
)


def report(found: Diagnosis, title: str) -> Facts:
    """The facts of a diagnosis of the car ``title``, with everything that they rest on."""
    sheet, told = figures.sheet(found, title), facts(found, title)
    when = ("after",) if found.verdict == NO_GAP else ("before", "after")
    parts = [
        *told.parts,
        *([_confusion(found.confusion)] if found.confusion else []),
        *([_unexplained(found.unexplained, sheet)] if found.unexplained else []),
        _search(found),
        _gap(found, sheet, when),
        Facts("Base parameters", tables=[_base(found)]),
        Facts("How it was measured", notes=MEASURED),
    ]
    ends = f"At the end of each log: {'; '.join(_speed_ends(found, when))}."
    speed = f"Speed of the open-loop replays less the measured one. {ends}"
    return replace(told, pictures=[Picture(speed, sheet, ("speed",))], parts=parts)


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
    leaves = [(name, f"{left:.2f}") for name, left in explanations(found)]
    return Facts(
        "Effects that were tried",
        headline="Every effect of the catalogue, with pads and tyres fitted again each time.",
        tables=[
            Table(("explanation", "leaves"), leaves, f"{ERROR.capitalize()} of each explanation."),
            Table(heads, rows if len(rows) > 1 else (), caption),
        ],
    )


def explanations(found: Diagnosis) -> list[tuple[str, float]]:
    """The explanations and the unexplained error that each leaves, the worst first."""
    before, after, left = found.reduced_before, found.reduced_after, found.unexplained
    seconds = dict(effect.runner_up for effect in found.effects if effect.runner_up is not None)
    rows = [("nothing added", before)]
    if left is not None and not found.effects:
        rows += [
            (f"{spaced(place)} over {driver}", before - share * (before - 1.0))
            for place, driver, share in reversed(left.runners_up)
        ]
        return [*rows, (f"{spaced(left.term.place)} over {left.term.driver}, added", after)]
    ordered = sorted(seconds.items(), key=lambda item: item[1])
    rows += [(f"{spaced(name)}, runner-up", before - gained) for name, gained in ordered]
    if found.effects:
        names = " + ".join(spaced(effect.name) for effect in found.effects)
        rows.append((f"{names}, added", after))
        if left is not None:
            rest = f"{spaced(left.term.place)} over {left.term.driver}, not added"
            rows.append((rest, after - left.explained * (after - 1.0)))
    return rows


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


def _unexplained(found: UnexplainedTerm, sheet: Sheet) -> Facts:
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
    caption = f"The empirical term on the {spaced(term.place)}."
    return Facts(
        "What no effect explains",
        tables=[
            Table(heads, points, "The empirical term; linear between its points."),
            Table(("place", "depends on", "explained"), others, shares),
        ],
        pictures=[Picture(caption, sheet, ("term",))],
    )


def _gap(found: Diagnosis, sheet: Sheet, when: tuple[str, ...]) -> Facts:
    """The gap of the hold-outs by channel, and by log in units of the noise of each channel."""
    by_channel = [
        (f"{name} [{UNITS[name]}]", *(f"{getattr(c, key):.4f}" for key in (*when, "noise")))
        for name, c in found.gap.by_channel.items()
    ]
    early = [
        f"{log.name}, {word}: {sim.notes[-1]}"
        for word, sims in (("before", found.before), ("after", found.after))
        for sim, log in zip(sims, found.measured, strict=True)
        if sim.time.size < log.time.size and sim.notes and "slower than" not in sim.notes[-1]
    ]
    heads = ("log, channel", *when, *(("closed",) if len(when) > 1 else ()), "noise")
    rms = "Gap by channel: rms of replay less measurement, noise taken out; and the noise."
    by_log = "Gap by log and channel, in units of the sensor's noise."
    return Facts(
        "The gap on the hold-outs",
        tables=[
            Table(("channel", *when, "noise"), by_channel, rms),
            Table(heads, _by_log(found.gap, when), by_log),
        ],
        notes=early,
        pictures=[Picture(LARGEST, sheet, ("acceleration", "split"))],
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


def _speed_ends(found: Diagnosis, when: tuple[str, ...]) -> list[str]:
    """Difference of replayed and measured speed at the end of each replay."""
    ends = []
    for replay in figures.replays_of(found):
        last = {word: f"{off[-1]:+.2f} m/s {word}" for word, _, off in replay.curves({"v": 1.0})}
        ends.append(f"{replay.measured.name} {', '.join(last[word] for word in when)}")
    return ends


def _base(found: Diagnosis) -> Table:
    """The re-identified base parameters, beside those of the vehicle file."""
    car = found.model_before.vehicle
    nominal = {"pad_friction_f": car.front.pad_friction, "pad_friction_r": car.rear.pad_friction}
    rows = [
        (BASE.get(name, name), *estimate(x), f"{nominal[name]:g}" if name in nominal else "")
        for name, x in found.base.items()
    ]
    heads = ("parameter", "value", "95 % interval", "vehicle file")
    return Table(heads, rows, "Base parameters as re-identified.")
