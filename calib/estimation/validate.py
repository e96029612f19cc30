"""`brake-cal validate`: the estimator on hold-out logs, its metrics and the verdict.

table, log -> estimate -> metrics -> judged against limits -> DIR/<stem>.parquet, summary.json

The verdict rests on what an ECU makes of the table, as it is exported. Truth proves it; a reference
speed can contradict it, but shares the ramp with it; without both it is consistent, not proved.
"""

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import LogError, VehicleError
from calib.base.plain import bound
from calib.base.warning import PlausibilityWarning
from calib.base.warning import to_dict as warning_dict
from calib.car.mass import MassUsed, mass_used
from calib.car.vehicle import NOT_OF_THE_CAR, Vehicle
from calib.estimation.axles import axles_warnings, crossed_warnings, crossed_wheels, judge_axles
from calib.estimation.budget import budget
from calib.estimation.estimator import Estimate, estimate
from calib.estimation.limits import DEFAULTS, FAILED, PASSED, Judgement, Limit, judge
from calib.estimation.metrics import baseline_errors, score, truth_of
from calib.estimation.plan import as_used
from calib.estimation.roads import Road, roads_of
from calib.estimation.settings import SETTINGS
from calib.estimation.warnings import limit_warnings, warnings_of
from calib.logs.log import Log
from calib.plausibility.speed import NO_SPEED, wrong_speed
from calib.run.axle_signals import signals
from calib.run.gates import require_same_wheels
from calib.run.observation import observe
from calib.run.rules import problems
from calib.run.warnings import clock_gaps, locked_wheels, saturated
from calib.store.evidence import CONSISTENT
from calib.store.version import Stored
from calib.table.budget import AxleBudget, summary
from calib.table.exported import Precision
from calib.table.generation import require_maps
from calib.table.table import Table

HOLDOUT, CALIBRATION = "hold-out", "calibration"
"""Roles of a log in a validation."""

TRUTH, REFERENCE, NONE = "truth", "reference", "none"
"""What a log has to hold against the table, from the strongest: torques, v, or neither."""


NO_HOLDOUT = "the table was fitted on this log: it is no hold-out and proves nothing"


@dataclass(frozen=True)
class Validation:
    """One log: its estimate, its metrics, its judgements, the baselines' errors if truth is known.

    ``role`` is `HOLDOUT`, or `CALIBRATION` for a log on which the table was fitted: it is reported,
    but validates nothing, so it does not pass. ``mass`` is what the estimate rests on; ``warnings``
    what speaks against the result.
    """

    log: str
    digest: str
    role: str
    estimate: Estimate
    figures: dict[str, float | None]
    judgements: tuple[Judgement, ...]
    baselines: dict[str, tuple[float, float]]
    mass: MassUsed
    warnings: tuple[PlausibilityWarning, ...] = ()

    def __repr__(self) -> str:
        mu_f, mu_r = self.figures["pad_friction_f"], self.figures["pad_friction_r"]
        pads = "no answer" if mu_f is None or mu_r is None else f"front {mu_f:.3f}, rear {mu_r:.3f}"
        return f"{self.log} ({self.role}): {self.word}, pad friction {pads}"

    @property
    def passed(self) -> bool:
        """Whether no judged metric fails and the log is a hold-out."""
        held = all(j.passed is not False for j in self.judgements)
        return held and self.role == HOLDOUT

    @property
    def all_warnings(self) -> tuple[PlausibilityWarning, ...]:
        """The warnings, and one for each metric past the range without warning."""
        return (*self.warnings, *limit_warnings(self.log, self.judgements))

    @property
    def refused(self) -> dict[str, float]:
        """Share of the braked samples above 3 m/s that are not valid, by reason, the largest first.

        Reasons for less than a tenth of them are left out.
        """
        e = self.estimate
        counted = e.braked & (e.speed > 3.0)
        if not counted.any():
            return {}
        share = {why: float(np.mean(mask[counted])) for why, mask in e.refused.items()}
        named = {why: x for why, x in share.items() if x > SETTINGS.named}
        return dict(sorted(named.items(), key=lambda item: -item[1]))

    @property
    def verdict(self) -> str:
        """`passed` or `failed`."""
        return PASSED if self.passed else FAILED

    @property
    def proof(self) -> str:
        """What the log held against the ECU: `TRUTH`, `REFERENCE` or `NONE`."""
        if self.role == HOLDOUT:
            for proof, metric in (
                (TRUTH, "ecu_normalised_error_f"),
                (REFERENCE, "ecu_reference_f"),
            ):
                if self.figures[metric] is not None:
                    return proof
        return NONE

    @property
    def word(self) -> str:
        """The verdict as it is told: `CONSISTENT` where nothing was there to prove it."""
        return CONSISTENT if self.passed and self.proof == NONE else self.verdict

    @property
    def budget(self) -> tuple[AxleBudget, AxleBudget] | None:
        """What the intervals of front and rear pads are made of; None without a valid sample.

        It is made when it is first asked for, and takes about as long as the estimate.
        """
        return self.limiting if self.estimate.valid.any() else None

    @cached_property
    def limiting(self) -> tuple[AxleBudget, AxleBudget] | None:
        """What keeps the intervals wide: `budget`; where nothing is valid, the same of the samples
        whose only fault is the width of their interval, and None without such.
        """
        return budget(self.estimate)


