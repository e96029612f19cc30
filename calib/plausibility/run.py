"""All that one run says against its sensors, from fit and estimate alike."""

from calib.base.warning import PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.plausibility.accelerometer import accelerometer_warnings
from calib.plausibility.brakes import pressure_warnings, response_warnings
from calib.plausibility.channels import channel_warnings
from calib.plausibility.wheel_signals import wheel_signal_warnings
from calib.run.accelerometer import Accelerometer
from calib.run.axle_signals import Signals
from calib.run.brake_response import BrakeResponse


def run_warnings(
    log: Log,
    s: Signals,
    vehicle: Vehicle,
    sensor: Accelerometer,
    response: BrakeResponse | None,
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on a run.

    ``s`` its signals as read, known effects taken out; ``vehicle`` with the pads that are expected;
    ``sensor`` the accelerometer as judged over the run; ``response`` of its brakes to the pressure.
    """
    return (
        *channel_warnings(log, vehicle, s),
        *wheel_signal_warnings(log, vehicle, s),
        *pressure_warnings(log.name, s),
        *accelerometer_warnings(log.name, sensor),
        *response_warnings(log.name, response, vehicle.motor_odds),
    )
