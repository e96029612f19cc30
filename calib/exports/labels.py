"""Labels of exported objects: identifiers that every format and every C compiler takes."""

import hashlib
import re
import unicodedata

LONGEST, LONGEST_PREFIX = 31, 16
"""Characters of a label (significant in every C99 compiler), and of its first part."""

_MARK = 4
"""Digits of the digest behind a shortened name."""


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
    """Label of one curve or scalar, at most 31 characters.

    >>> label("sedan_2up", "f1")
    'sedan_2up_f1'
    """
    whole = "_".join(parts)
    return whole if len(whole) <= LONGEST else _marked(whole, whole, LONGEST)


def _marked(word: str, name: str, longest: int) -> str:
    mark = hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:_MARK]
    return f"{word[: longest - _MARK - 1].rstrip('_')}_{mark}"
