"""The model of a car for the simulation: vehicle, pads, tyre, effects, and the road under it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.base.toml import did_you_mean
from calib.base.units import behind
from calib.car.effects.catalogue import definition
from calib.car.effects.effect import Card
from calib.car.effects.effects import Effects
from calib.car.lag import integral
from calib.car.tyre import MagicFormula
from calib.car.vehicle import Vehicle

WET_ASPHALT = MagicFormula(stiffness=25.0, peak=0.9)
"""The tyre that is assumed when nothing is known: a passenger car on wet asphalt."""


@dataclass(frozen=True)
class Surface:
    """A change of road: factors on stiffness and peak of the model's tyre from ``start`` on.

    ``start`` is a distance of the front axle [m] or a time [s], as ``unit`` says; the rear axle
    meets the change one wheelbase later.
    """

    start: float
    unit: str
    stiffness: float
    peak: float


@dataclass(frozen=True)
class Model:
    """A car that can be simulated.

    Attributes
    ----------
    vehicle : masses, lengths, brakes; its list of effects does not count.
    pad_friction_f, pad_friction_r : mu_p of the axles [1].
    tyre : common to both axles.
    effects : all effects that act in it.
    surfaces : changes of road, in order of their start.
    """

    vehicle: Vehicle
    pad_friction_f: float
    pad_friction_r: float
    tyre: MagicFormula
    effects: Effects
    surfaces: tuple[Surface, ...] = ()


def default_model(vehicle: Vehicle) -> Model:
    """Return the vehicle with nominal pads and its known effects, on wet asphalt.

    Raises ModelError if the vehicle names an effect or parameter that the catalogue does not know.

    >>> import calib
    >>> car = calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml")
    >>> model = calib.default_model(car)
    >>> model.pad_friction_f == car.front.pad_friction, model.tyre.peak, bool(model.effects)
    (True, 0.9, False)
    """
    where = f"vehicle {vehicle.name}: effects"
    named = {
        name: _checked(definition(vehicle.effects, name).card, values, f"{where}.{name}")
        for name, values in vehicle.effects.parameters.items()
    }
    return Model(
        vehicle=vehicle,
        pad_friction_f=vehicle.front.pad_friction,
        pad_friction_r=vehicle.rear.pad_friction,
        tyre=WET_ASPHALT,
        effects=replace(vehicle.effects, parameters=named),
    )


def with_effects(vehicle: Vehicle, model: Model) -> Vehicle:
    """Return the vehicle with the effects of a model added to its own."""
    return replace(vehicle, effects=vehicle.effects.with_(model.effects))


def with_model(vehicle: Vehicle, model: Model) -> Vehicle:
    """Return the vehicle with the pads of a model, and with its effects added to its own."""
    return with_effects(vehicle.with_pads(model.pad_friction_f, model.pad_friction_r), model)


def _checked(card: Card, values: Mapping[str, float], where: str) -> dict[str, float]:
    """Parameters [SI] of one effect. Raises ModelError where its card does not allow them."""
    cards = {p.name: p for p in card.parameters}
    for key in values:
        if key not in cards:
            expected, do = f"one of {', '.join(cards)}", did_you_mean(key, cards)
            raise ModelError(f"unknown key {key!r}", where=where, expected=expected, do=do)
    for key, parameter in cards.items():
        if key in values and not parameter.low <= values[key] <= parameter.high:
            raise ModelError(
                f"{values[key]:g}{behind(parameter.unit)} is not believable",
                where=f"{where}.{key}",
                expected=f"{parameter.low:g} to {parameter.high:g}{behind(parameter.unit)}",
            )
        if key not in values and parameter.default is None:
            expected = f"a value for {key!r}"
            raise ModelError(f"key {key!r} is missing", where=where, expected=expected)
    return dict(values)


_RELAXATION_LENGTH = 0.3
"""Length [m] over which a tyre changes to a new surface; 0.2 to 0.5 m for a passenger car."""


def tyres_along(model: Model, time: Array, v: Array) -> tuple[MagicFormula, MagicFormula]:
    """Tyres of the front and the rear axle on their surface, at every sample."""
    if not model.surfaces:
        return model.tyre, model.tyre
    distance = integral(time, v)
    front = _tyre_at(model, time, distance, 0.0)
    return front, _tyre_at(model, time, distance, model.vehicle.wheelbase)


def _tyre_at(model: Model, time: Array, distance: Array, offset: float) -> MagicFormula:
    """The tyre of an axle ``offset`` [m] behind the front one, which is at ``distance`` [m]."""
    starts, factors = [], [(1.0, 1.0)]
    for surface in model.surfaces:
        on_road = surface.unit == "m"
        starts.append(surface.start if on_road else np.interp(surface.start, time, distance))
        factors.append((surface.stiffness, surface.peak))
    points = np.ravel([[start, start + _RELAXATION_LENGTH] for start in starts])
    logs = np.repeat(np.log(factors), 2, axis=0)[1:-1]
    stiffness, peak = (np.exp(np.interp(distance - offset, points, c)) for c in logs.T)
    return model.tyre.on_surface(stiffness, peak)
