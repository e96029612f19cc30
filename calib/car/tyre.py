"""The tyre of a model: Pacejka's Magic Formula with its inverse.

    F ^        ____ peak mu          F      = mu sin(C atan(B x)),  B = K/(C mu)
      |     .-'    `-.__             lambda = (1 + b B x) x s
      |   .'            `--          B x    = tan(asin(F/mu)/C)   the inverse
      |  / slope K
      +-/----------------> lambda

F is the tyre force over the load F_z of the axle, lambda the slip. At a load of half the weight W
the tyre has K and mu, and lambda = x if there is no bend (b = 0). At the load F_z, the slip is
multiplied by s = (2 F_z/W)^q and mu by (2 F_z/W)^-p. The formula F(x) is straight near zero slip,
and the bend b curves it there. A brush model has F = K lambda (1 - K lambda/(3 mu) + ...), since
the rear end of its contact patch slides even at very small slip: this is b = C/3.

This is the steady state. The force builds up over the relaxation length sigma, so the slip of the
wheel is larger than the slip that carries the force by (sigma/v) dlambda/dt.

Source: Pacejka, Tyre and Vehicle Dynamics, ch. 4, pure longitudinal slip without the E term and
offsets; ch. 3 for the brush; ch. 7 for the relaxation length.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.car.braking import MOVING


@dataclass(frozen=True)
class MagicFormula:
    """A tyre."""

    stiffness: float  # K = dF/dlambda at zero slip and half the weight on the axle [1]
    peak: float  # mu, the largest normalised force at half the weight on the axle [1]
    shape: float = 1.65  # C [1], between 1 (never falls) and 2 (falls to zero)
    load_exponent: float = 0.0  # q [1]
    bend: float = 0.0  # b [1], not negative
    relaxation: float = 0.0  # sigma [m], not negative
    peak_exponent: float = 0.0  # p [1]

    def peak_at(self, relative_load: Array | float) -> Array | float:
        """The largest normalised force [1]; ``relative_load`` is axle load over half the weight."""
        return self.peak * relative_load**-self.peak_exponent if self.peak_exponent else self.peak

    def force(self, slip: Array, relative_load: Array | float = 1.0) -> Array:
        """Normalised force F [1] at braking ``slip`` [1]; ``relative_load`` as in `peak_at`.

        F is odd in the slip, and valid beyond the peak too, but not for a locked, hot wheel.
        """
        peak = self.peak_at(relative_load)
        bx = self._bx_at(slip / self._load_factor(relative_load), peak)
        return peak * np.sin(self.shape * np.arctan(bx))

    def slope(self, slip: Array, relative_load: Array | float = 1.0) -> Array:
        """dF/dlambda [1]: K/s at zero slip, zero at the peak, negative beyond it."""
        load_factor = self._load_factor(relative_load)
        bx = self._bx_at(slip / load_factor, self.peak_at(relative_load))
        return self._slope(bx, np.cos(self.shape * np.arctan(bx)), load_factor)

    def slip_at_force(
        self, force: Array, relative_load: Array | float = 1.0, edge: float = 1.0
    ) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Slip [1] at the normalised ``force`` [1] on the rising branch, and dF/dlambda [1] there.

        Forces above the share ``edge`` of the peak are cut; the third result is their mask.
        """
        peak, load_factor = self.peak_at(relative_load), self._load_factor(relative_load)
        share = force / peak
        is_beyond = np.abs(share) >= edge
        sine = np.clip(share, -edge, edge) if is_beyond.any() else share
        bx = np.tan(np.arcsin(sine) / self.shape)
        slope = self._slope(bx, np.sqrt(1.0 - sine * sine), load_factor)
        return self._slip_of(bx, peak, load_factor), slope, is_beyond

    def wheel_slip(self, slip: Array, v: Array, time: Array) -> Array:
        """Slip [1] (n,) of the wheel while ``slip`` (n,) carries the force, by the relaxation.

        ``time`` [s] (n,); ``v`` [m/s] (n,) counts as at least `MOVING`. Valid for slow changes of
        the slip; not near the peak, where the relaxation length falls.
        """
        if self.relaxation == 0.0:
            return slip
        lag = self.relaxation / np.maximum(v, MOVING)
        return np.asarray(slip + lag * np.gradient(slip, time))

    def slip_at(self, fraction: float, relative_load: Array | float = 1.0) -> Array:
        """Slip [1] at which C atan(B x) = ``fraction`` pi/2; the peak has the fraction 1."""
        bx = np.tan(0.5 * np.pi * fraction / self.shape)
        return self._slip_of(bx, self.peak_at(relative_load), self._load_factor(relative_load))

    def on_surface(self, stiffness_factor: float, peak_factor: float) -> Self:
        """Return the tyre on another surface: stiffness and peak multiplied by factors [1]."""
        stiffness, peak = self.stiffness * stiffness_factor, self.peak * peak_factor
        return replace(self, stiffness=stiffness, peak=peak)

    def _slope(self, bx: Array, cosine: Array, load_factor: Array | float) -> Array:
        """dF/dlambda at B x, where C atan(B x) has this cosine."""
        without_bend = self.stiffness / load_factor * cosine / (1.0 + bx * bx)
        return np.asarray(without_bend / (1.0 + 2.0 * self.bend * np.abs(bx)))

    def _b(self, peak: Array | float) -> Array | float:
        return self.stiffness / (self.shape * peak)

    def _bx_at(self, slip: Array, peak: Array | float) -> Array:
        """B x at the ``slip`` over s, from (1 + b B x) B x = B slip in a form that allows b = 0."""
        b_slip = self._b(peak) * slip
        return b_slip * 2.0 / (1.0 + np.sqrt(1.0 + 4.0 * self.bend * np.abs(b_slip)))

    def _slip_of(self, bx: Array | float, peak: Array | float, load_factor: Array | float) -> Array:
        x = bx * (1.0 + self.bend * np.abs(bx)) / self._b(peak)
        return np.asarray(x * load_factor)

    def _load_factor(self, relative_load: Array | float) -> Array | float:
        return relative_load**self.load_exponent if self.load_exponent else 1.0
