"""From the search to a verdict: effects that are named, rivals, and whether something is left.

`verdict_of` decides. Something is left if an empirical term is surely more probable, if the
innovations are far larger than noise, or if the replays of the hold-outs are far off. The named
effects are then dropped, and the cause is unknown, if a term alone is surely more probable than
the effects, or if these close too little of the gap.

`unexplained_of` describes what is left, with the best term. A term is a function of its driver, so
it cannot follow two things: what goes with the angle of a wheel, which is another in every run, and
what swings at its own frequency after each application, like liquid in a tank or a body on its
springs. Both are looked for in the innovations. The excess of the innovations is the sum of their
squares, less their number.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.car.effects.effects import EmpiricalTerm
from calib.car.effects.empirical import PLACES
from calib.diagnosis.explanation.channels import A_X, CHANNELS, SPEED, STEP, by_channel, thinned
from calib.diagnosis.explanation.fit import Fit
from calib.diagnosis.replays import Replayed
from calib.diagnosis.search import DECISIVE, Search
from calib.diagnosis.terms import PLAIN_LOSS, Ranked, ranked_terms, with_terms

WHEEL_ANGLE, FREQUENCY, SLIP = "wheel_angle", "frequency", "slip"  # drivers that no term has

_SURE_SCATTERS = 8.0
"""Standard deviations by which the mean squared innovation exceeds 1.01 if something is surely
left."""
_LEAST_CLOSED = 0.75  # share of gap and excess that effects must close if they leave something
_FAR = 3.0
"""Gap of the replays, in units of the noise, from which something is left beside named effects. If
nothing is named it is twice that, since then the errors of the parameters alone leave up to 4.2, on
a plant with other tyre curves than here; see tests/studies/naming.py."""
_HARMONICS = (1, 2)  # of the wheel's turn; run-out and uneven spacing show in the first ones
_HELD_SLOPE = 0.5  # d ln(torque)/d ln(pressure) below which a torque is held [1]
_ONE_SIDED = 0.3  # share of the excess that one wheel must take to be named
_LEAST_SHARE = 0.1  # share of the excess from which wheel angle or frequency may be the driver
_WINDOW = round(4.0 / STEP)  # innovations in a window of 4 s
_SLOWEST, _FASTEST = 2, 20
"""First and last line of the spectrum that may swing, 0.5 and 5 Hz; lines are 0.25 Hz apart. An
error that lasts for a stop is slower, a body on its springs swings at 1 to 2 Hz, a wheel is
faster."""
_PEAK_RATIO = 3.0
"""Least power of a peak over that of the slower lines. An error after every application, such as
that of a lag, is in all lines; a swing of 0.5 Hz or more has at most a fifth at 0.25 Hz."""


@dataclass(frozen=True)
class Verdict:
    """Result of a search."""

    search: Search
    after: Replayed  # replays with the best fit
    rivals: tuple[Fit, ...]  # as likely as the best fit
    term: Fit | None  # the best fit with an empirical term, or None if nothing is left

    @property
    def best(self) -> Fit:
        """The fit with the named effects, or the base without effects."""
        return self.after.fit

    @property
    def word(self) -> str:
        """The verdict as in diagnosis.json."""
        if self.best.names:
            return "ambiguous" if self.rivals else "named"
        return "unknown" if self.term else "no_gap"


def verdict_of(search: Search) -> Verdict:
    """Return the verdict on the best fit of a search."""
    base = search.base
    after, terms, term_fits = _last_closing(search)
    best = after.fit
    if not term_fits and search.gap(after).rms_after > (_FAR if best.names else 2.0 * _FAR):
        term_fits = with_terms(best, terms)
    if term_fits and best.names:
        term_alone = with_terms(base, search.terms)
        if term_alone[0].log_evidence > best.log_evidence + DECISIVE:
            best, after, term_fits = base, search.base_replayed, term_alone
    rivals = search.rivals if best is search.best else ()
    return Verdict(search, after, rivals, plainest(best, term_fits) if term_fits else None)


def _last_closing(search: Search) -> tuple[Replayed, list[Ranked], list[Fit]]:
    """Go back from the last accepted fit to the first that stands; the base always does.

    A fit must not widen the gap of the replays; if it leaves something, it must close the share
    `_LEAST_CLOSED` of the gap. Return its replays, the ranked terms, and fits with terms for what
    is left.
    """
    candidates = search.accepted
    # if the best fit cannot be replayed, its replays of when it was accepted stay
    with suppress(ModelError):
        candidates = [*search.accepted[:-1], search.replayed(search.best)]
    for replayed in reversed(candidates):
        fit = replayed.fit
        if fit.names and search.widens(replayed):
            continue
        terms = ranked_terms(fit)
        term_fits = _remaining_terms(search, fit, terms)
        explained = 1.0 - (fit.mean_square - 1.0) / max(search.base.mean_square - 1.0, 1e-9)
        closed = min(search.gap(replayed).closed, explained)
        if not fit.names or not term_fits or closed > _LEAST_CLOSED:
            return replayed, terms, term_fits
    return search.base_replayed, search.terms, _remaining_terms(search, search.base, search.terms)


def _remaining_terms(search: Search, fit: Fit, terms: Sequence[Ranked]) -> list[Fit]:
    """Fit the best of these terms beside a fit if more than noise is left; else return no fit.

    More is left if innovations are far larger, or a term is surely more probable, on hold-outs too.
    """
    is_surely_left = fit.mean_square > 1.01 + _SURE_SCATTERS * fit.scatter
    if not is_surely_left and terms[0].log_gain < DECISIVE:
        return []
    fits = with_terms(fit, terms)
    holdout_gain = search.fits.density(fits[0]) - search.fits.density(fit)
    gain = fits[0].log_evidence - fit.log_evidence + holdout_gain
    is_more_probable = holdout_gain > 0.0 and gain > DECISIVE
    return fits if is_surely_left or is_more_probable else []


@dataclass(frozen=True)
class Oscillation:
    """The strongest line of the spectrum of the innovations."""

    frequency: float  # [Hz], 0 if no line stands out
    share: float  # of the excess that swings with it [1]
    body: bool  # whether most of the swing is in a_x and v, so that the car as a whole swings


@dataclass(frozen=True)
class Unexplained:
    """What is left, with the empirical term that explains most of it.

    ``driver`` is the variable with the largest share of the excess: that of the term,
    `WHEEL_ANGLE`, or `FREQUENCY` for the oscillation. It is `SLIP` if front brakes hold a torque.
    """

    place: str  # one of `PLACES`
    axle: str
    wheel: str | None  # always slower than the other of its axle, by much of the excess
    driver: str
    size: float  # rms of the gap that replays leave without the term, over the noise [1]
    explained: float  # share of the excess that the term takes, at most 1
    turning: float  # share of the excess that goes with the angle of the wheels [1]
    oscillation: Oscillation
    held_from: float | None  # pressure from which a brake torque is held [Pa]
    term: EmpiricalTerm


def held_from(term: EmpiricalTerm) -> float | None:
    """Pressure [Pa] above which a brake torque hardly rises with the pressure; None if it rises.

    Brake control that limits the slip holds a torque in this way, at the rear also a valve.
    """
    if not term.on_brakes or term.driver != "pressure":
        return None
    p = np.array(term.knots)
    torque = p * (1.0 + np.array(term.values))  # up to a constant factor
    for i in range(2, p.size - 1):
        # half the rise of a torque in proportion to the pressure
        held_rise = _HELD_SLOPE * torque[i] / p[i] * np.diff(p[i:])
        if np.all(np.diff(torque[i:]) < held_rise):
            return float(p[i])
    return None


def plainest(fit: Fit, term_fits: Sequence[Fit]) -> Fit:
    """Return the first, which is the best, of the fits with a term, or a plain one if hardly worse.

    A plain term has a single number: it is constant, or holds a torque.
    """
    margin = PLAIN_LOSS * _excess(fit) / fit.count
    for with_term in term_fits:
        (term,) = with_term.effects.terms
        is_plain = term.driver == "constant" or held_from(term) is not None
        if is_plain and with_term.mean_square < term_fits[0].mean_square + margin:
            return with_term
    return term_fits[0]


def _excess(fit: Fit) -> float:
    """Excess of the sum of squares of the innovations, at least the scatter of the sum [1]."""
    return max((fit.mean_square - 1.0) * fit.count, float(np.sqrt(2.0 * fit.count)))


def unexplained_of(fit: Fit, with_term: Fit, size: float) -> Unexplained:
    """Describe what ``fit`` leaves, by ``with_term``, the same fit with a term added.

    ``size`` is as in `Unexplained`.
    """
    excess, (term,) = _excess(fit), with_term.effects.terms
    explained = min((fit.mean_square - with_term.mean_square) * fit.count / excess, 1.0)
    pressure = held_from(term)
    whitened = [by_channel(r) for r in fit.innovations]
    turning, turning_axle = _turning(fit, whitened, excess)
    swing = oscillation_of(whitened, excess)
    holds_front = pressure is not None and PLACES[term.place] != "rear"
    share_to_exceed = max(explained, _LEAST_SHARE)  # by wheel angle or frequency, to be the driver
    causes = (  # share of the excess, driver, place
        (share_to_exceed, SLIP if holds_front else term.driver, term.place),
        (turning, WHEEL_ANGLE, term.place),
        (swing.share, FREQUENCY, "body" if swing.body else "brakes"),
    )
    _, driver, place = max(causes, key=lambda cause: cause[0])
    return Unexplained(
        place=place,
        axle=turning_axle if driver == WHEEL_ANGLE else PLACES[place],
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
    """Share of the excess that goes with the angle of front or rear wheels [1], and that axle."""
    shares = {"front": 0.0, "rear": 0.0}
    for run, x in zip(fit.problem.runs, whitened, strict=True):
        for axle, angle in (("front", run.angle_f), ("rear", run.angle_r)):
            phase = np.outer(_HARMONICS, thinned(run, angle)[-x.shape[1] :])
            rows = [CHANNELS.index(name) for name in ("rim", "front_rear", f"{axle}_sides")]
            shares[axle] += float(np.sum(_power_of(x[rows], phase))) / excess
    axle = "front" if shares["front"] > shares["rear"] else "rear"
    return min(shares[axle], 1.0), axle


def oscillation_of(whitened: Sequence[Array], excess: float) -> Oscillation:
    """The strongest line of whitened innovations (6, m) of all runs, over the ``excess``."""
    frequencies = np.arange(_FASTEST + 2) / (_WINDOW * STEP)  # [Hz]
    phase = 2.0 * np.pi * np.outer(frequencies, STEP * np.arange(_WINDOW))
    full_windows = [x[:, : x.shape[1] // _WINDOW * _WINDOW] for x in whitened]
    windows = np.hstack(full_windows).reshape(len(CHANNELS), -1, _WINDOW)
    power = np.sum(_power_of(windows, phase), axis=1)  # by channel and line
    lines = np.sum(power, axis=0)
    peak = _SLOWEST + int(np.argmax(lines[_SLOWEST:-1]))
    # all slower lines but the neighbour of the peak
    if lines[peak] <= _PEAK_RATIO * np.max(lines[: max(peak - 1, _SLOWEST)]):
        return Oscillation(0.0, 0.0, body=False)
    near = slice(peak - 1, peak + 2)  # the peak and the lines beside it
    band = np.maximum(power[:, near], 0.0)
    total = float(np.sum(band))
    return Oscillation(
        frequency=float(np.sum(band @ frequencies[near])) / total,
        share=min(total / excess, 1.0),
        body=float(np.sum(band[[A_X, SPEED]])) > 0.5 * total,
    )


def _power_of(x: Array, phase: Array) -> Array:
    """Sum of squares (..., k) of innovations (..., n) that a wave of ``phase`` (k, n) explains."""
    # noise of variance 1 gives 2 on average, 1 each by the cosine and the sine
    return np.asarray(2.0 * np.abs(x @ np.exp(1j * phase).T) ** 2 / x.shape[-1] - 2.0)


def _one_sided(whitened: Sequence[Array], excess: float) -> str | None:
    """The wheel that is always slower than the other of its axle, if this is much of the excess."""
    joined = np.hstack(whitened)
    means = np.sum(joined, axis=1) / np.sqrt(joined.shape[1])  # in standard deviations
    by_axle = {axle: float(means[CHANNELS.index(f"{axle}_sides")]) for axle in ("front", "rear")}
    axle = max(by_axle, key=lambda name: abs(by_axle[name]))
    if by_axle[axle] ** 2 - 1.0 < _ONE_SIDED * excess:
        return None
    slower = "left" if by_axle[axle] < 0.0 else "right"  # the channel is left less right
    return f"{axle}_{slower}"
