"""Ramps and coast logs among the logs of a fit, and which of them will do."""

from calib.checks.check import problems_for
from calib.checks.gates import bitten, eta_rise, refuse_twice, require_same_wheels
from calib.errors import LogError
from calib.logs.log import Log
from calib.physics.forces import front_biased_up_to
from calib.physics.vehicle import Vehicle
from calib.signals.axle_signals import signals
from calib.signals.blocks import Blocks, blocks
from calib.signals.driving_record import brake_events, driving_record
from calib.signals.noise import SensorNoise, sensor_noise

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
        problems = problems_for(log, "diagnose" if coasting else "fit")
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
            _require_front_bias(vehicle, log, b)
        (coasts if coasting else ramps).append((log, b, sensor_noise(log, b)))
    if not ramps:
        raise LogError(
            "none of the logs holds a braking",
            where=", ".join(log.source for log in logs),
            expected="at least one ramp: 1 s unbraked, then pressure rising over 5 s or more",
        )
    return ramps, coasts


def _require_front_bias(vehicle: Vehicle, log: Log, b: Blocks) -> None:
    """Refuse a ramp on which eta falls where a front-biased car makes it rise."""
    biased = (b.z > 0.1) & (b.z < 0.8 * front_biased_up_to(vehicle))
    rise, error = eta_rise(b, biased & (b.end > bitten(b)))
    if rise < -4.0 * error:
        raise LogError(
            f"the front wheels slip less than the rear while braking: eta {100 * rise:+.2f} %",
            where=log.source,
            expected=f"a rise: {vehicle.name} is front-biased there",
            do="are the axles swapped? put them right in a channel map",
        )
