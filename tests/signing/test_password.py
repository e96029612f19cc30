"""scrypt with the numbers of libsodium, against libsodium itself."""

import ctypes
import ctypes.util

import pytest

from calib.errors import KeyFileError
from calib.signing.password import Cost, check_cost, check_new_password, mask, scrypt_numbers

LIBRARY = ctypes.util.find_library("sodium")

COSTS = [
    Cost(0, 0),
    Cost(2**15, 2**24),  # work limits N
    Cost(2**20, 2**25),  # both, as minisign halves them
    Cost(2**20 - 1, 2**25),
    Cost(2**22, 2**22),  # memory limits N: p is 8 and more
    Cost(2**20 + 12345, 3_000_000),
    Cost(100_000, 2**31),
]


@pytest.mark.skipif(LIBRARY is None, reason="libsodium is not installed: apt install libsodium23")
@pytest.mark.parametrize("cost", COSTS, ids=str)
def test_the_bytes_are_those_of_libsodium(cost):
    password, salt, stream = "Grüne Bremse", bytes(range(32)), ctypes.create_string_buffer(104)
    typed = password.encode()
    done = ctypes.CDLL(LIBRARY).crypto_pwhash_scryptsalsa208sha256(
        *(stream, ctypes.c_ulonglong(104), typed, ctypes.c_ulonglong(len(typed)), salt),
        *(ctypes.c_ulonglong(cost.work), ctypes.c_size_t(cost.memory)),
    )
    assert done == 0
    assert mask(password, salt, cost, 104, KeyFileError) == stream.raw


@pytest.mark.parametrize("memory", [2**31, 2**30, 12345678, 2**20, 1024, 1, 0])
@pytest.mark.parametrize("work", [2**28, 2**25, 2**15, 1, 0])
def test_no_cost_that_is_accepted_takes_more_memory_than_it_says(work, memory):
    cost = Cost(work, memory)
    check_cost(cost, KeyFileError)
    n, p = scrypt_numbers(cost)
    assert 128 * 8 * n <= max(memory, 2048)
    assert p >= 1
    assert 4 * 8 * n * p <= max(work, 2**15)


@pytest.mark.parametrize("password", ["two\nlines", "\r", "a\0b", "é" * 511 + "e", "\ud800"])
def test_a_password_that_minisign_cannot_read_is_refused_and_not_shown(password):
    with pytest.raises(KeyFileError, match="the password ") as refusal:
        check_new_password(password)
    assert password not in str(refusal.value)


@pytest.mark.parametrize("password", ["", " ", "é" * 511, "\udcff"])
def test_any_other_is_accepted(password):
    check_new_password(password)
