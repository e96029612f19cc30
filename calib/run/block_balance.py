"""The force balance of the blocks of a run."""

from calib.car.balance import ForceBalance, force_balance
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.run.blocks import Blocks


def block_balance(vehicle: Vehicle, effects: Effects, b: Blocks) -> ForceBalance:
    """`force_balance` of each block, with the spin of the wheels as it was measured, (k,)."""
    drive, spin = (b.drive_f, b.drive_r), (b.spin_f, b.spin_r)
    return force_balance(vehicle, effects, b.end, b.speed, b.z, b.p_f, drive, spin)
