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
"""Broken metrics in the head of the answer; all are in the details."""
_HEADS = (
    *("metric", "repeatability", "reproducibility", "cars"),
    *("%GRR", "95 %", "ndc", "of tolerance", "verdict"),
)
_CAPTION = "Repeatability, reproducibility and cars: standard deviations [1]."
_COLOURS, _MARKS = [*WHEEL_STROKES.values()], "osD^vPX"
_NAMED = 12
"""More cars than these have numbers instead of names."""


def gauge_facts(study: GaugeStudy) -> Facts:
    """Verdict of a gauge study, and each metric with its causes of scatter."""
    judged = [one for one in study.results if one.verdict != GaugeVerdict.NOT_JUDGED]
    within = sum(one.verdict not in REFUSED for one in judged)
    sentences = [f"{within} of {len(judged)} metrics within the limits"]
    for verdict in REFUSED:
        bad = [one.name for one in judged if one.verdict == verdict]
        sentences += [f"{verdict}: {', '.join(bad)}"] if bad else []
    if not judged:
        sentences = ["none of the metrics could be judged: their repeats do not scatter"]
    rows = [(one.name, *_cells(one), one.verdict) for one in study.results]
    worst = [(row[0], row[4], row[6], row[8]) for row in rows if row[8] in REFUSED]
    negative = [
        f"{one.name}: variances that came out negative count as zero: {', '.join(names)}"
        for one in study.results
        if one.gauge and (names := one.gauge.negative)
    ]
    # cars that are alike show nothing of a gauge, good or bad
    failed = any(one.verdict == GaugeVerdict.BAD for one in judged)
    outcome = FAILED if failed else PASSED if judged and study.passed else UNJUDGED
    word = WORDS.get(outcome, "Cannot tell" if judged else "Not judged")
    table, notes = Table(_HEADS, rows, _CAPTION), [*negative, *study.notes]
    return Facts(
        "Gauge study",
        headline="; ".join(sentences),
        verdict=outcome,
        word=word,
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


def gauge_sheet(study: GaugeStudy) -> Sheet:
    """The sheet of a gauge study: the first metric, and those that are not good enough."""
    first, *others = study.results
    drawn = [first, *(one for one in others if one.verdict == GaugeVerdict.BAD)]
    summary = gauge_facts(study)
    stations = f", {len(study.stations)} stations" if study.stations else ""
    notes = ["Points are single ramps, a line is the mean of a car", *study.notes]
    return Sheet(
        kind="repeatability",
        name="repeatability",
        panels=tuple(_panel(study, one) for one in drawn),
        title=f"Gauge study: {len(study.cars)} cars{stations}, {len(study.readings)} ramps",
        note=". ".join(notes) + ".",
        result=f"{summary.word}: {summary.headline}",
    )


def _panel(study: GaugeStudy, result: GaugeResult) -> Panel:
    """Values of a metric: one column a car, its stations side by side."""
    cars, stations, metric = study.cars, study.stations or ("",), plain(result.name)
    x = np.array([float(cars.index(r.car)) for r in study.readings])
    y = metric.factor * result.values
    lines = []
    for k, station in enumerate(stations):
        of_station = np.array([r.station == station for r in study.readings])
        aside = 0.5 * ((k + 0.5) / len(stations) - 0.5)
        look = dots(_COLOURS[k % len(_COLOURS)], 3.2, _MARKS[k % len(_MARKS)], alpha=0.8)
        lines.append(Line(x[of_station] + aside, y[of_station], look, as_text(station)))
    lines += [
        Line([i - 0.35, i + 0.35], [float(np.mean(y[x == i]))] * 2, BODY) for i in range(len(cars))
    ]
    return Panel(
        f"{result.name}-values",
        f"{as_text(metric.name.replace('_', ' '))}: {result.verdict}",
        "car, in order of its name",
        f"value [{metric.unit or 1}]",
        lines,
        xlim=(-0.6, len(cars) - 0.4),
        xticks=[as_text(car) for car in cars] if len(cars) <= _NAMED else (),
        columns=4,
    )
