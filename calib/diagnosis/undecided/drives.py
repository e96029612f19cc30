"""Effects that the logs could not have shown, and for each the drive that would show it most."""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.car.effects.effect import Card
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition, every_effect
from calib.diagnosis.explanation.explanation import Explanation, marginal
from calib.diagnosis.search.rank import Further
from calib.diagnosis.undecided.separate import best_drives, own_of

_SHOWN = 5.0
"""Size [sigma] from which logs show an effect: ln of the odds is 7 then, less its price of 5."""

_CLEAR = 10.0
"""Size [sigma] from which a drive shows an effect surely."""


@dataclass(frozen=True)
class ShowingDrive:
    """The manoeuvre in which the effect of a ``card``, at its usual size, shows most.

    ``sigma`` is what no other parameter can imitate there, over the noise.
    """

    card: Card
    name: str
    sigma: float

    @property
    def effect(self) -> str:
        """Name of the effect."""
        return self.card.name

    @property
    def clear(self) -> bool:
        """Whether the drive would show the effect, and not only show it best."""
        return self.sigma > _CLEAR


def unresolved(at: Explanation, further: Further) -> tuple[str, ...]:
    """Effects of usual size that these logs could not have shown, beside an explanation.

    Effects that the vehicle file has are known, and not among them.
    """
    tried, columns = further
    products = [at.products_of(i, of_run) for i, of_run in enumerate(columns)]
    E, _ = marginal(at, products, at.hypothesis.sizes).beyond()
    known, size = at.problem.vehicle.effects, dict[str, float]()
    for one, square in zip(tried, E.diagonal().tolist(), strict=True):
        card = every_effect(known)[one.name].card
        strength = card.parameters[0]
        times = (card.usual[strength.name] - card.neutral) / strength.spread
        size.setdefault(one.name, times**2 * square)  # the first is tried at usual further ones
    return tuple(n for n, square in size.items() if n not in at.effects and square < _SHOWN**2)


def drives(at: Explanation, names: Sequence[str]) -> tuple[ShowingDrive, ...]:
    """The best drive for each of the effects ``names``, on top of what explains the logs."""
    if not names:
        return ()
    base, effects = own_of(at)
    cards = [definition(at.problem.vehicle.effects, name).card for name in names]
    others = [(base, effects.with_(Effects({card.name: card.usual}))) for card in cards]
    best = best_drives(at, others)
    return tuple(ShowingDrive(c, *found) for c, found in zip(cards, best, strict=True))