DEPARTURE_F, DEPARTURE_R = (bound(f"repeatability_{axle}", "warn_high") for axle in "fr")
"""Largest departure of a stop from the mean pad friction of its road [1], front and rear, that the
same pads have. The rear signal is weaker. The station warns past it."""


@dataclass(frozen=True)
class _RoadAgreement:
    """The stops of one road: their names, the stiffness of their tyres over the table's [1].

    ``mean_f``, ``mean_r`` pad friction; ``spread_f``, ``spread_r`` the largest relative departure
    from it, the repeatability [1]; None of a single stop.
    """

    stops: tuple[str, ...]
    stiffness: float
    mean_f: float
    mean_r: float
    spread_f: float | None
    spread_r: float | None


@dataclass(frozen=True)
class Agreement:
    """Pad friction of the stops: the mean of all, and the largest departure within a road [1].

    On different roads the table errs differently, and the pads may really differ, so stops are
    compared with those of their own road only, see `calib.estimation.roads`.
    """

    mean_f: float
    mean_r: float
    spread_f: float
    spread_r: float
    roads: tuple[_RoadAgreement, ...] = ()

    @property
    def differ(self) -> bool:
        """Whether the stops are too far apart to have the same pads."""
        return self.spread_f > DEPARTURE_F or self.spread_r > DEPARTURE_R


