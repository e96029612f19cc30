"""Signatures of minisign: a file of four lines, made, verified, and what that of a table says.

untrusted comment: anybody can change this text
algorithm 2, key number 8, signature of the data 64      as base64
trusted comment: signed with the signature
signature of the signature and the trusted comment 64    as base64
"""

import re
from dataclasses import dataclass, fields
from functools import partial
from hashlib import blake2b

from calib.base.errors import SignatureRefused
from calib.store.minisign_keys import PublicKey, SecretKey
from calib.store.minisign_lines import (
    TRUSTED,
    UNTRUSTED,
    comment_fault,
    ed25519,
    file_of,
    need,
    parse_base64,
    parse_comment,
    spelled,
    split_lines,
)

PREHASHED, LEGACY = b"ED", b"Ed"
"""Algorithms: Ed25519 of the data's BLAKE2b-512, and of the data itself."""


@dataclass(frozen=True)
class Signature:
    """The content of a signature file.

    Attributes
    ----------
    algorithm : `PREHASHED` or `LEGACY`.
    number : key number, 8 bytes.
    of_data : signature of the data or of its hash, 64 bytes.
    trusted_comment : text that is signed; to be believed only after `verify`.
    of_comment : signature of ``of_data`` and the trusted comment, 64 bytes.
    untrusted_comment : text that is not signed.
    """

    algorithm: bytes
    number: bytes
    of_data: bytes
    trusted_comment: str
    of_comment: bytes
    untrusted_comment: str

    @property
    def key_id(self) -> str:
        """The number of the key that made it, as minisign prints it."""
        return spelled(self.number)

    @property
    def file(self) -> bytes:
        """The content of the signature file."""
        return file_of(
            UNTRUSTED + self.untrusted_comment,
            self.algorithm + self.number + self.of_data,
            TRUSTED + self.trusted_comment,
            self.of_comment,
        )


def parse_signature(content: bytes, where: object = None) -> Signature:
    """Read the content of a signature file; ``where`` is its name in messages.

    Raises SignatureRefused if it is cut off or otherwise not a signature file of minisign. Nothing
    is verified.
    """
    refuse = partial(SignatureRefused, where="signature" if where is None else where)
    untrusted, text, trusted, proof = split_lines(content, 4, refuse)
    untrusted_comment = parse_comment(untrusted, UNTRUSTED, refuse)
    signed = parse_base64(text, 2 + 8 + 64, "signature", refuse)
    if signed[:2] not in (PREHASHED, LEGACY):
        raise refuse("has an unknown algorithm", expected="Ed25519, the only one of minisign")
    return Signature(
        algorithm=signed[:2],
        number=signed[2:10],
        of_data=signed[10:],
        trusted_comment=parse_comment(trusted, TRUSTED, refuse),
        of_comment=parse_base64(proof, 64, "signature of the trusted comment", refuse),
        untrusted_comment=untrusted_comment,
    )


COMMENT = "signature from brake-cal"


def sign(
    key: SecretKey, data: bytes, trusted_comment: str, untrusted_comment: str = COMMENT
) -> bytes:
    """The content of the signature file of ``data``; it is prehashed, as minisign's own are.

    The trusted comment is signed too, the untrusted one is not. Raises ValueError for a comment
    that is more than one line of text or too long for minisign.
    """
    for text, prefix in ((trusted_comment, TRUSTED), (untrusted_comment, UNTRUSTED)):
        fault = comment_fault(text, prefix)
        if fault:
            raise ValueError(f"the {prefix.rstrip(': ')} {fault}")
    of_data = key.signature_of(_hashed(data))
    return Signature(
        algorithm=PREHASHED,
        number=key.public.number,
        of_data=of_data,
        trusted_comment=trusted_comment,
        of_comment=key.signature_of(of_data + trusted_comment.encode()),
        untrusted_comment=untrusted_comment,
    ).file


def verify(public: PublicKey, data: bytes, signature: Signature, where: object = None) -> str:
    """Check that ``signature`` is of ``data`` and of the key; returns the trusted comment.

    ``where`` is the name of the signature in messages. Raises SignatureRefused if it is of another
    key, or if the data or the trusted comment is not what was signed. The untrusted comment is not
    signed: any text is accepted there.
    """
    where = "signature" if where is None else where
    if signature.number != public.number:
        raise SignatureRefused(
            f"is of key {signature.key_id}", where=where, expected=f"key {public.key_id}"
        )
    message = _hashed(data) if signature.algorithm == PREHASHED else data
    if not _holds(public, signature.of_data, message):
        raise SignatureRefused(
            f"does not hold with key {public.key_id}: the data is not what was signed", where=where
        )
    signed_comment = signature.of_data + signature.trusted_comment.encode()
    if not _holds(public, signature.of_comment, signed_comment):
        raise SignatureRefused(
            f"does not hold with key {public.key_id}: its trusted comment is not what was signed",
            where=where,
        )
    return signature.trusted_comment


def _hashed(data: bytes) -> bytes:
    return blake2b(data).digest()


def _holds(public: PublicKey, signature: bytes, message: bytes) -> bool:
    invalid = need("cryptography.exceptions").InvalidSignature
    try:
        ed25519().Ed25519PublicKey.from_public_bytes(public.point).verify(signature, message)
    except invalid:
        return False
    return True


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
