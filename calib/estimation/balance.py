"""The force balance of a run, sample by sample: what the brakes must have done for this z.

W z = tyre forces + body forces          tyre forces = brakes + what else slows the wheels
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.fitting.identify import brake_forces
from calib.fitting.known_effects import motion
from calib.names import G
from calib.physics.effects.catalogue import Effects, total_axle_moment, total_body_force
from calib.physics.forces import axle_loads, braking_sum
from calib.physics.vehicle import Vehicle
from calib.signals.axle_signals import Signals
from calib.signals.driving_record import BITE

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LOW_PASS = 0.1
"""Time constant of the causal filter on z, loads and eta in front of a look-up [s]."""


@dataclass(frozen=True)
class Balance:
    """Forces of a run [N], shapes (n,).

    ``nominal_f``, ``nominal_r`` brake forces of nominal pads; ``demanded`` sum of the brake forces
    that z asks for; ``moment_f``, ``moment_r`` what else slows the wheels, inertia included, as a
    force at the road; ``load_f``, ``load_r`` quasi-static; ``body`` what slows the body directly;
    ``active`` where the pads bite, after the lead-in.
    """

    nominal_f: Array
    nominal_r: Array
    demanded: Array
    moment_f: Array
    moment_r: Array
    load_f: Array
    load_r: Array
    body: Array
    active: Mask


def balance(car: Vehicle, effects: Effects, s: Signals) -> Balance:
    """Balance of a run with the nominal pads of ``car`` and the known effects.

    The wheels slow with the car: d omega/dt = -g z/R, exact but for the change of slip.
    """
    load_f, load_r = axle_loads(car, s.z)
    state = motion(s.time, s.speed, s.z, s.p_f, (load_f, load_r))
    moment_f, moment_r = (
        moment / axle.rolling_radius - 2.0 * axle.wheel_inertia * G * s.z / axle.rolling_radius**2
        for moment, axle in zip(
            total_axle_moment(car, effects, state), (car.front, car.rear), strict=True
        )
    )
    body = total_body_force(car, effects, state)
    nominal_f, nominal_r = brake_forces(car, s.p_f, s.p_r)
    return Balance(
        nominal_f=nominal_f,
        nominal_r=nominal_r,
        demanded=braking_sum(car, s.z, body) - moment_f - moment_r,
        moment_f=moment_f,
        moment_r=moment_r,
        load_f=load_f,
        load_r=load_r,
        body=body,
        active=_began(s) & (np.maximum(s.p_f, s.p_r) > BITE),
    )


def _began(s: Signals) -> Mask:
    """From the end of the lead-in on."""
    began = np.ones(s.time.size, bool)
    began[: int(np.flatnonzero(s.lead_in)[-1]) + 1] = False
    return began


def low_pass(s: Signals, x: Array, time: float = LOW_PASS) -> Array:
    """First-order causal low-pass of ``x`` (n,), started at its first value."""
    from scipy.signal import lfilter

    a = 1.0 - float(np.exp(-s.sample_time / time))
    return np.asarray(lfilter([a], [1.0, a - 1.0], x, zi=[(1.0 - a) * x[0]])[0])
