"""The diagnosis of a car: find the gap, name its cause, add it, measure the gap on hold-outs.

calibration logs ──> problem ──> decide ──> (unknown: locate) ──> model
hold-out logs ────────────────── confirm ──────────────────────── replays, gap
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.checks.gates import require_same_wheels
from calib.diagnosis.candidate import (
    Candidate,
    Problem,
    base_of,
    fit,
    problem_of,
    turned_to_ripple,
)
from calib.diagnosis.channels import CHANNELS, residuals, thinned, whiten
from calib.diagnosis.decide import (
    DETECT,
    FLOOR,
    SECOND_SHARE,
    STRANGE,
    Decision,
    confusable,
    decide,
    gain,
)
from calib.diagnosis.gap import Gap, gap_of, replays
from calib.diagnosis.predict import SHAPE, ObservedRun, predict, run_of
from calib.diagnosis.search import unresolved
from calib.diagnosis.separate import separate_by
from calib.diagnosis.unexplained import UnexplainedTerm, locate
from calib.errors import LogError
from calib.logs.log import Log
from calib.physics.effects.catalogue import effect_named
from calib.physics.effects.effect import acts_on_wheels
from calib.physics.effects.effects import Effects
from calib.physics.magic_formula import MagicFormula
from calib.physics.model import Model
from calib.physics.vehicle import Vehicle
from calib.signals.axle_signals import signals
from calib.statistics.intervals import Z95

Array = NDArray[np.float64]

INFLATION = 2.0
"""Factor on the formal sigma of a parameter, for the error of the model itself; see
tests/studies/naming.py."""

SYSTEMATIC = 0.015
"""Relative sigma of every parameter for common errors of all runs: air, geometry, sensors."""


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter: value and 95 % interval, in ``unit``."""

    value: float
    unit: str
    ci95: tuple[float, float]


@dataclass(frozen=True)
class Where:
    """Where an effect acts: the channel that shows it most, and the ranges of its action, SI."""

    channel: str
    axle: str
    pressure: tuple[float, float]
    speed: tuple[float, float]
    temperature: tuple[float, float] | None


@dataclass(frozen=True)
class Named:
    """An effect that was accepted, with its evidence.

    ``gain`` fall of the mean squared innovation that it brings on the calibration logs,
    ``gain_holdout`` on the hold-outs; ``runner_up`` the next best name and its gain;
    ``indistinguishable_from`` names that fit the data as well; ``separate_by`` the feasible test
    that would distinguish them.
    """

    name: str
    parameters: dict[str, ParameterEstimate]
    where: Where
    gain: float
    gain_holdout: float
    runner_up: tuple[str, float] | None
    indistinguishable_from: tuple[str, ...]
    separate_by: str


@dataclass(frozen=True)
class Diagnosis:
    """The whole answer.

    ``before`` and ``after`` are the hold-outs replayed open loop; ``not_resolved`` the effects that
    the calibration logs could not have shown at their usual size.
    """

    verdict: str
    effects: tuple[Named, ...]
    unexplained: UnexplainedTerm | None
    base: dict[str, ParameterEstimate]
    gap: Gap
    model_before: Model
    model_after: Model
    before: tuple[Log, ...]
    after: tuple[Log, ...]
    measured: tuple[Log, ...]
    reduced_before: float
    reduced_after: float
    not_resolved: tuple[str, ...] = ()

    def __repr__(self) -> str:
        lines = [f"Diagnosis: {self.verdict}"]
        for effect in self.effects:
            for name, p in effect.parameters.items():
                low, high = p.ci95
                interval = f"{p.value:.4g} {p.unit} (95 % {low:.4g} to {high:.4g})"
                lines.append(f"  {effect.name}: {name} = {interval}")
        lines.append(f"  gap on the hold-outs: {100.0 * self.gap.closed:.0f} % closed")
        return "\n".join(lines)


