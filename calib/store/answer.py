"""May this table be used, how far does it reach, what limits it, and what comes next."""

from dataclasses import dataclass

from calib.base.plain import NBSP
from calib.store.state import DRAFT, REJECTED, RELEASED
from calib.store.version import Stored


@dataclass(frozen=True)
class Answer:
    """``usable`` where it is released; ``may`` says so in words.

    ``decelerations``, ``eta`` of the known rows [1]; ``ends`` what ends the range, ``limit`` what
    is beyond it; ``next`` the next step.
    """

    usable: bool
    may: str
    decelerations: tuple[float, float]
    eta: tuple[float, float]
    ends: str
    limit: str
    next: str


def answer(stored: Stored) -> Answer:
    """Return the answer for a version of a store."""
    paper, state, q = stored.table.paper, stored.state, stored.table.quality
    peak, end, real = (
        q.get(key) for key in ("eta_peak_deceleration", "deceleration_max", "eta_peak_is_real")
    )
    if peak is not None and real:
        ends = f"eta has its peak at {peak:.2f} g"
    else:
        ends = "the ramp ends" if end is None else f"the ramp ends at {end:.2f} g"
    two = "two decelerations have one eta, and " if real else ""
    return Answer(
        usable=state.released,
        may=("yes: " if state.released else "no: ") + state.words,
        decelerations=paper.usable,
        eta=paper.usable_eta,
        ends=ends,
        limit=f"{ends}: beyond it {two}an ECU uses the end value",
        next=_next(stored),
    )


_USE = {DRAFT: "for trials, not yet for an ECU", RELEASED: "for an ECU"}
"""What a version in a state is for; nothing in any other state."""


def verdict(stored: Stored) -> str:
    """For what a version is usable, and up to how many g, in one line."""
    word = stored.state.word
    if word not in _USE:
        return f"{stored.id} is of no use: it is {word}"
    return f"{stored.id} is {_USE[word]}, up to {stored.table.paper.usable[1]:.2f}{NBSP}g"


def _next(stored: Stored) -> str:
    return {
        RELEASED: f"brake-cal tables export {stored.name} --format ecu --out {stored.name}_ecu",
        DRAFT: f"brake-cal validate {stored.id} STOP... --out results",
        REJECTED: "find the cause and fit the car again, or release it on new evidence",
    }.get(stored.state.word, "fit the car again")
