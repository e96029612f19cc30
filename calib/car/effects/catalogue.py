"""The catalogue of effects, and effects that the user defines in a Python file.

A new effect of the catalogue stands in `EFFECTS` of the file of its link, in the order in which
they act, with a card in `cards.csv` and its parameters in `parameters.csv`. Effects of the user
belong to the `Effects` of a vehicle or model; `calib.car.effects.effect_file` reads their files.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from calib.base.errors import ModelError
from calib.car.effects import body, hydraulics, pads, wheels
from calib.car.effects.effect import CARDS, Effect
from calib.car.effects.effects import DefinedIn, Effects
from calib.car.vehicle import Vehicle

_CHAIN = {
    effect.card.name: effect for link in (hydraulics, pads, wheels, body) for effect in link.EFFECTS
}
CATALOGUE: dict[str, Effect] = {name: _CHAIN[name] for name in CARDS}

LINE, CALIPER = (
    tuple(effect.card.name for effect in part) for part in (hydraulics.LINE, hydraulics.CALIPER)
)
SENSOR = tuple(name for name, effect in _CHAIN.items() if effect.accelerometer is not None)
"""Effects on the accelerometer: first on the acceleration that it feels, then on its reading."""


@dataclass(frozen=True, kw_only=True)
class OwnEffect(DefinedIn):
    """An effect of the user, read from its file; its hooks raise ModelError where they fail."""

    effect: Effect

    @property
    def name(self) -> str:
        """Return the name of the effect."""
        return self.effect.card.name


def definition(effects: Effects, name: str) -> Effect:
    """The effect of that name, of the user or of the catalogue.

    Raises ModelError for an unknown name, and for an effect of the user without its file.
    """
    if name in effects.user_defined:
        return with_file(name, effects.user_defined[name]).effect
    if name not in CATALOGUE:
        raise ModelError(
            f"unknown effect {name!r}",
            expected=f"one of {', '.join(CATALOGUE)}",
            do="see calib/car/effects; give --effect FILE.py for one of your own",
        )
    return CATALOGUE[name]


def every_effect(effects: Effects) -> dict[str, Effect]:
    """All effects by name: those of the catalogue, then those of the user with their file."""
    defined = effects.user_defined.items()
    return {**CATALOGUE, **{n: x.effect for n, x in defined if isinstance(x, OwnEffect)}}


def with_file(name: str, defined: DefinedIn, where: object = None) -> OwnEffect:
    """An effect of the user with its file. Raises ModelError where that was not given."""
    if isinstance(defined, OwnEffect):
        return defined
    raise ModelError(
        f"the effect {name!r} is defined in {defined.file}, which was not given",
        where=where,
        do=f"give --effect {defined.file}, with its folder; diagnose, simulate, fit and validate "
        "have this option",
    )


def with_own(vehicle: Vehicle, own_effects: Iterable[OwnEffect]) -> Vehicle:
    """The vehicle that knows these effects of the user; none of them acts yet.

    Raises ModelError for a file that differs from the one with which its parameters were fitted,
    and for two effects of one name.
    """
    files: dict[str, OwnEffect] = {}
    for effect in own_effects:
        if effect.name in files:
            raise ModelError(
                f"the effect {effect.name!r} is also defined in {files[effect.name].file}",
                where=effect.file,
                expected="another name",
            )
        files[effect.name] = effect
    defined = completed(vehicle.effects.user_defined, files, vehicle.name)
    return replace(vehicle, effects=replace(vehicle.effects, user_defined=defined))


def completed(
    defined: Mapping[str, DefinedIn], files: Mapping[str, DefinedIn], where: object
) -> dict[str, DefinedIn]:
    """The ``defined`` effects, with these ``files``. Raises ModelError where a file has changed."""
    for name, new in files.items():
        earlier = defined.get(name, new)
        if earlier.sha256 and earlier.sha256 != new.sha256:
            raise ModelError(
                f"{new.file} has changed since the parameters of {name!r} were found with it",
                where=where,
                expected=f"the file with the SHA-256 {earlier.sha256[:12]}...",
                do="take that file, or fit or diagnose again",
            )
    return {**defined, **files}
