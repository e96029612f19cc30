"""All checks of the qualification, and their run on the shipped sample logs."""

import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from calib.demo.samples import sample_logs
from calib.qualification import (
    batches,
    causes,
    closed_forms,
    fitted,
    handed_out,
    line,
    reading,
    recorded,
    stops,
)
from calib.qualification.check import Check, Outcome, run
from calib.qualification.material import Material

SUITE: tuple[Check, ...] = (
    *closed_forms.CHECKS,
    *reading.CHECKS,
    *recorded.CHECKS,
    *fitted.CHECKS,
    *stops.CHECKS,
    *line.CHECKS,
    *batches.CHECKS,
    *handed_out.CHECKS,
    *causes.CHECKS,
)


@dataclass(frozen=True)
class Qualification:
    """The outcomes, and the SHA-256 [hex] of each sample file that they rest on.

    ``left_out`` are the checks that need a package that is not installed.
    """

    outcomes: tuple[Outcome, ...]
    files: dict[str, str]
    left_out: tuple[Check, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every check that was made held."""
        return all(outcome.held for outcome in self.outcomes)


def qualify(
    checks: Iterable[Check] = SUITE, done: Callable[[], None] = lambda: None
) -> Qualification:
    """Make all ``checks`` on the shipped sample logs, except those that need a missing package.

    Takes about 7 s of computing. ``done`` is called after each check. Writes into a temporary
    folder, which is deleted. Raises InputError when the program was installed without its sample
    logs.
    """
    samples = sample_logs()
    checks = tuple(checks)
    left_out = tuple(check for check in checks if check.missing)
    with tempfile.TemporaryDirectory(prefix="brake-cal-qualify-") as scratch:
        material = Material(samples, Path(scratch))
        outcomes = run((c for c in checks if c not in left_out), material, done)
        return Qualification(outcomes, material.files(), left_out)
