"""Facts of a diagnosis, from an answer that is written down in `tests.support`."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.catalogue import CATALOGUE
from calib.diagnosis.diagnosis import to_dict
from calib.show.diagnosis import KINDS, diagnosis_facts, outcome
from calib.show.diagnosis_figure import diagnosis_sheet
from calib.show.html import page_of
from tests.support.written_diagnosis import MARKUP, named_drag, unknown


@pytest.fixture(scope="module")
def named():
    return named_drag()


def within(found):
    return replace(found, gap=replace(found.gap, squares=0.01 * found.gap.squares))


def rest(found):
    return replace(found, unexplained=unknown(found).unexplained)


def worse(found):
    return replace(found, gap=replace(found.gap, squares=found.gap.squares[[0, 0]]))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda found: found, "named"),
        (rest, "rest"),
        (worse, "worse"),
        (lambda found: worse(replace(found, verdict="ambiguous")), "worse"),
        (lambda found: replace(found, verdict="ambiguous"), "ambiguous"),
        (lambda found: replace(rest(found), verdict="ambiguous"), "ambiguous_rest"),
        (unknown, "unknown"),
        (lambda found: within(unknown(found)), "within_noise"),
        (lambda found: replace(found, verdict="no_gap", effects=()), "no_gap"),
    ],
)
def test_a_name_is_good_only_if_the_hold_outs_say_so(named, change, expected, monkeypatch):
    monkeypatch.setattr("calib.show.html._panel", lambda sheet, name: "data:image/svg+xml,")
    found = change(named)
    told = diagnosis_facts(found)
    assert outcome(found) == expected
    assert (told.word, told.verdict) == KINDS[expected]
    assert page_of(told).count("<section>") >= 2


def test_a_named_cause_has_its_numbers_and_its_card(named):
    told = diagnosis_facts(named)
    numbers = [x for x in dict(told.rows)["gap"].replace(",", "").split() if x[0].isdigit()]
    assert numbers == ["6.7", "3.7", "45.7", "1"]
    effect, _, gap, base = told.parts
    assert effect.title == "Aerodynamic drag"
    assert dict(effect.rows)["Cause"] == CATALOGUE["aerodynamic_drag"].card.cause
    log, noise = gap.tables[0].rows
    assert log[:3] == (f"1 {MARKUP}", "6.7 to 3.7", "0.5 to 0.5")
    assert log[-1] == "4.0 to 8.0"
    assert (noise[2], noise[-1]) == ("0.0625 m/s^2", "0.0625 m/s")
    assert base.tables[0].rows[1][3] == ""  # a vehicle file says nothing of the tyres


def test_an_unknown_cause_is_described_by_its_term(named):
    found = unknown(named)
    (line,) = next(one for one in diagnosis_sheet(found).panels if one.name == "term").lines
    assert line.x == pytest.approx([0.0, 25.0])  # bar
    assert line.y == [0.0, -12.5]  # per cent


@pytest.mark.parametrize(("count", "length"), [(1, 8), (4, 8), (1, 80), (12, 60)])
def test_pictures_stay_readable_with_five_effects_and_long_names(named, count, length):
    """Axes that collapse are a warning of matplotlib, and so an error here."""
    five = tuple(replace(named.effects[0], name=name) for name in [*CATALOGUE][:5])
    logs = tuple(replace(named.measured[0], name=f"{i:02}" * (length // 2)) for i in range(count))
    squares = np.repeat(named.gap.squares, count, axis=1)
    gap = replace(named.gap, logs=tuple(log.name for log in logs), squares=squares)
    found = replace(
        named, effects=five, gap=gap, replays_before=logs, replays_after=logs, measured=logs
    )
    drawn = diagnosis_sheet(found)
    for figure in (drawn.overview(), *(drawn.figure(name) for name in drawn.names)):
        figure.canvas.draw()
        whole = figure.get_window_extent()
        for ax in figure.axes:
            across = 0.3 if len(figure.axes) > 1 else 0.7
            assert ax.get_window_extent().width > across * whole.width
            last = whole.x0
            for text in ax.texts:
                box = text.get_window_extent()
                assert last <= box.x0
                last = box.x1
            assert last <= whole.x1
    known = page_of(diagnosis_facts(found))
    assert all(log.name in known for log in logs)


def test_what_was_withdrawn_is_told(named):
    found = replace(unknown(named), withdrawn=(("rear_proportioning", "mass_error"),))
    told = dict(diagnosis_facts(found).rows)["Not named"]
    assert "rear proportioning" in told
    assert "mass error" in told
    assert to_dict(found)["withdrawn"] == [["rear_proportioning", "mass_error"]]
