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

from calib.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters, Trace


def pressure(parameters: Parameters, trace: Trace, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] that would clamp as hard without hysteresis, for each axle.

    Begins on the loading line. Below no pressure (sensor noise) there is no play.
    """
    width = parameters["width"]
    front = clamp(p_f, width)
    return front, front if p_r is p_f else clamp(p_r, width)


def clamp(p: Array, width: float) -> Array:
    """Clamping pressure [Pa] (n,) at line pressure ``p`` [Pa] (n,), ``width`` [1] below 1.

    Each sample limits what was before to [L, U]. Two such limits in a row are one limit, so all
    samples are taken in log2(n) sweeps, each of which joins runs of twice the length.
    """
    low, high = p.copy(), p / (1.0 - width)
    high[0] = p[0]
    reach = 1
    while reach < p.size:
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
