"""The diagnosis of a car: find the gap, name its cause, add it, measure the gap on hold-outs.

calibration logs ──> problem ──> decide ───────────> (something left: locate) ──> model
hold-out logs ────────────────── confirm ──> prove ─────────────────────────────── replays, gap
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import ModelError
from calib.base.processes import Mapped, one_blas_thread
from calib.base.units import behind
from calib.base.warning import PlausibilityWarning
from calib.car.effects.effect import acts_on_wheels, slows
from calib.car.effects.effects import Effects
from calib.car.model import Model
from calib.car.own_effects.own_effect import definition
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.agreement import half_widths
from calib.diagnosis.explanation.base import BASE, Ground
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.channels import CHANNELS, ChannelNoise, residuals, thinned, whiten
from calib.diagnosis.explanation.predict import ObservedRun, predict, run_of
from calib.diagnosis.explanation.problem import Problem, problem_of
from calib.diagnosis.explanation.progress import Tell, silent
from calib.diagnosis.explanation.vector import bounds
from calib.diagnosis.proof.confirm import confirm
from calib.diagnosis.proof.gap import Gap, gap_of
from calib.diagnosis.proof.hold_outs import HoldOuts, hold_outs_of, model_of
from calib.diagnosis.proof.prove import Proved, SearchStep, Withdrawn, prove
from calib.diagnosis.proof.remainder import Remainder, range_of
from calib.diagnosis.proof.unexplained import UnexplainedTerm, place_of_rest
from calib.diagnosis.runs.gates import (
    require_enough,
    require_own_pressure,
    require_right_channels,
    require_whole_wheel_speeds,
)
from calib.diagnosis.runs.judged import judged_logs
from calib.diagnosis.runs.sides import LARGEST, with_even_sides
from calib.diagnosis.runs.warnings import log_warnings, unexplained_warnings
from calib.diagnosis.search.axles import require_axles
from calib.diagnosis.search.clocks import with_clocks
from calib.diagnosis.search.decide import Decision, confusable, explains, gain
from calib.diagnosis.search.groups import LogGroup, groups_of
from calib.diagnosis.search.heats import start_heats_of, with_start_heats
from calib.diagnosis.search.offsets import LogOffsets, decided_with_offsets, offsets_of
from calib.diagnosis.search.own_pads import follow_a_driver, own_pads_of, with_own_pads
from calib.diagnosis.search.radii import with_free_radii
from calib.diagnosis.search.regroup import regrouped
from calib.diagnosis.search.search import unresolved
from calib.diagnosis.undecided.confusion import Confusion, confusion_of
from calib.diagnosis.undecided.doubts import base_half_widths
from calib.diagnosis.undecided.drives import ShowingDrive, drives
from calib.logs.log import Log
from calib.plausibility.run import wrong_speed
from calib.run.copies import without_holds
from calib.run.gates import refuse_copies

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter: value and 95 % interval, cut at what the parameter can be, in ``unit``."""

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

    ``gain`` rise of the mean squared innovation of the calibration logs without it, all else
    unchanged, ``gain_holdout`` of the hold-outs; ``runner_up`` the next best name and its gain;
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
    the calibration logs could not have shown at their usual size, and ``drives`` for each of them
    the manoeuvre that shows it most. ``confusion`` is the set of explanations that the logs cannot
    tell apart, None where there is one alone. ``unexplained`` describes what is left, beside
    "unknown" or beside effects, None where nothing significant is left; ``left`` is its size in the
    replays; ``sides`` by how much the right wheel of an axle rolled faster than the left one before
    that was taken out [1], by axle; ``groups`` the logs by pads and road, the reference first,
    where one set of parameters does not serve all; ``start_heats`` of the discs [degC] by log,
    where fade is named and no temperature is logged; ``offsets`` the slope of the road or the zero
    of a_x that each log has of its own, None where they have none; ``own_pads`` the factors on pads
    and tyres of each log, empty where those of its group serve; ``withdrawn`` what fits the
    calibration logs and not the hold-outs; ``steps`` the course of the search; ``noise`` that of
    the evidence, and its source; ``warnings`` what speaks against the logs and is not explained.
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
    left: Remainder
    withdrawn: tuple[Withdrawn, ...]
    steps: tuple[SearchStep, ...]
    noise: ChannelNoise
    groups: tuple[LogGroup, ...]
    start_heats: Mapping[str, tuple[float, float]]
    offsets: LogOffsets | None
    own_pads: Mapping[str, Ground]
    not_resolved: tuple[str, ...]
    drives: tuple[ShowingDrive, ...]
    confusion: Confusion | None
    sides: Mapping[str, float]
    warnings: tuple[PlausibilityWarning, ...]

    def __repr__(self) -> str:
        lines = [f"Diagnosis: {self.verdict}"]
        for effect in self.effects:
            for name, p in effect.parameters.items():
                low, high = p.ci95
                interval = f"{p.value:.4g}{behind(p.unit)} (95 % {low:.4g} to {high:.4g})"
                lines.append(f"  {effect.name}: {name} = {interval}")
        if self.effects and self.unexplained is not None:
            lines.append(f"  and something else: {self.left.size:.1f} times the noise is left")
        lines.append(f"  gap on the hold-outs: {100.0 * self.gap.closed:.0f} % closed")
        return "\n".join(lines)


