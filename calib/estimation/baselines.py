"""Other ways to the pad friction, shown beside the estimate: the paper's, and what it argues with.

    nominal               the pads of the file
    mean_gain             one factor for both axles by recursive least squares, the paper's [16]
    temperature           nominal pads that fade with a computed disc temperature, its [17]
    gradient_as_written   the paper's law (23)-(25) as it is written
    gradient_*, rls_*     that law and recursive least squares, on the three look-ups of the table,
                          with smoothed inputs, known resistance and a gain for each axle

A method that cannot be used on a run is left out, with a note; no baseline stops an estimate.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import InputError
from calib.car.effects.effects import Effects
from calib.car.vehicle import Axle, Vehicle
from calib.estimation import adaptive
from calib.estimation.as_written import as_written
from calib.estimation.lookup import LOOKUPS, LookupReading, smoothed
from calib.estimation.temperature import temperature
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.brake_response import BrakeBalance
from calib.table.table import Table

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Pair = tuple[Array, Array]


class _Baselines(NamedTuple):
    """Pad friction (front, rear) [1] by method name, and where the tyre look-up covers the run.

    ``notes`` name the methods that are left out, and say why.
    """

    pads: dict[str, Pair]
    covered: Mask
    notes: tuple[str, ...]


@dataclass(frozen=True)
class BaselineRun:
    """One run as the methods need it.

    ``car`` has the nominal pads; ``known`` its known effects, which are taken out of ``log``;
    ``s`` its signals, ``b`` their balance; ``eta`` zeroed (22) [1], (n,).
    """

    table: Table
    car: Vehicle
    known: Effects
    log: Log
    s: Signals
    b: BrakeBalance
    eta: Array


def baselines(run: BaselineRun, *, laws: bool = True) -> _Baselines:
    """All methods on one run. Without ``laws`` only the nominal pads."""
    car, s = run.car, run.s
    flat = np.ones_like(run.eta)
    pads = {"nominal": (car.front.pad_friction * flat, car.rear.pad_friction * flat)}
    tyre = read(run.table, car, s, run.b, run.eta, "tyre")
    left_out: dict[str, list[str]] = {}
    for name, method in _methods(run, tyre).items() if laws else ():
        try:
            pads[name] = method()
        except InputError as error:
            left_out.setdefault(error.what, []).append(name)
    notes = tuple(f"{', '.join(names)} left out: {why}" for why, names in left_out.items())
    return _Baselines(pads, tyre.inside, notes)


def _methods(run: BaselineRun, tyre: LookupReading) -> dict[str, Callable[[], Pair]]:
    """The methods beside nominal pads by name, ready to be run; ``tyre`` is that look-up read."""
    car, s, b = run.car, run.s, run.b
    methods: dict[str, Callable[[], Pair]] = {
        "mean_gain": partial(mean_gain, car, s, b),
        "temperature": partial(temperature, car, run.log, s, run.known),
        "gradient_as_written": partial(as_written, run.table, car, s, run.eta),
    }
    for name in LOOKUPS:
        known = tyre if name == "tyre" else read(run.table, car, s, b, run.eta, name)
        for law in ("gradient", "rls"):
            methods[f"{law}_{name}"] = partial(_adapt, car, s, b, known, law)
    return methods


def mean_gain(car: Vehicle, s: Signals, b: BrakeBalance) -> Pair:
    """Pad friction of both axles [1], (n,): nominal times one factor, the paper's [16].

    Recursive least squares with forgetting over `adaptive.LEVEL_MEMORY` of the brake force that the
    deceleration demands over that of nominal pads; 1 before the first braking. Of [16] the paper
    only says that its gain is found recursively, from wheel speed and pressure, and rests on the
    deceleration of the car alone. Here that is the accelerometer's, and known resistance is taken
    out. It cannot see a difference between the axles.
    """
    u = np.where(b.active, b.nominal_f + b.nominal_r, 0.0)
    more = adaptive.least_squares(b.balance.demanded - u, u, adaptive.LEVEL_MEMORY, s.sample_time)
    return car.front.pad_friction * (1.0 + more), car.rear.pad_friction * (1.0 + more)


def read(
    table: Table,
    car: Vehicle,
    s: Signals,
    b: BrakeBalance,
    eta: Array,
    name: str,
) -> LookupReading:
    """Normalised forces by one look-up from filtered z and eta."""
    z, smooth = smoothed(s, s.z), smoothed(s, eta)
    return LOOKUPS[name](table, z, smooth, z - b.balance.body / car.weight)


def _adapt(car: Vehicle, s: Signals, b: BrakeBalance, reading: LookupReading, law: str) -> Pair:
    """Pad friction of both axles by an adaptive law, "gradient" or "rls".

    Raises InputError if the gradient law is unstable: too high a pressure for the rate of the log.
    """
    road = b.balance

    def adapted(axle: Axle, force: Array, load: Array, moment: Array, pressure: Array) -> Array:
        """mu_n + zeta of one axle [1]; the inertia is already in the moment at the road."""
        half_load = 0.5 * smoothed(s, load)
        half_moment = 0.5 * moment * axle.rolling_radius
        spin = np.zeros_like(force)
        y = adaptive.measured_output(axle, force, half_load, spin, pressure, half_moment)
        u = np.where(b.active, adaptive.regressor(axle, pressure), 0.0)
        if law == "rls":
            zeta = adaptive.least_squares(y, u, adaptive.MEMORY, s.sample_time)
        else:
            gamma = adaptive.gain(axle)
            zeta = adaptive.gradient(y, u, gamma, s.sample_time)
        return axle.pad_friction + zeta

    return (
        adapted(car.front, reading.F_f, road.load_f, road.moment_f, s.p_f),
        adapted(car.rear, reading.F_r, road.load_r, road.moment_r, s.p_r),
    )
