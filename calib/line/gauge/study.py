"""Gauge study of the calibration: repeated ramps of several cars, judged metric by metric.

ramps --fit, one table for each ramp--> metrics --anova--> components --limits--> verdict

The scatter of the gauge is compared with the differences of the cars (%GRR, ndc), and with the
tolerance of a metric if it is known; see `calib.line.gauge.gauge_rr`. One file holds both limits
and tolerances:

    schema = 1

    [limits]
    grr = { max = 0.3 }                           # %GRR of every metric, as a share
    pad_scale = { min = 0.8, max = 1.2 }          # the tolerance of a metric
    grr_of_tolerance = { max = 0.2 }              # %GRR of every tolerance
"""

from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import InputError, LimitsError
from calib.estimation.limits import FAILED, Judgement, Limit, judge
from calib.line.gauge import gauge_rr as rr
from calib.logs.log import Log
from calib.run.axle_signals import signals
from calib.table.table import Table

_GOOD_GRR = 0.10  # %GRR up to which AIAG calls a gauge good; from here to the limit it is marginal

METRICS = ("pad_scale", "pad_friction_f", "pad_friction_r", "eta_zero", "slip_stiffness")
"""Metrics of every ramp [1], see `metrics_of`."""

_FIGURES = ("grr", "ndc", "grr_of_tolerance")  # figures of each metric that are judged
KNOWN_LIMITS = (*_FIGURES, *METRICS)  # in a file; the limit of a metric is its tolerance

# AIAG, Measurement Systems Analysis, 4th ed.
_DEFAULTS = Limit("grr", None, 0.3), Limit("ndc", 5.0, None), Limit("grr_of_tolerance", None, 0.3)


class GaugeVerdict(StrEnum):
    """Verdict on the gauge of a metric, by AIAG."""

    GOOD = "good"
    MARGINAL = "marginal"
    BAD = "bad"
    ALIKE = "the cars do not differ"  # and no tolerance is known
    NOT_JUDGED = "not judged"  # repeats do not scatter


REFUSED = (GaugeVerdict.BAD, GaugeVerdict.ALIKE)  # verdicts with which a metric does not pass


@dataclass(frozen=True)
class GaugeReading:
    """The metrics of one ramp."""

    log: str
    car: str
    station: str
    figures: dict[str, float]  # by the names of `METRICS`
    digest: str = ""  # of the log


@dataclass(frozen=True)
class GaugeResult:
    """The result for one metric."""

    name: str
    values: Array  # of the n readings in their order, (n,)
    gauge: rr.GaugeRR | None  # None if repeats do not scatter at all
    judgements: tuple[Judgement, ...]
    verdict: GaugeVerdict


@dataclass(frozen=True)
class GaugeStudy:
    """The whole study."""

    readings: tuple[GaugeReading, ...]
    results: tuple[GaugeResult, ...]
    notes: tuple[str, ...]  # what its design cannot tell

    @property
    def passed(self) -> bool:
        """Whether no metric has a verdict in `REFUSED`."""
        return all(result.verdict not in REFUSED for result in self.results)

    @property
    def cars(self) -> tuple[str, ...]:
        """Names of the cars, sorted."""
        return tuple(sorted({reading.car for reading in self.readings}))

    @property
    def stations(self) -> tuple[str, ...]:
        """Names of the stations, sorted; empty if the plan does not give them."""
        return tuple(sorted({reading.station for reading in self.readings if reading.station}))


def metrics_of(table: Table, log: Log) -> dict[str, float]:
    """Return the metrics of the ramp ``log`` from its ``table``."""
    s, pads = signals(log, table.vehicle.rear.rolling_radius), table.calibration
    omega_f, omega_r = (np.mean(omega[s.lead_in]) for omega in (s.omega_f, s.omega_r))
    return {
        "pad_scale": pads.pad_scale.value,
        "pad_friction_f": pads.pad_friction_f.value,
        "pad_friction_r": pads.pad_friction_r.value,
        "eta_zero": float(omega_r / omega_f) - 1.0,
        "slip_stiffness": pads.slip_stiffness.value,
    }


def read_gauge_limits(path: Path | None) -> tuple[Limit, ...]:
    """Return the limits of a file, or `_DEFAULTS` without a file. Raises LimitsError."""
    if path is None:
        return _DEFAULTS
    from calib.estimation.limits_file import read_limits

    limits = read_limits(path, KNOWN_LIMITS)
    _tolerances(limits, path)
    return limits


