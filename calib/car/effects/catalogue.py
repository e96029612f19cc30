"""The list of all effects.

A new effect needs its place in `EFFECTS` of the file of its link, in the order in which effects of
that link act, its card in `cards.csv` and its parameters in `parameters.csv`.
"""

from calib.car.effects import body, caliper, line, pads, sensors, wheels
from calib.car.effects.effect import CARDS, Effect

_CHAIN = {
    effect.card.name: effect
    for link in (line, caliper, pads, wheels, body, sensors)
    for effect in link.EFFECTS
}
CATALOGUE: dict[str, Effect] = {name: _CHAIN[name] for name in CARDS}

LINE = tuple(effect.card.name for effect in line.EFFECTS)
"""Effects between the master cylinder and the wheels, in the direction of flow."""

CALIPER = tuple(effect.card.name for effect in caliper.EFFECTS)
"""Effects in the caliper, behind a wheel pressure sensor."""

SENSOR = tuple(name for name, effect in _CHAIN.items() if effect.accelerometer is not None)
"""Effects on the accelerometer: those on the sensed acceleration first, then on the reading."""
