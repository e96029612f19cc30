"""Compute the half widths that a fit will have after some measures, before anybody drives them.

    prior --> a car --drive--> logs --noise--> fit --> half widths

This is a preposterior analysis by simulation (Chaloner and Verdinelli, Bayesian experimental
design: a review, Statistical Science 10, 1995): cars of the prior are driven with the noise of
their sensors, and fitted by `calib.fitting.fit`. Bumps and gear shifts are not counted.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import WHEELS, G
from calib.car.balance import force_per_pressure
from calib.car.beliefs import CAR
from calib.car.model import WET_ASPHALT, Model, default_model
from calib.car.vehicle import Vehicle
from calib.fitting.fit import fit
from calib.fitting.hypotheses import USUAL_PADS
from calib.logs.log import Log
from calib.model.roller_bench import TOLERANCE, AxleOnRollers, RollerBench
from calib.model.sensor_noise import LEVELS, NoiseLevel, add_noise
from calib.plan.achieved import HalfWidths, widths_of
from calib.plan.measure import RATE, Measure, Track, drive
from calib.run.resistance import identify
from calib.table.budget import axle_parts
from calib.table.table import Table, Value

_ROLLER_PRESSURES = (10e5, 20e5, 30e5, 40e5)  # [Pa], as `measures.csv` tells the workshop
_ROLLER_SCATTER = 0.005  # relative sigma of a force on the rollers [1]: half of `TOLERANCE`
_UNKNOWN_TYRES = 0.2  # sigma of ln of a slip stiffness [1], see `compliance` in beliefs.csv


@dataclass(frozen=True)
class Prior:
    """A car as it is known before the measures."""

    vehicle: Vehicle
    track: Track
    sensors: frozenset[str]  # optional channels that the car logs
    pad_level: Value  # ln of the level of the pads over that of the vehicle file [1]
    pad_ratio: Value  # ln of the pad ratio over that of the vehicle file [1]
    stiffness: Value  # ln of the slip stiffness [1]
    noise: Mapping[str, NoiseLevel]  # of each channel [SI]
    logs: tuple[Log, ...] = ()  # earlier logs, which the fit after the measures uses, too


def prior_of(
    vehicle: Vehicle,
    track: Track,
    sensors: frozenset[str] = frozenset(),
    table: Table | None = None,
    logs: Sequence[Log] = (),
) -> Prior:
    """Return the prior from ``logs``, else a ``table``, else the file. Raises as `fit` does."""
    if logs:
        table = fit(vehicle, list(logs))
        sensors = sensors | {name for log in logs for name in log.channels}
    if table is None:
        level = Value(0.0, USUAL_PADS)
        ratio = Value(CAR.log_pad_ratio.mean, CAR.log_pad_ratio.sigma)
        stiffness = Value(math.log(WET_ASPHALT.stiffness), _UNKNOWN_TYRES)
        return Prior(vehicle, track, sensors, level, ratio, stiffness, LEVELS)
    pads, noise = table.calibration, noise_of(table.noise)
    level, stiffness = _logarithm(pads.pad_scale), _logarithm(pads.slip_stiffness)
    return Prior(vehicle, track, sensors, level, pads.pad_log_ratio, stiffness, noise, tuple(logs))


def _logarithm(x: Value) -> Value:
    """Return ln x, with sigma by its derivative 1/x."""
    return Value(math.log(x.value), x.sigma / x.value)


def noise_of(densities: Mapping[str, float]) -> dict[str, NoiseLevel]:
    """Return white noise of the channels with the long-run noise ``densities`` of a table.

    A density [unit * s^0.5] is the sigma of a mean over 1 s, see `SensorNoise`, so the sigma of a
    sample is sqrt(`RATE`) times larger. The density "omega" is that of the mean of two wheels, so
    the density of one wheel is sqrt(2) times larger.
    """
    per_sample = math.sqrt(RATE)
    wheel = NoiseLevel(math.sqrt(2.0) * densities["omega"] * per_sample)
    channels = {f"omega_{w}": wheel for w in WHEELS}
    channels["a_x"] = NoiseLevel(G * densities["z"] * per_sample)
    speed = densities["v"] * per_sample  # 0 if no log has v
    return {**LEVELS, **channels, "v": NoiseLevel(speed) if speed else LEVELS["v"]}


_CORNERS = ((0.0, 0.0), (1.0, -1.0), (-1.0, 1.0))
"""Pad ratio and slip stiffness of the cars that stand for the prior, in sigma from the mean."""


def cars(prior: Prior, count: int = len(_CORNERS)) -> list[Model]:
    """Return the first ``count`` cars of `_CORNERS`, with the known effects of the vehicle.

    Drag and rolling resistance are those of `identify` without a coast.
    """
    nominal, scale = default_model(prior.vehicle), math.exp(prior.pad_level.value)
    effects = identify(prior.vehicle, ()).effects
    models = []
    for ratio_sigmas, stiffness_sigmas in _CORNERS[:count]:
        log_ratio = prior.pad_ratio.value + ratio_sigmas * prior.pad_ratio.sigma
        log_stiffness = prior.stiffness.value + stiffness_sigmas * prior.stiffness.sigma
        mu_f = scale * math.exp(0.5 * log_ratio) * nominal.pad_friction_f
        mu_r = scale / math.exp(0.5 * log_ratio) * nominal.pad_friction_r
        tyre = replace(nominal.tyre, stiffness=math.exp(log_stiffness))
        models.append(Model(nominal.vehicle, mu_f, mu_r, tyre, effects))
    return models


def half_widths(prior: Prior, car: Model, steps: Sequence[Measure], seed: int) -> HalfWidths:
    """Return the half widths of a fit of ``car`` after the measures, with noise by ``seed``.

    Raises ModelError for a run that cannot be driven, LogError for logs that make no table.
    """
    runs = [drive(car, step, prior.track, prior.sensors) for step in steps if step.driven]
    noisy = [add_noise(run, seed + i, prior.noise) for i, run in enumerate(runs)]
    kinds, pads = {step.kind for step in steps}, (car.pad_friction_f, car.pad_friction_r)
    mass = prior.vehicle.mass if "weighing" in kinds else None
    bench = on_rollers(prior.vehicle, pads, seed) if "rollers" in kinds else None
    return widths_of(fit(prior.vehicle, [*prior.logs, *noisy], mass=mass, bench=bench))


def on_rollers(vehicle: Vehicle, pads: tuple[float, float], seed: int) -> RollerBench:
    """Return the reading of a roller brake tester for a car with ``pads`` (front, rear) [1]."""
    random, pressures = np.random.default_rng([seed, 1]), np.array(_ROLLER_PRESSURES)
    nominal = (vehicle.front.pad_friction, vehicle.rear.pad_friction)
    axles = []
    for gain, mu, mu_n in zip(force_per_pressure(vehicle), pads, nominal, strict=True):
        scatter = 1.0 + _ROLLER_SCATTER * random.standard_normal(pressures.size)
        force = mu / mu_n * gain * pressures * scatter  # of the axle [N]
        axles.append(AxleOnRollers(_ROLLER_PRESSURES, tuple(force.tolist())))
    return RollerBench("rollers", "rollers", "", TOLERANCE, *axles)


def before_any_run(prior: Prior) -> HalfWidths:
    """Return the half widths by the prior of pads and mass alone."""
    level = {"pads": prior.pad_level.sigma**2, "mass": prior.vehicle.mass_tolerance**2}  # variances
    ratio = {"ratio": prior.pad_ratio.sigma**2}
    axles = axle_parts(prior.vehicle, prior.pad_ratio.value, level, ratio)
    front, rear = (Z95 * math.hypot(*parts.values()) for parts in axles)
    return HalfWidths(front, rear, Z95 * math.sqrt(sum(level.values())))
