"""A gauge study: its verdicts, the causes of scatter, and the values of the ramps as a picture.

A panel has a column for each car, a marker for each station, and a line at the mean of the car.
"""

from functools import partial

import numpy as np

from calib.base.plain import metric_of
from calib.line.gauge.gauge_rr import CAR, REPEATABILITY, REPRODUCIBILITY
from calib.line.gauge.study import REFUSED, GaugeResult, GaugeStudy, GaugeVerdict
from calib.show.facts import FAILED, PASSED, UNJUDGED, WARNING, WORDS, Facts, Picture, Table
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, FRONT, IDENTIFIED, NOMINAL, REAR, as_text, dots, names_below

_CAUSES = (REPEATABILITY, REPRODUCIBILITY, CAR)
_COLOURS = {GaugeVerdict.GOOD: PASSED, GaugeVerdict.MARGINAL: WARNING, GaugeVerdict.BAD: FAILED}
_SD = "Standard deviations of repeats, of stations with their cars, and of the cars."
_DRAWN = "Points are single ramps, a line is the mean of a car."
_STATIONS, _MARKS = (FRONT, REAR, IDENTIFIED, NOMINAL), "osD^vPX"


def gauge_facts(study: GaugeStudy) -> Facts:
    """Return the verdict of a gauge study, and each metric with its causes of scatter."""
    judged = [result for result in study.results if result.verdict != GaugeVerdict.NOT_JUDGED]
    within = sum(result.verdict not in REFUSED for result in judged)
    sentences = [f"{within} of {len(judged)} metrics within the limits"]
    for verdict in REFUSED:
        names = [metric_of(result.name).name for result in judged if result.verdict == verdict]
        sentences += [f"{verdict}: {', '.join(names)}"] if names else []
    if not judged:
        sentences = ["none of the metrics could be judged: their repeats do not scatter"]
    # cars that are alike show nothing of a gauge, good or bad
    failed = any(result.verdict == GaugeVerdict.BAD for result in judged)
    outcome = FAILED if failed else PASSED if judged and study.passed else UNJUDGED
    heads = ("metric", "%GRR", "95 %", "ndc", "of tolerance [%]", "verdict")
    causes = ("metric", "repeatability", "reproducibility", "cars")
    verdicts = [_COLOURS.get(result.verdict, "") for result in study.results]
    return Facts(
        "Gauge study",
        headline="; ".join(sentences),
        verdict=outcome,
        word=WORDS.get(outcome, "Cannot tell" if judged else "Not judged"),
        tables=[Table(heads, [*map(_shares, study.results)], verdicts=verdicts)],
        notes=study.notes,
        parts=[
            Facts("The ramps", pictures=[Picture(_DRAWN, partial(gauge_sheet, study))]),
            Facts("Where the scatter comes from",
                  tables=[Table(causes, [*map(_deviations, study.results)], _SD)]),
        ],
    )  # fmt: skip


def _shares(result: GaugeResult) -> tuple[str, ...]:
    """Return the row of a metric: %GRR with its interval, ndc, %GRR of the tolerance, verdict."""
    g, shares, of_tolerance = result.gauge, ("", "", ""), ""
    if g and g.cars_differ:
        low, high = (100.0 * end for end in g.grr.ci95)
        shares = f"{100.0 * g.grr.value:.1f}", f"{low:.0f} to {high:.0f}", str(g.ndc.value)
    if g and g.grr_of_tolerance:
        of_tolerance = f"{100.0 * g.grr_of_tolerance.value:.1f}"
    return metric_of(result.name).name, *shares, of_tolerance, result.verdict


def _deviations(result: GaugeResult) -> tuple[str, ...]:
    components, shown = result.gauge.components if result.gauge else {}, metric_of(result.name)
    deviations = {name: f"{shown.factor * x.sd:.3g}" for name, x in components.items()}
    return shown.heading, *(deviations.get(name, "") for name in _CAUSES)


def gauge_sheet(study: GaugeStudy) -> Sheet:
    """Return the sheet of a gauge study, with a panel for each metric."""
    facts = gauge_facts(study)
    stations = f", {len(study.stations)} stations" if study.stations else ""
    return Sheet(
        kind="repeatability",
        name="repeatability",
        panels=tuple(_panel(study, result) for result in study.results),
        title=f"Gauge study: {len(study.cars)} cars{stations}, {len(study.readings)} ramps",
        note=_DRAWN,
        result=facts.verdict_line,
    )


def _panel(study: GaugeStudy, result: GaugeResult) -> Panel:
    """Return the panel of a metric: a column for each car, its stations side by side."""
    cars, stations, shown = study.cars, study.stations or ("",), metric_of(result.name)
    x = np.array([float(cars.index(reading.car)) for reading in study.readings])
    y, lines = shown.factor * result.values, []
    for k, station in enumerate(stations):
        of_station = np.array([reading.station == station for reading in study.readings])
        aside = 0.5 * ((k + 0.5) / len(stations) - 0.5)
        look = dots(_STATIONS[k % len(_STATIONS)], 3.2, _MARKS[k % len(_MARKS)])
        lines.append(Line(x[of_station] + aside, y[of_station], look, as_text(station)))
    means = [float(np.mean(y[x == i])) for i in range(len(cars))]
    lines += [Line([i - 0.35, i + 0.35], [mean, mean], BODY) for i, mean in enumerate(means)]
    return Panel(
        f"{result.name}-values",
        f"{as_text(shown.name)}: {result.verdict}",
        "car, in order of its name",
        f"value [{shown.unit or 1}]",
        lines,
        xlim=(-0.6, len(cars) - 0.4),
        xticks=names_below(cars),
        columns=4,
    )
