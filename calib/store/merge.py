"""Merge the tables of several cars of one model into a mean table.

Each parent is the table of one car:

    parents --> curves and pads on common axes --> their mean and scatter --> the mean table
    parents --> draws of one more car --> maps of the mean table

`calib.store.mean` computes mean and scatter, with `calib.base.random_effects`.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from calib.base.errors import RevisionError
from calib.base.names import PROGRAM
from calib.base.random_effects import RandomEffects, random_effects
from calib.car.effects.effects import Effects
from calib.car.vehicle import UNCERTAINTIES, Vehicle
from calib.store.mean import inflated, mean_curves, mean_maps, mean_pads
from calib.store.version import Stored
from calib.table.compare import changes
from calib.table.table import FleetScatter, Provenance, Scatter, Table, TableReference

_MINIMUM, _SUM = ("deceleration_max", "eta_peak_is_real"), ("runs", "outliers")
"""Metrics of a fit whose minimum or sum stands in a mean table; of other metrics, the mean."""

_CAR_MARKS = ("serial", "vin")  # identifiers of one car
_LEAST_RANGE = 0.5  # of eta of a car, over the longest range [1]; the mean ends at the shortest
_SHARED_REMARK = (
    "what all cars share is in the mean as it is in each of them: mass, geometry and brakes of the "
    "vehicle file, the surface of the track, sensors that are wrong in one way, the method; its "
    "bands hold that, more cars do not shrink it"
)


def merge(parents: Sequence[Stored], name: str) -> Table:
    """Return the mean table of ``parents`` in any order, named ``name``.

    Its bands and sigmas are those of one more car of the model. Its `FleetScatter` holds the
    scatter between the cars and the error of the mean.

    Raises RevisionError with all reasons against a mean: fewer than two tables, a table that is
    unusable, is a mean itself or has a prior from other cars, a car or ramp twice, different
    vehicles, a range of eta that is too short, or the name of a parent.
    """
    flaws = [*_flaws_of_tables(parents), *_flaws_of_pairs(parents)]
    if len(parents) < 2:
        flaws = [f"a mean needs two cars or more, {len(parents)} was given"]
    if name in {parent.name for parent in parents}:
        flaws.append(f"the mean cannot be named {name!r}, as a car: take another name")
    if flaws:
        raise RevisionError("; ".join(flaws))
    parents = sorted(parents, key=lambda parent: (parent.name, parent.version, parent.digest))
    tables = [parent.table for parent in parents]
    curves, D_effects = mean_curves(tables)
    pads, pad_effects = mean_pads(tables)
    pad_map, level_map, draws = mean_maps(tables)
    return Table(
        name=name,
        vehicle=tables[0].vehicle,
        **curves,
        **pads,
        effects=_effects(tables),
        noise=_noise(tables),
        quality=_quality(tables),
        remarks=_remarks(parents),
        provenance=_provenance(parents),
        warnings=tuple(dict.fromkeys(w for table in tables for w in table.warnings)),
        spread=FleetScatter(len(tables), _scatters(D_effects), *_scatters(pad_effects)),
        map=pad_map,
        level_map=level_map,
        draws=draws,
    )


def _scatters(effects: RandomEffects) -> tuple[Scatter, ...]:
    pairs = zip(effects.between.tolist(), effects.sigma.tolist(), strict=True)
    return tuple(Scatter(between, of_mean) for between, of_mean in pairs)


def _effects(tables: Sequence[Table]) -> Effects:
    """Return the mean drag and rolling resistance, for one more car."""
    values: dict[str, dict[str, float]] = {}
    sigma: dict[str, dict[str, float]] = {}
    for effect, parameters in tables[0].effect_values.items():
        values[effect], sigma[effect] = {}, {}
        for parameter in parameters:
            cars = [table.effect_values[effect][parameter] for table in tables]
            x = np.array([[car.value] for car in cars])  # (cars, 1)
            scatter = random_effects(x, np.zeros_like(x))
            # errors of coasts come from road and wind: all cars share them
            shared = math.sqrt(np.mean([car.sigma**2 for car in cars]))
            values[effect][parameter] = float(scatter.mean[0])
            sigma[effect][parameter] = math.hypot(inflated(scatter)[0], shared)
    return Effects(values, sigma=sigma)


def _noise(tables: Sequence[Table]) -> dict[str, float]:
    """Return the root mean square over the cars of the noise of each sensor that all cars have."""
    sensors = [name for name in tables[0].noise if all(name in table.noise for table in tables)]
    squares = {name: [table.noise[name] ** 2 for table in tables] for name in sensors}
    return {name: float(np.sqrt(np.mean(of_cars))) for name, of_cars in squares.items()}


def _quality(tables: Sequence[Table]) -> dict[str, float]:
    """Return the number of cars, and the metrics of the fit that all tables have."""
    quality = {"cars": float(len(tables))}
    operations = dict.fromkeys(_MINIMUM, np.min) | dict.fromkeys(_SUM, np.sum)
    for name in tables[0].quality:
        if all(name in table.quality for table in tables):
            operation = operations.get(name, np.mean)
            quality[name] = float(operation([table.quality[name] for table in tables]))
    return quality


def _provenance(parents: Sequence[Stored]) -> Provenance:
    """Return the logs of all cars, and the settings with which all of them were fitted."""
    origins = [parent.table.provenance for parent in parents]
    first, *others = [origin.settings for origin in origins]
    same = {key: value for key, value in first.items() if all(s.get(key) == value for s in others)}
    return Provenance(
        logs=tuple(dict.fromkeys(log for origin in origins for log in origin.logs)),
        settings=same,
        program=PROGRAM,
        parents=tuple(TableReference(parent.id, parent.digest) for parent in parents),
    )


def _remarks(parents: Sequence[Stored]) -> tuple[str, ...]:
    ends = {parent.id: _end(parent) for parent in parents}
    shortest, longest = min(ends, key=ends.__getitem__), max(ends, key=ends.__getitem__)
    return (
        f"mean of {len(parents)} tables, taken as those of different cars that count alike; bands "
        "and sigmas are those of one more car of the model, by Student's t",
        f"curves end at eta {ends[shortest]:.5f}, where {shortest} ends; {longest} goes to "
        f"{ends[longest]:.5f}",
        _SHARED_REMARK,
    )


def _end(parent: Stored) -> float:
    return float(parent.table.difference.eta[-1])


def _flaws_of_tables(parents: Sequence[Stored]) -> Iterator[str]:
    """Yield what speaks against each table as a parent of a mean."""
    longest = max(map(_end, parents), default=1.0)
    for parent in parents:
        end = _end(parent)
        if not (parent.state.usable and parent.state.in_store):
            yield f"{parent.id} is {parent.state.description}; leave it out"
        if parent.table.spread is not None:
            yield f"{parent.id} is a mean of cars itself; merge the cars it was made of"
        if parent.table.fleet:
            yield f"{parent.id} has a prior from other cars; fit it without --fleet-prior"
        if end - 1.0 < _LEAST_RANGE * (longest - 1.0):
            yield f"{parent.id} ends at eta {end:.5f}, the longest at {longest:.5f}; leave it out"


def _flaws_of_pairs(parents: Sequence[Stored]) -> Iterator[str]:
    """Yield what speaks against each pair of tables in one mean."""
    for a, b in combinations(parents, 2):
        for mark in _CAR_MARKS:
            identity = a.table.provenance.identity.get(mark)
            if identity and identity == b.table.provenance.identity.get(mark):
                cars = f"{a.id} and {b.id} are of one car ({mark} {identity})"
                yield f"{cars}; give one of them, or fit its ramps together"
        if a.ramp_digests & b.ramp_digests:
            yield f"{a.id} and {b.id} are made of the same ramp"
        differences = vehicle_differences(a.table, b.table.vehicle)
        if differences:
            yield f"{a.id} and {b.id} are of different vehicles: {', '.join(differences[:4])}"


def vehicle_differences(table: Table, vehicle: Vehicle) -> list[str]:
    """Return how a table's vehicle differs from another, apart from names and uncertainties."""
    changed = changes(table, replace(table, vehicle=vehicle))
    sections = ("vehicle", "empirical", "own_effects")
    of_vehicle = [change for section in sections for change in changed.get(section, ())]
    relevant = [change for change in of_vehicle if change.key not in ("name", *UNCERTAINTIES)]
    return [f"{change.key} {change.a} and {change.b}" for change in relevant]
