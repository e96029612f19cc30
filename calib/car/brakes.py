"""The brake torque of each wheel, from the pressure of the master cylinder.

    p_mc --line_pressure--> wheel pressure --caliper_pressure--> clamping pressure
    clamping pressure --pads--> pad friction --brake_torque (2) (3), wheel_factors--> T_b

A logged wheel pressure replaces the result of `line_pressure`. The right wheel of an axle is
computed only where wheel pressures or an effect make it differ from the left wheel.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from calib.base.arrays import Array
from calib.base.names import WHEELS
from calib.car import forces
from calib.car.effects.combined import caliper_pressure, line_pressure, pad_factors, wheel_factors
from calib.car.effects.effect import Pair
from calib.car.history import RunHistory
from calib.car.model import Model
from calib.car.vehicle import Axle


@dataclass(frozen=True)
class Brakes:
    """The brakes in one run: the ``model``, and clamping pressures [Pa] (n,) of computed wheels."""

    model: Model
    clamp: dict[str, Array]

    def twin(self, w: str) -> str:
        """The computed wheel that stands for ``w``: itself, or the left wheel of its axle."""
        return w if w in self.clamp else f"{w[0]}l"

    def axle(self, w: str) -> Axle:
        """Return the axle of a wheel."""
        return self.model.vehicle.front if w[0] == "f" else self.model.vehicle.rear

    def pads(self, history: RunHistory, side: str = "l") -> Pair:
        """Friction of the front and the rear pads [1] (n,) on the left ("l") or right side."""
        p_f, p_r = self.clamp[self.twin(f"f{side}")], self.clamp[self.twin(f"r{side}")]
        front, rear = pad_factors(self.model.effects, history, p_f, p_r)
        return self.model.pad_friction_f * front, self.model.pad_friction_r * rear

    def torques(self, history: RunHistory) -> dict[str, Array]:
        """Brake torque [N m] (n,) of the computed wheels."""
        factors = wheel_factors(self.model.effects, history)
        sides = {w[1] for w in self.clamp}  # "l", and "r" where right wheels are computed
        pads = {side: self.pads(history, side) for side in sides}
        torques = {}
        for w, p in self.clamp.items():
            front, rear = pads[w[1]]
            T_b = forces.brake_torque(self.axle(w), front if w[0] == "f" else rear, p)  # (2), (3)
            torques[w] = T_b * factors[w] if w in factors else T_b
        return torques


def brakes_of(model: Model, history: RunHistory, logged: Mapping[str, Array]) -> Brakes:
    """Return the brakes at the pressure of ``history``, or at ``logged`` pressures [Pa] by wheel.

    A wheel pressure is measured behind the line, so only effects of the caliper act on it.
    """
    effects = model.effects
    p_f, p_r = line_pressure(effects, history)
    wheel_pressure = {"fl": p_f, "fr": p_f, "rl": p_r, "rr": p_r, **logged}
    uneven_axles = {w[0] for w in wheel_factors(effects, history)}
    computed = [w for w in WHEELS if w[1] == "l" or logged or w[0] in uneven_axles]
    clamp: dict[str, Array] = {}
    for side in {w[1] for w in computed}:
        front, rear = f"f{side}", f"r{side}"
        pressures = wheel_pressure[front], wheel_pressure[rear]
        clamp[front], clamp[rear] = caliper_pressure(effects, history, *pressures)
    return Brakes(model, {w: clamp[w] for w in computed})
