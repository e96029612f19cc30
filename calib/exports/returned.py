"""Content of an exported file that was read back: its numbers, and the facts that it states.

A file is an export of this program when it names a table, in its head or by its labels: a tool that
saves a file keeps labels and numbers, and seldom the head. It is complete when it has as many
objects as it states. Its numbers are unchanged when their checksum agrees.
"""

from dataclasses import dataclass
from pathlib import Path

from calib.errors import ExchangeError
from calib.exports.dataset import Content

VERSION = "_version"
"""How the label of the scalar ends that holds the version of the table."""


@dataclass(frozen=True)
class Returned:
    """A file read back: ``format`` DCM or CDF, ``facts`` by key, and its numbers.

    ``prefix`` of the labels of the table, ``table`` its id: as the head has it, or by the labels.
    """

    format: str
    facts: dict[str, str]
    units: dict[str, str]
    content: Content
    prefix: str
    table: str

    @property
    def unchanged(self) -> bool | None:
        """Whether the numbers agree with the checksum; None where the file states none."""
        stated = self.facts.get("checksum")
        return None if stated is None else stated == self.content.checksum


def returned(
    path: Path, form: str, facts: dict[str, str], units: dict[str, str], content: Content
) -> Returned:
    """Make a `Returned`. Raises ExchangeError where no table is named or objects are missing."""
    firsts = [name.removesuffix(VERSION) for name in content.scalars if name.endswith(VERSION)]
    firsts = [first for first in firsts if f"{first}_D" in content.curves]
    if len(firsts) != 1:
        raise ExchangeError(
            f"{form} with the labels of {len(firsts)} tables, such as NAME{VERSION} and NAME_D",
            where=path,
            expected="an export of one table, or that file as another tool has saved it",
        )
    first = firsts[0]
    found = len(content.axes) + len(content.curves) + len(content.scalars)
    if facts.get("objects", str(found)) != str(found):
        raise ExchangeError(
            f"holds {found} objects and states {facts['objects']}: cut off, or joined",
            where=path,
            do="export the table again",
        )
    table = facts.get("table", f"{first}@{content.scalars[first + VERSION]:.0f}")
    return Returned(form, facts, units, content, first, table)
