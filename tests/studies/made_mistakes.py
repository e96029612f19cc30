"""Mistakes as people make them at a station, by name: how large, and what names them.

A mistake changes a good line of `made_lines` in one place: its vehicle file, what the car, its
driver or its road do in some runs, or its logs. Sizes are drawn. Each has the words (a regular
expression) of which one must be in the answer that names it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from calib.base.arrays import Array
from calib.base.names import WHEELS, G
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from tests.studies.made_lines import BAR, RUNS, STOPS, Line, Run, exchanged, line
from tests.support.plant import Plant, Pressure

Rng = np.random.Generator
Logs = dict[str, Log]
Make = Callable[[Rng], "Mistake"]
"""Draws a mistake."""


@dataclass(frozen=True)
class Mistake:
    """One mistake of one size: what becomes of the vehicle ``file``, of a ``run``, of ``channels``
    by name in its log, of all ``logs``; whether the torque of motors is among the channels.

    ``entries`` that it makes wrong, as the program's list of unseen errors calls them, with the
    relative error [1].
    """

    size: str
    file: Callable[[Vehicle], Vehicle] = lambda car: car
    run: Callable[[Run], Run] | None = None
    channels: dict[str, Callable[[Array, Log], Array]] = field(default_factory=dict)
    logs: Callable[[Logs], Logs] = lambda logs: logs
    with_drive: bool = False
    entries: dict[str, float] = field(default_factory=dict)

    def line(self, line: Line, runs: tuple[str, ...]) -> Line:
        """The line that it makes of a good one, in some of its runs."""
        changed = {name: self.run(line.runs[name]) for name in runs} if self.run else {}
        sensors = replace(line.sensors, with_drive=self.with_drive)
        return replace(
            line, file=self.file(line.file), runs={**line.runs, **changed}, sensors=sensors
        )

    def recorded(self, logs: Logs, runs: tuple[str, ...]) -> Logs:
        """The logs of that line, wrong in some of its runs."""
        out = dict(logs)
        for name in runs:
            log = logs[name]
            new = {c: change(log[c], log) for c, change in self.channels.items() if c in log}
            out[name] = replace(log, channels={**log.channels, **new})
        return self.logs(out)


def of_car(size: str, change: Callable[[Plant], Plant]) -> Mistake:
    """A change of what the car and the road are."""
    return Mistake(size, run=lambda run: replace(run, plant=change(run.plant)))


def sign(rng: Rng) -> float:
    return float(rng.choice([-1.0, 1.0]))


def off_by(rng: Rng, low: float, high: float) -> float:
    """A factor that is wrong by ``low`` to ``high`` [1], up or down."""
    return 1.0 + sign(rng) * float(rng.uniform(low, high))


def percent(factor: float) -> str:
    """The error of a factor."""
    return f"{100 * (factor - 1):+.0f} %"


def axle(front: bool) -> str:
    return "front" if front else "rear"


# The vehicle file, the car, its driver, its road --------------------------------------------------


def file_value(name: str, low: float, high: float, up: bool = False) -> Make:
    """A value of the chassis too high, or also too low."""

    def make(rng: Rng) -> Mistake:
        k = 1.0 + float(rng.uniform(low, high)) if up else off_by(rng, low, high)
        return Mistake(
            percent(k),
            lambda car: replace(car, **{name: k * getattr(car, name)}),
            entries={name: k - 1.0},
        )

    return make


def axle_value(name: str, low: float, high: float, axles: tuple[str, ...] = ()) -> Make:
    """A value of all ``axles``, or of one of them drawn, too high or too low."""

    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        chosen = axles or (str(rng.choice(["front", "rear"])),)
        factors = dict.fromkeys(chosen, k)
        return Mistake(
            f"{'+'.join(chosen)} {percent(k)}",
            lambda car: scaled(car, name, factors),
            entries=dict.fromkeys([f"{axle}.{name}" for axle in chosen], k - 1.0),
        )

    return make


def scaled(car: Vehicle, name: str, factors: dict[str, float]) -> Vehicle:
    """The car with a value of some axles times a factor."""
    axles = {side: getattr(car, side) for side in factors}
    new = {s: replace(a, **{name: factors[s] * getattr(a, name)}) for s, a in axles.items()}
    return replace(car, **new)


def pads_swapped(rng: Rng) -> Mistake:
    k = off_by(rng, 0.15, 0.40)
    factors = {"front": k**0.5, "rear": k**-0.5}
    return Mistake(f"ratio {percent(k)}", lambda car: scaled(car, "pad_friction", factors))


def heavier(rng: Rng) -> Mistake:
    k = 1.0 + float(rng.uniform(0.05, 0.2))
    loaded = of_car(percent(k), lambda p: replace(p, mass_scale=k))
    return replace(loaded, entries={"mass": k - 1.0})


def engine(rng: Rng) -> Mistake:
    torque, front = float(rng.uniform(60.0, 200.0)), bool(rng.random() < 0.7)
    pair = (-2.0 * torque, 0.0) if front else (0.0, -2.0 * torque)
    size = f"{axle(front)} {torque:.0f} N m"
    return of_car(size, lambda p: replace(p, motor=lambda t: pair))


def motor(low: float, high: float, full: tuple[float, float], factor: float | None = None) -> Make:
    """A motor of ``low`` to ``high`` [N m] at both wheels, with the pedal, ``full`` from a pressure
    [bar] on; its torque is logged times a ``factor``, or not at all.
    """

    def make(rng: Rng) -> Mistake:
        torque, front = float(rng.uniform(low, high)), bool(rng.random() < 0.5)
        pressed = BAR * float(rng.uniform(*full))

        def change(run: Run) -> Run:
            def drive(t: float) -> tuple[float, float]:
                now = -torque * min(max(run.pressure(t) / pressed, 0.0), 1.0)
                return (now, 0.0) if front else (0.0, now)

            return replace(run, plant=replace(run.plant, motor=drive))

        return Mistake(
            f"{axle(front)} {torque:.0f} N m from {pressed / BAR:.0f} bar",
            file=lambda car: replace(car, motor_odds=0.1),  # nobody said that it has none
            run=change,
            channels={f"T_drive_{a}": lambda x, log: (factor or 1.0) * x for a in "fr"},
            with_drive=factor is not None,
        )

    return make


def rear_tyres(rng: Rng) -> Mistake:
    k = off_by(rng, 0.10, 0.20)
    return of_car(percent(k), lambda p: replace(p, rear_stiffness=k * p.rear_stiffness))


def tyres_changed(rng: Rng) -> Mistake:
    k, front = off_by(rng, 0.10, 0.20), bool(rng.random() < 0.5)

    def change(p: Plant) -> Plant:
        if front:
            return replace(p, surface=lambda x: (k, 1.0), rear_stiffness=p.rear_stiffness / k)
        return replace(p, rear_stiffness=k * p.rear_stiffness)

    return of_car(f"{axle(front)} {percent(k)}", change)


def bend(rng: Rng) -> Mistake:
    sideways = sign(rng) * float(rng.uniform(1.5, 5.0))

    def change(run: Run) -> Run:
        k = sideways / run.speed**2
        return replace(run, plant=replace(run.plant, curvature=lambda t: k))

    return Mistake(f"{sideways:+.1f} m/s^2 at first", run=change)


def slope(rng: Rng) -> Mistake:
    k = sign(rng) * float(rng.uniform(0.02, 0.04))
    return of_car(f"{100 * k:+.1f} %", lambda p: replace(p, grade=p.grade + k))


def rear_held(rng: Rng) -> Mistake:
    """Brake control lets the rear have a share of what goes past a pressure."""
    knee, share = float(rng.uniform(8.0, 15.0)) * BAR, float(rng.uniform(0.0, 0.5))

    def change(run: Run) -> Run:
        def rear(t: float) -> float:
            p = run.pressure(t)
            return p if p < knee else knee + share * (p - knee)

        return replace(run, wheels={**run.wheels, "rl": rear, "rr": rear})

    return Mistake(f"past {knee / BAR:.0f} bar {100 * share:.0f} %", run=change)


def dragging(rng: Rng) -> Mistake:
    rest_pressure, wheel = float(rng.uniform(2.0, 6.0)) * BAR, str(rng.choice(WHEELS))

    def change(run: Run) -> Run:
        pressure: Pressure = lambda t: max(run.pressure(t), rest_pressure)  # noqa: E731
        return replace(run, wheels={**run.wheels, wheel: pressure})

    return Mistake(f"{wheel} {rest_pressure / BAR:.1f} bar", run=change)


def abs_in_ramp(rng: Rng) -> Mistake:
    """ABS holds the front brakes at what the road bears and lets their wheels dip 5 times a second.

    The dips are drawn as half sine waves of slip, as they look in a log.
    """
    share, depth = float(rng.uniform(0.6, 0.8)), float(rng.uniform(0.08, 0.20))

    def change(run: Run) -> Run:
        most = share * run.pressure(run.duration)
        limited: Pressure = lambda t: min(run.pressure(t), most)  # noqa: E731
        return replace(run, wheels={"fl": limited, "fr": limited})

    def dipped(x: Array, log: Log) -> Array:
        works = log["p_mc"] > share * log["p_mc"].max()
        return x * (1.0 - depth * works * np.maximum(np.sin(2.0 * math.pi * 5.0 * log.time), 0.0))

    wheels = {"omega_fl": dipped, "omega_fr": dipped}
    return Mistake(f"{100 * depth:.0f} % slip", run=change, channels=wheels)


# The logs ----------------------------------------------------------------------------------------


def times(channel: str, k: float) -> Make:
    return lambda rng: Mistake(f"x {k:g}", channels={channel: lambda x, log: k * x})


def gain(channel: str, low: float, high: float) -> Make:
    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        changed = {channel: lambda x, log: k * x}
        return Mistake(percent(k), channels=changed, entries={channel: k - 1.0})

    return make


def offset(channel: str, low: float, high: float, floor: float = -math.inf) -> Make:
    """A zero of ``low`` to ``high`` [SI], up or down, of a channel that is cut at ``floor``."""

    def make(rng: Rng) -> Mistake:
        b = sign(rng) * float(rng.uniform(low, high))
        return Mistake(f"{b:+.3g}", channels={channel: lambda x, log: np.maximum(x + b, floor)})

    return make


def late(channel: str) -> Make:
    def make(rng: Rng) -> Mistake:
        delay = float(rng.uniform(0.1, 0.4))

        def shifted(x: Array, log: Log) -> Array:
            n = round(delay / log.sample_time)
            return np.concatenate([np.full(n, x[0]), x[:-n]])

        return Mistake(f"{delay:.2f} s", channels={channel: shifted})

    return make


def wheels_late(rng: Rng) -> Mistake:
    """The wheel speeds of one axle, as of a controller that filters or sends them later."""
    delay, side = float(rng.uniform(0.02, 0.06)), str(rng.choice(["f", "r"]))

    def shifted(x: Array, log: Log) -> Array:
        return np.asarray(np.interp(log.time - delay, log.time, x))

    channels = {f"omega_{side}{left}": shifted for left in "lr"}
    return Mistake(f"{axle(side == 'f')} {1e3 * delay:.0f} ms", channels=channels)


def wheel_off(rng: Rng) -> Mistake:
    k, wheel = 1.0 + 0.03 * sign(rng), str(rng.choice(WHEELS))
    return Mistake(f"{wheel} {percent(k)}", channels={f"omega_{wheel}": lambda x, log: k * x})


def another_car(rng: Rng) -> Mistake:
    """The runs of another car, with the same pressures."""
    other = line(rng, 0).runs["ramp"].plant
    return of_car(f"of {other.vehicle.mass:.0f} kg", lambda plant: other)


def clock_of_v(rng: Rng) -> Mistake:
    k = off_by(rng, 0.02, 0.10)

    def ran_off(logs: Logs) -> Logs:  # the logs end where the other clock ends
        return {name: cut(log, k * log.time[-1]) for name, log in logs.items()}

    def cut(log: Log, end: float) -> Log:
        inside = log.time <= end
        late = {**log.channels, "v": np.interp(log.time / k, log.time, log["v"])}
        channels = {name: x[inside] for name, x in late.items()}
        return replace(log, channels=channels, truth={n: x[inside] for n, x in log.truth.items()})

    return Mistake(percent(k), logs=ran_off)


def wheel_copied(rng: Rng) -> Mistake:
    return Mistake("omega_rl", channels={"omega_rr": lambda x, log: log["omega_rl"].copy()})


def pressure_in_acceleration(rng: Rng) -> Mistake:
    k = float(rng.uniform(0.9, 1.1)) * G / 70e5
    return Mistake("p_mc in a_x", channels={"a_x": lambda x, log: -k * log["p_mc"]})


def slope_in_v(rng: Rng) -> Mistake:
    """a_x is the difference of v over 0.16 s, on a slope."""
    k, n = sign(rng) * float(rng.uniform(0.02, 0.05)), 8

    def slowed(x: Array, log: Log) -> Array:
        v = np.pad(log["v"], n, mode="edge")
        return np.asarray((v[2 * n :] - v[: -2 * n]) / (2 * n * log.sample_time))

    change = of_car("", lambda p: replace(p, grade=k)).run
    return Mistake(f"{100 * k:+.1f} %", run=change, channels={"a_x": slowed})


def mirrored(rng: Rng) -> Mistake:
    return Mistake("fr rr", channels={f"omega_{w}": lambda x, log: -x for w in ("fr", "rr")})


def wheels_of(chosen: str, low: float, high: float, scale: bool) -> Make:
    """Wheel speeds of ``chosen`` names of wheels with an offset [rad/s], or times 1 plus it."""

    def make(rng: Rng) -> Mistake:
        by = sign(rng) * float(rng.uniform(low, high))
        changed = lambda x, log: x * (1.0 + by) if scale else x + by  # noqa: E731
        channels = {f"omega_{w}": changed for w in chosen.split()}
        return Mistake(f"{chosen} {by:+.3g}", channels=channels)

    return make


def swapped(*pairs: tuple[str, str]) -> Make:
    def exchange(logs: Logs) -> Logs:
        for pair in pairs:
            logs = {name: exchanged(log, pair) for name, log in logs.items()}
        return logs

    return lambda rng: Mistake("+".join(f"{a}<->{b}" for a, b in pairs), logs=exchange)


def ramp_again(rng: Rng) -> Mistake:
    return Mistake("stop_1", logs=lambda logs: {**logs, "stop_1": logs["ramp"]})


@dataclass(frozen=True)
class Kind:
    """``named`` words that name the cause; ``runs`` that it touches; ``make`` draws one.

    ``needs_v`` for a mistake of v; ``counts`` for one that is wrong whatever it moves.
    """

    named: str
    runs: tuple[str, ...]
    make: Make
    needs_v: bool = False
    counts: bool = False


# Words ------------------------------------------------------------------------------------------

A_X = r"\ba_x\b|acceleromet"
PRESSURE = r"\bp_mc\b|(?<!tyre )\bpressures?\b"
CLOCK = r"clock|sample rate|sampling"
HEIGHT = r"cg_height|cent(re|er) of gravity"
MASS = r"\bmass\b|weigh|payload|loaded|\bload of the car|\bload that"
MOTOR = r"engine|motor|in gear|regenerat|T_drive|retard"
PADS = r"\bpads?\b|pad_friction|caliper|piston"
TYRES = r"\btyres?\b"
RADIUS = r"radius|radii|\btyres?\b|wheel size"
SPEED = r"\bv\b|reference speed"
WHEELS_LATE = r"\bwheels? .*late|late.*\bwheels?|clock"
WHEEL = r"\bwheels?\b|omega_|\btyres?\b"
CAR = r"(another|other|of the) (car|vehicle)|\bcar of|vehicle file"
BEND = r"\bbend|corner|curve|steer|lateral"
SLOPE = r"slope|grade|hill|incline"
DRAG = r"drags|dragging|residual|seiz|stuck|sticks"
SWAPPED = r"swapp|exchang|mixed up|wrong (side|axle)"
CONTROL = r"rear brakes|brake control|wheel pressure|proportion|\bp_r[lr]\b"

# Kinds --------------------------------------------------------------------------------------------

ALL, RAMP = RUNS, ("ramp",)
BOTH = ("front", "rear")
KINDS: dict[str, Kind] = {
    "a_x gain, all": Kind(A_X, ALL, gain("a_x", 0.03, 0.20)),
    "a_x gain, ramp": Kind(A_X, RAMP, gain("a_x", 0.03, 0.20)),
    "a_x gain, stops": Kind(A_X, STOPS, gain("a_x", 0.03, 0.20)),
    "a_x offset, all": Kind(A_X, ALL, offset("a_x", 0.1, 0.5)),
    "a_x offset, ramp": Kind(A_X, RAMP, offset("a_x", 0.1, 0.5)),
    "a_x offset, stops": Kind(A_X, STOPS, offset("a_x", 0.1, 0.5)),
    "a_x late, ramp": Kind(A_X, RAMP, late("a_x")),
    "p_mc offset": Kind(PRESSURE, ALL, offset("p_mc", 1.5 * BAR, 6.0 * BAR)),
    "p_mc offset, clipped": Kind(PRESSURE, ALL, offset("p_mc", 1.5 * BAR, 6.0 * BAR, 0.0)),
    "p_mc gain, all": Kind(PRESSURE, ALL, gain("p_mc", 0.05, 0.20)),
    "p_mc gain, ramp": Kind(PRESSURE, RAMP, gain("p_mc", 0.05, 0.20)),
    "p_mc in MPa called bar": Kind(PRESSURE, ALL, times("p_mc", 0.1)),
    "p_mc late, ramp": Kind(PRESSURE, RAMP, late("p_mc")),
    "p_mc late, all": Kind(PRESSURE, ALL, late("p_mc")),
    "centre of gravity too high": Kind(HEIGHT, ALL, file_value("cg_height", 0.1, 0.4, up=True)),
    "mass of the file": Kind(MASS, ALL, file_value("mass", 0.05, 0.20)),
    "loaded in the stops": Kind(MASS, STOPS, heavier),
    "engine drag, all": Kind(MOTOR, ALL, engine),
    "engine drag, ramp": Kind(MOTOR, RAMP, engine),
    "engine drag, stops": Kind(MOTOR, STOPS, engine),
    "regeneration, stops": Kind(MOTOR, STOPS, motor(80.0, 400.0, (3.0, 3.0))),
    "pad ratio of the file": Kind(PADS, ALL, pads_swapped),
    "piston area of one axle": Kind(PADS, ALL, axle_value("piston_area", 0.10, 0.30)),
    "rear tyres unlike": Kind(TYRES, ALL, rear_tyres),
    "tyres changed after": Kind(TYRES, STOPS, tyres_changed),
    "rolling radius, both": Kind(RADIUS, ALL, axle_value("rolling_radius", 0.02, 0.06, BOTH)),
    "rolling radius, one axle": Kind(RADIUS, ALL, axle_value("rolling_radius", 0.02, 0.06)),
    "wheel inertia": Kind(r"inertia", ALL, axle_value("wheel_inertia", 0.3, 0.7, BOTH)),
    "omega_rl copied": Kind(r"omega_r[lr]|one signal|same signal|cop(y|ied)", ALL,
                            wheel_copied, counts=True),
    "p_mc in a_x": Kind(f"{A_X}|{PRESSURE}", ALL, pressure_in_acceleration, counts=True),
    "left and right swapped": Kind(SWAPPED, ALL, swapped(("fl", "fr"), ("rl", "rr"))),
    "front and rear swapped": Kind(SWAPPED, ALL, swapped(("fl", "rl"), ("fr", "rr"))),
    "clock of the logs": Kind(CLOCK, ALL, gain("time", 0.02, 0.10)),
    "clock of v": Kind(f"{CLOCK}|{SPEED}", ALL, clock_of_v, needs_v=True),
    "v in km/h called m/s": Kind(SPEED, ALL, times("v", 3.6), needs_v=True),
    "v gain": Kind(SPEED, ALL, gain("v", 0.02, 0.05), needs_v=True),
    "v late, all": Kind(SPEED, ALL, late("v"), needs_v=True),
    "wheels of an axle late, all": Kind(WHEELS_LATE, ALL, wheels_late),
    "wheels of an axle late, ramp": Kind(WHEELS_LATE, RAMP, wheels_late),
    "wheels of an axle late, stops": Kind(WHEELS_LATE, STOPS, wheels_late),
    "a wheel 3 % off, ramp": Kind(WHEEL, RAMP, wheel_off),
    "a wheel 3 % off, stops": Kind(WHEEL, STOPS, wheel_off),
    "ramp of another car": Kind(CAR, RAMP, another_car),
    "coast of another car": Kind(CAR, ("coast",), another_car),
    "stops of another car": Kind(CAR, STOPS, another_car),
    "bend, ramp": Kind(BEND, RAMP, bend),
    "bend, stops": Kind(BEND, STOPS, bend),
    "slope, all": Kind(SLOPE, ALL, slope),
    "slope, ramp": Kind(SLOPE, RAMP, slope),
    "slope, stops": Kind(SLOPE, STOPS, slope),
    "rear pressure held, stops": Kind(CONTROL, STOPS, rear_held),
    "brake drags, all": Kind(DRAG, ALL, dragging),
    "brake drags, ramp": Kind(DRAG, RAMP, dragging),
    "brake drags, stops": Kind(DRAG, STOPS, dragging),
    "ramp as hold-out": Kind(r"fitted on this log|hold-out|run once", STOPS, ramp_again,
                             counts=True),
    "ABS in the ramp": Kind(r"\bABS\b|\block", RAMP, abs_in_ramp),
    "motor not logged, all": Kind(MOTOR, ALL, motor(250.0, 600.0, (4.0, 15.0))),
    "one motor of two, all": Kind(MOTOR, ALL, motor(400.0, 600.0, (4.0, 15.0), 0.5)),
    "motor at its shaft, all": Kind(MOTOR, ALL, motor(250.0, 600.0, (4.0, 15.0), 0.1)),
    "motor of another sign": Kind(MOTOR, ALL, motor(250.0, 600.0, (4.0, 15.0), -1.0)),
    "a_x of v, on a slope": Kind("derivative of", ALL, slope_in_v, needs_v=True),
    "wheels offset, all": Kind("offset of the", ALL, wheels_of("fl fr rl rr", 4.0, 60.0, False),
                               needs_v=True, counts=True),
    "right wheels mirrored": Kind("sign of", ALL, mirrored, counts=True),
    "radius of an axle, log": Kind(RADIUS, ALL, wheels_of("rl rr", 0.04, 0.06, True)),
}  # fmt: skip
