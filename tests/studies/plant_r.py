"""A second plant, quasi-static, with five tyre forms: cars, ramp, coast and stops drawn at random.

It shares neither tyre nor load transfer nor noise with `calib` or with `tests.support.plant`: the
forces follow from pressure and speed, the slip from the inverse of a tabulated tyre curve, the
wheel speeds from the slip. Nothing swings or lags; the rolling resistance is that of the loads at
rest. A car's pads and tyres scatter about its file by 5 and 7 %, one sigma of an axle; mass and
centre of gravity by 0.5 %, its height by 2.5 %; the accelerometer has a scale, a zero and the pitch
of the body. All is SI.
"""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.digest import content_digest
from calib.car.mass import WEIGHED
from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from tests.studies.brakings import STEP, STOPS, WITHIN, BeyondPeakError, Braking, Demand, brakings

G, AIR = 9.80665, 1.2

FORMS = ("magic", "magic with E", "brush", "Burckhardt", "Dugoff")


@dataclass(frozen=True)
class Car:
    """The car as it is; ``vehicle`` is what the program is told.

    ``stiffness`` per slip and ``peak`` at the mean static load, the exponents with which both fall
    over load; ``pads`` friction on the ramp's day, front and rear; ``tyre_ratio`` stiffness rear
    over front; ``radius_load`` share by which a radius falls when its load doubles [1]; ``radius``
    true radii [m]; ``pitch`` [rad] per g.
    """

    vehicle: Vehicle
    form: str
    stiffness: float
    peak: float
    load_exponent: float
    peak_exponent: float
    pads: tuple[float, float]
    tyre_ratio: float
    radius_load: float
    mass: float
    cg_to_front_axle: float
    cg_height: float
    drag_area: float
    rolling_resistance: float
    radius: tuple[float, float]
    a_x_scale: float
    a_x_zero: float
    pitch: float


@dataclass(frozen=True)
class Stop:
    """One stop with its truth: the log, the road, and how the pads differ from the ramp's."""

    log: Log
    surface: str
    alike: bool


@dataclass(frozen=True)
class Case:
    """One car: what the program is told, its ramp, its stops, its coast; ``tyre`` names its
    form."""

    vehicle: Vehicle
    ramp: Log
    stops: tuple[Stop, ...]
    coast: Log | None
    tyre: str = ""


def curve(form: str, slip: Array, stiffness: float, peak: float) -> Array:
    """Force over load [1] at a slip (n,) [1]: Pacejka's formula without and with curvature, the
    brush with parabolic pressure, Burckhardt's and Dugoff's formulas."""
    x = stiffness * slip / peak
    if form == "magic":
        return peak * np.sin(1.65 * np.arctan(x / 1.65))
    if form == "magic with E":
        b = x / 1.45
        return peak * np.sin(1.45 * np.arctan(b + 0.6 * (b - np.arctan(b))))
    if form == "brush":
        return peak * (1.0 - (1.0 - np.minimum(x / 3.0, 1.0)) ** 3)
    if form == "Burckhardt":
        fall, rise = 0.35 * peak, 1.06 * peak
        return rise * (1.0 - np.exp(-(stiffness + fall) / rise * slip)) - fall * slip
    return peak * np.where(x < 0.5, x, 1.0 - 0.25 / np.maximum(x, 1e-9))


def slip_of(form: str, force: Array, stiffness: Array, peak: Array) -> Array:
    """Slip [1] on the rising branch at a force over load (n,) [1].

    Stiffness and peak (n,) scale one curve by similarity; Burckhardt's is only nearly similar.
    Raises BeyondPeakError.
    """
    slip = 0.4 * np.linspace(0.0, 1.0, 4001) ** 2
    k, mu = float(np.median(stiffness)), float(np.median(peak))
    carried = curve(form, slip, k, mu) / mu
    top = int(np.argmax(carried)) + 1
    if np.max(force / peak) > 0.995 * carried[top - 1]:
        raise BeyondPeakError(form)
    return np.interp(force / peak, carried[:top], k * slip[:top] / mu) * peak / stiffness


def drive(car: Car, name: str, run: Braking, rng: np.random.Generator) -> Log:
    """One run, until 1 m/s, as the sensors give it. Raises BeyondPeakError."""
    file, weight = car.vehicle, car.mass * G
    time = run.time
    to_cg = np.array([[car.cg_to_front_axle], [file.wheelbase - car.cg_to_front_axle]])
    radius = np.array(car.radius)[:, None]
    inertia = np.array([[2.0 * a.wheel_inertia] for a in (file.front, file.rear)])
    gain = np.array([[2.0 * a.torque_gain] for a in (file.front, file.rear)])
    friction = np.array([np.broadcast_to(mu, time.shape) for mu in run.pads])
    torque = gain * friction * run.pressure
    effective = car.mass + float(np.sum(inertia / radius**2))
    v = np.full(time.size, run.v0)
    for _ in range(6):
        resistance = car.rolling_resistance * weight + 0.5 * AIR * car.drag_area * v**2
        z = (np.sum(torque / radius, axis=0) + resistance) / (effective * G)
        slowed = z - z[0] if run.rolling else z
        lost = np.cumsum(0.5 * STEP * G * (slowed[1:] + slowed[:-1]))
        v = np.maximum(run.v0 - np.concatenate([[0.0], lost]), 0.3)
    at_rest = weight * to_cg[::-1] / file.wheelbase
    load = at_rest + weight * z * car.cg_height / file.wheelbase * np.array([[1.0], [-1.0]])
    force = torque / radius - inertia * G * slowed / radius**2 + car.rolling_resistance * at_rest
    ratio = car.tyre_ratio ** np.array([[-0.5], [0.5]])
    stiffness = car.stiffness * ratio * run.road[0] * (2.0 * load / weight) ** -car.load_exponent
    peak = car.peak * run.road[1] * (2.0 * load / weight) ** -car.peak_exponent
    moving = v > 1.0
    slip = np.array(
        [
            slip_of(car.form, f[moving], k[moving], mu[moving])
            for f, k, mu in zip(force / load, stiffness, peak, strict=True)
        ]
    )
    shown = radius * np.exp(-car.radius_load * (load / at_rest - 1.0))
    warmed = np.minimum(time / run.rolling, 1.0) if run.rolling else np.zeros(time.size)
    shown[1] *= 1.0 - run.drift * warmed
    omega = v[moving] * (1.0 - slip) / shown[:, moving]
    felt = car.a_x_zero - G * (car.a_x_scale * z + np.sin(car.pitch * z))
    channels = {
        "time": time[moving],
        "p_mc": run.pressure[moving] + rng.normal(0.0, 0.03e5, moving.sum()),
        "a_x": felt[moving] + noise(rng, 0.1, moving.sum()),
        "v": v[moving] + rng.normal(0.0, 0.02, moving.sum()),
    }
    truth = {}
    for i, axle in enumerate("fr"):
        truth[f"true_mu_pad_{axle}"] = friction[i, moving]
        for side in "lr":
            channels[f"omega_{axle}{side}"] = omega[i] + noise(rng, 0.05, omega[i].size)
            truth[f"true_Tb_{axle}{side}"] = 0.5 * torque[i, moving]
    digest = content_digest({"name": name}, {"channels": channels, "truth": truth})
    return Log(name=name, source="plant R", digest=digest, channels=channels, truth=truth)


