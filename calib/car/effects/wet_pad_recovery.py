"""Wet pads: a loss of friction that recovers while the heat of braking dries the brake."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory


def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 - a exp(-E/E_0) [1], each axle with its own heat E of one brake [J].

    ``wet_loss`` is the loss at the first sample of every run. A rear brake has less disc and pad to
    dry: ``dry_rear_share`` of the energy; all of it where it is not given, as in older files. Not
    valid if water comes later.
    """
    loss, dry = parameters["wet_loss"], parameters["dry_energy"]
    dry_rear = dry * parameters.get("dry_rear_share", 1.0)
    front = 1.0 - loss * np.exp(-history.energy_f / dry)
    return front, 1.0 - loss * np.exp(-history.energy_r / dry_rear)


EFFECT = Effect(
    card=Card(
        name="wet_pad_recovery",
        cause="a film of water on disc and pads that the heat of braking removes",
        equation=(
            "mu_p (1 - a exp(-E/E_0)), E heat of one brake, E_0 less at the rear; "
            "no effect at wet_loss = 0"
        ),
        source="Breuer and Bill, Brake Technology Handbook",
        looks_like="weak brakes at the first application that recover with energy, not with time",
        parameters=(
            Parameter("wet_loss", "1", 0.0, 0.95, 0.3, 0.15),
            Parameter("dry_energy", "J", 1e3, 1e6, 60e3, 40e3),
            Parameter("dry_rear_share", "1", 0.2, 2.0, 0.8, 0.3, default=1.0),
        ),
    ),
    friction=friction,
)
