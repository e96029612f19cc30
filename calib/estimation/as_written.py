"""The paper's law (23)-(25) as it is written, with nothing added.

    y = J d omega/dt - (z + f1(eta)) R F_z + mu_n C P          (23), f2 behind
    d theta/dt = gamma (y - theta u) u,    u = -C P            (24), (25)

d omega/dt is the step of the axle's mean wheel speed since the sample before, over the sample time;
nothing is smoothed. z is the accelerometer's as read, the loads are (6), (7), and no drag, rolling
resistance or motor is taken out. The law is not frozen: it moves wherever there is pressure.

What the paper leaves open is filled in so: (25) lacks its dot, and is integrated in steps of the
log's sample time; gamma has no number, and is one for both axles, the one that gives the front axle
the rate of the other laws, so that the rear of the reference car is 7 times slower; mu_n is that of
the estimate; P is the axle's where wheel pressures are logged. eta is zeroed like the table's: a
table and a run of the same raw wheel speeds would share the mismatch of the radii.
"""

import numpy as np
from numpy.typing import NDArray

from calib.car.forces import axle_loads
from calib.car.vehicle import Axle, Vehicle
from calib.estimation import adaptive
from calib.estimation.lookup import paper
from calib.run.axle_signals import Signals
from calib.table.table import Table

Array = NDArray[np.float64]


def as_written(table: Table, car: Vehicle, s: Signals, eta: Array) -> tuple[Array, Array]:
    """Pad friction mu_n + zeta of both axles [1], (n,).

    ``s`` the signals as read; ``eta`` zeroed (22) [1]; ``car`` has the nominal pads. Raises
    InputError if the law is unstable: too high a pressure for the rate of the log.
    """
    reading = paper(table, s.z, eta, s.z)  # (11), (12)
    load_f, load_r = axle_loads(car, s.z)  # (6), (7)
    gamma = adaptive.gain(car.front)

    def adapted(axle: Axle, force: Array, load: Array, omega: Array, pressure: Array) -> Array:
        spin = np.diff(omega, prepend=omega[0]) / s.sample_time
        y = adaptive.measured_output(axle, force, 0.5 * load, spin, pressure, 0.0)  # (23)
        u = adaptive.regressor(axle, pressure)  # (24)
        return axle.pad_friction + adaptive.gradient(y, u, gamma, s.sample_time)  # (25)

    return (
        adapted(car.front, reading.F_f, load_f, s.omega_f, s.p_f),
        adapted(car.rear, reading.F_r, load_r, s.omega_r, s.p_r),
    )
