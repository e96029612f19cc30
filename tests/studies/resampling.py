"""The same stop sampled otherwise: what turns over though nothing has happened.

    python tests/studies/resampling.py [--rates 20] [--jitters 3] [--seed 38] [--hidden] [--jobs 2]

Each log at so many rates from 80 to 500 Hz, with its first or its last sample cut off, and with a
tenth of its noise added. Ramps are fitted; stops are validated with a table of the logs as they
are. A sample log is what its sensors gave: a smooth part is interpolated, and the noise that is
left is dealt out again sample by sample, so that no rate has less noise than another. The stops of
the plant are computed at each rate, with the noise of that rate.

Printed per log: verdicts, names of warnings and refusals by number, the range of the valid share
[%], and of the pad friction front and rear; then the jumps: neighbours (of rates; the log as it is
and the log spoiled a little) whose verdict or names differ, or whose valid share differs by more
than 5 points. With ``--hidden`` the hold-outs of the hidden cases, too.
"""

import sys
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.signal import savgol_filter

sys.path.insert(0, str(Path(__file__).parents[2]))

import calib
from calib.base.errors import BrakeCalError
from calib.car.mass import WEIGHED
from calib.car.vehicle import Vehicle
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.logs.log import Log
from calib.model.sensor_noise import LEVELS, add_noise
from calib.table.table import Table
from tests.studies.ensemble import car, tyre
from tests.studies.study import arguments, carried_out
from tests.support.plant import Plant, Pressure, as_log, drive, per_pascal
from tests.support.reference_car import without

SAMPLES = Path(__file__).parents[2] / "sample_logs"
LOWEST, HIGHEST = 80.0, 500.0
SMOOTH = 7
"""Samples of the parabola that parts a sample log into a smooth part and noise."""
FAR = 25
"""Samples within which the noise of a sample that is needed twice is drawn."""
JUMP = 0.05
"""Change of the valid share that is a jump."""

FOLDERS = {
    "sedan": ("vehicle", ("ramp_wet_asphalt", "coast"), (
        "dry_asphalt_stop", "basalt_wet_pads", "wet_tile_wet_pads", "transition_dry_to_basalt")),
    "simulation_study": ("vehicle", ("ramp_noisy",), ("stop_noisy",)),
    "third_party": ("vehicle", ("cal_ramp",), (
        "hold1_const_mu30", "hold2_steps_muf25_mur33", "hold3_const_fade35_22",
        "hold4_driver_mu28")),
}  # fmt: skip
"""Vehicle file, logs of the table, and stops of each folder."""
HIDDEN = ("case_0", "case_2", "case_3", "case_5", "case_7")
OF_HIDDEN = ("stop_a", "stop_b", "mixed", "hot_stop")


def pumped(t: float) -> float:
    """A foot that pumps at 1.2 Hz."""
    return min(t / 0.3, 1.0) * (1.0 + 0.25 * np.sin(2.0 * np.pi * 1.2 * t))


def waved(t: float) -> float:
    """A foot that is not quite calm."""
    return min(t / 0.3, 1.0) * (1.0 + 0.08 * np.sin(2.0 * np.pi * t))


PLANT_STOPS: dict[str, tuple[Callable[[float], float], float, float, bool]] = {
    "30 bar in 0.10 s": (lambda t: min(t / 0.10, 1.0), 0.02, 0.0, True),
    "30 bar in 0.15 s": (lambda t: min(t / 0.15, 1.0), 0.02, 0.0, True),
    "in 0.15 s, motor unsaid": (lambda t: min(t / 0.15, 1.0), 0.02, 0.0, False),
    "30 bar in 0.30 s": (lambda t: min(t / 0.30, 1.0), 0.02, 0.0, True),
    "pumped, brakes 0.02 s late": (pumped, 0.02, 0.0, True),
    "pumped, brakes 0.06 s late": (pumped, 0.06, 0.0, True),
    "waved, brakes 0.19 s late": (waved, 0.19, 0.0, True),
    "slow rise, brakes 0.19 s late": (lambda t: t / 4.0, 0.19, 0.0, True),
    "motor of 40 N m": (lambda t: min(t / 0.25, 1.0), 0.02, 40.0, False),
    "motor of 80 N m": (lambda t: min(t / 0.25, 1.0), 0.02, 80.0, False),
    "motor of 150 N m": (lambda t: min(t / 0.25, 1.0), 0.02, 150.0, False),
}
"""Pressure over that of 0.42 g by the time after the bite [s], lag of the brakes [s], torque of an
unlogged motor at each front wheel [N m], and whether the vehicle file says that there is none."""


BITE = 1.5
"""Time of rolling before the brake [s]."""


@dataclass(frozen=True)
class Answer:
    """What came out of one variant; ``share`` None where there is none."""

    verdict: str
    names: tuple[str, ...]
    share: float | None
    pads: tuple[float, float] | None

    def jumps_to(self, other: "Answer") -> list[str]:
        """What differs between neighbours."""
        shares = (self.share or 0.0, other.share or 0.0)
        differ = {
            "verdict": self.verdict != other.verdict,
            "names": self.names != other.names,
            "share": abs(shares[0] - shares[1]) > JUMP,
        }
        return [name for name, jumped in differ.items() if jumped]


