"""Caliper hysteresis: on release the clamp holds on until the pressure has fallen by its width.

    clamp ^            .-------.        loading    c = p
          |          .'      .'         release    c = p/(1 - w)
          |        .'  .  .'            between    c stays
          |      .' .   .'
          |    .'.    .'
          +---'-----'------------> p

A play between two lines through the origin, so it closes at no pressure and is the same at any
speed of the pedal. With the lines L = p and U = p/(1 - w) of each sample it is

    c[k] = max(L[k], min(U[k], c[k-1]))
"""

import numpy as np

from calib.physics.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import RunHistory
from calib.statistics.intervals import QUARTILE

WOBBLE = 0.1e5
"""Most that a pressure sensor is taken to add to a held pressure [Pa]: three sigma of a usual one
(0.15 bar at 200 Hz), averaged over a tenth of a second. The third differences of such a mean are as
large as its noise."""


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] that would clamp as hard without hysteresis, for each axle.

    Begins on the loading line. Below no pressure (sensor noise) there is no play.
    """
    width = parameters["width"]
    front = held(p_f, width)
    return front, front if p_r is p_f else held(p_r, width)


def held(p: Array, width: float) -> Array:
    """Clamping pressure [Pa] (n,) at a measured line pressure ``p`` [Pa] (n,).

    What a sensor wobbles by must not ratchet the clamp up while the foot rests: the loop is that of
    the pressure less its wobble. Without noise it is exact; with it the clamp is low by twice the
    wobble at most while it goes from one line to the other.
    """
    rough = np.median(np.abs(np.diff(p, 3))) / QUARTILE if p.size > 3 else 0.0
    wobble = min(3.0 * float(rough), WOBBLE)
    foot = between(p - wobble, p + wobble, p[0])
    return np.asarray(p + (clamp(foot, width) - foot))


def clamp(p: Array, width: float) -> Array:
    """Clamping pressure [Pa] (n,) at line pressure ``p`` [Pa] (n,), ``width`` [1] below 1."""
    return between(p, p / (1.0 - width), p[0])


def between(lowest: Array, highest: Array, first: float) -> Array:
    """c[k] = max(lowest[k], min(highest[k], c[k-1])) (n,), from ``first`` on.

    Each sample limits what was before to [L, U]. Two such limits in a row are one limit, so all
    samples are taken in log2(n) sweeps, each of which joins runs of twice the length.
    """
    low, high = lowest.copy(), highest.copy()
    low[0] = high[0] = first
    reach = 1
    while reach < low.size:
        before = np.maximum(low[reach:], np.minimum(high[reach:], low[:-reach]))
        high[reach:] = np.maximum(low[reach:], np.minimum(high[reach:], high[:-reach]))
        low[reach:] = before
        reach *= 2
    return low


EFFECT = Effect(
    card=Card(
        name="caliper_hysteresis",
        cause="friction of piston seals and slide pins holds the pads on release",
        equation="c = p rising, p/(1 - w) falling, held between; nothing at width = 0",
        source="Visintin, Differential Models of Hysteresis, ch. III (play); Limpert, ch. 5",
        looks_like="more torque on release than on application at the same pressure, at any rate",
        parameters=(Parameter("width", "1", 0.0, 0.5, 0.06, 0.04),),
    ),
    pressure=pressure,
)
