"""What a fit says against its vehicle file and its logs."""

from collections.abc import Iterator, Sequence

from calib.base.warning import Measured, PlausibilityWarning, judged
from calib.car.plausible import plausible
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.resistance import ROLLING, Resistance
from calib.model.resistance import identify as identify_resistance
from calib.model.sensors import judge_accelerometer
from calib.model.sort_logs import Prepared
from calib.plausibility.run import of_bend, run_warnings
from calib.run.axle_signals import signals
from calib.run.brake_response import brake_balance, brake_response


def file_warnings(vehicle: Vehicle) -> tuple[PlausibilityWarning, ...]:
    """What no usual car has in its file; the pads are judged by what the fit says of them."""
    return tuple(w for w in plausible(vehicle) if not w.code.startswith("pad_friction"))


def log_warnings(
    vehicle: Vehicle, ramps: list[Prepared], coasts: list[Prepared], known: Resistance
) -> Iterator[PlausibilityWarning]:
    """Warnings on the logs of a fit, which need no fit.

    ``ramps``, ``coasts`` with the blocks as read; ``known`` the resistance that was identified,
    doubted where the vehicle file does not give it. A ramp is compared with that of the coasts
    alone, and with their straight course, where there are any.
    """
    effect, name = ROLLING
    if effect not in vehicle.effects:
        found = known.effects.parameters[effect][name]
        yield from judged(vehicle.name, [Measured("rolling_resistance", found)])
    coasted = [(b, noise.z) for _, b, noise in coasts]
    rolling = identify_resistance(vehicle, coasted) if coasts else known
    straight = [log for log, _, _ in coasts]
    for run in ramps:
        yield from _of_run(vehicle, run, known, rolling, straight)
    for run in coasts:
        yield from _of_run(vehicle, run, known, known, ())


def _of_run(
    vehicle: Vehicle, run: Prepared, known: Resistance, rolling: Resistance, straight: Sequence[Log]
) -> Iterator[PlausibilityWarning]:
    log, b, noise = run
    s = signals(log, vehicle)
    sensor = judge_accelerometer(vehicle, rolling, b, noise)
    response = brake_response(s, brake_balance(vehicle, known.effects, s))
    yield from run_warnings(log, s, vehicle, sensor, response)
    yield from judged(log.name, of_bend(log, s, vehicle.track_width, straight))
