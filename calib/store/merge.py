"""The mean table of several cars of one model: a golden table that is made, not picked.

    CAR@1, CAR@2, ... --> common axes --> mean and scatter of D, g, pads, tyre --> one table

The mean and its scatter are those of `calib.base.random_effects`. What the cars share (the
vehicle file, the track, the method) is in every one of them and in their mean.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.base.program import PROGRAM
from calib.base.random_effects import RandomEffects, random_effects
from calib.car.effects.effects import Effects
from calib.store.mean_curves import (
    all_D,
    car_weights,
    mean_difference,
    mean_paper,
    mean_tyre,
)
from calib.store.mean_pads import inflated, mean_pads
from calib.store.merge_words import remarks
from calib.store.parents import require_mergeable
from calib.store.version import Stored
from calib.table.spread import FleetScatter, Scatter
from calib.table.table import Provenance, Table, TableReference

Array = NDArray[np.float64]

LEAST = ("deceleration_max", "eta_peak_is_real")
"""Metrics of a fit of which the mean table has the least of its cars."""

SUM = ("runs", "outliers")
"""Metrics of which it has the sum; of all others it has the mean."""


def merge(parents: Sequence[Stored], name: str) -> Table:
    """The mean table of ``parents``, named ``name``.

    Its bands and sigmas are those of one more car of the model; how the cars differ, and how well
    the mean is known, is in its `Spread`. The order of the parents does not matter.

    Raises RevisionError for parents that have no mean: fewer than two, one car or one ramp twice,
    different vehicles, means or tables corrected by hand, a range of eta that is far too short.
    """
    require_mergeable(parents, name)
    parents = sorted(parents, key=lambda p: (p.name, p.version, p.digest))
    tables = [p.table for p in parents]
    every = all_D(tables)
    weights = car_weights(every)
    difference, scatter = mean_difference(tables, every, weights)
    pads = mean_pads(tables, weights)
    return Table(
        name=name,
        vehicle=tables[0].vehicle,
        difference=difference,
        paper=mean_paper(tables, difference, weights),
        tyre=mean_tyre(tables, weights),
        posterior=pads.posterior,
        calibration=pads.calibration,
        effects=_effects(tables, weights),
        noise=_noise(tables),
        quality=_quality(tables),
        remarks=remarks(parents),
        provenance=_provenance(parents),
        warnings=tuple(dict.fromkeys(w for t in tables for w in t.warnings)),
        budget=pads.budget,
        spread=_spread(scatter, pads.scatter),
    )


def _spread(of_D: RandomEffects, of_pads: RandomEffects) -> FleetScatter:
    D, (level, ratio, stiffness) = _scatters(of_D), _scatters(of_pads)
    return FleetScatter(of_D.freedom + 1, D, level, ratio, stiffness)


def _scatters(of: RandomEffects) -> tuple[Scatter, ...]:
    pairs = zip(np.sqrt(of.between).tolist(), of.sigma.tolist(), strict=True)
    return tuple(Scatter(between, of_mean) for between, of_mean in pairs)


def _effects(tables: Sequence[Table], weights: Array) -> Effects:
    """Resistance: what a coast says of road and wind counts as shared by all cars."""
    values: dict[str, dict[str, float]] = {}
    sigma: dict[str, dict[str, float]] = {}
    for effect, named in tables[0].effect_values.items():
        for parameter in named:
            all_ = [t.effect_values[effect][parameter] for t in tables]
            x = np.array([[v.value] for v in all_])
            found = random_effects(x, np.zeros_like(x), weights)
            shared = weights @ np.array([v.sigma**2 for v in all_])
            values.setdefault(effect, {})[parameter] = float(found.mean[0])
            of_cars = float(inflated(found)[0])
            sigma.setdefault(effect, {})[parameter] = float(np.hypot(of_cars, np.sqrt(shared)))
    return Effects(values, sigma=sigma)


def _noise(tables: Sequence[Table]) -> dict[str, float]:
    """Root mean square of each sensor that all cars have."""
    known = [n for n in tables[0].noise if all(n in t.noise for t in tables)]
    return {n: float(np.sqrt(np.mean([t.noise[n] ** 2 for t in tables]))) for n in known}


def _quality(tables: Sequence[Table]) -> dict[str, float]:
    known = [n for n in tables[0].quality if all(n in t.quality for t in tables)]
    out = {"cars": float(len(tables))}
    for name in known:
        of = np.array([t.quality[name] for t in tables])
        out[name] = float(of.min() if name in LEAST else of.sum() if name in SUM else of.mean())
    return out


def _provenance(parents: Sequence[Stored]) -> Provenance:
    """Logs of all cars; the settings that all of them were fitted with."""
    origins = [p.table.provenance for p in parents]
    settings = dict(origins[0].settings)
    for origin in origins[1:]:
        settings = {k: v for k, v in settings.items() if origin.settings.get(k) == v}
    return Provenance(
        logs=tuple(dict.fromkeys(log for origin in origins for log in origin.logs)),
        settings=settings,
        program=PROGRAM,
        parents=tuple(TableReference(p.id, p.digest) for p in parents),
    )
