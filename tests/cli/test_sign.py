"""`brake-cal tables sign`, `verify --key`, and `--require-signed` where tables are used."""

import io
import sys

import pytest

from calib.store.minisign import generate
from calib.store.store import Store
from tests.cli.conftest import parsed
from tests.support.signing import ADA, EVE, secret_file

pytestmark = pytest.mark.usefixtures("seen_file")

SEED = bytes(range(32))
SAMPLES = "sample_logs/sedan"


@pytest.fixture
def secret(tmp_path):
    path = tmp_path / "ada.key"
    path.write_bytes(secret_file(b"adasline", SEED))
    return path


@pytest.fixture
def public(tmp_path):
    path = tmp_path / "ada.pub"
    path.write_bytes(ADA.public.file)
    return path


@pytest.fixture
def signed(tables, secret):
    """The store of sedan@1, released and signed."""
    assert tables("sign", "sedan@1", "--key", secret).code == 0


def test_sign_json(tables, secret, store):
    head = Store(store).snapshot().journal.head
    document = parsed(tables("sign", "sedan@1", "--key", secret, "--json"))
    stored = Store(store).load("sedan@1")
    comment = document.pop("trusted_comment")
    assert comment.endswith(f"state=released digest={stored.digest} journal={head}")
    assert document == {
        "schema": 1,
        "table": "sedan@1",
        "digest": stored.digest,
        "state": "released",
        "key_id": ADA.public.key_id,
        "record": f"{store}/sedan/v0001/record.json",
        "signature": f"{store}/sedan/v0001.minisig",
    }


def test_the_password_is_typed_and_shown_nowhere(tables, tmp_path, monkeypatch, store):
    path = tmp_path / "locked.key"
    cheap = {"opslimit": 2**15, "memlimit": 2**24}
    monkeypatch.setattr("calib.store.minisign._SCRYPT", cheap)
    generate(path, tmp_path / "locked.pub", "Bremse 1")
    for typed, code in ((b"Bremse 2\n", 3), (b"", 2), (b"Bremse 1\n", 0)):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(typed), encoding="utf-8"))
        ran = tables("sign", "sedan@1", "--key", path)
        assert ran.code == code
        assert "Bremse" not in ran.out + ran.err
        assert (store / "sedan" / "v0001.minisig").exists() == (code == 0)


def test_verify_with_a_key(tables, signed, two, public):
    ran = tables("verify", "--key", public)
    assert ran.code == 0
    document = parsed(tables("verify", "--key", ADA.public.text, "--json"))
    assert [row["signed"] for row in document["versions"]] == ["released", None, None]
    ran = tables("verify", "--key", EVE.public.text, "--json")
    assert ran.code == 4
    assert ADA.public.key_id in ran.out
    assert EVE.public.key_id in ran.out
    assert tables("verify", "--key", "no.pub").code == 3


USES = {
    "export": ("tables", "export", "sedan@1", "--format", "csv", "--unreleased"),
    "validate": (
        "validate", "sedan@1", f"{SAMPLES}/dry_asphalt_stop.csv",
        "--vehicle", f"{SAMPLES}/vehicle.toml",
    ),
    "station": (
        "station", f"{SAMPLES}/ramp_wet_asphalt.csv", f"{SAMPLES}/dry_asphalt_stop.csv",
        "--vehicle", f"{SAMPLES}/vehicle.toml", "--golden", "sedan@1",
    ),
}  # fmt: skip


@pytest.fixture
def use(brake_cal, store, tmp_path):
    """Run a command that uses sedan@1 of the store."""

    def run(name, *options):
        out = tmp_path / "out"
        return brake_cal(*USES[name], "--store", store, "--out", out, *options)

    return run


@pytest.mark.parametrize("name", USES)
def test_require_signed_goes_on_only_with_what_is_signed(use, signed, public, tmp_path, name):
    """The made table is of another car than the logs: validate and station stop there."""
    ran = use(name, "--require-signed", "--key", EVE.public.text)
    assert (ran.code, ran.result) == (4, "")
    assert not (tmp_path / "out").exists()
    ran = use(name, "--require-signed", "--key", public)
    assert f"sedan@1 is signed as released by key {ADA.public.key_id}\n" in ran.err
    assert ran.code == (0 if name == "export" else 3)


def test_a_pair_of_keys_is_made_and_never_replaced(tables, tmp_path, monkeypatch):
    key, pub = tmp_path / "line.key", tmp_path / "line.pub"
    make = ("sign", "--key", key, "--new-key", pub)
    for typed in (b"Bremse 1\nBremse 2\n", b"Bremse 1\n", b""):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(typed), encoding="utf-8"))
        ran = tables(*make)
        assert (ran.code, key.exists(), "Bremse" in ran.err) == (2, False, False)
    document = parsed(tables(*make, "--no-password", "--json"))
    assert document["public_key"] in pub.read_text()
    content = key.read_bytes()
    assert tables(*make, "--no-password").code == 3
    assert key.read_bytes() == content
    assert tables("sign", "sedan@1", "--key", key).code == 0
    assert tables("verify", "--key", pub).code == 0
    for wrong in (("sedan@1", *make[1:]), ("sedan@1", "--key", key, "--no-password"), make[1:3]):
        assert tables("sign", *wrong).code == 2