def diagnose(vehicle: Vehicle, calibration: list[Log], holdout: list[Log]) -> Diagnosis:
    """Find where a car and its model disagree, name the missing effect, and confirm it.

    Parameters
    ----------
    vehicle : the car as its datasheet has it.
    calibration : two or more logs of different manoeuvres, in which the effect is searched.
    holdout : one or more logs, on which the effect must close the gap.

    Returns
    -------
    The diagnosis. Its ``model_after`` is the car with the identified effects, for `calib.simulate`.

    Raises LogError when there is no hold-out, when a log is given twice, lacks ``v`` or is of
    another car, or when nothing in the logs is braked.

    >>> import calib
    >>> case = calib.sample_logs() / "hidden" / "case_0"
    >>> car = calib.read_vehicle(case / "vehicle.toml")
    >>> searched = [calib.read_log(case / f"calibration/{n}.parquet") for n in ("ramp", "coast")]
    >>> diagnosis = calib.diagnose(car, searched, [calib.read_log(case / "holdout/stop_a.parquet")])
    >>> [effect.name for effect in diagnosis.effects]
    ['aerodynamic_drag']
    >>> low, high = diagnosis.effects[0].parameters["drag_area"].ci95
    >>> low < 0.7444 < high  # m^2, the hidden value
    True
    """
    check_logs(calibration, holdout)
    for log in (*calibration, *holdout):
        require_same_wheels(vehicle, log, signals(log, vehicle))
    ordered = sorted(calibration, key=lambda log: log.digest)
    problem = problem_of(vehicle, [run_of(log) for log in ordered])
    decision = decide(problem, fit(problem, (), np.zeros(4)))
    held = held_out(problem, holdout)
    decision = confirm(decision, held)
    unexplained = None
    if decision.verdict == "unknown":
        unexplained = locate(problem, decision.base, held.runs)
    before = model_of(vehicle, decision.base)
    after = after_model(vehicle, decision, unexplained)
    first = tuple(replays(before, holdout))
    last = first if after == before else tuple(replays(after, holdout))
    gap = gap_of(first, last, holdout)
    if unexplained is not None and gap.closed <= 0.0:
        # a term that does not help on the hold-outs is left out of the model
        after, last, gap = before, first, gap_of(first, first, holdout)
    stands = decision.verdict in ("named", "ambiguous")
    return Diagnosis(
        verdict=decision.verdict,
        effects=named(problem, held, decision) if stands else (),
        unexplained=unexplained,
        base=base_estimates(decision.best if stands else decision.base),
        gap=gap,
        model_before=before,
        model_after=after,
        before=first,
        after=last,
        measured=tuple(holdout),
        reduced_before=decision.base.reduced,
        not_resolved=unresolved(problem, decision.best, DETECT),
        reduced_after=unexplained.at.reduced if unexplained else decision.best.reduced,
    )


def held_out(problem: Problem, logs: list[Log]) -> Problem:
    """The hold-outs as a problem, with the noise of the calibration."""
    nominal = base_of(problem.vehicle, np.zeros(4))
    runs = [turned_to_ripple(problem.vehicle, nominal, run_of(log), problem.noise) for log in logs]
    return Problem(problem.vehicle, tuple(runs), problem.noise)


def check_logs(calibration: list[Log], holdout: list[Log]) -> None:
    """Raise LogError for logs from which no diagnosis can be made."""
    if not holdout:
        raise LogError("no hold-out log", expected="--holdout LOG...", do="keep two stops back")
    if len(calibration) < 2:
        raise LogError(
            f"{len(calibration)} calibration log",
            expected="two or more that differ: a coast, a ramp, stops at other pressures and heats",
        )
    digests = [log.digest for log in calibration if log.digest]
    for log in calibration:
        if digests.count(log.digest) > 1:
            raise LogError("given twice", where=log.source, do="give each run once")
    for log in holdout:
        if log.digest in digests:
            raise LogError(
                "is among the calibration logs too", where=log.source, do="hold it out, or fit it"
            )
    if max(float(np.max(log["p_mc"])) for log in calibration) < 5e5:
        raise LogError(
            "nothing is braked in the calibration logs",
            expected="pressure above 5 bar in at least one",
        )


PROOF, BEYOND_DOUBT = 0.003, 0.02
"""Least gain on the hold-outs of an effect that the calibration shows, and of one that is faint."""

FELT, FELT_PART = 10.0, 0.02
"""Change of the sum of squares above which a hold-out shows the effect: three sigma, and a share of
the change in the hold-out that shows it most."""


def confirm(decision: Decision, held: Problem) -> Decision:
    """Withdraw an effect that does not help on the hold-outs, log by log.

    A log that does not show the effect is not counted. After a withdrawal the verdict is `no_gap`
    only if neither the calibration logs nor the hold-outs have a gap without the effect.
    """
    if decision.faint is not None and second_shown(decision.faint, held):
        return without_refuted(decision.faint, held)
    if not decision.best.names:
        return decision
    fall = chi2_by_run(held, decision.base) - chi2_by_run(held, decision.best)
    count = count_of(held, decision.base)
    detected = gain(decision.base, decision.best) >= DETECT
    if np.sum(fall) / count > (PROOF if detected else BEYOND_DOUBT) and helps(fall):
        return without_refuted(decision, held)
    left = max(float(np.sum(chi2_by_run(held, decision.base))) / count, decision.base.reduced)
    verdict = "no_gap" if left < STRANGE else "unknown"
    return replace(decision, verdict=verdict, best=decision.base)


