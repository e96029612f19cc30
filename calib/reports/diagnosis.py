"""The report of a diagnosis: one HTML file that a colleague can read without the program.

Nothing in it is fetched: style and figures are inside. Light and dark follow the reader's screen;
on paper it is A4. Every string that comes from a file is escaped.
"""

from html import escape

from calib.diagnosis import words
from calib.diagnosis.diagnose import Diagnosis, Named, ParameterEstimate
from calib.diagnosis.gap import UNITS
from calib.diagnosis.unexplained import UnexplainedTerm
from calib.physics.effects.catalogue import effect_named
from calib.physics.effects.empirical import DRIVERS
from calib.plots import diagnosis
from calib.plots.sheet import Sheet
from calib.reports.html import figure, page, paragraph, section, table

VERDICTS = {
    "no_gap": "No gap",
    "named": "Named",
    "ambiguous": "Ambiguous",
    "unknown": "Unknown cause",
}

BASE = {
    "pad_friction_f": "pad friction, front",
    "pad_friction_r": "pad friction, rear",
    "tyre_stiffness": "slip stiffness of the tyres, over load",
    "tyre_peak": "peak of the tyres, over load",
}


def report_html(found: Diagnosis, title: str) -> str:
    """Return the report of a diagnosis as one HTML document; ``title`` stands at its head."""
    drawn = diagnosis.sheet(found, title)
    parts = [
        _head(found, title),
        figure(drawn, (("speed",),), _alt_speed(found), "The hold-outs, replayed open loop: speed "
                "of the replay less the measured speed, before and after what was found is added."),
        *(_effect(effect, found) for effect in found.effects),
        _unexplained(found, drawn),
        _evidence(found, drawn),
        _gap(found, drawn),
        _base(found),
        _method(found),
    ]  # fmt: skip
    return page(f"{title}: {diagnosis.heading(found)}", parts)


def _head(found: Diagnosis, title: str) -> str:
    g = found.gap
    times = "times the noise"
    if found.verdict == "no_gap":
        figures = [(f"{g.before:.1f}", f"gap on the hold-outs, {times}")]
    else:
        figures = [
            (f"{g.before:.1f}", f"gap before, {times}"),
            (f"{g.after:.1f}", f"gap after, {times}"),
            (f"{100.0 * g.closed:.1f} %", "of the gap closed"),
        ]
    figures.append((str(len(found.measured)), "hold-out logs"))
    shown = "".join(f"<div><dt>{escape(t)}</dt><dd>{escape(v)}</dd></div>" for v, t in figures)
    return (
        f'<header class="{found.verdict}">\n<p class="kind">{VERDICTS[found.verdict]}</p>\n'
        f"<h1>{escape(title)}</h1>\n"
        f'<p class="verdict">{escape(words.verdict(found))}</p>\n'
        f"{paragraph(words.gap(found))}\n<dl>{shown}</dl>\n</header>"
    )


def _effect(effect: Named, found: Diagnosis) -> str:
    """The section of one named effect: its card, its parameters, where it bites, its rivals."""
    card = effect_named(effect.name).card
    told = [
        ("Cause", card.cause),
        ("Equation", card.equation),
        ("In a log", card.looks_like),
        ("Source", card.source),
    ]
    rows = [
        (words.plain(name), words.value_of(value), words.interval_of(value))
        for name, value in effect.parameters.items()
    ]
    rivals = words.rivals(effect)
    return section(
        words.plain(effect.name).capitalize(),
        '<dl class="card">'
        + "".join(f"<dt>{name}</dt><dd>{escape(text)}</dd>" for name, text in told)
        + "</dl>",
        table("Parameters that were found.", ("parameter", "value", "95 % interval"), rows),
        "<h3>Where it bites</h3>",
        paragraph(words.where(effect)),
        "<h3>Evidence and runner-up</h3>",
        paragraph(words.evidence(effect, found)),
        paragraph(
            f"On the hold-outs, which took no part in the naming, the mean squared innovation "
            f"falls by {effect.gain_holdout:.2f}."
        ),
        "<h3>What it could be taken for</h3>",
        paragraph(rivals or "Nothing else in the catalogue explains these logs as well."),
    )


def _unexplained(found: Diagnosis, drawn: Sheet) -> str:
    if found.unexplained is None:
        return ""
    structure = found.unexplained
    driver = structure.term.driver
    return section(
        "What is known of the cause",
        paragraph(words.unexplained(structure)),
        figure(
            drawn,
            (("term",),),
            f"Line of {len(structure.term.knots)} points: the empirical term over {driver}. The "
            "points stand in the table below.",
            f"The empirical term that was added on the {words.plain(structure.term.place)}.",
        ),
        _term_table(structure),
        table(
            "Other places and drivers, by the share of the unexplained that they take.",
            ("place", "depends on", "explained"),
            [
                (words.plain(place), driver, f"{100.0 * share:.0f} %")
                for place, driver, share in structure.runners_up
            ],
        ),
    )


