"""A third plant, with a body on springs: what the model has at once comes late here.

    pressure -> 30 ms -> pads, which lose friction with the heat of the stop -> wheels as states
    force -> load: a share by the links at once (anti-dive), the rest by the springs, at 1.3 Hz

The tyre is a Magic Formula whose stiffness and peak over the load fall with the load; the radius
falls with the load, too. Wheel speeds carry the road: the rear wheels meet what the front ones met,
both sides half alike. It shares no physics with `calib`, `plant_r` or `tests.support.plant`. Left
and right are alike; a tyre builds up its force at once. All is SI.
"""

import math
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.digest import content_digest
from calib.car.mass import WEIGHED
from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from tests.studies.brakings import STEP, STOPS, WITHIN, BeyondPeakError, Braking, Demand, brakings
from tests.studies.ensemble import Case, Stop

G, AIR = 9.80665, 1.2
FINE = 5
"""Steps of the integration in one of the log while the brakes act; one while they do not. The
wheels are integrated implicitly, so that the longer step is stable."""

LOST = 0.25
"""Slip [1] beyond which a wheel is about to lock."""


@dataclass(frozen=True)
class Tyre:
    """Magic Formula of one axle: slip ``stiffness`` and ``peak`` over the load at the mean static
    load [1], ``falling`` shares that they lose when it doubles, shape C and curvature E."""

    stiffness: float
    peak: float
    falling: tuple[float, float]
    shape: float
    curvature: float

    def force(self, slip: float, load: float, road: tuple[float, float]) -> float:
        """Over the load [1]; ``load`` over the mean static load [1], ``road`` factors on stiffness
        and peak."""
        more = load - 1.0
        k = self.stiffness * road[0] * math.exp(-self.falling[0] * more)
        mu = self.peak * road[1] * math.exp(-self.falling[1] * more)
        x = k / (self.shape * mu) * slip
        return mu * math.sin(self.shape * math.atan(x - self.curvature * (x - math.atan(x))))


@dataclass(frozen=True)
class Car:
    """The car as it is; ``vehicle`` is what the program is told.

    ``anti_dive`` share of the load transfer that the links take; ``frequency`` [Hz] and ``damping``
    of the rest; ``pitch`` [rad] per g of it; ``lag`` [s] of the brakes; ``fade`` share of the
    friction that a stop from 30 m/s costs, front and rear; ``radius_load`` as in `plant_r`.
    """

    vehicle: Vehicle
    tyres: tuple[Tyre, Tyre]
    pads: tuple[float, float]
    fade: tuple[float, float]
    lag: float
    mass: float
    cg_to_front_axle: float
    cg_height: float
    anti_dive: float
    frequency: float
    damping: float
    pitch: float
    drag_area: float
    rolling_resistance: float
    radius: tuple[float, float]
    radius_load: float
    a_x_scale: float
    a_x_zero: float


