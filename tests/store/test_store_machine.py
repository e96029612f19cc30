"""The store against a simple model: any order of fits, decisions, kills, losses and copies."""

import shutil
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from calib.base.errors import DamagedTable, StoreError
from calib.store.state import Evidence, StateDecision
from calib.store.store import Store
from tests.support.killed import killed
from tests.support.tables import made_table

TABLES = {x: made_table(float(x)) for x in range(21, 27)}
WORDS = ("released", "rejected", "withdrawn")
FOLLOWS = {
    "draft": {"released", "rejected", "withdrawn"},
    "released": {"released", "rejected", "withdrawn"},
    "rejected": {"rejected", "released", "withdrawn"},
    "withdrawn": set(),
}


@dataclass
class Version:
    content: int
    state: str
    seen: set[str] = field(default_factory=set)
    last: str = ""
    sound: bool = True


class StoreMachine(RuleBasedStateMachine):
    """``model`` every version that ever was; ``strays`` folders nobody stored; ``gone`` deleted."""

    def __init__(self):
        super().__init__()
        self.folder = Path(tempfile.mkdtemp())
        self.store = Store(self.folder / "tables")
        self.model: dict[int, Version] = {}
        self.strays: set[int] = set()
        self.gone: set[int] = set()

    def teardown(self):
        shutil.rmtree(self.folder)

    # Steps

    @rule(content=st.sampled_from(sorted(TABLES)))
    def fit(self, content):
        self.took(content, self.store.save(TABLES[content]), None)

    @rule(content=st.sampled_from(sorted(TABLES)), word=st.sampled_from(WORDS[:2]),
          proof=st.sampled_from("abc"))  # fmt: skip
    def station(self, content, word, proof):
        evidence = (Evidence("station.json", proof),)
        decision = StateDecision(word, "by the station", word, evidence, "s", automatic=True)
        known = self.holder(content)
        now = self.model[known].state if known else "draft"
        kept = now == "withdrawn" or (now, word) == ("rejected", "released")
        stored = self.store.save(TABLES[content], decision)
        self.took(content, stored, None if kept else (word, proof))

    @precondition(lambda self: self.model)
    @rule(word=st.sampled_from(WORDS), proof=st.sampled_from(["", "a", "b", "d"]), data=st.data())
    def decide(self, word, proof, data):
        number = data.draw(st.sampled_from(sorted(self.model)))
        version = self.model[number]
        evidence = (Evidence("summary.json", proof),) if proof else ()
        decision = StateDecision(word, "why", "", evidence, "p")
        if number in self.gone and self.allowed(version, word, proof) and word == "withdrawn":
            assert self.store.withdraw_missing(f"sedan@{number}", decision)
            self.decided(version, word, "")
        elif not version.sound:
            with pytest.raises(DamagedTable):
                self.store.judge(f"sedan@{number}", decision)
        elif self.allowed(version, word, proof):
            state = self.store.judge(f"sedan@{number}", decision).state
            self.decided(version, word, proof)
            assert state.word == word
        else:
            with pytest.raises(StoreError):
                self.store.judge(f"sedan@{number}", decision)

    @rule(content=st.sampled_from(sorted(TABLES)), before=st.integers(0, 24))
    def killed_fit(self, content, before):
        there = {entry.version for entry in self.entries()}
        killed(lambda: self.store.save(TABLES[content]), before)
        new = {entry.version for entry in self.entries()} - there
        assert len(new) <= 1
        for number in new:  # whole or not at all: the invariant reads it
            assert self.holder(content) is None
            self.model[number] = Version(content, "draft")

    @precondition(lambda self: self.model)
    @rule(before=st.integers(0, 12), data=st.data())
    def killed_decision(self, before, data):
        number = data.draw(st.sampled_from(sorted(self.model)))
        version = self.model[number]
        if not version.sound or version.state == "withdrawn":
            return
        decision = StateDecision("withdrawn", "why", by="k")
        killed(lambda: self.store.judge(f"sedan@{number}", decision), before)
        state = next(e.state for e in self.entries() if e.version == number)
        assert state.word in (version.state, "withdrawn")
        if state.word == "withdrawn":
            self.decided(version, "withdrawn", "")

    @precondition(lambda self: any(v.sound for v in self.model.values()))
    @rule(data=st.data(), kind=st.sampled_from(["delete", "edit", "swap"]))
    def damage(self, data, kind):
        number = data.draw(st.sampled_from([n for n, v in self.model.items() if v.sound]))
        path = self.path(number)
        if kind == "delete":
            shutil.rmtree(path)
            self.gone.add(number)
        elif kind == "edit":
            text = (path / "record.json").read_text()
            (path / "record.json").write_text(text.replace("1744.0", "1745.0"))
        else:
            curve = path / "paper.parquet"
            curve.write_bytes(curve.read_bytes().replace(b"PAR1", b"PAR2"))
        self.model[number].sound = False

    @precondition(lambda self: any(v.sound for v in self.model.values()))
    @rule(data=st.data())
    def copy(self, data):
        number = data.draw(st.sampled_from([n for n, v in self.model.items() if v.sound]))
        stray = max([*self.model, *self.strays]) + 2
        shutil.copytree(self.path(number), self.home / f"v{stray:04d}")
        self.strays.add(stray)

    # The model

    @property
    def home(self):
        return self.store.folder / "sedan"

    def path(self, number):
        final = self.home / f"v{number:04d}"
        return final if final.is_dir() else self.home / f".new-v{number:04d}"

    def entries(self):
        return self.store.list() if self.store.folder.is_dir() else ()

    def holder(self, content):
        found = [n for n, v in self.model.items() if v.content == content and v.sound]
        return max(found, default=None)

    @staticmethod
    def allowed(version, word, proof):
        if version.state == word and version.last == proof:
            return True
        if word not in FOLLOWS[version.state]:
            return False
        back = (version.state, word) == ("rejected", "released")
        return not back or bool(proof and proof not in version.seen)

    @staticmethod
    def decided(version, word, proof):
        version.state, version.last = word, proof
        version.seen |= {proof} - {""}

    def took(self, content, stored, decision):
        known = self.holder(content)
        if known is None:
            assert stored.version not in {*self.model, *self.strays}
            assert not stored.existed
            self.model[stored.version] = Version(content, "draft")
        else:
            assert (stored.version, stored.existed) == (known, True)
        if decision is not None:
            self.decided(self.model[stored.version], *decision)
        assert stored.state.word == self.model[stored.version].state

    @invariant()
    def the_store_is_the_model(self):
        entries = {entry.version: entry for entry in self.entries()}
        assert set(entries) == set(self.model)
        for number, version in self.model.items():
            assert entries[number].state.word == version.state
            assert entries[number].sound == version.sound
            if version.sound:
                assert entries[number].stored.digest == TABLES[version.content].digest

    @invariant()
    def verify_finds_what_is_wrong_and_nothing_else(self):
        if not self.model:
            return
        wrong = {v.id for v in self.store.verify() if not v.sound}
        given_up = {n for n in self.gone if self.model[n].state == "withdrawn"}
        damaged = {n for n, v in self.model.items() if not v.sound} - given_up
        assert wrong == {f"sedan@{n}" for n in damaged | self.strays}

    @invariant()
    def a_bare_name_means_what_is_promised(self):
        if not self.model:
            return
        for find, words in (
            (self.store.load, ("draft", "released")),
            (self.store.released, ("released",)),
        ):
            fit = [n for n, v in self.model.items() if v.state in words]
            if fit and self.model[max(fit)].sound:
                assert find("sedan").version == max(fit)
            else:
                with pytest.raises(StoreError):
                    find("sedan")


TestStoreMachine = StoreMachine.TestCase
TestStoreMachine.settings = settings(
    max_examples=3, stateful_step_count=25, deadline=None,
    suppress_health_check=list(HealthCheck),
)  # fmt: skip
