"""Tyres: Pacejka's Magic Formula, with its inverse, and the forms that a fit takes.

    F ^        ____ peak mu          F      = mu sin(C atan(B x)),  B = K/(C mu)
      |     .-'    `-.__             lambda = s/B tan(asin(F/mu)/C)
      |   .'            `--          x = lambda/s,  s = (2 F_z/W)^q
      |  / slope K
      +-/----------------> lambda

Stiffness per load falls with the load by the exponent q, the peak as (2 F_z/W)^-p. The formula has
no curvature at zero slip; a brush has, since its contact patch slides at once at its end: F = K
lambda (1 - K lambda/(3 mu) + ...). The bend b adds it, lambda = (1 + b B x) x s, with b = C/3 for a
brush.

This is the steady state. The force builds up over the relaxation length sigma, so the slip leads
that of the force by (sigma/v) dlambda/dt.

Source: Pacejka, Tyre and Vehicle Dynamics, ch. 4, pure longitudinal slip without the E term and
offsets; ch. 3 for the brush; ch. 7 for the relaxation length.

The forms, each as its inverse in closed form:

    slip = c m X(u)        u = F/m,  X(u) -> u as u -> 0        0 <= u < 1

with the compliance c at small slip, the peak m and the normalised force F: Pacejka's similarity
(Tyre and Vehicle Dynamics, ch. 4). A tyre is a weighted mean of these inverses. The published forms
bound those of real tyres from a third of the peak on. Valid on the rising branch only.

    brush          1 - (1 - x/3)^3            3 (1 - (1 - u)^(1/3))
    exponential    1 - e^-x                   -ln(1 - u)                    Burckhardt, without fall
    Dugoff         x, then 1 - 1/(4 x)        u, then 1/(4 (1 - u))         Dugoff et al. 1970
    magic_sharp    sin(C atan(x/C)), 1.65     C tan(asin(u)/C)              Pacejka, E = 0
    magic_round    the same with 1.25
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.car.braking import MOVING


@dataclass(frozen=True)
class MagicFormula:
    """One tyre, common to both axles. Stiffness and peak are scalars or broadcast with the slip.

    Attributes
    ----------
    stiffness : K = dF/dlambda at zero slip and half the weight on the axle [1].
    peak : mu, the largest normalised force [1].
    shape : C [1], between 1 (never falls) and 2 (falls to zero).
    load_exponent, peak_exponent : q, p [1].
    bend : b [1], not negative.
    relaxation : sigma [m], not negative.
    """

    stiffness: float | Array
    peak: float | Array
    shape: float = 1.65
    load_exponent: float = 0.0
    bend: float = 0.0
    relaxation: float = 0.0
    peak_exponent: float = 0.0

    def peak_at(self, relative_load: Array | float) -> Array | float:
        """The largest normalised force [1] at an axle load over half the weight [1]."""
        return self.peak * relative_load**-self.peak_exponent if self.peak_exponent else self.peak

    def force(self, slip: Array, relative_load: Array | float = 1.0) -> Array:
        """Normalised force F [1] at braking ``slip`` [1], axle load over half the weight [1].

        Odd in the slip. Valid beyond the peak too, but not for the heat of a locked wheel.
        """
        peak = self.peak_at(relative_load)
        bx = self._without_bend(slip / self._load_factor(relative_load), peak)
        return peak * np.sin(self.shape * np.arctan(bx))

    def slope(self, slip: Array, relative_load: Array | float = 1.0) -> Array:
        """dF/dlambda [1]: K at zero slip, zero at the peak, negative beyond it."""
        load = self._load_factor(relative_load)
        bx = self._without_bend(slip / load, self.peak_at(relative_load))
        return self._slope(bx, np.cos(self.shape * np.arctan(bx)), load)

    def rising(
        self, force: Array, relative_load: Array | float = 1.0, edge: float = 1.0
    ) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Slip of the normalised ``force`` on the rising branch, dF/dlambda there, all [1].

        And whether the force is beyond the share ``edge`` of the peak; it then counts as that.
        """
        peak, load = self.peak_at(relative_load), self._load_factor(relative_load)
        share = force / peak
        beyond = np.abs(share) >= edge
        sine = np.clip(share, -edge, edge) if beyond.any() else share
        bx = np.tan(np.arcsin(sine) / self.shape)
        slope = self._slope(bx, np.sqrt(1.0 - sine * sine), load)
        return self._with_bend(bx, peak, load), slope, beyond

    def leading(self, slip: Array, v: Array, time: Array) -> Array:
        """Slip [1] (n,) that the wheel has while ``slip`` (n,) carries the force.

        ``v`` [m/s] (n,), at least `MOVING`; ``time`` [s] (n,). Valid for a lag that is short
        against the changes of the slip, and not near the peak, where the way grows shorter.
        """
        if self.relaxation == 0.0:
            return slip
        way = self.relaxation / np.maximum(v, MOVING)
        return np.asarray(slip + way * np.gradient(slip, time))

    def slip_at(self, fraction: float, relative_load: Array | float = 1.0) -> Array:
        """Slip [1] where C atan(B x) is ``fraction`` of pi/2; 1 is the peak itself."""
        bx = np.tan(0.5 * np.pi * fraction / self.shape)
        return self._with_bend(bx, self.peak_at(relative_load), self._load_factor(relative_load))

    def on_surface(self, stiffness_factor: Array | float, peak_factor: Array | float) -> Self:
        """Return the tyre on another surface: stiffness and peak times these factors [1]."""
        return replace(
            self,
            stiffness=self.stiffness * stiffness_factor,
            peak=self.peak * peak_factor,
        )

    def _b(self, peak: Array | float) -> Array | float:
        return self.stiffness / (self.shape * peak)

    def _slope(self, bx: Array, cosine: Array, load_factor: Array | float) -> Array:
        """dF/dlambda where the formula has B x, and the cosine of C atan(B x)."""
        straight = self.stiffness / load_factor * cosine / (1.0 + bx * bx)
        return np.asarray(straight / (1.0 + 2.0 * self.bend * np.abs(bx)))

    def _without_bend(self, slip: Array, peak: Array | float) -> Array:
        """B x of the formula at a slip for half the weight; the stable root of its square."""
        bx = self._b(peak) * slip
        return bx * 2.0 / (1.0 + np.sqrt(1.0 + 4.0 * self.bend * np.abs(bx)))

    def _with_bend(
        self, bx: Array | float, peak: Array | float, load_factor: Array | float
    ) -> Array:
        """Slip where the formula has B x."""
        x = bx * (1.0 + self.bend * np.abs(bx)) / self._b(peak)
        return np.asarray(x * load_factor)

    def _load_factor(self, relative_load: Array | float) -> Array | float:
        return relative_load**self.load_exponent if self.load_exponent else 1.0


