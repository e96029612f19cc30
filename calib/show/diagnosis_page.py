"""The report of a diagnosis: one HTML file that can be read without the program."""

from calib.car.effects.empirical import DRIVERS
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.diagnose import Diagnosis, Named
from calib.diagnosis.proof.gap import UNITS, ChannelGap, Gap
from calib.diagnosis.proof.unexplained import UnexplainedTerm
from calib.diagnosis.undecided.confusion import Confusion
from calib.diagnosis.written import printed, words
from calib.diagnosis.written.course import changes
from calib.diagnosis.written.headline import KINDS, headline, outcome
from calib.show import diagnosis_figure as diagnosis
from calib.show.html import Report, drawn
from calib.show.judged import warned
from calib.show.sheet import Sheet

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

CI = "95 % interval"
ERROR = "unexplained error (1 = noise)"


def report_html(found: Diagnosis, title: str) -> str:
    """Return the report of a diagnosis as one HTML document with the heading ``title``."""
    sheet = diagnosis.sheet(found, title)
    same, judged = found.verdict == "no_gap", outcome(found)
    when = ("before",) if same else ("before", "after")
    heads = ["replay"] if same else [*when]
    gap, holdouts = found.gap, [log.name for log in found.measured]
    page = Report(f"{title}: {diagnosis.heading(found)}", title, COLOURS[judged], KINDS[judged])
    page.text(headline(found))
    page.text(words.something_else(found))
    page.text(words.withdrawn(found))
    before = f"gap {'on the hold-outs' if same else 'before'}, times the noise"
    numbers = [(before, f"{gap.before:.1f}"), ("hold-out logs", str(len(holdouts)))]
    if not same:
        numbers.insert(1, ("gap after, times the noise", f"{gap.after:.1f}"))
        numbers.insert(2, ("of the gap closed", f"{100.0 * gap.closed:.1f} %"))
    page.add("key_numbers", numbers)
    ends = "; ".join(_speed_ends(found, when))
    speed = f"Speed of the open-loop replays less the measured one. At the end of each log: {ends}."
    page.add("figure", drawn(sheet, "speed"), speed, speed)
    page.warnings(map(warned, found.warnings))
    for effect in found.effects:
        _effect(page, effect, found)
    if found.confusion:
        _confusion(page, found.confusion)
    if found.unexplained:
        _unexplained(page, found.unexplained, sheet, bool(found.effects))
    page.section("Effects that were tried")
    page.text(
        "Every effect of the catalogue, with pads and tyres fitted again each time.",
        "" if found.effects else "None explained enough.",
    )
    _course(page, found)
    tried = [f"{label} leaves {left:.2f}" for label, left, _ in diagnosis.explanations(found)]
    page.figure(drawn(sheet, "evidence"), f"{ERROR.capitalize()}: {'; '.join(tried)}.")
    page.section("Logs with other pads or on another road")
    groups = [
        (words.listed(group.logs), words.factors_of(group) if i else "the reference")
        for i, group in enumerate(found.groups)
    ]
    state = "A state of a log, no effect of the car: pads changed, wet or not bedded; another road."
    page.table(state, ("logs", "pads and road"), groups)
    _drives(page, found)
    page.section("The gap on the hold-outs")
    largest = "The log with the largest gap; and the gap of every channel over its sensor's noise."
    page.figure(drawn(sheet, "acceleration", "split", "gap"), largest)
    by_channel = [
        (f"{name} [{UNITS[name]}]", *(f"{getattr(c, key):.4f}" for key in (*when, "noise")))
        for name, c in gap.by_channel.items()
    ]
    rms = "Gap by channel: rms of replay less measurement, noise taken out; and the noise."
    page.table(rms, ("channel", *heads, "noise"), by_channel)
    closed = ("log, channel", *heads, *(() if same else ("closed",)), "noise")
    by_log = "Gap by log and channel, in units of the sensor's noise."
    page.table(by_log, closed, _closure(gap, when), "closure", _closure_kinds(gap))
    early = words.early_ends(found)
    page.text("Replays that end before their log:" if early else "")
    page.listing(early)
    page.section("Base parameters")
    told = (words.radii, words.sides, words.known, words.start_heats, words.offsets, words.own_pads)
    page.text(
        "Pads and tyres differ from car to car and day to day: they are identified, and no effect.",
        *(one(found) for one in told),
    )
    _base(page, found)
    page.section("How it was measured")
    page.text(
        "The gap is that of the hold-outs alone, replayed from their pressures and first speed: "
        f"{', '.join(holdouts)}. An effect is named if it explains nearly all of the excess of the "
        "calibration logs over their noise, and if the hold-outs get better with it.",
        words.noise(found),
        words.own_effects(found),
    )
    page.text(
        "Beside this page: diagnosis.json (all numbers), model.toml (for brake-cal simulate "
        "--model), and the replays in sim/before and sim/after."
    )
    return page.html()


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


def _course(page: Report, found: Diagnosis) -> None:
    """What each step added, what that brought, and what it left."""
    first, *others = found.steps
    rows = [("nothing", f"{first.innovation:.3f}", "", f"{first.left:.2f}", "")]
    for change in changes(found.steps):
        what = [words.listed(change.added)] if change.added else []
        what += [f"without {words.listed(change.removed)}"] if change.removed else []
        now = change.step
        error, left = f"{now.innovation:.3f}", f"{now.left:.2f}"
        shown = ", ".join(what) or "the same, fitted anew"
        rows.append((shown, error, f"{0.0 - change.gain:+.3f}", left, f"{0.0 - change.fall:+.2f}"))
    heads = ("added", "unexplained error", "change", "left in replays", "change")
    caption = (
        f"The course of the search: {ERROR}, and lasting errors of the replays over the noise."
    )
    page.table(caption, heads, rows if others else (), "closure")


