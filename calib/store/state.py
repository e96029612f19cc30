"""The state of a version: may it be used, who decided so, and on what evidence.

    draft ──> released ──> withdrawn
      │          │  ^          ^
      └──────> rejected ───────┘

A draft may be withdrawn, too. A version begins as a draft, or in the state of its decision. Only
new evidence releases a rejected version. A withdrawn version stays withdrawn.
"""

import getpass
from dataclasses import dataclass

from calib.base.errors import StoreError

STATES = DRAFT, RELEASED, REJECTED, WITHDRAWN = "draft", "released", "rejected", "withdrawn"

CHANGES = {
    DRAFT: (RELEASED, REJECTED, WITHDRAWN),
    RELEASED: (RELEASED, REJECTED, WITHDRAWN),
    REJECTED: (REJECTED, RELEASED, WITHDRAWN),
    WITHDRAWN: (),
}
"""The states that may follow each state; the same state on new evidence."""


@dataclass(frozen=True)
class Evidence:
    """A file on which a state rests: its name without folder, and its digest."""

    name: str
    sha256: str


@dataclass(frozen=True)
class StateDecision:
    """A new state of a version, and its reason; ``by`` "" is the user of the computer.

    ``automatic``: by a program, which neither releases a rejected version nor changes a withdrawn.
    """

    state: str = DRAFT
    reason: str = ""
    verdict: str = ""
    evidence: tuple[Evidence, ...] = ()
    by: str = ""
    automatic: bool = False


@dataclass(frozen=True)
class VersionState:
    """The state of a version ``since`` a time (ISO 8601, UTC), by whom, why, on what evidence.

    ``past_evidence``: SHA-256 of the evidence of all its states; ``in_store``: False for a copy.
    """

    word: str = DRAFT
    since: str = ""
    by: str = ""
    reason: str = ""
    verdict: str = ""
    evidence: tuple[Evidence, ...] = ()
    stored_at: str = ""
    past_evidence: frozenset[str] = frozenset()
    in_store: bool = True

    @property
    def released(self) -> bool:
        """Whether the version may be handed out."""
        return self.word == RELEASED

    @property
    def usable(self) -> bool:
        """Whether a bare name may mean the version, unless a released one is needed."""
        return self.word not in (REJECTED, WITHDRAWN)

    @property
    def why(self) -> str:
        """The state with its reason."""
        return f"{self.word}: {self.reason}" if self.reason else self.word

    @property
    def words(self) -> str:
        """The state with its reason, person and date."""
        source = ", ".join(filter(None, (self.by and f"by {self.by}", self.since[:10])))
        return f"{self.why} ({source})" if source else self.why


UNJUDGED = VersionState()
OUTSIDE = VersionState(reason="outside of its store, whose journal knows its state", in_store=False)
NOT_STORED = VersionState(reason="not stored", in_store=False)


def is_new(version: str, now: VersionState, decision: StateDecision | None) -> bool:
    """Whether a decision changes anything. Raises StoreError where its state may not follow."""
    if decision is None or decision.state == DRAFT:
        return False
    new = decision.state
    back = (now.word, new) == (REJECTED, RELEASED)
    if decision.automatic and (now.word == WITHDRAWN or back):
        return False  # a person decides
    if now.word == new and now.evidence == decision.evidence:
        return False  # the same command again
    if new not in CHANGES[now.word]:
        flaw = f"is {now.words}; it stays withdrawn"
        raise StoreError(flaw, where=version, do="fit the car again: a new log makes a new version")
    if back and now.past_evidence >= {one.sha256 for one in decision.evidence}:
        flaw = f"is {now.words}; it is released only on new evidence"
        do = "validate it on another stop, and give the summary.json with --evidence"
        raise StoreError(flaw, where=version, do=do)
    return True


def user() -> str:
    """Name of the user of this computer; "unknown" where it has none."""
    try:
        return getpass.getuser()
    except (ImportError, KeyError, OSError):  # Windows has no pwd
        return "unknown"
