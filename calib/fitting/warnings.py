"""What a fit says against its logs and its vehicle file."""

from collections.abc import Iterator

from calib.base.warning import Measured, PlausibilityWarning, judged
from calib.car.plausible import plausible
from calib.car.vehicle import Vehicle
from calib.model.resistance import ROLLING, Resistance
from calib.model.resistance import identify as identify_resistance
from calib.model.sensors import judge_accelerometer
from calib.model.sort_logs import Prepared
from calib.plausibility.bend import bend_of
from calib.plausibility.run import run_warnings
from calib.run.axle_signals import signals
from calib.run.brake_response import brake_balance, brake_response


def log_warnings(
    vehicle: Vehicle, ramps: list[Prepared], coasts: list[Prepared], known: Resistance
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on the logs of a fit, which need no fit.

    ``ramps``, ``coasts`` with the blocks as read; ``known`` the resistance that was identified. A
    ramp is compared with the resistance of the coasts alone, where there are any.
    """
    coasted = [(b, noise.z) for _, b, noise in coasts]
    rolling = identify_resistance(vehicle, coasted) if coasts else known
    runs = [(run, rolling) for run in ramps] + [(run, known) for run in coasts]
    return (
        *_of_resistance(vehicle, known),
        *(warning for run, own in runs for warning in _of_run(vehicle, run, known, own)),
        *_of_bends(vehicle, ramps, coasts),
    )


def file_warnings(vehicle: Vehicle) -> tuple[PlausibilityWarning, ...]:
    """What no usual car has in its file; the pads are judged by what the fit says of them."""
    return tuple(w for w in plausible(vehicle) if not w.code.startswith("pad_friction"))


def _of_resistance(vehicle: Vehicle, known: Resistance) -> tuple[PlausibilityWarning, ...]:
    """Of a rolling resistance that was identified, not of one that the vehicle file gives."""
    effect, name = ROLLING
    if effect in vehicle.effects:
        return ()
    found = known.effects.parameters[effect][name]
    return judged(vehicle.name, [Measured("rolling_resistance", found)])


def _of_bends(
    vehicle: Vehicle, ramps: list[Prepared], coasts: list[Prepared]
) -> Iterator[PlausibilityWarning]:
    straight = [log for log, _, _ in coasts]
    for log, _, _ in ramps:
        bend = bend_of(log, signals(log, vehicle), vehicle.track_width, straight)
        yield from judged(log.name, bend)


def _of_run(
    vehicle: Vehicle, run: Prepared, known: Resistance, rolling: Resistance
) -> tuple[PlausibilityWarning, ...]:
    log, b, noise = run
    sensor = judge_accelerometer(vehicle, rolling, b, noise)
    s = signals(log, vehicle)
    response = brake_response(s, brake_balance(vehicle, known.effects, s))
    return run_warnings(log, s, vehicle, sensor, response)
