"""The effects of a table as figures: value, unit and 95 % interval of each parameter."""

from collections.abc import Iterator
from dataclasses import dataclass

from calib.car.effects.effect import Parameter
from calib.car.own_effects.own_effect import every_effect
from calib.table.table import Table, Value


@dataclass(frozen=True)
class EffectFigure:
    """A parameter of an effect: ``value`` and ``ci95`` [``unit``].

    ``ci95`` is the interval of the value's sigma, cut at the range of the effect's card: no drag is
    negative. ``unit`` is "SI" for an effect of the user's own whose file was not given.
    """

    effect: str
    name: str
    value: Value
    unit: str
    ci95: tuple[float, float]

    def __str__(self) -> str:
        low, high = self.ci95
        unit = "" if self.unit == "1" else f" {self.unit}"
        within = f"95 %: {low:.4g} to {high:.4g}" if low < high else "given"
        return f"{self.name} {self.value.value:.4g}{unit} ({within})"


def effect_figures(table: Table) -> Iterator[EffectFigure]:
    """Every parameter of the effects of a table, in the order of its record."""
    known = every_effect(table.vehicle.effects)
    for effect, values in table.effect_values.items():
        card = known[effect].card if effect in known else None
        parameters = {p.name: p for p in card.parameters} if card else {}
        for name, value in values.items():
            yield _figure(effect, name, value, parameters.get(name))


def _figure(effect: str, name: str, value: Value, of: Parameter | None) -> EffectFigure:
    low, high = value.ci95
    if of is None:
        return EffectFigure(effect, name, value, "SI", (low, high))
    cut = (max(low, min(of.low, value.value)), min(high, max(of.high, value.value)))
    return EffectFigure(effect, name, value, of.unit, cut)