def driven(car: Car, run: Braking) -> dict[str, Array]:
    """One run without sensors, until 1 m/s, (n,) each: v [m/s]; ``z`` along the road and ``late``,
    what the springs carry of it [g]; omega [rad/s], torque of both wheels [N m] and pad friction of
    each axle. Raises BeyondPeakError."""
    file, weight, length = car.vehicle, car.mass * G, car.vehicle.wheelbase
    axles = (file.front, file.rear)
    rest = [
        weight * (length - car.cg_to_front_axle) / length,
        weight * car.cg_to_front_axle / length,
    ]
    shift = weight * car.cg_height / length
    roads = [np.broadcast_to(factor, run.pressure.shape).tolist() for factor in run.road]
    friction = [np.broadcast_to(mu, run.pressure.shape).tolist() for mu in run.pads]
    pressure = run.pressure.tolist()
    swing, damp = (2.0 * math.pi * car.frequency) ** 2, 4.0 * math.pi * car.frequency * car.damping
    free = car.rolling_resistance + 0.5 * AIR * car.drag_area * run.v0**2 / weight
    slope = free if run.rolling else 0.0
    v, z, late, rate, caliper = run.v0, free, free, 0.0, 0.0
    omega = [run.v0 / r for r in car.radius]
    heat = [0.0, 0.0]
    stop_heat = 0.5 * car.mass * 30.0**2
    rows = []
    for i, asked in enumerate(pressure):
        road = roads[0][i], roads[1][i]
        busy = asked > 0.0 or caliper > 1e3
        count = FINE if busy else 1
        h = STEP / count
        warmed = 1.0 - run.drift * min(i * STEP / run.rolling, 1.0) if run.rolling else 1.0
        radius_at_rest = car.radius[0], car.radius[1] * warmed
        for _ in range(count):
            caliper += (asked - caliper) * -math.expm1(-h / car.lag)
            moved = shift * (car.anti_dive * z + (1.0 - car.anti_dive) * late)
            loads = rest[0] + moved, rest[1] - moved
            total, mu, torque = 0.5 * AIR * car.drag_area * v**2, [0.0, 0.0], [0.0, 0.0]
            for k, axle in enumerate(axles):
                load = loads[k]
                radius = radius_at_rest[k] * (1.0 - car.radius_load * (load / rest[k] - 1.0))
                mu[k] = friction[k][i] * (1.0 - car.fade[k] * heat[k] / stop_heat)
                torque[k] = 2.0 * axle.torque_gain * mu[k] * caliper
                relative = 2.0 * load / weight
                slip = 1.0 - omega[k] * radius / v
                if slip > LOST:
                    raise BeyondPeakError(f"slip {slip:.2f}")
                force = load * car.tyres[k].force(slip, relative, road)
                ahead = load * car.tyres[k].force(slip + 1e-5, relative, road)
                stiff = (ahead - force) / 1e-5 * radius / v
                turning = radius * (force - car.rolling_resistance * load) - torque[k]
                step = h * turning / (2.0 * axle.wheel_inertia + h * radius * stiff)
                omega[k] += step
                total += force - stiff * step
                heat[k] += torque[k] * omega[k] * h
            z = total / weight
            rate += h * (swing * (z - late) - damp * rate)
            late += h * rate
            v -= h * G * (z - slope)
        if v < 1.0:
            break
        rows.append((v, z, late, *omega, *torque, *mu))
    names = ("v", "z", "late", "omega_f", "omega_r", "torque_f", "torque_r", "mu_f", "mu_r")
    return dict(zip(names, np.array(rows).T, strict=True))


def drive(car: Car, name: str, run: Braking, rng: np.random.Generator) -> Log:
    """One run as the sensors give it. Raises BeyondPeakError."""
    true = driven(car, run)
    v, count = true["v"], true["v"].size
    dip = car.pitch * true["late"]
    felt = -G * (true["z"] * np.cos(dip) + np.sin(dip))
    shaken = uneven(v, car.vehicle.wheelbase, rng)
    channels = {
        "time": STEP * np.arange(count),
        "p_mc": run.pressure[:count] + rng.normal(0.0, 0.1e5, count),
        "a_x": car.a_x_scale * felt + car.a_x_zero + rng.normal(0.0, 0.08, count)
        + 0.05 * shaken["fl"] + 0.05 * shaken["fr"],
        "v": v + rng.normal(0.0, 0.02, count),
    }  # fmt: skip
    truth = {}
    for axle in "fr":
        truth[f"true_mu_pad_{axle}"] = true[f"mu_{axle}"]
        for side in "lr":
            wheel = f"{axle}{side}"
            noise = 0.05 * shaken[wheel] + rng.normal(0.0, 0.03, count)
            channels[f"omega_{wheel}"] = true[f"omega_{axle}"] + noise
            truth[f"true_Tb_{wheel}"] = 0.5 * true[f"torque_{axle}"]
    digest = content_digest({"name": name}, {"channels": channels, "truth": truth})
    return Log(name=name, source="plant M", digest=digest, channels=channels, truth=truth)


