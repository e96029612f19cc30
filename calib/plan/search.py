"""The best sequence of measures: each next one narrows the bounds most for its time.

    gain = sum over front, rear, total of ln(width now / width then), no width below the wanted one

The first ramp has the greatest mean gain over several cars, each with its own noise. Each next
measure has the greatest gain per second for the mean car. One that gained next to nothing is not
tried again: gains diminish. Widths after the steps are medians over several cars, floors of one.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from calib.base.errors import BrakeCalError, LogError, ModelError
from calib.base.processes import MapFunction, parallel_map
from calib.base.units import BAR
from calib.plan.achieved import HalfWidths
from calib.plan.expected import Prior, before_any_run, cars, half_widths
from calib.plan.measure import Measure, drive, measures, pressure_trace

SEED = 20
"""Seed of the noise of a plan: the same question has the same plan."""

_CARS = 3  # cars, each with its own noise, of a median
_TURN = 20.0  # time to turn and to come back up to speed before another run [s]
_WORTH = 0.02  # gain below which a measure is not worth its time [1]: 2 % of one width

_Sequel = tuple[Measure, ...]
"""Measures in the order in which they are done."""


class Want(NamedTuple):
    """Half ``widths`` that are narrow enough, 0 where none is named; ``seconds`` to spend."""

    widths: HalfWidths = HalfWidths()
    seconds: float = math.inf

    def met_by(self, widths: HalfWidths) -> bool:
        """Whether the widths are as narrow as wanted; never where none is named."""
        pairs = zip(widths, self.widths, strict=True)
        return any(self.widths) and all(width <= goal for width, goal in pairs if goal)

    def gain(self, now: HalfWidths, then: HalfWidths) -> float:
        """Gain from one set of widths to the next [1]."""
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

    ``start`` the widths by the prior; ``not_worth`` measures that gained less than `_WORTH` when
    they were last tried, each with its gain [1]; ``impossible`` those that cannot be done
    here, each with the reason; ``floor`` the widths after all that can be done here, whatever its
    time, ``floor_of_runs`` after all runs without a workshop; ``with_speed`` those of the steps
    with ``v`` logged as well, None where it is logged.
    """

    prior: Prior
    want: Want
    start: HalfWidths
    steps: tuple[Step, ...]
    not_worth: dict[Measure, float]
    impossible: dict[Measure, str]
    floor: HalfWidths
    floor_of_runs: HalfWidths
    with_speed: HalfWidths | None

    @property
    def after(self) -> HalfWidths:
        """The widths at the end of the plan."""
        return self.steps[-1].widths if self.steps else self.start

    @property
    def seconds(self) -> float:
        """The time that the plan takes [s]."""
        return sum(step.seconds for step in self.steps)


def plan(prior: Prior, want: Want, workers: int = 1) -> Plan:
    """Find the best sequence of measures for what is wanted, the same in any number of processes.

    Raises LogError where no ramp can be driven here, with the reason of each.
    """
    with parallel_map(workers, "calib.plan.search") as mapped:
        now = _medians(mapped, prior, [()], 1)[0] if prior.logs else before_any_run(prior)
        search = _Search(prior, want, mapped)
        chosen = search.run(now)
        others = [m for m in measures() if m not in search.impossible and not m.is_whole_ramp]
        everything = tuple(dict.fromkeys((*chosen, *others)))
        runs = tuple(m for m in everything if m.driven)
        floor, floor_of_runs = _medians(mapped, prior, [everything, runs], 1)
        after = _medians(mapped, prior, [chosen[: i + 1] for i in range(len(chosen))], _CARS)
        faster = replace(prior, sensors=prior.sensors | {"v"})
        with_speed = None if "v" in prior.sensors else _medians(mapped, faster, [chosen], _CARS)[0]
    return Plan(
        prior=prior,
        want=want,
        start=now,
        steps=tuple(map(Step, chosen, _times(chosen), after)),
        not_worth={m: x for m, x in search.gains.items() if m not in chosen and x < _WORTH},
        impossible=search.impossible,
        floor=floor,
        floor_of_runs=floor_of_runs,
        with_speed=with_speed,
    )


