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
from calib.diagnosis.proof.oscillation import Oscillation, oscillation_of

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
"""Share of the excess in left less right from which one wheel of an axle is named."""

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
    nearly = [k for k, share in enumerate(shares) if held[k] and share > shares[0] - _PLAIN]
    best = nearly[0] if nearly else 0
    term = terms[best].effects.terms[0]
    whitened = [by_channel(r) for r in at.innovations]
    turning, axle = _turning(at, whitened, excess)
    swing = oscillation_of(whitened, excess)
    least = max(shares[best], _NO_TERM)
    driver, acts_on = term.driver, PLACES[term.place]
    if held[best] and acts_on != "rear":
        driver = SLIP
    if turning > max(least, swing.share):
        driver, acts_on = WHEEL_ANGLE, axle
    elif swing.share > least:
        driver, acts_on = FREQUENCY, "body" if swing.body else "both"
    others = [(k, one.effects.terms[0]) for k, one in enumerate(terms) if k != best]
    return Unexplained(
        at=terms[best],
        axle=acts_on,
        driver=driver,
        explained=min(shares[best], 1.0),
        turning=turning,
        oscillation=swing,
        wheel=_one_sided(at, whitened, excess),
        runners_up=tuple((one.place, one.driver, min(shares[k], 1.0)) for k, one in others),
    )


def _turning(at: Explanation, whitened: list[list[Array]], excess: float) -> tuple[float, str]:
    """Share of the excess that goes with the angle of the front or rear wheels, and which [1]."""
    shares = {}
    for axle, own in (("front", "front_sides"), ("rear", "rear_sides")):
        gain = 0.0
        for run, channels in zip(at.problem.runs, whitened, strict=True):
            angle = thinned(run, run.angle_f if axle == "front" else run.angle_r)
            for name in ("rim", "front_rear", own):
                x = channels[CHANNELS.index(name)]
                turn = np.exp(1j * np.outer(_HARMONICS, angle[-x.size :]))
                # noise alone gives two per harmonic: cosine and sine
                gain += float(np.sum(2.0 * np.abs(turn @ x) ** 2 / x.size - 2.0))
        shares[axle] = gain / excess
    best = max(shares, key=lambda axle: shares[axle])
    return min(shares[best], 1.0), best


def _one_sided(at: Explanation, whitened: list[list[Array]], excess: float) -> str | None:
    """The slower wheel of an axle, where left less right holds most of the excess; else None."""
    sides = {}
    for axle in ("front", "rear"):
        x = np.concatenate([run[CHANNELS.index(f"{axle}_sides")] for run in whitened])
        sides[axle] = (float(x @ x) - x.size, float(np.mean(x)))
    axle = max(sides, key=lambda a: sides[a][0])
    beyond, mean = sides[axle]
    if beyond < _ONE_SIDED * excess or abs(mean) * np.sqrt(at.count / len(CHANNELS)) < 5.0:
        return None
    return f"{axle}_{'left' if mean < 0.0 else 'right'}"
