"""Measure how often an answer of an ECU is VALID and wrong, and how often a clean stop is refused.

    python tests/studies/failing_stops.py --first 300 --cars 6

The drives are those of cars of `failing_plant`: clean, with oddities, with ABS, and with sensors
that fail in the middle. A drive has three stops in 17 s.

A sample is wrong if its answer is VALID and the pads of an axle are more than 4 % outside the
bounds, while the car brakes, from 0.5 s after the fault on. Where a sensor fails, samples that are
wrong without the fault do not count. "Afterwards" is from 2 s after the end of a fault on, or the
stops that begin after it; its VALID is a share of the samples that are VALID without the fault.
"""

import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

sys.path.insert(0, str(Path(__file__).parents[2]))

import calib
from calib.base.arrays import Array, Mask
from calib.base.names import WHEELS
from calib.estimation.online import online
from calib.estimation.readout import Bounded
from calib.estimation.reasons import Reason
from calib.logs.log import Log
from calib.table.table import Table
from tests.studies.failing_plant import PATTERN, SLIP, Plant, Scene, drawn, run
from tests.studies.study import arguments

TIME = np.arange(0.0, 17.0, 1e-3)
STOPS = (3.0, 6.0), (8.5, 11.0), (13.0, 15.0)  # [s]
MARGIN, LATE, AGAIN = 0.04, 0.5, 2.0  # of the bounds [1]; after a fault, after its end [s]
V0, BRAKED = 38.0, 4e5  # [m/s]; [Pa]
ODDITIES = [
    "padstep",
    "padalike",
    "fade",
    "wet",
    "slope",
    "slope0",
    "road",
    "gear",
    "regen",
    "bump",
]
FACTORS = (1.0 / 3.6, 0.8, 1.25, 3.6, 0.9, 1.1)  # of wheel speeds in another unit


class Drive(NamedTuple):
    """A log with the begin and the end of its fault [s]; a ``group`` is a row of its ``kind``."""

    kind: str
    group: str
    car: int
    log: Log
    begin: float = 0.0
    end: float = 99.0


class Clean(NamedTuple):
    """Where the answers of a drive without a fault are wrong, and where VALID (n,)."""

    wrong: Mask
    valid: Mask


def rise(begin: float, end: float) -> Array:
    """Return a ramp from 0 to 1 between two times (t,)."""
    return np.clip((TIME - begin) / (end - begin), 0.0, 1.0)


def pedal(r: np.random.Generator, scale: float = 1.0) -> Array:
    """Return the pressure of three stops (t,) [Pa]: held, pumped, pressed again or eased."""
    pressure = np.zeros_like(TIME)
    for begin, end in STOPS:
        level, ramp = r.uniform(22e5, 40e5) * scale, r.uniform(0.15, 0.5)
        shape = rise(begin, begin + ramp) * (1.0 - rise(end - 0.25, end))
        kind = r.integers(4)
        if kind == 1:
            shape *= 1.0 + 0.15 * np.sin(2.0 * np.pi * r.uniform(0.3, 1.2) * (TIME - begin))
        if kind == 2:
            shape *= 1.0 + 0.3 * rise(begin + 1.2, begin + 1.5) * r.choice([-1, 1])
        if kind == 3:
            shape *= 1.0 - 0.35 * rise(begin + 0.5, begin + 2.5)
        pressure += level * shape
    return pressure


def clean(car: Plant, r: np.random.Generator, kinds: list[str]) -> Scene:
    """Return three stops without a fault of a sensor, with oddities of road, pads and motor."""
    s = Scene(car, V0, pedal(r), name=" + ".join(kinds) or "nothing odd")
    s.pads, s.road, s.grade = np.ones((TIME.size, 2)), np.ones((TIME.size, 2)), np.zeros(TIME.size)
    times = r.uniform(3.6, 5.2), r.uniform(9.1, 10.4)
    torque = car.vehicle.weight * car.vehicle.front.rolling_radius
    for kind in kinds:
        match kind:
            case "padstep" | "padalike":
                for t in times:
                    steps = r.uniform(-0.25, 0.25, 2 if kind == "padstep" else 1)
                    s.pads *= 1.0 + steps * rise(t, t + r.choice([0.02, 0.3]))[:, None]
            case "fade":
                s.pads *= 1.0 - 0.3 * rise(3.0, 6.0)[:, None]
            case "wet":
                s.pads *= 0.55 + 0.45 * rise(3.2, 5.5)[:, None]
            case "slope":
                s.grade += (
                    r.choice([-1, 1]) * r.uniform(0.03, 0.09) * rise(times[0], times[0] + 0.3)
                )
                s.grade -= r.choice([-1, 1]) * 0.05 * rise(times[1], times[1] + 0.2)
            case "slope0":
                s.grade += r.uniform(-0.08, 0.08)
            case "road":
                for t in times:
                    steps = np.array([r.uniform(-0.35, 0.2), r.uniform(-0.5, 0.0)])
                    s.road *= 1.0 + steps * rise(t, t + 0.1)[:, None]
            case "gear":
                s.motor, s.logged = np.zeros((TIME.size, 2)), False
                shape = 1.0 - rise(times[0], times[0] + 0.15) + rise(times[0] + 0.5, times[0] + 0.6)
                s.motor[:, r.integers(2)] -= torque * r.uniform(0.01, 0.05) * shape
            case "regen":
                s.motor, s.logged = np.zeros((TIME.size, 2)), True
                for begin, end in ((2.9, times[0]), (8.3, times[1]), (12.8, 14.5)):
                    shape = rise(begin, begin + r.uniform(0.1, 0.4))
                    shape *= 1.0 - rise(end, end + r.uniform(0.1, 0.5))
                    s.motor[:, r.integers(2)] -= torque * r.uniform(0.05, 0.18) * shape
            case "bump":
                hits = sum(np.abs(TIME - t) < 0.045 for t in times)
                s.road *= 1.0 - r.uniform(0.2, 0.5) * hits[:, None]
    return s