@dataclass(frozen=True)
class Subject:
    """A log to be spoiled: ``source`` its folder, or "plant"; ``ramp`` one that is fitted."""

    source: str
    name: str
    ramp: bool = False


@cache
def sample(folder: str, name: str) -> Log:
    """A sample log."""
    (path,) = (SAMPLES / folder).rglob(f"{name}.[cp]*")
    return calib.read_log(path)


@cache
def vehicle_of(folder: str) -> Vehicle:
    """The vehicle of a folder of sample logs."""
    return calib.read_vehicle(SAMPLES / folder / "vehicle.toml")


@cache
def plant() -> Plant:
    """One car, whose tyres build up their force over 0.3 m."""
    rng = np.random.default_rng([38, 1])
    return Plant(
        vehicle=replace(car(rng), mass_tolerance=WEIGHED),
        tyre=tyre(rng),
        drag_area=0.65,
        rolling_resistance=0.011,
        radius_scale=(1.0, 1.0 + float(rng.normal(0.0, 0.001))),
        pitch_frequency=1.3,
        relaxation=0.3,
    )


def run(of: Plant, pressure: Pressure, v0: float, seed: int, **how: float) -> Log:
    """One run as its sensors give it, which are quiet ones."""
    levels = {name: replace(level, sd=0.7 * level.sd) for name, level in LEVELS.items()}
    log = add_noise(as_log(drive(of, pressure, v0, **how), f"run {seed}"), seed, levels)
    return replace(without(log, "T_drive_f", "T_drive_r"), truth={})


@cache
def table_of(source: str) -> Table:
    """The table of a folder as it is, or of the plant: a ramp to 0.58 g and a coast log."""
    if source.startswith("plant"):
        end = BITE + 0.58 / per_pascal(plant().vehicle) / 6e5
        how = {"duration": round(20.0 * end) / 20.0, "stop_speed": 8.0}
        ramp = run(plant(), lambda t: 6e5 * max(t - BITE, 0.0), 32.0, 1, **how)
        coast = run(plant(), lambda t: 0.0, 32.0, 2, duration=12.0)
        odds = 0.0 if source == "plant" else 0.1
        return calib.fit(replace(plant().vehicle, motor_odds=odds), [ramp, coast])
    names = FOLDERS[source][1] if source in FOLDERS else ("ramp", "coast", "coast_slow")
    return calib.fit(vehicle_of(source), [sample(source, name) for name in names])


def plant_stop(name: str, rate: float, seed: int) -> Log:
    """A stop of the plant at a rate [Hz]; a motor hands over to the brakes from 10 to 5 km/h."""
    shape, lag, torque, _ = PLANT_STOPS[name]
    top = 0.42 / per_pascal(plant().vehicle)
    pressure: Pressure = lambda t: top * shape(max(t - BITE, 0.0))  # noqa: E731

    def motor(t: float) -> tuple[float, float]:
        return -2.0 * torque * min(10.0 * pressure(t) / top, 1.0), 0.0

    of = replace(
        plant(),
        hydraulic_lag=lag,
        motor=motor if torque else None,
        motor_share=lambda v: min(max((v - 1.4) / 1.4, 0.0), 1.0),
    )
    return run(of, pressure, 27.0, seed, duration=11.0, stop_speed=1.5, rate=rate)


