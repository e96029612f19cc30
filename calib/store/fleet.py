"""The tables of a model's cars in a store, as the prior of a new car: for `calib.fit`."""

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

    A mean of cars stands for its cars, where the store has them. Left out are tables of the ramps
    whose digests are among ``logs``, and those that rest on other cars or on a file of tyres, whose
    information would count once for each. Raises StoreError where none is left.
    """
    now = store.now()
    candidates: dict[str, Stored] = {}
    for name in now.names:
        if fit := [v for v in now.journal.versions(name) if now.journal.word(name, v) == RELEASED]:
            candidates |= {stored.id: stored for stored in _cars(now, now.load(name, max(fit)))}
    cars, used_ramps = {}, set(logs)
    for stored in sorted(candidates.values(), key=lambda s: s.table.spread is not None):
        table = stored.table
        dependent = table.fleet or any(log.role == "tyre" for log in table.provenance.logs)
        if not (stored.ramps & used_ramps or dependent or differ(table, vehicle)):
            cars[stored.id] = table
            used_ramps |= stored.ramps
    if not cars:
        raise StoreError(
            f"no released table of another car of this model, of {len(candidates)} looked at",
            where=store.folder,
            expected=f"the vehicle file of {vehicle.name} but its name, no --tyre or --fleet-prior",
            do="release tables of cars of this model, or fit without --fleet-prior",
        )
    return cars


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
