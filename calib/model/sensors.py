"""The accelerometer of a run, judged against a resistance and put right."""

from dataclasses import replace

from calib.car.vehicle import Vehicle
from calib.model.resistance import Resistance
from calib.model.resistance import identify as identify_resistance
from calib.model.sort_logs import Prepared
from calib.run.accelerometer import Accelerometer, accelerometer
from calib.run.blocks import Blocks, block_balance
from calib.run.noise import SensorNoise


def put_right(run: Prepared, sensor: Accelerometer) -> Prepared:
    """The run with the z that the tyres feel, by its accelerometer as judged over all of it."""
    log, b, noise = run
    return log, replace(b, z=sensor.corrected(b.z)), noise


def of_whole_run(vehicle: Vehicle, b: Blocks, noise: SensorNoise) -> Accelerometer:
    """Scale and offset of the accelerometer of a calibration run by all of its blocks.

    The resistance is not known yet: usual values with their spread stand for it.
    """
    usual = identify_resistance(vehicle, [])
    return judge_accelerometer(vehicle, usual, b, noise)


def judge_accelerometer(
    vehicle: Vehicle,
    known: Resistance,
    b: Blocks,
    noise: SensorNoise,
) -> Accelerometer:
    """Scale and offset of the accelerometer of a run by all of it."""
    unexplained = block_balance(vehicle, known.effects, b).demanded / vehicle.weight
    sigma = known.sigma_z(vehicle, b.speed)
    return accelerometer(b, unexplained, sigma, noise.z, noise.v)
