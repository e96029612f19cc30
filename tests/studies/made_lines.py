"""A car at a station, drawn at random: ramp, coast, three stops within an hour on one road.

Everything that a good line does not know is drawn, in the size that it has on a good line; nothing
of `calib` makes the data but the noise of the sensors. What a mistake adds is in `made_mistakes`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from calib.base.names import WHEELS, G
from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from calib.model.sensor_noise import LEVELS, NoiseLevel, add_noise
from tests.support.plant import (
    Plant,
    Pressure,
    Tyre,
    as_log,
    brush,
    drive,
    magic,
    per_pascal,
)

RATE = 100.0
"""Sample rate of the logs [Hz]."""

BAR = 1e5
ROTATING = (0.02, 0.05)
"""Four wheels (inertia over R^2) over the mass of a car [1]: tyre and wheel weigh 0.8 to 2 % of the
car, and 0.6 of them turn with the radius."""
STOPS = ("stop_1", "stop_2", "stop_3")
RUNS = ("ramp", "coast", *STOPS)
WEIGHED = 0.01
"""How well the mass of the vehicle file is known [1]."""


@dataclass(frozen=True)
class Run:
    """One drive: what the car is in it, what its driver does.

    ``wheels`` pressures [Pa] of wheels that have one of their own; nobody logs them.
    """

    plant: Plant
    pressure: Pressure
    speed: float
    duration: float
    stop_speed: float
    wheels: dict[str, Pressure] = field(default_factory=dict)


@dataclass(frozen=True)
class Sensors:
    """``zeros`` and ``gains`` of channels, noise by channel, its seed; whether ``v`` is logged, and
    the torque of motors."""

    zeros: dict[str, float]
    gains: dict[str, float]
    levels: dict[str, NoiseLevel]
    seed: int
    with_v: bool
    with_drive: bool = False


@dataclass(frozen=True)
class Line:
    """One car at the station: the file it comes with, its runs, its sensors."""

    file: Vehicle
    runs: dict[str, Run]
    sensors: Sensors

    @property
    def true(self) -> Vehicle:
        """The car as it is."""
        return self.runs["ramp"].plant.vehicle


def line(rng: np.random.Generator, seed: int) -> Line:
    """Draw a good line; ``seed`` is that of its noise."""
    true = with_usual_wheels(drawn_car(rng))
    plant = Plant(
        vehicle=true,
        tyre=tyre(rng),
        drag_area=float(rng.uniform(0.55, 0.8)),
        rolling_resistance=float(rng.uniform(0.008, 0.014)),
        radius_load=float(rng.uniform(0.0, 0.004)),
        rear_stiffness=math.exp(rng.normal(0.0, 0.03)),
        pitch_frequency=float(rng.uniform(1.1, 1.6)),
        pitch_damping=float(rng.uniform(0.25, 0.4)),
        pitch_felt=math.radians(rng.uniform(0.0, 0.6)),
        grade=float(rng.normal(0.0, 0.002)),
        hydraulic_lag=float(rng.uniform(0.01, 0.05)),
    )
    common, apart = rng.uniform(0.9, 1.1), math.exp(rng.normal(0.0, 0.02))
    runs = {
        name: replace(run, plant=replace(run.plant, pads=pads(rng, true, common, apart)))
        for name, run in drives(rng, plant).items()
    }
    return Line(on_paper(rng, true), runs, sensors(rng, seed))


def tyre(rng: np.random.Generator) -> Tyre:
    """Magic Formula or brush, 18 to 32 per slip, a peak of a wet road, load exponent 0 to 0.08."""
    stiffness, peak = float(rng.uniform(18.0, 32.0)), float(rng.uniform(0.8, 1.0))
    load = float(rng.uniform(0.0, 0.08))
    if rng.random() < 0.3:
        return brush(stiffness, peak * 1.1, load)
    return magic(stiffness, peak, curvature=float(rng.uniform(-0.5, 0.3)), load_exponent=load)


def drawn_car(rng: np.random.Generator) -> Vehicle:
    """A passenger car, front-biased at rest."""
    mass = float(rng.uniform(1100.0, 2200.0))
    wheelbase = float(rng.uniform(2.45, 2.95))
    front = float(rng.uniform(0.40, 0.47)) * wheelbase
    radius = float(rng.uniform(0.29, 0.36))
    share = float(rng.uniform(0.70, 0.80))
    total = mass * G * radius / 70e5  # N m per Pa for 70 bar a g
    mu = float(rng.uniform(0.34, 0.44))

    def axle(part: float, disc: float) -> Axle:
        area = total * part / (4.0 * mu * disc)
        return Axle(radius, float(rng.uniform(0.8, 1.8)), area, disc, 2, mu)

    return Vehicle(
        name="car",
        mass=mass,
        cg_to_front_axle=front,
        cg_to_rear_axle=wheelbase - front,
        cg_height=float(rng.uniform(0.5, 0.68)),
        track_width=1.5,
        front=axle(share, 0.13),
        rear=axle(1.0 - share, 0.12),
    )


def with_usual_wheels(drawn: Vehicle) -> Vehicle:
    """The car with wheels that are not too heavy or too light for it."""
    axles = (drawn.front, drawn.rear)
    share = 2.0 * sum(a.wheel_inertia / a.rolling_radius**2 for a in axles) / drawn.mass
    factor = float(np.clip(share, *ROTATING)) / share
    front, rear = (replace(a, wheel_inertia=factor * a.wheel_inertia) for a in axles)
    return replace(drawn, front=front, rear=rear)


def pads(
    rng: np.random.Generator, true: Vehicle, common: float, apart: float
) -> Callable[[float], tuple[float, float]]:
    """Pads of one run: those of the car, 1 % up or down, the axles 0.5 % apart by chance."""
    now, split = common * math.exp(rng.normal(0.0, 0.01)), apart * math.exp(rng.normal(0.0, 0.005))
    front = true.front.pad_friction * now * math.sqrt(split)
    rear = true.rear.pad_friction * now / math.sqrt(split)
    return lambda t: (front, rear)


def on_paper(rng: np.random.Generator, true: Vehicle) -> Vehicle:
    """The vehicle file: weighed to 1 %, centre of gravity to 3 %, tyres to 0.3 and 0.1 %.

    It says how well the car was weighed, and that no motor brakes along: the makers of a car know.
    """
    radius = 1.0 + rng.normal(0.0, 0.003)
    front, rear = (
        replace(
            axle,
            rolling_radius=axle.rolling_radius * radius * (1.0 + rng.normal(0.0, 0.001)),
            wheel_inertia=axle.wheel_inertia * (1.0 + rng.normal(0.0, 0.05)),
        )
        for axle in (true.front, true.rear)
    )
    return replace(
        true,
        mass=true.mass * (1.0 + rng.normal(0.0, WEIGHED)),
        cg_height=true.cg_height * (1.0 + rng.normal(0.0, 0.03)),
        mass_tolerance=WEIGHED,
        motor_odds=0.0,
        front=front,
        rear=rear,
    )


def drives(rng: np.random.Generator, plant: Plant) -> dict[str, Run]:
    """What the driver does: a ramp of 5 s after 1.5 s of rolling, a coast, three stops."""
    bar_per_g = 1.0 / per_pascal(plant.vehicle)
    slope = bar_per_g * rng.uniform(0.45, 0.55) / 5.0
    ramp = Run(plant, lambda t: slope * max(t - 1.5, 0.0), float(rng.uniform(29.0, 33.0)), 6.5, 8.0)
    runs = {"ramp": ramp, "coast": replace(ramp, pressure=lambda t: 0.0, duration=15.0)}
    for name in STOPS:
        peak = bar_per_g * float(rng.uniform(0.22, 0.45))
        speed = float(rng.uniform(22.0, 30.0))
        runs[name] = Run(plant, profile(rng, peak), speed, 11.0, 1.5)
    return runs


def profile(rng: np.random.Generator, peak: float) -> Pressure:
    """Pressure [Pa] of a stop: held, waved, in two steps or slowly let go, from 1.5 s on."""
    rise, kind = float(rng.uniform(0.2, 0.5)), int(rng.integers(4))

    def shape(t: float) -> float:
        if kind == 0:
            return 1.0
        if kind == 1:
            return 0.88 + 0.12 * math.sin(2.5 * t)
        if kind == 2:
            return 0.6 + 0.4 / (1.0 + math.exp(-(t - 1.5) / 0.15))
        return 1.0 - 0.05 * t

    return lambda t: peak * min(max((t - 1.5) / rise, 0.0), 1.0) * shape(max(t - 1.5, 0.0))


def sensors(rng: np.random.Generator, seed: int) -> Sensors:
    """Good sensors: a_x to 0.5 % and 0.02 m/s^2, pressure to 0.5 % and 0.15 bar, v to 0.2 %."""
    loud = float(rng.uniform(0.6, 1.5))
    levels = {name: replace(level, sd=level.sd * loud) for name, level in LEVELS.items()}
    levels["a_x"] = replace(levels["a_x"], quantum=float(rng.choice([0.005, 0.01, 0.02])))
    floor = float(rng.choice([0.0, -math.inf]))  # half of the loggers clip the pressure
    levels["p_mc"] = replace(levels["p_mc"], floor=floor)
    return Sensors(
        zeros={"a_x": float(rng.normal(0.0, 0.02)), "p_mc": float(rng.normal(0.0, 0.15 * BAR))},
        gains={
            "a_x": 1.0 + float(rng.normal(0.0, 0.005)),
            "p_mc": 1.0 + float(rng.normal(0.0, 0.005)),
            "v": 1.0 + float(rng.normal(0.0, 0.002)),
        },
        levels=levels,
        seed=seed,
        with_v=bool(rng.random() < 2.0 / 3.0),
    )


def recorded(name: str, run: Run, sensors: Sensors) -> Log:
    """The log of a run as its sensors give it; the truth stays beside it."""
    how = {"duration": run.duration, "stop_speed": run.stop_speed, "rate": RATE, "rtol": 1e-6}
    log = as_log(drive(run.plant, run.pressure, run.speed, wheel_pressure=run.wheels, **how), name)
    hidden = {f"p_{w}" for w in WHEELS}
    if not sensors.with_drive:
        hidden |= {"T_drive_f", "T_drive_r"}
    channels = {k: x for k, x in log.channels.items() if k not in hidden}
    for channel, gain in sensors.gains.items():
        channels[channel] = gain * channels[channel]
    for channel, zero in sensors.zeros.items():
        channels[channel] = channels[channel] + zero
    if not sensors.with_v:
        del channels["v"]
    seed = sensors.seed + RUNS.index(name)
    return add_noise(replace(log, channels=channels), seed, sensors.levels)


PAIRS = (("fl", "rl"), ("fr", "rr"), ("fl", "rr"), ("fr", "rl"))
"""A front and a rear wheel whose columns may be exchanged."""


def exchanged(log: Log, pair: tuple[str, str]) -> Log:
    """The log with the columns of two wheels exchanged."""
    a, b = (f"omega_{w}" for w in pair)
    return replace(log, channels={**log.channels, a: log[b], b: log[a]})


def with_brakes(run: Run, **shares: float) -> Run:
    """The run with shares of the pressure [1] at some wheels."""
    wheels = {w: (lambda t, s=share: s * run.pressure(t)) for w, share in shares.items()}
    return replace(run, wheels=wheels)


def in_bend(run: Run, radius: float, start: float) -> Run:
    """The run in a bend [m] from a time [s] on."""
    return replace(run, plant=replace(run.plant, curvature=lambda t: (t >= start) / radius))
