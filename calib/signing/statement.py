"""What the signature of a table says: one line, its trusted comment."""

import re
from dataclasses import dataclass, fields

from calib.errors import SignatureRefused

STATES = ("draft", "released", "rejected", "withdrawn")

_PARTS = {
    "table": r"[A-Za-z0-9._-]{1,100}",
    "version": r"[1-9][0-9]{0,5}",
    "state": "|".join(STATES),
    "digest": r"[0-9a-f]{64}",
    "head": r"[0-9a-f]{64}",
}
_LINE = re.compile(
    "brake-cal table=({table}) version=({version}) state=({state})"
    " digest=({digest}) journal=({head})".format(**_PARTS)
)


@dataclass(frozen=True)
class Statement:
    """That a version of a table had a state when it was signed.

    Attributes
    ----------
    table, version : the name of the table and the number of its version, 1 to 999999.
    state : one of `STATES`.
    digest : SHA-256 of the content of the version, 64 characters.
    head : SHA-256 of the newest entry of the store's journal, 64 characters.

    Raises ValueError for a value that has no place in the line.

    >>> print(Statement("sedan", 3, "released", "0" * 64, "f" * 64).line[:56])
    brake-cal table=sedan version=3 state=released digest=00
    """

    table: str
    version: int
    state: str
    digest: str
    head: str

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not re.fullmatch(_PARTS[field.name], str(value)):
                raise ValueError(f"{field.name} {value!r} has no place in a signature")

    @property
    def line(self) -> str:
        """The statement as a trusted comment."""
        return (
            f"brake-cal table={self.table} version={self.version} state={self.state}"
            f" digest={self.digest} journal={self.head}"
        )


def parse_statement(line: str, where: object = None) -> Statement:
    """The statement in a trusted comment; ``where`` is the name of the signature in messages.

    Raises SignatureRefused for every line that is not the one spelling of a statement.
    """
    found = _LINE.fullmatch(line)
    if not found:
        raise SignatureRefused(
            "its trusted comment is not that of a table",
            where=where,
            expected="brake-cal table=... version=... state=... digest=... journal=...",
        )
    table, version, state, digest, head = found.groups()
    return Statement(table, int(version), state, digest, head)
