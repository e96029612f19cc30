"""The verdict on one car.

ramps, coasts --fit--> table
table, stops --validate--> metrics --limits--> checks --> passed, warning or failed
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from calib.base.errors import LogError
from calib.base.plain import counted, metric_of
from calib.base.warning import Measured, PlausibilityWarning, rule_warnings
from calib.car.balance import front_share
from calib.car.vehicle import Vehicle, require_same_car
from calib.estimation.limits import FAILED, NOT_KNOWN, PASSED, WARNING, Judgement, Limit, judge
from calib.estimation.metrics import METRICS as OF_STOPS
from calib.estimation.validate import NONE, Validation, proof_of, validate_one
from calib.fitting.fit import fit
from calib.line.station.metrics import METRICS as OF_CAR
from calib.line.station.metrics import metrics_of
from calib.logs.log import Log
from calib.run.same_run import refuse_copies
from calib.store.evidence import CONSISTENT
from calib.store.state import DRAFT, REJECTED, RELEASED, Evidence, StateDecision
from calib.store.version import Stored
from calib.table.table import Table

STATION = "station"  # purpose of rules for ramp and stops together, see `calib/base/rules.csv`
_LONGEST = 64  # largest number of characters of an identifier

TITLES = {
    "serial": "Serial number",  # of the car, or of its brake control unit
    "vin": "VIN",
    "station": "Station",  # where the run took place
    "rxswin": "RXSWIN",  # of the software, by UN R156
}
"""Titles of the identifiers of a run."""

Identity = Mapping[str, str]  # the identifiers of a run, by their names in `TITLES`


def identifier(text: str) -> str:
    """Return ``text`` if a report can show it as an identifier. Raises ValueError."""
    if not text.strip() or len(text) > _LONGEST or not text.isprintable():
        raise ValueError(f"not an identifier: 1 to {_LONGEST} characters that can be printed")
    return text


@dataclass(frozen=True)
class StationCheck(Judgement):
    """A judgement of a metric of the hold-out ``stop``, or of the car if ``stop`` is None."""

    stop: str | None = None

    @property
    def scope(self) -> str:
        """The name of the hold-out, or "car". A hold-out may be named "car" as well."""
        return "car" if self.stop is None else self.stop

    @property
    def text(self) -> str:
        """Value and limit in words: `Front brakes, left less right: 31 %; limit: -20 to 20 %`."""
        metric = metric_of(self.figure)
        limit = f"limit: {metric.bounds(self.low, self.high)}"
        if self.verdict == WARNING:
            limit = f"no warning: {metric.bounds(self.warn_low, self.warn_high)}"
        prefix = "" if self.stop is None else f"stop {self.stop}, "
        return f"{prefix}{metric.name}: {metric.with_unit(self.value)}; {limit}"

    @property
    def action(self) -> str:
        """The next step where the limit is not held, in one or two sentences."""
        default = "Look at the log with brake-cal check and brake-cal plot."
        return metric_of(self.figure).action or default


@dataclass(frozen=True)
class StationOutcome:
    """A car after its run at the station, and the verdict."""

    table: Table  # fitted on `ramps` and on coasts
    ramps: Sequence[Log]
    results: tuple[Validation, ...]  # of the hold-outs in their order
    limits: Sequence[Limit]
    golden: Stored | None = None  # golden table of the model
    accepted: str = ""  # reason why warnings are accepted; "" accepts none
    by: str = ""  # person who answers for the verdict; "" is the user of the computer
    limits_file: str = ""  # name and digest of the file of `limits`; "" for default limits

    @property
    def identity(self) -> Identity:
        """The identifiers of the run."""
        return self.table.provenance.identity

    @cached_property
    def figures(self) -> dict[str, float | None]:
        """The metrics of the car as a whole."""
        golden = self.golden.table if self.golden else None
        return metrics_of(self.table, self.ramps, self.results, golden)

    @cached_property
    def checks(self) -> list[StationCheck]:
        """The check of every metric of the car and of its stops that has a limit."""
        limits = tuple(limit for limit in self.limits if limit.figure in OF_CAR)
        checks = [StationCheck(**vars(judgement)) for judgement in judge(limits, self.figures)]
        for result in self.results:
            checks += [StationCheck(**vars(x), stop=result.log) for x in result.judgements]
        return checks

    @property
    def logs(self) -> list[tuple[str, str, str]]:
        """Role, name and digest of each log."""
        # a tyre file has the role "tyre", and is no log
        drives = [log for log in self.table.provenance.logs if log.role in ("ramp", "coast")]
        stops = [(result.role, result.log, result.digest) for result in self.results]
        return [(log.role, log.name, log.digest) for log in drives] + stops

    @property
    def warnings(self) -> tuple[PlausibilityWarning, ...]:
        """The warnings of the fit, of fit and stops together, and of the stops."""
        of_stops = (warning for result in self.results for warning in result.warnings)
        return (*self.table.warnings, *car_warnings(self.table, self.results), *of_stops)

    @property
    def verdict(self) -> str:
        """`failed` if any check fails, else `warning` if there is any warning, else `passed`."""
        if not self.passed:
            return FAILED
        return WARNING if self.warnings or self.counts[WARNING] else PASSED

    @property
    def passed(self) -> bool:
        """Whether no check fails; warnings pass."""
        return not self.counts[FAILED]

    @property
    def headline(self) -> str:
        """The numbers of checks and warnings in a sentence."""
        counts, warnings = self.counts, len(self.warnings)
        labels = {FAILED: "failed", WARNING: "with a warning", NOT_KNOWN: "not known"}
        others = [f"{counts[word]} {label}" for word, label in labels.items() if counts[word]]
        checks = ", ".join([f"{counted(counts[PASSED], 'check')} passed", *others])
        warned = f"; {counted(warnings, 'warning')} of its logs" if warnings else ""
        return f"{checks}{warned}{self._unproved}"

    @property
    def _unproved(self) -> str:
        """A remark if the stops have neither truth nor speed, so that they prove nothing."""
        return f", {CONSISTENT}" if self.passed and proof_of(self.results) == NONE else ""

    def decision(self, digest: str) -> StateDecision:
        """Return the decision on the table's state; ``digest`` is that of `station.json`."""
        state = {PASSED: RELEASED, FAILED: REJECTED, WARNING: DRAFT}[self.verdict]
        reason = f"{self.verdict} at the station{self._unproved}"
        if self.verdict == WARNING and self.accepted:
            state, reason = RELEASED, f"{reason}; accepted: {self.accepted}"
        evidence = (Evidence("station.json", digest),)
        return StateDecision(state, reason, self.verdict, evidence, self.by, automatic=True)

    @cached_property
    def counts(self) -> dict[str, int]:
        """The number of checks by verdict."""
        verdicts = [check.verdict for check in self.checks]
        return {word: verdicts.count(word) for word in (PASSED, WARNING, FAILED, NOT_KNOWN)}


