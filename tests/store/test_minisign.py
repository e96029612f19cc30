"""Both directions against the program `minisign` itself."""

import shutil
import stat
import subprocess
from itertools import count

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from calib.base.errors import KeyFileError, SignatureRefused
from calib.store.minisign import parse_signature, sign, verify
from calib.store.minisign_keys import SENSITIVE, Cost, generate, read_public_key, read_secret_key
from tests.store.conftest import never
from tests.store.golden.make import little_memory

pytestmark = pytest.mark.skipif(
    shutil.which("minisign") is None, reason="minisign is not installed: apt install minisign"
)

CHEAP = Cost(2**15, 2**24)
DATA = bytes(range(256)) * 300
COMMENT = "brake-cal table=Käfer version=3"


@pytest.fixture
def minisign(tmp_path):
    """Run minisign in a folder with data.bin; its passwords are typed into its input.

    With little memory it makes keys whose password takes little time; it cannot read `SENSITIVE`.
    """
    (tmp_path / "data.bin").write_bytes(DATA)

    def run(*arguments, typed="", limit=little_memory):
        return subprocess.run(
            ["minisign", *map(str, arguments)],
            cwd=tmp_path,
            input=typed,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=limit,
        )

    return run


@pytest.mark.parametrize(
    ("password", "cost"), [("", CHEAP), ("Bremse 9", CHEAP), ("é" * 511, CHEAP), ("b", SENSITIVE)]
)
def test_our_keys_work_in_minisign(minisign, tmp_path, password, cost):
    public = generate(tmp_path / "car.key", tmp_path / "car.pub", password, cost)
    signing = ("-S", "-s", "car.key", "-p", "car.pub", "-m", "data.bin", "-t", COMMENT)
    limit = None if cost == SENSITIVE else little_memory
    ran = minisign(*signing, typed=f"{password}\n", limit=limit)
    assert ran.returncode == 0, ran.stderr
    signature = parse_signature((tmp_path / "data.bin.minisig").read_bytes())
    assert verify(public, DATA, signature) == COMMENT
    # what minisign makes of our secret key is our public key
    again = ("-R", "-s", "car.key", "-p", "again.pub")
    assert minisign(*again, typed=f"{password}\n", limit=limit).returncode == 0
    assert (tmp_path / "again.pub").read_bytes() == (tmp_path / "car.pub").read_bytes()


def test_our_wrong_password_is_wrong_in_minisign(minisign, tmp_path):
    generate(tmp_path / "car.key", tmp_path / "car.pub", "Bremse 9", CHEAP)
    ran = minisign("-S", "-s", "car.key", "-m", "data.bin", typed="Bremse 8\n")
    assert (ran.returncode, "Wrong password" in ran.stderr) == (2, True)


@pytest.mark.parametrize("comment", ["", COMMENT, "\t", "é" * 4086])
def test_our_signatures_hold_in_minisign(minisign, tmp_path, comment):
    public = generate(tmp_path / "car.key", tmp_path / "car.pub", "")
    key = read_secret_key(tmp_path / "car.key", never)
    (tmp_path / "data.bin.minisig").write_bytes(sign(key, DATA, comment))
    for way in (("-p", "car.pub"), ("-P", public.text)):
        ran = minisign("-V", "-H", "-Q", *way, "-m", "data.bin")
        assert (ran.returncode, ran.stdout) == (0, f"{comment}\n")


@pytest.mark.parametrize("typed", ["", "Bremse 9\n", "\n"])
@pytest.mark.parametrize("legacy", [(), ("-l",)])
def test_keys_and_signatures_of_minisign_are_ours(minisign, tmp_path, typed, legacy):
    """Also a key that is hidden by an empty password."""
    open_key = ("-W",) if not typed else ()
    ran = minisign("-G", *open_key, "-s", "car.key", "-p", "car.pub", typed=typed * 2)
    assert ran.returncode == 0, ran.stderr
    key = read_secret_key(tmp_path / "car.key", typed.strip if typed else never)
    assert key.public == read_public_key(tmp_path / "car.pub")
    assert minisign("-S", *legacy, "-s", "car.key", "-m", "data.bin", typed=typed).returncode == 0
    signature = parse_signature((tmp_path / "data.bin.minisig").read_bytes())
    assert "file:data.bin" in verify(key.public, DATA, signature)


def test_a_key_whose_password_minisign_took_away_is_read(minisign, tmp_path):
    public = generate(tmp_path / "car.key", tmp_path / "car.pub", "Bremse 9", CHEAP)
    assert minisign("-C", "-W", "-s", "car.key", typed="Bremse 9\n").returncode == 0
    assert read_secret_key(tmp_path / "car.key", never).public == public


def test_a_key_that_minisign_gave_a_password_is_read(minisign, tmp_path):
    public = generate(tmp_path / "car.key", tmp_path / "car.pub", "")
    assert minisign("-C", "-s", "car.key", typed="b\nb\n").returncode == 0
    assert read_secret_key(tmp_path / "car.key", lambda: "b").public == public
    with pytest.raises(KeyFileError, match="the password is wrong"):
        read_secret_key(tmp_path / "car.key", lambda: "c")


def test_the_files_have_the_modes_that_minisign_gives(minisign, tmp_path):
    generate(tmp_path / "ours.key", tmp_path / "ours.pub", "")
    minisign("-G", "-W", "-s", "its.key", "-p", "its.pub")
    for end in ("key", "pub"):
        modes = [
            stat.S_IMODE((tmp_path / f"{who}.{end}").stat().st_mode) for who in ("ours", "its")
        ]
        assert modes[0] == modes[1]


NUMBER = count()


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 400), st.integers(1, 255))
def test_what_we_accept_of_a_changed_file_minisign_accepts(minisign, tmp_path, golden, place, by):
    """The other way need not hold: minisign ignores what follows the last line."""
    content = bytearray((golden / "open.minisig").read_bytes())
    content[place % len(content)] ^= by
    data = (golden / "data.bin").read_bytes()
    name = tmp_path / f"{next(NUMBER)}.bin"
    name.write_bytes(data)
    name.with_suffix(".bin.minisig").write_bytes(content)
    its = minisign("-V", "-q", "-p", golden / "open.pub", "-m", name).returncode == 0
    try:
        verify(read_public_key(golden / "open.pub"), data, parse_signature(bytes(content)))
    except SignatureRefused:
        return
    assert its
