"""A log of a diagnosis, judged by itself: its signals, its accelerometer, how its brakes answer."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.known_effects import remove_known_effects
from calib.model.resistance import Resistance
from calib.model.resistance import identify as identify_resistance
from calib.run.axle_signals import Signals, signals
from calib.run.blocks import Blocks, blocks
from calib.run.brake_response import BrakeResponse, brake_balance, brake_response
from calib.run.driving_record import brake_events, driving_record
from calib.run.noise import SensorNoise, sensor_noise


@dataclass(frozen=True)
class JudgedLog:
    """A log without the effects that the vehicle file knows.

    ``vehicle`` as driven; ``known`` the resistance that the coast logs tell; ``response`` None
    where too little is braked to tell.
    """

    log: Log
    vehicle: Vehicle
    known: Resistance
    signals: Signals
    blocks: Blocks
    noise: SensorNoise
    response: BrakeResponse | None

    def over_others(self, judged: "Sequence[JudgedLog]") -> float | None:
        """Brakes of this log over the median of the other ones [1]; None with fewer than two."""
        others = [one.response.level for one in judged if one is not self and one.response]
        if self.response is None or len(others) < 2:
            return None
        return self.response.level / median(others)


def judged_logs(vehicle: Vehicle, logs: Sequence[Log]) -> list[JudgedLog]:
    """Judge every log; drag and rolling resistance are those of the ones without braking.

    Raises ModelError when a known effect cannot be taken out of a log.
    """
    runs = [remove_known_effects(vehicle, log) for log in logs]
    seen = [signals(run.log, run.vehicle) for run in runs]
    pieces = [blocks(s) for s in seen]
    noises = [sensor_noise(run.log, b) for run, b in zip(runs, pieces, strict=True)]
    coasts = [
        (b, noise.z)
        for log, b, noise in zip(logs, pieces, noises, strict=True)
        if not brake_events(driving_record(log))
    ]
    known = identify_resistance(runs[0].vehicle, coasts)
    return [
        JudgedLog(
            log=run.log,
            vehicle=run.vehicle,
            known=known,
            signals=s,
            blocks=b,
            noise=noise,
            response=brake_response(s, brake_balance(run.vehicle, known.effects, s)),
        )
        for run, s, b, noise in zip(runs, seen, pieces, noises, strict=True)
    ]
