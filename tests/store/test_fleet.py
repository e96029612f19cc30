"""Which tables of a store are the cars of a model, by their states, vehicles and parents."""

from dataclasses import replace

from calib.store.fleet import released_cars
from calib.store.merge import merge
from calib.table.table import LogReference, TableReference
from tests.support.cars_of_a_line import car_table
from tests.support.signing import RELEASE
from tests.support.tables import VEHICLE

NEW = replace(VEHICLE, name="new", mass_tolerance=0.005)


def car(number, **more):
    """Return the table of a car with its own name; ``more`` are fields of its provenance."""
    table, name = car_table(number, 26.0 + number), f"car{number}"
    origin = replace(table.provenance, **more)
    vehicle = replace(table.vehicle, name=name)
    return replace(table, name=name, vehicle=vehicle, provenance=origin)


def test_newest_released_version_of_each_other_car_of_the_model(store):
    for number in (1, 2, 3):
        store.save(car(number), RELEASE)
    newer = replace(car(1), quality={"runs": 2.0})
    store.save(newer, RELEASE)
    store.save(car(4))  # a draft
    heavier = replace(car(5), vehicle=replace(car(5).vehicle, mass=1900.0))
    store.save(heavier, RELEASE)
    of_new_car = store.save(car(6), RELEASE)
    cars = released_cars(store, NEW, of_new_car.ramp_digests)
    assert sorted(cars) == ["car1@2", "car2@1", "car3@1"]
    assert cars["car1@2"].digest == newer.digest


def test_tables_that_rest_on_others_do_not_count(store):
    first = store.save(car(1), RELEASE)
    store.save(car(2, parents=(TableReference(first.id, first.digest),)), RELEASE)
    tyre = LogReference("t", "0" * 64, "tyre")
    store.save(car(3, logs=(*car(3).provenance.logs, tyre)), RELEASE)
    assert list(released_cars(store, NEW, ())) == ["car1@1"]


def test_a_mean_of_cars_is_no_car(store):
    parents = [store.save(car(number), RELEASE) for number in (1, 2)]
    store.save(merge(parents, "golden"), RELEASE)
    assert sorted(released_cars(store, NEW, ())) == ["car1@1", "car2@1"]