def validate(
    table: Table,
    logs: list[Log],
    vehicle: Vehicle | None = None,
    limits: tuple[Limit, ...] = DEFAULTS,
    mass: float | None = None,
    exported: Table | None = None,
) -> list[Validation]:
    """Run, score and judge the estimator on every log.

    Parameters
    ----------
    table : the one to be validated.
    logs : hold-outs; a log on which the table was fitted is marked and validates nothing.
    vehicle : nominal pads other than the table's; must be the same car in all else.
    limits : of the metrics, for pass or fail.
    mass : of the car in these logs [kg], if it is not that of the table's vehicle.
    exported : the table as an ECU reads it, see `calib.table.exported`; else its full maps.

    Returns
    -------
    One validation per log, in their order.

    Raises LogError for a log that cannot be used, and when the log is clearly of another vehicle;
    VehicleError when ``vehicle`` is another car than the table's; StoreError for a table without
    maps.

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
    return [validate_one(table, log, vehicle, limits, mass=mass, exported=exported) for log in logs]


def validate_one(
    table: Table,
    log: Log,
    vehicle: Vehicle | None,
    limits: tuple[Limit, ...],
    *,
    mass: float | None = None,
    baselines: bool = True,
    exported: Table | None = None,
) -> Validation:
    """Run, score and judge one log; without ``baselines`` the other methods are left out."""
    require_maps(table)
    seen = observe(log, full=False)
    reasons = problems(seen, "validate")
    if reasons:
        raise LogError(
            "this run cannot be used for a validation: " + "; ".join(reasons),
            where=log.source,
            do="see `brake-cal check`",
        )
    car = as_used(table, vehicle, mass)
    require_same_vehicle(table, vehicle, mass=mass)
    read = signals(log, table.vehicle)
    require_same_wheels(table.vehicle, log, read)
    result = estimate(
        table, log, vehicle, mass=mass, with_laws=baselines, read=read, exported=exported
    )
    other = judge_axles(table, log, result)
    crossed = crossed_wheels(table, result, seen.wheels)
    warnings = (
        *clock_gaps(log.name, seen),
        *warnings_of(log, result),
        *axles_warnings(log.name, result, other),
        *locked_wheels(log.name, seen),
        *saturated(log.name, seen),
        *crossed_warnings(log.name, crossed),
    )
    if other is not None and other.log_odds > SETTINGS.axles_sure:
        result = _without_answer(result, "the wheel speeds fit with front and rear exchanged")
    if crossed is not None and crossed.sure:
        front, rear = crossed.found.wheels
        result = _without_answer(result, f"the wheel speeds fit with {front} and {rear} exchanged")
    if (wrong := wrong_speed(warnings)) is not None:
        result = _without_answer(result, NO_SPEED[wrong.code])
    figures = score(log, car, result)
    compared = baselines and bool(result.valid.any())
    truth = truth_of(log, car, result) if compared else None
    return Validation(
        log=log.name,
        digest=log.digest,
        role=HOLDOUT if table.provenance.parent_of(log) is None else CALIBRATION,
        estimate=result,
        figures=figures,
        judgements=judge(limits, figures),
        baselines={} if truth is None else baseline_errors(car, result, truth),
        mass=mass_used(table.vehicle, mass),
        warnings=warnings,
    )


def _without_answer(result: Estimate, why: str) -> Estimate:
    """Return the estimate with no valid sample, for one reason that the whole run gives."""
    refused = {**result.refused, why: result.braked}
    return replace(result, valid=np.zeros_like(result.valid), refused=refused)


def require_same_vehicle(
    table: Table, vehicle: Vehicle | None, where: object = None, mass: float | None = None
) -> None:
    """Raise VehicleError if ``vehicle`` differs from the table's in more than pads and effects.

    ``where`` names its file. With a stated ``mass`` that of the files may differ.
    """
    if vehicle is None:
        return
    ours, theirs = _geometry(table.vehicle), _geometry(vehicle)
    if mass is not None:
        ours.pop("mass")
    differ = [f"{k} {theirs[k]:.6g} for {ours[k]:.6g}" for k in ours if theirs[k] != ours[k]]
    if differ:
        raise VehicleError(
            f"the table was fitted for another car: {', '.join(differ[:4])}",
            where=vehicle.name if where is None else where,
            expected="a vehicle with other pads only",
            do="fit a table for this car",
        )


def _geometry(vehicle: Vehicle) -> dict[str, float]:
    """Everything of a vehicle but its name, pads, effects, and what is open about it."""
    flat = {k: v for k, v in asdict(vehicle).items() if isinstance(v, float)}
    for side, axle in (("front", vehicle.front), ("rear", vehicle.rear)):
        flat |= {f"{side}.{k}": v for k, v in asdict(axle).items() if k != "pad_friction"}
    return {key: value for key, value in flat.items() if key not in NOT_OF_THE_CAR}


def all_warnings(
    of_table: Iterable[PlausibilityWarning], results: list[Validation]
) -> list[PlausibilityWarning]:
    """Warnings of the table's fit, then those of each log."""
    return [*of_table, *(w for result in results for w in result.all_warnings)]


