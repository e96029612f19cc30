"""An offset of the wheel speeds, or of v: a hypothesis against another radius and nothing wrong.

    v = R (omega - offset + slip and growth of the tyre) + delay z g

over coasting, lead-in and braking. Slip is a cubic of z. The three are linear Gaussian models, in
which tyres and the sensor of v have what they usually have; they differ in what they believe of the
radius R and of the offset.
"""

import math
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES, G
from calib.run.driving_record import DRIVEN, GREATEST, NOMINAL_RADIUS, SMOOTH
from calib.run.filters import block_mean
from calib.run.run import Run

_FEWEST, _LASTING = 20, 4.0
"""Means over which an offset is told, and how much longer than one of them its errors last [1]."""
_FILE, _USUAL, _OTHER = 0.012, 0.08, (0.1, 3.0)
"""Sigma of a radius over that of the vehicle file, of any radius, and of one of another car and in
another unit [1]."""
_SLIP = ((0.04, 0.02), (0.01, 0.02), (0.0, 0.02), (0.0, 0.003))
"""Mean and sigma of what v has over radius and wheel speed, with z, its square and cube, and with
the square of the wheel speed over 100 rad/s: slip of a tyre, its bend, and how a tyre grows [1]."""
_LATE, _FINEST = 0.15, 5e-3  # sigma of the delay of v [s], and least of v [m/s]
_SMALL, _LARGE = 0.3, 30.0  # sigma of an offset that no one sees, and of one by mistake [rad/s]
_RARE, _RARER = math.log(0.05), math.log(0.01)  # odds of another radius, and of an offset
_SURE, _EXPLAINED = 3.0, 1.5
"""ln of the odds from which an offset is named, and the most that it leaves of v, over noise."""


class _Offset(NamedTuple):
    """An offset of wheel speeds with its sigma [rad/s], ln of its odds, and the radius [m]."""

    value: float
    sigma: float
    log_odds: float
    radius: float


def offsets_of(run: Run) -> dict[str, _Offset]:
    """Offsets of the wheel speeds that explain v, by axle; by "" one that both may have."""
    car = run.vehicle
    radii = (car.front.rolling_radius, car.rear.rolling_radius) if car else (None, None)
    each = {axle: _offset(run, axle, radius) for axle, radius in zip(AXLES, radii, strict=True)}
    every = {axle: offset for axle, offset in each.items() if offset is not None}
    named = {axle: offset for axle, offset in every.items() if offset.log_odds > _SURE}
    value, sigma, log_odds, _ = np.transpose([*every.values()] or np.zeros((1, 4)))
    if np.ptp(value) > 3.0 * math.hypot(*sigma) or not named:
        return named
    return {"": [*every.values()][int(np.argmax(log_odds))]}


def _offset(run: Run, axle: str, known: float | None) -> _Offset | None:
    """The offset that the wheels of an axle would have, with a radius that is ``known`` or not [m].

    None where a log is too short to tell, or the offset leaves too much of it, as of locked wheels.
    """
    v, omega, z = _means(run, axle)
    if v.size < _FEWEST:
        return None
    R, (slip, sigma) = known or NOMINAL_RADIUS, np.transpose(_SLIP)
    slips = (z * omega, z**2 * omega, z**3 * omega, 1e-4 * omega**3)
    A = R * np.stack([omega, -np.ones_like(omega), *slips, G / R * z], axis=1)
    usual = np.array([1.0, 0.0, *slip, 0.0])
    left = v - A @ np.linalg.lstsq(A, v, rcond=None)[0]
    noise = math.sqrt(_LASTING * float(left @ left) / (v.size - usual.size)) + _FINEST
    rows, r = A / noise, (v - A @ usual) / noise

    def model(radius: float, offset: float) -> tuple[float, Array, Array]:
        return _posterior(rows, r, np.array([radius, offset, *sigma, _LATE]))

    same = _FILE if known else _USUAL
    others = [model(same, _SMALL)[0], *(model(other, _SMALL)[0] + _RARE for other in _OTHER)]
    log, x, error = model(same, _LARGE)
    rest = r - rows @ x
    if _LASTING * float(rest @ rest) > _EXPLAINED * v.size:
        return None
    odds = log + _RARER - float(np.logaddexp.reduce(others))
    return _Offset(float(x[1]), float(error[1]), odds, float(R * (1.0 + x[0])))


def _means(run: Run, axle: str) -> tuple[Array, Array, Array]:
    """Means of v, wheel speed and z over 0.1 s in which the car moves and no engine drives it."""
    d, size = run.driving, max(1, round(SMOOTH / run.driving.step))
    inside = d.moving & (d.z > -DRIVEN) & (d.z < GREATEST)
    use = block_mean(np.where(inside, 1.0, 0.0), size) == 1.0
    omega = 0.5 * (run.log[f"omega_{axle}l"] + run.log[f"omega_{axle}r"])
    v, omega, z = (block_mean(x, size)[use] for x in (run.log["v"], omega, d.z))
    return v, omega, z


def _posterior(rows: Array, r: Array, prior: Array) -> tuple[float, Array, Array]:
    """ln of the evidence of r = rows x + e, with x and its sigma, by the sigma before it is seen.

    e is white, of variance 1.
    """
    B = rows * prior
    M = np.eye(prior.size) + B.T @ B
    x = np.linalg.solve(M, B.T @ r)
    log = -0.5 * float(r @ r - r @ B @ x + np.linalg.slogdet(M)[1])
    return log, prior * x, prior * np.sqrt(np.diag(np.linalg.inv(M)))
