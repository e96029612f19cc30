"""Caliper hysteresis: on release the clamp stays until the pressure has fallen by its width.

    clamp ^            .-------.        loading    c = p
          |          .'      .'         release    c = p/(1 - w)
          |        .'  .  .'            between    c stays
          |      .' .   .'
          |    .'.    .'
          +---'-----'------------> p

A play operator between two lines through the origin: its width is zero at zero pressure and does
not depend on the rate of the pressure. With L = p and U = p/(1 - w) at each sample it is

    c[k] = max(L[k], min(U[k], c[k-1]))
"""

import numpy as np

from calib.physics.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import RunHistory
from calib.statistics.intervals import QUARTILE

WOBBLE = 0.1e5
"""Largest error that a pressure sensor is assumed to add to a held pressure [Pa]: three sigma of a
usual sensor (0.15 bar at 200 Hz), averaged over 0.1 s. The third differences of such a mean are as
large as its noise."""


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] that would give the same clamping without hysteresis, for each axle.

    Begins on the loading line. No play where the pressure is negative (sensor noise).
    """
    width = parameters["width"]
    front = held(p_f, width)
    return front, front if p_r is p_f else held(p_r, width)


def held(p: Array, width: float) -> Array:
    """Clamping pressure [Pa] (n,) at a measured line pressure ``p`` [Pa] (n,).

    Sensor noise must not raise the clamp step by step while the pressure is held: the loop is
    computed from the pressure less a band of its noise. Without noise it is exact; with noise the
    clamp is low by at most twice that band while it moves from one line to the other.
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

    Each sample limits the value before it to [L, U]. Two such limits in a row are one limit, so all
    samples are computed in log2(n) passes, each of which joins runs of twice the length.
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
        equation="c = p rising, p/(1 - w) falling, held between; no effect at width = 0",
        source="Visintin, Differential Models of Hysteresis, ch. III (play); Limpert, ch. 5",
        looks_like="more torque on release than on application at the same pressure, fast or slow",
        parameters=(Parameter("width", "1", 0.0, 0.5, 0.06, 0.04),),
    ),
    pressure=pressure,
)
