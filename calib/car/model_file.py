"""A model as a TOML file: pads, tyre, effects. `brake-cal manual diagnosis` shows a file.

A file without pads or effects has those of the vehicle; ``[effects]`` replaces all effects of the
vehicle. Without ``[tyre]`` the tyre is that of wet asphalt. ``[own_effects.NAME]`` has the Python
file and the SHA-256 of an effect of the user.
"""

from collections.abc import Mapping
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, create_model, model_validator

from calib.base import record
from calib.base.errors import ModelError
from calib.base.record_errors import wrong
from calib.base.toml import load_toml, written_quantity
from calib.base.write import write_whole
from calib.car.effects import catalogue
from calib.car.effects.catalogue import OwnEffect
from calib.car.effects.effect import Effect
from calib.car.effects.effects import DefinedIn, Effects, EmpiricalTerm
from calib.car.effects.empirical import DRIVERS, PLACES
from calib.car.model import WET_ASPHALT, Model, default_model
from calib.car.vehicle import Vehicle

_Friction = Annotated[float, record.QuantityMark("1", 0.02, 1.0)]


class PadsSection(record.Section):
    """Pad friction of the axles; by default the nominal friction."""

    front: _Friction | None = None
    rear: _Friction | None = None


class _TyreSection(record.Section):
    """The tyre of both axles; by default that of wet asphalt."""

    stiffness: Annotated[float, record.QuantityMark("1", 1.0, 100.0)] | None = None
    peak: Annotated[float, record.QuantityMark("1", 0.02, 2.0)] | None = None
    # with 1 the force stays at the peak, with 2 the force falls to zero
    shape: Annotated[float, record.QuantityMark("1", 1.01, 1.99)] | None = None
    load_exponent: Annotated[float, record.QuantityMark("1", -1.0, 1.0)] | None = None
    bend: Annotated[float, record.QuantityMark("1", 0.0, 1.0)] | None = None
    relaxation: Annotated[float, record.QuantityMark("m", 0.0, 2.0)] | None = None
    peak_exponent: Annotated[float, record.QuantityMark("1", -1.0, 1.0)] | None = None


class _EmpiricalSection(record.Section):
    """An empirical term, as in `EmpiricalTerm`: values at the knots of a driver, in SI."""

    place: Annotated[str, record.OneOf(tuple(PLACES))]
    driver: Annotated[str, record.OneOf(tuple(DRIVERS))]
    knots: list[float]
    values: list[float]

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        is_increasing = all(b > a for a, b in pairwise(self.knots))
        if len(self.knots) != len(self.values) or not is_increasing:
            raise wrong("knots and values do not fit", "as many of each, knots increasing")
        return self


def _effects_section(effects: Mapping[str, Effect]) -> type[record.ByName]:
    """Return the schema of ``[effects]``, with an entry for each of these effects."""
    entries = {}
    for name, effect in effects.items():
        keys: dict[str, tuple[Any, Any]] = {}
        for p in effect.card.parameters:
            kind = Annotated[float, record.QuantityMark(p.unit, p.low, p.high)]
            keys[p.name] = (kind, ... if p.default is None else p.default)
        entries[name] = record.section(name, effect.card.cause, keys)
    description = "All effects of the car; without this section, those of the vehicle."
    return record.by_name("EffectsSection", entries, description)


class _DefinedInSection(record.Section):
    """The file of an effect of the user, as in `DefinedIn`."""

    file: str
    sha256: str = ""


class _OwnEffects(record.Section, extra="ignore"):
    """The first key of a model file to be read, since the schema of ``[effects]`` depends on it."""

    own_effects: dict[str, _DefinedInSection] = Field(default_factory=dict)


class ModelFile(record.FileSchema):
    """The model of a simulation, besides the vehicle."""

    pads: PadsSection = PadsSection()
    tyre: _TyreSection = _TyreSection()
    effects: _effects_section(catalogue.CATALOGUE) | None = None  # type: ignore[valid-type]
    own_effects: dict[str, _DefinedInSection] = Field(default_factory=dict)
    empirical: list[_EmpiricalSection] = Field(default_factory=list)


def read_model(path: Path, vehicle: Vehicle) -> Model:
    """Read a model file; parts that the file does not have are as in `default_model`.

    Effects of the user must be given with the vehicle, see `calib.car.effects.catalogue.with_own`.
    Raises ModelError for a file that is missing, not TOML or of another schema; for an unknown key,
    effect or unit; for a missing parameter; for a value out of its range; and for an effect of the
    user whose file was not given or has changed.
    """
    document = load_toml(Path(path), ModelError)
    own_effects = _user_defined(document, vehicle.effects, path)
    schema: type[ModelFile] = ModelFile
    if own_effects:
        allowed = catalogue.all_effects(Effects(user_defined=own_effects))
        effects: Any = _effects_section(allowed) | None
        schema = create_model("ModelFile", __base__=ModelFile, effects=(effects, None))
    file = record.validated(document, schema, path, ModelError)
    base = default_model(vehicle)
    named = base.effects.parameters
    if file.effects is not None:
        named = {name: dict(effect) for name, effect in file.effects.entries()}
    terms = tuple(
        EmpiricalTerm(term.place, term.driver, tuple(term.knots), tuple(term.values))
        for term in file.empirical
    )
    return replace(
        base,
        pad_friction_f=file.pads.front or base.pad_friction_f,
        pad_friction_r=file.pads.rear or base.pad_friction_r,
        tyre=replace(WET_ASPHALT, **file.tyre.model_dump(exclude_none=True)),
        effects=Effects(named, terms or base.effects.terms, user_defined=own_effects),
    )


def _user_defined(
    document: Mapping[str, Any], effects: Effects, path: Path
) -> dict[str, DefinedIn]:
    """Return the user's effects by name: those of the vehicle, and those that the model names.

    Raises ModelError for a file that was not given with --effect, or that has changed.
    """
    sections = record.validated(document, _OwnEffects, path, ModelError).own_effects
    named = {name: DefinedIn(entry.file, entry.sha256) for name, entry in sections.items()}
    by_user = {name: x for name, x in effects.user_defined.items() if isinstance(x, OwnEffect)}
    all_own = catalogue.with_files(named, by_user, path)
    return {name: catalogue.require_file(name, effect, path) for name, effect in all_own.items()}


def write_model(model: Model, path: Path) -> None:
    """Write a model file that `read_model` reads back exactly, with the same vehicle."""
    import tomlkit

    effects = model.effects
    named: dict[str, dict[str, Any]] = {}
    for name, values in effects.parameters.items():
        card = catalogue.definition(effects, name).card
        parameters = [p for p in card.parameters if p.name in values]
        named[name] = {p.name: written_quantity(values[p.name], p.unit) for p in parameters}
    document: dict[str, Any] = {
        "schema": 1,
        "pads": {"front": model.pad_friction_f, "rear": model.pad_friction_r},
        "tyre": {
            name: written_quantity(value, "m" if name == "relaxation" else "1")
            for name, value in asdict(model.tyre).items()
        },
        "effects": named,
    }
    if effects.defined_in:
        document["own_effects"] = {name: asdict(file) for name, file in effects.defined_in.items()}
    if effects.terms:
        document["empirical"] = [
            {**asdict(t), "knots": list(t.knots), "values": list(t.values)} for t in effects.terms
        ]
    write_whole(Path(path), tomlkit.dumps(document).encode())
