"""The report of a diagnosis: one HTML file that can be read without the program."""

from calib.diagnosis.diagnose import Diagnosis, Named
from calib.diagnosis.proof.gap import UNITS, ChannelGap, Gap
from calib.diagnosis.proof.unexplained import UnexplainedTerm
from calib.diagnosis.undecided.confusion import Confusion
from calib.diagnosis.written import printed, words
from calib.diagnosis.written.course import changes
from calib.diagnosis.written.headline import KINDS, headline, outcome
from calib.physics.effects.empirical import DRIVERS
from calib.physics.own_effects.own_effect import definition
from calib.plots import diagnosis
from calib.plots.sheet import Sheet
from calib.reports.html import drawn, page
from calib.reports.judged import warned

BASE = {
    "pad_friction_f": "pad friction, front",
    "pad_friction_r": "pad friction, rear",
    "tyre_stiffness": "slip stiffness of the tyres, over load",
    "tyre_peak": "peak of the tyres, over load",
    "rolling_radius": "rolling radii, over those of the vehicle file",
}

COLOURS = {
    "no_gap": "no_gap",
    "named": "named",
    "rest": "ambiguous",
    "worse": "unknown",
    "ambiguous": "ambiguous",
    "ambiguous_rest": "ambiguous",
    "unknown": "unknown",
}
"""Classes of the style sheet by outcome: only the first two are green or blue."""


def report_html(found: Diagnosis, title: str) -> str:
    """Return the report of a diagnosis as one HTML document with the heading ``title``."""
    sheet = diagnosis.sheet(found, title)
    judged = outcome(found)
    when = ("before",) if found.verdict == "no_gap" else ("before", "after")
    return page(
        "diagnosis",
        title=f"{title}: {diagnosis.heading(found)}",
        name=title,
        verdict=found.verdict,
        headline=headline(found),
        gap=found.gap,
        holdouts=[log.name for log in found.measured],
        speed=drawn(sheet, "speed"),
        speed_ends=_speed_ends(found, when),
        effects=[_effect(effect, found) for effect in found.effects],
        unexplained=found.unexplained and _unexplained(found.unexplained, sheet),
        kind=KINDS[judged],
        colour=COLOURS[judged],
        warnings=[warned(warning) for warning in found.warnings],
        something_else=words.something_else(found),
        withdrawn=words.withdrawn(found),
        own_effects=words.own_effects(found),
        noise=words.noise(found),
        steps=_steps(found),
        confusion=found.confusion and _confusion(found.confusion),
        not_resolved=words.not_resolved(found),
        known=words.known(found),
        radii=words.radii(found),
        sides=words.sides(found),
        start_heats=words.start_heats(found),
        offsets=words.offsets(found),
        own_pads=words.own_pads(found),
        groups=[
            (words.listed(group.logs), words.factors_of(group) if i else "the reference")
            for i, group in enumerate(found.groups)
        ],
        drives=_drives(found),
        evidence=drawn(sheet, "evidence"),
        tried=[f"{label} leaves {left:.2f}" for label, left, _ in diagnosis.explanations(found)],
        largest=drawn(sheet, "acceleration", "split", "gap"),
        by_channel=[
            (f"{name} [{UNITS[name]}]", *(f"{getattr(c, key):.4f}" for key in (*when, "noise")))
            for name, c in found.gap.by_channel.items()
        ],
        closure=_closure(found.gap, when),
        closure_kinds=_closure_kinds(found.gap),
        early_ends=words.early_ends(found),
        base=_base(found),
    )


