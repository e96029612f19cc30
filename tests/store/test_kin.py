"""Versions made of the ramp of a rejected one are named."""

from dataclasses import replace

import pytest

from calib.store.kin import refused_kin
from calib.store.state import StateDecision
from calib.store.store import Store
from tests.support.tables import made_table


@pytest.mark.parametrize("word", ["rejected", "withdrawn"])
def test_the_same_ramp_of_a_refused_version_is_found(tmp_path, word):
    store = Store(tmp_path / "tables")
    store.save(made_table(27.0), StateDecision(word, "wet"))
    again = store.save(made_table(28.0))
    assert [other.id for other in refused_kin(store, again)] == ["sedan@1"]
    table = made_table(29.0)
    ramp = replace(table.provenance.logs[0], digest="cd" * 32)
    other = replace(table.provenance, logs=(ramp, *table.provenance.logs[1:]))
    assert refused_kin(store, store.save(replace(table, provenance=other))) == ()
    store.judge("sedan@2", StateDecision("released", "good"))
    assert refused_kin(store, store.load("sedan@2")) != ()
