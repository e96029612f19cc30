"""What the page `tables` promises of signatures."""

import shutil
import subprocess
from dataclasses import replace

import pytest

import calib.store.signature
from calib.base.errors import DamagedTable, SignatureRefused, StoreError
from calib.store.signature import require_signed, sign, verify_signed
from calib.store.state import Evidence
from calib.store.store import Store
from calib.table.table import Value
from tests.support.killed import killed
from tests.support.signing import (
    ADA,
    EVE,
    NAMESAKE,
    REJECT,
    RELEASE,
    WITHDRAW,
    forget,
    passes,
    refusal,
    replaced_by,
    secret_file,
    set_back,
    used,
)
from tests.support.tables import made_table


@pytest.fixture
def store(signed_store):
    return signed_store


@pytest.fixture
def keys(tmp_path):
    """Ada's keys as the files of minisign."""
    secret, public = tmp_path / "ada.key", tmp_path / "ada.pub"
    secret.write_bytes(secret_file(b"adasline", bytes(range(32))))
    public.write_bytes(ADA.public.file)
    return secret, public


def minisign(*arguments):
    if shutil.which("minisign") is None:
        pytest.skip("minisign is not installed: apt install minisign")
    line = ["minisign", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True, check=False)


# Made and checked by minisign


def test_a_signature_is_checked_by_minisign_and_made_by_minisign(store, keys):
    home, (secret, public) = store.folder / "sedan", keys
    record, signature = home / "v0002" / "record.json", home / "v0002.minisig"
    ran = minisign("-Vm", record, "-x", signature, "-p", public)
    assert ran.returncode == 0, ran.stderr
    stored = store.load("sedan@2")
    head = store.snapshot().journal.head
    line = f"brake-cal table=sedan version=2 digest={stored.digest} journal={head}"
    signature.unlink()
    ran = minisign("-S", "-W", "-s", secret, "-m", record, "-x", signature, "-t", line)
    assert ran.returncode == 0, ran.stderr
    assert used(store).comment == line
    entries = verify_signed(store, ADA.public)[0]
    assert [verdict.signed for verdict in entries] == ["released", "released", None]


# What is refused


def computed_anew(store, tmp_path):
    """Another pad friction in a store that is sound in itself, with Ada's signatures."""
    table = store.load("sedan@2").table
    pads = replace(table.calibration, pad_friction_f=Value(0.5, 0.01))
    forge = Store(tmp_path / "forge")
    forge.save(made_table(27.0), RELEASE)
    forge.save(replace(table, calibration=pads), RELEASE)
    for name in ("v0001.minisig", "v0002.minisig"):
        shutil.copy(store.folder / "sedan" / name, forge.folder / "sedan" / name)
    replaced_by(store, forge)
    assert all(verdict.sound for verdict in store.verify())


def swapped_curve(store, _):
    home = store.folder / "sedan"
    shutil.copy(home / "v0001" / "paper.parquet", home / "v0002" / "paper.parquet")


@pytest.mark.parametrize("damage", [computed_anew, swapped_curve])
def test_a_signed_version_that_was_edited_is_refused(store, tmp_path, damage):
    loaded = store.load("sedan@2")
    damage(store, tmp_path)
    refusal(store)
    assert "sedan@2" in [v.id for v in verify_signed(store, ADA.public)[0] if not v.sound]
    with pytest.raises(StoreError):
        require_signed(loaded, ADA.public)


def test_a_signature_of_another_version_is_refused(store, tmp_path):
    home = store.folder / "sedan"
    shutil.copy(home / "v0001.minisig", home / "v0002.minisig")
    refusal(store)
    used(store, "sedan@1")

    sign(store, "wagon@1", ADA)  # the table of another car, renamed, with the signature of wagon@1
    forge = Store(tmp_path / "forge")
    renamed = forge.save(made_table(), replace(RELEASE, by="Eve"))
    shutil.copy(store.folder / "wagon" / "v0001.minisig", renamed.path.parent / "v0001.minisig")
    refusal(forge, "sedan@1")

    shutil.rmtree(home / "v0002")
    shutil.copytree(store.folder / "wagon" / "v0001", home / "v0002")
    shutil.copy(store.folder / "wagon" / "v0001.minisig", home / "v0002.minisig")
    with pytest.raises(DamagedTable):
        store.load("sedan@2")


def test_a_comment_without_a_head_at_which_it_was_stored_is_refused(store):
    """The key signed the right record, with a comment that a person wrote by hand."""
    first = store.snapshot().journal.entries[0].hash
    home = store.folder / "sedan"
    record = (home / "v0002" / "record.json").read_bytes()
    heads = (f"brake-cal journal={first}", "brake-cal journal=", "journal=")
    for comment in (*heads, "my best table"):
        (home / "v0002.minisig").write_bytes(ADA.sign(record, comment))
        refusal(store)