@one_blas_thread()
def diagnose(
    vehicle: Vehicle,
    calibration: list[Log],
    holdout: list[Log],
    tell: Tell = silent,
    mapped: Mapped = map,
) -> Diagnosis:
    """Find where a car and its model disagree, name the missing effect, and confirm it.

    Parameters
    ----------
    vehicle : the car as its datasheet has it; it may have effects that the catalogue lacks, see
        `calib.car.own_effects.own_effect.with_own`.
    calibration : two or more logs of different manoeuvres, in which the effect is searched.
    holdout : one or more logs, on which the effect must close the gap.
    tell : called at each step with the stage in words, the steps of it that are done, and their
        number.
    mapped : carries out independent pieces of work, see `calib.base.processes.side_by_side`.
        Effects of one's own, which other processes do not know, are tried in this one.

    Returns
    -------
    The diagnosis. Its ``model_after`` is the car with the identified effects, for `calib.simulate`.
    Left and right wheel speeds are made even where nothing brakes (`calib.diagnosis.runs.sides`).

    Raises LogError when there is no hold-out, when nothing in the logs is braked, and for a log
    that looks like a mistake: a run that is given twice, also as a copy; one whose channels `check`
    calls wrong; one of another car; wheel speeds that are swapped; a pressure of another run.

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
    tell("checking the logs", 0, 1)
    warnings = checked(vehicle, calibration, holdout)
    sides, proved = _proved(vehicle, calibration, holdout, tell, mapped)
    held, decision = proved.held, proved.decision
    problem, holdout = decision.base.problem, list(held.logs)
    stands = decision.verdict in ("named", "ambiguous")
    left_of = decision.best if stands else decision.base
    unexplained = proved.placed
    if unexplained is None and proved.rest:
        unexplained = place_of_rest(left_of, held)
    tell("asking what these logs could not show", 0, 1)
    not_resolved = unresolved(decision.best, decision.least_shown)
    like = confusable(decision.best, decision.rivals) if stands else []
    confusion = confusion_of(problem, decision.best, like)
    before = model_of(vehicle, decision.base)
    after, last = model_of(vehicle, left_of), proved.after
    at = decision.best
    if unexplained is not None and not unexplained.on_hold_outs and not stands:
        after, last = with_term(before, unexplained, proved.before, held)
        at = unexplained.at
    groups = groups_of((*problem.runs, *held.problem.runs))
    own_pads = own_pads_of((problem, held.problem), left_of.base, left_of.effects)
    return Diagnosis(
        verdict=decision.verdict,
        effects=named(problem, held.problem, decision, confusion) if stands else (),
        unexplained=unexplained,
        base=_base_estimates(left_of, not_resolved),
        gap=gap_of(proved.before, last, holdout),
        model_before=before,
        model_after=after,
        before=proved.before,
        after=last,
        measured=tuple(holdout),
        reduced_before=decision.base.reduced,
        groups=groups,
        start_heats=start_heats_of((*problem.runs, *held.problem.runs)),
        offsets=offsets_of((problem, held.problem), left_of.base, left_of.effects),
        own_pads=own_pads,
        not_resolved=not_resolved,
        drives=drives(problem, decision.best, not_resolved),
        confusion=confusion,
        reduced_after=at.reduced,
        left=proved.left,
        withdrawn=proved.withdrawn,
        steps=proved.steps,
        noise=problem.noise,
        sides=sides,
        warnings=unexplained_warnings(
            warnings, left=unexplained is not None, grouped=bool(groups) or bool(own_pads)
        ),
    )


def checked(
    vehicle: Vehicle, calibration: list[Log], holdout: list[Log]
) -> tuple[PlausibilityWarning, ...]:
    """What speaks against the logs; raises LogError for a mistake that must not be searched in."""
    logs = [*calibration, *holdout]
    require_enough(calibration, holdout)
    refuse_copies(calibration, holdout)
    require_right_channels(vehicle, logs)
    judged = judged_logs(vehicle, logs)
    require_axles(vehicle, logs, judged)
    require_own_pressure(judged)
    warnings = log_warnings(judged)
    if (wrong := wrong_speed(warnings)) is not None:
        raise wrong
    require_whole_wheel_speeds(warnings)
    return warnings


def _proved(
    vehicle: Vehicle, calibration: list[Log], holdout: list[Log], tell: Tell, mapped: Mapped
) -> tuple[dict[str, float], Proved]:
    """How the sides of each axle differed [1] before they were made even, and what is proved then.

    A difference that tyres of one age do not make is made even if nothing that slows the car is
    missing then: it is no brake that drags.
    """
    given = [*sorted(calibration, key=lambda log: log.digest), *holdout]
    logs = [without_holds(log) for log in given]

    def proved(evened: list[Log]) -> Proved:
        return _searched(
            vehicle, evened[: len(calibration)], evened[len(calibration) :], tell, mapped
        )

    usual, sides = with_even_sides(logs)
    unlike, all_sides = with_even_sides(logs, LARGEST)
    if sides != all_sides:
        found = proved(unlike)
        if _rolls_freely(found):
            return all_sides, found
    return sides, proved(usual)


def _rolls_freely(found: Proved) -> bool:
    """Whether nothing is left, and nothing named slows the car."""
    best = found.decision.best
    known = best.problem.vehicle.effects
    slowed = any(slows(definition(known, name)) for name in best.names)
    return _whole(found) and not slowed


def _searched(
    vehicle: Vehicle, calibration: list[Log], holdout: list[Log], tell: Tell, mapped: Mapped
) -> Proved:
    """The explanation of the calibration logs, as far as it holds on the hold-outs."""
    tell("fitting the model without effects", 0, 1)
    known_to_all = map if vehicle.effects.own else mapped
    problem = problem_of(vehicle, [run_of(log) for log in calibration], tell, known_to_all)
    found = _proved_from(problem, holdout)
    if _whole(found):
        return found
    own = with_own_pads(found.decision)
    other = None if own is None else _proved_from(own, holdout)
    if other is None or not _whole(other) or follow_a_driver(other.decision.best):
        return found
    return other


def _proved_from(problem: Problem, holdout: list[Log]) -> Proved:
    decision = decided_with_offsets(problem, [run_of(log) for log in holdout])
    decision = by_log(with_clocks(with_free_radii(decision)))
    held = hold_outs_of(decision.best, holdout)
    return prove(held, confirm(decision, held.problem))


def _whole(found: Proved) -> bool:
    """Whether nothing is left to explain."""
    return found.decision.verdict != "unknown" and not found.rest


def by_log(decision: Decision) -> Decision:
    """The decision with what differs from log to log, pads and road or the discs' first heat.

    Only where nothing explains the logs without, a faint second effect neither: the better one of
    the two.
    """
    if decision.faint is not None and explains(decision.faint):
        return decision
    found = (regrouped(decision), with_start_heats(decision))
    return min(found, key=lambda other: (not explains(other), other.best.reduced))


def with_term(
    before: Model, unexplained: UnexplainedTerm, replayed: tuple[Log, ...], held: HoldOuts
) -> tuple[Model, tuple[Log, ...]]:
    """The model with an empirical term, and its replays; without it where it does not help."""
    model = model_of(before.vehicle, unexplained.at)
    model = replace(model, effects=replace(model.effects, terms=(unexplained.term,)))
    try:
        last = held.replays(unexplained.at.base, model.effects)
    except ModelError:  # such a term need not have an equilibrium
        return before, replayed
    helped = gap_of(replayed, last, held.logs).closed > 0.0
    return (model, last) if helped else (before, replayed)


def named(
    problem: Problem, held: Problem, decision: Decision, confusion: Confusion | None
) -> tuple[Named, ...]:
    """Every effect of the best explanation, with evidence; ``confusion`` with those like it."""
    best, half = decision.best, half_widths(decision.best)
    nearest = None if confusion is None else confusion.pair(0, 1)
    separate = "" if nearest is None else f"{nearest.drive} ({nearest.sigma:.0f} sigma apart)"
    like = confusable(best, decision.rivals)
    held_chi2 = held.chi2(best.base, best.effects)
    out = []
    for name, own in problem.places(best.names).items():
        parameters = {}
        card = definition(problem.vehicle.effects, name).card
        for p, width in zip(card.parameters, half[own], strict=True):
            found = best.effects.parameters[name][p.name]
            value = min(max(found, p.low), p.high)  # bounds of a fit are a trifle wider
            spread = float(width * p.spread)
            ends = (max(value - spread, p.low), min(value + spread, p.high))
            parameters[p.name] = ParameterEstimate(value, p.unit, ends)
        others = sorted({n for c in like for n in c.names} - set(best.names))
        runner = next((c for c in decision.rivals if name not in c.names), None)
        out.append(
            Named(
                name=name,
                parameters=parameters,
                where=_where_of(problem, best, name),
                gain=_gain_without(problem, best, name, best.chi2),
                gain_holdout=_gain_without(held, best, name, held_chi2),
                runner_up=None
                if runner is None
                else (" + ".join(runner.names), gain(decision.base, runner)),
                indistinguishable_from=tuple(others),
                separate_by=separate,
            )
        )
    return tuple(out)


def _gain_without(problem: Problem, best: Candidate, name: str, chi2: float) -> float:
    """Rise of the mean squared innovation of a problem's runs when the effect is removed.

    ``chi2`` sum of the squared innovations with it.
    """
    innovations = problem.flat(best.base, best.without(name))
    return (float(innovations @ innovations) - chi2) / innovations.size


def _where_of(problem: Problem, best: Candidate, name: str) -> Where:
    """The channel and the ranges in which removing the effect changes the innovations most."""
    rest = best.without(name)
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
        pressure=range_of(p, weight),
        speed=range_of(v, weight),
        temperature=range_of(heat, weight) if warm else None,
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
    if not acts_on_wheels(definition(problem.vehicle.effects, name)):
        return "body"
    rest = best.without(name)
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


def _base_estimates(candidate: Candidate, unseen: Sequence[str]) -> dict[str, ParameterEstimate]:
    """Base parameters with intervals; ``rolling_radius`` over that of the file where it is free.

    ``unseen`` are the effects that the logs could not have shown. An interval is cut at what the
    fit allows: pads of half and double the file's, a tyre of a seventh and seven times a usual one.
    """
    half = base_half_widths(candidate, unseen)
    b = candidate.base
    values = {
        "pad_friction_f": b.pad_friction_f,
        "pad_friction_r": b.pad_friction_r,
        "tyre_stiffness": b.stiffness,
        "tyre_peak": b.peak,
    }
    place = {name: i for i, name in enumerate(values)}
    if candidate.problem.free_radius:
        values["rolling_radius"], place["rolling_radius"] = b.radius, BASE
    low, high = bounds(candidate.problem, candidate.names)
    out = {}
    for name, value in values.items():
        at, i = candidate.x[place[name]], place[name]
        ends = np.clip((at - half[i], at + half[i]), low[i], high[i])
        lower, upper = (value * float(np.exp(end - at)) for end in ends)
        out[name] = ParameterEstimate(value, "1", (lower, upper))
    return out
