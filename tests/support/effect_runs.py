"""Made histories, and short runs of the reference car under named effects."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.effects import Effects
from calib.car.history import Motion, RunHistory
from calib.car.model import default_model
from calib.car.tyre import MagicFormula
from calib.car.vehicle_file import read_vehicle
from calib.model.simulate import simulate
from tests.support.plant import Plant, drive, magic

SEDAN = read_vehicle(Path(__file__).parents[2] / "sample_logs/sedan/vehicle.toml")
TYRE = MagicFormula(25.0, 0.9, 1.65)


def without_inertia(car):
    """The car whose torques are forces at once."""
    axles = (replace(axle, wheel_inertia=0.0) for axle in (car.front, car.rear))
    front, rear = axles
    return replace(car, front=front, rear=rear)


def made_history(n=200, **changes):
    """A history (n,) in which everything moves."""
    time = np.arange(n) * 0.01
    options = {
        "time": time,
        "v": 30.0 - 4.0 * time,
        "z": 0.3 + 0.2 * np.sin(3.0 * time),
        "p_mc": 20e5 + 15e5 * np.sin(2.0 * time),
        "temperature_f": 100.0 + 80.0 * time,
        "temperature_r": 60.0 + 20.0 * time,
        "angle_f": 90.0 * time,
        "angle_r": 91.0 * time,
        "energy_f": 40e3 * time,
        "energy_r": 10e3 * time,
    }
    return RunHistory(**{**options, **changes})


def made_motion(v, load_f=1e4, load_r=7e3):
    """The motion of a made history at these speeds [m/s] and axle loads [N]."""
    v = np.asarray(v, float)
    ones = np.ones_like(v)
    return Motion(v, load_f * ones, load_r * ones, made_history(v.size, v=v))


def pressures(name, history, **parameters):
    """Front and rear pressure [Pa] of an effect fed with p_mc."""
    return CATALOGUE[name].pressure(parameters, history, history.p_mc, history.p_mc)


def factors(name, history, **parameters):
    """Factors on the front and the rear pads [1] at p_mc."""
    return CATALOGUE[name].friction(parameters, history, history.p_mc, history.p_mc)


def clock(duration, rate=200):
    return np.arange(round(duration * rate) + 1) / rate


def driven(effects, pressure=lambda t: 25e5, v0=30.0, *, duration=4.0, rate=200, car=SEDAN, **more):
    """Simulate the car with these parameters of named effects, and no other effects."""
    time = clock(duration, rate)
    model = replace(default_model(car), effects=Effects(effects), tyre=TYRE)
    return simulate(model, time, np.array([pressure(t) for t in time]), v0, **more)


def on_the_plant(
    pressure=lambda t: 25e5, v0=30.0, *, duration=4.0, car=SEDAN, wheel_pressure=None, **plant
):
    """Drive the plant, which shares nothing with the simulation, the same way."""
    truth = Plant(car, tyre=magic(25.0, 0.9, 1.65), **plant)
    return drive(truth, pressure, v0, duration=duration, wheel_pressure=wheel_pressure)


def apart(log, run, channel):
    """Largest difference of a channel where both have it."""
    n = min(log.time.size, run["time"].size)
    mine = log.channels[channel] if channel in log.channels else log.truth[channel]
    return float(np.max(np.abs(mine[:n] - run[channel][:n])))


def wave(t):
    """Pressure [Pa] that rises and falls, from zero on."""
    return 15e5 * (1.0 - np.cos(2.5 * t))
