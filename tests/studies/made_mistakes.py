"""Mistakes as people make them at a station, by name: how large, and what names them.

A mistake changes a good line of `made_lines` in one place: its vehicle file, what the car, its
driver or its road do in some runs, or its logs. Sizes are drawn. Each has the words (a regular
expression) of which one must be in the answer that names it.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from calib.base.names import WHEELS, G
from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from tests.studies.made_lines import BAR, RUNS, STOPS, Line, Run
from tests.support.plant import Plant, Pressure

Rng = np.random.Generator
Logs = dict[str, Log]
Make = Callable[[Rng], "Mistake"]
"""Draws a mistake."""


@dataclass(frozen=True)
class Mistake:
    """One mistake of one size: the line that it makes of a good one, and the logs."""

    size: str
    line: Callable[[Line], Line] = lambda line: line
    logs: Callable[[Logs], Logs] = lambda logs: logs


def in_file(change: Callable[[Vehicle], Vehicle]) -> Callable[[Line], Line]:
    """A change of the vehicle file."""
    return lambda line: replace(line, file=change(line.file))


def in_runs(names: Iterable[str], change: Callable[[Run], Run]) -> Callable[[Line], Line]:
    """A change of what happens in some runs."""
    return lambda line: replace(
        line, runs={**line.runs, **{name: change(line.runs[name]) for name in names}}
    )


def in_car(names: Iterable[str], change: Callable[[Plant], Plant]) -> Callable[[Line], Line]:
    """A change of what the car and the road are in some runs."""
    return in_runs(names, lambda run: replace(run, plant=change(run.plant)))


def in_channel(
    names: Iterable[str], channel: str, change: Callable[[np.ndarray, Log], np.ndarray]
) -> Callable[[Logs], Logs]:
    """A change of one channel in some logs."""

    def changed(logs: Logs) -> Logs:
        out = dict(logs)
        for name in names:
            log = logs[name]
            if channel in log:
                new = {**log.channels, channel: change(log[channel], log)}
                out[name] = replace(log, channels=new)
        return out

    return changed


def off_by(rng: Rng, low: float, high: float) -> float:
    """A factor that is wrong by ``low`` to ``high`` [1], up or down."""
    return 1.0 + float(rng.choice([-1.0, 1.0])) * float(rng.uniform(low, high))


def percent(factor: float) -> str:
    """The error of a factor."""
    return f"{100 * (factor - 1):+.0f} %"


# The vehicle file, the car, its driver, its road --------------------------------------------------


def file_value(name: str, low: float, high: float) -> Make:
    """A value of the chassis too high or too low."""

    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        return Mistake(
            percent(k), line=in_file(lambda car: replace(car, **{name: k * getattr(car, name)}))
        )

    return make


def too_high(rng: Rng) -> Mistake:
    k = 1.0 + float(rng.uniform(0.1, 0.4))
    return Mistake(percent(k), line=in_file(lambda c: replace(c, cg_height=k * c.cg_height)))


def axle_value(name: str, low: float, high: float, axles: tuple[str, ...]) -> Make:
    """A value of all ``axles``, or of one of them drawn, too high or too low."""

    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        chosen = axles if len(axles) == 2 else (str(rng.choice(["front", "rear"])),)

        def change(car: Vehicle) -> Vehicle:
            new = {side: scaled(getattr(car, side), name, k) for side in chosen}
            return replace(car, **new)

        return Mistake(f"{'+'.join(chosen)} {percent(k)}", line=in_file(change))

    return make


def scaled(axle: Axle, name: str, k: float) -> Axle:
    return replace(axle, **{name: k * getattr(axle, name)})


def pads_swapped(rng: Rng) -> Mistake:
    k = off_by(rng, 0.15, 0.40)

    def change(car: Vehicle) -> Vehicle:
        front, rear = (
            scaled(car.front, "pad_friction", k**0.5),
            scaled(car.rear, "pad_friction", k**-0.5),
        )
        return replace(car, front=front, rear=rear)

    return Mistake(f"ratio {percent(k)}", line=in_file(change))


def heavier(rng: Rng) -> Mistake:
    k = 1.0 + float(rng.uniform(0.05, 0.2))
    return Mistake(percent(k), line=in_car(STOPS, lambda p: replace(p, mass_scale=k)))


def engine(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        torque, front = float(rng.uniform(60.0, 200.0)), bool(rng.random() < 0.7)
        pair = (-2.0 * torque, 0.0) if front else (0.0, -2.0 * torque)
        change = in_car(runs, lambda p: replace(p, motor=lambda t: pair))
        return Mistake(f"{'front' if front else 'rear'} {torque:.0f} N m", line=change)

    return make


def regeneration(rng: Rng) -> Mistake:
    torque, front = float(rng.uniform(40.0, 200.0)), bool(rng.random() < 0.5)

    def change(run: Run) -> Run:
        def motor(t: float) -> tuple[float, float]:
            now = -2.0 * torque * min(max(run.pressure(t) / (3.0 * BAR), 0.0), 1.0)
            return (now, 0.0) if front else (0.0, now)

        return replace(run, plant=replace(run.plant, motor=motor))

    return Mistake(f"{'front' if front else 'rear'} {torque:.0f} N m", line=in_runs(STOPS, change))


def rear_tyres(rng: Rng) -> Mistake:
    k = off_by(rng, 0.10, 0.20)
    change = in_car(RUNS, lambda p: replace(p, rear_stiffness=k * p.rear_stiffness))
    return Mistake(percent(k), line=change)


def tyres_changed(rng: Rng) -> Mistake:
    k, front = off_by(rng, 0.10, 0.20), bool(rng.random() < 0.5)

    def change(p: Plant) -> Plant:
        if front:
            return replace(p, surface=lambda x: (k, 1.0), rear_stiffness=p.rear_stiffness / k)
        return replace(p, rear_stiffness=k * p.rear_stiffness)

    return Mistake(f"{'front' if front else 'rear'} {percent(k)}", line=in_car(STOPS, change))


def bend(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        sideways = float(rng.choice([-1.0, 1.0]) * rng.uniform(1.5, 5.0))

        def change(run: Run) -> Run:
            k = sideways / run.speed**2
            return replace(run, plant=replace(run.plant, curvature=lambda t: k))

        return Mistake(f"{sideways:+.1f} m/s^2 at first", line=in_runs(runs, change))

    return make


def slope(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        k = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.02, 0.04))
        change = in_car(runs, lambda p: replace(p, grade=p.grade + k))
        return Mistake(f"{100 * k:+.1f} %", line=change)

    return make


def rear_held(rng: Rng) -> Mistake:
    """Brake control lets the rear have a share of what goes past a pressure."""
    knee, share = float(rng.uniform(8.0, 15.0)) * BAR, float(rng.uniform(0.0, 0.5))

    def change(run: Run) -> Run:
        def rear(t: float) -> float:
            p = run.pressure(t)
            return p if p < knee else knee + share * (p - knee)

        return replace(run, wheels={**run.wheels, "rl": rear, "rr": rear})

    return Mistake(f"past {knee / BAR:.0f} bar {100 * share:.0f} %", line=in_runs(STOPS, change))


def dragging(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        rest, wheel = float(rng.uniform(2.0, 6.0)) * BAR, str(rng.choice(WHEELS))

        def change(run: Run) -> Run:
            held: Pressure = lambda t: max(run.pressure(t), rest)  # noqa: E731
            return replace(run, wheels={**run.wheels, wheel: held})

        return Mistake(f"{wheel} {rest / BAR:.1f} bar", line=in_runs(runs, change))

    return make


def abs_in_ramp(rng: Rng) -> Mistake:
    """ABS holds the front brakes at what the road bears and lets their wheels dip 5 times a second.

    The dips are drawn as half sine waves of slip, as they look in a log.
    """
    share, depth = float(rng.uniform(0.6, 0.8)), float(rng.uniform(0.08, 0.20))

    def change(run: Run) -> Run:
        most = share * run.pressure(run.duration)
        held: Pressure = lambda t: min(run.pressure(t), most)  # noqa: E731
        return replace(run, wheels={"fl": held, "fr": held})

    def dipped(x: np.ndarray, log: Log) -> np.ndarray:
        works = log["p_mc"] > share * log["p_mc"].max()
        return x * (1.0 - depth * works * np.maximum(np.sin(2.0 * math.pi * 5.0 * log.time), 0.0))

    def logs(of: Logs) -> Logs:
        for wheel in ("omega_fl", "omega_fr"):
            of = in_channel(("ramp",), wheel, dipped)(of)
        return of

    return Mistake(f"{100 * depth:.0f} % slip", line=in_runs(("ramp",), change), logs=logs)


# The logs ----------------------------------------------------------------------------------------


def gain(runs: tuple[str, ...], channel: str, low: float, high: float) -> Make:
    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        return Mistake(percent(k), logs=in_channel(runs, channel, lambda x, log: k * x))

    return make


def times(runs: tuple[str, ...], channel: str, k: float) -> Make:
    return lambda rng: Mistake(f"x {k:g}", logs=in_channel(runs, channel, lambda x, log: k * x))


def acceleration_offset(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        b = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.5))
        return Mistake(f"{b:+.2f} m/s^2", logs=in_channel(runs, "a_x", lambda x, log: x + b))

    return make


def pressure_offset(floor: float) -> Make:
    def make(rng: Rng) -> Mistake:
        b = float(rng.choice([-1.0, 1.0]) * rng.uniform(1.5, 6.0))
        change = in_channel(RUNS, "p_mc", lambda x, log: np.maximum(x + b * BAR, floor))
        return Mistake(f"{b:+.1f} bar", logs=change)

    return make


def late(runs: tuple[str, ...], channel: str) -> Make:
    def make(rng: Rng) -> Mistake:
        delay = float(rng.uniform(0.1, 0.4))

        def shifted(x: np.ndarray, log: Log) -> np.ndarray:
            n = round(delay / log.sample_time)
            return np.concatenate([np.full(n, x[0]), x[:-n]])

        return Mistake(f"{delay:.2f} s", logs=in_channel(runs, channel, shifted))

    return make


def clock(channel: str) -> Make:
    """The clock of whole logs, or of one channel in them."""

    def make(rng: Rng) -> Mistake:
        k = off_by(rng, 0.02, 0.10)
        if channel == "time":
            return Mistake(percent(k), logs=in_channel(RUNS, "time", lambda t, log: k * t))
        change = in_channel(RUNS, channel, lambda x, log: np.interp(log.time / k, log.time, x))
        return Mistake(percent(k), logs=change)

    return make


def copied(channel: str, source: str) -> Make:
    change = in_channel(RUNS, channel, lambda x, log: log[source].copy())
    return lambda rng: Mistake(f"{source} in {channel}", logs=change)


def pressure_in_acceleration(rng: Rng) -> Mistake:
    k = float(rng.uniform(0.9, 1.1)) * G / 70e5
    change = in_channel(RUNS, "a_x", lambda x, log: -k * log["p_mc"])
    return Mistake("p_mc in a_x", logs=change)


def swapped(pairs: tuple[tuple[str, str], ...]) -> Make:
    def exchange(logs: Logs) -> Logs:
        new = {a: b for pair in pairs for a, b in (pair, pair[::-1])}
        return {
            name: replace(
                log,
                channels={
                    **log.channels,
                    **{f"omega_{a}": log[f"omega_{b}"] for a, b in new.items()},
                },
            )
            for name, log in logs.items()
        }

    return lambda rng: Mistake("+".join(f"{a}<->{b}" for a, b in pairs), logs=exchange)


def ramp_again(rng: Rng) -> Mistake:
    return Mistake("stop_1", logs=lambda logs: {**logs, "stop_1": logs["ramp"]})


RAMP = ("ramp",)


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
BEND = r"\bbend|corner|curve|steer|lateral"
SLOPE = r"slope|grade|hill|incline"
DRAG = r"drags|dragging|residual|seiz|stuck|sticks"
SWAPPED = r"swapp|exchang|mixed up|wrong (side|axle)"
CONTROL = r"rear brakes|brake control|wheel pressure|proportion|\bp_r[lr]\b"

# Kinds ------------------------------------------------------------------------------------------

ALL = RUNS
BOTH = ("front", "rear")
KINDS: dict[str, Kind] = {
    "a_x gain, all": Kind(A_X, ALL, gain(ALL, "a_x", 0.03, 0.20)),
    "a_x gain, ramp": Kind(A_X, RAMP, gain(RAMP, "a_x", 0.03, 0.20)),
    "a_x gain, stops": Kind(A_X, STOPS, gain(STOPS, "a_x", 0.03, 0.20)),
    "a_x offset, all": Kind(A_X, ALL, acceleration_offset(ALL)),
    "a_x offset, ramp": Kind(A_X, RAMP, acceleration_offset(RAMP)),
    "a_x offset, stops": Kind(A_X, STOPS, acceleration_offset(STOPS)),
    "a_x late, ramp": Kind(A_X, RAMP, late(RAMP, "a_x")),
    "p_mc offset": Kind(PRESSURE, ALL, pressure_offset(-math.inf)),
    "p_mc offset, clipped": Kind(PRESSURE, ALL, pressure_offset(0.0)),
    "p_mc gain, all": Kind(PRESSURE, ALL, gain(ALL, "p_mc", 0.05, 0.20)),
    "p_mc gain, ramp": Kind(PRESSURE, RAMP, gain(RAMP, "p_mc", 0.05, 0.20)),
    "p_mc in MPa called bar": Kind(PRESSURE, ALL, times(ALL, "p_mc", 0.1)),
    "p_mc late, ramp": Kind(PRESSURE, RAMP, late(RAMP, "p_mc")),
    "p_mc late, all": Kind(PRESSURE, ALL, late(ALL, "p_mc")),
    "centre of gravity too high": Kind(HEIGHT, ALL, too_high),
    "mass of the file": Kind(MASS, ALL, file_value("mass", 0.05, 0.20)),
    "loaded in the stops": Kind(MASS, STOPS, heavier),
    "engine drag, all": Kind(MOTOR, ALL, engine(ALL)),
    "engine drag, ramp": Kind(MOTOR, RAMP, engine(RAMP)),
    "engine drag, stops": Kind(MOTOR, STOPS, engine(STOPS)),
    "regeneration, stops": Kind(MOTOR, STOPS, regeneration),
    "pad ratio of the file": Kind(PADS, ALL, pads_swapped),
    "piston area of one axle": Kind(PADS, ALL, axle_value("piston_area", 0.10, 0.30, ())),
    "rear tyres unlike": Kind(TYRES, ALL, rear_tyres),
    "tyres changed after": Kind(TYRES, STOPS, tyres_changed),
    "rolling radius, both": Kind(RADIUS, ALL, axle_value("rolling_radius", 0.02, 0.06, BOTH)),
    "rolling radius, one axle": Kind(RADIUS, ALL, axle_value("rolling_radius", 0.02, 0.06, ())),
    "wheel inertia": Kind(r"inertia", ALL, axle_value("wheel_inertia", 0.3, 0.7, BOTH)),
    "omega_rl copied": Kind(r"omega_r[lr]|one signal|same signal|cop(y|ied)", ALL,
                            copied("omega_rr", "omega_rl"), counts=True),
    "p_mc in a_x": Kind(f"{A_X}|{PRESSURE}", ALL, pressure_in_acceleration, counts=True),
    "left and right swapped": Kind(SWAPPED, ALL, swapped((("fl", "fr"), ("rl", "rr")))),
    "front and rear swapped": Kind(SWAPPED, ALL, swapped((("fl", "rl"), ("fr", "rr")))),
    "clock of the logs": Kind(CLOCK, ALL, clock("time")),
    "clock of v": Kind(f"{CLOCK}|{SPEED}", ALL, clock("v"), needs_v=True),
    "v in km/h called m/s": Kind(SPEED, ALL, times(ALL, "v", 3.6), needs_v=True),
    "v gain": Kind(SPEED, ALL, gain(ALL, "v", 0.02, 0.05), needs_v=True),
    "bend, ramp": Kind(BEND, RAMP, bend(RAMP)),
    "bend, stops": Kind(BEND, STOPS, bend(STOPS)),
    "slope, all": Kind(SLOPE, ALL, slope(ALL)),
    "slope, ramp": Kind(SLOPE, RAMP, slope(RAMP)),
    "slope, stops": Kind(SLOPE, STOPS, slope(STOPS)),
    "rear pressure held, stops": Kind(CONTROL, STOPS, rear_held),
    "brake drags, all": Kind(DRAG, ALL, dragging(ALL)),
    "brake drags, ramp": Kind(DRAG, RAMP, dragging(RAMP)),
    "brake drags, stops": Kind(DRAG, STOPS, dragging(STOPS)),
    "ramp as hold-out": Kind(r"fitted on this log|hold-out|run once", STOPS, ramp_again,
                             counts=True),
    "ABS in the ramp": Kind(r"\bABS\b|\block", RAMP, abs_in_ramp),
}  # fmt: skip
