"""Names that are valid in every format: C identifiers of at most 31 characters, from any name.

Letters, digits and single underscores, with a letter first and no underscore last: valid in C
(MISRA C:2012, 5.1: 31 significant characters), DCM and CDF. If more than a ``-`` or a ``.`` of a
name was replaced, four digits of its SHA-256 follow, so that different names stay different.
"""

import hashlib
import re
import unicodedata

LONGEST = 31
"""Significant characters of an external name in every C99 compiler."""

LONGEST_PREFIX = 16
MARK = 4
"""Digits of the digest behind a shortened name."""


def prefix(name: str) -> str:
    """Label of a table's name, at most 16 characters.

    >>> prefix("sedan-2up"), prefix("2up")
    ('sedan_2up', 't_2up')
    >>> prefix("Müller")
    'Muller_a784'
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    word = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    if not word[:1].isalpha():
        word = f"t_{word}".rstrip("_")
    whole = re.fullmatch(r"[A-Za-z0-9._-]+", name) is not None
    if whole and len(word) <= LONGEST_PREFIX:
        return word
    return _marked(word, name, LONGEST_PREFIX)


def label(first: str, *parts: str) -> str:
    """Label of one curve or scalar, at most 31 characters.

    >>> label("sedan_2up", "f1")
    'sedan_2up_f1'
    """
    whole = "_".join((first, *parts))
    return whole if len(whole) <= LONGEST else _marked(whole, whole, LONGEST)


def printable(text: str) -> str:
    """``text`` on one line, without control characters."""
    return "".join(c if c.isprintable() else " " for c in text)


def _marked(word: str, name: str, longest: int) -> str:
    mark = hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:MARK]
    return f"{word[: longest - MARK - 1].rstrip('_')}_{mark}"
