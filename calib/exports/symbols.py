"""Labels of exported objects, and places of objects in the memory of an ECU."""

import re
import unicodedata
from dataclasses import dataclass, field
from typing import NamedTuple

from calib.base.digest import sha256

LONGEST, LONGEST_PREFIX = 31, 16
"""Characters of a label (significant in every C99 compiler), and of its first part."""
_MARK = 4  # digits of a name's digest at the end of a label that is shorter than the name
_NO_ELF = (
    "all addresses are 0 and little endian is assumed: `tables export --elf FILE` takes them from "
    "the linked program"
)


def prefix(name: str) -> str:
    """Return the first part of the labels of a table by its name, at most 16 characters.

    >>> prefix("sedan-2up"), prefix("2up"), prefix("Müller")
    ('sedan_2up', 't_2up', 'Muller_a784')
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    word = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    if not word[:1].isalpha():
        word = f"t_{word}".rstrip("_")
    is_plain = re.fullmatch(r"[A-Za-z0-9._-]+", name) is not None
    return word if is_plain and len(word) <= LONGEST_PREFIX else _marked(word, name, LONGEST_PREFIX)


def label(*parts: str) -> str:
    """Return the label of an object: an identifier in C and every format, at most 31 characters."""
    name = "_".join(parts)
    return name if len(name) <= LONGEST else _marked(name, name, LONGEST)


def _marked(word: str, name: str, longest: int) -> str:
    """Return ``word`` cut to ``longest`` characters, which end with a mark of the ``name``."""
    mark = sha256(name.encode("utf-8", "surrogatepass"))[:_MARK]
    return f"{word[: longest - _MARK - 1].rstrip('_')}_{mark}"


class Within(NamedTuple):
    """A place in an object of the memory: the ``symbol``, the member in C, its offset [bytes]."""

    symbol: str
    member: str = ""
    offset: int = 0

    @property
    def link(self) -> str:
        """The place as debug information names it."""
        return f"{self.symbol}.{self.member}" if self.member else self.symbol


class Measured(NamedTuple):
    """A variable that a tool can measure in the memory."""

    label: str
    meaning: str
    unit: str
    kind: str  # type in A2L
    low: float  # ends of its range [unit]
    high: float
    within: Within


@dataclass(frozen=True)
class Addresses:
    """Addresses of objects by label."""

    by_label: dict[str, int] = field(default_factory=dict)
    segment: tuple[int, int] = (0, 0)  # first address and size of the data [bytes]
    big_endian: bool = False
    remarks: tuple[str, ...] = (_NO_ELF,)  # what was assumed, in words
