"""The verdict on one car: fitted, validated on its stops, every metric checked with its limit.

ramps, coasts --> table --> stops --> metrics --> checks --> passed, warning or failed
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

STATION = "station"
"""Purpose of the rules that the station asks of ramp and stops together."""

_LONGEST = 64
"""Largest number of characters of an identifier."""

Identity = Mapping[str, str]
"""Identifiers of a run at the line that were given, by their names in `TITLES`."""

TITLES = {"serial": "Serial number", "vin": "VIN", "station": "Station", "rxswin": "RXSWIN"}
"""Identifiers in a report: of the car or brake control unit, of the car, where it ran, and the
software identification of UN R156."""


def identifier(text: str) -> str:
    """Return the text of an identifier. Raises ValueError for one that no report can show."""
    if not text.strip() or len(text) > _LONGEST or not text.isprintable():
        raise ValueError(f"not an identifier: 1 to {_LONGEST} characters that can be printed")
    return text


@dataclass(frozen=True)
class StationCheck:
    """One metric and its limit: of the hold-out named ``stop``; None for the car as a whole."""

    stop: str | None
    judgement: Judgement

    @property
    def scope(self) -> str:
        """Name of the hold-out, or "car"; a hold-out may have that name as well."""
        return "car" if self.stop is None else self.stop

    @property
    def figure(self) -> str:
        """Name of the metric."""
        return self.judgement.figure

    @property
    def verdict(self) -> str:
        """`passed`, `warning`, `failed` or `not known`."""
        return self.judgement.verdict

    @property
    def text(self) -> str:
        """In plain names and units: `Front brakes, left less right: 31 %; limit: -20 to 20 %`."""
        j, shown = self.judgement, metric_of(self.figure)
        kind, ends = "limit", (j.low, j.high)
        if self.verdict == WARNING:
            kind, ends = "no warning", (j.warn_low, j.warn_high)
        prefix = "" if self.stop is None else f"stop {self.stop}, "
        return f"{prefix}{shown.name}: {shown.with_unit(j.value)}; {kind}: {shown.bounds(*ends)}"

    @property
    def action(self) -> str:
        """What to do where the limit is not held, in one or two sentences."""
        look = "Look at the log with brake-cal check and brake-cal plot."
        return metric_of(self.figure).action or look


@dataclass(frozen=True)
class StationOutcome:
    """A car after its run at the station, and the verdict.

    ``table`` fitted on ``ramps`` and on coasts; ``results`` of the hold-outs in their order;
    ``golden`` table of its model; ``accepted`` why warnings are accepted; ``by`` who answers for
    it, "" for the user of the computer; ``limits_file`` file of ``limits`` with its digest, "" for
    the default ones.
    """

    table: Table
    ramps: Sequence[Log]
    results: tuple[Validation, ...]
    limits: Sequence[Limit]
    golden: Stored | None = None
    accepted: str = ""
    by: str = ""
    limits_file: str = ""

    @property
    def identity(self) -> Identity:
        """The identifiers that were given."""
        return self.table.provenance.identity

    @cached_property
    def figures(self) -> dict[str, float | None]:
        """The metrics of the car as a whole."""
        golden = self.golden.table if self.golden else None
        return metrics_of(self.table, self.ramps, self.results, golden)

    @cached_property
    def checks(self) -> list[StationCheck]:
        """Every metric of the car and of its stops that has a limit."""
        of_car = judge(tuple(x for x in self.limits if x.figure in OF_CAR), self.figures)
        of_stops = [StationCheck(r.log, j) for r in self.results for j in r.judgements]
        return [*(StationCheck(None, j) for j in of_car), *of_stops]

    @property
    def logs(self) -> list[tuple[str, str, str]]:
        """Role, name and digest of each log."""
        fitted = [x for x in self.table.provenance.logs if x.role in ("ramp", "coast")]
        stops = [(r.role, r.log, r.digest) for r in self.results]
        return [(x.role, x.name, x.digest) for x in fitted] + stops

    @property
    def warnings(self) -> tuple[PlausibilityWarning, ...]:
        """Warnings of the fit, of the stops, and of both together."""
        of_stops = (w for result in self.results for w in result.warnings)
        return (*self.table.warnings, *car_warnings(self.table, self.results), *of_stops)

    @property
    def verdict(self) -> str:
        """`failed` if any check fails, else `warning` if there is any warning, else `passed`."""
        if self.counts[FAILED]:
            return FAILED
        return WARNING if self.warnings or self.counts[WARNING] else PASSED

    @property
    def passed(self) -> bool:
        """Whether no check fails; warnings pass."""
        return self.verdict != FAILED

    @property
    def headline(self) -> str:
        """The verdict in a sentence with its counts."""
        n, count = self.counts, len(self.warnings)
        parts = {"failed": n[FAILED], "with a warning": n[WARNING], "not known": n[NOT_KNOWN]}
        others = [f"{number} {word}" for word, number in parts.items() if number]
        of_logs = f"; {counted(count, 'warning')} of its logs" if count else ""
        passed = ", ".join([f"{counted(n[PASSED], 'check')} passed", *others])
        return f"{passed}{of_logs}{self._unproved}"

    @property
    def _unproved(self) -> str:
        """Remark where the stops have nothing that could prove the table."""
        return f", {CONSISTENT}" if self.passed and proof_of(self.results) == NONE else ""

    def decision(self, digest: str) -> StateDecision:
        """The state of the table by the verdict; ``digest`` of `station.json`, its evidence.

        With warnings that nobody accepts it stays a draft.
        """
        state = {PASSED: RELEASED, FAILED: REJECTED}.get(self.verdict, DRAFT)
        reason = f"{self.verdict} at the station{self._unproved}"
        if self.verdict == WARNING and self.accepted:
            state, reason = RELEASED, f"{reason}; accepted: {self.accepted}"
        evidence = (Evidence("station.json", digest),)
        return StateDecision(state, reason, self.verdict, evidence, self.by, automatic=True)

    @cached_property
    def counts(self) -> dict[str, int]:
        """Number of checks by verdict."""
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

    Parameters
    ----------
    ramps, coasts : logs for the fit; the provenance of the table holds the ``identity``.
    stops : hold-outs of the same car.
    mass : of the car in these logs [kg], if it is not that of ``vehicle``.
    golden : the table of its model.
    report : called after the fit and after each stop.
    fields : further fields of `StationOutcome`.

    Raises VehicleError for a golden table of another car, LogError for a ramp without braking, a
    coast with braking, a stop that was fitted.
    """
    if golden is not None:
        require_same_car(golden.table.vehicle, vehicle)
    refuse_copies([*ramps, *coasts], stops)
    fitted = fit(vehicle, [*ramps, *coasts], mass=mass)
    _require_roles(fitted, ramps, coasts)
    table = replace(fitted, provenance=replace(fitted.provenance, identity=dict(identity or {})))
    report()
    of_stops, results = tuple(x for x in limits if x.figure in OF_STOPS), []
    for log in stops:
        results.append(validate_one(table, log, None, of_stops, mass=mass))
        report()
    return StationOutcome(table, ramps, tuple(results), limits, golden, **fields)