def scenes(car: Plant, r: np.random.Generator) -> Iterator[tuple[str, Scene]]:
    """Return the drives of a car without a fault of its sensors, each with its kind."""
    for kinds in ([], *([x] for x in ODDITIES)):
        yield "clean", clean(car, r, kinds)
    for _ in range(4):
        yield "clean, two oddities", clean(car, r, list(r.choice(ODDITIES, 2, replace=False)))
    for name, kind, how, grip, scale in (
        ("pattern, 3 Hz", PATTERN, (0.1, r.uniform(2.5, 4), r.uniform(0.3, 0.5), False), 1.0, 1.2),
        ("pattern, 7 Hz", PATTERN, (0.1, r.uniform(5, 9), r.uniform(0.3, 0.6), False), 1.0, 1.2),
        ("pattern, rear alone", PATTERN, (0.1, 4.0, 0.5, True), 1.0, 1.2),
        ("slip, low grip", SLIP, (0.12, 0.0, 0.0, False), 0.3, 1.2),
        ("slip, less grip", SLIP, (0.07, 0.0, 0.0, False), 0.5, 1.8),
        ("slip, dry", SLIP, (0.13, 0.0, 0.0, False), 0.9, 3.0),
    ):
        begin, pressure = float(r.choice([4.0, 0.0])), pedal(r, scale)
        s = Scene(car, V0, pressure, name=name, abs_kind=kind, abs_how=how, abs_from=begin)
        s.road = np.ones((TIME.size, 2)) * [1.0, grip]
        yield "ABS", s


def faulty(log: Log, r: np.random.Generator) -> Iterator[tuple[str, str, Log, float, float]]:
    """Return a log with sensors that fail: kind, group, log, begin and end of the fault [s]."""
    t = log.time

    def with_channels(begin: float, end: float, **new: Array) -> tuple[Log, float, float]:
        return replace(log, channels=log.channels | new), begin, end

    for size in (-3, -2, -1, -0.5, -0.3, 0.3, 0.5, 1, 2, 3):
        begin = r.uniform(3.8, 5.0)
        end = float(r.choice([begin + 0.8, 6.2, 99.0]))
        a_x = log["a_x"] + size * ((t > begin) & (t < end))
        kind = "a_x steps by 0.3" if abs(size) < 0.4 else "a_x steps by 0.5 or more"
        yield kind, f"{abs(size)} m/s^2", *with_channels(begin, end, a_x=a_x)
    for size, lasts in ((r.choice([-1, 1]), 99.0), (3, 2.5)):
        begin = r.uniform(1.0, 2.5)
        a_x = log["a_x"] + size * ((t > begin) & (t < begin + lasts))
        yield (
            "a_x steps while it rolls",
            f"{lasts} s",
            *with_channels(begin, begin + lasts, a_x=a_x),
        )
    motors = {f"T_drive_{x}": log.channels.get(f"T_drive_{x}", 0.0 * t) for x in "fr"}
    for size in (-18, -10, -5, -3, -1, -0.5, 0.5, 1, 3, 5, 10, 18):
        begin = r.choice([r.uniform(0.3, 2.2), r.uniform(2.4, 3.0), r.uniform(3.4, 5.0)])
        end = begin + r.choice([0.1, 0.3, 0.7, 1.0])
        front = motors["T_drive_f"] + 1e3 * size * ((t > begin) & (t < end))
        fault = with_channels(begin, end, **motors | {"T_drive_f": front})
        yield "T_drive spikes", f"{abs(size)} kN m", *fault
    for factor in FACTORS:
        begin = r.choice([-1.0, r.uniform(3.8, 5.0)])
        names = [f"omega_{wheel}" for wheel in WHEELS]
        wheels = {name: log[name] * np.where(t > begin, factor, 1.0) for name in names}
        yield "wheels in another unit", f"x {factor:.2f}", *with_channels(begin, 99.0, **wheels)


