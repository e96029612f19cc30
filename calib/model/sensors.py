"""The accelerometer of a run, judged against a resistance and put right."""

from dataclasses import replace

from calib.car.vehicle import Vehicle
from calib.model.sort_logs import Prepared
from calib.run.accelerometer import Accelerometer, accelerometer
from calib.run.blocks import Blocks, block_balance
from calib.run.noise import SensorNoise
from calib.run.resistance import Resistance
from calib.run.resistance import identify as identify_resistance


def put_right(vehicle: Vehicle, run: Prepared) -> tuple[Prepared, Accelerometer]:
    """The run with the z that the tyres feel; scale and offset by all of its blocks.

    The resistance is not known yet: usual values with their spread stand for it.
    """
    log, b, noise = run
    usual = identify_resistance(vehicle, [])
    sensor = judge_accelerometer(vehicle, usual, b, noise)
    return (log, replace(b, z=sensor.corrected(b.z)), noise), sensor


def judge_accelerometer(
    vehicle: Vehicle,
    known: Resistance,
    b: Blocks,
    noise: SensorNoise,
) -> Accelerometer:
    """Scale and offset of the accelerometer of a run, block by block."""
    unexplained = block_balance(vehicle, known.effects, b).demanded / vehicle.weight
    sigma = known.sigma_z(vehicle, b.speed)
    return accelerometer(b, unexplained, sigma, noise.z, noise.v)
