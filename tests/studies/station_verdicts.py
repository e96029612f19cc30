"""What the station says of good cars and of cars with a known fault, by its default limits.

    python tests/studies/station_verdicts.py [--models 20] [--cars 6] [--seed 1] [--jobs 2]

Models of car, tyre and track are drawn as in `ensemble`; the cars of a model scatter as new cars of
one line do (see `scattered`). Each drives a ramp, a coast and three stops with the pads of the
ramp, and is judged with a golden table of its model. Prints how often a good car fails or warns and
on what, and for each fault how often it is failed, and by the check that is meant to see it.
"""

import argparse
import math
import sys
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.car.vehicle import Vehicle
from calib.estimation.limits import FAILED, PASSED, WARNING
from calib.line.station.identity import Identity
from calib.line.station.limits_file import ADVICE
from calib.line.station.metrics import Car
from calib.line.station.station import outcome, table_of, validated
from calib.logs.log import Log
from calib.model.sensor_noise import LEVELS, NoiseLevel, add_noise
from calib.table.table import Table
from tests.studies.ensemble import car, tyre
from tests.studies.naming import wilson
from tests.support.plant import Plant, Pressure, as_log, drive, per_pascal

LIMITS = tuple(row.limit for row in ADVICE)
STOPS = ("hold", "hard", "wave")
REFUSED = "refused"


@dataclass(frozen=True)
class Model:
    """A model of car with the track of its line."""

    vehicle: Vehicle
    plant: Plant
    levels: dict[str, NoiseLevel]
    bar_per_second: float
    speed: float


@dataclass(frozen=True)
class Build:
    """One car: what it really is, relative to its model.

    ``pads`` front and rear, ``left`` of a wheel's brake over the right one's; ``radius`` of the
    axles; ``mass``; ``stiffness`` of the track that day; ``fading`` of the pads within a stop
    [1/s]; ``late`` pads of the last stop; ``loud`` noise of the wheel speeds; ``reach`` of the
    ramp [g].
    """

    pads: tuple[float, float] = (1.0, 1.0)
    left: tuple[float, float] = (1.0, 1.0)
    radius: tuple[float, float] = (1.0, 1.0)
    mass: float = 1.0
    stiffness: float = 1.0
    fading: float = 0.0
    late: tuple[float, float] = (1.0, 1.0)
    loud: float = 1.0
    reach: float = 0.58


def scattered(rng: np.random.Generator) -> Build:
    """A good car: pads of one grade, new tyres, a driver, the track of the day; one sigma each."""
    alike, ratio = rng.normal(0.0, 0.03), rng.normal(0.0, 0.03)
    return Build(
        pads=(math.exp(alike + 0.5 * ratio), math.exp(alike - 0.5 * ratio)),
        left=tuple(np.exp(rng.normal(0.0, 0.02, 2)).tolist()),
        radius=tuple((1.0 + rng.normal(0.0, 0.001, 2)).tolist()),
        mass=1.0 + float(rng.normal(0.0, 0.01)),
        stiffness=1.0 + float(rng.normal(0.0, 0.03)),
    )


def scaled(name: str, front: float, rear: float) -> Callable[[Build], Build]:
    """A change of a car: the pair ``name`` with each part multiplied."""

    def change(build: Build) -> Build:
        pair = getattr(build, name)
        return replace(build, **{name: (pair[0] * front, pair[1] * rear)})

    return change


FAULTS: dict[str, tuple[Callable[[Build], Build], tuple[str, ...]]] = {
    # what is wrong with it, and the checks that are meant to see it
    "pads 30 % weak, both axles": (scaled("pads", 0.7, 0.7), ("pad_scale",)),
    "rear pads 35 % weak": (scaled("pads", 1.0, 0.65), ("pad_ratio", "golden_distance")),
    "front pads 30 % weak": (
        scaled("pads", 0.7, 1.0),
        ("pad_ratio", "golden_distance", "front_biased_up_to"),
    ),
    "front left brake 35 % weak": (scaled("left", 0.65, 1.0), ("side_difference_f",)),
    "rear left brake 50 % weak": (scaled("left", 1.0, 0.5), ("side_difference_r",)),
    "rear tyres 2 % too small": (scaled("radius", 1.0, 0.98), ("ramp_eta_zero", "eta_zero")),
    "pads fade 8 % a second in stops": (
        lambda b: replace(b, fading=-0.08),
        ("pad_friction_drift_f", "pad_friction_drift_r"),
    ),
    "pads 35 % weak in the last stop": (
        lambda b: replace(b, late=(0.65, 0.65)),
        ("repeatability_f", "repeatability_r"),
    ),
    "wheel speeds ten times as loud": (
        lambda b: replace(b, loud=10.0),
        ("band_width", "interval_f", "interval_r", "measured_share", "valid_share"),
    ),
    "ramp ends at 0.28 g": (lambda b: replace(b, reach=0.28), ()),
}


