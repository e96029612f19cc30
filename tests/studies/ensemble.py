"""Cars, ramps and stops drawn at random from the plant of the tests, for the studies.

Everything that a station meets and cannot know is drawn: the car, its tyres, its radii, its drag,
its body's pitch, the road, the pads, the sensors. Nothing of `calib` makes the data.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from calib.model.sensor_noise import LEVELS, NoiseLevel, add_noise
from tests.studies.causes import COAST, RAMP, STOP, Hidden
from tests.support.plant import Plant, Pressure, as_log, brush, drive, magic, per_pascal
from tests.support.reference_car import without

SURFACES = {
    # name: stiffness factors, peak factors, deceleration aimed at, common pad level
    "same": ((1.0, 1.0), (1.0, 1.0), (0.25, 0.50), (0.8, 1.05)),
    "dry": ((1.0, 1.1), (1.05, 1.2), (0.30, 0.55), (0.95, 1.0)),
    "basalt": ((0.9, 1.02), (0.5, 0.65), (0.22, 0.32), (0.45, 0.9)),
    "tile": ((0.6, 0.8), (0.22, 0.30), (0.10, 0.13), (0.45, 0.9)),
}


@dataclass(frozen=True)
class Stop:
    """One stop with its truth: the log, the road, and how the pads differ from the ramp's."""

    log: Log
    surface: str
    alike: bool


@dataclass(frozen=True)
class Case:
    """One car: what the program is told, its ramp, its stops; ``coast`` where one was asked for;
    ``tyre`` names its form where the plant has several."""

    vehicle: Vehicle
    ramp: Log
    stops: tuple[Stop, ...]
    coast: Log | None = None
    tyre: str = ""


@dataclass(frozen=True)
class Track:
    """What all runs of a car share: what is hidden in it, and the noise of its sensors."""

    hidden: Hidden
    levels: dict[str, NoiseLevel]

    def driven(
        self, role: str, name: str, plant: Plant, pressure: Pressure, v0: float, seed: int, **how
    ) -> Log:
        """One run as the sensors give it; ``how`` as `drive` has it."""
        real = self.hidden.car(role, plant, pressure, v0)
        log = without(as_log(drive(real, pressure, v0, **how), name), "T_drive_f", "T_drive_r")
        return add_noise(self.hidden.sense(role, log), seed, self.levels)


def cases(count: int, seed: int, stops: int = 3) -> Iterator[Case]:
    """Draw ``count`` cars with ``stops`` stops each; car i is the same for any count."""
    for i in range(count):
        yield case(np.random.default_rng([seed, i]), stops, seed * 1000 + i)


def case(
    rng: np.random.Generator, stops: int, noise_seed: int, hidden: Hidden | None = None
) -> Case:
    """One car, one ramp on its home surface, stops elsewhere.

    With something ``hidden`` it has a coast log, too; the car, its roads and its pads are those
    that it has without.
    """
    vehicle = car(rng)
    plant = Plant(
        vehicle=vehicle,
        tyre=tyre(rng),
        drag_area=float(rng.choice([0.0, rng.uniform(0.55, 0.8)], p=[0.3, 0.7])),
        radius_scale=(1.0, 1.0 + float(rng.normal(0.0, 0.001))),
        pitch_frequency=float(rng.choice([0.0, rng.uniform(1.1, 1.6)])),
        pitch_damping=float(rng.uniform(0.25, 0.4)),
    )
    if plant.drag_area:
        plant = replace(plant, rolling_resistance=float(rng.uniform(0.008, 0.014)))
    loud = float(rng.uniform(0.6, 2.0))
    levels = {k: replace(v, sd=v.sd * loud) for k, v in LEVELS.items()}
    given = hidden or Hidden()
    track = Track(given, given.levels(levels))
    slope = float(rng.uniform(4.0, 7.0)) * 1e5
    v0 = float(rng.uniform(30.0, 34.0))
    top = round(20.0 * ((0.58 / per_pascal(vehicle)) / slope + 1.5)) / 20.0
    pressure = lambda t: slope * max(t - 1.5, 0.0)  # noqa: E731
    how = {"duration": top, "stop_speed": 8.0}
    ramp = track.driven(RAMP, "ramp", plant, pressure, v0, noise_seed, **how)
    coast = None
    if hidden:
        seed = noise_seed + 104_729
        coast = track.driven(COAST, "coast", plant, lambda t: 0.0, v0, seed, duration=15.0)
    made = [
        stop(rng, plant, vehicle, str(name), noise_seed + 7919 * (k + 1), track)
        for k, name in enumerate(rng.choice(list(SURFACES), stops, p=[0.3, 0.3, 0.25, 0.15]))
    ]
    return Case(given.told(vehicle), ramp, tuple(made), coast)


