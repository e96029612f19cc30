"""From the search to a verdict: what is named, what is as likely, and whether something is left.

    best fit --> replays of the hold-outs --> anything left? --> more likely by a term?
                                                        no: named          yes: unknown

Something is left where an empirical term is surely more probable, where the innovations have far
more than noise, or where the replays are far off. It is no known effect where a term alone is
surely more probable than what is named, or where that closes too little of the gap. What is left is
told by where it acts, on what it depends, and how much of it a term follows. A term cannot follow
what goes with the angle of the wheels, which start at another angle in every run, nor what swings
with a frequency of its own after every application, as liquid in a tank or a body on its springs
does. It shows a brake torque that something holds, though not what does.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import PLACES
from calib.diagnosis.explanation.channels import A_X, CHANNELS, DRIFT, STEP, by_channel, thinned
from calib.diagnosis.explanation.fit import Fit
from calib.diagnosis.replays import Replayed
from calib.diagnosis.search import SURE, Search
from calib.diagnosis.terms import PLAIN, Ranked, ranked_terms, with_terms

NO_GAP, NAMED, AMBIGUOUS, UNKNOWN = "no_gap", "named", "ambiguous", "unknown"

_STRANGE = 8.0  # scatters of the mean squared innovation from which a cause is sure
_CLOSED = 0.75  # share of the gap and of the excess that effects must close which leave something
_FAR = 3.0
"""Gap of the replays, in units of the noise, from which something is left beside what is named,
whatever innovations of one step show; twice that where nothing is named. With nothing hidden the
errors of the parameters leave up to 4.2, on a plant with other forms of tyre than here; see
tests/studies/naming.py."""

WHEEL_ANGLE, FREQUENCY, SLIP = "wheel_angle", "frequency", "slip"  # drivers that no term has

_HARMONICS = (1, 2)  # of the wheel's turn; run-out and uneven spacing show in the first ones
_HELD = 0.5  # rise of a brake torque from knot to knot, over that before, below which it is held

# shares of the excess
_ONE_SIDED = 0.3  # that a lasting difference of left and right must take to name one wheel
_NO_TERM = 0.1  # that must go with the angle of the wheels, or swing, to be told as that

_WINDOW = round(4.0 / STEP)  # innovations in a window of 4 s
_SLOWEST, _FASTEST = 2, 20
"""First and last line of its spectrum that may swing, 0.5 and 5 Hz: an error that lasts for a stop
is slower, a body on its springs swings at 1 to 2 Hz, a wheel is faster."""
_OVER = 3.0
"""Least power of a peak over that of the slower lines. What every application leaves, as a lag
does, is in all of them; a swing of 0.5 Hz or more has at most a fifth at 0.25 Hz."""


@dataclass(frozen=True)
class Verdict:
    """What a ``search`` comes to: the fit whose hold-outs are ``after``.

    ``rivals`` as likely; ``term`` the fit with the best empirical term beside it, where something
    is left.
    """

    search: Search
    after: Replayed
    rivals: tuple[Fit, ...]
    term: Fit | None

    @property
    def best(self) -> Fit:
        """What is named, or the base without effects."""
        return self.after.fit

    @property
    def word(self) -> str:
        """The verdict as in diagnosis.json."""
        if self.best.names:
            return AMBIGUOUS if self.rivals else NAMED
        return UNKNOWN if self.term else NO_GAP


def verdict_of(search: Search) -> Verdict:
    """The verdict on the ``best`` of a search, by its hold-outs."""
    base = search.base
    after, terms, beside = _standing(search)
    best = after.fit
    if not beside and search.gap(after).rms_after > (_FAR if best.names else 2.0 * _FAR):
        beside = with_terms(best, terms)
    if beside and best.names:
        alone = with_terms(base, search.terms)
        if alone[0].log_evidence > best.log_evidence + SURE:
            best, after, beside = base, search.base_replayed, alone
    rivals = search.rivals if best is search.best else ()
    return Verdict(search, after, rivals, plainest(best, beside) if beside else None)


def _standing(search: Search) -> tuple[Replayed, list[Ranked], list[Fit]]:
    """Return the last fit of a search that closes the gap of the replays, with terms beside it.

    By `_CLOSED` where something is left with it; else it must not widen the gap.
    """
    accepted = [*search.accepted]
    with suppress(ModelError):  # else the last one stands as it was accepted
        accepted[-1:] = [search.replayed(search.best)]
    for replayed in reversed(accepted):
        best = replayed.fit
        if best.names and search.widens(replayed):
            continue
        terms = ranked_terms(best)
        beside = _remaining_terms(search, best, terms)
        explained = 1.0 - (best.reduced - 1.0) / max(search.base.reduced - 1.0, 1e-9)
        if not best.names or not beside or min(search.gap(replayed).closed, explained) > _CLOSED:
            return replayed, terms, beside
    return search.base_replayed, search.terms, _remaining_terms(search, search.base, search.terms)


def _remaining_terms(search: Search, fit: Fit, terms: Sequence[Ranked]) -> list[Fit]:
    """Fits with the best of these terms, where more than noise is left; else none.

    That is where a term is surely more probable, on the hold-outs, too: no law stands behind it.
    """
    is_strange = fit.reduced > 1.01 + _STRANGE * fit.scatter
    if not is_strange and terms[0].log_gain < SURE:
        return []
    with_term, fits = with_terms(fit, terms), search.fits
    holdout_gain = fits.density(with_term[0]) - fits.density(fit)
    is_sure = (
        holdout_gain > 0.0 and with_term[0].log_evidence - fit.log_evidence + holdout_gain > SURE
    )
    return with_term if is_strange or is_sure else []


@dataclass(frozen=True)
class Oscillation:
    """The strongest line of what is left.

    ``share`` of the excess [1] that swings at ``frequency`` [Hz], 0 where no line stands out;
    ``body`` whether most of it is in a_x and v, so that the car as a whole swings.
    """

    frequency: float
    share: float
    body: bool


@dataclass(frozen=True)
class Unexplained:
    """The empirical ``term`` that explains most of what is left.

    ``driver`` is the variable that it depends on: the term's, `WHEEL_ANGLE` where ``turning``, the
    share that goes with the angle of the wheels, is larger, `FREQUENCY` where that of
    ``oscillation`` is, or `SLIP` where the torque of front brakes is held: no valve does that.
    ``place`` where it acts, one of `PLACES`, that of the term but of what swings, and the ``axle``;
    ``held_from`` the pressure [Pa] from which a brake torque is held; ``size`` rms of what replays
    without the term leave, over the noise of the sensors [1]; ``explained`` share of the excess of
    the innovations that the term takes, at most 1; ``wheel`` the one that is slower than the other
    wheel of its axle, where that is most of the excess.
    """

    place: str
    axle: str
    wheel: str | None
    driver: str
    size: float
    explained: float
    turning: float
    oscillation: Oscillation
    held_from: float | None
    term: EmpiricalTerm


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


def plainest(fit: Fit, terms: Sequence[Fit]) -> Fit:
    """The best of ``terms``, which is the first, or one of a single number that is hardly worse.

    Such a term is constant, or holds a torque.
    """
    hardly = PLAIN * _excess(fit) / fit.count

    def is_behind(described: Fit) -> bool:
        term = described.effects.terms[0]
        plain = term.driver == "constant" or held_from(term) is not None
        return not plain or described.reduced >= terms[0].reduced + hardly

    return min(terms, key=is_behind)


def _excess(fit: Fit) -> float:
    """What the sum of squares of the innovations has beyond noise, at least its scatter."""
    return max((fit.reduced - 1.0) * fit.count, float(np.sqrt(2.0 * fit.count)))


def unexplained_of(fit: Fit, with_term: Fit, size: float) -> Unexplained:
    """Describe what is left on top of ``fit``, by the fit with a term beside it."""
    excess, (term,) = _excess(fit), with_term.effects.terms
    explained = min((fit.reduced - with_term.reduced) * fit.count / excess, 1.0)
    pressure = held_from(term)
    whitened = [by_channel(r) for r in fit.innovations]
    turning, turned = _turning(fit, whitened, excess)
    swing = oscillation_of(whitened, excess)
    slips = pressure is not None and PLACES[term.place] != "rear"
    causes = (
        (max(explained, _NO_TERM), SLIP if slips else term.driver, term.place),
        (turning, WHEEL_ANGLE, term.place),
        (swing.share, FREQUENCY, "body" if swing.body else "brakes"),
    )
    _, driver, place = max(causes, key=lambda cause: cause[0])
    return Unexplained(
        place=place,
        axle=turned if driver == WHEEL_ANGLE else PLACES[place],
        wheel=_one_sided(whitened, excess),
        driver=driver,
        size=size,
        explained=explained,
        turning=turning,
        oscillation=swing,
        held_from=pressure,
        term=term,
    )


def _turning(fit: Fit, whitened: Sequence[Array], excess: float) -> tuple[float, str]:
    """Share of the excess that goes with the angle of the front or rear wheels, and which [1]."""
    shares = {"front": 0.0, "rear": 0.0}
    for run, x in zip(fit.problem.runs, whitened, strict=True):
        for axle, angle in (("front", run.angle_f), ("rear", run.angle_r)):
            phase = np.outer(_HARMONICS, thinned(run, angle)[-x.shape[1] :])
            shown = [CHANNELS.index(name) for name in ("rim", "front_rear", f"{axle}_sides")]
            shares[axle] += float(np.sum(_power_of(x[shown], phase))) / excess
    share, axle = max((share, axle) for axle, share in shares.items())
    return min(share, 1.0), axle


def oscillation_of(whitened: Sequence[Array], excess: float) -> Oscillation:
    """The strongest line of whitened innovations (6, m) of each run, over the ``excess``."""
    frequencies = np.arange(_FASTEST + 2) / (_WINDOW * STEP)
    phase = 2.0 * np.pi * np.outer(frequencies, STEP * np.arange(_WINDOW))
    cut = (x[:, : x.shape[1] // _WINDOW * _WINDOW] for x in whitened)
    windows = np.hstack([*cut]).reshape(len(CHANNELS), -1, _WINDOW)
    power = np.sum(_power_of(windows, phase), axis=1)
    lines = np.sum(power, axis=0)
    peak = _SLOWEST + int(np.argmax(lines[_SLOWEST:-1]))
    if lines[peak] <= _OVER * np.max(lines[: max(peak - 1, _SLOWEST)]):
        return Oscillation(0.0, 0.0, body=False)
    near = slice(peak - 1, peak + 2)
    band = np.maximum(power[:, near], 0.0)
    whole = float(np.sum(band))
    return Oscillation(
        frequency=float(np.sum(band @ frequencies[near])) / whole,
        share=min(whole / excess, 1.0),
        body=float(np.sum(band[[A_X, DRIFT]])) > 0.5 * whole,
    )


def _power_of(x: Array, phase: Array) -> Array:
    """Squares (..., k) that waves of a ``phase`` (k, n) [rad] take of innovations (..., n).

    Less those of noise alone, two a wave: cosine and sine.
    """
    return np.asarray(2.0 * np.abs(x @ np.exp(1j * phase).T) ** 2 / x.shape[-1] - 2.0)


def _one_sided(whitened: Sequence[Array], excess: float) -> str | None:
    """The wheel that is always slower than that beside it, if much of the excess is that."""
    every = np.hstack(whitened)
    lasting = np.sum(every, axis=1) / np.sqrt(every.shape[1])
    mean = {axle: float(lasting[CHANNELS.index(f"{axle}_sides")]) for axle in ("front", "rear")}
    axle = max(mean, key=lambda one: abs(mean[one]))
    if mean[axle] ** 2 - 1.0 < _ONE_SIDED * excess:
        return None
    return f"{axle}_{'left' if mean[axle] < 0.0 else 'right'}"
