"""From the search to a verdict: what is named, what is as likely, and whether something is left.

    best explanation --> replays of the hold-outs --> anything left? --> more likely by a term?
                                                        no: named          yes: unknown

Something is left where an empirical term is surely more probable, where the innovations have far
more than noise, or where the replays are far off. It is no known effect where a term alone is
surely more probable than what is named, or where that closes too little of the gap.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from calib.base.errors import ModelError
from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.explanation.fit import SETTLED
from calib.diagnosis.proof.unexplained import plainest_first
from calib.diagnosis.replays.hold_outs import Replayed
from calib.diagnosis.search.search import SURE, Search
from calib.diagnosis.search.terms import Ranked, ranked_terms, with_terms

NO_GAP, NAMED, AMBIGUOUS, UNKNOWN = "no_gap", "named", "ambiguous", "unknown"

_STRANGE = 8.0  # scatters of the mean squared innovation from which a cause is sure
_CLOSED = 0.75  # share of the gap and of the excess that effects must close which leave something
_FAR = 3.0
"""Gap of the replays, in units of the noise, from which something is left beside what is named,
whatever innovations of one step show; twice that where nothing is named. With nothing hidden the
errors of the parameters leave up to 4.2, on a plant with other forms of tyre than here; see
tests/studies/naming.py."""


@dataclass(frozen=True)
class Verdict:
    """What a ``search`` comes to: the explanation whose hold-outs are ``after``.

    ``rivals`` as likely; ``terms`` explanations with the best empirical terms beside it, where
    something is left, the one that describes it first.
    """

    search: Search
    after: Replayed
    rivals: tuple[Explanation, ...]
    terms: tuple[Explanation, ...]

    @property
    def best(self) -> Explanation:
        """What is named, or the base without effects."""
        return self.after.of

    @property
    def word(self) -> str:
        """The verdict as in diagnosis.json."""
        if self.best.names:
            return AMBIGUOUS if self.rivals else NAMED
        return UNKNOWN if self.terms else NO_GAP


def verdict_of(search: Search) -> Verdict:
    """The verdict on the ``best`` of a search, by its hold-outs."""
    base = search.base
    after, terms, beside = _standing(search)
    best = after.of
    if not beside and search.gap(after).after > (_FAR if best.names else 2.0 * _FAR):
        beside = with_terms(best, terms)
    if beside and best.names:
        alone = with_terms(base, search.terms)
        if alone[0].log_evidence > best.log_evidence + SURE:
            best, after, beside = base, search.before, alone
    rivals = search.rivals if best is search.best else ()
    return Verdict(search, after, rivals, tuple(plainest_first(best, beside)))


def _standing(search: Search) -> tuple[Replayed, list[Ranked], list[Explanation]]:
    """The last explanation of a search that closes the gap of the replays, with terms beside it.

    By `_CLOSED` where something is left with it; else it must not widen the gap.
    """
    accepted = [*search.accepted]
    with suppress(ModelError):  # else the last one stands as it was accepted
        accepted[-1:] = [search.replayed(search.best, SETTLED)]
    for one in reversed(accepted):
        best = one.of
        if best.names and search.widens(one):
            continue
        terms = ranked_terms(best)
        beside = _left(search, best, terms)
        taken = 1.0 - (best.reduced - 1.0) / max(search.base.reduced - 1.0, 1e-9)
        if not best.names or not beside or min(search.gap(one).closed, taken) > _CLOSED:
            return one, terms, beside
    return search.before, search.terms, _left(search, search.base, search.terms)


def _left(search: Search, at: Explanation, terms: Sequence[Ranked]) -> list[Explanation]:
    """An explanation with the best of these terms, where more than noise is left; else none.

    That is where a term is surely more probable, on the hold-outs, too: no law stands behind it.
    """
    strange = at.reduced > 1.01 + _STRANGE * at.scatter
    if not strange and terms[0].log_gain < SURE:
        return []
    found, fits = with_terms(at, terms), search.fits
    held = fits.density(found[0]) - fits.density(at)
    sure = held > 0.0 and found[0].log_evidence - at.log_evidence + held > SURE
    return found if strange or sure else []