def _times(steps: _Sequel) -> list[float]:
    """Time of each step [s]."""
    return [_following(m) if i else m.duration for i, m in enumerate(steps)]


def _following(measure: Measure) -> float:
    """Time of a measure that follows another [s]: a run has its turn before it."""
    return measure.duration + _TURN * measure.driven


class _Search:
    """The greedy search; ``gains`` of measures when they were last tried, ``impossible`` ones."""

    def __init__(self, prior: Prior, want: Want, mapped: MapFunction) -> None:
        self.prior, self.want, self.mapped = prior, want, mapped
        self.gains: dict[Measure, float] = {}
        reasons = {measure: _why_not_driven(prior, measure) for measure in measures()}
        self.impossible = {measure: reason for measure, reason in reasons.items() if reason}

    def run(self, now: HalfWidths) -> _Sequel:
        """The measures in their order. Raises LogError where there can be no ramp."""
        chosen: _Sequel = ()
        while not self.want.met_by(now):
            first = not (chosen or self.prior.logs)
            widths = self._tried(chosen, now, first)
            if not widths and first:
                reasons = "; ".join(dict.fromkeys(self.impossible.values()))
                raise LogError(
                    f"no ramp can be driven here: {reasons or 'none is short enough'}",
                    where=self.prior.vehicle.name,
                    expected="a ramp of 7 s from 60 km/h or more",
                    do="give a longer track, a higher speed or more time",
                )
            if not widths:
                break
            best = max(widths, key=lambda m: self.gains[m] / (1.0 if first else _following(m)))
            chosen, now = (*chosen, best), widths[best]
        return self._pruned(chosen, now)

    def _tried(self, chosen: _Sequel, now: HalfWidths, first: bool) -> dict[Measure, HalfWidths]:
        """Median widths over cars after each measure that can come next and is worth its time.

        Sets the mean gain of each, or the reason why it is impossible.
        """
        possible = (m for m in measures() if m not in (*chosen, *self.impossible))
        options = [
            m
            for m in possible
            if (m.is_whole_ramp or not first)
            and self.gains.get(m, _WORTH) >= _WORTH
            and sum(_times((*chosen, m))) <= self.want.seconds
        ]
        sequels = [(*chosen, m) for m in options]
        outcomes = _outcomes(self.mapped, self.prior, sequels, _CARS if first else 1)
        widths = {}
        for measure, (reason, of_cars) in zip(options, outcomes, strict=True):
            if reason:
                self.impossible[measure] = reason
                continue
            self.gains[measure] = sum(self.want.gain(now, w) for w in of_cars) / len(of_cars)
            if first or self.gains[measure] >= _WORTH:
                widths[measure] = _median(of_cars)
        return widths

    def _pruned(self, chosen: _Sequel, now: HalfWidths) -> _Sequel:
        """The steps without those that later ones made superfluous, the longest first."""
        fixed = 0 if self.prior.logs else 1  # the first ramp makes the table
        dropped = sorted(chosen[fixed:], key=_following, reverse=True)
        shorter = [tuple(x for x in chosen if x != m) for m in dropped]
        outcomes = _outcomes(self.mapped, self.prior, shorter, 1)
        for steps, (_, (widths,)) in zip(shorter, outcomes, strict=True):
            if self.want.met_by(widths) or self.want.gain(widths, now) < _WORTH:
                return self._pruned(steps, now)
        return chosen


def _why_not_driven(prior: Prior, measure: Measure) -> str:
    """Why the mean car cannot be driven so; "" where it can."""
    try:
        if measure.driven:
            drive(cars(prior, 1)[0], measure, prior.track, prior.sensors)
    except ModelError as error:
        return error.problem
    return ""


