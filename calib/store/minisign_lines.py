"""Files of comment lines and base64 lines, as minisign writes them.

Stricter than minisign, which ignores what follows the last line it needs and the unused bits of
base64: here a file has one spelling, save its line ends, which may be LF or CRLF.
"""

import importlib
from base64 import b64decode, b64encode
from collections.abc import Callable
from pathlib import Path
from typing import Any

from calib.base.bounded import KEY, read_bounded
from calib.base.errors import BrakeCalError, KeyFileError
from calib.base.printable import printable

UNTRUSTED = "untrusted comment: "
TRUSTED = "trusted comment: "
LONGEST = {UNTRUSTED: 1023, TRUSTED: 8191}
"""Bytes of a comment line with its prefix and its line end that minisign reads."""

Refuse = Callable[..., BrakeCalError]
"""Makes the error of a file: the class of the error, with ``where`` filled in."""


def read_small(path: Path, refuse: Refuse) -> bytes:
    """The bytes of a file; no more is read than any file of minisign has.

    Raises the error of ``refuse`` if the file cannot be read or is longer.
    """
    try:
        return read_bounded(path, KEY)
    except OSError as error:
        raise refuse(f"cannot be read ({error.strerror})", do="check the path") from None


def split_lines(content: bytes, count: int, refuse: Refuse) -> list[bytes]:
    """The lines of a file without their ends, LF or CRLF.

    Raises the error of ``refuse`` if there are not ``count`` lines, all with an end.
    """
    expected = f"a file of minisign with {count} lines"
    if len(content) > KEY.most:
        raise refuse(f"is longer than {KEY.most} bytes", expected=expected)
    if not content:
        raise refuse("is empty", expected=expected)
    if not content.endswith(b"\n"):
        raise refuse("is cut off: its last line has no end", expected=expected)
    lines = [line.removesuffix(b"\r") for line in content[:-1].split(b"\n")]
    if len(lines) != count:
        raise refuse(f"has {len(lines)} line{'s' * (len(lines) > 1)}", expected=expected)
    return lines


def parse_comment(line: bytes, prefix: str, refuse: Refuse) -> str:
    """The text of a comment line after its prefix.

    Raises the error of ``refuse`` for another prefix, and for what `check_comment` refuses.
    """
    name = prefix.rstrip(": ")
    if not line.startswith(prefix.encode()):
        raise refuse(f"has no {name} where it belongs", expected=f"a line that opens {prefix!r}")
    try:
        text = line.removeprefix(prefix.encode()).decode()
    except UnicodeDecodeError:
        raise refuse(f"the {name} is not UTF-8") from None
    fault = comment_fault(text, prefix)
    if fault:
        raise refuse(f"the {name} {fault}")
    return text


def comment_fault(text: str, prefix: str) -> str:
    """What is wrong with a comment, in words; "" if minisign and a terminal can take it.

    A comment is one line of UTF-8 without control characters except the tab.
    """
    flat = text.replace("\t", " ")
    if printable(flat) != flat:
        return "has a control character"
    if len(f"{prefix}{text}\n".encode()) > LONGEST[prefix]:
        return f"is longer than {LONGEST[prefix] - len(prefix) - 1} bytes"
    return ""


def parse_base64(line: bytes, size: int, what: str, refuse: Refuse) -> bytes:
    """The ``size`` bytes of a base64 line; ``what`` is its name in the message.

    Raises the error of ``refuse``, which shows nothing of the line.
    """
    expected = f"{4 * -(-size // 3)} characters of base64"
    try:
        content = b64decode(line, validate=True)
    except ValueError:
        raise refuse(f"the {what} is not base64", expected=expected) from None
    if len(content) != size:
        raise refuse(f"the {what} has {len(content)} bytes, not {size}", expected=expected)
    if b64encode(content) != line:
        raise refuse(f"the {what} is not base64 as minisign writes it", expected=expected)
    return content


def file_of(*lines: str | bytes) -> bytes:
    """A file of text lines and of bytes, which are written as base64."""
    texts = [line if isinstance(line, str) else b64encode(line).decode() for line in lines]
    return "".join(f"{text}\n" for text in texts).encode()


def spelled(number: bytes) -> str:
    """A key number of 8 bytes as minisign prints it.

    >>> spelled(bytes([1, 2, 0, 0, 0, 0, 0xAB, 0]))
    'AB000000000201'
    """
    return f"{int.from_bytes(number, 'little'):X}"


def need(module: str) -> Any:
    """Import ``module`` of cryptography.

    Raises KeyFileError that names the extra if cryptography is not installed.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as cause:
        if cause.name is None or cause.name.split(".")[0] != "cryptography":
            raise
        raise KeyFileError(
            "keys are used with cryptography, which is not installed",
            do="pip install 'brake-cal[sign]'",
        ) from cause


def ed25519() -> Any:
    """The module of Ed25519 keys."""
    return need("cryptography.hazmat.primitives.asymmetric.ed25519")
