"""From fitted candidates to a verdict: no effect, one, two, a set that the logs cannot
distinguish, or a cause that is not in the catalogue.

    base ──> gap? ──> best single ──> enough? ──> best second ──> enough? ──> unknown
              no: no_gap       yes: named or ambiguous      yes: named

The measure is the excess of the mean squared innovation over 1. An effect is named if it reduces
the innovations enough, explains most of the excess, and helps on hold-outs it was not fitted to.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.candidate import Candidate, shown, without_its_noise
from calib.diagnosis.explanation.channels import CHANNELS
from calib.diagnosis.explanation.fit import fit, fit_without
from calib.diagnosis.explanation.ranges import at_bound
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.chance import chance_of
from calib.diagnosis.search.search import refine

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Decision:
    """The verdict with its candidates.

    ``verdict`` as in diagnosis.json; ``base`` without effects; ``best`` the explanation that was
    accepted or comes nearest; ``rivals`` the other fitted ones of the last step, best first.
    ``faint`` is the decision for two effects that replaces this one if the hold-outs confirm it;
    ``chance`` the gain in chi-square, by effect, that chance alone could give
    (`calib.diagnosis.search.chance`).
    """

    verdict: str
    base: Candidate
    best: Candidate
    rivals: tuple[Candidate, ...]
    first: Candidate | None = None
    faint: "Decision | None" = None
    chance: Mapping[str, float] = field(default_factory=dict)

    @property
    def detected(self) -> bool:
        """Whether the calibration logs alone show the best explanation."""
        if not self.best.names or gain(self.base, self.best) < GATES.form:
            return False
        return _beyond_chance(self.chance, self.base, self.best) > GATES.sure

    @property
    def least_shown(self) -> dict[str, float]:
        """Gain in chi-square from which the calibration logs alone show an effect, by effect."""
        return {name: GATES.sure * gain for name, gain in self.chance.items()}


def decide(base: Candidate) -> Decision:
    """Search for one or two effects and judge them; ``base`` is the fit without any.

    Where the best explanation leaves less noise, the search is repeated with that noise: the
    candidates' problem, `Candidate.problem`, then is another than the one that was given.
    """
    decision = _searched(base)
    named = [c for c in (decision.best, *decision.rivals) if c.names]
    quieter = without_its_noise(named[0]) if named else None
    if quieter is None:
        return decision
    return _searched(fit(quieter, (), base.x))


def decided_anew(at: Candidate) -> Decision:
    """The decision of a new search, on the problem of an explanation and from its base."""
    return decide(fit(at.problem, (), at.x[: at.problem.base_size]))


def _searched(base: Candidate) -> Decision:
    singles = settled(simplest_first(refine(base)))
    chance = chance_of(base, singles[0] if singles else base)
    decision = _decided(base, singles, chance)
    faint = decision.faint and replace(decision.faint, chance=chance)
    return replace(decision, chance=chance, faint=faint)


def _decided(base: Candidate, singles: list[Candidate], chance: Mapping[str, float]) -> Decision:
    if not singles or _beyond_chance(chance, base, singles[0]) < 1.0:
        verdict = "unknown" if strange(base) else "no_gap"
        return Decision(verdict, base, base, tuple(singles))
    pairs = seconds(base, singles)
    if pairs:
        singles = _with_lower(singles, spared(pairs[0]))
    first = singles[0]
    faint = _faint(base, first, pairs)
    if pairs and gain(first, pairs[0]) > max(GATES.second, GATES.second_of_all * gain(base, first)):
        # something the first does not explain lies along another effect
        verdict = standing(base, pairs[0], pairs[1:])
        if _second_earns(first, pairs[0]):
            return Decision(verdict, base, pairs[0], tuple(pairs[1:]))
        return Decision("unknown", base, pairs[0], tuple(pairs[1:]), faint=faint)
    if pairs and strange(base) and _replaces(singles, pairs[0]):
        return Decision(standing(base, pairs[0], pairs[1:]), base, pairs[0], tuple(pairs[1:]))
    verdict = standing(base, first, singles[1:])
    if verdict == "unknown" and not strange(base) and gain(base, first) < GATES.second:
        # too weak here for an excess; the hold-outs may excite it more
        shown = "ambiguous" if confusable(first, singles[1:]) else "named"
        faint = faint or Decision(shown, base, first, tuple(singles[1:]), first=base)
    return Decision(verdict, base, first, tuple(singles[1:]), faint=faint)


def _with_lower(singles: list[Candidate], other: Candidate) -> list[Candidate]:
    """Explanations with one effect, best first, with another fit of one of them if that is better.

    What is left of a pair without its second effect can have come to a lower minimum.
    """
    lower = [c for c in singles if c.names == other.names and c.chi2 > other.chi2]
    return simplest_first([other, *(c for c in singles if c not in lower)]) if lower else singles


def _replaces(singles: list[Candidate], pair: Candidate) -> bool:
    """Whether a pair explains all, and one effect of hardly fewer parameters ends at its bound.

    That is the best one, or one of the pair that explains nearly as much. A delay beside a lag
    looks like two lags in a row, or like an oscillation without overshoot.
    """
    first = singles[0]
    explains_more = pair.reduced < min(quiet(pair), first.reduced - GATES.confusable)
    if not explains_more or pair.parameters > first.parameters + 1:
        return False
    of_the_pair = [c for c in confusable(first, singles[1:]) if set(c.names) < set(pair.names)]
    return any(at_bound(one) for one in (first, *of_the_pair))


def _faint(base: Candidate, first: Candidate, pairs: list[Candidate]) -> Decision | None:
    """A decision for the best pair, None if the pair cannot be accepted."""
    if not pairs or gain(first, pairs[0]) < GATES.faint_second:
        return None
    verdict = standing(base, pairs[0], pairs[1:])
    if verdict == "unknown":
        return None
    return Decision(verdict, base, pairs[0], tuple(pairs[1:]), first=first)


def _beyond_chance(chance: Mapping[str, float], base: Candidate, best: Candidate) -> float:
    """Gain of an explanation over the largest that chance gives one of its effects [1]."""
    by_chance = max(chance.get(name, 0.0) for name in best.names)
    return (base.chi2 - best.chi2) / max(by_chance, 1e-9)


def quiet(candidate: Candidate) -> float:
    """Mean squared innovation up to which nothing is left to explain."""
    return GATES.floor + GATES.quiet * candidate.scatter


def explains(decision: Decision) -> bool:
    """Whether the innovations have a verdict and no more than noise is left in them."""
    return decision.verdict != "unknown" and decision.best.reduced <= quiet(decision.best)


def strange(candidate: Candidate) -> bool:
    """Whether a cause is present, even if no known effect explains it."""
    return candidate.reduced > GATES.floor + GATES.strange * candidate.scatter


def gain(before: Candidate, after: Candidate) -> float:
    """Fall of the mean squared innovation."""
    return before.reduced - after.reduced


def seconds(base: Candidate, singles: list[Candidate]) -> list[Candidate]:
    """Pairs from the two best singles, best first, each pair once.

    Where the first leaves nothing, from the second only if that explains half: of two effects that
    a third one imitates, one does. Only what may explain more than the first alone.
    """
    first, *others = singles
    half = base.reduced - 0.5 * gain(base, first)
    second = [c for c in others[:1] if first.reduced > quiet(first) or c.reduced < half]
    found: dict[frozenset[str], Candidate] = {}
    for parent in (first, *second):
        for pair in refine(parent, 4, first.chi2):
            key = frozenset(pair.names)
            if key not in found or pair.chi2 < found[key].chi2:
                found[key] = pair
    return settled(simplest_first(list(found.values())))


def settled(found: list[Candidate]) -> list[Candidate]:
    """Explanations, best first, with the best one at its minimum.

    A fit with secant updates can end before it, where the model has corners. So the best one is
    fitted once more from where it ended, with fresh derivatives, if something is left with it.
    """
    if not found or found[0].reduced <= quiet(found[0]):
        return found
    best, *others = found
    again = fit(best.problem, best.names, best.x)
    return [again if again.chi2 < best.chi2 else best, *others]


def simplest_first(found: list[Candidate]) -> list[Candidate]:
    """Best first; every further parameter must gain `parameter`."""
    return sorted(
        found, key=lambda candidate: candidate.reduced + GATES.parameter * candidate.parameters
    )


def _second_earns(first: Candidate, pair: Candidate) -> bool:
    """Whether the second effect of a pair explains enough to be named."""
    left = max(first.reduced - GATES.floor, 1e-9)
    return gain(first, pair) / left > GATES.second_share


def standing(base: Candidate, best: Candidate, rivals: list[Candidate]) -> str:
    """The verdict on the best explanation: named, ambiguous or unknown."""
    closed = gain(base, best) / max(base.reduced - quiet(best), 1e-9)
    if (best.reduced > quiet(best) and closed < GATES.enough) or refuted(base, best):
        return "unknown"
    return "ambiguous" if confusable(best, rivals) else "named"


def refuted(base: Candidate, best: Candidate) -> bool:
    """Whether a channel of a run is explained worse with the effects than without them."""
    worse = float(np.max(_mean_squares(best) - _mean_squares(base)))
    return worse > GATES.hurts or _contradicted(best)


def _contradicted(best: Candidate) -> bool:
    """Whether a channel refutes an effect that fits the other channels.

    The effect must reduce the residual of every channel that it changes. Example: unevenly spaced
    teeth ripple in the wheel speeds as a disc of uneven thickness does, but not in a_x.
    """
    after = best.whitened
    for name in best.names:
        before = best.problem.whitened(best.base, best.without(name))
        for channel in range(len(CHANNELS)):
            x = np.concatenate([run[channel] for run in before])
            y = np.concatenate([run[channel] for run in after])
            power = float(np.sum((x - y) ** 2))
            if power > GATES.felt_power and float(x @ x - y @ y) < -0.5 * power:
                return True
    return False


def _mean_squares(candidate: Candidate) -> Array:
    """Mean squared innovation by run and channel."""
    return np.array([[float(np.mean(c**2)) for c in run] for run in candidate.whitened])


def confusable(best: Candidate, rivals: list[Candidate] | tuple[Candidate, ...]) -> list[Candidate]:
    """Rivals that the data cannot distinguish from the best, with no more parameters than it.

    Another fit of the best one's own effects is no rival.
    """
    return [
        rival
        for rival in rivals
        if set(rival.names) != set(best.names)
        and rival.reduced - best.reduced < GATES.confusable
        and (rival.parameters <= best.parameters or rival.reduced < best.reduced - GATES.confusable)
        and len(rival.names) <= len(best.names)
    ]


def spared(at: Candidate) -> Candidate:
    """The explanation without effects that are not worth their parameters."""
    for name, brings in shown(at).items():
        price = GATES.faint_second * at.problem.parameters_of(name)
        if brings > GATES.surely_shown * price * at.count:
            continue
        fewer = fit_without(at, name)
        price = GATES.faint_second * (at.parameters - fewer.parameters)
        if fewer.reduced - at.reduced < price:
            return spared(fewer)
    return at