def _term_table(found: UnexplainedTerm) -> str:
    unit = DRIVERS[found.term.driver]
    shown = words.unit_shown(unit) or "1"
    on = "brake torque" if found.term.on_brakes else "force over weight"
    rows = [
        (f"{words.in_shown(knot, unit):.3g}", f"{100.0 * value:+.2f} %")
        for knot, value in zip(found.term.knots, found.term.values, strict=True)
    ]
    return table(
        "The empirical term; linear between its points.",
        (f"{found.term.driver} [{shown}]", f"change of {on}"),
        rows,
    )


def _evidence(found: Diagnosis, drawn: Sheet) -> str:
    tried = [f"{label} leaves {left:.2f}" for label, left, _ in diagnosis.explanations(found)]
    text = (
        "Every effect of the catalogue was tried on the calibration logs, with pads and tyres "
        "fitted again each time."
    )
    if found.verdict == "no_gap":
        text += " None earned its place."
    return section(
        "What was tried",
        paragraph(text),
        paragraph(words.not_resolved(found)),
        figure(
            drawn,
            (("evidence",),),
            f"Mean squared innovation by explanation: {'; '.join(tried)}. Noise alone is 1.",
            "Mean squared innovation that each explanation leaves on the calibration logs; 1 is "
            "noise alone.",
        ),
    )


def _gap(found: Diagnosis, drawn: Sheet) -> str:
    g, same = found.gap, found.verdict == "no_gap"
    after = () if same else ("after",)
    channels = [
        (
            f"{name} [{UNITS[name]}]",
            *(f"{getattr(c, when):.4f}" for when in ("before", *after)),
            f"{c.noise:.4f}",
        )
        for name, c in g.by_channel.items()
    ]
    logs = [
        (name, *(f"{value:.2f}" for value in (pair[:1] if same else pair)))
        for name, pair in g.by_log.items()
    ]
    first = "replay" if same else "before"
    early = "".join(f"<li>{escape(line)}</li>" for line in words.early_ends(found))
    return section(
        "The gap on the hold-outs",
        figure(
            drawn,
            (("acceleration", "split"), ("gap", "gap")),
            "Three plots: acceleration and difference of wheel speeds, replay less measured, in "
            "the log with the largest gap; and bars of the gap by channel, whose values stand in "
            "the table below.",
            "The log with the largest gap, and the gap of every channel over the noise of its "
            "sensor.",
        ),
        table(
            "Gap by channel: rms of replay less measurement, noise taken out; and the noise.",
            ("channel", first, *after, "noise"),
            channels,
        ),
        table(
            "Gap by log, all channels together, in units of the sensors' noise.",
            ("log", first, *after),
            logs,
        ),
        f"<p>Replays that end before their log:</p><ul>{early}</ul>" if early else "",
    )


def _base(found: Diagnosis) -> str:
    car = found.model_before.vehicle
    nominal = {
        "pad_friction_f": f"{car.front.pad_friction:g}",
        "pad_friction_r": f"{car.rear.pad_friction:g}",
    }
    rows = [
        (BASE.get(name, name), *_plain_value(value), nominal.get(name, ""))
        for name, value in found.base.items()
    ]
    return section(
        "Base parameters",
        paragraph(
            "Pads and tyres differ from car to car and from day to day. They were identified anew "
            "beside whatever was found, and are no finding of their own."
        ),
        table(
            "Base parameters as re-identified.",
            ("parameter", "value", "95 % interval", "vehicle file"),
            rows,
        ),
    )


def _plain_value(found: ParameterEstimate) -> tuple[str, str]:
    return words.value_of(found), words.interval_of(found)


def _method(found: Diagnosis) -> str:
    names = ", ".join(log.name for log in found.measured)
    return section(
        "How it was measured",
        paragraph(
            "The calibration logs were compared with what the vehicle model says its sensors "
            "should read, in six channels: acceleration, drift of the speed, mean slip, front less "
            "rear, and left less right on both axles. The noise of each channel was read from the "
            "unbraked parts and taken out, so that what is left is white with variance 1 if the "
            "model is right. Every effect of the catalogue was then fitted together with pads and "
            "tyres; one had to explain nearly all of what was left and to help on the hold-outs. "
            f"The gap stands on the hold-outs alone ({names}): they were replayed from their "
            "pressures and first speed, and the replay compared with the measurement, sample by "
            "sample, over the sensors' noise. Intervals are 95 %, widened for what the model "
            "itself leaves out."
        ),
        paragraph(
            "Beside this report lie diagnosis.json (all numbers), model.toml (the model with what "
            "was found, for brake-cal simulate --model), and the replays in sim/before and "
            "sim/after."
        ),
    )


def _alt_speed(found: Diagnosis) -> str:
    parts = []
    for replay in diagnosis.replays_of(found):
        (_, _, before), (_, _, after) = replay.curves({"v": 1.0})
        ends = f"{before[-1]:+.2f} m/s before, {after[-1]:+.2f} m/s after"
        if found.verdict == "no_gap":
            ends = f"{after[-1]:+.2f} m/s"
        parts.append(f"{replay.measured.name} {ends}")
    return f"Error of the replayed speed over time. At the end of each log: {'; '.join(parts)}."
