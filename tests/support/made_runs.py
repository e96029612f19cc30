"""Runs in closed form: a given pressure, deceleration in proportion, slip in proportion to it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.logs.log import Log

BAR_PER_G = 70.0
RADIUS = 0.32
SLIP_F, SLIP_R = 0.012, 0.007  # per g


def ramp(start: float = 1.5, rate: float = 6.0, top: float = 40.0) -> Callable[[Array], Array]:
    """Pressure [bar] that rises steadily from ``start`` [s] on."""
    return lambda t: np.clip(rate * (t - start), 0.0, top)


def stop(start: float = 1.5, level: float = 25.0, end: float = 99.0) -> Callable[[Array], Array]:
    """Pressure [bar] that is applied at once."""
    return lambda t: np.where((t >= start) & (t < end), level, 0.0)


def made_run(
    pressure: Callable[[Array], Array] | None = None,
    *,
    duration: float = 8.0,
    rate: float = 200.0,
    speed: float = 30.0,
    noise: float = 1.0,
    name: str = "made",
) -> Log:
    """A run on an even road. ``noise`` 1 is that of usual sensors, 0 none at all."""
    rng = np.random.default_rng(7)
    t = np.arange(round(duration * rate)) / rate
    p = (pressure or ramp())(t)
    v = np.maximum(speed - np.cumsum(p / BAR_PER_G) * G / rate, 0.0)
    z = np.where(v > 0.0, p / BAR_PER_G, 0.0)
    slips = {"fl": SLIP_F, "fr": SLIP_F, "rl": SLIP_R, "rr": SLIP_R}

    def noisy(x: Array, sigma: float) -> Array:
        return x + noise * sigma * rng.normal(size=x.size)

    channels = {
        "time": t,
        "p_mc": noisy(p * 1e5, 0.1e5),
        "a_x": noisy(-z * G, 0.05),
        **{f"omega_{w}": noisy(v / RADIUS * (1 - s * z), 0.02) for w, s in slips.items()},
        "v": noisy(v, 0.02),
    }
    return Log(name, f"{name}.csv", "0" * 64, channels)


def changed(log: Log, **channels: Array | None) -> Log:
    """The run with some channels replaced, or left out where None."""
    merged = {**log.channels, **channels}
    return replace(log, channels={k: v for k, v in merged.items() if v is not None})


def with_slip(
    log: Log, wheels: list[str], start: float, length: float, depth: float, v: bool = True
) -> Log:
    """Slip added to some wheels as half a sine wave, as an ABS lets it come and go."""
    t = log.time
    bump = np.where((t > start) & (t < start + length), np.sin(np.pi * (t - start) / length), 0.0)
    wheel = {f"omega_{w}": log[f"omega_{w}"] * (1 - depth * bump) for w in wheels}
    return changed(log, **wheel, **({} if v else {"v": None}))