def noise(rng: np.random.Generator, sd: float, count: int) -> Array:
    """White noise and 0.4 of it with a memory of 50 ms, (count,)."""
    from scipy.signal import lfilter

    keep = np.exp(-STEP / 0.05)
    shocks = rng.normal(0.0, 0.4 * sd * np.sqrt(1.0 - keep**2), count)
    return rng.normal(0.0, sd, count) + lfilter([1.0], [1.0, -keep], shocks)


def car(rng: np.random.Generator, scatter: float = 1.0) -> Car:
    """A car, and how it differs from its file, ``scatter`` times as much as cars usually do.

    The file says that it was weighed and that no motor brakes.
    """
    size, wheelbase = rng.uniform(0.85, 1.2), rng.uniform(2.55, 2.95)
    front, height = wheelbase * rng.uniform(0.40, 0.47), rng.uniform(0.52, 0.66)
    areas = 28.84e-4 * rng.uniform(0.95, 1.1), 11.34e-4 * rng.uniform(0.9, 1.15)
    radius, mu = 0.322 * size**0.3, rng.uniform(0.36, 0.44)
    file = Vehicle(
        name="drawn",
        mass=1744.0 * size,
        cg_to_front_axle=front,
        cg_to_rear_axle=wheelbase - front,
        cg_height=height,
        track_width=1.5,
        front=Axle(radius, 1.2, areas[0], 0.1309, 2, mu),
        rear=Axle(radius, 1.1, areas[1], 0.124, 2, mu),
        mass_tolerance=WEIGHED,
        motor_odds=0.0,
    )

    def about(value: float, sigma: float) -> float:
        return float(value * np.exp(rng.normal(0.0, sigma * scatter)))

    return Car(
        vehicle=file,
        form=str(rng.choice(FORMS)),
        stiffness=rng.uniform(18.0, 32.0),
        peak=rng.uniform(0.85, 1.1),
        load_exponent=scatter * rng.uniform(-0.15, 0.2),
        peak_exponent=rng.uniform(0.0, 0.1),
        pads=(about(mu, 0.05), about(mu, 0.05)),
        tyre_ratio=about(1.0, 0.07),
        radius_load=rng.uniform(0.0, 0.004),
        mass=about(file.mass, 0.005),
        cg_to_front_axle=about(front, 0.005),
        cg_height=about(height, 0.025),
        drag_area=rng.uniform(0.5, 0.8),
        rolling_resistance=rng.uniform(0.008, 0.014),
        radius=(about(radius, 0.002), about(radius, 0.002)),
        a_x_scale=1.0 + scatter * rng.normal(0.0, 0.007),
        a_x_zero=scatter * rng.normal(0.0, 0.05),
        pitch=rng.uniform(0.0, 0.012),
    )


def case(rng: np.random.Generator, scatter: float = 1.0, within: bool = False) -> Case:
    """A car with its ramp, its coast and its stops; a stop beyond the peak of its road is left out.

    ``scatter`` as `car` has it; ``within`` with the stops of `WITHIN`. Raises BeyondPeakError for
    the ramp.
    """
    one_car = car(rng, scatter)
    runs = brakings(Demand(one_car.vehicle, one_car.mass, one_car.pads, one_car.peak), rng)
    logs = {}
    for (name, run), noise_of_run in zip(runs.items(), rng.spawn(len(runs)), strict=True):
        if within or name not in WITHIN:
            with suppress(BeyondPeakError):
                logs[name] = drive(one_car, name, run, noise_of_run)
    if "ramp" not in logs:
        raise BeyondPeakError("ramp")
    stops = [Stop(log, name, runs[name].alike) for name, log in logs.items() if name in STOPS]
    return Case(one_car.vehicle, logs["ramp"], tuple(stops), logs["coast"], one_car.form)


def drawn(seed: int, number: int, scatter: float = 1.0, within: bool = False) -> Case:
    """Car ``number`` as `case` has it, the same for any count; another one is drawn for a car whose
    ramp is beyond the peak."""
    rng = np.random.default_rng([seed, number])
    while True:
        with suppress(BeyondPeakError):
            return case(rng, scatter, within)
