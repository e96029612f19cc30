"""From a password to the bytes that hide a secret key: scrypt, as libsodium chooses it."""

from dataclasses import dataclass

from calib.errors import KeyFileError
from calib.signing.library import need
from calib.signing.lines import Refuse

LONGEST = 1022
"""Bytes of a password that minisign reads from one line."""

MOST_MEMORY = 2**31
MOST_WORK = 2**28
"""Eight times the work of a key of minisign: about half a minute."""

BLOCK = 8
"""r of scrypt."""


@dataclass(frozen=True)
class Cost:
    """What a password costs to try: scrypt's work (operations) and memory (bytes)."""

    work: int
    memory: int


SENSITIVE = Cost(2**25, 2**30)
"""What minisign takes: 1 GiB, a few seconds."""


def check_cost(cost: Cost, refuse: Refuse) -> None:
    """Raise the error of ``refuse`` if the cost is more than a key of minisign can ask for."""
    if cost.memory > MOST_MEMORY:
        raise refuse(f"asks for {cost.memory / 2**30:.4g} GiB of memory", expected="at most 2 GiB")
    if cost.work > MOST_WORK:
        times = cost.work / SENSITIVE.work
        raise refuse(
            f"asks for {times:.4g} times the work of a key of minisign",
            expected=f"at most {MOST_WORK // SENSITIVE.work} times",
        )


def check_new_password(password: str) -> None:
    """Raise KeyFileError if minisign could not read the password from one line."""
    content = _bytes_of(password, KeyFileError)
    if any(sign in content for sign in b"\0\r\n"):
        raise KeyFileError("the password has a line end or a zero character")
    if len(content) > LONGEST:
        raise KeyFileError(f"the password has {len(content)} bytes", expected=f"at most {LONGEST}")


def mask(password: str, salt: bytes, cost: Cost, size: int, refuse: Refuse) -> bytes:
    """``size`` bytes that only the password gives; ``cost`` has passed `check_cost`.

    Raises the error of ``refuse`` if there is not enough memory.
    """
    n, p = scrypt_numbers(cost)
    scrypt = need("cryptography.hazmat.primitives.kdf.scrypt").Scrypt
    try:
        stream: bytes = scrypt(salt=salt, length=size, n=n, r=BLOCK, p=p).derive(
            _bytes_of(password, refuse)
        )
    except MemoryError:
        megabytes = 128 * BLOCK * n / 2**20
        raise refuse(
            f"its password needs {megabytes:.0f} MiB of memory, which is not free"
        ) from None
    return stream


def scrypt_numbers(cost: Cost) -> tuple[int, int]:
    """N and p of scrypt for a cost, as `pickparams` of libsodium 1.0.18 has them.

    >>> scrypt_numbers(SENSITIVE)
    (1048576, 1)
    """
    work = max(cost.work, 2**15)
    by_work = work < cost.memory // 32
    most = work // (4 * BLOCK) if by_work else cost.memory // (128 * BLOCK)
    n = 2
    while n <= most // 2:
        n *= 2
    return n, 1 if by_work else min(work // 4 // n, 2**30 - 1) // BLOCK


def _bytes_of(password: str, refuse: Refuse) -> bytes:
    """The bytes that were typed; the error of the codec would show the password."""
    try:
        return password.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        raise refuse("the password is not text") from None
