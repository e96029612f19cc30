"""May this table be used, how far does it reach, what limits it, and what comes next."""

from dataclasses import dataclass

import numpy as np

from calib.store.state import DRAFT, REJECTED, RELEASED
from calib.store.version import Stored
from calib.table.table import EXTRAPOLATED, Table


@dataclass(frozen=True)
class Answer:
    """``usable`` where it is released; ``may`` says so in words.

    ``decelerations``, ``eta`` least and greatest of the rows that rest on measurements [1];
    ``limit`` what ends the range; ``next`` the next step.
    """

    usable: bool
    may: str
    decelerations: tuple[float, float]
    eta: tuple[float, float]
    limit: str
    next: str


def answer(stored: Stored) -> Answer:
    """The answer for a version of a store."""
    table, state = stored.table, stored.state
    known = table.paper.flag != EXTRAPOLATED
    z, eta = table.paper.z[known], table.paper.eta[known]
    return Answer(
        usable=state.released,
        may=("yes: " if state.released else "no: ") + state.words,
        decelerations=(float(np.min(z)), float(np.max(z))),
        eta=(float(np.min(eta)), float(np.max(eta))),
        limit=_limit(table),
        next=_next(stored),
    )


def _limit(table: Table) -> str:
    q = table.quality
    peak, end = q.get("eta_peak_deceleration"), q.get("deceleration_max")
    if peak is not None and q.get("eta_peak_is_real"):
        return (
            f"eta has its peak at {peak:.2f} g: beyond it two decelerations have one eta, "
            "and an ECU uses the end value"
        )
    if end is not None:
        return f"the ramp ends at {end:.2f} g: beyond it an ECU uses the end value"
    return "the end of the ramp: beyond it an ECU uses the end value"


def _next(stored: Stored) -> str:
    word, id_ = stored.state.word, stored.id
    warned = "look at its warnings, then " if stored.table.warnings else ""
    if word == RELEASED:
        return f"`brake-cal tables export {stored.name} --format dcm --out {stored.name}.dcm`"
    if word == DRAFT:
        return (
            f"{warned}validate it on stops (`brake-cal validate {id_} STOP... --out results`) and "
            f"release it (`brake-cal tables release {id_} --reason ... "
            "--evidence results/summary.json`)"
        )
    if word == REJECTED:
        return "find the cause, and fit the car again; or release it on new evidence"
    return "fit the car again"