def uneven(v: Array, wheelbase: float, rng: np.random.Generator) -> dict[str, Array]:
    """What the road adds to each wheel (n,), of variance 1 at 20 m/s and less below: a memory of
    1 m along the way, half of it alike on both sides, behind the same as in front.

    It makes eta uneven by 5e-4 over 50 ms and 1e-4 over 0.5 s; a log of a car on a road (comma2k19,
    Example_1, 17 m/s) has one and a half to three times as much.
    """
    from scipy.signal import lfilter

    gone = np.concatenate([[0.0], np.cumsum(v[1:] * STEP)]) + wheelbase
    along = np.arange(0.0, gone[-1] + 0.2, 0.1)
    keep = math.exp(-0.1)
    common, left, right = (
        lfilter([math.sqrt(1.0 - keep**2)], [1.0, -keep], rng.normal(0.0, 1.0, along.size))
        for _ in range(3)
    )
    size = np.minimum(v / 20.0, 1.0)
    out = {}
    for side, own in (("l", left), ("r", right)):
        track = math.sqrt(0.5) * (common + own)
        out[f"f{side}"] = size * np.interp(gone, along, track)
        out[f"r{side}"] = size * np.interp(gone - wheelbase, along, track)
    return out


def car(rng: np.random.Generator, scatter: float = 1.0) -> Car:
    """A car, and how it differs from its file, ``scatter`` times as much as cars usually do.

    The file says that it was weighed and that no motor brakes.
    """
    even = rng.uniform
    mass, wheelbase, radius = even(1150.0, 2250.0), even(2.5, 3.0), even(0.29, 0.35)
    front, height, mu = wheelbase * even(0.39, 0.47), even(0.5, 0.68), even(0.34, 0.44)
    share, per_bar = even(0.74, 0.82), mass * G * radius / 75e5
    areas = [
        per_bar * part / (4.0 * mu * disc) for part, disc in ((share, 0.13), (1 - share, 0.12))
    ]
    file = Vehicle(
        name="drawn",
        mass=mass,
        cg_to_front_axle=front,
        cg_to_rear_axle=wheelbase - front,
        cg_height=height,
        track_width=1.5,
        front=Axle(radius, even(0.9, 1.7), areas[0], 0.13, 2, mu),
        rear=Axle(radius, even(0.9, 1.7), areas[1], 0.12, 2, mu),
        mass_tolerance=WEIGHED,
        motor_odds=0.0,
    )

    def about(value: float, sigma: float) -> float:
        return float(value * np.exp(rng.normal(0.0, sigma * scatter)))

    stiffness, ratio, peak = even(18.0, 32.0), about(1.0, 0.07), even(0.85, 1.1)
    falling = scatter * even(-0.15, 0.25), even(0.0, 0.15)
    shape, curvature = even(1.4, 1.7), even(-1.0, 0.4)
    return Car(
        vehicle=file,
        tyres=tuple(
            Tyre(stiffness * ratio**half, peak, falling, shape, curvature) for half in (-0.5, 0.5)
        ),
        pads=(about(mu, 0.05), about(mu, 0.05)),
        fade=(even(0.0, 0.15), even(0.0, 0.15)),
        lag=0.03,
        mass=about(mass, 0.005),
        cg_to_front_axle=about(front, 0.005),
        cg_height=about(height, 0.025),
        anti_dive=even(0.1, 0.4),
        frequency=1.3,
        damping=0.3,
        pitch=math.radians(even(0.4, 1.2)),
        drag_area=even(0.5, 0.85),
        rolling_resistance=even(0.008, 0.014),
        radius=(about(radius, 0.002), about(radius, 0.002)),
        radius_load=even(0.0, 0.006),
        a_x_scale=1.0 + scatter * rng.normal(0.0, 0.007),
        a_x_zero=scatter * rng.normal(0.0, 0.05),
    )


def case(rng: np.random.Generator, scatter: float = 1.0, within: bool = False) -> Case:
    """A car with its ramp, its coast and its stops, as `plant_r.case`."""
    of = car(rng, scatter)
    runs = brakings(Demand(of.vehicle, of.mass, of.pads, of.tyres[0].peak), rng)
    logs = {}
    for (name, run), own in zip(runs.items(), rng.spawn(len(runs)), strict=True):
        if within or name not in WITHIN:
            with suppress(BeyondPeakError):
                logs[name] = drive(of, name, run, own)
    if "ramp" not in logs:
        raise BeyondPeakError("ramp")
    stops = [Stop(log, name, runs[name].alike) for name, log in logs.items() if name in STOPS]
    return Case(of.vehicle, logs["ramp"], tuple(stops), logs["coast"])
