"""The figures of `calib/manual/theory.md`, and the constants on `calib/manual/step.md`.

    python -m tests.support.theory

Run it after a change of the law, of the fit, of the step or of `tests/studies/results/coverage.md`,
look at the pictures, and commit both. Tyres, stops and truth are of the plant of the tests.
"""

import inspect
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from io import BytesIO
from itertools import zip_longest
from pathlib import Path

import numpy as np
from PIL import Image

from calib.car.balance import front_share
from calib.car.forces import axle_loads, speed_ratio
from calib.car.tyre import MagicFormula
from calib.car.vehicle_file import read_vehicle
from calib.estimation.baselines import METHODS, gain, gradient
from calib.estimation.constants import Constants
from calib.estimation.constants import constants as step_constants
from calib.estimation.estimator import estimate
from calib.estimation.state import Sample
from calib.estimation.step import follow, started
from calib.fitting.fit import fit
from calib.logs.read import read_log
from calib.run.blocks import BLOCK
from calib.run.noise import SensorNoise
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet, render
from calib.show.style import BODY, DOTTED, ETA, FRONT, IDENTIFIED, LONG, NOMINAL, REAR, TRUTH
from calib.store.store import Store
from calib.table.maps import Reader
from tests.support.reference_car import CAR, REAL, WET, noisy, ramp, stop, without

ROOT = Path(__file__).parents[2]
STEP = ROOT / "calib" / "manual" / "step.md"
COVERAGE = ROOT / "tests" / "studies" / "results" / "coverage.md"
PICTURES = ROOT / "sample_logs" / "figures" / "theory"

LAW = {"color": "#CC79A7", "linestyle": LONG}

ROADS = {
    "dry asphalt": ((25.0, 0.9), BODY),
    "wet asphalt": ((20.0, 0.75), IDENTIFIED),
    "wet tile": ((17.5, 0.25), LAW),
}
"""Stiffness and peak [1] of the tyres on each road; of tile 0.7 and a quarter of dry asphalt."""
TILE = (ROADS["wet tile"][0][0] / 25.0, ROADS["wet tile"][0][1] / 0.9)
"""The same over those of the plant's dry asphalt."""
_STEP, _PRESSURE, _DT = -0.1, 20e5, 0.005
"""Change of the pads [1] to which the law answers, its pressure [Pa], time of a step [s]."""


