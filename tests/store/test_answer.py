"""The answer on a table: for what it is usable, how far, what limits it."""

import pytest

from calib.store.answer import answer, verdict, verdict_lines
from calib.store.state import StateDecision
from calib.store.store import Store
from tests.support.tables import made_table

REACH = ", up to 0.29 g (the ramp ends); pads known to "
"""The last row of the made table, at 0.30 g, is extrapolated."""


@pytest.mark.parametrize(
    ("word", "use"),
    [
        ("draft", f"usable for trials and for a validation, not for an ECU{REACH}"),
        ("released", f"usable for an ECU{REACH}"),
        ("rejected", "usable for nothing: it is rejected"),
        ("withdrawn", "usable for nothing: it is withdrawn"),
    ],
)
def test_each_state_has_its_use(store, word, use):
    stored = Store(store).save(made_table(), StateDecision(word, "made for a test"))
    assert verdict(stored).startswith(use)
    first, last = verdict_lines(stored)
    assert first == f"sedan@1 is {verdict(stored)}"
    assert last == f"next: {answer(stored).next}"


def test_the_widths_are_those_of_the_intervals(store):
    stored = Store(store).save(made_table())
    for pads, axle in (
        (stored.table.calibration.pad_friction_f, "front"),
        (stored.table.calibration.pad_friction_r, "rear"),
    ):
        assert f"{100 * 1.96 * pads.sigma / pads.value:.0f} % {axle}" in verdict(stored)
