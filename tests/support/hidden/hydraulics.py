"""From the master cylinder to the pressure that presses the pads, on a grid of 1 kHz.

p_mc --> delay --> lag --> knee (rear) --> threshold --> loop --> applications --> sticking
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from calib.base.arrays import Array
from tests.support.hidden.settings import Hidden

STEP = 1e-3
"""Clock of the pressures [s]."""

BAR = 1e5


@dataclass(frozen=True)
class Lines:
    """Pressures [Pa] every `STEP`: master cylinder, pads in front, pads behind."""

    master: Array
    front: Array
    rear: Array


def lines(hidden: Hidden, master: Array) -> Lines:
    """Press the pads with ``master`` (n,) [Pa]."""
    p = follow(hidden, master)
    front, rear = p, p
    if hidden.knee:
        rear = np.where(p > hidden.knee, hidden.knee + hidden.knee_slope * (p - hidden.knee), p)
    pressed = []
    for line in (front, rear):
        if hidden.threshold:
            line = released(line, hidden.threshold)
        if hidden.hysteresis:
            line = loop(line, hidden.hysteresis)
        if hidden.hysteresis_fixed:
            line = backlash(line, hidden.hysteresis_fixed)
        if hidden.weaker_by:
            line = line * (1.0 - hidden.weaker_by * np.maximum(applications(p) - 1, 0))
        pressed.append(line)
    if hidden.sticking:
        pressed[1] = np.maximum(pressed[1], stuck(p, hidden.sticking))
    return Lines(master, pressed[0], pressed[1])


def follow(hidden: Hidden, master: Array) -> Array:
    """Delay, then lags of first order that start settled."""
    p = master
    if hidden.delay:
        n = hidden.delay / STEP
        p = np.interp(np.arange(p.size) - n, np.arange(p.size), p)
    for lag in (hidden.lag, hidden.lag_behind):
        if lag:
            a = np.exp(-STEP / lag)
            p = np.asarray(lfilter([1.0 - a], [1.0, -a], p, zi=[a * p[0]])[0])
    if hidden.surge:
        p = swinging(p, 2.0 * np.pi * hidden.surge, hidden.surge_damping)
    return p


def swinging(p: Array, frequency: float, damping: float) -> Array:
    """Spring and mass by small steps of semi-implicit Euler, settled at first."""
    y, rate = float(p[0]), 0.0
    out = np.empty_like(p)
    parts = 4
    dt = STEP / parts
    for i, now in enumerate(p.tolist()):
        for _ in range(parts):
            rate += dt * frequency * (frequency * (now - y) - 2.0 * damping * rate)
            y += dt * rate
        out[i] = y
    return np.maximum(out, 0.0)


def released(p: Array, threshold: float) -> Array:
    """p less the threshold, the corner rounded over some 0.3 bar; nought at no pressure."""
    width = 0.1 * BAR
    bare = width * np.logaddexp(0.0, (p - threshold) / width)
    return np.asarray(np.minimum(bare, p))


def loop(p: Array, width: float) -> Array:
    """Prandtl-Ishlinskii: the mean of three plays whose half-widths go with the pressure.

    Rising it follows p (1 - width/2), falling p (1 + width/2), and goes over gently.
    """
    halves = [0.5 * width * k for k in (0.5, 1.0, 1.5)]
    heights = [0.0, 0.0, 0.0]
    out = np.empty_like(p)
    for i, now in enumerate(p.tolist()):
        heights = [
            min(max(c, now * (1.0 - h)), now * (1.0 + h))
            for c, h in zip(heights, halves, strict=True)
        ]
        out[i] = sum(heights) / 3.0
    return out


def backlash(p: Array, half: float) -> Array:
    """The mean of three plays whose half-widths do not depend on the pressure, never below zero.

    Rising far enough it follows p - half, falling p + half; what is left stays at no pressure.
    """
    halves = [half * k for k in (0.7, 1.0, 1.3)]
    heights = [0.0, 0.0, 0.0]
    out = np.empty_like(p)
    for i, now in enumerate(p.tolist()):
        heights = [
            max(min(max(c, now - h), now + h), 0.0) for c, h in zip(heights, halves, strict=True)
        ]
        out[i] = sum(heights) / 3.0
    return out


def applications(p: Array) -> Array:
    """How often the pressure has risen past 2 bar so far, having been below 1 bar."""
    count, on = 0, False
    out = np.empty(p.size)
    for i, now in enumerate(p.tolist()):
        if not on and now > 2.0 * BAR:
            count, on = count + 1, True
        elif on and now < 1.0 * BAR:
            on = False
        out[i] = count
    return out


def stuck(p: Array, most: float) -> Array:
    """What the pads are left with: a residual that drains within some 8 s of every application."""
    drain = np.exp(-STEP / 8.0)
    out, residual = np.empty_like(p), 0.0
    for i, now in enumerate(p.tolist()):
        residual = max(residual * drain, min(now, most))
        out[i] = residual
    return out
