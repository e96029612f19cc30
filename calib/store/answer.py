"""May this table be used, how far does it reach, what limits it, and what comes next."""

from dataclasses import dataclass

from calib.store.state import DRAFT, REJECTED, RELEASED
from calib.store.version import Stored
from calib.table.budget import budget_of, largest


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
    """The answer for a version of a store."""
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


_USE = {DRAFT: "for trials and for a validation, not for an ECU", RELEASED: "for an ECU"}
"""What a version in a state is for; nothing in any other state."""


def verdict_lines(stored: Stored) -> list[str]:
    """The answer in two lines: for what it is usable and what limits it, and what comes next."""
    return [f"{stored.id} is {verdict(stored)}", f"next: {answer(stored).next}"]


def verdict(stored: Stored) -> str:
    """For what a version is usable, up to how many g, what limits it, in one line."""
    word, cal = stored.state.word, stored.table.calibration
    if word not in _USE:
        return f"usable for nothing: it is {word}"
    said = answer(stored)
    front, rear = (
        f"{100.0 * (pads.ci95[1] / pads.value - 1.0):.0f} %"
        for pads in (cal.pad_friction_f, cal.pad_friction_r)
    )
    parts = [largest(of).replace("_", " ") for of in budget_of(stored.table).axles]
    return (
        f"usable {_USE[word]}, up to {said.decelerations[1]:.2f} g ({said.ends}); pads known to "
        f"{front} front and {rear} rear, limited by {' and '.join(dict.fromkeys(parts))}"
    )


def _next(stored: Stored) -> str:
    id_, warned = stored.id, "look at its warnings, then " if stored.table.warnings else ""
    return {
        RELEASED: f"`brake-cal tables export {stored.name} --format dcm --out {stored.name}.dcm`",
        DRAFT: f"{warned}validate it on stops (`brake-cal validate {id_} STOP... --out results`) "
        f"and release it (`brake-cal tables release {id_} --reason ... "
        "--evidence results/summary.json`)",
        REJECTED: "find the cause, and fit the car again; or release it on new evidence",
    }.get(stored.state.word, "fit the car again")
