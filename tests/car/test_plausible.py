"""Cars of the road pass; ordinary mistakes in their files do not."""

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest

from calib.base.warning import UNITS
from calib.car.plausible import vehicle_warnings
from calib.car.vehicle import Axle, Vehicle
from calib.car.vehicle_file import read_vehicle

LOGS = Path(__file__).parents[2] / "sample_logs"
SEDAN = read_vehicle(LOGS / "sedan/vehicle.toml")


def car(mass, wheelbase, front, height, track, radius, wheel, piston, disc):
    """Return a car from a data sheet: ``front`` share of the load, pistons of one side [mm]."""
    axles = [
        Axle(R, 0.6 * m * R * R, sum(pi / 4 * (d / 1e3) ** 2 for d in pistons), r / 1e3, 2, 0.4)
        for R, m, pistons, r in zip(radius, wheel, piston, disc, strict=True)
    ]
    ends = ((1.0 - front) * wheelbase, front * wheelbase)
    return Vehicle("car", mass, *ends, height, track, *axles)


CARS = {
    "hatchback": car(1280, 2.55, 0.61, 0.54, 1.50, (0.302, 0.302),
        (18, 17), ([54], [34]), (111, 93)),
    "compact with EBD": car(1450, 2.63, 0.59, 0.54, 1.53, (0.312, 0.312),
        (20, 19), ([54], [38]), (117, 113)),
    "limousine": car(2250, 3.11, 0.52, 0.56, 1.65, (0.345, 0.345),
        (28, 29), ([42, 42], [44]), (158, 147)),
    "off-road": car(2450, 3.02, 0.50, 0.80, 1.70, (0.388, 0.388),
        (38, 38), ([42, 46], [45]), (147, 140)),
    "van, laden": car(3300, 3.66, 0.44, 0.85, 1.71, (0.345, 0.345),
        (30, 30), ([48, 48], [50]), (123, 128)),
    "rear engine": car(1620, 2.45, 0.39, 0.46, 1.58, (0.332, 0.345),
        (23, 27), ([28, 30, 36], [28, 34]), (148, 142)),
    "electric": car(1950, 2.875, 0.48, 0.45, 1.58, (0.335, 0.335),
        (26, 30), ([42, 42], [43]), (133, 144)),
    "microcar": car(1010, 1.873, 0.43, 0.56, 1.38, (0.285, 0.285),
        (14, 15), ([42], [30]), (102, 98)),
}  # fmt: skip


def scaled(axle, factors):
    """Return the axle with values multiplied by ``factors``; a number of faces stays an integer."""
    values = {key: getattr(axle, key) for key in factors}
    return replace(axle, **{key: type(x)(x * factors[key]) for key, x in values.items()})


def on_rear(**factors):
    return replace(SEDAN, rear=scaled(SEDAN.rear, factors))


def on_both(**factors):
    return replace(on_rear(**factors), front=scaled(SEDAN.front, factors))


MISTAKES = {
    "piston area of both sides": (on_both(piston_area=2.0), "pressure_per_g"),
    "one piston of two": (on_both(piston_area=0.5), "pressure_per_g"),
    "one friction face": (on_both(friction_faces=0.5), "friction_faces_f"),
    "one friction face, rear": (on_rear(friction_faces=0.5), "friction_faces_r"),
    "area of both sides, rear": (on_rear(piston_area=2.0), "front_biased_up_to"),
    "diameter of the disc": (on_both(effective_radius=2.0), "disc_ratio_f"),
    "diameter of the wheel": (on_both(rolling_radius=2.0), "rolling_radius_f"),
    "radius of the rim": (on_both(rolling_radius=0.63), "rolling_radius_r"),
    "inertia in another unit": (on_both(wheel_inertia=10.0), "wheel_mass_f"),
    "pounds": (replace(SEDAN, mass=2.2 * SEDAN.mass), "pressure_per_g"),
    "mass of one axle": (replace(SEDAN, mass=0.5 * SEDAN.mass), "pressure_per_g"),
    "height above the axles": (replace(SEDAN, cg_height=SEDAN.cg_height - 0.322), "cg_height"),
    "height of the roof": (replace(SEDAN, cg_height=1.5), "cg_height_ratio"),
    "half of the track": (replace(SEDAN, track_width=0.775), "track_width"),
    "distances swapped": (
        replace(SEDAN, cg_to_front_axle=1.6494, cg_to_rear_axle=1.1556), "lock_efficiency",
    ),
    "axles swapped": (replace(SEDAN, front=SEDAN.rear, rear=SEDAN.front), "brake_share_f"),
}  # fmt: skip


@pytest.mark.parametrize("name", CARS)
def test_a_good_car_has_no_warning(name):
    assert vehicle_warnings(CARS[name]) == ()


def test_the_cars_of_the_samples_have_no_warning():
    files = [*LOGS.glob("*/vehicle.toml"), *LOGS.glob("hidden/*/vehicle.toml")]
    assert len(files) > 5
    assert [w for path in files for w in vehicle_warnings(read_vehicle(path))] == []


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told_with_its_causes(name):
    vehicle, code = MISTAKES[name]
    by_code = {w.code: w for w in vehicle_warnings(vehicle)}
    assert code in by_code
    assert set(by_code) <= set(UNITS)
    assert all(w.causes and w.do and w.log == vehicle.name for w in by_code.values())
