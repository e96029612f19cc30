"""The cars of a model in a store that a new one is known by: tables for `calib.fit`."""

from collections.abc import Collection

from calib.base.errors import StoreError
from calib.car.vehicle import Vehicle
from calib.store.merge import differ
from calib.store.snapshot import Snapshot
from calib.store.state import RELEASED
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.table import Table


def released_cars(store: Store, vehicle: Vehicle, logs: Collection[str]) -> dict[str, Table]:
    """The newest released table of each car of the model of ``vehicle``, by name@version.

    A mean of cars stands for those it was made of, where the store has them. Left out are tables
    of the ramps whose digests are among ``logs``, and those that rest on other cars or on a file of
    tyres themselves: what all of these share would count once for each. Raises StoreError where
    none is left.
    """
    now = store.now()
    looked_at: dict[str, Stored] = {}
    for name in now.names:
        if fit := [v for v in now.journal.of(name) if now.journal.word(name, v) == RELEASED]:
            looked_at |= {one.id: one for one in _cars(now, now.load(name, max(fit)))}
    kept, seen = {}, set(logs)
    for id_, one in sorted(looked_at.items(), key=lambda item: item[1].table.spread is not None):
        leans = one.table.fleet or any(log.role == "tyre" for log in one.table.provenance.logs)
        if not (one.ramps & seen or leans or differ(one.table, vehicle)):
            kept[id_] = one.table
            seen |= one.ramps
    if not kept:
        raise StoreError(
            f"no released table of another car of this model, of {len(looked_at)} looked at",
            where=store.folder,
            expected=f"the vehicle file of {vehicle.name} but its name, no --tyre or --fleet-prior",
            do="release tables of cars of this model, or fit without --fleet-prior",
        )
    return kept


def _cars(now: Snapshot, stored: Stored) -> list[Stored]:
    """The cars of a mean, or the version itself: a mean without its cars here is one more car."""
    if stored.table.spread is None:
        return [stored]
    parents = stored.table.provenance.parents
    try:
        cars = [now.load(*now.numbered(one.id)) for one in parents]
    except StoreError:
        return [stored]
    return cars if [one.digest for one in cars] == [one.digest for one in parents] else [stored]
