"""The state of a version: whether the version may be used, who decided that, on what evidence.

    draft ──> released ──> withdrawn
      │          │  ^          ^
      └──────> rejected ───────┘

A draft may be withdrawn, too. A new version is a draft, unless a decision comes with it. Only new
evidence releases a rejected version. A withdrawn version stays withdrawn.
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
"""The states that may follow each state. A state may follow itself on other evidence."""


@dataclass(frozen=True)
class Evidence:
    """A file on which a state rests."""

    name: str  # without folder
    sha256: str


@dataclass(frozen=True)
class StateDecision:
    """The decision that a version gets ``state``.

    A program makes an ``automatic`` decision. Such a decision neither releases a rejected version
    nor changes a withdrawn version.
    """

    state: str = DRAFT
    reason: str = ""
    verdict: str = ""  # of the evidence
    evidence: tuple[Evidence, ...] = ()
    by: str = ""  # who decided; "" is the user of the computer
    automatic: bool = False


DRAFTED = StateDecision()


@dataclass(frozen=True)
class VersionState:
    """The state of a version, with its last decision. Times are in UTC (ISO 8601)."""

    word: str = DRAFT  # one of STATES
    since: str = ""
    by: str = ""
    reason: str = ""
    verdict: str = ""
    evidence: tuple[Evidence, ...] = ()
    stored_at: str = ""
    past_evidence: frozenset[str] = frozenset()  # SHA-256 of the evidence of all states so far
    in_store: bool = True  # False for a copy outside of a store

    @property
    def released(self) -> bool:
        """Whether the version may be handed out to an ECU."""
        return self.word == RELEASED

    @property
    def usable(self) -> bool:
        """Whether a table's name without a version may mean this version."""
        return self.word not in (REJECTED, WITHDRAWN)

    @property
    def with_reason(self) -> str:
        """The state with its reason."""
        return f"{self.word}: {self.reason}" if self.reason else self.word

    @property
    def description(self) -> str:
        """The state with its reason, person and date."""
        person = f"by {self.by}" if self.by else ""
        origin = ", ".join(filter(None, (person, self.since[:10])))
        return f"{self.with_reason} ({origin})" if origin else self.with_reason


UNJUDGED = VersionState()
OUTSIDE = VersionState(reason="outside of its store, whose journal knows its state", in_store=False)
NOT_STORED = VersionState(reason="not stored", in_store=False)


def changes_state(version: str, current: VersionState, decision: StateDecision) -> bool:
    """Whether ``decision`` changes the ``current`` state. Raises StoreError if it must not."""
    if decision.state == DRAFT:
        return False
    releases_rejected = current.word == REJECTED and decision.state == RELEASED
    if decision.automatic and (releases_rejected or current.word == WITHDRAWN):
        return False  # only a person may decide that
    if current.word == decision.state and current.evidence == decision.evidence:
        return False  # the same command was given twice
    if decision.state not in CHANGES[current.word]:  # the current state is "withdrawn"
        flaw = f"is {current.description}; it stays withdrawn"
        raise StoreError(flaw, where=version, do="fit the car again: a new log makes a new version")
    new_evidence = {file.sha256 for file in decision.evidence} - current.past_evidence
    if releases_rejected and not new_evidence:
        flaw = f"is {current.description}; it is released only on new evidence"
        do = "validate it on another stop, and give the summary.json with --evidence"
        raise StoreError(flaw, where=version, do=do)
    return True


def user() -> str:
    """Return the name of the user of this computer, "unknown" where the system has none."""
    try:
        return getpass.getuser()
    except (ImportError, KeyError, OSError):  # Windows has no pwd
        return "unknown"
