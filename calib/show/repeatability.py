"""A gauge study, of repeated ramps: verdicts, causes of scatter, and a picture of all values.

%GRR is the share of the gauge in the scatter, ndc the number of distinct cars that it can tell.
"""

import numpy as np

from calib.base.plain import metric_of
from calib.line.gauge.gauge_rr import CAR, REPEATABILITY, REPRODUCIBILITY
from calib.line.gauge.study import REFUSED, GaugeResult, GaugeStudy, GaugeVerdict
from calib.show.facts import FAILED, PASSED, UNJUDGED, WARNING, WORDS, Facts, Picture, Table
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, FRONT, IDENTIFIED, NOMINAL, REAR, as_text, dots, names_below

_CAUSES = (REPEATABILITY, REPRODUCIBILITY, CAR)
_VERDICTS = {GaugeVerdict.GOOD: PASSED, GaugeVerdict.MARGINAL: WARNING, GaugeVerdict.BAD: FAILED}
_SD = "Standard deviations of repeats, of stations with their cars, and of the cars."
_DRAWN = "Points are single ramps, a line is the mean of a car."
_STATIONS, _MARKERS = (FRONT, REAR, IDENTIFIED, NOMINAL), "osD^vPX"
"""Looks and markers of the stations."""


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
    # A marginal metric passes. A study without a bad metric may still not pass: in some metrics the
    # cars are too alike to tell.
    outcome = UNJUDGED
    if any(result.verdict == GaugeVerdict.BAD for result in judged):
        outcome = FAILED
    elif judged and study.passed:
        outcome = PASSED
    heads = ("metric", "%GRR", "95 %", "ndc", "of tolerance [%]", "verdict")
    causes = ("metric", "repeatability", "reproducibility", "cars")
    verdicts = [_VERDICTS.get(result.verdict, "") for result in study.results]
    return Facts(
        "Gauge study",
        headline="; ".join(sentences),
        verdict=outcome,
        word=WORDS.get(outcome, "Cannot tell" if judged else "Not judged"),
        tables=[Table(heads, [*map(_shares, study.results)], verdicts=verdicts)],
        notes=study.notes,
        parts=[
            Facts("The ramps", pictures=[Picture(_DRAWN, lambda: gauge_sheet(study))]),
            Facts("Where the scatter comes from",
                  tables=[Table(causes, [*map(_deviations, study.results)], _SD)]),
        ],
    )  # fmt: skip


def _shares(result: GaugeResult) -> tuple[str, ...]:
    """Return the row of a metric: %GRR with its interval, ndc, %GRR of the tolerance, verdict."""
    gauge, shares, of_tolerance = result.gauge, ("", "", ""), ""
    if gauge and gauge.cars_differ:
        low, high = (100.0 * end for end in gauge.grr.ci95)
        shares = f"{100.0 * gauge.grr.value:.1f}", f"{low:.0f} to {high:.0f}", str(gauge.ndc.value)
    if gauge and gauge.grr_of_tolerance:
        of_tolerance = f"{100.0 * gauge.grr_of_tolerance.value:.1f}"
    return metric_of(result.name).name, *shares, of_tolerance, result.verdict


def _deviations(result: GaugeResult) -> tuple[str, ...]:
    metric = metric_of(result.name)
    components = result.gauge.components if result.gauge else {}
    deviations = {cause: f"{metric.factor * x.sd:.3g}" for cause, x in components.items()}
    return metric.heading, *(deviations.get(cause, "") for cause in _CAUSES)


def gauge_sheet(study: GaugeStudy) -> Sheet:
    """Return the sheet of a gauge study, with a panel for each metric."""
    stations = f", {len(study.stations)} stations" if study.stations else ""
    return Sheet(
        kind="repeatability",
        name="repeatability",
        panels=tuple(_panel(study, result) for result in study.results),
        title=f"Gauge study: {len(study.cars)} cars{stations}, {len(study.readings)} ramps",
        note=_DRAWN,
        result=gauge_facts(study).verdict_line,
    )


def _panel(study: GaugeStudy, result: GaugeResult) -> Panel:
    """Return the panel of a metric: a column for each car with its mean, stations side by side."""
    cars, stations, metric = study.cars, study.stations or ("",), metric_of(result.name)
    x = np.array([float(cars.index(reading.car)) for reading in study.readings])
    y, lines = metric.factor * result.values, []
    for k, station in enumerate(stations):
        at_station = np.array([reading.station == station for reading in study.readings])
        shift = 0.5 * ((k + 0.5) / len(stations) - 0.5)  # a column is 0.5 wide
        look = dots(_STATIONS[k % len(_STATIONS)], 3.2, _MARKERS[k % len(_MARKERS)])
        lines.append(Line(x[at_station] + shift, y[at_station], look, as_text(station)))
    means = [float(np.mean(y[x == i])) for i in range(len(cars))]
    lines += [Line([i - 0.35, i + 0.35], [mean, mean], BODY) for i, mean in enumerate(means)]
    return Panel(
        f"{result.name}-values",
        f"{as_text(metric.name)}: {result.verdict}",
        "car, in order of its name",
        f"value [{metric.unit or 1}]",
        lines,
        xlim=(-0.6, len(cars) - 0.4),
        xticks=names_below(cars),
        columns=4,
    )
