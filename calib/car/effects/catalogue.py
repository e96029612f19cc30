"""The list of all effects, and those of the user's own, which a Python file defines.

A new effect needs its place in `EFFECTS` of the file of its link, in the order in which effects of
that link act, its card in `cards.csv` and its parameters in `parameters.csv`. Own effects are part
of the value `Effects`, that of a vehicle or a model: two cars in one program may have different
ones. `calib.car.effects.effect_file` reads such a file.
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
"""Effects on the accelerometer: those on the sensed acceleration first, then on the reading."""


@dataclass(frozen=True, kw_only=True)
class OwnEffect(DefinedIn):
    """An effect whose file was given. Its hooks raise ModelError where they go wrong."""

    effect: Effect

    @property
    def name(self) -> str:
        """Name of the effect, by its card."""
        return self.effect.card.name


def definition(effects: Effects, name: str) -> Effect:
    """The effect of that name: one of ``effects.own``, or of the catalogue.

    Raises ModelError for an unknown name, and for an own effect whose file was not given.
    """
    if name in effects.own:
        return given(name, effects.own[name]).effect
    if name not in CATALOGUE:
        raise ModelError(
            f"unknown effect {name!r}",
            expected=f"one of {', '.join(CATALOGUE)}",
            do="see calib/car/effects; give --effect FILE.py for one of your own",
        )
    return CATALOGUE[name]


def every_effect(effects: Effects) -> dict[str, Effect]:
    """All effects by name: those of the catalogue, then the own ones whose files were given."""
    own = {n: one.effect for n, one in effects.own.items() if isinstance(one, OwnEffect)}
    return {**CATALOGUE, **own}


def given(name: str, own: DefinedIn, where: object = None) -> OwnEffect:
    """An own effect with its file. Raises ModelError where that was not given."""
    if isinstance(own, OwnEffect):
        return own
    raise ModelError(
        f"the effect {name!r} is defined in {own.file}, which was not given",
        where=where,
        do=f"give --effect {own.file}, with its folder; diagnose, simulate, fit and validate "
        "have this option",
    )


def with_own(vehicle: Vehicle, own: Iterable[OwnEffect]) -> Vehicle:
    """The vehicle, which may then have these effects; none of them acts by that.

    Raises ModelError for a file that is not the one with which its effects were fitted, and for two
    effects of one name.
    """
    files: dict[str, OwnEffect] = {}
    for one in own:
        if one.name in files:
            raise ModelError(
                f"the effect {one.name!r} is also defined in {files[one.name].file}",
                where=one.file,
                expected="another name",
            )
        files[one.name] = one
    effects = replace(vehicle.effects, own=completed(vehicle.effects.own, files, vehicle.name))
    return replace(vehicle, effects=effects)


def completed(
    defined: Mapping[str, DefinedIn], files: Mapping[str, DefinedIn], where: object
) -> dict[str, DefinedIn]:
    """``defined``, completed by these ``files``. Raises ModelError where one has changed.

    ``where`` is what names the definitions, for the message.
    """
    for name, own in files.items():
        known = defined.get(name, own)
        if known.sha256 and known.sha256 != own.sha256:
            raise ModelError(
                f"{own.file} has changed since the parameters of {name!r} were found with it",
                where=where,
                expected=f"the file with the SHA-256 {known.sha256[:12]}...",
                do="take that file, or fit or diagnose again",
            )
    return {**defined, **files}