def model(rng: np.random.Generator) -> Model:
    """A model, its track, its sensors and its ramp."""
    vehicle = car(rng)
    plant = Plant(
        vehicle=vehicle,
        tyre=tyre(rng),
        drag_area=float(rng.uniform(0.55, 0.8)),
        rolling_resistance=float(rng.uniform(0.008, 0.014)),
        pitch_frequency=float(rng.uniform(1.1, 1.6)),
        pitch_damping=float(rng.uniform(0.25, 0.4)),
    )
    loud = float(rng.uniform(0.6, 1.5))
    levels = {k: replace(v, sd=v.sd * loud) for k, v in LEVELS.items()}
    return Model(
        vehicle, plant, levels, float(rng.uniform(4.0, 7.0)), float(rng.uniform(30.0, 34.0))
    )


def run(
    of: Model, build: Build, name: str, pressure: Pressure, v0: float, seed: int, **more: float
) -> Log:
    """One run of a car, as its sensors give it; what each wheel's brake gets is not logged."""
    nominal = of.vehicle.front.pad_friction, of.vehicle.rear.pad_friction
    late = build.late if name == STOPS[-1] else (1.0, 1.0)
    fading = build.fading if name in STOPS else 0.0

    def pads(t: float) -> tuple[float, float]:
        now = math.exp(fading * max(t - 1.5, 0.0))
        f, r = (n * p * k * now for n, p, k in zip(nominal, build.pads, late, strict=True))
        return f, r

    plant = replace(
        of.plant,
        pads=pads,
        radius_scale=build.radius,
        mass_scale=build.mass,
        surface=lambda x: (build.stiffness, 1.0),
    )
    wheels = {}
    for axle, weak in zip("fr", build.left, strict=True):
        root = math.sqrt(weak)
        for side, part in (("l", root), ("r", 1.0 / root)):
            share = 2.0 * part / (root + 1.0 / root)  # the axle as a whole stays as it is
            if build.left != (1.0, 1.0):
                wheels[axle + side] = lambda t, share=share: share * pressure(t)
    log = as_log(drive(plant, pressure, v0, wheel_pressure=wheels, **more), name)
    seen = {k: v for k, v in log.channels.items() if k[:3] not in ("p_f", "p_r")}
    levels = {
        k: replace(v, sd=v.sd * build.loud) if k.startswith("omega") else v
        for k, v in of.levels.items()
    }
    return add_noise(replace(log, channels=seen, truth={}), seed, levels)


def ramp_and_coast(of: Model, build: Build, seed: int) -> tuple[Log, Log]:
    """What the table is fitted on."""
    slope = of.bar_per_second * 1e5
    top = round(20.0 * (build.reach / per_pascal(of.vehicle) / slope + 1.5)) / 20.0
    pressure = lambda t: slope * max(t - 1.5, 0.0)  # noqa: E731
    ramp = run(of, build, "ramp", pressure, of.speed, seed, duration=top, stop_speed=8.0)
    return ramp, run(of, build, "coast", lambda t: 0.0, of.speed, seed + 1, duration=15.0)


def stops(of: Model, build: Build, seed: int) -> list[Log]:
    """Three stops with the pads of the ramp."""
    bar = 1.0 / per_pascal(of.vehicle)

    def at(z: float, t: float) -> float:
        return bar * z * min(max((t - 1.5) / 0.25, 0.0), 1.0)

    shapes: dict[str, Pressure] = {
        "hold": lambda t: at(0.3, t),
        "hard": lambda t: at(0.45, t),
        "wave": lambda t: at(0.3 + 0.06 * math.sin(2.5 * (t - 1.5)), t),
    }
    more = {"duration": 11.0, "stop_speed": 1.5}
    return [
        run(of, build, name, shape, 27.0, seed + 2 + k, **more)
        for k, (name, shape) in enumerate(shapes.items())
    ]


@dataclass(frozen=True)
class Told:
    """What the station said of one car: its verdict, what failed or warned, all that was judged."""

    kind: str
    verdict: str
    failed: frozenset[str] = frozenset()
    warned: frozenset[str] = frozenset()
    said: str = ""
    figures: dict[str, list[float]] = field(default_factory=dict)


