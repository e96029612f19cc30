"""Draw a case in which something is hidden.

    case = draw("single", 7)
    case.calibration, case.holdout, case.vehicle     what the program may see

The same seed gives the same case. Nothing in names, order or metadata tells what is hidden.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from calib.model.sensor_noise import NoiseLevel, add_noise
from tests.support.hidden.hydraulics import lines
from tests.support.hidden.manoeuvres import manoeuvre
from tests.support.hidden.plant import Car, Start, drive
from tests.support.hidden.settings import Hidden
from tests.support.hidden.severities import CATALOGUE, OUTSIDE, SEVERITIES, hide
from tests.support.hidden.variety import Ground, Variety, unlike, varied
from tests.support.plant import Tyre, brush, burckhardt, dugoff, magic
from tests.support.shared import shared

KINDS = ("single", "double", "none", "outside", "triple", "varied", "unlike")
"""``varied``: nothing hidden, other numbers of logs, rates, noise. ``unlike``: one effect, and each
log with pads and tyres of its own, on a slope of its own in half of them."""

# As the shared logs measure: the accelerometer rides on the body, a part of its noise is slow.
NOISE = {
    "a_x": NoiseLevel(0.060, 0.47, 0.005),
    "v": NoiseLevel(0.02, 0.0, 0.001),
    "p_mc": NoiseLevel(0.15e5, 0.0, 0.1e5, 0.0),
    **{f"omega_{w}": NoiseLevel(0.0208, 0.25, 0.005) for w in ("fl", "fr", "rl", "rr")},
    **{f"T_disc_{s}": NoiseLevel(1.0, 0.0, 1.0) for s in "fr"},
}


def _car(name: str, values: str) -> Vehicle:
    """A car from a row: kg; l_f, l_r, h, track m; R m; mu; inertia, piston cm^2, disc mm, twice."""
    mass, l_f, l_r, h, track, radius, mu, *axles = map(float, values.split())
    front, rear = (
        Axle(radius, inertia, area * 1e-4, disc * 1e-3, 2, mu)
        for inertia, area, disc in (axles[:3], axles[3:])
    )
    return Vehicle(name, mass, l_f, l_r, h, track, front, rear)


CARS = (
    _car("hatch-b", "1245 1.0200 1.5400 0.540 1.55 0.301 0.40 0.95 22.90 112.0 0.85 7.10 108.0"),
    _car("sedan-2up", "1744 1.1556 1.6494 0.615 1.55 0.322 0.38 1.20 28.84 130.9 1.10 11.34 124.0"),
    _car("suv-d", "2180 1.3800 1.5200 0.710 1.64 0.362 0.39 1.90 45.20 142.0 1.80 14.50 142.0"),
)

SURFACES = {"dry_asphalt": (26.2, 1.08), "wet_asphalt": (25.5, 0.86)}
"""Stiffness per slip and peak, both over the load [1]."""


@dataclass(frozen=True)
class HiddenCase:
    """One case.

    Attributes
    ----------
    kind, effects : what is hidden; `KINDS`, names.
    vehicle : what the program is told.
    calibration, holdout : noisy logs.
    hidden : all settings of the plant.
    """

    kind: str
    effects: tuple[str, ...]
    vehicle: Vehicle
    calibration: tuple[Log, ...]
    holdout: tuple[Log, ...]
    hidden: Hidden


@shared
def draw(
    kind: str,
    seed: int,
    names: tuple[str, ...] = (),
    severity: int | None = None,
    only: tuple[str, ...] = (),
    unlike_tyres: bool = False,
) -> HiddenCase:
    """Draw a case; ``names`` and ``severity`` (0 to 2) are drawn unless given.

    Successive seeds go round the names. With ``only`` these of its runs are driven, and are the
    same as without. With ``unlike_tyres`` each axle has a tyre of its own, by Burckhardt, Dugoff or
    as a brush. Raises ValueError for an unknown kind, KeyError for an unknown name.
    """
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    effects = names or choose(kind, seed, rng)
    hidden = Hidden()
    for name in effects:
        level = int(rng.integers(SEVERITIES)) if severity is None else severity
        hidden = hide(hidden, name, level, rng)
    vehicle = CARS[rng.integers(len(CARS))]
    surface = str(rng.choice(list(SURFACES)))
    front, rear = axle_tyres(surface, rng) if unlike_tyres else (tyre(surface, rng), None)
    car = Car(
        vehicle,
        front,
        (float(rng.uniform(0.85, 1.1)), float(rng.uniform(0.85, 1.1))),
        float(rng.uniform(0.85, 1.15)),
        hidden,
        rear,
    )
    variety = VARIETIES.get(kind, lambda _: Variety())(rng)
    levels = {k: scaled(level, variety.noise) for k, level in NOISE.items()}
    logs = {}
    for i, name in enumerate((*variety.calibration, *variety.holdout)):
        driven = run_of(on(car, variety.ground(i)), name, rng, variety.rate)
        noise = int(rng.integers(2**31))
        if only and name not in only:
            continue
        logs[name] = add_noise(driven(), noise, levels)
    return HiddenCase(
        kind,
        tuple(effects),
        vehicle,
        tuple(logs[n] for n in variety.calibration if n in logs),
        tuple(logs[n] for n in variety.holdout if n in logs),
        hidden,
    )


VARIETIES = {"varied": varied, "unlike": unlike}


def scaled(level: NoiseLevel, factor: float) -> NoiseLevel:
    """A sensor that is louder or quieter, with the same rounding."""
    return replace(level, sd=level.sd * factor)


def on(car: Car, ground: Ground) -> Car:
    """The car with other pads and tyres, on another slope."""
    front, rear = (a * b for a, b in zip(car.pad_scale, ground.pad_scale, strict=True))
    stiffness, h = car.stiffness_scale * ground.stiffness, car.hidden
    if ground.grade:
        h = replace(h, grade=h.grade + ground.grade, grade_felt=True)
    return replace(car, pad_scale=(front, rear), stiffness_scale=stiffness, hidden=h)


def choose(kind: str, seed: int, rng: np.random.Generator) -> tuple[str, ...]:
    """Names for a kind. Pairs leave out what is nearly a pad level even alone."""
    catalogue, outside = list(CATALOGUE), list(OUTSIDE)
    if kind == "single":
        return (catalogue[seed % len(catalogue)],)
    if kind == "unlike":
        names = [n for n in catalogue if n not in ("road_grade", "accelerometer_bias")]
        return (names[seed % len(names)],)
    if kind == "outside":
        return (outside[seed % len(outside)],)
    if kind in ("double", "triple"):
        plain = [n for n in catalogue if n not in ("mass_error", "wheel_inertia")]
        count = 2 if kind == "double" else 3
        return tuple(str(n) for n in rng.choice(plain, count, replace=False))
    return ()


def tyre(surface: str, rng: np.random.Generator) -> Tyre:
    """The surface's tyre, its form drawn: a Magic Formula with its E term, or a brush."""
    stiffness, peak = SURFACES[surface]
    stiffness *= float(rng.uniform(0.97, 1.03))
    peak *= float(rng.uniform(0.97, 1.03))
    load = float(rng.uniform(0.0, 0.05))
    if rng.random() < 0.2:
        return brush(stiffness, peak * 1.25, load)
    return magic(stiffness, peak, curvature=float(rng.uniform(-0.3, 0.2)), load_exponent=load)


