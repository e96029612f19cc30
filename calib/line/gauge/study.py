"""Gauge study of the calibration: repeated ramps of several cars, judged metric by metric.

ramps --fit, one table a ramp--> metrics --anova--> components --limits--> verdict

The scatter of the gauge is compared with the differences of the cars (%GRR, ndc), and with the
tolerance of a metric where it is known. Limits and tolerances stand in one file:

    [limits]
    grr = { max = 0.3 }                           %GRR of every metric, as a share
    pad_scale = { min = 0.8, max = 1.2 }          the tolerance of a metric
    grr_of_tolerance = { max = 0.2 }              %GRR of every tolerance
"""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import InputError, LimitsError
from calib.estimation.limits import FAILED, Judgement, Limit, judge
from calib.line.gauge.gauge_rr import (
    INTERACTION,
    STATION,
    Anova,
    GaugeRR,
    anova,
    gauge_rr,
    terms_of,
)
from calib.logs.log import Log
from calib.run.axle_signals import signals
from calib.table.table import LogReference, Table

_GOOD_GRR = 0.10
"""%GRR up to which AIAG calls a gauge good; between this and the limit it is marginal."""

METRICS = ("pad_scale", "pad_friction_f", "pad_friction_r", "eta_zero", "slip_stiffness")
"""Metrics of every ramp [1], see `metrics_of`."""

_FIGURES = ("grr", "ndc", "grr_of_tolerance")
"""What is judged of each metric."""

KNOWN_LIMITS = (*_FIGURES, *METRICS)
"""Names in a file of limits; that of a metric is its tolerance."""

_DEFAULTS = (
    Limit("grr", None, 0.30),
    Limit("ndc", 5.0, None),
    Limit("grr_of_tolerance", None, 0.30),
)
"""AIAG, Measurement Systems Analysis, 4th ed."""


class GaugeVerdict(StrEnum):
    """Verdict on a metric as a gauge, by AIAG; NOT_JUDGED if repeats do not scatter.

    ALIKE: the cars do not differ and no tolerance is known, so nothing can be judged.
    """

    GOOD = "good"
    MARGINAL = "marginal"
    BAD = "bad"
    ALIKE = "the cars do not differ"
    NOT_JUDGED = "not judged"


REFUSED = (GaugeVerdict.BAD, GaugeVerdict.ALIKE)
"""Verdicts with which a metric does not pass."""


@dataclass(frozen=True)
class GaugeReading:
    """The metrics of one ramp, ``figures`` by name of `METRICS`; its car, station and SHA-256."""

    log: str
    car: str
    station: str
    figures: dict[str, float]
    digest: str = ""


@dataclass(frozen=True)
class GaugeResult:
    """Result for one metric; ``values`` are in the order of the readings.

    ``gauge`` is None if repeats do not scatter at all.
    """

    name: str
    values: Array
    gauge: GaugeRR | None
    judgements: tuple[Judgement, ...]
    verdict: GaugeVerdict


