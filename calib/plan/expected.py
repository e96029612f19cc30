"""The bounds that a fit will have after some measures, before anybody drives them.

    car --drive--> logs --noise--> fit --> half widths     of each car; their median is planned

Preposterior analysis by simulation (Chaloner and Verdinelli, Bayesian experimental design: a
review, Statistical Science 10, 1995): cars are drawn from the prior, driven with the noise of their
sensors, and fitted by `calib.fitting.fit` itself. Bumps and gear shifts are not counted.
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

_ROLLER_PRESSURES = (10e5, 20e5, 30e5, 40e5)
_ROLLER_SCATTER = 0.005  # relative, of the rows of a roller brake tester [1]: half its tolerance


@dataclass(frozen=True)
class Prior:
    """What is known of a car before the drive.

    ``pad_level`` ln of the pads over those of the ``vehicle`` file, ``pad_ratio`` ln of front over
    rear, ``stiffness`` ln of the slip stiffness, all [1]; ``noise`` of each channel in SI; ``logs``
    of the car that are there; ``sensors`` it has of the optional channels.
    """

    vehicle: Vehicle
    track: Track
    sensors: frozenset[str]
    pad_level: Value
    pad_ratio: Value
    stiffness: Value
    noise: Mapping[str, NoiseLevel]
    logs: tuple[Log, ...] = ()


def prior_of(
    vehicle: Vehicle,
    track: Track,
    sensors: frozenset[str] = frozenset(),
    table: Table | None = None,
    logs: Sequence[Log] = (),
) -> Prior:
    """What is known of a car: from its ``logs``, else from a ``table`` of it, else from its file.

    Raises as `calib.fitting.fit` for logs of which no table can be made.
    """
    if logs:
        table = fit(vehicle, list(logs))
        sensors = sensors | {name for log in logs for name in log.channels}
    if table is None:
        level = Value(0.0, USUAL_PADS)
        ratio = Value(CAR.log_pad_ratio.mean, CAR.log_pad_ratio.sigma)
        stiff = Value(math.log(WET_ASPHALT.stiffness), 0.2)
        return Prior(vehicle, track, sensors, level, ratio, stiff, LEVELS)
    pads, noise = table.calibration, noise_of(table.noise)
    level, stiff = _logarithm(pads.pad_scale), _logarithm(pads.slip_stiffness)
    return Prior(vehicle, track, sensors, level, pads.pad_log_ratio, stiff, noise, tuple(logs))


def _logarithm(value: Value) -> Value:
    return Value(math.log(value.value), value.sigma / value.value)


def noise_of(densities: Mapping[str, float]) -> dict[str, NoiseLevel]:
    """White noise of the channels with the long-run ``densities`` of a table, see `SensorNoise`.

    The mean of an axle has the noise of a wheel over sqrt(2).
    """
    per_sample = math.sqrt(RATE)
    wheel = NoiseLevel(math.sqrt(2.0) * densities["omega"] * per_sample)
    channels = {f"omega_{w}": wheel for w in WHEELS}
    channels["a_x"] = NoiseLevel(G * densities["z"] * per_sample)
    speed = densities["v"] * per_sample
    return {**LEVELS, **channels, "v": NoiseLevel(speed) if speed else LEVELS["v"]}


_POINTS = ((0.0, 0.0), (1.0, -1.0), (-1.0, 1.0))
"""Pads' ratio and tyre stiffness of the cars that stand for the prior [sigma]."""


def cars(prior: Prior, count: int = len(_POINTS)) -> list[Model]:
    """The first ``count`` of the cars that stand for the prior: the mean, then two corners.

    Each has the known effects of the vehicle, and its usual drag and rolling resistance.
    """
    mean, pads = default_model(prior.vehicle), math.exp(prior.pad_level.value)
    usual = identify(prior.vehicle, ()).effects
    models = []
    for ratio_at, stiffness_at in _POINTS[:count]:
        half = math.exp(0.5 * (prior.pad_ratio.value + ratio_at * prior.pad_ratio.sigma))
        stiffness = math.exp(prior.stiffness.value + stiffness_at * prior.stiffness.sigma)
        front, rear = pads * half * mean.pad_friction_f, pads / half * mean.pad_friction_r
        tyre = replace(mean.tyre, stiffness=stiffness)
        model = replace(mean, pad_friction_f=front, pad_friction_r=rear, tyre=tyre, effects=usual)
        models.append(model)
    return models


def half_widths(prior: Prior, car: Model, steps: Sequence[Measure], seed: int) -> HalfWidths:
    """Half widths of a fit of ``car`` after the measures, with noise by ``seed``.

    Raises ModelError for a run that cannot be driven, LogError where they make no table.
    """
    runs = [drive(car, run, prior.track, prior.sensors) for run in steps if run.driven]
    kinds, pads = {measure.kind for measure in steps}, (car.pad_friction_f, car.pad_friction_r)
    table = fit(
        prior.vehicle,
        [*prior.logs, *(add_noise(run, seed + i, prior.noise) for i, run in enumerate(runs))],
        mass=prior.vehicle.mass if "weighing" in kinds else None,
        bench=on_rollers(prior.vehicle, pads, seed) if "rollers" in kinds else None,
    )
    return widths_of(table)


def on_rollers(vehicle: Vehicle, pads: tuple[float, float], seed: int) -> RollerBench:
    """What a roller brake tester would read of a car with the friction of ``pads``, front, rear."""
    random = np.random.default_rng([seed, 1])
    axles = []
    for gain, pad, axle in zip(
        force_per_pressure(vehicle), pads, (vehicle.front, vehicle.rear), strict=True
    ):
        scatter = 1.0 + _ROLLER_SCATTER * random.standard_normal(len(_ROLLER_PRESSURES))
        force = pad / axle.pad_friction * gain * np.array(_ROLLER_PRESSURES) * scatter
        axles.append(AxleOnRollers(_ROLLER_PRESSURES, tuple(force.tolist())))
    return RollerBench("rollers", "rollers", "", TOLERANCE, *axles)


def before_any_run(prior: Prior) -> HalfWidths:
    """Half widths by what is known of the pads before any log, the mass included."""
    level = {"pads": prior.pad_level.sigma**2, "mass": prior.vehicle.mass_tolerance**2}
    ratio = {"ratio": prior.pad_ratio.sigma**2}
    axles = axle_parts(prior.vehicle, prior.pad_ratio.value, level, ratio)
    front, rear = (Z95 * math.hypot(*parts.values()) for parts in axles)
    return HalfWidths(front, rear, Z95 * math.sqrt(sum(level.values())))
