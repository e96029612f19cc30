"""All that was fitted in a search, by what it says, and what the hold-outs make of it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.explanation import Explanation, seen
from calib.diagnosis.explanation.fit import ROUGHLY, fit
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State, start_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.rank import Promise
from calib.diagnosis.replays import placed

_PRUNED = 20.0  # what ln of the evidence can gain where effects not worth their price are left out


@dataclass
class Fits:
    """``fitted`` explanations of a problem by their keys; ``held`` the logs that are held out.

    ``base`` the one without effects; ``densities`` ln of those of the hold-outs; ``attempts`` at
    parts, by their keys and those of what they are parts of.
    """

    problem: Problem
    held: Problem
    base: Explanation = field(init=False)
    fitted: dict[object, Explanation] = field(default_factory=dict)
    densities: dict[object, float] = field(default_factory=dict)
    attempts: set[object] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.base = fit(self.problem, Hypothesis(), start_of(self.problem))
        self.add(self.base)

    def known(self, hypothesis: Hypothesis, promised: float) -> bool:
        """Whether it was fitted, and did not fall far short of what is ``promised`` of it now."""
        found = self.fitted.get(hypothesis.key)
        return found is not None and found.log_evidence > promised - 3.0

    def add(self, e: Explanation) -> None:
        """In the place of what is known of the same hypothesis, if that is rougher or no better."""
        known = self.fitted.get(e.hypothesis.key, e)
        if e.settled < known.settled or e.log_evidence >= known.log_evidence:
            self.fitted[e.hypothesis.key] = e
            self.densities.pop(e.hypothesis.key, None)

    def best_of(self, tops: Sequence[Promise], near: Explanation) -> list[Explanation]:
        """What is promised beside ``near``, best first; pruned if that can make it the best."""
        new = [p for p in tops if not self.known(p.hypothesis, p.log_evidence)]
        if new:
            names = ", ".join(" + ".join(p.hypothesis.names) for p in new).replace("_", " ")
            self.problem.tell(f"fitting {names}", 0, 1)
        job = partial(_fitted, self.problem.alone, near.columns, near.bent)
        for one in self.problem.mapped(job, new):
            self.add(replace(one, problem=self.problem))
        news = sorted((self.fitted[p.hypothesis.key] for p in tops), key=lambda e: -e.log_evidence)
        least = news[0].log_evidence - _PRUNED if news else 0.0
        return [self.pruned(e) if e.log_evidence > least else e for e in news]

    def pruned(self, at: Explanation) -> Explanation:
        """Without kinds that are not worth their price, and effects by a linear step, too."""
        while True:
            worth = 100.0 + 0.01 * (at.log_evidence - self.base.log_evidence)
            spare = [name for name in at.names if at.worth_of(name) < worth]
            better = max(self.fewer(at, spare), key=lambda e: e.log_evidence, default=at)
            if better.log_evidence <= at.log_evidence:
                return at
            at = better

    def fewer(self, at: Explanation, names: Iterable[str]) -> list[Explanation]:
        """An explanation without each of these effects, and each kind in which logs differ."""
        out, kinds = [], at.hypothesis.kinds
        for name in names:
            left = tuple(n for n in at.names if n != name)
            part = Hypothesis(left, kinds - {"heat"} if name == FADE else kinds)
            out.append(self._part(at, part, at.log_evidence - at.worth_of(name)))
        same = [Hypothesis(at.names, kinds - {kind}) for kind in kinds]
        return out + [self._part(at, p, at.marginal(sizes=p.sizes).evidence()) for p in same]

    def _part(self, at: Explanation, part: Hypothesis, promised: float) -> Explanation:
        """A part of an explanation as it is known, else fitted from where that is."""
        attempt = part.key, at.hypothesis.key
        if attempt not in self.attempts and not self.known(part, promised):
            self.attempts.add(attempt)
            keep = np.isin(at.prior.of, ["", *part.names])
            x, same = at.state.x[keep[: at.state.x.size]], part.sizes == at.hypothesis.sizes
            state = State(x, at.state.form, np.where(same, at.state.own, 0.0))
            self.add(fit(self.problem, part, state, [J[keep] for J in at.columns], ROUGHLY))
        return self.fitted[part.key]

    def others(self, best: Explanation) -> tuple[Explanation, ...]:
        """All that was fitted but the ``best``, by evidence."""
        found = [e for key, e in self.fitted.items() if key != best.hypothesis.key]
        return tuple(sorted(found, key=lambda e: -e.log_evidence))

    def value(self, at: Explanation) -> float:
        """ln of the evidence of all logs, searched and held out."""
        return at.log_evidence + self.density(at)

    def density(self, at: Explanation) -> float:
        """ln of the density of the hold-outs given the other logs, by one linear model of both.

        It is linear about what each log has of its own, and right but for a constant of the rows.
        """
        key, held = at.hypothesis.key, self.held
        if key not in self.densities:
            own = placed(held, at)
            other = seen(held, at.hypothesis, replace(at.state, own=own))
            together = replace(
                at,
                problem=replace(at.problem, runs=(*at.problem.runs, *held.runs)),
                state=replace(at.state, own=np.vstack([at.state.own, own])),
                predictions=[*at.predictions, *other.predictions],
                innovations=[*at.innovations, *other.innovations],
                columns=[*at.columns, *other.columns],
                rest=[*at.rest, *other.rest],
            )
            more = together.marginal().evidence() - at.marginal().evidence()
            self.densities[key] = more - at.hypothesis.phases(len(held.runs))
        return self.densities[key]


def _fitted(problem: Problem, near: Sequence[Array], bent: bool, promise: Promise) -> Explanation:
    """What is promised, fitted from its state; pads and tyres from usual ones if they were bent."""
    state = promise.state
    if bent:
        usual = start_of(problem)
        state = replace(usual, x=np.concatenate([usual.x, state.x[problem.base_size :]]))
    return fit(problem, promise.hypothesis, state, near, ROUGHLY)
