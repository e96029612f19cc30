"""The cars of a model in a store that a new one is known by: tables for `calib.fit`."""

from collections.abc import Collection

from calib.base.errors import StoreError
from calib.car.vehicle import Vehicle
from calib.store.merge import differ
from calib.store.snapshot import Snapshot
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
    fit = [[v for v in now.versions(name) if now.journal.state(name, v).released]
           for name in now.names]  # fmt: skip
    newest = [now.load(name, max(v)) for name, v in zip(now.names, fit, strict=True) if v]
    cars = {one.id: one for stored in newest for one in _cars(now, stored)}
    kept, seen = {}, set(logs)
    for id_, one in sorted(cars.items(), key=lambda item: item[1].table.spread is not None):
        if not (one.ramps & seen or _leans(one.table) or differ(one.table, vehicle)):
            kept[id_] = one.table
            seen |= one.ramps
    if not kept:
        raise StoreError(
            f"no released table of another car of this model, of {len(cars)} looked at",
            where=store.folder,
            expected=f"the vehicle file of {vehicle.name} but its name, no --tyre or --fleet-prior",
            do="release tables of cars of this model, or fit without --fleet-prior",
        )
    return kept


def fleet_again(store: Store, stored: Stored) -> dict[str, Table]:
    """The cars that the prior of ``stored`` rests on. Raises StoreError for one that changed."""
    found = {}
    for one in stored.table.fleet:
        parent = store.load(one.id)
        if parent.digest != one.digest:
            raise StoreError(
                f"{one.id} has the digest {parent.digest[:12]}",
                where=stored.id,
                expected=f"{one.digest[:12]}, on which its prior rests",
                do="name with --store the store that it was made in",
            )
        found[one.id] = parent.table
    return found


def _leans(table: Table) -> bool:
    return bool(table.fleet) or any(log.role == "tyre" for log in table.provenance.logs)


def _cars(now: Snapshot, stored: Stored) -> list[Stored]:
    if stored.table.spread is None:
        return [stored]
    try:
        parents = stored.table.provenance.parents
        cars = [now.load(*now.numbered(one.id)) for one in parents]
    except StoreError:  # handed on without them: its draws are those of one more car
        return [stored]
    return cars if [c.digest for c in cars] == [p.digest for p in parents] else [stored]
