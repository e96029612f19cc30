"""What no effect explains: where it acts, on what it depends, and how much of it a term follows.

A term cannot follow what goes with the angle of the wheels, which start at another angle in every
run: the share of that is computed from its harmonics. Nor can it follow what swings with a
frequency of its own: that share is computed from the spectrum. A term shows a brake torque that
something holds, though not what does.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import PLACES
from calib.diagnosis.explanation.channels import CHANNELS, by_channel, thinned
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.proof.oscillation import Oscillation, oscillation_of, power_of

WHEEL_ANGLE, FREQUENCY, SLIP = "wheel_angle", "frequency", "slip"
"""Drivers that no term has."""

_HARMONICS = (1, 2)
"""Harmonics of the wheel's turn; run-out and uneven spacing show in the first ones."""

_HELD = 0.5
"""Rise of a brake torque with the pressure, over that before, below which something holds it. From
knot to knot: it may be held from the middle on."""

_PLAIN = 0.03
"""Share of the excess that a term must explain beyond one that holds a brake torque, which is a
single number, to be preferred to it."""

_ONE_SIDED = 0.3
"""Share of the excess that a lasting difference of left and right takes from which one wheel of an
axle is named."""

_NO_TERM = 0.1
"""Share of the excess that must go with the angle of the wheels, or swing, to be told as that."""


@dataclass(frozen=True)
class Unexplained:
    """The empirical term that explains most of what is left.

    ``at`` the explanation with the term; ``axle`` it acts on; ``explained`` share of the excess, at
    most 1; ``runners_up`` as (place, driver, share); ``driver`` the variable it depends on: the
    term's, `WHEEL_ANGLE` where ``turning``, the share that goes with the angle of the wheels, is
    larger, `FREQUENCY` where that of ``oscillation`` is, or `SLIP` where the torque of front brakes
    is held: no valve does that; ``wheel`` the one that is slower than the other wheel of its axle,
    where that is most of the excess.
    """

    at: Explanation
    axle: str
    driver: str
    explained: float
    turning: float
    oscillation: Oscillation
    wheel: str | None
    runners_up: tuple[tuple[str, str, float], ...]

    @property
    def term(self) -> EmpiricalTerm:
        """The term as it was fitted."""
        return self.at.effects.terms[0]

    @property
    def place(self) -> str:
        """Where it acts, one of `PLACES`: that of the term, but of what swings."""
        if self.driver != FREQUENCY:
            return self.term.place
        return "body" if self.oscillation.body else "brakes"


def held_from(term: EmpiricalTerm) -> float | None:
    """Pressure [Pa] above which a brake torque hardly rises with it; None where it does rise.

    Brake control that limits the slip holds a torque so; at the rear, a valve does, too.
    """
    if not term.on_brakes or term.driver != "pressure":
        return None
    p = np.array(term.knots)
    torque = p * (1.0 + np.array(term.values))
    for i in range(2, p.size - 1):
        if np.all(np.diff(torque[i:]) < _HELD * torque[i] / p[i] * np.diff(p[i:])):
            return float(p[i])
    return None


def unexplained_of(at: Explanation, terms: Sequence[Explanation]) -> Unexplained:
    """What is left on top of ``at``, by explanations with ``terms`` beside it, best first."""
    excess = max((at.reduced - 1.0) * at.count, float(np.sqrt(2.0 * at.count)))
    shares = [(at.reduced - one.reduced) * at.count / excess for one in terms]
    held = [held_from(one.effects.terms[0]) is not None for one in terms]
    nearly = (k for k, share in enumerate(shares) if held[k] and share > shares[0] - _PLAIN)
    best = next(nearly, 0)
    term = terms[best].effects.terms[0]
    axle = PLACES[term.place]
    whitened = [dict(zip(CHANNELS, by_channel(r), strict=True)) for r in at.innovations]
    turning, turned = _turning(at, whitened, excess)
    swing = oscillation_of(whitened, excess)
    causes = (
        (max(shares[best], _NO_TERM), SLIP if held[best] and axle != "rear" else term.driver, axle),
        (turning, WHEEL_ANGLE, turned),
        (swing.share, FREQUENCY, "body" if swing.body else "both"),
    )
    _, driver, axle = max(causes, key=lambda cause: cause[0])
    others = [(one.effects.terms[0], shares[k]) for k, one in enumerate(terms) if k != best]
    return Unexplained(
        at=terms[best],
        axle=axle,
        driver=driver,
        explained=min(shares[best], 1.0),
        turning=turning,
        oscillation=swing,
        wheel=_one_sided(whitened, excess),
        runners_up=tuple((one.place, one.driver, min(share, 1.0)) for one, share in others),
    )


_Whitened = list[dict[str, Array]]
"""Innovations of each run by the name of the channel."""


def _turning(at: Explanation, whitened: _Whitened, excess: float) -> tuple[float, str]:
    """Share of the excess that goes with the angle of the front or rear wheels, and which [1]."""
    shares = {"front": 0.0, "rear": 0.0}
    for run, channels in zip(at.problem.runs, whitened, strict=True):
        for axle, angle in (("front", run.angle_f), ("rear", run.angle_r)):
            phase = np.outer(_HARMONICS, thinned(run, angle))
            for name in ("rim", "front_rear", f"{axle}_sides"):
                x = channels[name]
                shares[axle] += float(np.sum(power_of(x, phase[:, -x.size :]))) / excess
    axle = max(shares, key=lambda one: shares[one])
    return min(shares[axle], 1.0), axle


def _one_sided(whitened: _Whitened, excess: float) -> str | None:
    """The slower wheel of an axle, where it always is, and that is most of the excess; else None.

    By the share of the excess that a constant takes of left less right.
    """
    sides = {}
    for axle in ("front", "rear"):
        x = np.concatenate([channels[f"{axle}_sides"] for channels in whitened])
        sides[axle] = float(np.sum(x)) / float(np.sqrt(x.size))
    axle = max(sides, key=lambda one: abs(sides[one]))
    if sides[axle] ** 2 - 1.0 < _ONE_SIDED * excess:
        return None
    return f"{axle}_{'left' if sides[axle] < 0.0 else 'right'}"
