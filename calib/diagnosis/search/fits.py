"""All that was fitted in a search, by what it says, and what the hold-outs make of it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.columns import seen
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.explanation.fit import ROUGHLY, fit
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State, start_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.replays.hold_outs import placed
from calib.diagnosis.search.rank import Promise

_PRUNED = 20.0
"""What ln of the evidence of a hypothesis can gain where its effects that are not worth their price
are taken out."""


@dataclass
class Fits:
    """``fitted`` explanations of a problem by their keys; ``held`` the logs that are held out.

    ``base`` the one without effects; ``densities`` ln of those of the hold-outs.
    """

    problem: Problem
    held: Problem
    base: Explanation = field(init=False)
    fitted: dict[object, Explanation] = field(default_factory=dict)
    densities: dict[object, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.base = fit(self.problem, Hypothesis(), start_of(self.problem))
        self.add(self.base)

    def add(self, e: Explanation) -> None:
        """In the place of what was known of the same hypothesis."""
        self.fitted[e.hypothesis.key] = e
        self.densities.pop(e.hypothesis.key, None)

    def best_of(self, tops: Sequence[Promise], near: Explanation) -> list[Explanation]:
        """What is promised beside ``near`` as it was fitted, if it fell far short then anew.

        Best first; pruned if that can make it the best.
        """
        known = {key: e.log_evidence for key, e in self.fitted.items()}
        new = [p for p in tops if known.get(p.hypothesis.key, -np.inf) < p.log_evidence - 3.0]
        if new:
            names = ", ".join(" + ".join(p.hypothesis.names) for p in new).replace("_", " ")
            self.problem.tell(f"fitting {names}", 0, 1)
        job = partial(_fitted, self.problem.alone, near.columns, near.bent)
        for p, one in zip(new, self.problem.mapped(job, new), strict=True):
            if one.log_evidence > known.get(p.hypothesis.key, -np.inf):
                self.add(replace(one, problem=self.problem))
        news = sorted((self.fitted[p.hypothesis.key] for p in tops), key=lambda e: -e.log_evidence)
        least = news[0].log_evidence - _PRUNED if news else 0.0
        return [self.pruned(e) if e.log_evidence > least else e for e in news]

    def pruned(self, at: Explanation) -> Explanation:
        """Without kinds that are not worth their price, and effects by a linear step, too."""
        while True:
            worth = 100.0 + 0.01 * (at.log_evidence - self.base.log_evidence)
            size = at.state.x**2 / (2.0 * worth * np.diag(at.covariance))
            spare = [name for name in at.names if size[np.argmax(at.prior.of == name)] < 1.0]
            better = max(self.fewer(at, spare), key=lambda e: e.log_evidence, default=at)
            if better.log_evidence <= at.log_evidence:
                return at
            at = better

    def fewer(self, at: Explanation, names: Iterable[str]) -> list[Explanation]:
        """An explanation without each of these effects, and each kind in which logs differ."""
        out, kinds = [], at.hypothesis.kinds
        for name in names:
            left = tuple(n for n in at.names if n != name)
            out.append(Hypothesis(left, kinds - {"heat"} if name == FADE else kinds))
        out += [Hypothesis(at.names, kinds - {kind}) for kind in kinds]
        return [self._part(at, hypothesis) for hypothesis in out]

    def _part(self, at: Explanation, hypothesis: Hypothesis) -> Explanation:
        """A part of an explanation as it is known, else fitted from where that is."""
        if hypothesis.key not in self.fitted:
            keep = np.isin(at.prior.of, ["", *hypothesis.names])
            x, same = at.state.x[keep[: at.state.x.size]], hypothesis.sizes == at.hypothesis.sizes
            state = State(x, at.state.form, np.where(same, at.state.own, 0.0))
            near = [J[keep] for J in at.columns]
            self.add(fit(self.problem, hypothesis, state, near, ROUGHLY))
        return self.fitted[hypothesis.key]

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
