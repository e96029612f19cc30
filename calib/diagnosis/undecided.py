"""What the logs cannot tell, and for each such question the drive that would tell it best.

    columns of the logs + columns of a manoeuvre --> less what pads, tyres, effects do --> sigma

One linear step: right for small effects, and the order of magnitude for large ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, compress

import numpy as np

from calib.base.arrays import Array
from calib.base.names import WHEELS, G
from calib.car.effects.catalogue import every_effect
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.columns import seen
from calib.diagnosis.explanation.explanation import Explanation, innovations
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.own import OWN
from calib.diagnosis.explanation.predict import ObservedRun, run_of
from calib.logs.log import Log

_SHOWN = 5.0  # size [sigma] from which logs show an effect: ln of the odds is 7, its price is 5
_CLEAR = 10.0  # size [sigma] from which a drive shows it surely

_TESTS = {
    # first speed [m/s], pressure [bar], its rise [bar/s], period of its applications [s]
    "coast down from 130 km/h": (36.0, 0.0, 1e9, 12.0),
    "coast down from 50 km/h": (14.0, 0.0, 1e9, 12.0),
    "slow ramp to 45 bar": (33.0, 45.0, 5.0, 12.0),
    "light stop at 8 bar from 60 km/h": (17.0, 8.0, 1e9, 12.0),
    "hard stop at 45 bar from 120 km/h": (33.0, 45.0, 1e9, 12.0),
    "applications of 20 bar, 1 s on and 1 s off": (30.0, 20.0, 1e9, 2.0),
}
"""Tests that any proving ground can do; an application begins after 1 s."""


@dataclass(frozen=True)
class Alike:
    """Effects, the mean squared innovation that they leave [1], and how far behind the best's."""

    effects: tuple[str, ...]
    innovation: float
    behind: float


@dataclass(frozen=True)
class Pair:
    """Two explanations by their places, and how far they are apart, in sigma of all innovations.

    In the calibration logs, and in ``drive``, the manoeuvre that tells them apart best.
    """

    between: tuple[int, int]
    apart_in_logs: float
    drive: str
    apart_in_drive: float
    unit: str = "sigma"


@dataclass(frozen=True)
class Confusion:
    """Explanations that the logs cannot tell apart, the best first, with every pair of them."""

    explanations: tuple[Alike, ...]
    pairs: tuple[Pair, ...]


@dataclass(frozen=True)
class Size:
    """A size of a parameter in ``unit``."""

    value: float
    unit: str


@dataclass(frozen=True)
class ShowingDrive:
    """The manoeuvre ``drive`` in which an ``effect`` shows most; ``usual_size`` by parameter.

    ``sigma`` is what no other parameter can imitate there, over the noise; ``clear`` whether the
    drive would show the effect, and not only show it best.
    """

    effect: str
    usual_size: dict[str, Size]
    drive: str
    sigma: float
    clear: bool


def confusion_of(best: Explanation, like: Sequence[Explanation]) -> Confusion | None:
    """The best explanation with those that are ``like`` it; None if there are none."""
    if not like:
        return None
    members, pairs = (best, *like), []
    for (i, one), (j, other) in combinations(enumerate(members), 2):
        apart = np.concatenate(one.innovations) - np.concatenate(other.innovations)
        ((drive, sigma),) = best_drives(one, [(other.base, other.effects)])
        pairs.append(Pair((i, j), float(np.linalg.norm(apart)), drive, sigma))
    alike = (Alike(e.names, e.reduced, e.reduced - best.reduced) for e in members)
    return Confusion(tuple(alike), tuple(pairs))


def drives(at: Explanation) -> tuple[ShowingDrive, ...]:
    """The best drive for each effect that the logs could not have shown at its usual size.

    On top of what explains them. Effects that the vehicle file has are known, and not among them.
    """
    every = every_effect(at.problem.vehicle.effects)
    cards = [effect.card for name, effect in every.items() if name not in at.effects]
    others = [(at.base, at.effects.with_(Effects({card.name: card.usual}))) for card in cards]
    unseen = _sizes(at, _products(at, others)) < _SHOWN
    out = []
    found = best_drives(at, [*compress(others, unseen)])
    for card, (drive, sigma) in zip(compress(cards, unseen), found, strict=True):
        size = {name: Size(value, card.units[name]) for name, value in card.usual.items()}
        out.append(ShowingDrive(card.name, size, drive, sigma, clear=sigma > _CLEAR))
    return tuple(out)


def best_drives(at: Explanation, others: Sequence[tuple[Base, Effects]]) -> list[tuple[str, float]]:
    """For each of the ``others`` the manoeuvre that tells it best from ``at``.

    And how far apart they are in the logs and in that together [sigma].
    """
    if not others:
        return []
    problem = replace(at.problem, runs=manoeuvres(at))
    state = replace(at.state, own=np.zeros((len(problem.runs), len(OWN))))
    driven, logs = seen(problem, at.hypothesis, state), _products(at, others)
    shown = np.stack([_sizes(at, [*logs, test]) for test in _products(driven, others)])
    best = [problem.runs[i].source for i in np.argmax(shown, axis=0)]
    return list(zip(best, np.max(shown, axis=0).tolist(), strict=True))


def _products(at: Explanation, others: Sequence[tuple[Base, Effects]]) -> list[Products]:
    """Inner products of each log, with what the ``others`` change behind its own columns."""
    changes = [
        np.stack([innovations(at.problem, *other, run, lag) - r for other in others])
        for run, lag, r in zip(at.runs, at.lags(), at.innovations, strict=True)
    ]
    return at.products_with(changes)


def _sizes(at: Explanation, products: list[Products]) -> Array:
    """Sizes of the columns behind those of ``at``, beyond what these can imitate [sigma]."""
    E, _ = at.marginal(products).beyond()
    return np.sqrt(np.maximum(np.diag(E), 0.0))


def manoeuvres(at: Explanation) -> tuple[ObservedRun, ...]:
    """The `_TESTS` with a rough course of speed: 70 bar give 1 g."""
    warm, out = at.problem.runs[0].temperature_f is not None, []
    time = 0.01 * np.arange(1200)
    for name, (v0, most, rise, period) in _TESTS.items():
        p = 1e5 * np.clip(rise * (time % period - 1.0), 0.0, most)
        z = p / 70e5
        v = np.maximum(v0 - 0.01 * np.cumsum(z * G), 2.0)
        channels = {"time": time, "p_mc": p, "a_x": -z * G, "v": v}
        turn, heat = v / at.problem.vehicle.front.rolling_radius, 100.0 + 0.3 * (v0**2 - v**2)
        channels |= {f"omega_{wheel}": turn for wheel in WHEELS}
        channels |= dict.fromkeys(("T_disc_f", "T_disc_r") if warm else (), heat)
        out.append(run_of(Log(name, name, "", channels)))
    return tuple(out)
