"""Signature files of minisign: four lines.

untrusted comment: anybody can change this text
algorithm 2, key number 8, signature of the data 64      as base64
trusted comment: signed with the signature
signature of the signature and the trusted comment 64    as base64
"""

from dataclasses import dataclass
from functools import partial

from calib.errors import SignatureRefused
from calib.signing.lines import (
    TRUSTED,
    UNTRUSTED,
    file_of,
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