def _tolerances(limits: tuple[Limit, ...], where: object = None) -> dict[str, float]:
    """Return the width USL - LSL of each tolerance; raise LimitsError if its ends are not apart."""
    widths = {}
    for limit in limits:
        if limit.figure not in METRICS:
            continue
        if limit.low is None or limit.high is None or not limit.low < limit.high:
            flaw = f"{limit.figure} is the tolerance of a metric and needs two ends that are apart"
            expected = f"{limit.figure} = {{ min = LOW, max = HIGH }}"
            raise LimitsError(flaw, where=where, expected=expected)
        widths[limit.figure] = limit.high - limit.low
    return widths


def study(readings: tuple[GaugeReading, ...], limits: tuple[Limit, ...] = _DEFAULTS) -> GaugeStudy:
    """Analyse the readings, each metric by itself.

    At least two cars and one repeated ramp are needed; stations are optional. If ``limits`` has
    only tolerances, `_DEFAULTS` judge. Raises InputError for an insufficient design, LimitsError
    for a tolerance with one end.
    """
    tolerances = _tolerances(limits)
    gauge_limits = tuple(limit for limit in limits if limit.figure not in METRICS) or _DEFAULTS
    # numbers of car and station of each reading, (n,)
    car = np.unique([reading.car for reading in readings], return_inverse=True)[1]
    station = np.unique([reading.station for reading in readings], return_inverse=True)[1]
    causes = rr.causes_of(car, station)
    values = {name: np.array([r.figures[name] for r in readings]) for name in readings[0].figures}
    try:
        analyses = {name: rr.anova(y, car, station, causes) for name, y in values.items()}
    except ValueError as error:
        expected = "two cars or more, and more ramps than cars and stations together"
        raise InputError(str(error), where=f"{len(readings)} ramps", expected=expected) from error
    results = [
        _result(name, values[name], analysis, gauge_limits, tolerances.get(name))
        for name, analysis in analyses.items()
    ]
    notes = _notes(causes, several_stations=bool(station.max() > 0))
    alike = [result.name for result in results if result.verdict == GaugeVerdict.ALIKE]
    if alike:
        notes.append(
            f"the cars do not differ in {', '.join(alike)}: %GRR would be near 100 % for any "
            "gauge; take cars that differ, or give the tolerance in --limits"
        )
    return GaugeStudy(readings, tuple(results), tuple(notes))


def _result(
    name: str, values: Array, analysis: rr.Anova, limits: tuple[Limit, ...], tolerance: float | None
) -> GaugeResult:
    """Return the result for one metric; %GRR and ndc are judged if the cars differ."""
    try:
        gauge = rr.gauge_rr(analysis, tolerance)
    except ValueError:
        return GaugeResult(name, values, None, (), GaugeVerdict.NOT_JUDGED)
    figures: dict[str, float | None] = {}
    if gauge.cars_differ:
        figures = {"grr": gauge.grr.value, "ndc": gauge.ndc.value}
    if gauge.grr_of_tolerance:
        figures["grr_of_tolerance"] = gauge.grr_of_tolerance.value
    judgements = judge(limits, figures)
    grr_figures = figures.get("grr"), figures.get("grr_of_tolerance")
    shares = [share for share in grr_figures if share is not None]
    if any(judgement.verdict == FAILED for judgement in judgements):
        verdict = GaugeVerdict.BAD
    elif not shares:
        verdict = GaugeVerdict.ALIKE
    else:
        verdict = GaugeVerdict.GOOD if max(shares) <= _GOOD_GRR else GaugeVerdict.MARGINAL
    return GaugeResult(name, values, gauge, judgements, verdict)


def _notes(causes: tuple[str, ...], *, several_stations: bool) -> list[str]:
    """Return the limits of a design that separates ``causes``, in words."""
    if not several_stations:
        return ["fewer than two stations are given: reproducibility is not measured"]
    if rr.STATION not in causes:
        return ["no car was on two stations: differences of stations count as differences of cars"]
    if rr.INTERACTION not in causes:
        return ["no car was twice on a station: the interaction counts as repeatability"]
    return []


def to_dict(result: GaugeStudy) -> dict[str, object]:
    """Return the JSON document of a study."""
    return {
        "passed": result.passed,
        "cars": result.cars,
        "stations": result.stations,
        "notes": result.notes,
        "ramps": result.readings,
        "quantities": {result.name: _entry(result) for result in result.results},
    }


def _entry(result: GaugeResult) -> dict[str, object]:
    """Return the part of the document for one metric; every metric is a pure number."""
    limits = [asdict(judgement) | judgement.outcome for judgement in result.judgements]
    entry: dict[str, object] = {"unit": "1", "verdict": result.verdict, "limits": limits}
    if result.gauge is None:
        return entry | dict.fromkeys(("components", *_FIGURES, "cars_differ"))
    return entry | {"mean": float(result.values.mean()), **vars(result.gauge)}
