"""Wet pads: friction that is missing at first and comes back as the brake dries itself."""

import numpy as np

from calib.physics.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import RunHistory


def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 - a exp(-E/E_0) [1], each axle with its own heat E of one brake [J].

    Every run begins as wet as ``wet_loss`` says; water that comes later is not covered.
    """
    loss, dry = parameters["wet_loss"], parameters["dry_energy"]
    front, rear = (1.0 - loss * np.exp(-E / dry) for E in (history.energy_f, history.energy_r))
    return front, rear


EFFECT = Effect(
    card=Card(
        name="wet_pad_recovery",
        cause="a film of water on disc and pads, driven off by the heat of braking",
        equation="mu_p (1 - a exp(-E/E_0)), E heat of one brake; nothing at wet_loss = 0",
        source="Breuer and Bill, Brake Technology Handbook",
        looks_like="weak brakes at the first application, recovering with energy and not with time",
        parameters=(
            Parameter("wet_loss", "1", 0.0, 0.95, 0.3, 0.15),
            Parameter("dry_energy", "J", 1e3, 1e6, 60e3, 40e3),
        ),
    ),
    friction=friction,
)
