"""Caliper hysteresis: friction of seals and pins holds the pads, with a fixed and a relative width.

    clamp ^            .-------.        loading    c = p - r, not below zero
          |          .'      .'         release    c = p/(1 - u) + r
          |        .'      .'           between    c stays
          |      .'      .'
          |    .'      .'               r = s w p_0/2     s w of the width is fixed,
          |    |     .'                 u = (1 - s) w     the rest grows with the pressure
          +----'-----'--------> p

A play operator between two lines. It does not depend on the rate of the pressure. The fixed part is
that of dry friction: the pads bite late by r and keep r when the pedal is free. The relative part
has no width at zero pressure. With L = p - r and U = p/(1 - u) + r at each sample the clamp is

    c[k] = max(L[k], min(U[k], c[k-1]))
"""

from dataclasses import dataclass

import numpy as np

from calib.base.intervals import QUARTILE
from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory

REFERENCE = 20e5
"""Pressure p_0 at which the width is told [Pa]: that of a usual stop."""

WOBBLE = 0.25e5
"""Largest error that a pressure sensor is assumed to add to a held pressure [Pa]: three sigma of a
loud sensor (0.4 bar at 200 Hz), averaged over 0.1 s. The third differences of such a mean are as
large as its noise."""


@dataclass(frozen=True)
class Play:
    """The lines of the loop: ``relative`` u [1] below 1, ``half`` r of the fixed width [Pa]."""

    relative: float
    half: float = 0.0


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] that would give the same clamping without hysteresis, for each axle.

    Begins on the loading line. No play where the pressure is negative (sensor noise). Both calipers
    have the same width. Without ``fixed_share`` all of it is relative, as in older files.
    Not valid for a caliper whose seals pull the pads back by themselves: it keeps no torque at zero
    pressure.
    """
    width, share = parameters["width"], parameters.get("fixed_share", 0.0)
    play = Play((1.0 - share) * width, 0.5 * share * width * REFERENCE)
    front = held(p_f, play)
    return front, front if p_r is p_f else held(p_r, play)


def held(p: Array, play: Play) -> Array:
    """Clamping pressure [Pa] (n,) at a measured line pressure ``p`` [Pa] (n,).

    Sensor noise must not raise the clamp step by step while the pressure is held: the loop is
    computed from the pressure less a band of its noise. Without noise it is exact; with noise the
    clamp is low by at most twice that band while it moves from one line to the other.
    """
    rough = np.median(np.abs(np.diff(p, 3))) / QUARTILE if p.size > 3 else 0.0
    wobble = min(3.0 * float(rough), WOBBLE)
    foot = between(p - wobble, p + wobble, p[0])
    return np.asarray(p + (clamp(foot, play) - foot))


def clamp(p: Array, play: Play) -> Array:
    """Clamping pressure [Pa] (n,) at line pressure ``p`` [Pa] (n,)."""
    loading = p - np.clip(p, 0.0, play.half)
    return between(loading, p / (1.0 - play.relative) + play.half, loading[0])


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
        equation=(
            "c = p - r rising, p/(1 - (1 - s) w) + r falling, held between; "
            "r = s w p_0/2, p_0 = 20 bar; no effect at width = 0"
        ),
        source="Visintin, Differential Models of Hysteresis, ch. III (play); Limpert, ch. 5",
        looks_like=(
            "more torque on release than on application at the same pressure, fast or slow; a "
            "fixed width also bites late and drags after release; seen only in logs with a release"
        ),
        parameters=(
            Parameter("width", "1", 0.0, 0.5, 0.06, 0.04),
            Parameter("fixed_share", "1", 0.0, 1.0, 0.5, 0.5, default=0.0),
        ),
    ),
    pressure=pressure,
)