def _confusion(page: Report, found: Confusion) -> None:
    """The set as a matrix, and the drive for each pair; explanations are called A, B ..."""
    letters = [chr(ord("A") + i) for i in range(len(found.explanations))]
    best = found.explanations[0].innovation
    rows = []
    for i, explanation in enumerate(found.explanations):
        far = ["" if i == j else f"{found.pair(i, j).apart:.0f}" for j in range(len(letters))]
        name = f"{letters[i]}: {words.listed(explanation.names)}"
        left = explanation.innovation
        rows.append((name, f"{left:.3f}", f"{left - best:+.4f}" if i else "", *far))
    drives = [
        (f"{letters[pair.one]} or {letters[pair.other]}", pair.drive, f"{pair.sigma:.0f} sigma")
        for pair in found.pairs
    ]
    page.section("What these logs cannot tell apart")
    heads = ("explanation", words.UNEXPLAINED, "behind A", *(f"to {x}" for x in letters))
    page.table(f"Explanations that fit these logs alike: {ERROR}, distances [sigma].", heads, rows)
    apart = "The drive that tells each two of them apart, and their distance in it."
    page.table(apart, ("which", "drive", "apart"), drives, "steps")


def _drives(page: Report, found: Diagnosis) -> None:
    """Effects that the logs could not show, with the drive that would."""
    page.section("What these logs could not show")
    page.text(words.not_resolved(found) if found.drives else "")
    rows = [
        (words.plain(d.effect), words.usual_size(d), words.would_show(d), f"{d.sigma:.0f} sigma")
        for d in found.drives
    ]
    heads = ("effect", "usual size", "drive", "size there")
    caption = "The drive in which each of them shows most; add it to the calibration logs."
    page.table(caption, heads, rows, "steps")


def _speed_ends(found: Diagnosis, when: tuple[str, ...]) -> list[str]:
    """Difference of replayed and measured speed at the end of each replay."""
    ends = []
    for replay in diagnosis.replays_of(found):
        (_, _, before), (_, _, after) = replay.curves({"v": 1.0})
        both = f"{before[-1]:+.2f} m/s before, {after[-1]:+.2f} m/s after"
        ends.append(f"{replay.measured.name} {both if len(when) > 1 else f'{after[-1]:+.2f} m/s'}")
    return ends


def _effect(page: Report, effect: Named, found: Diagnosis) -> None:
    """One named effect: its card, its parameters, where it acts, its rivals."""
    card = definition(found.model_before.vehicle.effects, effect.name).card
    parameters = [
        (words.plain(name), printed.value_of(value), printed.interval_of(value))
        for name, value in effect.parameters.items()
    ]
    page.section(words.plain(effect.name).capitalize())
    page.terms(
        {
            "Cause": card.cause,
            "Equation": card.equation,
            "In a log": card.looks_like,
            "Source": card.source,
        }
    )
    page.table("Identified parameters.", ("parameter", "value", CI), parameters)
    page.add("heading", "Where it acts")
    page.text(words.where(effect))
    page.add("heading", "Evidence and runner-up")
    page.text(words.evidence(effect, found))
    page.text(f"On the hold-outs the {ERROR} falls by {effect.gain_holdout:.2f}.")
    page.add("heading", "Effects that cannot be distinguished from it")
    page.text(words.rivals(effect) or "Nothing else in the catalogue explains these logs as well.")


def _unexplained(page: Report, found: UnexplainedTerm, sheet: Sheet, named: bool) -> None:
    """The empirical term point by point, and other terms that explain a part of the gap."""
    term, unit = found.term, DRIVERS[found.term.driver]
    on = "brake torque" if term.on_brakes else "force over weight"
    points = [
        (f"{printed.in_shown(knot, unit):.3g}", f"{100.0 * value:+.2f} %")
        for knot, value in zip(term.knots, term.values, strict=True)
    ]
    others = [
        (words.plain(place), driver, printed.percent(share))
        for place, driver, share in found.runners_up
    ]
    page.section("What is left" if named else "Place and driver of the cause")
    page.text(words.unexplained(found))
    page.figure(drawn(sheet, "term"), f"The empirical term on the {words.plain(term.place)}.")
    heads = (f"{term.driver} [{printed.unit_shown(unit) or '1'}]", f"change of {on}")
    page.table("The empirical term; linear between its points.", heads, points)
    shares = "Other places and drivers, by the share of the gap that they explain."
    page.table(shares, ("place", "depends on", "explained"), others)


def _base(page: Report, found: Diagnosis) -> None:
    """The re-identified base parameters, beside those of the vehicle file."""
    car = found.model_before.vehicle
    nominal = {"pad_friction_f": car.front.pad_friction, "pad_friction_r": car.rear.pad_friction}
    rows = [
        (
            BASE.get(name, name),
            printed.value_of(value),
            printed.interval_of(value),
            f"{nominal[name]:g}" if name in nominal else "",
        )
        for name, value in found.base.items()
    ]
    heads = ("parameter", "value", CI, "vehicle file")
    page.table("Base parameters as re-identified.", heads, rows)
