"""The accelerometer of a calibration run, put right before anything is fitted to it."""

from dataclasses import replace

import numpy as np

from calib.fitting.resistance import identify as identify_resistance
from calib.fitting.sort_logs import Prepared
from calib.logs.log import Log
from calib.physics.balance import force_balance
from calib.physics.vehicle import Vehicle
from calib.signals.accelerometer import accelerometer
from calib.signals.blocks import Blocks
from calib.signals.noise import SensorNoise


def correct_accelerometer(vehicle: Vehicle, log: Log, b: Blocks, noise: SensorNoise) -> Prepared:
    """Blocks with the z that the tyres feel, by what the whole run says of scale and offset.

    The resistance is not known yet: usual values with their spread stand for it.
    """
    usual = identify_resistance(vehicle, [])
    spin = (b.spin_f, b.spin_r)
    forces = force_balance(vehicle, usual.effects, b.end, b.speed, b.z, b.p_f, spin)
    unexplained, sigma = forces.demanded / vehicle.weight, usual.sigma_z(vehicle, b.speed)
    sensor = accelerometer(b, unexplained, sigma, noise.z, noise.v)
    scale, bias = float(sensor.scale[-1]), float(sensor.bias[-1])
    return log, replace(b, z=np.asarray((b.z - bias) * (1.0 - scale))), noise