def _require_roles(table: Table, ramps: Sequence[Log], coasts: Sequence[Log]) -> None:
    roles = {log.digest: log.role for log in table.provenance.logs}
    for role, logs in (("ramp", ramps), ("coast", coasts)):
        for log in logs:
            if roles[log.digest] != role:
                raise LogError(
                    f"given as a {role}, and it is a {roles[log.digest]}",
                    where=log.source,
                    do="the ramp comes first, further ones with --ramp, coasts with --coast",
                )


def car_warnings(table: Table, results: Sequence[Validation]) -> tuple[PlausibilityWarning, ...]:
    """Warnings of a brake level that changed from the ramp to the mean of the stops."""
    changes = [change for r in results if (change := level_change(table, r)) is not None]
    mean = float(np.mean(np.log(changes))) if changes else 0.0
    measured = Measured("level_changed", mean, to_display=math.expm1)
    return rule_warnings(table.vehicle.name, [measured], STATION)


def level_change(table: Table, result: Validation) -> float | None:
    """Brake force of a stop over that with the pads of the ramp [1]; None if not known."""
    mu_f, mu_r = (result.figures[f"pad_friction_{axle}"] for axle in "fr")
    if mu_f is None or mu_r is None:
        return None
    cal = table.calibration
    share = front_share(table.vehicle, cal.pad_log_ratio.value)
    front, rear = mu_f / cal.pad_friction_f.value, mu_r / cal.pad_friction_r.value
    return share * front + (1.0 - share) * rear