FORMS = ("brush", "exponential", "dugoff", "magic_sharp", "magic_round")
"""Names of the forms, in the order of `inverse_forms`."""

NEAR_PEAK = 0.97
"""Share of its peak above which a tyre no longer counts as rolling [1]."""


def inverse_forms(use: Array) -> Array:
    """X of each form at the used share of the peak ``use`` [1] (...), shape (..., 5).

    Above `NEAR_PEAK` it is the value there: the caller leaves such forces out.
    """
    u = np.clip(use, 0.0, NEAR_PEAK)
    angle = np.arcsin(u)
    return np.stack(
        [
            3.0 * (1.0 - np.cbrt(1.0 - u)),
            -np.log1p(-u),
            np.where(u < 0.5, u, 0.25 / (1.0 - u)),
            1.65 * np.tan(angle / 1.65),
            1.25 * np.tan(angle / 1.25),
        ],
        axis=-1,
    )


_NODES = 2048
_Q_END = np.sqrt(1.0 - NEAR_PEAK)
_USE = 1.0 - np.linspace(1.0, _Q_END, _NODES + 1) ** 2
_OVER_USE = np.vstack([np.ones(len(FORMS)), inverse_forms(_USE[1:]) / _USE[1:, None]]).T.copy()
_RISE = np.diff(_OVER_USE, axis=1)


def mean_inverse(use: Array, weights: Array) -> Array:
    """X of tyres with ``weights`` (n, 5) of the forms, at ``use`` (n, k) [1]; odd in ``use``.

    X/u is interpolated linearly over the root of 1 - u: faster than the forms, and within 1e-5.
    """
    u = np.minimum(np.abs(use), NEAR_PEAK)
    position = (1.0 - np.sqrt(1.0 - u)) * (_NODES / (1.0 - _Q_END))
    cell = np.minimum(position.astype(np.int64), _NODES - 1)
    position -= cell
    mean = np.zeros_like(u)
    for over, rise, weight in zip(_OVER_USE, _RISE, weights.T, strict=True):
        form = rise.take(cell)  # in place: one form at a time stays in the cache
        form *= position
        form += over.take(cell)
        form *= weight[:, None]
        mean += form
    return np.asarray(np.copysign(u, use) * mean)