def test_a_version_without_a_signature_of_the_key_is_refused(store):
    store.judge("wagon@1", RELEASE)
    refusal(store, "wagon@1")
    assert [v.id for v in verify_signed(store, ADA.public)[0] if not v.sound] == ["wagon@1"]
    assert all(v.sound for v in verify_signed(store, ADA.public, "sedan")[0])
    sign(store, "wagon@1", EVE)
    assert EVE.public.key_id in refusal(store, "wagon@1")
    refusal(store, "sedan@2", NAMESAKE)
    sign(store, "wagon@1", ADA)
    assert [v.signed for v in verify_signed(store, ADA.public, "wagon")[0]] == ["released"]
    sign(store, "wagon@1", EVE)
    path = store.folder / "wagon" / "v0001.minisig"
    path.write_bytes(path.read_bytes()[:-9])
    refusal(store, "wagon@1", EVE)


@pytest.mark.parametrize("decision", [REJECT, WITHDRAW])
def test_a_signature_holds_until_the_state_changes(store, decision):
    store.judge("sedan@2", decision)
    refusal(store)
    sign(store, "sedan@2", ADA)
    assert used(store).stored.state.word == decision.state
    assert passes(store)


def test_a_state_that_came_back_without_the_key_is_refused(store):
    """Whoever can write the store can release what was rejected, but cannot sign that."""
    more = replace(RELEASE, evidence=(Evidence("summary.json", "ab" * 32),))
    store.judge("sedan@2", more)
    used(store)  # released again on more evidence is no other state
    store.judge("sedan@2", REJECT)
    store.judge("sedan@2", replace(RELEASE, evidence=(Evidence("summary.json", "cd" * 32),)))
    refusal(store)


def test_an_older_version_is_not_offered_as_the_newest(store):
    """Whoever can write the store can reject sedan@2, or take its signature away."""
    store.judge("sedan@2", REJECT)
    older = store.released("sedan")
    require_signed(older, ADA.public)  # asked for by its number
    signature = store.folder / "sedan" / "v0002.minisig"
    content = signature.read_bytes()
    for _ in range(2):
        with pytest.raises(SignatureRefused) as error:
            require_signed(older, ADA.public, newest=True)
        assert error.value.where == "sedan@2"
        assert not passes(store)
        signature.unlink(missing_ok=True)
    signature.write_bytes(content)
    sign(store, "sedan@2", ADA)
    assert require_signed(older, ADA.public, newest=True).stored.version == 1
    never = store.save(made_table(31.0), REJECT)  # one that was never released
    shutil.rmtree(never.path)
    assert require_signed(older, ADA.public, newest=True).stored.version == 1


# The journal set back


def test_a_journal_that_does_not_contain_what_was_signed_is_refused(store, seen_file, tmp_path):
    length = len(store.snapshot().journal.entries)
    store.judge("sedan@2", WITHDRAW)
    sign(store, "sedan@2", ADA)
    set_back(store, length)  # the newer signature is still there
    forget(seen_file)
    assert store.released("sedan").version == 2
    for version in ("sedan@2", "sedan@1"):  # of whatever version
        refusal(store, version)
    with pytest.raises(SignatureRefused):
        sign(store, "wagon@1", ADA)
    assert not (store.folder / "wagon" / "v0001.minisig").exists()
    assert len(store.snapshot().journal.entries) == length

    other = Store(tmp_path / "other")  # the same versions, whose journal has another first line
    for stiffness in (27.0, 28.0):
        other.save(made_table(stiffness), replace(RELEASE, by="Eve"))
    shutil.copy(store.folder / "sedan" / "v0001.minisig", other.folder / "sedan")
    assert other.load("sedan@1").record_digest == store.load("sedan@1").record_digest
    refusal(other, "sedan@1")


# Writing


def test_if_signing_is_interrupted_no_wrong_signature_is_left(store, seen_file, monkeypatch):
    """On a full disk, and before each change of the disk by kill -9."""
    path = store.folder / "sedan" / "v0002.minisig"
    content = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    for version in ("sedan@2", "wagon@1"):
        with monkeypatch.context() as patch:
            patch.setattr(calib.store.signature, "write_whole", full)
            with pytest.raises(StoreError):
                sign(store, version, ADA)
    assert path.read_bytes() == content
    assert not (store.folder / "wagon" / "v0001.minisig").exists()

    for step in range(100):
        stopped = killed(lambda: sign(store, "wagon@1", ADA), step)
        assert passes(store)
        if not stopped:
            break
    assert step > 3
    used(store, "wagon@1")


def test_a_path_is_signed_in_its_own_store_and_nowhere_else(store, tmp_path):
    path = store.folder / "sedan" / "v0002"
    require_signed(Store("elsewhere").load(str(path)), ADA.public)
    shutil.copytree(path, tmp_path / "taken" / "v0002")
    with pytest.raises(StoreError):
        require_signed(store.load(str(tmp_path / "taken" / "v0002")), ADA.public)


def test_a_key_shows_itself_by_its_number_only(store, seen_file, keys):
    sign(store, "wagon@1", ADA)
    words = [key.read_text().split("\n")[1] for key in keys]
    files = [p for p in (*store.folder.rglob("*"), seen_file) if p.is_file()]
    assert len(files) > 12
    for path in files:
        content = path.read_bytes().decode(errors="replace")
        assert bytes(range(32)).hex() not in content
        # the secret half of the secret key, the point of the public one
        assert not any(word[i : i + 16] in content for word in words for i in range(16, 40))
