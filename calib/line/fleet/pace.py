"""Progress of a batch: finished logs, rate and remaining time."""

import math
from dataclasses import dataclass
from datetime import timedelta


@dataclass(frozen=True)
class Pace:
    """``total`` logs, ``done`` in this run or before, ``fresh`` in this run, ``elapsed`` [s]."""

    total: int
    done: int
    fresh: int
    errors: int
    elapsed: float

    @property
    def rate(self) -> float:
        """Logs per second of this run; 0 before the first."""
        return self.fresh / self.elapsed if self.elapsed > 0.0 else 0.0

    @property
    def remaining(self) -> float:
        """Seconds left at this rate; infinite before the first.

        >>> Pace(total=10, done=6, fresh=4, errors=0, elapsed=2.0).remaining
        2.0
        """
        return (self.total - self.done) / self.rate if self.rate > 0.0 else float("inf")


def words(pace: Pace) -> str:
    """The progress in words.

    >>> words(Pace(total=300, done=200, fresh=100, errors=2, elapsed=0.5))
    '200 of 300 logs, 200 a second, 0:00:01 left, 2 with errors'
    """
    text = f"{pace.done} of {pace.total} logs"
    if pace.rate > 0.0:
        text += f", {pace.rate:.3g} a second"
    if pace.done < pace.total and pace.rate > 0.0:
        text += f", {timedelta(seconds=math.ceil(pace.remaining))} left"
    return text + (f", {pace.errors} with errors" if pace.errors else "")
