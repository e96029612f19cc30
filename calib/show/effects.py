"""Facts of the catalogue of effects."""

from collections.abc import Sequence

from calib.base.units import behind
from calib.car.effects.effect import Card
from calib.show.facts import Facts, Table


def cards(found: Sequence[Card]) -> Facts:
    """Each effect with its cause."""
    return Facts(tables=[Table(("effect", "cause"), [(one.name, one.cause) for one in found])])


def card(one: Card) -> Facts:
    """The card of an effect; its parameters as expected value, spread and range."""
    head = ("name", "cause", "equation", "source", "looks_like")
    rows = [(name.replace("_", " "), str(getattr(one, name))) for name in head]
    for p in one.parameters:
        unit = behind(p.unit)
        usual = f"{p.typical:g} +- {p.spread:g}{unit}, from {p.low:g} to {p.high:g}{unit}"
        rows.append((p.name, usual))
    return Facts(rows=rows)
