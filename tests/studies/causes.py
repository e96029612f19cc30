"""One cause at a time that sets a real car apart from its model: how large it is, and whence.

A cause is drawn for a car as a `Hidden`: what it does to the car and the road of a run, to what the
program is told, to what the sensors read. `CAUSES` has them by name, the control first.

Spreads are those of the road, not of the program's priors. Where the source gives a tolerance it is
named; where it gives a range, the draw is even over the range; the rest is our own estimate and is
called so.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from typing import TypeVar

import numpy as np

from calib.base.names import WHEELS, G
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.sensor_noise import NoiseLevel
from tests.support.made_runs import changed
from tests.support.plant import Plant, Pressure, per_pascal

BAR = 1e5
RAMP, COAST, STOP = "ramp", "coast", "stop"

Rng = np.random.Generator
Levels = dict[str, NoiseLevel]
Car = Callable[[str, Plant, Pressure, float], Plant]
T = TypeVar("T")


@dataclass(frozen=True)
class Hidden:
    """What a car has that its model lacks.

    ``car`` makes the plant of a run from its role, the plant, its pressure and first speed;
    ``told`` the vehicle file; ``sense`` what the sensors read before noise, by role; ``levels``
    their noise and steps.
    """

    car: Car = lambda role, plant, pressure, v0: plant
    told: Callable[[Vehicle], Vehicle] = lambda vehicle: vehicle
    sense: Callable[[str, Log], Log] = lambda role, log: log
    levels: Callable[[Levels], Levels] = lambda levels: levels


def in_role(where: str, drawn: list[T], change: Callable[[Plant, float, T], Plant]) -> Car:
    """The plant of each run that has the role ``where``: a ``change`` of it, by its first speed
    [m/s] and the next one ``drawn``."""

    def car(role: str, p: Plant, pressure: Pressure, v0: float) -> Plant:
        return change(p, v0, drawn.pop()) if role == where else p

    return car


def control(rng: Rng) -> Hidden:
    return Hidden()


def tyres_per_axle(rng: Rng) -> Hidden:
    """One sigma 10 %: pressure, wear and width of front and rear tyres are seldom the same.

    Carlson and Gerdes, IEEE Trans. Control Systems Technology 13 (2005), see the stiffness of one
    tyre move by such amounts with pressure and tread; Gustafsson, Automatica 33 (1997), between
    tyres by more.
    """
    k = math.exp(rng.normal(0.0, 0.10))
    return Hidden(car=lambda role, p, *_: replace(p, rear_stiffness=k * p.rear_stiffness))


def tyres_changed(rng: Rng) -> Hidden:
    """Another set on one axle after the ramp: one sigma 10 %, same sources."""
    k, front = math.exp(rng.normal(0.0, 0.10)), bool(rng.random() < 0.5)

    def car(role: str, p: Plant, *_: object) -> Plant:
        if role != STOP:
            return p
        if not front:
            return replace(p, rear_stiffness=k * p.rear_stiffness)
        road = p.surface or (lambda x: (1.0, 1.0))
        both = lambda x: (k * road(x)[0], road(x)[1])  # noqa: E731
        return replace(p, surface=both, rear_stiffness=p.rear_stiffness / k)

    return Hidden(car=car)


def mass(rng: Rng) -> Hidden:
    """A driver of 75 kg (Regulation (EU) 1230/2012) is in the file; up to two more and their bags
    (75 and 7 kg each), and half a tank more or less (25 kg), are in no file; in the stops others.
    """

    def load() -> float:
        return float(82.0 * rng.integers(0, 3) + rng.uniform(-25.0, 25.0))

    ramp, stops = load(), load()

    def car(role: str, p: Plant, *_: object) -> Plant:
        extra = stops if role == STOP else ramp
        return replace(p, mass_scale=p.mass_scale * (1.0 + extra / p.vehicle.mass))

    return Hidden(car=car)


def centre_of_gravity(rng: Rng) -> Hidden:
    """One sigma 7 %: a height from a sister model or from the roof; a test by ISO 10392 does
    better, and passengers raise it by 2 to 4 % (our estimate)."""
    k = math.exp(rng.normal(0.0, 0.07))
    return Hidden(told=lambda car: replace(car, cg_height=k * car.cg_height))


def a_x_scale(rng: Rng) -> Hidden:
    """One sigma 2.5 %: ADXL350 data sheet, 473.6 to 550.4 LSB/g about 512, 7.5 % at most."""
    k = 1.0 + float(rng.normal(0.0, 0.025))
    return Hidden(sense=lambda role, log: changed(log, a_x=k * log["a_x"]))


def a_x_bias(rng: Rng) -> Hidden:
    """One sigma 0.15 m/s^2, other in every run: 0.31 mg/K (ADXL350 data sheet) over 30 K of a
    car that warms, and half a degree of mounting and of tank and trunk (our estimate)."""
    ramp, stops = rng.normal(0.0, 0.15, 2).tolist()
    return Hidden(
        sense=lambda role, log: changed(log, a_x=log["a_x"] + (stops if role == STOP else ramp))
    )


def body_pitch(rng: Rng) -> Hidden:
    """0.5 to 2 degrees a g: Reimpell, The Automotive Chassis, and Gillespie, Fundamentals of
    Vehicle Dynamics, give passenger cars about 1 to 2 without anti-dive."""
    dip = math.radians(rng.uniform(0.5, 2.0))
    return Hidden(car=lambda role, p, *_: replace(p, pitch_felt=dip))


def grade(rng: Rng) -> Hidden:
    """Ramp and coast on a test track, up to 1 % (49 CFR 571.135, S6.2; California VC 26456); a stop
    on a road, up to 4 %, as German main roads have on a plain (RAL)."""
    track = float(rng.uniform(-0.01, 0.01))
    roads = rng.uniform(-0.04, 0.04, 16).tolist()

    def car(role: str, p: Plant, *_: object) -> Plant:
        return replace(p, grade=roads.pop() if role == STOP else track)

    return Hidden(car=car)


def hills(rng: Rng) -> Hidden:
    """Stops over crests and through dips, 1 to 4 % up and down within 80 to 250 m: the vertical
    curves of main roads (RAL: radii of 3 to 10 km) and, at the short end, of bridges and ramps."""
    drawn = [(rng.uniform(0.01, 0.04), rng.uniform(80.0, 250.0), rng.uniform(0.0, 6.28))
             for _ in range(16)]  # fmt: skip

    def hilly(p: Plant, v0: float, of: tuple[float, float, float]) -> Plant:
        size, length, phase = of
        return replace(p, hills=lambda x: size * math.sin(2.0 * math.pi * x / length + phase))

    return Hidden(car=in_role(STOP, drawn, hilly))


def passenger(rng: Rng) -> Hidden:
    """Somebody of 75 kg in the stops, in half of the cars two; nobody states it."""
    load = 75.0 * float(rng.integers(1, 3))

    def car(role: str, p: Plant, *_: object) -> Plant:
        more = load / p.vehicle.mass if role == STOP else 0.0
        return replace(p, mass_scale=p.mass_scale * (1.0 + more))

    return Hidden(car=car)


def pads_along(rng: Rng) -> Hidden:
    """Friction that goes with speed, 3 % per 15 m/s, and with pressure, 2 % per 30 bar, one sigma
    of each axle: dynamometer runs by ISO 26867 of pads of one grade spread by such amounts (our
    estimate). A pressure of 0.1 to 0.5 bar until the pads touch: springs of the seals (Limpert,
    Brake Design and Safety). The truth is the torque over all of the pressure."""
    by_speed, by_pressure = rng.normal(0.0, 0.03, 2), rng.normal(0.0, 0.02, 2)
    bite = rng.uniform(0.1, 0.5, 2) * BAR

    def car(role: str, p: Plant, pressure: Pressure, v0: float) -> Plant:
        usual = (p.vehicle.front.pad_friction, p.vehicle.rear.pad_friction)
        pads = p.pads or (lambda t: usual)
        time = np.arange(0.0, 60.0, 0.01)
        z = per_pascal(p.vehicle) * np.array([pressure(t) for t in time.tolist()])
        speed = np.maximum(v0 - G * np.cumsum(z) * 0.01, 1.0)

        def now(t: float) -> tuple[float, float]:
            v, on = float(np.interp(t, time, speed)), max(pressure(t), 1.0)
            moved = 1.0 + by_speed * (v / 15.0 - 1.0) + by_pressure * (on / (30.0 * BAR) - 1.0)
            left = np.maximum(1.0 - bite / on, 1e-6) * moved
            front, rear = pads(t)
            return float(front * left[0]), float(rear * left[1])

        return replace(p, pads=now)

    return Hidden(car=car)


def rear_valve(rng: Rng) -> Hidden:
    """A valve that lets 0.3 to 0.5 of the pressure through to the rear brakes above a knee of 15 to
    35 bar, and is not in the vehicle file: usual sizes (Limpert, Brake Design and Safety, ch. 7).
    The truth is the torque over all of the pressure, so the rear pads seem to weaken."""
    slope, knee = rng.uniform(0.3, 0.5), rng.uniform(15.0, 35.0) * BAR

    def car(role: str, p: Plant, pressure: Pressure, v0: float) -> Plant:
        usual = (p.vehicle.front.pad_friction, p.vehicle.rear.pad_friction)
        pads = p.pads or (lambda t: usual)

        def now(t: float) -> tuple[float, float]:
            on = max(pressure(t), 1.0)
            front, rear = pads(t)
            return front, rear * (on - (1.0 - slope) * max(on - knee, 0.0)) / on

        return replace(p, pads=now)

    return Hidden(car=car)


def radius_over_load(rng: Rng) -> Hidden:
    """0.2 to 1 % per 100 % of load: the coefficients BREFF, DREFF and FREFF of common tyre files
    give about 0.4 (Pacejka, Tyre and Vehicle Dynamics, ch. 4, A4 of the MF-Tyre manual)."""
    k = float(rng.uniform(0.002, 0.01))
    return Hidden(car=lambda role, p, *_: replace(p, radius_load=k))


def load_exponent(rng: Rng) -> Hidden:
    """Compliance grows with load to the power 0 to 0.2: PKX1 to PKX3 of tyre files (Pacejka)."""
    k = float(rng.uniform(0.0, 0.2))

    def car(role: str, p: Plant, *_: object) -> Plant:
        inner = p.tyre

        def tyre(slip: float, load: float, stiffness: float, peak: float) -> float:
            return inner(slip, load, stiffness * load**-k, peak)

        return replace(p, tyre=tyre)

    return Hidden(car=car)


def motor_torque(rng: Rng) -> Hidden:
    """20 to 200 N m a wheel that come with the pedal (UN R13-H, category A) or on the lift of the
    other one: 0.01 to 0.1 g, as cars with belt starters and hybrids have; half of them in the
    ramp, too. On a slippery road less, as stability control lets it (our estimate)."""
    torque, front, pedal, ramp = (
        float(rng.uniform(20.0, 200.0)),
        bool(rng.random() < 0.6),
        bool(rng.random() < 0.5),
        bool(rng.random() < 0.5),
    )

    def car(role: str, p: Plant, pressure: Pressure, v0: float) -> Plant:
        if role == COAST or (role == RAMP and not ramp):
            return p

        most = torque * grip(p)

        def motor(t: float) -> tuple[float, float]:
            on = min(max(pressure(t) / (3.0 * BAR), 0.0), 1.0) if pedal else 1.0
            both = -2.0 * most * on
            return (both, 0.0) if front else (0.0, both)

        return replace(p, motor=motor)

    return Hidden(car=car)


def hydraulic_lag(rng: Rng) -> Hidden:
    """0.05 to 0.2 s: Limpert, Brake Design and Safety; UN R13-H lets 0.6 s pass to 75 % force."""
    lag = float(rng.uniform(0.05, 0.20))
    return Hidden(car=lambda role, p, *_: replace(p, hydraulic_lag=lag))


def tyre_relaxation(rng: Rng) -> Hidden:
    """0.1 to 0.6 m of way until a tyre has built up its force: slip stiffness, 20 to 30 times 4 kN,
    over the carcass' stiffness along the wheel, 0.2 to 1 kN/mm (Pacejka, ch. 7). The pedals of the
    stops are fast, 20 to 250 bar/s (`tests.studies.ensemble.profile`)."""
    way = float(rng.uniform(0.1, 0.6))
    return Hidden(car=lambda role, p, *_: replace(p, relaxation=way))


def bends(rng: Rng) -> Hidden:
    """Stops in bends of 1 to 4 m/s^2 at first, less on a slippery road: what drivers do (our
    estimate); the ramp is straight."""
    sideways = rng.choice([-1.0, 1.0], 16) * rng.uniform(1.0, 4.0, 16)
    left = sideways.tolist()

    def car(role: str, p: Plant, pressure: Pressure, v0: float) -> Plant:
        if role != STOP:
            return p
        k = left.pop() * grip(p) / v0**2
        return replace(p, curvature=lambda t: k)

    return Hidden(car=car)


def tone_ring(rng: Rng) -> Hidden:
    """Each ring out of true by 0.05 to 0.15 mm on 50 mm (our estimate of the usual tolerance):
    0.1 to 0.3 % of the wheel speed, once a turn."""
    sizes, angles = rng.uniform(0.001, 0.003, 4), rng.uniform(0.0, 2.0 * math.pi, 4)

    def sense(role: str, log: Log) -> Log:
        seen = {}
        for wheel, size, angle in zip(WHEELS, sizes, angles, strict=True):
            omega = log[f"omega_{wheel}"]
            turned = angle + np.cumsum(omega) * log.sample_time
            seen[f"omega_{wheel}"] = omega * (1.0 + size * np.cos(turned))
        return changed(log, **seen)

    return Hidden(sense=sense)


def quantisation(rng: Rng) -> Hidden:
    """Steps of signals on vehicle buses, as the public DBC files of opendbc have them: wheel speeds
    0.01 to 0.0625 km/h, a_x 0.01 to 0.04 m/s^2, pressure 0.1 to 0.5 bar."""
    speed = float(rng.choice([0.01, 0.03125, 0.05625, 0.0625])) / 3.6 / 0.31
    steps = {f"omega_{w}": speed for w in WHEELS}
    steps |= {"a_x": float(rng.choice([0.01, 0.02, 0.04])), "p_mc": float(rng.choice([0.1, 0.5]))}
    steps["p_mc"] *= BAR
    return Hidden(
        levels=lambda levels: {
            name: replace(level, quantum=steps.get(name, level.quantum))
            for name, level in levels.items()
        }
    )


def bump(rng: Rng, where: str = STOP) -> Hidden:
    """A bump of 0.1 m or a pothole in each stop, or in the ramp, as long as a wheel takes 40 to 80
    ms: the load of an axle falls by 20 to 60 % and rises by the same, then the wheel hops at 10 to
    14 Hz for three turns (Gillespie, Fundamentals of Vehicle Dynamics, chapter 5). a_x shows it
    10 to 30 ms after the wheels, by the filter of the sensor (our estimate)."""
    drawn = [(rng.uniform(0.2, 0.6), rng.uniform(40.0, 75.0), rng.uniform(10.0, 14.0))
             for _ in range(16)]  # fmt: skip
    late = float(rng.uniform(0.01, 0.03))

    def bumpy(p: Plant, v0: float, of: tuple[float, float, float]) -> Plant:
        size, start, hop = of
        length = 0.06 * v0
        swing = 2.0 * math.pi * hop / v0

        def load(x: float) -> float:
            along = x - start
            if along < 0.0:
                return 1.0
            if along < length:
                return 1.0 + size * (-1.0 if along < 0.5 * length else 1.0)
            after = along - length
            return 1.0 + 0.5 * size * math.exp(-after * hop / (3.0 * v0)) * math.sin(swing * after)

        return replace(p, bumps=load)

    def sense(role: str, log: Log) -> Log:
        at = log.time - late
        return changed(log, a_x=np.interp(at, log.time, log["a_x"])) if role == where else log

    return Hidden(car=in_role(where, drawn, bumpy), sense=sense)


def patch(rng: Rng, where: str = STOP) -> Hidden:
    """A patch of 8 to 25 m in each stop, or in the ramp, painted, wet or mended, with 0.4 to 0.8 of
    the friction of its road and 0.8 to 1 of its stiffness (our estimate)."""
    drawn = [
        (
            rng.uniform(40.0, 75.0),
            rng.uniform(8.0, 25.0),
            rng.uniform(0.8, 1.0),
            rng.uniform(0.4, 0.8),
        )
        for _ in range(16)
    ]

    def patched(p: Plant, v0: float, of: tuple[float, float, float, float]) -> Plant:
        start, length, stiffness, peak = of
        before = p.surface or (lambda x: (1.0, 1.0))

        def surface(x: float) -> tuple[float, float]:
            k, mu = before(x)
            on = start < x < start + length
            return (k * stiffness, mu * peak) if on else (k, mu)

        return replace(p, surface=surface)

    return Hidden(car=in_role(where, drawn, patched))


def gear_shift(rng: Rng, where: str = STOP) -> Hidden:
    """An engine brakes the driven axle with 80 to 300 N m: 20 to 40 N m times the ratios of a
    second to fourth gear. It sets in or ends 1 to 3 s after the first pressure, or a shift breaks
    it, or adds to it, for 0.4 to 0.9 s (our estimate)."""
    front = bool(rng.random() < 0.7)
    drawn = [
        (
            float(rng.uniform(80.0, 300.0)),
            float(rng.uniform(2.5, 4.5)),
            float(rng.uniform(0.4, 0.9)),
            int(rng.integers(4)),
        )
        for _ in range(16)
    ]

    def shifted(p: Plant, v0: float, of: tuple[float, float, float, int]) -> Plant:
        size, start, length, kind = of

        def motor(t: float) -> tuple[float, float]:
            inside = start < t < start + length
            on = (t > start, t < start, inside, not inside)[kind]
            both = -size * on
            return (both, 0.0) if front else (0.0, both)

        return replace(p, motor=motor)

    return Hidden(car=in_role(where, drawn, shifted))


def everything(rng: Rng) -> Hidden:
    """All that stands before it, together."""
    before = takewhile(lambda draw: draw is not everything, CAUSES.values())
    return together([draw(rng) for draw in before])


def grip(p: Plant) -> float:
    """Peak of the road over that of a good one [1], at most 1."""
    return min(p.surface(0.0)[1], 1.0) if p.surface else 1.0


def together(parts: list[Hidden]) -> Hidden:
    """Several causes in one car."""

    def car(role: str, p: Plant, pressure: Pressure, v0: float) -> Plant:
        for part in parts:
            p = part.car(role, p, pressure, v0)
        return p

    def told(vehicle: Vehicle) -> Vehicle:
        for part in parts:
            vehicle = part.told(vehicle)
        return vehicle

    def sense(role: str, log: Log) -> Log:
        for part in parts:
            log = part.sense(role, log)
        return log

    def levels(of: Levels) -> Levels:
        for part in parts:
            of = part.levels(of)
        return of

    return Hidden(car, told, sense, levels)


CAUSES: dict[str, Callable[[Rng], Hidden]] = {
    "control": control,
    "tyres per axle": tyres_per_axle,
    "tyres changed after": tyres_changed,
    "mass": mass,
    "centre of gravity": centre_of_gravity,
    "a_x scale": a_x_scale,
    "a_x bias": a_x_bias,
    "body pitch": body_pitch,
    "grade": grade,
    "radius over load": radius_over_load,
    "load exponent": load_exponent,
    "motor torque": motor_torque,
    "hydraulic lag": hydraulic_lag,
    "tyre relaxation": tyre_relaxation,
    "bends": bends,
    "tone ring": tone_ring,
    "quantisation": quantisation,
    "everything": everything,
    "hills": hills,
    "passenger": passenger,
    "pads along a run": pads_along,
    "rear valve": rear_valve,
    "bump": bump,
    "bump in the ramp": partial(bump, where=RAMP),
    "patch": patch,
    "patch in the ramp": partial(patch, where=RAMP),
    "gear shift": gear_shift,
    "gear shift in the ramp": partial(gear_shift, where=RAMP),
}
