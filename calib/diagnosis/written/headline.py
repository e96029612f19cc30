"""What a diagnosis is worth in one line: the verdict, and what the hold-outs say to it.

The verdict names a cause. Whether it is good enough is told by the hold-outs: how much of their gap
is closed, and what is left.
"""

from calib.diagnosis.diagnose import Diagnosis
from calib.diagnosis.gates import GATES
from calib.diagnosis.written.words import not_excluded, verdict

KINDS = {
    "no_gap": "No gap",
    "named": "Named",
    "rest": "Named and something else",
    "worse": "Named, and the hold-outs are no better",
    "ambiguous": "Ambiguous",
    "ambiguous_rest": "Ambiguous and something else",
    "unknown": "Unknown cause",
}
"""The outcomes, each in a few words."""


def outcome(found: Diagnosis) -> str:
    """The verdict as the hold-outs judge it, a key of `KINDS`.

    "named" only if the gap of the hold-outs is smaller than before and nothing significant is left.
    """
    if found.verdict not in ("named", "ambiguous"):
        return found.verdict
    if found.gap.closed <= 0.0:
        return "worse"
    left = found.unexplained is not None or found.left.significant
    if found.verdict == "ambiguous":
        return "ambiguous_rest" if left else "ambiguous"
    return "rest" if left else "named"


def headline(found: Diagnosis) -> str:
    """The verdict, what it does to the hold-outs, and what it does not exclude, in sentences."""
    return f"{verdict(found)} {closure(found)} {not_excluded(found)}".rstrip()


def closure(found: Diagnosis) -> str:
    """How much of the gap of the hold-outs is closed, and what is left over the noise."""
    gap, noise = found.gap, "times the sensors' noise"
    if found.verdict == "no_gap":
        return f"Replays of the hold-outs are {gap.after:.1f} {noise} off."
    if found.verdict == "unknown" and not found.model_after.effects.terms:
        return f"Nothing was added: replays of the hold-outs stay {gap.before:.1f} {noise} off."
    if gap.closed <= 0.0 and max(gap.before, gap.after) < GATES.within:
        return (
            f"Replays of the hold-outs do not show it: {gap.before:.1f} {noise} off without it, "
            f"{gap.after:.1f} with it."
        )
    if gap.closed <= 0.0:
        return (
            f"The gap on the hold-outs does not shrink: {gap.before:.1f} {noise} before, "
            f"{gap.after:.1f} after."
        )
    share, left = f"{100.0 * gap.closed:.1f} %", f"{gap.after:.1f} {noise} is left"
    if found.verdict == "unknown":
        return f"An empirical term closes {share} of the gap on the hold-outs; {left}."
    return f"{share} of the gap on the hold-outs is closed; {left}."
