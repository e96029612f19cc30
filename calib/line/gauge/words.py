"""A gauge study in words."""

from calib.line.gauge.study import REFUSED, GaugeStudy, GaugeVerdict


def conclusion(found: GaugeStudy) -> str:
    """The verdict on the whole study in one line, with the metrics that do not pass.

    Its first word is "passed", "failed", or "none" where no metric could be judged.
    """
    judged = [one for one in found.results if one.verdict != GaugeVerdict.NOT_JUDGED]
    if not judged:
        return "none of the metrics could be judged: their repeats do not scatter"
    held = sum(one.verdict not in REFUSED for one in judged)
    word = "passed" if found.passed else "failed"
    parts = [f"{word}: {held} of {len(judged)} metrics within the limits"]
    for verdict in REFUSED:
        names = [one.name for one in judged if one.verdict == verdict]
        parts += [f"{verdict}: {', '.join(names)}"] if names else []
    return "; ".join(parts)
