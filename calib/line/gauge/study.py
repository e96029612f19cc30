"""Gauge study of the calibration: repeated ramps of several cars, judged metric by metric.

ramps --fit, one table a ramp--> metrics --anova--> components --limits--> verdict

A metric is compared with the differences of the cars (%GRR, ndc) and, where its tolerance is known,
with that. Where the cars do not differ only the tolerance can judge the gauge.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import InputError
from calib.estimation.limits import Judgement, Limit, judge
from calib.line.gauge.anova import INTERACTION, STATION, Anova, anova, terms_of
from calib.line.gauge.gauge_rr import GaugeRR, gauge_rr
from calib.line.gauge.tolerance import tolerances
from calib.logs.log import Log
from calib.run.axle_signals import signals
from calib.table.table import LogReference, Table

Array = NDArray[np.float64]
Codes = NDArray[np.int64]

REFERENCE = 0.0015
"""Default eta - 1 at which the curves are compared [1]: on the rising branch of all usual cars, and
ten times the uncertainty of the zero of a good ramp."""

GOOD_GRR = 0.10
"""%GRR up to which AIAG calls a gauge good; between this and the limit it is marginal."""

FIGURES = ("grr", "ndc", "grr_of_tolerance")
"""What is judged of each metric."""

DEFAULTS = (
    Limit("grr", None, 0.30),
    Limit("ndc", 5.0, None),
    Limit("grr_of_tolerance", None, 0.30),
)
"""AIAG, Measurement Systems Analysis, 4th ed."""

METRICS = {
    "pad_scale": "common factor on the nominal pad friction",
    "pad_friction_f": "pad friction, front",
    "pad_friction_r": "pad friction, rear",
    "eta_zero": "eta - 1 on the unbraked lead-in",
    "slip_stiffness": "normalised force per slip of the tyres at small slip",
    "difference": "D = F_f - F_r at the reference eta",
    "f1": "f1 at the reference eta",
    "f2": "f2 at the reference eta",
}
"""Metrics of every ramp; all dimensionless."""


class GaugeVerdict(StrEnum):
    """Verdict on a metric as a gauge, by AIAG; NOT_JUDGED if repeats do not scatter.

    ALIKE: the cars do not differ and no tolerance is known, so nothing shows that it is good.
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
    """The metrics of one ramp, by name of `METRICS`; its car, station and SHA-256."""

    log: str
    car: str
    station: str
    metrics: dict[str, float]
    digest: str = ""


@dataclass(frozen=True)
class GaugeResult:
    """Result for one metric; ``values`` are in the order of the readings.

    ``analysis`` and ``gauge`` are None if repeats do not scatter at all.
    """

    name: str
    values: Array
    analysis: Anova | None
    gauge: GaugeRR | None
    judgements: tuple[Judgement, ...]
    verdict: GaugeVerdict


