"""A gauge study: every metric by car and station, and the causes of its scatter.

values   |  .  o       one column a car, one mark a station, a line at the car's mean
bars     |  [==]--|    standard deviation of each cause over the total, 95 % interval
"""

import numpy as np

from calib.line.gauge.gauge_rr import CAR, GAUGE, INTERACTION, REPEATABILITY, STATION, TOTAL
from calib.line.gauge.study import GOOD_GRR, GaugeResult, GaugeStudy, GaugeVerdict
from calib.show.sheet import Panel, Sheet
from calib.show.style import BODY, FRONT, IDENTIFIED, LAW, NOMINAL, REAR, Axes

SUMMARY, SMALLER = "summary", "%GRR of each metric: the smaller, the better the gauge"
LABELS = {
    REPEATABILITY: "repeatability",
    STATION: "station",
    INTERACTION: "car by station",
    GAUGE: "gauge",
    CAR: "cars",
}
MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
COLOURS = tuple(s["color"] for s in (FRONT, REAR, IDENTIFIED, LAW, BODY, NOMINAL))
NAMED = 12
"""Above this number the cars are numbered, not named."""


TITLES = {
    "pad_scale": "pad level",
    "pad_friction_f": "front pads",
    "pad_friction_r": "rear pads",
    "eta_zero": r"zero of $\eta$",
    "slip_stiffness": "slip stiffness",
    "difference": "$D$",
    "f1": "$f_1$",
    "f2": "$f_2$",
}
"""The metrics in words; another one has its own name."""
HEAT = {
    GaugeVerdict.GOOD: "#BFE3D6",
    GaugeVerdict.MARGINAL: "#F3E3A9",
    GaugeVerdict.BAD: "#F0B08C",
    GaugeVerdict.ALIKE: "#D9D9D9",
    GaugeVerdict.NOT_JUDGED: "#FFFFFF",
}
"""Colours of the verdicts; each cell says its verdict in words too."""


def sheet(found: GaugeStudy) -> Sheet:
    """Return the sheet of a gauge study: two panels for every metric."""
    pairs = [_panels(found, result) for result in found.results]
    stations = f", {len(found.stations)} stations" if found.stations else ""
    sentences = (
        "Points are single ramps, a bar is the mean of a car",
        "Components are standard deviations over the total one, with 95 % intervals; shaded: "
        "gauge up to 10 and 30 %",
        "%GRR: the gauge's standard deviation over the total one, or six of it over the tolerance",
        f"D, f1, f2 where eta - 1 is {100.0 * found.reference:g} %",
        *found.notes,
    )
    return Sheet(
        kind="repeatability",
        name="repeatability",
        title=f"Gauge study: {len(found.cars)} cars{stations}, {len(found.readings)} ramps",
        note=". ".join(s[0].upper() + s[1:] for s in sentences) + ".",
        panels=(
            Panel(SUMMARY, SMALLER, heat, (found,)),
            *(panel for pair in pairs for panel in pair),
        ),
        rows=((SUMMARY,) * 3, *((values.name, values.name, parts.name) for values, parts in pairs)),
        heights=(0.62, *(0.8 for _ in pairs)),
        result=_result(found),
    )


def _result(found: GaugeStudy) -> str:
    """Passed, or the metrics for which it failed."""
    if found.passed:
        return "Passed"
    bad = (GaugeVerdict.BAD, GaugeVerdict.ALIKE)
    return f"Failed: {', '.join(title_of(r) for r in found.results if r.verdict in bad)}"


def _panels(found: GaugeStudy, result: GaugeResult) -> tuple[Panel, Panel]:
    name, heading = result.name, title_of(result)
    heading = heading if heading.startswith("$") else heading[0].upper() + heading[1:]
    return (
        Panel(f"{name}-values", f"{heading}: {_verdict(result)}", by_car, (found, result), 4),
        Panel(f"{name}-parts", "Causes", components, (result,)),
    )


def _verdict(result: GaugeResult) -> str:
    """The verdict with the numbers that it rests on."""
    found = result.gauge
    if found is None:
        return result.verdict
    words = [str(result.verdict)]
    if found.cars_differ:
        words.append(f"%GRR {100.0 * found.grr:.0f}, ndc {found.categories}")
    if found.tolerance is not None:
        words.append(f"%GRR of tolerance {100.0 * found.tolerance:.0f}")
    return ", ".join(words)


def by_car(ax: Axes, found: GaugeStudy, result: GaugeResult) -> None:
    """Draw the values: one column for each car, with its stations side by side."""
    cars, stations = found.cars, found.stations or ("",)
    x = np.array([float(cars.index(r.car)) for r in found.readings])
    for k, station in enumerate(stations):
        here = np.array([r.station == station for r in found.readings])
        aside = 0.5 * ((k + 0.5) / len(stations) - 0.5)
        look = {"color": COLOURS[k % len(COLOURS)], "ms": 3.2, "alpha": 0.8}
        label, mark = _plain(station) or None, MARKS[k % len(MARKS)]
        ax.plot(x[here] + aside, result.values[here], mark, label=label, **look)
    for i in range(len(cars)):
        mean = float(np.mean(result.values[x == i]))
        ax.plot([i - 0.35, i + 0.35], [mean, mean], color=BODY["color"], linewidth=1.4)
    ax.axhline(float(np.mean(result.values)), color=NOMINAL["color"], linewidth=0.7)
    names = len(cars) <= NAMED
    if names:
        turn = 0.0 if max(map(len, cars)) * len(cars) < 60 else 35.0
        shown = [_plain(car) for car in cars]
        ax.set_xticks(range(len(cars)), shown, rotation=turn, ha="right" if turn else "center")
    ax.set(ylabel=f"{title_of(result)} [1]", xlabel="" if names else "car, in order of its name")
    ax.set_xlim(-0.6, len(cars) - 0.4)
    ax.ticklabel_format(axis="y", style="plain", useOffset=False)  # a factor would cover the legend


