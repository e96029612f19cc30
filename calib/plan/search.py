"""Search a sequence of measures, where each next measure gains most for the time that it takes.

    gain = sum over front, rear, total torque of ln(half width before / half width after)

A width below the wanted one counts as the wanted one. The first measure is the ramp with the
greatest mean gain over several cars, each with its own noise. Each next measure has the greatest
gain per second for the mean car. A measure that gained next to nothing is not tried again, since
gains diminish with every measure. The widths of a plan are medians over several cars. Its floors
show what more measures could bring: the widths of the mean car after the plan and all other
possible measures, but without further ramps of both axles.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from calib.base.errors import BrakeCalError, LogError, ModelError
from calib.base.processes import MapFunction, parallel_map
from calib.plan.achieved import HalfWidths
from calib.plan.expected import Prior, before_any_run, cars, half_widths
from calib.plan.measure import Measure, drive, measures

SEED = 20  # seed of the noise of a plan: the same question has the same plan
_CARS = 3  # cars of a median, each with its own noise
_TURN = 20.0  # time to turn and to come back up to speed before another run [s]
_WORTH = 0.02  # gain below which a measure is not worth its time [1]: 2 % of one width

_Sequence = tuple[Measure, ...]  # measures in the order in which they are done


class Want(NamedTuple):
    """The half widths that a plan is to reach, and the time for it."""

    widths: HalfWidths = HalfWidths()  # 0 where none is wanted
    seconds: float = math.inf  # time to spend [s]

    def met_by(self, widths: HalfWidths) -> bool:
        """Whether the widths are as narrow as wanted; False if none is wanted."""
        pairs = zip(widths, self.widths, strict=True)
        return any(self.widths) and all(width <= goal for width, goal in pairs if goal)

    def gain(self, wide: HalfWidths, narrow: HalfWidths) -> float:
        """Return the gain from ``wide`` to ``narrow`` [1], over all widths if none is wanted."""
        gain = 0.0
        for width, narrower, goal in zip(wide, narrow, self.widths, strict=True):
            if goal > 0.0 or not any(self.widths):
                gain += math.log(max(width, goal) / max(narrower, goal))
        return gain


@dataclass(frozen=True)
class Step:
    """A measure of a plan."""

    measure: Measure
    seconds: float  # that it takes [s]
    widths: HalfWidths  # after the measure


@dataclass(frozen=True)
class Plan:
    """The steps to do, and the widths that they will bring."""

    prior: Prior
    want: Want
    start: HalfWidths  # before any step
    steps: tuple[Step, ...]  # in their order
    not_worth: dict[Measure, float]  # gains [1] when last tried, if below `_WORTH`
    impossible: dict[Measure, str]  # why measures cannot be done here
    floor: HalfWidths  # after every measure that can be done here, whatever its time
    floor_of_runs: HalfWidths  # after every run that can be done here
    with_speed: HalfWidths | None  # after the steps if `v` were logged; None if it is logged

    @property
    def after(self) -> HalfWidths:
        """The widths at the end of the plan."""
        return self.steps[-1].widths if self.steps else self.start

    @property
    def seconds(self) -> float:
        """The time that the plan takes [s]."""
        return sum(step.seconds for step in self.steps)


def plan(prior: Prior, want: Want, workers: int = 1) -> Plan:
    """Find a plan, the same for any number of ``workers``. Raises LogError without a ramp."""
    with parallel_map(workers, "calib.plan.search") as in_parallel:
        medians = partial(_medians, in_parallel)
        # before any measure, a fit has the earlier logs alone
        start = medians(prior, [()], 1)[0] if prior.logs else before_any_run(prior)
        search = _Search(prior, want, in_parallel)
        chosen = search.run(start)
        beginnings = [chosen[: i + 1] for i in range(len(chosen))]
        widths = medians(prior, beginnings, _CARS)
        others = [m for m in measures() if m not in search.impossible and not m.is_whole_ramp]
        everything = tuple(dict.fromkeys((*chosen, *others)))
        runs = tuple(measure for measure in everything if measure.driven)
        floor, floor_of_runs = medians(prior, [everything, runs], 1)
        with_speed = None
        if "v" not in prior.sensors:
            has_speed = replace(prior, sensors=prior.sensors | {"v"})
            with_speed = medians(has_speed, [chosen], _CARS)[0]
    not_worth = {m: gain for m, gain in search.gains.items() if m not in chosen and gain < _WORTH}
    return Plan(
        prior=prior,
        want=want,
        start=start,
        steps=tuple(map(Step, chosen, _times(chosen), widths)),
        not_worth=not_worth,
        impossible=search.impossible,
        floor=floor,
        floor_of_runs=floor_of_runs,
        with_speed=with_speed,
    )


def _times(sequence: _Sequence) -> list[float]:
    """Return the time of each measure [s], with the turn before each run but the first measure."""
    times = [measure.duration for measure in sequence[:1]]
    return times + [_time_after_another(measure) for measure in sequence[1:]]


def _time_after_another(measure: Measure) -> float:
    """Return the time of a measure that is not the first [s]: the car turns before a run."""
    return measure.duration + _TURN if measure.driven else measure.duration


class _Search:
    """The greedy search: gains of the measures that were tried, and why others are impossible."""

    def __init__(self, prior: Prior, want: Want, in_parallel: MapFunction) -> None:
        self.prior, self.want, self.in_parallel = prior, want, in_parallel
        self.gains: dict[Measure, float] = {}
        reasons = {measure: _why_not_driven(prior, measure) for measure in measures()}
        self.impossible = {measure: reason for measure, reason in reasons.items() if reason}

    def run(self, widths: HalfWidths) -> _Sequence:
        """Return the sequence found from the first ``widths``. Raises LogError without a ramp."""
        chosen: _Sequence = ()
        while not self.want.met_by(widths):
            is_first = not (chosen or self.prior.logs)
            widths_after = self._try(chosen, widths, is_first)
            if not widths_after and is_first:
                reasons = "; ".join(dict.fromkeys(self.impossible.values()))
                flaw = f"no ramp can be driven here: {reasons or 'none is short enough'}"
                where, expected = self.prior.vehicle.name, "a ramp of 7 s from 60 km/h or more"
                do = "give a longer track, a higher speed or more time"
                raise LogError(flaw, where=where, expected=expected, do=do)
            if not widths_after:
                break
            rates = {m: self.gains[m] / _time_after_another(m) for m in widths_after}
            ranking = self.gains if is_first else rates
            best = max(widths_after, key=ranking.__getitem__)
            chosen, widths = (*chosen, best), widths_after[best]
        return self._pruned(chosen, widths)

    def _try(
        self, chosen: _Sequence, widths: HalfWidths, is_first: bool
    ) -> dict[Measure, HalfWidths]:
        """Return the widths after each measure that can come next and is worth its time.

        Set the gain of each measure that was tried, or the reason why it is impossible. The first
        measure is a ramp with both axles; its gain and its widths are of several cars.
        """
        options = [
            measure
            for measure in measures()
            if measure not in (*chosen, *self.impossible)
            and (measure.is_whole_ramp or not is_first)
            and self.gains.get(measure, _WORTH) >= _WORTH  # not tried yet, or worth its time
            and sum(_times((*chosen, measure))) <= self.want.seconds
        ]
        sequences = [(*chosen, measure) for measure in options]
        count = _CARS if is_first else 1
        outcomes = _outcomes(self.in_parallel, self.prior, sequences, count)
        widths_after = {}
        for measure, (reason, by_car) in zip(options, outcomes, strict=True):
            if reason:
                self.impossible[measure] = reason
                continue
            self.gains[measure] = sum(self.want.gain(widths, narrow) for narrow in by_car) / count
            if is_first or self.gains[measure] >= _WORTH:
                widths_after[measure] = _median(by_car)
        return widths_after

    def _pruned(self, chosen: _Sequence, widths: HalfWidths) -> _Sequence:
        """Return the sequence without measures that later ones made superfluous.

        ``widths`` are those after the whole sequence. The longest measure is left out first.
        """
        fixed = 0 if self.prior.logs else 1  # the first ramp makes the table
        by_time = sorted(chosen[fixed:], key=_time_after_another, reverse=True)
        shorter = [tuple(m for m in chosen if m != left_out) for left_out in by_time]
        outcomes = _outcomes(self.in_parallel, self.prior, shorter, 1)
        for sequence, (_, by_car) in zip(shorter, outcomes, strict=True):
            (wider,) = by_car
            if self.want.met_by(wider) or self.want.gain(wider, widths) < _WORTH:
                return self._pruned(sequence, widths)
        return chosen


def _why_not_driven(prior: Prior, measure: Measure) -> str:
    """Return why the mean car cannot drive a measure here; "" if it can."""
    try:
        if measure.driven:
            drive(cars(prior, 1)[0], measure, prior.track, prior.sensors)
    except ModelError as error:
        return error.problem
    return ""


def _medians(
    in_parallel: MapFunction, prior: Prior, sequences: Sequence[_Sequence], count: int
) -> list[HalfWidths]:
    """Return the median widths over ``count`` cars after each sequence. Raises LogError."""
    medians = []
    for reason, widths in _outcomes(in_parallel, prior, sequences, count):
        if reason:
            raise LogError(reason, where=prior.vehicle.name)
        medians.append(_median(widths))
    return medians


def _median(widths: Sequence[HalfWidths]) -> HalfWidths:
    return HalfWidths(*np.median(np.array(widths), axis=0).tolist())


def _outcomes(
    in_parallel: MapFunction, prior: Prior, sequences: Sequence[_Sequence], count: int
) -> Iterator[tuple[str, list[HalfWidths]]]:
    """Yield, for each sequence, why it cannot be done or "", and the widths of ``count`` cars."""
    cases = [(number, sequence) for sequence in sequences for number in range(count)]
    outcomes = list(in_parallel(partial(_outcome, prior), cases))
    for i in range(0, len(outcomes), count):
        by_car = outcomes[i : i + count]
        reason = next((reason for reason, _ in by_car if reason), "")
        yield reason, [widths for _, widths in by_car]


def _outcome(prior: Prior, case: tuple[int, _Sequence]) -> tuple[str, HalfWidths]:
    """Return "" and the widths of one car, given by its number in `cars`, after a sequence.

    If the sequence cannot be done, return the reason and infinite widths.
    """
    number, sequence = case
    try:
        return "", half_widths(prior, cars(prior)[number], sequence, SEED + 100 * number)
    except BrakeCalError as error:
        return error.problem, HalfWidths(math.inf, math.inf, math.inf)
