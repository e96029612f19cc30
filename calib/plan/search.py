"""The best sequence of measures: each next one narrows the bounds most for its time.

    gain = sum over front, rear, total of ln(width now / width then), a width as wanted is enough

The first ramp is the one of the greatest mean gain over several cars, each with its own noise. Each
next measure is that of the greatest gain per second of one car, the mean of what is prior. What
gained next to nothing is not tried again: what measures tell together is less than the sum of what
each tells. The figures of the steps are medians over several cars, floors those of one.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from calib.base.errors import BrakeCalError, LogError, ModelError
from calib.base.processes import Mapped, side_by_side
from calib.plan.expected import (
    HalfWidths,
    Prior,
    before_any_run,
    cars,
    half_widths,
    median,
)
from calib.plan.measure import LEAD_IN, Measure, drive, measures

SEED = 20
"""Seed of the noise of a plan: the same question has the same plan."""

_CARS = 3
"""Cars, each with its own noise, over which a figure is the median."""

_TURN = 20.0
"""Time [s] to turn and to come back up to speed before another run."""

_WORTH = 0.02
"""Gain [1] below which a measure is not worth its time: 2 % of one width."""

_Sequel = tuple[Measure, ...]
"""Measures in the order in which they are done."""


@dataclass(frozen=True)
class Want:
    """Half widths that are narrow enough [1], 0 where none is named; ``seconds`` to spend."""

    front: float = 0.0
    rear: float = 0.0
    total: float = 0.0
    seconds: float = math.inf

    @property
    def widths(self) -> HalfWidths:
        """The half widths that are wanted."""
        return HalfWidths(self.front, self.rear, self.total)

    def met_by(self, widths: HalfWidths) -> bool:
        """Whether the widths are as narrow as wanted; never where none is named."""
        pairs = zip(widths, self.widths, strict=True)
        return any(self.widths) and all(width <= goal for width, goal in pairs if goal)

    def gain(self, now: HalfWidths, then: HalfWidths) -> float:
        """What is gained from one set of widths to the next [1]."""
        counts = [goal > 0.0 or not any(self.widths) for goal in self.widths]
        rows = zip(now, then, self.widths, counts, strict=True)
        return sum(math.log(max(a, goal) / max(b, goal)) for a, b, goal, used in rows if used)


@dataclass(frozen=True)
class Step:
    """A measure of a plan: it takes ``seconds``; ``widths`` after it and all before it."""

    measure: Measure
    seconds: float
    widths: HalfWidths


@dataclass(frozen=True)
class Plan:
    """What to do, in this order, and what it will bring.

    ``before`` the widths by what is prior now; ``not_worth`` the measures that would gain less than
    `_WORTH` beside the steps, each with its gain [1]; ``impossible`` those that cannot be done
    here, each with the reason; ``floor`` the widths after all that can be done here, whatever its
    time, ``floor_of_runs`` after all runs without a workshop; ``with_speed`` those of the steps
    with ``v`` logged as well, None where it is logged.
    """

    prior: Prior
    want: Want
    before: HalfWidths
    steps: tuple[Step, ...]
    not_worth: dict[Measure, float]
    impossible: dict[Measure, str]
    floor: HalfWidths
    floor_of_runs: HalfWidths
    with_speed: HalfWidths | None

    @property
    def after(self) -> HalfWidths:
        """The widths at the end of the plan."""
        return self.steps[-1].widths if self.steps else self.before

    @property
    def seconds(self) -> float:
        """The time that the plan takes [s]."""
        return sum(step.seconds for step in self.steps)


def plan(prior: Prior, want: Want, workers: int = 1) -> Plan:
    """Find the best sequence of measures for what is wanted, the same in any number of processes.

    Raises LogError where no ramp can be driven here, with the reason of each.
    """
    with side_by_side(workers, "calib.plan.search") as mapped:
        now = before_any_run(prior)
        if prior.logs:
            (now,) = _medians(mapped, prior, [()], 1)
        search = _Search(prior, want, mapped)
        chosen = search.run(now)
        others = [m for m in measures() if m not in search.impossible and not _is_whole_ramp(m)]
        everything = tuple(dict.fromkeys((*chosen, *others)))
        runs = tuple(m for m in everything if m.driven)
        floor, floor_of_runs = _medians(mapped, prior, [everything, runs], 1)
        after = _medians(mapped, prior, [chosen[: i + 1] for i in range(len(chosen))], _CARS)
        faster = replace(prior, sensors=prior.sensors | {"v"})
        with_speed = None if "v" in prior.sensors else _medians(mapped, faster, [chosen], _CARS)[0]
    seconds = [_seconds_of(measure, i == 0) for i, measure in enumerate(chosen)]
    return Plan(
        prior=prior,
        want=want,
        before=now,
        steps=tuple(map(Step, chosen, seconds, after)),
        not_worth={m: x for m, x in search.gains.items() if m not in chosen and x < _WORTH},
        impossible=search.impossible,
        floor=floor,
        floor_of_runs=floor_of_runs,
        with_speed=with_speed,
    )


def _seconds_of(measure: Measure, first: bool) -> float:
    """Time that a measure takes [s]; a run that is not the ``first`` one with its turn."""
    if not measure.driven:
        return measure.seconds
    driven = measure.rise if measure.kind == "coast" else LEAD_IN + measure.rise
    return driven + (0.0 if first else _TURN)


def _is_whole_ramp(measure: Measure) -> bool:
    """Whether it is a ramp with both axles, of which one is enough."""
    return measure.kind == "ramp" and not measure.axle


class _Search:
    """The greedy search; ``gains`` of measures when they were last tried, ``impossible`` ones."""

    def __init__(self, prior: Prior, want: Want, mapped: Mapped) -> None:
        self.prior, self.want, self.mapped = prior, want, mapped
        self.gains: dict[Measure, float] = {}
        reasons = {measure: _why_not_driven(prior, measure) for measure in measures()}
        self.impossible = {measure: reason for measure, reason in reasons.items() if reason}

    def run(self, now: HalfWidths) -> _Sequel:
        """The measures in their order. Raises LogError where there can be no ramp."""
        chosen: _Sequel = ()
        spent, first = 0.0, not self.prior.logs
        while not self.want.met_by(now):
            options = [m for m in measures() if self._is_option(m, chosen, first, spent)]
            widths = self._tried(chosen, options, now, _CARS if first else 1)
            worthy = {m: w for m, w in widths.items() if first or self.gains[m] >= _WORTH}
            if first and not worthy:
                raise self._no_ramp()
            if not worthy:
                break
            best = max(worthy, key=lambda m: self._rate(m, first))
            chosen, now = (*chosen, best), worthy[best]
            spent, first = spent + _seconds_of(best, len(chosen) == 1), False
        return self._pruned(chosen, now)

    def _pruned(self, chosen: _Sequel, now: HalfWidths) -> _Sequel:
        """The steps without those that later ones made superfluous, the longest first."""
        fixed = 0 if self.prior.logs else 1  # the first ramp makes the table
        shorter = {m: tuple(x for x in chosen if x != m) for m in chosen[fixed:]}
        outcomes = _outcomes(self.mapped, self.prior, list(shorter.values()), 1)
        for measure, of_cars in sorted(
            zip(shorter, outcomes, strict=True), key=lambda pair: -_seconds_of(pair[0], False)
        ):
            if isinstance(of_cars, str):
                continue
            (widths,) = of_cars
            if self.want.met_by(widths) or self.want.gain(widths, now) < _WORTH:
                return self._pruned(shorter[measure], now)
        return chosen

    def _rate(self, measure: Measure, first: bool) -> float:
        """Gain of the first ramp, gain per second of what follows."""
        return self.gains[measure] / (1.0 if first else _seconds_of(measure, first=False))

    def _is_option(self, measure: Measure, chosen: _Sequel, first: bool, spent: float) -> bool:
        """Whether a measure can come next: once, in the time left, if it gained before."""
        if (first and not _is_whole_ramp(measure)) or measure in self.impossible:
            return False
        if measure in chosen or self.gains.get(measure, _WORTH) < _WORTH:
            return False
        return spent + _seconds_of(measure, not chosen) <= self.want.seconds

    def _tried(
        self, chosen: _Sequel, options: Sequence[Measure], now: HalfWidths, count: int
    ) -> dict[Measure, HalfWidths]:
        """Median widths of ``count`` cars after each option, but for impossible ones.

        Sets the mean gain of each, or the reason why it is impossible.
        """
        outcomes = _outcomes(self.mapped, self.prior, [(*chosen, m) for m in options], count)
        widths = {}
        for measure, of_cars in zip(options, outcomes, strict=True):
            if isinstance(of_cars, str):
                self.impossible[measure] = of_cars
            else:
                widths[measure] = median(of_cars)
                self.gains[measure] = sum(self.want.gain(now, w) for w in of_cars) / count
        return widths

    def _no_ramp(self) -> LogError:
        reasons = "; ".join(dict.fromkeys(self.impossible.values()))
        return LogError(
            f"no ramp can be driven here: {reasons or 'none is short enough'}",
            where=self.prior.vehicle.name,
            expected="a ramp of 7 s from 60 km/h or more",
            do="give a longer track, a higher speed or more time",
        )


def _why_not_driven(prior: Prior, measure: Measure) -> str:
    """Why the mean car cannot be driven so; "" where it can."""
    try:
        if measure.driven:
            drive(cars(prior, 1)[0], measure, prior.track, prior.sensors)
    except ModelError as error:
        return error.problem
    return ""


def _medians(
    mapped: Mapped, prior: Prior, sequels: Sequence[_Sequel], count: int
) -> list[HalfWidths]:
    """Median widths over ``count`` cars after each of the sequels.

    Raises LogError with the reason for one that cannot be done.
    """
    medians = []
    for of_cars in _outcomes(mapped, prior, sequels, count):
        if isinstance(of_cars, str):
            raise LogError(of_cars, where=prior.vehicle.name)
        medians.append(median(of_cars))
    return medians


def _outcomes(
    mapped: Mapped, prior: Prior, sequels: Sequence[_Sequel], count: int
) -> list[list[HalfWidths] | str]:
    """Widths of ``count`` cars after each sequel, or why one of them cannot be driven or fitted."""
    cases = [(number, steps) for steps in sequels for number in range(count)]
    outcomes = list(mapped(partial(_outcome, prior), cases))
    groups = [outcomes[i : i + count] for i in range(0, len(outcomes), count)]
    widths: list[list[HalfWidths] | str] = []
    for group in groups:
        reasons = [outcome for outcome in group if isinstance(outcome, str)]
        widths.append(reasons[0] if reasons else [w for w in group if isinstance(w, HalfWidths)])
    return widths


def _outcome(prior: Prior, case: tuple[int, _Sequel]) -> HalfWidths | str:
    """Widths of the car of that number after the measures, or why it has none."""
    number, steps = case
    try:
        return half_widths(prior, cars(prior)[number], steps, SEED + 100 * number)
    except BrakeCalError as error:
        return error.problem