def judged(of: Model, build: Build, golden: Table, kind: str, seed: int) -> Told:
    """Run a car through the station; a log that it refuses is an answer too."""
    try:
        ramp, coast = ramp_and_coast(of, build, seed)
        holdouts = stops(of, build, seed)
        table = table_of(of.vehicle, [ramp], [coast], Identity())
        results = [validated(table, log, LIMITS) for log in holdouts]
    except BrakeCalError as error:
        return Told(kind, REFUSED, said=str(error))
    found = outcome(
        Car(table, [ramp], holdouts, results, golden), [coast], LIMITS, Identity(), "golden"
    )
    names = {
        word: frozenset(check.figure for check in found.with_verdict(word))
        for word in (FAILED, WARNING)
    }
    figures: dict[str, list[float]] = {}
    for check in found.checks:
        if check.judgement.value is not None:
            figures.setdefault(check.figure, []).append(check.judgement.value)
    return Told(kind, found.verdict, names[FAILED], names[WARNING], "", figures)


def line(job: tuple[int, int, int, int]) -> list[Told]:
    """All cars of one model: good ones, then some with each fault."""
    seed, number, good, faulty = job
    rng = np.random.default_rng([seed, number])
    of = model(rng)
    first = 10_000 * number + 1_000_000 * seed
    golden = table_of(
        of.vehicle, *([log] for log in ramp_and_coast(of, Build(), first)), Identity()
    )
    kinds = ["good"] * good + [name for name in FAULTS for _ in range(faulty)]
    out = []
    for k, kind in enumerate(kinds, start=1):
        build = scattered(rng)
        if kind in FAULTS:
            build = FAULTS[kind][0](build)
        out.append(judged(of, build, golden, kind, first + 10 * k))
    return out


def percent(hits: int, n: int) -> str:
    """A share with its 95 % limits."""
    low, high = wilson(hits, n)
    return f"{100 * hits / n:5.1f} % ({100 * low:.0f}-{100 * high:.0f}, n {n})"


def report(cars: list[Told]) -> None:
    """Print the tables."""
    good = [c for c in cars if c.kind == "good"]
    print("good cars")
    for verdict in (PASSED, WARNING, FAILED, REFUSED):
        print(f"  {verdict:<10} {percent(sum(c.verdict == verdict for c in good), len(good))}")
    for word, of in (("fails", [c.failed for c in good]), ("warns", [c.warned for c in good])):
        counted = Counter(name for names in of for name in names)
        said = ", ".join(f"{name} {n}" for name, n in counted.most_common())
        print(f"  what {word}: {said or 'nothing'}")
    print(f"\n{'figure of good cars':<22} {'0.5 %':>8} {'median':>8} {'99.5 %':>8}   warn, fail")
    for row in ADVICE:
        held = row.limit
        values = [v for c in good for v in c.figures.get(held.figure, [])]
        if values:
            low, middle, high = np.percentile(values, [0.5, 50, 99.5])
            ends = f"{held.warn_low} to {held.warn_high}, {held.low} to {held.high}"
            print(f"{held.figure:<22} {low:8.3f} {middle:8.3f} {high:8.3f}   {ends}")
    print(f"\n{'fault':<34} {'not passed on':<28} {'by the check meant for it':<28}")
    for kind, (_, meant) in FAULTS.items():
        part = [c for c in cars if c.kind == kind]
        if part:
            stopped = sum(c.verdict in (FAILED, REFUSED) for c in part)
            by = sum(bool(c.failed & set(meant)) for c in part)
            shown = percent(by, len(part)) if meant else "refused before"
            print(f"{kind:<34} {percent(stopped, len(part)):<28} {shown}")
    for said, n in Counter(f"{c.kind}: {c.said}" for c in cars if c.said).most_common(5):
        print(f"refused {n}: {said}")


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--models", type=int, default=20)
    parser.add_argument("--cars", type=int, default=6, help="good cars of each model")
    parser.add_argument("--faulty", type=int, default=1, help="cars of each model and fault")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    asked = parser.parse_args()
    jobs = [(asked.seed, i, asked.cars, asked.faulty) for i in range(asked.models)]
    with ProcessPoolExecutor(asked.jobs) as pool:
        cars = [told for told_of in pool.map(line, jobs) for told in told_of]
    print(f"{asked.models} models, seed {asked.seed}")
    report(cars)


if __name__ == "__main__":
    main()
