"""The catalogue of effects, and effects that the user defines in a Python file.

An effect of the catalogue is an entry of `EFFECTS` in `hydraulics`, `pads`, `wheels` or `body`, in
the order in which the effects act. Its card is in `cards.csv`, its parameters in `parameters.csv`.
An effect of the user is in `Effects.user_defined` of a vehicle or a model: as an `OwnEffect` if its
file was given and read (`calib.car.effects.effect_file`), else as a `DefinedIn`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from calib.base.errors import ModelError
from calib.car.effects import body, hydraulics, pads, wheels
from calib.car.effects.effect import CARDS, Effect
from calib.car.effects.effects import DefinedIn, Effects
from calib.car.vehicle import Vehicle

_IN_ORDER = (*hydraulics.EFFECTS, *pads.EFFECTS, *wheels.EFFECTS, *body.EFFECTS)
_BY_NAME = {effect.card.name: effect for effect in _IN_ORDER}
CATALOGUE: dict[str, Effect] = {name: _BY_NAME[name] for name in CARDS}
"""The effects of the catalogue by name, in the order of `CARDS`."""

LINE_EFFECTS = tuple(effect.card.name for effect in hydraulics.LINE)
CALIPER_EFFECTS = tuple(effect.card.name for effect in hydraulics.CALIPER)
SENSOR_EFFECTS = tuple(effect.card.name for effect in _IN_ORDER if effect.accelerometer is not None)
"""Effects on the accelerometer in their order: gravity that it feels, then errors of the sensor."""


@dataclass(frozen=True, kw_only=True)
class OwnEffect(DefinedIn):
    """An effect of the user, read from its file; its hooks raise ModelError where they fail."""

    effect: Effect

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.card.name


def definition(effects: Effects, name: str) -> Effect:
    """Return the effect of that name, of the user or of the catalogue.

    Raises ModelError for an unknown name, and for an effect of the user without its file.
    """
    if name in effects.user_defined:
        return require_file(name, effects.user_defined[name]).effect
    if name not in CATALOGUE:
        expected = f"one of {', '.join(CATALOGUE)}"
        do = "see calib/car/effects; give --effect FILE.py for one of your own"
        raise ModelError(f"unknown effect {name!r}", expected=expected, do=do)
    return CATALOGUE[name]


def all_effects(effects: Effects) -> dict[str, Effect]:
    """All effects by name: the catalogue, then the effects of the user whose file was given."""
    defined = effects.user_defined.items()
    return CATALOGUE | {name: x.effect for name, x in defined if isinstance(x, OwnEffect)}


def require_file(name: str, defined: DefinedIn, where: object = None) -> OwnEffect:
    """Return an effect of the user. Raises ModelError if its file was not given."""
    if isinstance(defined, OwnEffect):
        return defined
    flaw = f"the effect {name!r} is defined in {defined.file}, which was not given"
    option = f"--effect {defined.file}, with its folder"
    do = f"give {option}; diagnose, simulate, fit and validate have this option"
    raise ModelError(flaw, where=where, do=do)


def with_own(vehicle: Vehicle, own_effects: Iterable[OwnEffect]) -> Vehicle:
    """Return the vehicle with these effects of the user, which do not yet act.

    Raises ModelError for two effects of one name, and for a file other than that of an earlier fit.
    """
    files: dict[str, OwnEffect] = {}
    for effect in own_effects:
        if effect.name in files:
            flaw = f"the effect {effect.name!r} is also defined in {files[effect.name].file}"
            raise ModelError(flaw, where=effect.file, expected="another name")
        files[effect.name] = effect
    defined = with_files(vehicle.effects.user_defined, files, vehicle.name)
    return replace(vehicle, effects=replace(vehicle.effects, user_defined=defined))


def with_files(
    defined: Mapping[str, DefinedIn], files: Mapping[str, DefinedIn], where: object
) -> dict[str, DefinedIn]:
    """Return ``defined`` and ``files`` together, by effect; a given file replaces a definition.

    Raises ModelError for a file that has changed since the effect was defined.
    """
    for name, given_file in files.items():
        earlier = defined.get(name, given_file)
        if earlier.sha256 and earlier.sha256 != given_file.sha256:
            flaw = f"{given_file.file} has changed since the parameters of {name!r} were found"
            expected = f"the file with the SHA-256 {earlier.sha256[:12]}..."
            do = "take that file, or fit or diagnose again"
            raise ModelError(flaw, where=where, expected=expected, do=do)
    return {**defined, **files}
