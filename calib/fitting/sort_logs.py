"""Ramps and coast logs among the logs of a fit, and which of them will do."""

import numpy as np

from calib.checks.check import problems_for
from calib.checks.gates import bitten, eta_rise, refuse_twice, require_same_wheels
from calib.checks.swapped import what_to_check
from calib.errors import LogError
from calib.logs.log import Log
from calib.physics.forces import front_biased_up_to
from calib.physics.vehicle import Vehicle
from calib.signals.axle_signals import signals
from calib.signals.blocks import Blocks, blocks
from calib.signals.driving_record import brake_events, driving_record
from calib.signals.noise import SensorNoise, sensor_noise
from calib.signals.one_axle import braked_alone

Prepared = tuple[Log, Blocks, SensorNoise]


def sort_logs(vehicle: Vehicle, logs: list[Log]) -> tuple[list[Prepared], list[Prepared]]:
    """Ramps and coast logs, each with blocks and noise, in the order of their digests.

    The order of the command line must not change a bit of the table. Raises LogError for a log
    that will not do, that is not of this vehicle, or that is there twice.
    """
    refuse_twice(logs)
    ramps: list[Prepared] = []
    coasts: list[Prepared] = []
    for log in sorted(logs, key=lambda item: item.digest):
        s = signals(log, vehicle)
        coasting = not brake_events(driving_record(log))
        problems = problems_for(log, "coast" if coasting else "fit")
        if problems:
            raise LogError(
                f"this {'coast' if coasting else 'run'} will not do for a fit: "
                + "; ".join(problems),
                where=log.source,
                do="see `brake-cal check`",
            )
        require_same_wheels(vehicle, log, s)
        b = blocks(s)
        if not coasting:
            _require_axles(vehicle, log, b)
        (coasts if coasting else ramps).append((log, b, sensor_noise(log, b)))
    if not ramps:
        raise LogError(
            "none of the logs holds a braking",
            where=", ".join(log.source for log in logs),
            expected="at least one ramp: 1 s unbraked, then pressure rising over 3 to 8 s",
        )
    if all(braked_alone(b.p_f, b.p_r) for _, b, _ in ramps):
        raise LogError(
            "on every ramp one axle brakes alone, so there is no curve over eta",
            where=", ".join(log.source for log, _, _ in ramps),
            expected="at least one ramp with both axles; ramps with one axle serve in addition",
        )
    return ramps, coasts


_EXPECTED = {"f": (1.0, "rise", "front", "rear"), "r": (-1.0, "fall", "rear", "front")}
"""Sign and name of the change of eta, by the axle that slips more; that axle, and the other."""


def _require_axles(vehicle: Vehicle, log: Log, b: Blocks) -> None:
    """Refuse a ramp on which eta goes the wrong way: the axle that brakes more must slip more.

    That is the front axle of a front-biased car, or the one that brakes alone by its pressures.
    """
    alone = braked_alone(b.p_f, b.p_r)
    end = np.inf if alone else 0.8 * front_biased_up_to(vehicle)
    rise, error = eta_rise(b, (b.z > 0.1) & (b.z < end) & (b.end > bitten(b)))
    sign, way, more, less = _EXPECTED["r" if alone == "r" else "f"]
    if sign * rise < -4.0 * error:
        biased = f"{vehicle.name} is front-biased there"
        why = f"only the {more} brakes have pressure" if alone else biased
        raise LogError(
            f"the {more} wheels slip less than the {less} while braking: eta {100 * rise:+.2f} %",
            where=log.source,
            expected=f"a {way}: {why}",
            do=what_to_check(less)
            + ("; leave out wheel pressures that are not measured" if alone else ""),
        )
