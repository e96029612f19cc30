"""From fitted candidates to a verdict: nothing, one effect, two, a set that cannot be told apart,
or something that the catalogue does not know.

    base ──> gap? ──> best single ──> enough? ──> best second ──> enough? ──> unknown
              no: no_gap       yes: named or ambiguous      yes: named

What is judged is the excess of the mean squared innovation over one. An effect must earn its place
in innovations, explain the better part of the excess, and help on hold-outs it was not fitted to.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.candidate import Candidate, Problem
from calib.diagnosis.channels import CHANNELS
from calib.diagnosis.search import refine

Array = NDArray[np.float64]

DETECT = 0.004
"""Gain in the mean squared innovation from which an effect is seen. Without any effect the best of
all names gains up to 0.0013 on a plant that is not this program's (tests/studies/naming.py)."""

FAINT = 0.0015
"""Gain from which an effect may be there: it counts if the hold-outs, which may excite it more,
show it beyond doubt."""

QUIET = 1.06
"""Mean squared innovation below which nothing is left to explain: no tyre curve is exact."""

STRANGE = 1.15
"""Mean squared innovation from which something is there, whatever the catalogue says."""

PARAMETER = 0.001
"""What a further parameter must gain in the mean squared innovation: an effect that can mimic a
simpler one is not preferred to it."""

HURTS = 0.35
"""Rise of the mean squared innovation of one channel in one run that no true cause brings: five
sigma of the difference of two runs of 450 steps."""

ENOUGH = 0.80
"""Share of the excess over QUIET that an explanation must close to stand."""

FELT_POWER = 50.0
"""What an effect must do to a channel for the channel to have a say, in squared sigma: where it is
not there it makes the sum of squares worse by as much, seven sigma of its chance."""

FLOOR = 1.03
"""What the best of models leaves on a plant that is not itself."""

SECOND = 0.02
"""Least gain in the mean squared innovation of a second effect."""

SECOND_OF_ALL = 0.03
"""Least share of the whole gap that what is left must show along any further effect to count."""

SECOND_SHARE = 0.6
"""Share of what the first left over that a second must close."""

FAINT_SECOND = 0.002
"""Gain from which a second effect may be there; it counts if the hold-outs show it beyond doubt. A
second that is not there gains up to 0.003, or 0.009 beside one whose form is not the plant's; and
on the hold-outs up to 0.012."""

CONFUSABLE = 0.004
"""Rivals whose mean squared innovation lies within this of the best cannot be told from it."""


@dataclass(frozen=True)
class Decision:
    """The verdict with its candidates.

    ``verdict`` as in diagnosis.json; ``base`` without effects; ``best`` the explanation that stands
    or comes nearest; ``rivals`` the other fitted ones of the last step, best first. ``faint`` is a
    decision for two effects that only the hold-outs can make.
    """

    verdict: str
    base: Candidate
    best: Candidate
    rivals: tuple[Candidate, ...]
    first: Candidate | None = None
    faint: "Decision | None" = None


def decide(problem: Problem, base: Candidate) -> Decision:
    """Search and judge."""
    singles = simplest_first(refine(problem, base))
    if not singles or gain(base, singles[0]) < FAINT:
        verdict = "no_gap" if base.reduced < STRANGE else "unknown"
        return Decision(verdict, base, base, tuple(singles))
    first = singles[0]
    pairs = seconds(problem, singles) if first.reduced > 1.0 else []
    faint = _faint(problem, base, first, pairs)
    if pairs and gain(first, pairs[0]) > max(SECOND, SECOND_OF_ALL * gain(base, first)):
        # something the first does not explain lies along another effect
        verdict = standing(problem, base, pairs[0], pairs[1:])
        if second_earns(first, pairs[0]):
            return Decision(verdict, base, pairs[0], tuple(pairs[1:]))
        return Decision("unknown", base, pairs[0], tuple(pairs[1:]), faint=faint)
    verdict = standing(problem, base, first, singles[1:])
    if verdict == "unknown" and base.reduced < STRANGE and gain(base, first) < SECOND:
        # hardly felt here, so that there is no excess to explain; the hold-outs may hold one
        shown = "ambiguous" if confusable(first, singles[1:]) else "named"
        faint = faint or Decision(shown, base, first, tuple(singles[1:]), first=base)
    return Decision(verdict, base, first, tuple(singles[1:]), faint=faint)


