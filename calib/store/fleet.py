"""The tables of other cars of one model, as the prior of a new car in `calib.fit`."""

from collections.abc import Collection

from calib.base.errors import StoreError
from calib.car.vehicle import Vehicle
from calib.store.merge import vehicle_differences
from calib.store.state import RELEASED
from calib.store.store import Store
from calib.table.table import Table


def released_cars(store: Store, vehicle: Vehicle, logs: Collection[str]) -> dict[str, Table]:
    """Return the newest released table of each car of the model of ``vehicle``, by name@version.

    A table is left out if its evidence would count twice: a mean, a table with a prior from other
    cars or a tyre file, and a table of a ramp whose digest is in ``logs``. Raises StoreError if no
    table is left.
    """
    snapshot = store.snapshot()
    journal = snapshot.journal
    cars: dict[str, Table] = {}
    used_ramps = set(logs)
    for name in snapshot.names:
        released = [v for v in journal.versions(name) if journal.word(name, v) == RELEASED]
        if not released:
            continue
        stored = snapshot.load(name, max(released))
        provenance = stored.table.provenance
        has_tyre_file = any(log.role == "tyre" for log in provenance.logs)
        # a table with parents is a mean, or has a prior from other cars
        counts_twice = provenance.parents or has_tyre_file or stored.ramp_digests & used_ramps
        if not counts_twice and not vehicle_differences(stored.table, vehicle):
            cars[stored.id] = stored.table
            used_ramps |= stored.ramp_digests
    if not cars:
        flaw = f"no released table of another car of this model, of {len(snapshot.names)} looked at"
        expected = f"other cars like {vehicle.name}, fitted without --tyre and --fleet-prior"
        do = "release tables of cars of this model, or fit without --fleet-prior"
        raise StoreError(flaw, where=store.folder, expected=expected, do=do)
    return cars