def judged_car(
    vehicle: Vehicle,
    ramps: Sequence[Log],
    coasts: Sequence[Log],
    stops: Sequence[Log],
    limits: Sequence[Limit],
    identity: Identity | None = None,
    *,
    mass: float | None = None,
    golden: Stored | None = None,
    report: Callable[[], None] = lambda: None,
    **fields: Any,
) -> StationOutcome:
    """Fit the table of a car, validate it on its stops, and judge both by the limits.

    ``mass`` is that of the car in these logs [kg], if not that of ``vehicle``. ``golden`` is the
    golden table of the model. ``report`` is called after the fit and after each stop. ``fields``
    are further fields of `StationOutcome`.

    Raises VehicleError for a golden table of another model, LogError for a ramp without braking, a
    coast with braking, or a stop that is a copy of a log of the fit.
    """
    if golden is not None:
        require_same_car(golden.table.vehicle, vehicle)
    refuse_copies([*ramps, *coasts], stops)
    fitted = fit(vehicle, [*ramps, *coasts], mass=mass)
    _require_roles(fitted, ramps, coasts)
    table = replace(fitted, provenance=replace(fitted.provenance, identity=dict(identity or {})))
    report()
    stop_limits = tuple(limit for limit in limits if limit.figure in OF_STOPS)
    results = []
    for log in stops:
        results.append(validate_one(table, log, None, stop_limits, mass=mass))
        report()
    return StationOutcome(table, ramps, tuple(results), limits, golden, **fields)


def _require_roles(table: Table, ramps: Sequence[Log], coasts: Sequence[Log]) -> None:
    """Raise LogError for a ramp that the fit took for a coast, or a coast taken for a ramp."""
    roles = {log.digest: log.role for log in table.provenance.logs}
    for role, logs in (("ramp", ramps), ("coast", coasts)):
        for log in logs:
            if roles[log.digest] != role:
                flaw = f"given as a {role}, and it is a {roles[log.digest]}"
                do = "the ramp comes first, further ones with --ramp, coasts with --coast"
                raise LogError(flaw, where=log.source, do=do)


def car_warnings(table: Table, results: Sequence[Validation]) -> tuple[PlausibilityWarning, ...]:
    """Return a warning if the brakes of the stops, in the mean, are not those of the ramp."""
    of_stops = [force_over_ramp(table, result) for result in results]
    ratios = [ratio for ratio in of_stops if ratio is not None]
    if not ratios:
        return ()
    mean = float(np.mean(np.log(ratios)))
    measured = Measured("level_changed", mean, to_display=math.expm1)
    return rule_warnings(table.vehicle.name, [measured], STATION)


def force_over_ramp(table: Table, result: Validation) -> float | None:
    """Return the brake force of a stop over that with the ramp's pads [1]; None if not known."""
    mu_f, mu_r = (result.figures[f"pad_friction_{axle}"] for axle in "fr")
    if mu_f is None or mu_r is None:
        return None
    pads = table.calibration
    share = front_share(table.vehicle, pads.pad_log_ratio.value)
    front, rear = mu_f / pads.pad_friction_f.value, mu_r / pads.pad_friction_r.value
    return share * front + (1.0 - share) * rear
