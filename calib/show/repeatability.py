"""A gauge study: the causes of scatter as a table, and the values of its ramps as a picture.

value |  .  o             one column a car, one mark a station, a line at the car's mean
"""

import numpy as np

from calib.base.plain import plain
from calib.line.gauge.gauge_rr import CAR, REPEATABILITY, REPRODUCIBILITY
from calib.line.gauge.study import REFUSED, GaugeResult, GaugeStudy, GaugeVerdict
from calib.show.facts import FAILED, PASSED, UNJUDGED, WORDS, Facts, Table
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, WHEEL_STROKES, as_text, dots

_SHOWN = 5
"""Metrics in the head of the answer that break their limit; all are in the details."""
_HEADS = (
    *("metric", "repeatability", "reproducibility", "cars"),
    *("%GRR", "95 %", "ndc", "of tolerance", "verdict"),
)
_CAPTION = "Repeatability, reproducibility and cars: standard deviations [1]."
_COLOURS, _MARKS = [*WHEEL_STROKES.values()], "osD^vPX"
_NAMED = 12
"""Above this number the cars are numbered, not named."""


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
    rows = [(one.name, *_cells(one), one.verdict) for one in found.results]
    worst = [(row[0], row[4], row[6], row[8]) for row in rows if row[8] in REFUSED]
    negative = [
        f"{one.name}: variances that came out negative count as zero: {', '.join(names)}"
        for one in found.results
        if one.gauge and (names := one.gauge.negative)
    ]
    word = (PASSED if found.passed else FAILED) if judged else UNJUDGED
    table, notes = Table(_HEADS, rows, _CAPTION), [*negative, *found.notes]
    return Facts(
        "Gauge study",
        headline="; ".join(told),
        verdict=word,
        word=WORDS.get(word, "Not judged"),
        tables=[Table(("metric", "%GRR", "ndc", "verdict"), worst[:_SHOWN])],
        parts=[Facts("All metrics", tables=[table], notes=notes)],
    )


def _cells(result: GaugeResult) -> tuple[str, ...]:
    g = result.gauge
    if g is None:
        return ("-",) * 7
    names = (REPEATABILITY, REPRODUCIBILITY, CAR)
    sds = [f"{g.components[name].sd:.3g}" if name in g.components else "-" for name in names]
    of_tolerance = "-" if g.grr_of_tolerance is None else f"{100.0 * g.grr_of_tolerance.value:.1f}"
    if not g.cars_differ:
        return *sds, "-", "-", "-", of_tolerance
    low, high = (100.0 * end for end in g.grr.ci95)
    share = (f"{100.0 * g.grr.value:.1f}", f"{low:.0f} to {high:.0f}", str(g.ndc.value))
    return *sds, *share, of_tolerance


def sheet(found: GaugeStudy) -> Sheet:
    """The sheet of a gauge study: the first metric, and those that are not good enough."""
    first, *others = found.results
    drawn = [first, *(one for one in others if one.verdict == GaugeVerdict.BAD)]
    summary = facts(found)
    stations = f", {len(found.stations)} stations" if found.stations else ""
    at = f"D, f1, f2 where eta - 1 is {100.0 * found.reference:g} %"
    notes = ["Points are single ramps, a line is the mean of a car", at, *found.notes]
    return Sheet(
        kind="repeatability",
        name="repeatability",
        panels=tuple(_panel(found, one) for one in drawn),
        title=f"Gauge study: {len(found.cars)} cars{stations}, {len(found.readings)} ramps",
        note=". ".join(notes) + ".",
        result=f"{summary.word}: {summary.headline}",
    )


def _panel(found: GaugeStudy, result: GaugeResult) -> Panel:
    """The values: one column for each car, with its stations side by side."""
    cars, stations, one = found.cars, found.stations or ("",), plain(result.name)
    x, y = np.array([float(cars.index(r.car)) for r in found.readings]), one.factor * result.values
    lines = []
    for k, station in enumerate(stations):
        here = np.array([r.station == station for r in found.readings])
        aside = 0.5 * ((k + 0.5) / len(stations) - 0.5)
        look = dots(_COLOURS[k % len(_COLOURS)], 3.2, _MARKS[k % len(_MARKS)], alpha=0.8)
        lines.append(Line(x[here] + aside, y[here], look, as_text(station)))
    lines += [
        Line([i - 0.35, i + 0.35], [float(np.mean(y[x == i]))] * 2, BODY) for i in range(len(cars))
    ]
    return Panel(
        f"{result.name}-values",
        f"{as_text(one.name.replace('_', ' '))}: {result.verdict}",
        "car, in order of its name",
        f"value [{one.unit or 1}]",
        lines,
        xlim=(-0.6, len(cars) - 0.4),
        xticks=[as_text(car) for car in cars] if len(cars) <= _NAMED else (),
        columns=4,
    )
