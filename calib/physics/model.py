"""What the simulation needs besides the vehicle, as a value and as a file.

schema = 1
[pads]                        # friction [1]; nominal when left out
front = 0.38
rear = 0.36
[tyre]                        # wet asphalt for what is left out
stiffness = 25.0
peak = 0.9
[effects.aerodynamic_drag]    # [effects] is the whole list; the vehicle's when left out
drag_area = "0.66 m^2"
[[surfaces]]                  # factors on the tyre, from a distance or a time on
start = "60 m"
stiffness = 0.8
peak = 0.5
[empirical]                   # over a driver in SI, see calib/physics/effects/empirical.py;
                              # several terms are written with [[empirical]]
place = "front_brakes"
driver = "speed"
knots = [5.0, 20.0, 35.0]
values = [0.0, -0.05, -0.1]
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from calib.errors import ModelError
from calib.files import write_whole
from calib.physics.effects.catalogue import CATALOGUE, effect_named
from calib.physics.effects.effects import Effects, EmpiricalTerm
from calib.physics.effects.empirical import DRIVERS, PLACES
from calib.physics.magic_formula import MagicFormula
from calib.physics.vehicle import Vehicle
from calib.toml import did_you_mean

WET_ASPHALT = MagicFormula(stiffness=25.0, peak=0.9)
"""What is assumed of a tyre when nothing is known: a passenger car on wet asphalt."""


@dataclass(frozen=True)
class Surface:
    """A change of road: factors on stiffness and peak of the tyre from ``start`` on.

    ``start`` is a distance of the front axle [m] or a time [s], as ``unit`` says; the rear axle
    meets the change one wheelbase later. Factors are relative to the model's tyre.
    """

    start: float
    unit: str
    stiffness: float
    peak: float


@dataclass(frozen=True)
class Model:
    """A car that can be driven forward.

    Attributes
    ----------
    vehicle : masses, lengths, brakes. Its own list of effects is not read here.
    pad_friction_f, pad_friction_r : mu_p of the axles [1].
    tyre : common to both axles.
    effects : all that act in it.
    surfaces : changes of road, in the order in which they are met.
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
    >>> model.pad_friction_f == car.front.pad_friction, model.tyre.peak, model.effects
    (True, 0.9, {})
    """
    where = f"vehicle {vehicle.name}: effects"
    given = vehicle.effects.parameters
    named = {name: _believable(name, own, f"{where}.{name}") for name, own in given.items()}
    return Model(
        vehicle=vehicle,
        pad_friction_f=vehicle.front.pad_friction,
        pad_friction_r=vehicle.rear.pad_friction,
        tyre=WET_ASPHALT,
        effects=replace(vehicle.effects, parameters=named),
    )


def read_model(path: Path, vehicle: Vehicle) -> Model:
    """Read a model file; what it leaves out is as in `default_model`.

    Raises ModelError for a file that is missing, not TOML or of another schema; for an unknown key,
    effect or unit; for a missing parameter; for a value out of its range.
    """
    path = Path(path)
    table = read_toml(path, SCHEMA, ModelError)
    check_keys(table, ("pads", "tyre", "effects", "surfaces", "empirical"), (), path, ModelError)
    base = default_model(vehicle)
    pads = _numbers(table.get("pads", {}), _PADS, f"{path}: pads")
    return Model(
        vehicle=vehicle,
        pad_friction_f=pads.get("front", base.pad_friction_f),
        pad_friction_r=pads.get("rear", base.pad_friction_r),
        tyre=_tyre(table.get("tyre", {}), f"{path}: tyre"),
        effects=Effects(
            _effects(table["effects"], path) if "effects" in table else base.effects.parameters,
            _terms(table["empirical"], path) if "empirical" in table else base.effects.terms,
        ),
        surfaces=_surfaces(table.get("surfaces", []), path),
    )


def write_model(model: Model, path: Path) -> None:
    """Write a model file that `read_model` reads back exactly, with the same vehicle.

    Raises OSError if ``path`` cannot be written.
    """
    lines = [f"schema = {SCHEMA}", "", "[pads]"]
    lines += [f"front = {model.pad_friction_f!r}", f"rear = {model.pad_friction_r!r}", "", "[tyre]"]
    lines += [f"{f.name} = {float(getattr(model.tyre, f.name))!r}" for f in fields(MagicFormula)]
    lines += ["", "[effects]"]
    for name, parameters in model.effects.parameters.items():
        lines += ["", f"[effects.{name}]"]
        for parameter in effect_named(name).card.parameters:
            value, unit = float(parameters[parameter.name]), parameter.unit
            written = repr(value) if unit == "1" else f'"{value!r} {unit}"'
            lines.append(f"{parameter.name} = {written}")
    for surface in model.surfaces:
        lines += ["", "[[surfaces]]", f'start = "{surface.start!r} {surface.unit}"']
        lines += [f"stiffness = {surface.stiffness!r}", f"peak = {surface.peak!r}"]
    head = "[empirical]" if len(model.effects.terms) == 1 else "[[empirical]]"
    for term in model.effects.terms:
        lines += ["", head, f'place = "{term.place}"', f'driver = "{term.driver}"']
        lines += [f"knots = {list(term.knots)!r}", f"values = {list(term.values)!r}"]
    write_whole(Path(path), "\n".join([*lines, ""]).encode())


def with_effects(vehicle: Vehicle, model: Model) -> Vehicle:
    """Return the vehicle with the effects of a model known beside its own."""
    return replace(vehicle, effects=vehicle.effects.with_(model.effects))


def with_model(vehicle: Vehicle, model: Model) -> Vehicle:
    """Return the vehicle with the pads of a model, and with its effects known beside its own."""
    front = replace(vehicle.front, pad_friction=model.pad_friction_f)
    rear = replace(vehicle.rear, pad_friction=model.pad_friction_r)
    return with_effects(replace(vehicle, front=front, rear=rear), model)


Range = tuple[float, float]
_PADS: dict[str, Range] = {"front": (0.02, 1.0), "rear": (0.02, 1.0)}
# Shape 1 never falls past the peak, 2 falls to zero: outside, the closed inverse does not hold.
_TYRE: dict[str, Range] = {
    "stiffness": (1.0, 100.0),
    "peak": (0.02, 2.0),
    "shape": (1.01, 1.99),
    "load_exponent": (-1.0, 1.0),
}
_SURFACE: dict[str, Range] = {"stiffness": (0.05, 20.0), "peak": (0.05, 20.0)}


def _numbers(table: object, ranges: dict[str, Range], where: str) -> dict[str, float]:
    values = check_keys(table, ranges, (), where, ModelError)
    return {
        key: _within(
            quantity(value, "1", f"{where}.{key}", ModelError), ranges[key], "1", f"{where}.{key}"
        )
        for key, value in values.items()
    }


def _within(value: float, bounds: Range, unit: str, where: str) -> float:
    if not bounds[0] <= value <= bounds[1]:
        raise ModelError(
            f"{value:g} is out of range",
            where=where,
            expected=f"{bounds[0]:g} to {bounds[1]:g} {unit}",
        )
    return value


def _tyre(table: object, where: str) -> MagicFormula:
    given = _numbers(table, _TYRE, where)
    return MagicFormula(**{key: given.get(key, getattr(WET_ASPHALT, key)) for key in _TYRE})


def _effects(table: object, path: Path) -> dict[str, dict[str, float]]:
    where = f"{path}: effects"
    named = check_keys(table, CATALOGUE, (), where, ModelError)
    return {name: _parameters(name, values, f"{where}.{name}") for name, values in named.items()}


def _parameters(name: str, table: object, where: str) -> dict[str, float]:
    """Read the parameters of one effect, each with the unit of its card."""
    units = {p.name: p.unit for p in CATALOGUE[name].card.parameters}
    given = check_keys(table, units, tuple(units), where, ModelError)
    values = {k: quantity(v, units[k], f"{where}.{k}", ModelError) for k, v in given.items()}
    return _believable(name, values, where)


def _believable(name: str, values: Mapping[str, float], where: str) -> dict[str, float]:
    """Check parameters [SI] of one effect against its card."""
    cards = {p.name: p for p in effect_named(name).card.parameters}
    check_keys(dict(values), cards, tuple(cards), where, ModelError)
    for key, card in cards.items():
        _within(values[key], (card.low, card.high), card.unit, f"{where}.{key}")
    return dict(values)


def _surfaces(tables: object, path: Path) -> tuple[Surface, ...]:
    if not isinstance(tables, list):
        raise ModelError(
            f"surfaces = {tables!r}", where=path, expected="[[surfaces]] with double brackets"
        )
    return tuple(_surface(t, f"{path}: surfaces[{i}]") for i, t in enumerate(tables))


def _surface(table: object, where: str) -> Surface:
    keys = ("start", *_SURFACE)
    values = dict(check_keys(table, keys, keys, where, ModelError))
    start, unit = _start(values.pop("start"), f"{where}.start")
    return Surface(start, unit, **_numbers(values, _SURFACE, where))


def _start(written: object, where: str) -> tuple[float, str]:
    for unit in ("m", "s"):
        try:
            return quantity(written, unit, where, ModelError), unit
        except ModelError:
            continue
    raise ModelError(
        f"{written!r} is neither a distance nor a time", where=where, expected='"60 m" or "3 s"'
    )


def _terms(tables: object, path: Path) -> tuple[EmpiricalTerm, ...]:
    if not isinstance(tables, list):
        return (_term(tables, f"{path}: empirical"),)
    return tuple(_term(t, f"{path}: empirical[{i}]") for i, t in enumerate(tables))


def _term(table: object, where: str) -> EmpiricalTerm:
    keys = ("place", "driver", "knots", "values")
    given = check_keys(table, keys, keys, where, ModelError)
    for key, known in (("place", PLACES), ("driver", DRIVERS)):
        if given[key] not in known:
            raise ModelError(
                f"unknown key {key!r}",
                where=where,
                expected=f"one of {', '.join(cards)}",
                do=did_you_mean(key, cards),
            )
    rows = {key: _row(given[key], f"{where}.{key}") for key in ("knots", "values")}
    knots = rows["knots"]
    if len(knots) != len(rows["values"]) or any(b <= a for a, b in pairwise(knots)):
        raise ModelError("knots and values", where=where, expected="as many, knots increasing")
    return EmpiricalTerm(str(given["place"]), str(given["driver"]), knots, rows["values"])


def _row(value: object, where: str) -> tuple[float, ...]:
    if not isinstance(value, list) or not all(
        isinstance(v, int | float) and not isinstance(v, bool) for v in value
    ):
        raise ModelError(f"{value!r}", where=where, expected="a list of numbers")
    return tuple(float(v) for v in value)
