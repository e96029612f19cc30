"""Where an explanation comes to the ends of what its effects may be."""

import numpy as np

from calib.car.effects.effect import Parameter
from calib.car.own_effects.own_effect import definition
from calib.diagnosis.explanation.candidate import Candidate, free
from calib.diagnosis.explanation.problem import joined
from calib.diagnosis.explanation.vector import bounds, prior_rows, with_priors
from calib.diagnosis.gates import GATES


def at_bound(at: Candidate) -> tuple[str, ...]:
    """The effects of which a parameter has come to an end of its range.

    A share of one axle ends where the physics does: all of it is a result like any other. So does
    what is at its default: it need not be given.
    """
    return tuple(dict.fromkeys(name for name, _, _ in _ended(at)))


def pressed(at: Candidate) -> tuple[str, ...]:
    """The effects that a range holds: past its end a parameter would explain clearly more.

    In one linear step, with all parameters that are inside their ranges fitted again. Something
    else acts then than the effect as its card has it. A parameter that ends where it does nothing
    more, as the power of a motor that nothing limits, is not held.
    """
    ended = _ended(at)
    if not ended:
        return ()
    size = at.x.size
    J = with_priors(at.problem, at.names, at.jacobian, size)
    rest = np.concatenate([joined(at.whitened), prior_rows(at.problem, at.names, at.x)])
    inside = np.ones(size, bool)
    inside[[place for _, place, _ in ended]] = False
    directions = np.linalg.qr(J[:, inside])[0]
    held = []
    for name, place, outward in ended:
        own = free(J[:, place], directions)
        along = float(own @ rest)
        gained = along**2 / max(float(own @ own), 1e-12)
        if -along * outward > 0.0 and gained > max(GATES.pressed, GATES.parameter * at.count):
            held.append(name)
    return tuple(dict.fromkeys(held))


def divided(at: Candidate) -> tuple[str, ...]:
    """The effects that act on both axles in an odd share, as few cars' engines do."""
    return tuple(
        name
        for name in at.names
        for p in definition(at.problem.vehicle.effects, name).card.parameters
        if p.share
        and min(abs(at.effects.parameters[name][p.name] - x) for x in (p.low, p.high, p.typical))
        > GATES.divided
    )


def _ended(at: Candidate) -> list[tuple[str, int, float]]:
    """Effect, place in the vector and outward direction (1 or -1) of each ended parameter."""
    low, high = bounds(at.problem, at.names)
    margin = GATES.at_bound * np.minimum(high - low, GATES.usual_range)
    found = []
    for name, own in at.problem.places(at.names).items():
        parameters = definition(at.problem.vehicle.effects, name).card.parameters
        for place, p in zip(range(own.start, own.stop), parameters, strict=True):
            below, above = at.x[place] < (low + margin)[place], at.x[place] > (high - margin)[place]
            default = _is_default(p, at.effects.parameters[name][p.name])
            if (below or above) and not (p.share or default):
                found.append((name, place, 1.0 if above else -1.0))
    return found


def _is_default(parameter: Parameter, value: float) -> bool:
    if parameter.default is None:
        return False
    return abs(value - parameter.default) < GATES.at_bound * (parameter.high - parameter.low)
