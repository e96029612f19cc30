"""Other ways to the pad friction, shown beside the estimate: the paper's, and what it argues with.

`nominal` trusts the file. `mean_gain` puts all of the deceleration into one common factor.
`gradient_*` is the paper's law (23)-(28) and `rls_*` recursive least squares, each on the three
look-ups of the table. A law that is unstable on a run is left out, with a note; no baseline stops
an estimate.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.estimation import adaptive
from calib.estimation.lookup import LOOKUPS, LookupReading, smoothed
from calib.estimation.pad_level import PadLevel
from calib.estimation.priors import Priors
from calib.physics.vehicle import Axle, Vehicle
from calib.signals.axle_signals import Signals
from calib.signals.brake_balance import BrakeBalance
from calib.table.table import Table

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Pair = tuple[Array, Array]


class Baselines(NamedTuple):
    """Pad friction (front, rear) [1] by method name, and where the tyre look-up covers the run.

    ``notes`` name the methods that are left out, and say why.
    """

    pads: dict[str, Pair]
    covered: Mask
    notes: tuple[str, ...]


def baselines(
    table: Table,
    car: Vehicle,
    s: Signals,
    b: BrakeBalance,
    eta: Array,
    level: PadLevel,
    priors: Priors,
    *,
    laws: bool = True,
) -> Baselines:
    """All methods on one run; ``eta`` is zeroed (22) [1], ``car`` has the nominal pads.

    Without ``laws`` only those that need no look-up.
    """
    pads: dict[str, Pair] = {
        "nominal": (
            np.full_like(eta, car.front.pad_friction),
            np.full_like(eta, car.rear.pad_friction),
        ),
        "mean_gain": (car.front.pad_friction * level.value, car.rear.pad_friction * level.value),
    }
    covered = np.ones(eta.size, bool)
    left_out: dict[str, list[str]] = {}
    for name in LOOKUPS if laws else ("tyre",):
        reading = read(table, car, s, b, eta, name, priors)
        for law in ("gradient", "rls") if laws else ():
            try:
                pads[f"{law}_{name}"] = adapt(car, s, b, reading, law, priors)
            except InputError as error:
                left_out.setdefault(error.what, []).append(f"{law}_{name}")
        if name == "tyre":
            covered = reading.inside
    notes = tuple(f"{', '.join(names)} left out: {why}" for why, names in left_out.items())
    return Baselines(pads, covered, notes)


def read(
    table: Table,
    car: Vehicle,
    s: Signals,
    b: BrakeBalance,
    eta: Array,
    name: str,
    priors: Priors,
) -> LookupReading:
    """Normalised forces by one look-up from filtered z and eta."""
    z, smooth = smoothed(s, s.z, priors), smoothed(s, eta, priors)
    return LOOKUPS[name](table, z, smooth, z - b.balance.body / car.weight)


def adapt(
    car: Vehicle, s: Signals, b: BrakeBalance, reading: LookupReading, law: str, priors: Priors
) -> Pair:
    """Pad friction of both axles by an adaptive law, "gradient" or "rls".

    Raises InputError if the gradient law is unstable: too high a pressure for the rate of the log.
    """
    road = b.balance

    def adapted(axle: Axle, force: Array, load: Array, moment: Array, pressure: Array) -> Array:
        """mu_n + zeta of one axle [1]; the inertia is already in the moment at the road."""
        half_load = 0.5 * smoothed(s, load, priors)
        half_moment = 0.5 * moment * axle.rolling_radius
        spin = np.zeros_like(force)
        y = adaptive.measured_output(axle, force, half_load, spin, pressure, half_moment)
        u = np.where(b.active, adaptive.regressor(axle, pressure), 0.0)
        if law == "rls":
            zeta = adaptive.least_squares(y, u, priors.rls_memory, s.sample_time)
        else:
            gamma = adaptive.gain(axle, priors.law_rate, priors.law_pressure)
            zeta = adaptive.gradient(y, u, gamma, s.sample_time)
        return axle.pad_friction + zeta

    return (
        adapted(car.front, reading.F_f, road.load_f, road.moment_f, s.p_f),
        adapted(car.rear, reading.F_r, road.load_r, road.moment_r, s.p_r),
    )
