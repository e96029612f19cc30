"""One tyre curve for both axles, written as compliance: slip over normalised force.

(15) and (16) say that one f gives F_f = f(lambda_f) and F_r = f(lambda_r). Here is its inverse:

    slip = exp(c - s) (2 F_z/W)^q F (1 + b2 u + b3 u^2),   u = F w

c = ln of the compliance at the table's surface, b2 and b3 its curvature, q the load exponent
(compliance per load grows with the load); s and w are the surface: ln of its stiffness relative
to the table's, and the table's peak relative to its own. The similarity in w follows Pacejka (Tyre
and Vehicle Dynamics, ch. 4): a lower peak shrinks the curve along both axes.

In this form the noisy measurement (slip, from wheel speeds) is the response and the well-known
force is the regressor, so that noise does not bias the fit. Valid on the rising branch: slip must
grow with force, so the curve ends at the peak of the tyre.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array

PARAMETERS = ("log_compliance", "curvature_2", "curvature_3", "load_exponent")


@dataclass(frozen=True)
class Tyre:
    """Parameters of the compliance [1].

    ``log_compliance`` c, ``curvature_2`` b2, ``curvature_3`` b3, ``load_exponent`` q, surface
    ``log_stiffness`` s and ``peak_ratio`` w.
    """

    log_compliance: float
    curvature_2: float
    curvature_3: float
    load_exponent: float
    log_stiffness: float = 0.0
    peak_ratio: float = 1.0

    def slip(self, force: Array, relative_load: Array | float) -> Array:
        """Slip [1] at the normalised ``force`` [1]; ``relative_load``: axle load over W/2 [1]."""
        return self.slip_at(force, self.gain(relative_load))

    def slope(self, force: Array, relative_load: Array | float) -> Array:
        """d slip/d force [1]."""
        return self.slope_at(force, self.gain(relative_load))

    def gain(self, relative_load: Array | float) -> Array:
        """Slip per normalised force at the origin [1], as a function of the load."""
        stiffness = np.exp(self.log_compliance - self.log_stiffness)
        return np.asarray(stiffness * relative_load**self.load_exponent)

    def slip_at(self, force: Array, gain: Array) -> Array:
        """`slip` where the `gain` of the load is known."""
        u = force * self.peak_ratio
        # (15), (16) solved for lambda
        slip = gain * force * (1.0 + self.curvature_2 * u + self.curvature_3 * u * u)
        return np.asarray(slip)

    def slope_at(self, force: Array, gain: Array) -> Array:
        """`slope` where the `gain` of the load is known."""
        u = force * self.peak_ratio
        slope = gain * (1.0 + 2.0 * self.curvature_2 * u + 3.0 * self.curvature_3 * u * u)
        return np.asarray(slope)


@dataclass(frozen=True)
class AxleTyres:
    """The tyres of both axles: one curve, and in what the axles may differ.

    ``log_ratio`` ln of the rear tyres' stiffness over that of the front ones [1]; ``radius_load``
    share by which a rolling radius falls when the load of its axle doubles [1].
    """

    tyre: Tyre
    log_ratio: float = 0.0
    radius_load: float = 0.0

    def slips(
        self, forces: tuple[Array, Array], loads: tuple[Array, Array], at_rest: tuple[float, float]
    ) -> tuple[Array, Array]:
        """Slips of the axles [1] that their wheel speeds show, against the radii at rest.

        ``forces`` normalised [1], ``loads`` [N], front and rear, (n,); ``at_rest`` static loads
        [N]. The radius of a loaded wheel is R exp(-radius_load (F_z/F_z0 - 1)): a wheel whose
        radius fell turns faster, and shows less slip than its tyre has.
        """
        half = 0.5 * sum(at_rest)
        out = []
        for force, load, rest, sign in zip(forces, loads, at_rest, (0.5, -0.5), strict=True):
            slip = self.tyre.slip(force, load / half) * np.exp(sign * self.log_ratio)
            shown = np.exp(self.radius_load * (load / rest - 1.0))
            out.append(np.asarray(1.0 - (1.0 - slip) * shown))
        return out[0], out[1]

    def on_the_curve(
        self, shown: tuple[Array, Array], loads: tuple[Array, Array], at_rest: tuple[float, float]
    ) -> tuple[Array, Array]:
        """Slips [1] of the common tyre at half the weight from the ``shown`` ones of the axles.

        The inverse of `slips`: both axles then lie on one curve over the force. Arguments as there.
        """
        half = 0.5 * sum(at_rest)
        out = []
        for seen, load, rest, sign in zip(shown, loads, at_rest, (0.5, -0.5), strict=True):
            slip = 1.0 - (1.0 - seen) / np.exp(self.radius_load * (load / rest - 1.0))
            softer = (load / half) ** self.tyre.load_exponent * np.exp(sign * self.log_ratio)
            out.append(np.asarray(slip / softer))
        return out[0], out[1]
