"""Content of an exported file that was read back: its numbers, and the facts that it states.

A file is an export of this program when it names a table, its digest and a checksum. It is complete
when it has as many objects as it states. Its numbers are unchanged when their checksum agrees.
"""

from dataclasses import dataclass
from pathlib import Path

from calib.errors import ExchangeError
from calib.exports.dataset import Content

CLAIMS = ("table", "digest", "checksum", "objects")
"""Facts that a file must state to be read back."""


@dataclass(frozen=True)
class Returned:
    """A file read back: ``format`` DCM or CDF, ``facts`` by key, and its numbers."""

    format: str
    facts: dict[str, str]
    units: dict[str, str]
    content: Content

    @property
    def unchanged(self) -> bool:
        """Whether the numbers agree with the checksum."""
        return self.facts["checksum"] == self.content.checksum


def returned(
    path: Path, form: str, facts: dict[str, str], units: dict[str, str], content: Content
) -> Returned:
    """Make a `Returned`. Raises ExchangeError where facts or objects are missing."""
    missing = [key for key in CLAIMS if key not in facts]
    if missing:
        raise ExchangeError(
            f"{form} without {', '.join(missing)}",
            where=path,
            expected="a file written by `brake-cal tables export`",
        )
    found = len(content.axes) + len(content.curves) + len(content.scalars)
    if facts["objects"] != str(found):
        raise ExchangeError(
            f"holds {found} objects and states {facts['objects']}: cut off, or joined",
            where=path,
            do="export the table again",
        )
    return Returned(form, facts, units, content)
