"""The mean table of several cars of one model, by `calib.base.random_effects`.

CAR@1, CAR@2, ... --> common axes --> mean and scatter of D, g, pads, tyre --> one table
                  --> draws of one more car --> its maps
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

_LEAST = ("deceleration_max", "eta_peak_is_real")
_SUM = ("runs", "outliers")
"""Metrics of a fit of which a mean table has the minimum or the sum; of others it has the mean."""

_CAR_MARKS = ("serial", "vin")  # identifiers of one car

_LEAST_RANGE = 0.5
"""Share of the longest range of eta that every table must cover [1], since the mean ends with the
shortest."""

_SHARED = (
    "what all cars share is in the mean as it is in each of them: mass, geometry and brakes of the "
    "vehicle file, the surface of the track, sensors that are wrong in one way, the method; its "
    "bands hold that, more cars do not shrink it"
)


def merge(parents: Sequence[Stored], name: str) -> Table:
    """Return the mean table of ``parents`` in any order, named ``name``.

    Its bands and sigmas are those of one more car of the model. Its `FleetScatter` holds the
    scatter between the cars and the error of the mean.

    Raises RevisionError with all reasons against a mean: fewer than two tables; a table that is
    unusable, is a mean itself or rests on other cars; a car or ramp twice; different vehicles; a
    range of eta that is too short; the name of a parent.
    """
    flaws = [*_each(parents), *_pairs(parents)]
    if len(parents) < 2:
        flaws = [f"a mean needs two cars or more, {len(parents)} was given"]
    if name in {p.name for p in parents}:
        flaws.append(f"the mean cannot be named {name!r}, as a car: take another name")
    if flaws:
        raise RevisionError("; ".join(flaws))
    parents = sorted(parents, key=lambda p: (p.name, p.version, p.digest))
    tables = [p.table for p in parents]
    curves, D_effects = mean_curves(tables)
    pads, pad_effects = mean_pads(tables)
    pad_map, level_map, draws = mean_maps(tables)
    sensors = [n for n in tables[0].noise if all(n in t.noise for t in tables)]
    return Table(
        name=name,
        vehicle=tables[0].vehicle,
        **curves,
        **pads,
        effects=_effects(tables),
        noise={n: float(np.sqrt(np.mean([t.noise[n] ** 2 for t in tables]))) for n in sensors},
        quality=_quality(tables),
        remarks=_remarks(parents),
        provenance=_provenance(parents),
        warnings=tuple(dict.fromkeys(w for t in tables for w in t.warnings)),
        spread=FleetScatter(len(tables), _scatters(D_effects), *_scatters(pad_effects)),
        map=pad_map,
        level_map=level_map,
        draws=draws,
    )


def _scatters(effects: RandomEffects) -> tuple[Scatter, ...]:
    pairs = zip(effects.between.tolist(), effects.sigma.tolist(), strict=True)
    return tuple(Scatter(between, of_mean) for between, of_mean in pairs)


def _effects(tables: Sequence[Table]) -> Effects:
    """Mean of the resistance; errors of the coasts by road and wind count as shared."""
    values: dict[str, dict[str, float]] = {}
    sigma: dict[str, dict[str, float]] = {}
    for effect, named in tables[0].effect_values.items():
        values[effect], sigma[effect] = {}, {}
        for parameter in named:
            cars = [t.effect_values[effect][parameter] for t in tables]
            x = np.array([[car.value] for car in cars])
            scatter = random_effects(x, np.zeros_like(x))
            shared = math.sqrt(np.mean([car.sigma**2 for car in cars]))
            values[effect][parameter] = float(scatter.mean[0])
            sigma[effect][parameter] = math.hypot(inflated(scatter)[0], shared)
    return Effects(values, sigma=sigma)


def _quality(tables: Sequence[Table]) -> dict[str, float]:
    out = {"cars": float(len(tables))}
    for name in tables[0].quality:
        if all(name in t.quality for t in tables):
            how = np.min if name in _LEAST else np.sum if name in _SUM else np.mean
            out[name] = float(how([t.quality[name] for t in tables]))
    return out


def _provenance(parents: Sequence[Stored]) -> Provenance:
    """Logs of all cars; the settings that all of them were fitted with."""
    origins = [p.table.provenance for p in parents]
    common = set.intersection(*({*origin.settings.items()} for origin in origins))
    return Provenance(
        logs=tuple(dict.fromkeys(log for origin in origins for log in origin.logs)),
        settings={k: v for k, v in origins[0].settings.items() if (k, v) in common},
        program=PROGRAM,
        parents=tuple(TableReference(p.id, p.digest) for p in parents),
    )


def _remarks(parents: Sequence[Stored]) -> tuple[str, ...]:
    ends = {p.id: float(p.table.difference.eta[-1]) for p in parents}
    shortest, longest = min(ends, key=lambda i: ends[i]), max(ends, key=lambda i: ends[i])
    return (
        f"mean of {len(parents)} tables, taken as those of different cars that count alike; bands "
        "and sigmas are those of one more car of the model, by Student's t",
        f"curves end at eta {ends[shortest]:.5f}, where {shortest} ends; {longest} goes to "
        f"{ends[longest]:.5f}",
        _SHARED,
    )


def _each(parents: Sequence[Stored]) -> Iterator[str]:
    longest = max((float(p.table.difference.eta[-1]) - 1.0 for p in parents), default=0.0)
    for parent in parents:
        reach = float(parent.table.difference.eta[-1]) - 1.0
        if not (parent.state.usable and parent.state.in_store):
            yield f"{parent.id} is {parent.state.words}; leave it out"
        if parent.table.spread is not None:
            yield f"{parent.id} is a mean of cars itself; merge the cars it was made of"
        if parent.table.fleet:
            yield (
                f"{parent.id} rests on other cars by its prior, which would count twice; fit it "
                "without --fleet-prior"
            )
        if reach < _LEAST_RANGE * longest:
            yield (
                f"{parent.id} ends at eta {1.0 + reach:.5f}, less than half of the range of the "
                f"longest, {1.0 + longest:.5f}; leave it out"
            )


def _pairs(parents: Sequence[Stored]) -> Iterator[str]:
    for a, b in combinations(parents, 2):
        for mark in _CAR_MARKS:
            if _identity(a, mark) and _identity(a, mark) == _identity(b, mark):
                yield (
                    f"{a.id} and {b.id} are of one car ({mark} {_identity(a, mark)}), which would "
                    "count as two; give one of them, or fit its ramps together"
                )
        if a.ramps & b.ramps:
            yield f"{a.id} and {b.id} are made of the same ramp"
        if apart := differ(a.table, b.table.vehicle):
            yield f"{a.id} and {b.id} are of different vehicles: {', '.join(apart[:4])}"


def _identity(stored: Stored, mark: str) -> str:
    return stored.table.provenance.identity.get(mark, "")


def differ(table: Table, vehicle: Vehicle) -> list[str]:
    """Differences between two vehicles, without names and uncertainties."""
    changed = changes(table, replace(table, vehicle=vehicle))
    of_car = [c for part in ("vehicle", "empirical", "own_effects") for c in changed.get(part, ())]
    return [f"{c.key} {c.a} and {c.b}" for c in of_car if c.key not in ("name", *UNCERTAINTIES)]