@dataclass(frozen=True)
class GaugeStudy:
    """The whole study; ``notes`` on the limits of the design."""

    readings: tuple[GaugeReading, ...]
    results: tuple[GaugeResult, ...]
    reference: float
    notes: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether each judged metric is shown to hold its limits."""
        return all(result.verdict not in REFUSED for result in self.results)

    @property
    def cars(self) -> tuple[str, ...]:
        """Names of the cars, sorted."""
        return tuple(sorted({reading.car for reading in self.readings}))

    @property
    def stations(self) -> tuple[str, ...]:
        """Names of the stations, sorted; empty if they are not given."""
        return tuple(sorted({r.station for r in self.readings if r.station}))


@dataclass(frozen=True)
class Design:
    """Car and station of each ramp as codes (n,), and the causes that can be separated."""

    car: Codes
    station: Codes
    terms: tuple[str, ...]


def metrics_of(table: Table, log: Log, reference: float = REFERENCE) -> dict[str, float]:
    """Metrics of one ramp from its ``table``, with the curves at eta - 1 = ``reference`` [1].

    At a given eta the curves are what the ECU reads. At a given deceleration they would depend only
    on the pad ratio, which a ramp determines poorly. Raises InputError if the curves do not reach
    ``reference``.
    """
    paper, eta = table.paper, 1.0 + reference
    if not paper.eta[0] <= eta <= paper.eta[-1]:
        raise InputError(
            f"f1 and f2 have no value where eta is {100.0 * reference:g} % above one",
            where=log.source,
            expected=f"at most {100.0 * (paper.eta[-1] - 1.0):.2f} %, where eta turns",
            do="give another --eta",
        )
    s = signals(log, table.vehicle)
    D = table.difference
    pads = table.calibration
    return {
        "pad_scale": pads.pad_scale.value,
        "pad_friction_f": pads.pad_friction_f.value,
        "pad_friction_r": pads.pad_friction_r.value,
        "eta_zero": float(np.mean(s.omega_r[s.lead_in]) / np.mean(s.omega_f[s.lead_in])) - 1.0,
        "slip_stiffness": float(np.exp(-table.posterior.value("log_compliance"))),
        "difference": float(np.interp(eta, D.eta, D.D)),
        "f1": float(np.interp(eta, paper.eta, paper.f1)),
        "f2": float(np.interp(eta, paper.eta, paper.f2)),
    }


def refuse_repeated(log: Log, read: Iterable[LogReference]) -> None:
    """Raise InputError for a run that was read before: a copy would look like a perfect repeat."""
    first = next((one for one in read if one.is_run_of(log)), None)
    if first is not None:
        raise InputError(f"the same run as {first.name}", where=log.source, do="give it once")


def known_limits() -> set[str]:
    """Names allowed in a limits file.

    `FIGURES` of all metrics, or of one as ``NAME_grr``; a metric itself: its tolerance.
    """
    return {*FIGURES, *METRICS} | {f"{q}_{f}" for q in METRICS for f in FIGURES}


def study(
    readings: tuple[GaugeReading, ...],
    limits: tuple[Limit, ...] = DEFAULTS,
    reference: float = REFERENCE,
) -> GaugeStudy:
    """Analyse the readings, each metric by itself. Raises InputError for an insufficient design.

    At least two cars and one repeated ramp are needed; stations are optional. A limit of a metric
    itself is its tolerance and must have both ends, else LimitsError is raised; where there are
    only such limits the `DEFAULTS` judge.
    """
    known = tolerances(limits, METRICS)
    held = tuple(limit for limit in limits if limit.figure not in METRICS) or DEFAULTS
    car, station = (_coded([getattr(r, key) for r in readings]) for key in ("car", "station"))
    _check_design(readings, car, station)
    design = Design(car, station, terms_of(car, station))
    results = tuple(
        _result(
            name,
            np.array([r.metrics[name] for r in readings]),
            design,
            held,
            known.get(name),
        )
        for name in readings[0].metrics
    )
    return GaugeStudy(readings, results, reference, (*_notes(design), *_alike(results)))


def _alike(results: tuple[GaugeResult, ...]) -> tuple[str, ...]:
    """What to do about metrics in which the cars do not differ."""
    names = [result.name for result in results if result.verdict == GaugeVerdict.ALIKE]
    if not names:
        return ()
    return (
        f"the cars do not differ in {', '.join(names)}: %GRR would be near 100 % for any gauge; "
        "take cars that differ, or give the tolerance in --limits",
    )


def _coded(names: list[str]) -> NDArray[np.int64]:
    return np.asarray(np.unique(names, return_inverse=True)[1], dtype=np.int64)


def _check_design(readings: tuple[GaugeReading, ...], car: Codes, station: Codes) -> None:
    where = f"{len(readings)} ramps"
    if len(set(car)) < 2:
        raise InputError(
            "all ramps are of one car",
            where=where,
            expected="ramps of two cars or more; 10 is usual",
        )
    cells = len({*zip(car.tolist(), station.tolist(), strict=True)})
    if cells == len(readings) and len(set(station)) < 2:
        raise InputError(
            "no car has a second ramp", where=where, expected="two ramps or more of some cars"
        )
    try:
        anova(np.zeros(car.size), car, station)
    except ValueError as cause:
        raise InputError(
            str(cause), where=where, expected="more ramps than cars and stations together"
        ) from cause


def _result(
    name: str,
    values: Array,
    design: Design,
    limits: tuple[Limit, ...],
    tolerance: float | None,
) -> GaugeResult:
    analysis = anova(values, design.car, design.station, design.terms)
    try:
        judged = gauge_rr(analysis, tolerance)
    except ValueError:
        return GaugeResult(name, values, None, None, (), GaugeVerdict.NOT_JUDGED)
    judgements = judge(_limits_of(name, limits), _figures(judged))
    return GaugeResult(name, values, analysis, judged, judgements, _verdict(judged, judgements))


def _figures(judged: GaugeRR) -> dict[str, float | None]:
    """`FIGURES` of a metric; None for what has no meaning or is not known."""
    of_cars = (judged.grr, float(judged.categories)) if judged.cars_differ else (None, None)
    return dict(zip(FIGURES, (*of_cars, judged.tolerance), strict=True))


def _verdict(judged: GaugeRR, judgements: tuple[Judgement, ...]) -> GaugeVerdict:
    shares = [judged.grr] if judged.cars_differ else []
    shares += [] if judged.tolerance is None else [judged.tolerance]
    if any(j.passed is False for j in judgements):
        return GaugeVerdict.BAD
    if not shares:
        return GaugeVerdict.ALIKE
    return GaugeVerdict.GOOD if max(shares) <= GOOD_GRR else GaugeVerdict.MARGINAL


def _limits_of(name: str, limits: tuple[Limit, ...]) -> tuple[Limit, ...]:
    """The limits of one metric: its own if given, else the common ones."""
    by_name = {limit.figure: limit for limit in limits}
    both = [(f, by_name.get(f"{name}_{f}", by_name.get(f))) for f in FIGURES]
    return tuple(Limit(f, limit.low, limit.high) for f, limit in both if limit is not None)


def _notes(design: Design) -> tuple[str, ...]:
    """Quantities that the design cannot determine, or only roughly."""
    stations, cars = len(set(design.station)), len(set(design.car))
    few_stations = f"{stations} stations are few: the interval of the reproducibility is wide"
    few_cars = f"{cars} cars are few: AIAG asks for 10"
    notes = (
        _not_separated(design),
        few_stations if STATION in design.terms and stations < 4 else "",
        few_cars if cars < 5 else "",
        _unbalanced(design),
    )
    return tuple(filter(None, notes))


def _not_separated(design: Design) -> str:
    if len(set(design.station)) < 2:
        return "stations are not given: reproducibility is not measured"
    if STATION not in design.terms:
        return "no car was on two stations: differences of stations count as differences of cars"
    if INTERACTION not in design.terms:
        return "no car was twice on a station: the interaction counts as repeatability"
    return ""


def _unbalanced(design: Design) -> str:
    ramps = np.zeros((int(design.car.max()) + 1, int(design.station.max()) + 1), dtype=np.int64)
    np.add.at(ramps, (design.car, design.station), 1)
    if ramps.min() == ramps.max():
        return ""
    empty = int(np.sum(ramps == 0))
    cells = f", {empty} of {ramps.size} car-station cells empty" if empty else ""
    return (
        f"unequal numbers of ramps{cells}: sums of squares are type I (car, station, both), "
        "variances from their expectations, intervals approximate"
    )