def stop(
    rng: np.random.Generator, plant: Plant, vehicle: Vehicle, name: str, seed: int, track: Track
) -> Stop:
    """One stop on a surface, with pads of their own."""
    stiffness, peak, aim, level = (rng.uniform(*r) for r in SURFACES[name])
    alike = bool(rng.random() < 0.6)
    ratio = 0.0 if alike else float(rng.normal(0.0, 0.15))
    fade = float(rng.choice([0.0, rng.uniform(-0.06, 0.03)], p=[0.7, 0.3])) if name != "dry" else 0
    if name == "dry" and alike:
        level = 1.0
    front, rear = vehicle.front.pad_friction, vehicle.rear.pad_friction

    def pads(t: float) -> tuple[float, float]:
        now = level * math.exp(fade * t)
        return front * now * math.exp(0.5 * ratio), rear * now * math.exp(-0.5 * ratio)

    p0 = float(aim / per_pascal(vehicle) / level)
    pressure = profile(rng, p0)
    on_road = replace(plant, pads=pads, surface=lambda x: (float(stiffness), float(peak)))
    v0 = float(rng.uniform(22.0, 30.0)) if name != "tile" else float(rng.uniform(16.0, 20.0))
    how = {"duration": 11.0, "stop_speed": 1.5}
    return Stop(track.driven(STOP, name, on_road, pressure, v0, seed, **how), name, alike)


def profile(rng: np.random.Generator, p0: float) -> Callable[[float], float]:
    """Pressure over time: hold, wave or two steps, bitten within 0.15 to 0.4 s after 1.5 s."""
    rise = float(rng.uniform(0.15, 0.4))
    kind = rng.choice(["hold", "wave", "steps"])

    def shape(t: float) -> float:
        if kind == "wave":
            return 1.0 + 0.15 * math.sin(2.0 * math.pi * 0.4 * t)
        if kind == "steps":
            return 0.6 + 0.4 / (1.0 + math.exp(-(t - 2.5) / 0.1))
        return 1.0

    return lambda t: p0 * min(max((t - 1.5) / rise, 0.0), 1.0) * shape(t - 1.5)


def tyre(rng: np.random.Generator):
    """Magic Formula or brush, 18 to 32 per slip, a peak of a wet road, load exponent 0 to 0.08."""
    stiffness, peak = float(rng.uniform(18.0, 32.0)), float(rng.uniform(0.8, 1.0))
    load = float(rng.uniform(0.0, 0.08))
    if rng.random() < 0.3:
        return brush(stiffness, peak * 1.1, load)
    return magic(stiffness, peak, curvature=float(rng.uniform(-0.5, 0.3)), load_exponent=load)


def car(rng: np.random.Generator) -> Vehicle:
    """A passenger car, front-biased at rest."""
    mass = float(rng.uniform(1100.0, 2200.0))
    wheelbase = float(rng.uniform(2.45, 2.95))
    front = float(rng.uniform(0.40, 0.47)) * wheelbase
    radius = float(rng.uniform(0.29, 0.36))
    share = float(rng.uniform(0.70, 0.80))
    total = mass * 9.80665 * radius / 70e5  # N m per Pa for 70 bar a g
    mu = float(rng.uniform(0.34, 0.44))

    def axle(part: float, disc: float) -> Axle:
        area = total * part / (4.0 * mu * disc)
        return Axle(radius, float(rng.uniform(0.8, 1.8)), area, disc, 2, mu)

    return Vehicle(
        name="drawn",
        mass=mass,
        cg_to_front_axle=front,
        cg_to_rear_axle=wheelbase - front,
        cg_height=float(rng.uniform(0.5, 0.68)),
        track_width=1.5,
        front=axle(share, 0.13),
        rear=axle(1.0 - share, 0.12),
    )
