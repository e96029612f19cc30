"""Sign data, and verify a signature: Ed25519 of RFC 8032 over BLAKE2b of RFC 7693."""

from hashlib import blake2b

from calib.errors import SignatureRefused
from calib.signing.library import ed25519, need
from calib.signing.lines import TRUSTED, UNTRUSTED, comment_fault
from calib.signing.public_key import PublicKey
from calib.signing.secret_key import SecretKey
from calib.signing.signature import PREHASHED, Signature

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
