"""When the estimator stands behind a sample."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.car.braking import MOVING
from calib.estimation.constants import Constants
from calib.estimation.readout import Readout
from calib.estimation.state import Reason
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.filters import since, without_single

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LOCKS = "a wheel locks, or ABS works"
CORNERS = "the car corners"
TURNED = "the wheel is turned"
NO_PAD = "no pad has such a friction"
BEYOND_MAP = "no stop that the table knows shows such an eta"
"""Names of these reasons for a sample that is not valid."""


@dataclass(frozen=True)
class Gates:
    """Limits within which the estimator stands behind a sample; each with its reason."""

    pressure: float = Constants.least_pressure
    """Pressure [Pa] below which a pad level means little."""
    speed: float = MOVING
    """Speed [m/s] below which slip is noise."""
    settle: float = Constants.settle
    """Time of braking [s] before the level is trusted: half its memory has passed by then."""
    beyond: float = 1.2
    """Normalised force over the greatest one of the ramp up to which the tyre's curve is continued:
    rear brakes that are held leave the front ones more than the ramp had. The curvature of the
    posterior widens the interval there."""
    possible: tuple[float, float] = (0.02, 1.2)
    """Pad friction [1] that a brake may show in a stop: soaked pads, and the best of racing pads
    with a tenth of error."""
    steering: float = np.deg2rad(5.0)
    """Angle at the driver's wheel [rad] whose effect on eta is as large as the signal."""
    lateral: float = 3.0
    """Lateral acceleration [m/s^2] by left and right wheel speeds past which cornering tyres leave
    the curve; radii 0.5 % apart, left to right, look like as much at 30 m/s."""
    lock: float = 0.15
    """Relative departure of a wheel from the others that only ABS or a locked wheel shows."""
    recover: float = 1.0
    """Time after such a departure [s]: the filters behind the signals have forgotten it."""


@dataclass(frozen=True)
class _Validity:
    """Where the estimator stands behind its answer, (n,); ``refused`` masks by reason, (n,) each.

    Of the samples in which the pads bite; a sample may be refused for several reasons.
    """

    valid: Mask
    refused: dict[str, Mask]


def validity(
    gates: Gates,
    s: Signals,
    best: Readout,
    normalised: tuple[Array, Array],
    active: Mask,
    greatest: float,
    calm: dict[str, Mask],
) -> _Validity:
    """Where the estimator stands behind its answer, see `Gates`.

    ``normalised`` forces of front and rear [1], ``active`` where the pads bite (n,); ``greatest``
    normalised force of the ramp [1]; ``calm`` as `undisturbed` has it.
    """
    low, high = gates.possible
    pads = np.stack([best.pads_f.value, best.pads_r.value])
    with np.errstate(invalid="ignore"):
        good = {
            "the pressure is low": np.maximum(s.p_f, s.p_r) > gates.pressure,
            "the car is slow": s.speed > gates.speed,
            "the brake has just been applied": since(s.time, ~active) > gates.settle,
            LOCKS: calm[LOCKS],
            BEYOND_MAP: best.reason != Reason.BEYOND_MAP,
            NO_PAD: ((pads > low) & (pads < high)).all(axis=0),
            "the tyres carry more than on the ramp": np.maximum(*normalised)
            < gates.beyond * greatest,
            CORNERS: calm[CORNERS],
            TURNED: calm[TURNED],
        }
    valid = np.logical_and.reduce([active, *good.values()])
    return _Validity(np.asarray(valid), {why: active & ~ok for why, ok in good.items()})


def undisturbed(gates: Gates, log: Log, s: Signals, cornering: Array) -> dict[str, Mask]:
    """Samples (n,) in which no wheel locks, or has just, and the car goes straight; by reason.

    ``cornering`` the lateral acceleration [m/s^2] (n,).
    """
    steered = log["steering"] if "steering" in log else np.zeros_like(s.time)
    with np.errstate(invalid="ignore"):
        return {
            LOCKS: since(s.time, _locked(log, s, gates)) > gates.recover,
            CORNERS: np.abs(cornering) < gates.lateral,
            TURNED: np.abs(steered) < gates.steering,
        }


def _locked(log: Log, s: Signals, gates: Gates) -> Mask:
    """Where a wheel departs from the others, or from v, as only ABS or a locked wheel does."""
    wheels = np.stack([without_single(log[f"omega_{w}"]) for w in WHEELS])
    fastest = wheels.max(axis=0)
    if s.v is not None and s.lead_in.any():  # all four may lock together
        per_speed = float(np.mean(fastest[s.lead_in]) / np.mean(s.v[s.lead_in]))
        fastest = np.maximum(fastest, per_speed * s.v)
    apart = fastest - wheels.min(axis=0) > gates.lock * np.maximum(fastest, 1.0)
    return np.asarray(apart & (s.speed > gates.speed))