def _plain(name: str) -> str:
    """A name as plain text: no formula, and no leading underscore, which the legend would hide."""
    shown = name.replace("$", r"\$")
    return f" {shown}" if shown.startswith("_") else shown


def components(ax: Axes, result: GaugeResult) -> None:
    """Draw every cause's standard deviation over the total with its 95 % interval [%]."""
    if result.gauge is None:
        ax.text(0.5, 0.5, "repeats do not scatter", transform=ax.transAxes, ha="center")
        ax.set_axis_off()
        return
    parts = result.gauge.components
    total = parts[TOTAL].sd
    names = [name for name in LABELS if name in parts]
    for low, high, colour in ((0.0, GOOD_GRR, "#DDEFE6"), (GOOD_GRR, 0.3, "#F6EBD0")):
        ax.axvspan(100.0 * low, 100.0 * high, color=colour, linewidth=0.0, zorder=0)
    top = 110.0
    for i, name in enumerate(names):
        sd, low, high = (100.0 * v / total for v in (parts[name].sd, *parts[name].sd95))
        strong = name in (GAUGE, CAR)
        ax.barh(i, sd, height=0.55, color=COLOURS[0] if strong else "#8DB9DA", zorder=2)
        ax.plot([low, high], [i, i], color=BODY["color"], linewidth=1.0, zorder=3)
        ax.plot(low, i, "|", color=BODY["color"], ms=5.0, zorder=3)
        # an arrow where the interval reaches beyond the axis
        mark = "|" if high <= top else ">"
        ax.plot(min(high, top), i, mark, color=BODY["color"], ms=5.0, zorder=3, clip_on=False)
        if name in result.gauge.negative:
            ax.text(2.0, i - 0.1, "came out negative", va="bottom", fontsize=6.5, zorder=4)
    ax.set_yticks(range(len(names)), [LABELS[name] for name in names])
    ax.invert_yaxis()
    ax.grid(axis="y", visible=False)
    ax.set(xlabel="of the total standard deviation [%]", xlim=(0.0, top))


def title_of(result: GaugeResult) -> str:
    """The metric in words."""
    return TITLES.get(result.name, result.name.replace("_", " "))


def heat(ax: Axes, found: GaugeStudy) -> None:
    """One cell for each metric with %GRR and ndc; below it %GRR of its tolerance, where known."""
    from matplotlib.patches import Rectangle

    rows = {"of the cars": _of_cars}
    if any(_tolerance(result) is not None for result in found.results):
        rows["of the tolerance"] = _of_tolerance
    for j, cell in enumerate(rows.values()):
        for i, result in enumerate(found.results):
            text, verdict = cell(result)
            place = (i - 0.48, j - 0.46)
            ax.add_patch(Rectangle(place, 0.96, 0.92, color=HEAT[verdict], linewidth=0.0))
            ax.text(i, j, text, ha="center", va="center", fontsize=7.0)
    ax.set_xlim(-0.5, len(found.results) - 0.5)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    words = {GaugeVerdict.ALIKE: "no verdict"}
    names = [f"{title_of(r)}\n{words.get(r.verdict, r.verdict)}" for r in found.results]
    ax.set_xticks(range(len(found.results)), names)
    ax.set_yticks(range(len(rows)), list(rows))
    ax.tick_params(length=0)
    ax.grid(visible=False)
    ax.spines[:].set_visible(False)


def _tolerance(result: GaugeResult) -> float | None:
    return None if result.gauge is None else result.gauge.tolerance


def _of_cars(result: GaugeResult) -> tuple[str, GaugeVerdict]:
    gauge = result.gauge
    if gauge is None:
        return "repeats do\nnot scatter", GaugeVerdict.NOT_JUDGED
    if not gauge.cars_differ:
        return "the cars\ndo not differ", GaugeVerdict.ALIKE
    text = f"{100.0 * gauge.grr:.0f} %\nndc {gauge.categories}"
    return text, _colour(result, gauge.grr, ("grr", "ndc"))


def _of_tolerance(result: GaugeResult) -> tuple[str, GaugeVerdict]:
    share = _tolerance(result)
    if share is None:
        return "not known", GaugeVerdict.NOT_JUDGED
    return f"{100.0 * share:.0f} %", _colour(result, share, ("grr_of_tolerance",))


def _colour(result: GaugeResult, share: float, figures: tuple[str, ...]) -> GaugeVerdict:
    """The verdict of one cell: by its own limits."""
    if any(j.passed is False for j in result.judgements if j.figure in figures):
        return GaugeVerdict.BAD
    return GaugeVerdict.GOOD if share <= GOOD_GRR else GaugeVerdict.MARGINAL
