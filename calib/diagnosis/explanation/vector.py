"""The vector x that is fitted: the base parameters, then those of the effects."""

from dataclasses import dataclass, replace

from calib.car.effects.effect import Parameter
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.explanation.problem import DRAG, SHARE, Problem

STRENGTH, FURTHER = 2.0, 1.0
"""Standard deviations of the priors on the strength of an effect and on its further parameters, in
spreads of its card."""


@dataclass(frozen=True)
class Element:
    """A ``parameter`` of an ``effect``: x in units of its spread, counted from its ``origin``.

    That is the value of the vehicle file, if it has any; else the neutral one for a strength, the
    typical one for any other parameter. ``sigma`` is the standard deviation of the prior on x.
    """

    effect: str
    parameter: Parameter
    origin: float
    sigma: float

    @property
    def low(self) -> float:
        """Least x, by the card."""
        return (self.parameter.low - self.origin) / self.parameter.spread

    @property
    def high(self) -> float:
        """Largest x, by the card."""
        return (self.parameter.high - self.origin) / self.parameter.spread

    def value(self, x: float) -> float:
        """The parameter [SI]."""
        p = self.parameter
        return min(max(self.origin + x * p.spread, p.low), p.high)


def elements_of(known: Effects, name: str) -> list[Element]:
    """The parameters of one effect, beside those that the vehicle file has."""
    card = definition(known, name).card
    given = known.parameters.get(name, {card.parameters[0].name: card.neutral})
    sigmas = [STRENGTH, *[FURTHER] * (len(card.parameters) - 1)]
    pairs = zip(card.parameters, sigmas, strict=True)
    return [Element(name, p, given.get(p.name, p.typical), sigma) for p, sigma in pairs]


def elements(problem: Problem, names: tuple[str, ...]) -> list[Element]:
    """All behind the base: the load that a known drag moves where the file does not say, effects.

    That load is not sure to be as usual where the rest of the drag is known: its prior is wider.
    """
    known = problem.vehicle.effects
    out = [one for name in names for one in elements_of(known, name)]
    if problem.free_share:
        (share,) = (one for one in elements_of(known, DRAG) if one.parameter.name == SHARE)
        out.insert(0, replace(share, sigma=STRENGTH))
    return out
