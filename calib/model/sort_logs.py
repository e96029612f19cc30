"""Ramps and coast logs among the logs of a fit, and which of them will do."""

from calib.base.errors import LogError
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.axle_signals import signals
from calib.run.blocks import Blocks, blocks, braked_alone
from calib.run.check import problems_for
from calib.run.driving_record import brake_events, driving_record
from calib.run.gates import refuse_copies, require_right_slip, require_same_wheels
from calib.run.noise import SensorNoise, sensor_noise

Prepared = tuple[Log, Blocks, SensorNoise]


def sort_logs(vehicle: Vehicle, logs: list[Log]) -> tuple[list[Prepared], list[Prepared]]:
    """Ramps and coast logs, each with blocks and noise, in the order of their digests.

    The order of the command line must not change a bit of the table. Raises LogError for a log
    that will not do, that is not of this vehicle, or that is there twice.
    """
    refuse_copies(logs)
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
            require_right_slip(vehicle, log, b)
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
