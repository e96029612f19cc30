"""The model of a car for the simulation: vehicle, pads, tyre, effects."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from calib.base.errors import ModelError
from calib.base.toml import did_you_mean
from calib.base.units import unit_suffix
from calib.car.effects.catalogue import definition
from calib.car.effects.effect import Card
from calib.car.effects.effects import Effects
from calib.car.tyre import MagicFormula
from calib.car.vehicle import Vehicle

WET_ASPHALT = MagicFormula(stiffness=25.0, peak=0.9)  # a passenger car's; used if none is given


@dataclass(frozen=True)
class Model:
    """A car that can be simulated."""

    vehicle: Vehicle  # its pad friction and its effects are replaced by those here
    pad_friction_f: float  # [1]
    pad_friction_r: float  # [1]
    tyre: MagicFormula  # of both axles
    effects: Effects


def default_model(vehicle: Vehicle) -> Model:
    """Return the vehicle with nominal pads and its known effects, on wet asphalt.

    Raises ModelError if the vehicle names an effect or parameter that the catalogue does not know.

    >>> import calib
    >>> car = calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml")
    >>> model = calib.default_model(car)
    >>> model.pad_friction_f == car.front.pad_friction, model.tyre.peak, bool(model.effects)
    (True, 0.9, False)
    """
    for name, values in vehicle.effects.parameters.items():
        card = definition(vehicle.effects, name).card
        _require_valid(card, values, f"vehicle {vehicle.name}: effects.{name}")
    return Model(
        vehicle=vehicle,
        pad_friction_f=vehicle.front.pad_friction,
        pad_friction_r=vehicle.rear.pad_friction,
        tyre=WET_ASPHALT,
        effects=vehicle.effects,
    )


def with_effects(vehicle: Vehicle, model: Model) -> Vehicle:
    """Return the vehicle with the effects of a model added to its own."""
    return replace(vehicle, effects=vehicle.effects.with_(model.effects))


def with_model(vehicle: Vehicle, model: Model) -> Vehicle:
    """Return the vehicle with the pads of a model, and with its effects added to its own."""
    return with_effects(vehicle.with_pads(model.pad_friction_f, model.pad_friction_r), model)


def _require_valid(card: Card, values: Mapping[str, float], where: str) -> None:
    """Raise ModelError for a parameter that is unknown, missing or out of range."""
    allowed = {parameter.name: parameter for parameter in card.parameters}
    for key in values:
        if key not in allowed:
            expected, do = f"one of {', '.join(allowed)}", did_you_mean(key, allowed)
            raise ModelError(f"unknown key {key!r}", where=where, expected=expected, do=do)
    for key, parameter in allowed.items():
        if key in values and not parameter.low <= values[key] <= parameter.high:
            unit = unit_suffix(parameter.unit)
            flaw = f"{values[key]:g}{unit} is not believable"
            expected = f"{parameter.low:g} to {parameter.high:g}{unit}"
            raise ModelError(flaw, where=f"{where}.{key}", expected=expected)
        if key not in values and parameter.default is None:
            expected = f"a value for {key!r}"
            raise ModelError(f"key {key!r} is missing", where=where, expected=expected)
