"""Text of others made safe for a terminal and for one line of a message."""

import unicodedata


def printable(text: str, keep: str = "") -> str:
    r"""Text with everything escaped that a terminal would obey instead of show.

    That is: control characters (C0 and C1), marks that turn the direction of writing, other
    characters without a shape, and bytes that are not UTF-8. Spaces of any width stay, and the
    characters in ``keep``.

    >>> import os
    >>> print(printable(os.fsdecode(b"r\xfcck.csv")))
    r\udcfcck.csv
    >>> print(printable("two\nlines.csv"))
    two\x0alines.csv
    >>> print(printable("\x1b[2J \u202egnp"))
    \x1b[2J \u202egnp
    """
    if text.isprintable():
        return text
    return "".join(c if _is_shown(c) or c in keep else _escaped(c) for c in text)


def _is_shown(sign: str) -> bool:
    return sign.isprintable() or unicodedata.category(sign) == "Zs"


def _escaped(sign: str) -> str:
    r"""``\x1b``, ``\u202e`` or ``\U000e0001``."""
    code = ord(sign)
    if code < 0x100:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def one_line(text: str) -> str:
    """Text in one line; control characters are escaped."""
    return printable(" ".join(line.strip() for line in text.splitlines() if line.strip()))