def _faint(
    problem: Problem, base: Candidate, first: Candidate, pairs: list[Candidate]
) -> Decision | None:
    """A decision for the best pair, if it may stand."""
    if not pairs or gain(first, pairs[0]) < FAINT_SECOND:
        return None
    verdict = standing(problem, base, pairs[0], pairs[1:])
    if verdict == "unknown":
        return None
    return Decision(verdict, base, pairs[0], tuple(pairs[1:]), first=first)


def gain(before: Candidate, after: Candidate) -> float:
    """Fall of the mean squared innovation."""
    return before.reduced - after.reduced


def seconds(problem: Problem, singles: list[Candidate]) -> list[Candidate]:
    """Pairs from the two best singles, best first, each pair once."""
    found: dict[frozenset[str], Candidate] = {}
    for parent in singles[:2]:
        for pair in refine(problem, parent, 4):
            key = frozenset(pair.names)
            if key not in found or pair.chi2 < found[key].chi2:
                found[key] = pair
    return simplest_first(list(found.values()))


def simplest_first(found: list[Candidate]) -> list[Candidate]:
    """Best first; every further parameter must be worth `PARAMETER`."""
    return sorted(found, key=lambda candidate: candidate.reduced + PARAMETER * candidate.x.size)


def second_earns(first: Candidate, pair: Candidate) -> bool:
    """Whether the second effect is worth its name."""
    left = max(first.reduced - FLOOR, 1e-9)
    return gain(first, pair) / left > SECOND_SHARE


def standing(problem: Problem, base: Candidate, best: Candidate, rivals: list[Candidate]) -> str:
    """Named, ambiguous or unknown."""
    closed = gain(base, best) / max(base.reduced - QUIET, 1e-9)
    if best.reduced > QUIET and closed < ENOUGH:
        return "unknown"
    if float(np.max(cells(problem, best) - cells(problem, base))) > HURTS:
        return "unknown"
    if contradicted(problem, best):
        return "unknown"
    return "ambiguous" if confusable(best, rivals) else "named"


def contradicted(problem: Problem, best: Candidate) -> bool:
    """Whether a channel says no to an effect that others ask for.

    What an effect does to a channel, it must take away there. Teeth that are not evenly spaced
    ripple in the wheel speeds as a disc of uneven thickness does, but the car does not feel them.
    """
    after = problem.whitened(best.base, best.effects)
    for name in best.names:
        before = problem.whitened(best.base, best.effects.without(name))
        for channel in range(len(CHANNELS)):
            x = np.concatenate([run[channel] for run in before])
            y = np.concatenate([run[channel] for run in after])
            power = float(np.sum((x - y) ** 2))
            if power > FELT_POWER and float(x @ x - y @ y) < -0.5 * power:
                return True
    return False


def cells(problem: Problem, candidate: Candidate) -> Array:
    """Mean squared innovation by run and channel."""
    parts = problem.whitened(candidate.base, candidate.effects)
    return np.array([[float(np.mean(c**2)) for c in run] for run in parts])


def confusable(best: Candidate, rivals: list[Candidate] | tuple[Candidate, ...]) -> list[Candidate]:
    """Rivals that the data cannot tell from the best and that are no more complicated."""
    return [
        rival
        for rival in rivals
        if rival.reduced - best.reduced < CONFUSABLE
        and (rival.x.size <= best.x.size or rival.reduced < best.reduced - CONFUSABLE)
        and len(rival.names) <= len(best.names)
    ]
