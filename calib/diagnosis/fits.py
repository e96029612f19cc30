"""All fits of a search by their hypotheses, and the density of the hold-outs given each."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import Fit, linearised
from calib.diagnosis.explanation.gauss_newton import ROUGH, fit_logs
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, State, start_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.rank import Promise
from calib.diagnosis.replays import placed

_PRUNED = 20.0  # what ln of the evidence can gain where effects not worth their price are left out


@dataclass
class Fits:
    """``fitted`` hypotheses of a problem by their keys; ``holdouts`` the logs that are held out.

    ``base`` the one without effects; ``densities`` ln of those of the hold-outs; ``attempts`` at
    parts, by their keys and those of what they are parts of.
    """

    problem: Problem
    holdouts: Problem
    base: Fit = field(init=False)
    fitted: dict[object, Fit] = field(default_factory=dict)
    densities: dict[object, float] = field(default_factory=dict)
    attempts: set[object] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.base = fit_logs(self.problem, Hypothesis(), start_of(self.problem))
        self.add(self.base)

    def is_known(self, hypothesis: Hypothesis, promised: float) -> bool:
        """Whether it was fitted, and its evidence is not far below the ``promised`` one."""
        fit = self.fitted.get(hypothesis.key)
        return fit is not None and fit.log_evidence > promised - 3.0

    def add(self, e: Fit) -> None:
        """Store a fit. An earlier one stays if it is more probable."""
        if e.log_evidence >= self.fitted.get(e.hypothesis.key, e).log_evidence:
            self.fitted[e.hypothesis.key] = e
            self.densities.pop(e.hypothesis.key, None)

    def best_of(self, tops: Sequence[Promise], near: Fit, least: float = -np.inf) -> list[Fit]:
        """Fit what is promised beside ``near``; best first, pruned where that may be best.

        ``least`` is the ln of the evidence below which none is of use.
        """
        new = [p for p in tops if not self.is_known(p.hypothesis, p.log_evidence)]
        if new:
            names = ", ".join(" + ".join(p.hypothesis.names) for p in new).replace("_", " ")
            self.problem.tell(f"fitting {names}", 0, 1)
        job = partial(_fitted, self.problem.alone, near.columns, near.has_unusual_base, least)
        for one in self.problem.mapped(job, new):
            self.add(replace(one, problem=self.problem))
        news = sorted((self.fitted[p.hypothesis.key] for p in tops), key=lambda e: -e.log_evidence)
        least = max((e.log_evidence for e in news), default=0.0) - _PRUNED
        return [self.pruned(e) if e.log_evidence > least else e for e in news]

    def pruned(self, fit: Fit) -> Fit:
        """Leave out kinds and effects that are not worth their price, as long as that is better."""
        while True:
            worth = 100.0 + 0.01 * (fit.log_evidence - self.base.log_evidence)
            spare = [name for name in fit.names if fit.worth_of(name) < worth]
            better = max(self.fewer(fit, spare), key=lambda e: e.log_evidence, default=fit)
            if better.log_evidence <= fit.log_evidence:
                return fit
            fit = better

    def fewer(self, fit: Fit, names: Iterable[str]) -> list[Fit]:
        """Fit it without each of these effects, and without each kind in which logs differ."""
        out, kinds = [], fit.hypothesis.kinds
        for name in names:
            names_left = tuple(n for n in fit.names if n != name)
            part = Hypothesis(names_left, kinds - {"heat"} if name == FADE else kinds)
            out.append(self._part(fit, part, fit.log_evidence - fit.worth_of(name)))
        same = [Hypothesis(fit.names, kinds - {kind}) for kind in kinds]
        return out + [self._part(fit, p, fit.marginal(sizes=p.sizes).evidence()) for p in same]

    def _part(self, fit: Fit, part: Hypothesis, promised: float) -> Fit:
        """Return a part of a fit as it was fitted before, else fit it from that state."""
        attempt = part.key, fit.hypothesis.key
        if attempt not in self.attempts and not self.is_known(part, promised):
            self.attempts.add(attempt)
            keep = np.isin(fit.prior.effect_names, ["", *part.names])
            x, same = fit.state.x[keep[: fit.state.x.size]], part.sizes == fit.hypothesis.sizes
            state = State(x, fit.state.form, np.where(same, fit.state.random_effects, 0.0))
            self.add(
                fit_logs(self.problem, part, state, [J[keep] for J in fit.columns], tolerance=ROUGH)
            )
        return self.fitted[part.key]

    def value(self, fit: Fit) -> float:
        """ln of the evidence of all logs, searched and held out."""
        return fit.log_evidence + self.density(fit)

    def density(self, fit: Fit) -> float:
        """ln of the density of the hold-outs given the other logs, by one linear model of both.

        It is linear about the random effects, and right but for a constant of the rows.
        """
        key, holdouts = fit.hypothesis.key, self.holdouts
        if key not in self.densities:
            state = replace(fit.state, random_effects=placed(holdouts, fit))
            other = linearised(holdouts, fit.hypothesis, state)
            together = fit.marginal([*fit.products, *other.products])
            more = together.evidence() - fit.marginal().evidence()
            self.densities[key] = more - fit.hypothesis.phases(len(holdouts.runs))
        return self.densities[key]


def _fitted(
    problem: Problem, near: Sequence[Array], unusual: bool, least: float, promise: Promise
) -> Fit:
    """Fit what is promised from its state; pads and tyres from usual ones if they were not."""
    state = promise.state
    if unusual:
        usual = start_of(problem)
        state = replace(usual, x=np.concatenate([usual.x, state.x[BASE:]]))
    return fit_logs(problem, promise.hypothesis, state, near, least, ROUGH)
