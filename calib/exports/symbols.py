"""Labels of objects, and their places in the memory of an ECU."""

import re
import unicodedata
from dataclasses import dataclass, field
from typing import NamedTuple

from calib.base.digest import sha256

LONGEST, LONGEST_PREFIX = 31, 16
"""Characters of a label (significant in every C99 compiler), and of its first part."""
_MARK = 4  # digits of the digest behind a shortened name
_NONE_GIVEN = (
    "all addresses are 0 and little endian is assumed: `tables export --elf FILE` takes them from "
    "the linked program"
)


def prefix(name: str) -> str:
    """Label of a table's name, at most 16 characters.

    >>> prefix("sedan-2up"), prefix("2up"), prefix("Müller")
    ('sedan_2up', 't_2up', 'Muller_a784')
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    word = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    if not word[:1].isalpha():
        word = f"t_{word}".rstrip("_")
    whole = re.fullmatch(r"[A-Za-z0-9._-]+", name) is not None
    return word if whole and len(word) <= LONGEST_PREFIX else _marked(word, name, LONGEST_PREFIX)


def label(*parts: str) -> str:
    """Label of one object, at most 31 characters: an identifier of every format and C compiler."""
    whole = "_".join(parts)
    return whole if len(whole) <= LONGEST else _marked(whole, whole, LONGEST)


def _marked(word: str, name: str, longest: int) -> str:
    mark = sha256(name.encode("utf-8", "surrogatepass"))[:_MARK]
    return f"{word[: longest - _MARK - 1].rstrip('_')}_{mark}"


class Within(NamedTuple):
    """A place in the object of a ``symbol``: its member in C, and its offset [bytes]."""

    symbol: str
    member: str = ""
    offset: int = 0

    @property
    def link(self) -> str:
        """As debug information has it."""
        return f"{self.symbol}.{self.member}" if self.member else self.symbol


class Measured(NamedTuple):
    """A variable in the memory; ``kind`` its type in A2L, ``low`` and ``high`` its range [unit]."""

    label: str
    meaning: str
    unit: str
    kind: str
    low: float
    high: float
    within: Within


@dataclass(frozen=True)
class Addresses:
    """Address of each object by label, and the byte order; ``remarks`` on what was assumed.

    ``segment`` first address and size of what holds the data [bytes].
    """

    by_label: dict[str, int] = field(default_factory=dict)
    segment: tuple[int, int] = (0, 0)
    big_endian: bool = False
    remarks: tuple[str, ...] = (_NONE_GIVEN,)