def parted(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A smooth part and the noise of a channel, (n,) each."""
    smooth = savgol_filter(x, SMOOTH, 2)
    return smooth, x - smooth


def resampled(log: Log, rate: float, seed: int) -> Log:
    """The log at another rate [Hz], with as much noise in each sample as it has."""
    rng = np.random.default_rng([seed, round(rate)])
    count = int((log.time[-1] - log.time[0]) * rate) + 1
    time = log.time[0] + np.arange(count) / rate
    after = np.clip(np.searchsorted(log.time, time), 1, log.time.size - 1)
    nearest = after - (time - log.time[after - 1] < log.time[after] - time)
    again = np.concatenate([[False], nearest[1:] == nearest[:-1]])
    drawn_at = nearest + rng.integers(-FAR, FAR + 1, count) * again
    drawn_at = np.clip(drawn_at, 0, log.time.size - 1)
    channels = {"time": time}
    for name, x in log.channels.items():
        if name != "time":
            smooth, noise = parted(x)
            channels[name] = np.interp(time, log.time, smooth) + noise[drawn_at]
    return replace(log, channels=channels, truth={})


def cut(log: Log, first: int, last: int) -> Log:
    """The log less some samples at its ends."""
    keep = slice(first, log.time.size - last)
    return replace(log, channels={k: x[keep] for k, x in log.channels.items()}, truth={})


def jittered(log: Log, seed: int) -> Log:
    """The log with a tenth of its noise added."""
    rng = np.random.default_rng(seed)
    noise = {name: float(np.std(parted(x)[1])) for name, x in log.channels.items()}
    channels = {
        name: x if name == "time" else x + 0.1 * noise[name] * rng.standard_normal(x.size)
        for name, x in log.channels.items()
    }
    return replace(log, channels=channels, truth={})


def answer(subject: Subject, log: Log) -> Answer:
    """What the program makes of a log."""
    try:
        if subject.ramp:
            others = [sample(subject.source, n) for n in FOLDERS[subject.source][1][1:]]
            table = calib.fit(vehicle_of(subject.source), [log, *others])
            scale, car = table.calibration.pad_scale.value, table.vehicle
            half = np.exp(0.5 * table.calibration.pad_log_ratio.value)
            pads = scale * car.front.pad_friction * half, scale * car.rear.pad_friction / half
            return Answer("fitted", _names(table.warnings), None, pads)
        result = validate_one(table_of(subject.source), log, None, DEFAULTS)
    except BrakeCalError as error:
        return Answer(f"refused ({type(error).__name__})", (), None, None)
    front, rear = (result.figures[f"pad_friction_{axle}"] for axle in "fr")
    pads = None if front is None or rear is None else (front, rear)
    names = _names(result.all_warnings)
    return Answer(result.word, names, result.figures["valid_share"], pads)


def _names(warnings: tuple) -> tuple[str, ...]:
    return tuple(sorted({warning.code for warning in warnings}))


@dataclass(frozen=True)
class Found:
    """Answers of one subject, at the rates in their order, and each spoiled way to spoil it."""

    subject: Subject
    as_is: Answer
    rates: tuple[Answer, ...]
    spoiled: tuple[Answer, ...]

    @property
    def jumps(self) -> Counter[str]:
        """Number of jumps by what jumped."""
        pairs = [*pairwise(self.rates), *((self.as_is, one) for one in self.spoiled)]
        return Counter(what for a, b in pairs for what in a.jumps_to(b))

    def told(self) -> str:
        """One line."""
        all_of = [self.as_is, *self.rates, *self.spoiled]
        shares = [100.0 * a.share for a in all_of if a.share is not None]
        pads = np.array([a.pads for a in all_of if a.pads is not None])
        line = f"{self.subject.source}: {self.subject.name}"
        out = f"{line:45} {_counted(a.verdict for a in all_of):24}"
        out += f" valid {min(shares):3.0f} to {max(shares):3.0f}" if shares else 17 * " "
        if pads.size:
            (f0, r0), (f1, r1) = pads.min(axis=0), pads.max(axis=0)
            out += f"  pads {f0:.3f} to {f1:.3f}, {r0:.3f} to {r1:.3f}"
        jumps = ", ".join(f"{what} {count}" for what, count in sorted(self.jumps.items()))
        names = _counted(name for a in all_of for name in a.names)
        return f"{out}  jumps: {jumps or 'none'}" + (f"\n    {names}" if names else "")


def _counted(words: Iterable[str]) -> str:
    return ", ".join(f"{word} {count}" for word, count in Counter(words).most_common())


def tried(job: tuple[Subject, int, int, int]) -> Found:
    """One subject at so many rates, cut and jittered."""
    subject, rates, jitters, seed = job
    of_plant = subject.source.startswith("plant")
    if of_plant:
        log = plant_stop(subject.name, 200.0, seed)
    else:
        log = replace(sample(subject.source, subject.name), truth={})
    at = np.round(np.geomspace(LOWEST, HIGHEST, rates))
    make = plant_stop if of_plant else lambda name, rate, seed: resampled(log, rate, seed)
    spoiled = [cut(log, 1, 0), cut(log, 0, 1), *(jittered(log, seed + k) for k in range(jitters))]
    return Found(
        subject,
        answer(subject, log),
        tuple(answer(subject, make(subject.name, float(rate), seed)) for rate in at),
        tuple(answer(subject, one) for one in spoiled),
    )


def subjects(hidden: bool) -> list[Subject]:
    """All logs of the study."""
    told = {name: "plant" if odds_0 else "plant, motor unsaid" for name, (*_, odds_0) in
            PLANT_STOPS.items()}  # fmt: skip
    out = [Subject(source, name) for name, source in told.items()]
    out += [Subject(folder, name) for folder, (_, _, stops) in FOLDERS.items() for name in stops]
    out += [Subject(folder, logs[0], ramp=True) for folder, (_, logs, _) in FOLDERS.items()]
    if hidden:
        out += [Subject(f"hidden/{case}", name) for case in HIDDEN for name in OF_HIDDEN]
    return out


def main() -> None:
    """Run the study."""
    asked = arguments(__doc__, "hidden", rates=20, jitters=3, seed=38, jobs=1)
    jobs = [(one, asked.rates, asked.jitters, asked.seed) for one in subjects(asked.hidden)]
    total: Counter[str] = Counter()
    for found in carried_out(tried, jobs, asked.jobs):
        print(found.told(), flush=True)
        total += found.jumps
    neighbours = len(jobs) * (asked.rates - 1 + 2 + asked.jitters)
    shown = ", ".join(f"{what} {total[what]}" for what in ("verdict", "names", "share"))
    print(f"jumps in {neighbours} pairs of neighbours: {shown}")


if __name__ == "__main__":
    main()