def friction_used(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Friction [1] that the front and the rear axle of the car use at z, by (6) and (7)."""
    share, (front, rear) = front_share(CAR, 0.0), axle_loads(CAR, z)
    force = z * CAR.weight
    return share * force / front, (1.0 - share) * force / rear


def eta_over(z: np.ndarray, stiffness: float, peak: float) -> np.ndarray:
    """Eta - 1 [1] of the reference car with nominal pads; NaN within 5 % of a tyre's peak."""
    slip = np.linspace(0.0, 0.1, 4000)
    force = MagicFormula(stiffness, peak).force(slip)
    rising = slice(np.searchsorted(force, 0.95 * peak))
    slips = (np.interp(F, force[rising], slip[rising], right=np.nan) for F in friction_used(z))
    return speed_ratio(*slips) - 1.0


def forces() -> Sheet:
    """Force over load of both axles, and the eta that they make."""
    z = np.linspace(0.0, 0.7, 200)
    front, rear = friction_used(z)
    of_eta = [
        Line(z, 100.0 * eta_over(z, *tyre), look, name) for name, (tyre, look) in ROADS.items()
    ]
    twice = Line((0.0, 0.7), (0.3, 0.3), {**NOMINAL, "linestyle": DOTTED}, "0.3 % on dry: two z")
    return Sheet("theory", "forces", (
        Panel("F", "Force over load, (6) to (8)", "z [g]", "F_f, F_r [1]",
              [Line(z, front, FRONT, "front"), Line(z, rear, REAR, "rear"),
               Line(z, z, BODY, "z")]),
        Panel("eta", "What the wheels show of it, (22)", "z [g]", ETA, [*of_eta, twice],
              ylim=(0.0, 0.85), columns=2),
    ), (("F", "eta"),))  # fmt: skip


def law() -> Sheet:
    """The law (25) after a step of the pads: one gain and two, and the limit of its stability."""
    t, gains = np.arange(0.0, 2.0, _DT), (gain(CAR.front), gain(CAR.rear))

    def adapted(axle: str, gamma: float) -> np.ndarray:
        u = np.full_like(t, -getattr(CAR, axle).torque_gain * _PRESSURE)
        return 0.38 + gradient(_STEP * u, u, gamma, _DT)

    def errors(product: float) -> np.ndarray:
        """Error after each step (20,) where gamma u^2 dt is ``product``."""
        return (1.0 - product) ** np.arange(20)

    looks = {0.04: BODY, 1.5: IDENTIFIED, 1.95: {**LAW, "linestyle": LONG}, 2.1: REAR}
    return Sheet("theory", "law", (
        Panel("gains", "One gain, or one for each axle", "time [s]", "pad friction [1]", [
            Line(t, adapted("front", gains[0]), FRONT, "front"),
            Line(t, adapted("rear", gains[0]), REAR, "rear, gain of the front"),
            Line(t, adapted("rear", gains[1]), {**LAW, "linestyle": DOTTED}, "rear, its own gain"),
            Line(t, np.full_like(t, 0.38 + _STEP), TRUTH, "truth")], columns=2),
        Panel("limit", "Stable while \u03b3 u\u00b2 dt < 2", "step", "error over the first one [1]",
              [Line(np.arange(20.0), errors(x), look, f"{x:g}") for x, look in looks.items()],
              ylim=(-4.0, 4.0), columns=4),
    ), (("gains", "limit"),))  # fmt: skip


def roads() -> Sheet:
    """A stop on wet tile with wet pads, the table of a dry ramp: curves of the paper, and map."""
    table = fit(CAR, [without(noisy(ramp(REAL), 1), "v")])
    clean = stop(replace(WET, surface=lambda x: TILE), 16e5, duration=8.0)
    log = without(noisy(clean, 2), "v")
    e, used = estimate(table, log), np.flatnonzero(clean.time > 1.8)[::10]
    t, ecu, curve = clean.time[used], e.ecu.torque_r, table.difference
    by_law = METHODS["gradient_paper"](e)[1] * CAR.rear.torque_gain * e.signals.p_r
    law, value, low, high = (
        100.0 * x[used] / clean.truth["true_Tb_rl"][used]
        for x in (by_law, ecu.value, ecu.lower, ecu.upper)
    )
    z = np.linspace(0.0, 0.32, 100)
    on_tile = np.subtract(*friction_used(z))
    return Sheet("theory", "roads", (
        Panel("D", "The curve is that of one road", ETA, "D = F_f - F_r [1]", [
            Line(100.0 * (curve.eta - 1.0), curve.D, BODY, "table, dry asphalt",
                 (curve.lower, curve.upper)),
            Line(100.0 * eta_over(z, *ROADS["wet tile"][0]), on_tile, LAW, "wet tile")],
            xlim=(0.0, 0.8), columns=2),
        Panel("torque", "Rear torque on tile, wet pads", "time [s]", "over the true one [%]", [
            Line(t, law, LAW, "law on the curves"),
            Line(t, value, REAR, "map, 95 %", (low, high)),
            Line((t[0], t[-1]), (100.0, 100.0), TRUTH, "truth")]),
    ), (("D", "torque"),))  # fmt: skip


def coverage() -> Iterator[tuple[str, list[float], tuple[float, float]]]:
    """Of each quantity of an ECU its coverage at 50, 80 and 95 % [1], and limits of the last."""
    part = COVERAGE.read_text().partition("ecu, without v")[2].partition("\n\n")[0]
    for line in part.splitlines()[2:]:
        name, *_ = line.split()
        numbers = re.findall(r"\d\.\d\d", line)
        yield name, [float(x) for x in numbers[:3]], (float(numbers[3]), float(numbers[4]))


def covered() -> Sheet:
    """Coverage over the share that was said."""
    looks = {"level": BODY, "ratio": IDENTIFIED, "front": FRONT, "rear": REAR}
    dots = {"marker": "o", "ms": 3.5}
    stated_percent = np.array([50.0, 80.0, 95.0])
    lines = [
        Line(stated_percent, 100.0 * np.array(share), {**looks[name], **dots}, name)
        for name, share, _ in coverage() if name in looks
    ]  # fmt: skip
    right = Line((45.0, 100.0), (45.0, 100.0), TRUTH, "as stated")
    return Sheet("theory", "coverage", (
        Panel("covered", "ECU without v: how often the bounds held the truth",
              "stated [%]", "held [%]", [*lines, right], xlim=(45.0, 100.0), ylim=(45.0, 101.0)),
    ))  # fmt: skip


SHEETS = (forces, law, roads, covered)


def picture(sheet: Sheet) -> Image.Image:
    """The page of a sheet, in few colours."""
    figure = sheet.overview()
    figure.set_size_inches(*((7.0, 2.7) if len(sheet.panels) > 1 else (4.2, 3.0)))
    return Image.open(BytesIO(render(figure, ".png"))).convert("RGB").quantize(64)


_UNIT = re.compile(
    r"^    (\w+): float = (?!_follows)[^#\n]*(?:#(?:[^[\n]*\[([^]\n]+)\])?.*)?$", re.MULTILINE
)
_SHOWN = {"Pa": (1e-5, "bar"), "rad": (180.0 / math.pi, "deg")}


def constants() -> list[str]:
    """The lines of the appendix: name and value of each tuned number of the step, in two columns.

    The unit is that in the comment of the code, if there is one.
    """
    values = {one.name: one.default for one in fields(Constants)}
    cells = [f"block           {BLOCK:g} s"]
    for name, unit in re.findall(_UNIT, inspect.getsource(Constants)):
        factor, shown = _SHOWN.get(unit, (1.0, "" if unit == "1" else unit))
        cells.append(f"{name:<16}{factor * values[name]:.4g} {shown}".rstrip())
    half = -(-len(cells) // 2)
    return [
        f"{a:<40}{b}".rstrip() for a, b in zip_longest(cells[:half], cells[half:], fillvalue="")
    ]


def bounded(x: Sequence[float], form: str = ".3f") -> str:
    """A value with its lower and upper bound."""
    value, low, high = (format(one, form) for one in np.ravel(x))
    return f"{value} ({low} to {high})"


_READ = (0.3, 1.004)
"""Deceleration [g] and eta at which the example reads a table."""
_PLACE = 7.0
"""Time of the example in its stop [s]."""


def reading() -> list[str]:
    """The lines of the example that reads the table of the reference car."""
    z, eta = _READ
    table = Store(ROOT / "tables").load("sedan-2up@2").table
    p = table.paper
    f1, f2 = (
        bounded([np.interp(eta, p.eta, getattr(p, name + end)) for end in ("", "_lower", "_upper")])
        for name in ("f1", "f2")
    )
    ends = ("", "_lower", "_upper")
    look = Reader(table.map, [f"ratio{end}" for end in ends] + ["prior"])
    *ratio, prior = np.ravel(look(*np.array([z, (eta - 1.0) / z, 0.0])))
    level = Reader(table.level_map, [f"level{end}" for end in ends])(np.array(z))
    return [
        f"f1(eta), f2(eta)            {f1}, {f2}",
        f"level[z]                    {bounded(level)}",
        f"ratio[z, (eta - 1)/z, 0]    {bounded(ratio)}, as wide as {prior:.2f} of the prior",
    ]


def stopped() -> list[str]:
    """The lines of the example of a stop: Section IV of the paper, without v."""
    logs = ROOT / "sample_logs" / "simulation_study"
    car = read_vehicle(logs / "vehicle.toml")
    table = fit(car, [read_log(logs / "ramp_noisy.parquet")])
    log = read_log(logs / "stop_noisy.parquet")
    e = estimate(table, log)
    ecu, i = e.ecu, int(np.argmin(np.abs(log.time - _PLACE)))
    numbers = step_constants(table, SensorNoise(**table.noise), BLOCK)
    state = started(numbers)
    for row in zip(*(x.tolist() for x in ecu.inputs), strict=True):
        block_state = follow(numbers, state, Sample(*row))
        if block_state.braked > _PLACE - 5.0 - 1.5 * BLOCK:  # the brake is applied at 5 s
            break
    level, ratio = ecu.step.level[:, i], ecu.step.ratio[:, i]
    share = front_share(car, 0.0)
    n = 1.0 + share * (math.exp(ratio[0]) - 1.0)
    torque = (bounded([x[i] for x in getattr(ecu, f"torque_{axle}")], ".1f") for axle in "fr")
    pads = (bounded([x[i] for x in getattr(ecu, f"pads_{axle}")]) for axle in "fr")
    z = block_state.z
    return [
        f"means of y and xi/y         {z:.3f}, {block_state.eta_rise / z:.4f}",
        f"level, (S13)                {bounded(level)}",
        f"ratio, (S12)                {bounded(ratio)}",
        f"n, (S14)                    1 + {share:.4f} (exp({ratio[0]:.3f}) - 1) = {n:.4f}",
        f"pads, (S15)                 {', '.join(pads)}",
        f"p; C_f, C_r                 {e.signals.p_f[i] / 1e5:.1f} bar; "
        + ", ".join(f"{x.torque_gain:.4g} m^3" for x in (car.front, car.rear)),
        f"torque of a wheel [N m]     {', '.join(torque)}",
        "truth of the simulation     "
        + ", ".join(f"{log.truth[f'true_Tb_{x}'][i]:.1f}" for x in ("fl", "rl")),
    ]


BLOCKS = {"Constants": constants, "A table, read": reading, "A stop, step by step": stopped}
"""What makes the first block of text below each of these headings of the page on the step."""
_BLOCK = r"(\n## {}\n.*?\n```text\n)(.*?)(```\n)"


def block(heading: str) -> str:
    """The block below a heading as the page on the step has it."""
    (parts,) = re.findall(_BLOCK.format(heading), STEP.read_text(), re.DOTALL)
    return parts[1]


def main() -> None:
    """Make all of it anew."""
    PICTURES.mkdir(exist_ok=True)
    for make in SHEETS:
        picture(sheet := make()).save(PICTURES / f"{sheet.name}.png", optimize=True)
    page = STEP.read_text()
    for heading, lines in BLOCKS.items():
        text = "".join(f"{line}\n" for line in lines())
        page = re.sub(_BLOCK.format(heading), rf"\g<1>{text}\g<3>", page, flags=re.DOTALL)
    STEP.write_text(page)


if __name__ == "__main__":
    main()