@dataclass(frozen=True)
class GaugeStudy:
    """The whole study; ``notes`` on the limits of the design."""

    readings: tuple[GaugeReading, ...]
    results: tuple[GaugeResult, ...]
    notes: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether no metric is refused."""
        return all(result.verdict not in REFUSED for result in self.results)

    @property
    def cars(self) -> tuple[str, ...]:
        """Names of the cars, sorted."""
        return tuple(sorted({reading.car for reading in self.readings}))

    @property
    def stations(self) -> tuple[str, ...]:
        """Names of the stations, sorted; empty if they are not given."""
        return tuple(sorted({r.station for r in self.readings if r.station}))


def metrics_of(table: Table, log: Log) -> dict[str, float]:
    """Metrics of one ramp from its ``table``.

    The curves follow from them: D = C (eta - 1) with the slip stiffness C, and f1 and f2 from D.
    """
    s, pads = signals(log, table.vehicle.rear.rolling_radius), table.calibration
    return {
        "pad_scale": pads.pad_scale.value,
        "pad_friction_f": pads.pad_friction_f.value,
        "pad_friction_r": pads.pad_friction_r.value,
        "eta_zero": float(np.mean(s.omega_r[s.lead_in]) / np.mean(s.omega_f[s.lead_in])) - 1.0,
        "slip_stiffness": pads.slip_stiffness.value,
    }


def refuse_repeated(log: Log, read: Iterable[LogReference]) -> None:
    """Raise InputError for a run that was read before: a copy is no repeat."""
    first = next((one for one in read if one.is_run_of(log)), None)
    if first is not None:
        raise InputError(f"the same run as {first.name}", where=log.source, do="give it once")


def read_gauge_limits(path: Path | None) -> tuple[Limit, ...]:
    """The limits of a file; the `_DEFAULTS` without one. Raises LimitsError for a bad file."""
    if path is None:
        return _DEFAULTS
    from calib.estimation.limits_file import read_limits

    limits = read_limits(path, KNOWN_LIMITS)
    _tolerances(limits, path)
    return limits


def _tolerances(limits: tuple[Limit, ...], where: object = None) -> dict[str, float]:
    """Width USL - LSL of the tolerance of each metric with a limit, in its unit."""
    out = {}
    for limit in (limit for limit in limits if limit.figure in METRICS):
        if limit.low is None or limit.high is None or not limit.low < limit.high:
            raise LimitsError(
                f"{limit.figure} is the tolerance of a metric and needs two ends that are apart",
                where=where,
                expected=f"{limit.figure} = {{ min = LOW, max = HIGH }}",
            )
        out[limit.figure] = limit.high - limit.low
    return out


def study(
    readings: tuple[GaugeReading, ...],
    limits: tuple[Limit, ...] = _DEFAULTS,
) -> GaugeStudy:
    """Analyse the readings, each metric by itself. Raises InputError for an insufficient design.

    At least two cars and one repeated ramp are needed; stations are optional. A limit of a metric
    itself is its tolerance; where there are no others, the `_DEFAULTS` judge. Raises LimitsError
    for a tolerance with one end.
    """
    tolerances = _tolerances(limits)
    of_gauge = tuple(limit for limit in limits if limit.figure not in METRICS) or _DEFAULTS
    car, station = (
        np.unique([getattr(r, key) for r in readings], return_inverse=True)[1]
        for key in ("car", "station")
    )
    terms = terms_of(car, station)
    values = {name: np.array([r.figures[name] for r in readings]) for name in readings[0].figures}
    try:
        analyses = {name: anova(y, car, station, terms) for name, y in values.items()}
    except ValueError as cause:
        raise InputError(
            str(cause),
            where=f"{len(readings)} ramps",
            expected="two cars or more, and more ramps than cars and stations together",
        ) from cause
    results = [
        _result(name, values[name], analysis, of_gauge, tolerances.get(name))
        for name, analysis in analyses.items()
    ]
    notes = _notes(terms, several=bool(station.max()))
    alike = [result.name for result in results if result.verdict == GaugeVerdict.ALIKE]
    if alike:
        notes.append(
            f"the cars do not differ in {', '.join(alike)}: %GRR would be near 100 % for any "
            "gauge; take cars that differ, or give the tolerance in --limits"
        )
    return GaugeStudy(readings, tuple(results), tuple(notes))


def _result(
    name: str, values: Array, analysis: Anova, limits: tuple[Limit, ...], tolerance: float | None
) -> GaugeResult:
    try:
        gauge = gauge_rr(analysis, tolerance)
    except ValueError:
        return GaugeResult(name, values, None, (), GaugeVerdict.NOT_JUDGED)
    of_cars = (gauge.grr.value, gauge.ndc.value) if gauge.cars_differ else (None, None)
    of_tolerance = gauge.grr_of_tolerance.value if gauge.grr_of_tolerance else None
    figures = dict(zip(_FIGURES, (*of_cars, of_tolerance), strict=True))
    judgements = judge(limits, figures)
    shares = [x for x in (of_cars[0], of_tolerance) if x is not None]
    if any(j.verdict == FAILED for j in judgements):
        verdict = GaugeVerdict.BAD
    elif not shares:
        verdict = GaugeVerdict.ALIKE
    else:
        verdict = GaugeVerdict.GOOD if max(shares) <= _GOOD_GRR else GaugeVerdict.MARGINAL
    return GaugeResult(name, values, gauge, judgements, verdict)


def _notes(terms: tuple[str, ...], *, several: bool) -> list[str]:
    """What the design cannot tell; ``several`` stations."""
    notes = {
        "stations are not given: reproducibility is not measured": not several,
        "no car was on two stations: differences of stations count as differences of cars": (
            several and STATION not in terms
        ),
        "no car was twice on a station: the interaction counts as repeatability": (
            STATION in terms and INTERACTION not in terms
        ),
    }
    return [text for text, holds in notes.items() if holds]


def to_dict(result: GaugeStudy) -> dict[str, object]:
    """The JSON document of a study."""
    return {
        "passed": result.passed,
        "cars": result.cars,
        "stations": result.stations,
        "notes": result.notes,
        "ramps": result.readings,
        "quantities": {result.name: _entry(result) for result in result.results},
    }


def _entry(result: GaugeResult) -> dict[str, object]:
    limits = [asdict(j) | j.outcome for j in result.judgements]
    entry: dict[str, object] = {"unit": "1", "verdict": result.verdict, "limits": limits}
    if result.gauge is None:
        return entry | dict.fromkeys(
            ("components", "grr", "ndc", "grr_of_tolerance", "cars_differ")
        )
    return entry | {"mean": float(result.values.mean()), **vars(result.gauge)}