def without_refuted(decision: Decision, held: Problem) -> Decision:
    """Drop rivals that the hold-outs refute; an ambiguous effect may then become a named one."""
    count = count_of(held, decision.base)
    own = float(np.sum(chi2_by_run(held, decision.best)))
    refuted = [
        rival
        for rival in confusable(decision.best, decision.rivals)
        if float(np.sum(chi2_by_run(held, rival))) - own > BEYOND_DOUBT * count
    ]
    rivals = tuple(c for c in decision.rivals if all(c is not r for r in refuted))
    verdict = decision.verdict
    if verdict == "ambiguous" and not confusable(decision.best, rivals):
        verdict = "named"
    return replace(decision, verdict=verdict, rivals=rivals)


def helps(fall: Array) -> bool:
    """Whether most of the hold-outs (n,) that show an effect are explained better with it."""
    felt = fall[np.abs(fall) > max(FELT, FELT_PART * float(np.max(np.abs(fall))))]
    return bool(np.mean(felt > 0.0) > 0.5) if felt.size else False


SECOND_PROOF, SECOND_PART = 0.05, 0.01
"""Least gain on the hold-outs of a faint second effect, and its least share of the first's gain: if
the form of the first is not exact, any second effect takes half a percent of its gain."""


def second_shown(pair: Decision, held: Problem) -> bool:
    """Whether the hold-outs show a second effect clearly, and it explains most of the rest."""
    assert pair.first is not None
    count = count_of(held, pair.base)
    none, first, both = (chi2_by_run(held, c) / count for c in (pair.base, pair.first, pair.best))
    fall = first - both
    gained = float(np.sum(fall))
    return bool(
        gained > SECOND_PROOF
        and gained > SECOND_PART * float(np.sum(none - first))
        and gained > SECOND_SHARE * (float(np.sum(first)) - FLOOR)
        and helps(fall * count)
    )


def chi2_by_run(problem: Problem, candidate: Candidate) -> Array:
    """Sum of squared innovations of every run."""
    parts = problem.whitened(candidate.base, candidate.effects)
    return np.array([sum(float(c @ c) for c in run) for run in parts])


def count_of(problem: Problem, candidate: Candidate) -> int:
    """Number of innovations of a candidate in a problem."""
    return sum(c.size for run in problem.whitened(candidate.base, Effects()) for c in run)


def named(problem: Problem, held: Problem, decision: Decision) -> tuple[Named, ...]:
    """Every effect of the best explanation, with evidence."""
    best, sigma = decision.best, standard_errors(decision.best)
    like = confusable(best, decision.rivals)
    held_gain = chi2_by_run(held, decision.base).sum() - chi2_by_run(held, best).sum()
    out, i = [], 4
    for name in best.names:
        parameters = {}
        for p in effect_named(name).card.parameters:
            value = best.effects.parameters[name][p.name]
            spread = Z95 * float(np.hypot(sigma[i] * p.spread, SYSTEMATIC * value))
            parameters[p.name] = ParameterEstimate(value, p.unit, (value - spread, value + spread))
            i += 1
        others = sorted({n for c in like for n in c.names} - set(best.names))
        runner = next((c for c in decision.rivals if name not in c.names), None)
        out.append(
            Named(
                name=name,
                parameters=parameters,
                where=where_of(problem, best, name),
                gain=gain_without(problem, best, name),
                gain_holdout=float(held_gain / count_of(held, best)),
                runner_up=None
                if runner is None
                else (" + ".join(runner.names), gain(decision.base, runner)),
                indistinguishable_from=tuple(others),
                separate_by=separate_by(problem, best, like[0]) if like else "",
            )
        )
    return tuple(out)


def standard_errors(candidate: Candidate) -> Array:
    """Sigma of a candidate's vector, the error of the model itself included."""
    formal = np.sqrt(np.maximum(np.diag(candidate.covariance), 0.0))
    return np.asarray(INFLATION * np.sqrt(max(candidate.reduced, 1.0)) * formal)


