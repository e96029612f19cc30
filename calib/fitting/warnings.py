"""What a fit says against its vehicle file and its logs."""

from collections.abc import Iterator

from calib.base.warning import Measured, PlausibilityWarning, judged
from calib.car.plausible import plausible
from calib.car.vehicle import Vehicle
from calib.model.resistance import ROLLING, Resistance
from calib.model.resistance import identify as identify_resistance
from calib.model.sensors import judge_accelerometer
from calib.model.sort_logs import Prepared
from calib.plausibility.run import of_bend, run_warnings
from calib.run.axle_signals import signals
from calib.run.brake_response import brake_balance, brake_response


def warnings_of(
    filed: Vehicle, car: Vehicle, ramps: list[Prepared], coasts: list[Prepared], known: Resistance
) -> Iterator[PlausibilityWarning]:
    """Warnings which need no fit: it says itself what it thinks of the pads.

    ``car`` as its effects leave it of the ``filed`` one; ``ramps``, ``coasts`` with the blocks as
    read; ``known`` the resistance that was identified, doubted where the file does not give it. A
    ramp is compared with that of the coasts alone, and with their course, where there are any.
    """
    yield from (w for w in plausible(filed) if not w.code.startswith("pad_friction"))
    effect, name = ROLLING
    if effect not in car.effects:
        found = known.effects.parameters[effect][name]
        yield from judged(car.name, [Measured("rolling_resistance", found)])
    coasted = [(b, noise.z) for _, b, noise in coasts]
    rolling = identify_resistance(car, coasted) if coasts else known
    straight = [log for log, _, _ in coasts]
    runs = [(run, rolling, straight) for run in ramps] + [(run, known, []) for run in coasts]
    for (log, b, noise), resistance, others in runs:
        s = signals(log, car)
        sensor = judge_accelerometer(car, resistance, b, noise)
        response = brake_response(s, brake_balance(car, known.effects, s))
        yield from run_warnings(log, s, car, sensor, response)
        yield from judged(log.name, of_bend(log, s, car.track_width, others))