def _closure(gap: Gap, when: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Each log with all channels together, then channel by channel, in units of the noise."""
    rows = []
    for log, (before, after) in gap.by_log.items():
        # a log as a whole, in units of the noise of each channel
        whole = ChannelGap(before, after, 1.0)
        rows.append((log, *_cells(whole, when), ""))
        for name, channel in gap.cells[log].items():
            noise = f"{channel.noise:.4f} {UNITS[name]}"
            rows.append((name, *_cells(channel, when), noise))
    return rows


def _cells(channel: ChannelGap, when: tuple[str, ...]) -> list[str]:
    """The gap over the noise, before and after, and the share that is closed."""
    cells = [f"{getattr(channel, key) / channel.noise:.2f}" for key in when]
    return [*cells, _closed(channel)] if len(when) > 1 else cells


def _closed(channel: ChannelGap) -> str:
    """The share that is closed; that of a gap within the noise says nothing."""
    if channel.closed is None or channel.within_noise:
        return "within noise"
    if channel.closed < 0.0:
        return f"{printed.percent(channel.closed)}, worse"
    return printed.percent(channel.closed)


def _closure_kinds(gap: Gap) -> list[str]:
    """Class of each row of the closure table."""
    return [kind for cells in gap.cells.values() for kind in ("whole", *["part"] * len(cells))]


def _steps(found: Diagnosis) -> list[tuple[str, ...]]:
    """What each step added, what that brought, and what it left."""
    first, *_ = found.steps
    rows: list[tuple[str, ...]] = [
        ("nothing", f"{first.innovation:.3f}", "", f"{first.left:.2f}", "")
    ]
    for change in changes(found.steps):
        what = [words.listed(change.added)] if change.added else []
        what += [f"without {words.listed(change.removed)}"] if change.removed else []
        now = change.step
        error, left = f"{now.innovation:.3f}", f"{now.left:.2f}"
        shown = ", ".join(what) or "the same, fitted anew"
        rows.append((shown, error, f"{0.0 - change.gain:+.3f}", left, f"{0.0 - change.fall:+.2f}"))
    return rows


def _confusion(found: Confusion) -> dict[str, object]:
    """The set as a matrix, and the drive for each pair; explanations are called A, B ..."""
    letters = [chr(ord("A") + i) for i in range(len(found.explanations))]
    best = found.explanations[0].innovation
    rows = []
    for i, explanation in enumerate(found.explanations):
        far = ["" if i == j else f"{found.pair(i, j).apart:.0f}" for j in range(len(letters))]
        name = f"{letters[i]}: {words.listed(explanation.names)}"
        left = explanation.innovation
        rows.append((name, f"{left:.3f}", f"{left - best:+.4f}" if i else "", *far))
    return {
        "heads": ["explanation", words.UNEXPLAINED, "behind A", *(f"to {x}" for x in letters)],
        "rows": rows,
        "drives": [
            (f"{letters[pair.one]} or {letters[pair.other]}", pair.drive, f"{pair.sigma:.0f} sigma")
            for pair in found.pairs
        ],
    }


def _drives(found: Diagnosis) -> list[tuple[str, ...]]:
    """Effects that the logs could not show, with the drive that would."""
    return [
        (
            words.plain(drive.effect),
            words.usual_size(drive),
            words.would_show(drive),
            f"{drive.sigma:.0f} sigma",
        )
        for drive in found.drives
    ]


def _speed_ends(found: Diagnosis, when: tuple[str, ...]) -> list[str]:
    """Difference of replayed and measured speed at the end of each replay."""
    ends = []
    for replay in diagnosis.replays_of(found):
        (_, _, before), (_, _, after) = replay.curves({"v": 1.0})
        both = f"{before[-1]:+.2f} m/s before, {after[-1]:+.2f} m/s after"
        ends.append(f"{replay.measured.name} {both if len(when) > 1 else f'{after[-1]:+.2f} m/s'}")
    return ends


def _effect(effect: Named, found: Diagnosis) -> dict[str, object]:
    """One named effect: its card, its parameters, where it acts, its rivals."""
    return {
        "name": words.plain(effect.name).capitalize(),
        "card": definition(found.model_before.vehicle.effects, effect.name).card,
        "parameters": [
            (words.plain(name), printed.value_of(value), printed.interval_of(value))
            for name, value in effect.parameters.items()
        ],
        "where": words.where(effect),
        "evidence": words.evidence(effect, found),
        "gain_holdout": effect.gain_holdout,
        "rivals": words.rivals(effect),
    }


def _unexplained(found: UnexplainedTerm, sheet: Sheet) -> dict[str, object]:
    """The empirical term point by point, and other terms that explain a part of the gap."""
    term, unit = found.term, DRIVERS[found.term.driver]
    return {
        "text": words.unexplained(found),
        "picture": drawn(sheet, "term"),
        "place": words.plain(term.place),
        "driver": term.driver,
        "unit": printed.unit_shown(unit) or "1",
        "on": "brake torque" if term.on_brakes else "force over weight",
        "points": [
            (f"{printed.in_shown(knot, unit):.3g}", f"{100.0 * value:+.2f} %")
            for knot, value in zip(term.knots, term.values, strict=True)
        ],
        "runners_up": [
            (words.plain(place), driver, printed.percent(share))
            for place, driver, share in found.runners_up
        ],
    }


def _base(found: Diagnosis) -> list[tuple[str, ...]]:
    """The re-identified base parameters, beside those of the vehicle file."""
    car = found.model_before.vehicle
    nominal = {"pad_friction_f": car.front.pad_friction, "pad_friction_r": car.rear.pad_friction}
    return [
        (
            BASE.get(name, name),
            printed.value_of(value),
            printed.interval_of(value),
            f"{nominal[name]:g}" if name in nominal else "",
        )
        for name, value in found.base.items()
    ]