def _medians(
    mapped: MapFunction, prior: Prior, sequels: Sequence[_Sequel], count: int
) -> list[HalfWidths]:
    """Median widths over ``count`` cars after each of the sequels.

    Raises LogError with the reason for one that cannot be done.
    """
    outcomes = list(_outcomes(mapped, prior, sequels, count))
    for reason in filter(None, (reason for reason, _ in outcomes)):
        raise LogError(reason, where=prior.vehicle.name)
    return [_median(widths) for _, widths in outcomes]


def _median(widths: Sequence[HalfWidths]) -> HalfWidths:
    return HalfWidths(*np.median(np.array(widths), axis=0).tolist())


def _outcomes(
    mapped: MapFunction, prior: Prior, sequels: Sequence[_Sequel], count: int
) -> Iterator[tuple[str, list[HalfWidths]]]:
    """Why a sequel cannot be done, "" where it can, and the widths of ``count`` cars after it."""
    cases = [(number, steps) for steps in sequels for number in range(count)]
    outcomes = list(mapped(partial(_outcome, prior), cases))
    for i in range(0, len(outcomes), count):
        reasons, widths = zip(*outcomes[i : i + count], strict=True)
        yield next(filter(None, reasons), ""), list(widths)


def _outcome(prior: Prior, case: tuple[int, _Sequel]) -> tuple[str, HalfWidths]:
    """Widths of the car of that number after the measures; infinite, and why, if it has none."""
    number, steps = case
    try:
        return "", half_widths(prior, cars(prior)[number], steps, SEED + 100 * number)
    except BrakeCalError as error:
        return error.problem, HalfWidths(math.inf, math.inf, math.inf)


def document(plan: Plan) -> dict[str, Any]:
    """The plan as a JSON document: half widths are relative [1], infinite if nothing is known."""
    track = plan.prior.track
    return {
        "vehicle": plan.prior.vehicle.name,
        "track": {"length": track.length, "speed": track.speed},
        "sensors": sorted(plan.prior.sensors),
        "noise": {name: level.sd for name, level in sorted(plan.prior.noise.items())},
        "want": {**plan.want.widths._asdict(), "seconds": plan.want.seconds},
        "before": plan.start._asdict(),
        "steps": [
            {
                "measure": step.measure.name,
                "text": step.measure.text,
                "driver": step.measure.driver,
                "seconds": step.seconds,
                "end": step.measure.end,
                "file": file,
                "half_width": step.widths._asdict(),
            }
            for step, file in zip(plan.steps, _files(plan), strict=True)
        ],
        "after": plan.after._asdict(),
        "seconds": plan.seconds,
        "met": plan.want.met_by(plan.after),
        "with_v": None if plan.with_speed is None else plan.with_speed._asdict(),
        "floor": plan.floor._asdict(),
        "floor_of_runs": plan.floor_of_runs._asdict(),
        "not_worth": {m.name: gain for m, gain in plan.not_worth.items()},
        "impossible": {m.name: reason for m, reason in plan.impossible.items()},
    }


def _files(plan: Plan) -> list[str | None]:
    """Name of the file with the pressure of each step, None for one without a pressure."""
    measures = [step.measure for step in plan.steps]
    return [f"{i}_{m.name}.csv" if m.kind == "ramp" else None for i, m in enumerate(measures, 1)]


def pressure_files(plan: Plan) -> Iterator[tuple[str, bytes]]:
    """Name and content of each file of pressure over time, of p_mc, every 10 ms."""
    for step, file in zip(plan.steps, _files(plan), strict=True):
        if file is not None:
            time, pressure = pressure_trace(plan.prior.vehicle, step.measure)
            lines = (f"{t:.2f},{p / BAR:.3f}" for t, p in zip(time, pressure, strict=True))
            yield file, "\n".join(["time [s],p_mc [bar]", *lines, ""]).encode()