def axle_tyres(surface: str, rng: np.random.Generator) -> tuple[Tyre, Tyre]:
    """Front and rear tyre of one surface: of another form, stiffness (8 %) and peak (5 %) each."""
    drawn = []
    for _ in "fr":
        stiffness, peak = SURFACES[surface]
        stiffness *= float(np.exp(0.08 * rng.normal()))
        peak *= float(rng.uniform(0.95, 1.05))
        load = float(rng.uniform(0.0, 0.05))
        form, more = ((brush, 1.25), (burckhardt, 1.1), (dugoff, 1.25))[int(rng.integers(3))]
        drawn.append(form(stiffness, more * peak, load))
    return drawn[0], drawn[1]


def run(car: Car, name: str, rng: np.random.Generator, rate: float = 200.0) -> Log:
    """One run without noise. Wheels start anywhere in their turn."""
    return run_of(car, name, rng, rate)()


def run_of(car: Car, name: str, rng: np.random.Generator, rate: float) -> Callable[[], Log]:
    """What drives a run that is drawn."""
    m = manoeuvre(name.partition(":")[0], car.vehicle, rng)
    start = Start(m.v0, m.temperature, float(rng.uniform(0.0, 2.0 * np.pi)))
    rtol = 5e-6 if car.hidden.thickness else 1e-6  # a ripple costs steps; both lie below the noise

    def driven() -> Log:
        channels = drive(car, lines(car.hidden, m.pressure), start, rate, rtol=rtol)
        return Log(name=name, source=f"{name}.csv", digest="", channels=channels)

    return driven