def agreement(results: list[Validation]) -> Agreement | None:
    """Agreement of the stops; None where no two with an estimate are of one road."""
    pads = ("pad_friction_f", "pad_friction_r")
    known = [r for r in results if None not in [r.figures[name] for name in pads]]
    values = np.array([[r.figures[name] for name in pads] for r in known], dtype=float)
    roads = tuple(
        _on_one_road(road, [known[i].log for i in road.stops], values[list(road.stops)])
        for road in roads_of([r.estimate for r in known])
    )
    front, rear = (
        [spread for spread in spreads if spread is not None]
        for spreads in ([r.spread_f for r in roads], [r.spread_r for r in roads])
    )
    if not front:
        return None
    mean = values.mean(axis=0)
    return Agreement(float(mean[0]), float(mean[1]), max(front), max(rear), roads)


def _on_one_road(road: Road, stops: list[str], values: NDArray[np.float64]) -> _RoadAgreement:
    mean = values.mean(axis=0)
    spread = np.abs(values / mean - 1.0).max(axis=0)
    spreads = (float(spread[0]), float(spread[1])) if len(stops) > 1 else (None, None)
    stiffness = float(np.exp(road.log_stiffness))
    return _RoadAgreement(tuple(stops), stiffness, float(mean[0]), float(mean[1]), *spreads)


def proof_of(results: Iterable[Validation]) -> str:
    """The strongest proof that any of the logs gives."""
    given = {result.proof for result in results}
    return next((proof for proof in (TRUTH, REFERENCE) if proof in given), NONE)


def to_dict(
    stored: Stored, results: list[Validation], how: Precision | None = None
) -> dict[str, object]:
    """`summary.json`: every metric, judgement and baseline of every log, and the verdict.

    Its warnings begin with those of the table, which speak against every estimate with it. ``how``
    the table was taken as exported, if not in full.
    """
    together = agreement(results)
    return {
        "schema": 1,
        "table": stored.id,
        "digest": stored.digest,
        "state": stored.state.word,
        "mass": asdict(results[0].mass) if results else None,
        "warnings": [warning_dict(w) for w in all_warnings(stored.table.warnings, results)],
        "verdict": PASSED if all(r.passed for r in results) else FAILED,
        "proof": proof_of(results),
        "exported": None if how is None else asdict(how),
        "logs": [
            {
                "log": r.log,
                "digest": r.digest,
                "role": r.role,
                "verdict": r.verdict,
                "proof": r.proof,
                "figures": {k: _finite(v) for k, v in r.figures.items()},
                "limits": [
                    {
                        "figure": j.figure,
                        "value": _finite(j.value),
                        "min": j.low,
                        "max": j.high,
                        "warn": [j.warn_low, j.warn_high],
                        "passed": j.passed,
                        "warned": j.warned,
                    }
                    for j in r.judgements
                ],
                "not_held": [j.figure for j in r.judgements if j.passed is False],
                "warned": list(dict.fromkeys(warning.code for warning in r.all_warnings)),
                "budget": None if r.budget is None else summary(*r.budget),
                "not_valid": r.refused,
                "rms_error_by_method": {
                    name: {"front": _finite(f), "rear": _finite(b)}
                    for name, (f, b) in r.baselines.items()
                },
                **({"notes": list(notes)} if (notes := _notes(r)) else {}),
            }
            for r in results
        ],
        "agreement": None
        if together is None
        else {
            "pad_friction_f": together.mean_f,
            "pad_friction_r": together.mean_r,
            "largest_departure_f": together.spread_f,
            "largest_departure_r": together.spread_r,
            "roads": [asdict(road) for road in together.roads],
        },
    }


def _notes(result: Validation) -> tuple[str, ...]:
    own = (NO_HOLDOUT,) if result.role == CALIBRATION else ()
    return (*own, *result.estimate.notes)


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
