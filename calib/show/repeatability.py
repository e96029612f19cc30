"""A gauge study: the causes of scatter as a table, and every metric by car and station.

|  .  o       one column a car, one mark a station, a line at the car's mean
"""

import numpy as np

from calib.line.gauge.gauge_rr import CAR, REPEATABILITY, REPRODUCIBILITY
from calib.line.gauge.study import REFUSED, GaugeResult, GaugeStudy, GaugeVerdict
from calib.show.facts import FAILED, PASSED, UNJUDGED, WORDS, Facts, Table
from calib.show.sheet import Panel, Sheet
from calib.show.style import BODY, FRONT, IDENTIFIED, LAW, NOMINAL, REAR, Axes

_MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
_COLOURS = tuple(s["color"] for s in (FRONT, REAR, IDENTIFIED, LAW, BODY, NOMINAL))
_NAMED = 12
"""Above this number the cars are numbered, not named."""


_TITLES = {
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


def facts(found: GaugeStudy) -> Facts:
    """A gauge study: the verdict, and each metric with its causes of scatter."""
    judged = [one for one in found.results if one.verdict != GaugeVerdict.NOT_JUDGED]
    held = sum(one.verdict not in REFUSED for one in judged)
    told = [f"{held} of {len(judged)} metrics within the limits"]
    for verdict in REFUSED:
        bad = [one.name for one in judged if one.verdict == verdict]
        told += [f"{verdict}: {', '.join(bad)}"] if bad else []
    if not judged:
        told = ["none of the metrics could be judged: their repeats do not scatter"]
    heads = ("repeatability", "reproducibility", "cars", "%GRR", "95 %", "ndc", "of tolerance")
    rows = [(one.name, *_cells(one), one.verdict) for one in found.results]
    caption = "Repeatability, reproducibility and cars: standard deviations [1]."
    negative = [
        f"{one.name}: variances that came out negative count as zero: {', '.join(names)}"
        for one in found.results
        if one.gauge and (names := one.gauge.negative)
    ]
    word = (PASSED if found.passed else FAILED) if judged else UNJUDGED
    return Facts(
        "Gauge study",
        headline="; ".join(told),
        verdict=word,
        word=WORDS.get(word, "Not judged"),
        tables=[Table(("metric", *heads, "verdict"), rows, caption)],
        notes=[*negative, *found.notes],
    )


def _cells(result: GaugeResult) -> tuple[str, ...]:
    g = result.gauge
    if g is None:
        return ("-",) * 7
    names = (REPEATABILITY, REPRODUCIBILITY, CAR)
    sds = [f"{g.components[name].sd:.3g}" if name in g.components else "-" for name in names]
    of_tolerance = "-" if g.tolerance is None else f"{100.0 * g.tolerance:.1f}"
    if not g.cars_differ:
        return *sds, "-", "-", "-", of_tolerance
    low, high = (100.0 * end for end in g.grr95)
    share = (f"{100.0 * g.grr:.1f}", f"{low:.0f} to {high:.0f}", str(g.categories))
    return *sds, *share, of_tolerance


def sheet(found: GaugeStudy) -> Sheet:
    """Return the sheet of a gauge study: a panel for every metric."""
    panels = tuple(_panel(found, result) for result in found.results)
    stations = f", {len(found.stations)} stations" if found.stations else ""
    sentences = (
        "Points are single ramps, a bar is the mean of a car",
        "%GRR: the gauge's standard deviation over the total one, or six of it over the tolerance",
        f"D, f1, f2 where eta - 1 is {100.0 * found.reference:g} %",
        *found.notes,
    )
    return Sheet(
        kind="repeatability",
        name="repeatability",
        title=f"Gauge study: {len(found.cars)} cars{stations}, {len(found.readings)} ramps",
        note=". ".join(s[0].upper() + s[1:] for s in sentences) + ".",
        panels=panels,
        rows=tuple((panel.name,) for panel in panels),
        heights=(0.8,) * len(panels),
        result=_result(found),
    )


def _result(found: GaugeStudy) -> str:
    """Passed, or the metrics for which it failed."""
    if found.passed:
        return "Passed"
    return f"Failed: {', '.join(_title_of(r) for r in found.results if r.verdict in REFUSED)}"


def _panel(found: GaugeStudy, result: GaugeResult) -> Panel:
    heading = _title_of(result)
    heading = heading if heading.startswith("$") else heading[0].upper() + heading[1:]
    title = f"{heading}: {_verdict(result)}"
    return Panel(f"{result.name}-values", title, by_car, (found, result), 4)


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
        look = {"color": _COLOURS[k % len(_COLOURS)], "ms": 3.2, "alpha": 0.8}
        label, mark = _plain(station) or None, _MARKS[k % len(_MARKS)]
        ax.plot(x[here] + aside, result.values[here], mark, label=label, **look)
    for i in range(len(cars)):
        mean = float(np.mean(result.values[x == i]))
        ax.plot([i - 0.35, i + 0.35], [mean, mean], color=BODY["color"], linewidth=1.4)
    ax.axhline(float(np.mean(result.values)), color=NOMINAL["color"], linewidth=0.7)
    names = len(cars) <= _NAMED
    if names:
        turn = 0.0 if max(map(len, cars)) * len(cars) < 60 else 35.0
        shown = [_plain(car) for car in cars]
        ax.set_xticks(range(len(cars)), shown, rotation=turn, ha="right" if turn else "center")
    ax.set(ylabel=f"{_title_of(result)} [1]", xlabel="" if names else "car, in order of its name")
    ax.set_xlim(-0.6, len(cars) - 0.4)
    ax.ticklabel_format(axis="y", style="plain", useOffset=False)  # a factor would cover the legend


def _plain(name: str) -> str:
    """A name as plain text: no formula, and no leading underscore, which the legend would hide."""
    shown = name.replace("$", r"\$")
    return f" {shown}" if shown.startswith("_") else shown


def _title_of(result: GaugeResult) -> str:
    """The metric in words."""
    return _TITLES.get(result.name, result.name.replace("_", " "))