def gain_without(problem: Problem, best: Candidate, name: str) -> float:
    """Rise of the mean squared innovation when the effect is removed."""
    innovations = problem.flat(best.base, best.effects.without(name))
    return float(innovations @ innovations) / best.count - best.reduced


def where_of(problem: Problem, best: Candidate, name: str) -> Where:
    """The channel and the ranges in which removing the effect changes the innovations most."""
    rest = best.effects.without(name)
    power = np.zeros(len(CHANNELS))
    rows = []
    for run in problem.runs:
        change = _change(problem, best, rest, run)
        power += np.sum(change**2, axis=1)
        drivers = [run.p_mc, run.v_smooth]
        drivers.append(np.zeros_like(run.v) if run.temperature_f is None else run.temperature_f)
        along = [thinned(run, d)[-change.shape[1] :] for d in drivers]
        rows.append(np.vstack([np.sum(change**2, axis=0), *along]))
    weight, p, v, heat = np.hstack(rows)
    warm = all(run.temperature_f is not None for run in problem.runs)
    strongest = CHANNELS[int(np.argmax(power))]
    return Where(
        channel=strongest,
        axle=_axle(problem, best, name),
        pressure=_range(p, weight),
        speed=_range(v, weight),
        temperature=_range(heat, weight) if warm else None,
    )


def _change(problem: Problem, best: Candidate, rest: Effects, run: ObservedRun) -> Array:
    """Change of the whitened channels (6, m) of a run when an effect is removed; common length."""
    parts = [
        whiten(residuals(run, predict(problem.vehicle, best.base, effects, run)), problem.noise)
        for effects in (best.effects, rest)
    ]
    m = min(c.size for c in parts[0])
    return np.stack([b[-m:] - a[-m:] for a, b in zip(*parts, strict=True)])


def _axle(problem: Problem, best: Candidate, name: str) -> str:
    """Whose torque or wheels an effect changes: front, rear, both, or body."""
    if not acts_on_wheels(effect_named(name)):
        return "body"
    rest = best.effects.without(name)
    front = rear = 0.0
    for run in problem.runs:
        a, b = (predict(problem.vehicle, best.base, e, run) for e in (best.effects, rest))
        front += float(np.sum((a.omega[:2] - b.omega[:2]) ** 2))
        rear += float(np.sum((a.omega[2:] - b.omega[2:]) ** 2))
    if front + rear < 1e-9:
        return "body"
    if min(front, rear) > 0.2 * max(front, rear):
        return "both"
    return "front" if front > rear else "rear"


def _range(driver: Array, weight: Array) -> tuple[float, float]:
    """The range of a driver that holds the middle 80 % of the weight."""
    order = np.argsort(driver)
    share = np.cumsum(weight[order]) / max(float(np.sum(weight)), 1e-12)
    low, high = np.searchsorted(share, [0.1, 0.9])
    last = driver.size - 1
    return float(driver[order[min(low, last)]]), float(driver[order[min(high, last)]])


def base_estimates(candidate: Candidate) -> dict[str, ParameterEstimate]:
    """Base parameters with intervals."""
    sigma = standard_errors(candidate)
    b = candidate.base
    values = {
        "pad_friction_f": b.pad_friction_f,
        "pad_friction_r": b.pad_friction_r,
        "tyre_stiffness": b.stiffness,
        "tyre_peak": b.peak,
    }
    out = {}
    for i, (name, value) in enumerate(values.items()):
        factor = float(np.exp(Z95 * np.hypot(sigma[i], 0.005)))
        out[name] = ParameterEstimate(value, "1", (value / factor, value * factor))
    return out


def model_of(vehicle: Vehicle, candidate: Candidate) -> Model:
    """A candidate as a model that can be simulated."""
    b = candidate.base
    return Model(
        vehicle=vehicle,
        pad_friction_f=b.pad_friction_f,
        pad_friction_r=b.pad_friction_r,
        tyre=MagicFormula(b.stiffness, b.peak, SHAPE),
        effects=candidate.effects,
        surfaces=(),
    )


def after_model(vehicle: Vehicle, decision: Decision, unexplained: UnexplainedTerm | None) -> Model:
    """The vehicle as a model with the accepted effects, and the empirical term if there is one."""
    if unexplained is None:
        return model_of(vehicle, decision.best)
    model = model_of(vehicle, unexplained.at)
    return replace(model, effects=replace(model.effects, terms=(unexplained.term,)))
