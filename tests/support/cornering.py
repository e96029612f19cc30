"""What a bend does to the four wheels of the plant: paths, loads, slip across, drag of the steer.

          path of wheel   v (1 -+ k T/2) behind, hypot(1 -+ k T/2, k L) in front    k curvature
    force along the car   tyre(hypot(s, a)) s / hypot(s, a)     s slip along, a slip across

The second line is the similarity method of Pacejka, Tyre and Vehicle Dynamics, section 4.2, for a
tyre that is alike in both directions. Where a bend takes the tyre past its peak it stops being
true; body roll and the width of the contact patch are left out.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from calib.car.vehicle import Vehicle

GRAVITY = 9.80665

Tyre = Callable[[float, float, float, float], float]
"""slip, load over the static mean load, stiffness factor, peak factor -> normalised force."""


@dataclass(frozen=True)
class Cornering:
    """Wheels fl, fr, rl, rr: ``path`` speed over the car's [1], ``load`` over its axle's mean [1].

    ``across`` slip across the wheel [1]; ``resistance`` of the steered wheels over their load [1].
    """

    path: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    load: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    across: float = 0.0
    resistance: float = 0.0


STRAIGHT = Cornering()


def cornering(vehicle: Vehicle, tyre: Tyre, curvature: float, v: float) -> Cornering:
    """The wheels on a path of ``curvature`` [1/m], positive to the left, at ``v`` [m/s]."""
    if not curvature:
        return STRAIGHT
    sideways = curvature * v * v / GRAVITY
    moved = 2.0 * vehicle.cg_height / vehicle.track_width * sideways
    left, right = (1.0 + s * 0.5 * curvature * vehicle.track_width for s in (-1.0, 1.0))
    ahead = curvature * vehicle.wheelbase
    return Cornering(
        path=(math.hypot(left, ahead), math.hypot(right, ahead), left, right),
        load=(1.0 - moved, 1.0 + moved, 1.0 - moved, 1.0 + moved),
        across=sideways * 1e-4 / tyre(1e-4, 1.0, 1.0, 1.0),
        resistance=sideways * ahead,
    )


def along(
    tyre: Tyre, slip: float, across: float, load: float, factors: tuple[float, float]
) -> float:
    """Normalised force along the wheel at ``slip`` along and ``across`` it."""
    if not across:
        return tyre(slip, load, *factors)
    total = math.hypot(slip, across)
    return tyre(total, load, *factors) * slip / total
