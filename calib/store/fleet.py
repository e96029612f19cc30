"""Tables of cars of one model as the prior of a new car in `calib.fit`."""

from collections.abc import Collection

from calib.base.errors import StoreError
from calib.car.vehicle import Vehicle
from calib.store.merge import differ
from calib.store.state import RELEASED
from calib.store.store import Store
from calib.table.table import Table


def released_cars(store: Store, vehicle: Vehicle, logs: Collection[str]) -> dict[str, Table]:
    """The newest released table of each car of the model of ``vehicle``, by name@version.

    Without means, tables of ramps whose digests are in ``logs``, and tables with a prior from other
    cars or a tyre file, which would count repeatedly. Raises StoreError where none remains.
    """
    now, cars, used_ramps = store.now(), dict[str, Table](), set(logs)
    for name in now.names:
        released = [v for v in now.journal.versions(name) if now.journal.word(name, v) == RELEASED]
        for stored in [now.load(name, max(released))] if released else ():
            table = stored.table
            mean_or_prior = table.provenance.parents
            tyres = any(log.role == "tyre" for log in table.provenance.logs)
            if not (stored.ramps & used_ramps or mean_or_prior or tyres or differ(table, vehicle)):
                cars[stored.id] = table
                used_ramps |= stored.ramps
    if not cars:
        flaw = f"no released table of another car of this model, of {len(now.names)} looked at"
        expected = f"the vehicle file of {vehicle.name} but its name, no --tyre or --fleet-prior"
        do = "release tables of cars of this model, or fit without --fleet-prior"
        raise StoreError(flaw, where=store.folder, expected=expected, do=do)
    return cars