def drives(cars: list[Plant], seed: int) -> list[Drive]:
    """Return all drives of all cars."""
    r = np.random.default_rng(seed)
    drawn_scenes = [(i, kind, s) for i, car in enumerate(cars) for kind, s in scenes(car, r)]
    logs = run([s for _, _, s in drawn_scenes], seed + 1)
    out = list[Drive]()
    for (car, kind, s), log in zip(drawn_scenes, logs, strict=True):
        begin = s.abs_from if kind == "ABS" else 0.0
        out.append(Drive(kind, s.name, car, log, begin))
        if kind == "ABS":
            flag = replace(log, channels=log.channels | {"abs_active": log.truth["abs"]})
            out.append(Drive("ABS, with the flag", s.name, car, flag, begin))
        if s.name in ("nothing odd", "regen"):
            out += [Drive(a, b, car, *rest) for a, b, *rest in faulty(log, r)]
    return out


def smoothed(x: Array, time: float, step: float) -> Array:
    """Return a signal (n,) behind a lag of first order with a ``time`` constant [s]."""
    share = 1.0 - np.exp(-step / time)
    return lfilter([share], [1.0, share - 1.0], x, zi=[x[0] * (1.0 - share)])[0]


def frictions(drive: Drive, car: Plant) -> Iterator[Array]:
    """Return the true friction of front and of rear pads (n,), by p_mc behind the line's lags."""
    log, dt = drive.log, drive.log.sample_time
    line = smoothed(smoothed(np.maximum(log["p_mc"], 0.0), 0.02, dt), 0.15, dt) + 1e4
    for x, axle in (("f", car.vehicle.front), ("r", car.vehicle.rear)):
        yield smoothed(log.truth[f"true_Tb_{x}"], 0.15, dt) / axle.torque_gain / line


def is_out(answer: Bounded, true: Array) -> Mask:
    """Return where the truth is outside the bounds by more than `MARGIN` (n,)."""
    low, high = answer.lower * (1.0 - MARGIN), answer.upper * (1.0 + MARGIN)
    return (true < low) | (true > high)


def score(drive: Drive, car: Plant, table: Table, clean: Clean | None) -> tuple[Array, Clean]:
    """Count samples: braked, wrong, VALID, IMPLAUSIBLE; afterwards braked, wrong, VALID without the
    fault, and VALID with it. ``clean``: the drive without the fault, None if there is none."""
    log, answer = drive.log, online(table, car.vehicle, drive.log)
    front, rear = frictions(drive, car)
    valid, implausible = answer.valid, answer.step.reason == Reason.IMPLAUSIBLE
    wrong = valid & (is_out(answer.pads_f, front) | is_out(answer.pads_r, rear))
    without = clean or Clean(np.zeros_like(valid), valid)
    by_fault, usual = wrong & ~without.wrong[: wrong.size], without.valid[: wrong.size]
    braked, late = log["p_mc"] > BRAKED, 0.0 if drive.kind.startswith("clean") else LATE
    during = braked & (log.time > drive.begin + late)
    if drive.kind.startswith("ABS"):
        during &= log.truth["abs"] > 0.0
    next_stop = min((begin for begin, _ in STOPS if begin > drive.end), default=np.inf)
    after = braked & (log.time > min(drive.end + AGAIN, next_stop))
    masks = (
        *(during, during & by_fault, during & valid, during & implausible),
        *(after, after & by_fault, after & usual, after & usual & valid),
    )
    return np.array([x.sum() for x in masks]), Clean(wrong, valid)


def main() -> None:
    """Run the study."""
    options = arguments(__doc__, "groups", first=300, cars=6, kind=())
    cars = [drawn(options.first + i) for i in range(options.cars)]
    ramp = 5.5e5 * np.maximum(np.arange(0.0, 9.5, 1e-3) - 1.5, 0.0)
    logs = run([Scene(car, 33.0, ramp, name="ramp") for car in cars], options.first)
    tables = [calib.fit(car.vehicle, [log]) for car, log in zip(cars, logs, strict=True)]
    counts, base = defaultdict[str, Array](lambda: np.zeros(8)), None
    for drive in drives(cars, options.first):
        words = " ".join(options.kind)
        is_base = drive.group in ("nothing odd", "regen")
        if words not in f"{drive.kind} {drive.group}" and not is_base:
            continue
        faults = not drive.kind.startswith(("clean", "ABS"))
        i = drive.car
        row, answered = score(drive, cars[i], tables[i], base if faults else None)
        base = answered if is_base else base
        for name in (drive.kind, *([f"{drive.kind}: {drive.group}"] * options.groups)):
            counts[name] += row
    print("| drives | braked samples | wrong | VALID | IMPLAUSIBLE | afterwards wrong | VALID |")
    print("|---|---|---|---|---|---|---|")
    for name, (braked, *during, after, late, usual, again) in sorted(counts.items()):
        shares = [f"{100 * x / max(braked, 1):.2f} %" for x in during]
        for part, whole in ((late, after), (again, usual)):
            shares.append(f"{100 * part / whole:.2f} %" if whole else "")
        print(f"| {name} | {braked:.0f} | {' | '.join(shares)} |")


if __name__ == "__main__":
    main()
