"""Validate a table: run the estimator on hold-out logs, and judge its metrics.

table, log -> estimate -> metrics -> judgements by limits -> verdict

The verdict is on the answer of an ECU with the table as exported. True torques prove the table. A
speed v can only contradict it, since the estimates with and without v rest on the same ramp.
Without truth and v the answer is consistent, not proved.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property

from calib.base.viewable import Viewable
from calib.base.warning import PlausibilityWarning
from calib.car.mass import MassUsed, mass_used
from calib.car.vehicle import Vehicle, require_same_car
from calib.estimation.estimator import Estimate, estimate_run, run_of
from calib.estimation.limits import DEFAULTS, FAILED, PASSED, WARNING, Judgement, Limit, judge
from calib.estimation.metrics import Figures, baseline_errors, budget, counted_samples, score, share
from calib.estimation.readout import Readout
from calib.estimation.warnings import warnings_of
from calib.logs.log import Log
from calib.plausibility.rules import VALIDATE, makes_void, require
from calib.store.evidence import CONSISTENT
from calib.store.version import Stored, table_in
from calib.table.budget import Parts
from calib.table.table import Table

HOLDOUT, CALIBRATION = "hold-out", "calibration"  # roles of a log

TRUTH, REFERENCE, NONE = "truth", "reference", "none"  # proofs by true torques, v, or nothing
_PROOFS = {TRUTH: "ecu_normalised_error_f", REFERENCE: "ecu_reference_f"}
"""Proofs from the strongest, with a metric that only a log with this proof has."""

Coded = Callable[[Estimate, Log], Readout]  # returns the answer of the C code to the log

NO_HOLDOUT = "the table was fitted on this log: it is no hold-out and proves nothing"


@dataclass(frozen=True)
class Validation(Viewable):
    """The validation on one log."""

    log: str  # name
    digest: str
    role: str  # `HOLDOUT`, or `CALIBRATION` for a log on which the table was fitted
    estimate: Estimate
    figures: Figures
    judgements: tuple[Judgement, ...]
    mass: MassUsed  # in the estimate
    warnings: tuple[PlausibilityWarning, ...] = ()  # of log and estimate

    def __repr__(self) -> str:
        mu_f, mu_r = self.figures["pad_friction_f"], self.figures["pad_friction_r"]
        pads = "no answer" if mu_f is None or mu_r is None else f"front {mu_f:.3f}, rear {mu_r:.3f}"
        return f"{self.log} ({self.role}): {self.word}, pad friction {pads}"

    @property
    def passed(self) -> bool:
        """Whether no judged metric fails and the log is a hold-out."""
        return self.role == HOLDOUT and all(j.verdict != FAILED for j in self.judgements)

    @property
    def proof(self) -> str:
        """The proof of the ECU by this log: `TRUTH`, `REFERENCE` or `NONE`."""
        proofs = (proof for proof, metric in _PROOFS.items() if self.figures[metric] is not None)
        return next(proofs, NONE) if self.role == HOLDOUT else NONE

    @property
    def word(self) -> str:
        """The verdict in a word: `FAILED`, `PASSED`, or `CONSISTENT` where nothing proves it."""
        if not self.passed:
            return FAILED
        return CONSISTENT if self.proof == NONE else PASSED

    @property
    def all_warnings(self) -> tuple[PlausibilityWarning, ...]:
        """The warnings of log and estimate, and of metrics outside ``warn`` of their limits."""
        warned = (j for j in self.judgements if j.verdict == WARNING)
        return (*self.warnings, *(j.warning(self.log) for j in warned))

    @property
    def refused(self) -> dict[str, float]:
        """Share of the braked samples above 3 m/s that are not valid, by reason, if above 10 %."""
        counted = counted_samples(self.estimate)
        shares = {why: share(x, counted) for why, x in self.estimate.refused.items()}
        reasons = sorted(shares, key=lambda why: (shares[why], why), reverse=True)
        return {why: shares[why] for why in reasons if shares[why] > 0.1}

    @cached_property
    def baselines(self) -> dict[str, tuple[float, float]]:
        """Rms relative errors of front and rear pads by method, as `baseline_errors`."""
        return baseline_errors(self.estimate)

    @cached_property
    def budget(self) -> tuple[Parts, Parts] | None:
        """Budgets of the intervals of front and rear pads; None without a valid sample."""
        return budget(self.estimate)

    @property
    def compared_with(self) -> str:
        """The kind of values that baselines are compared with: `TRUTH`, `REFERENCE` or `NONE`."""
        if "estimate" in self.baselines:
            return TRUTH
        return REFERENCE if self.baselines else NONE


def validate(
    table: Table | Stored,
    logs: list[Log],
    vehicle: Vehicle | None = None,
    *,
    limits: tuple[Limit, ...] = DEFAULTS,
    mass: float | None = None,
    exported: Table | None = None,
) -> list[Validation]:
    """Run, score and judge the estimator on every log; one validation for each, in their order.

    Parameters
    ----------
    table, mass, exported : as in `calib.estimation.estimator.estimate`.
    logs : hold-outs. A log on which the table was fitted is marked, and validates nothing.
    vehicle : the same car with other nominal pads than the table's.
    limits : ranges outside of which a metric fails or warns.

    Raises LogError for a log that cannot be used or is clearly of another vehicle, VehicleError
    when ``vehicle`` is another car than the table's, StoreError for a table without maps.

    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> (result,) = calib.validate(table, [calib.read_log(logs / "stop_noisy.parquet")])
    >>> result.log, result.role, result.passed, result.proof
    ('stop_noisy', 'hold-out', True, 'truth')
    >>> result.figures["ecu_normalised_error_f"] < 2.0  # against the truth in the log
    True
    """
    table = table_in(table)
    return [validate_one(table, log, vehicle, limits, mass=mass, exported=exported) for log in logs]


def validate_one(
    table: Table,
    log: Log,
    vehicle: Vehicle | None,
    limits: tuple[Limit, ...],
    *,
    mass: float | None = None,
    exported: Table | None = None,
    coded: Coded | None = None,
) -> Validation:
    """Run, score and judge one log; with ``coded`` the ECU's answers are those of the C code."""
    run = run_of(table, log, vehicle, mass)
    if vehicle is not None:
        require_same_car(table.vehicle, vehicle, weighed=mass is not None)
    require(run, VALIDATE)
    result = estimate_run(table, run, vehicle, exported)
    if coded is not None:
        result = replace(result, ecu=coded(result, log))
    warnings = warnings_of(result, run)
    unfit = (warning.causes[0] for warning in warnings if makes_void(warning, VALIDATE))
    result = replace(result, unfit=tuple(unfit))
    figures = score(result)
    return Validation(
        log=log.name,
        digest=log.digest,
        role=HOLDOUT if table.provenance.fitted_log_of(log) is None else CALIBRATION,
        estimate=result,
        figures=figures,
        judgements=judge(limits, figures),
        mass=mass_used(table.vehicle, mass),
        warnings=warnings,
    )


def proof_of(results: Iterable[Validation]) -> str:
    """Return the strongest proof that any of the logs gives."""
    proofs = {result.proof for result in results}
    return next((proof for proof in _PROOFS if proof in proofs), NONE)
