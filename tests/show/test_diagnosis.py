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


def within_noise(diagnosis):
    return replace(diagnosis, gap=replace(diagnosis.gap, squares=0.01 * diagnosis.gap.squares))


def with_unexplained(diagnosis):
    return replace(diagnosis, unexplained=unknown(diagnosis).unexplained)


def without_gain(diagnosis):
    return replace(diagnosis, gap=replace(diagnosis.gap, squares=diagnosis.gap.squares[[0, 0]]))


def ambiguous(diagnosis):
    return replace(diagnosis, verdict="ambiguous")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda diagnosis: diagnosis, "named"),
        (with_unexplained, "rest"),
        (without_gain, "worse"),
        (lambda diagnosis: without_gain(ambiguous(diagnosis)), "worse"),
        (ambiguous, "ambiguous"),
        (lambda diagnosis: ambiguous(with_unexplained(diagnosis)), "ambiguous_rest"),
        (unknown, "unknown"),
        (lambda diagnosis: within_noise(unknown(diagnosis)), "within_noise"),
        (lambda diagnosis: replace(diagnosis, verdict="no_gap", effects=()), "no_gap"),
    ],
)
def test_a_name_is_good_only_if_the_hold_outs_say_so(named, change, expected, monkeypatch):
    monkeypatch.setattr("calib.show.html._panel", lambda sheet, name: "data:image/svg+xml,")
    diagnosis = change(named)
    facts = diagnosis_facts(diagnosis)
    assert outcome(diagnosis) == expected
    assert (facts.word, facts.verdict) == KINDS[expected]
    assert page_of(facts).count("<section>") >= 2


def test_a_named_cause_has_its_numbers_and_its_card(named):
    facts = diagnosis_facts(named)
    numbers = [x for x in dict(facts.rows)["gap"].replace(",", "").split() if x[0].isdigit()]
    assert numbers == ["6.7", "3.7", "45.7", "1"]
    effect, _, gap, base = facts.parts
    assert effect.title == "Aerodynamic drag"
    assert dict(effect.rows)["Cause"] == CATALOGUE["aerodynamic_drag"].card.cause
    log, noise = gap.tables[0].rows
    assert log[:3] == (f"1 {MARKUP}", "6.7 to 3.7", "0.5 to 0.5")
    assert log[-1] == "4.0 to 8.0"
    assert (noise[2], noise[-1]) == ("0.0625 m/s^2", "0.0625 m/s")
    assert base.tables[0].rows[1][3] == ""  # a vehicle file says nothing of the tyres


def test_an_unknown_cause_is_described_by_its_term(named):
    (line,) = diagnosis_sheet(unknown(named)).by_name["term"].lines
    assert line.x == pytest.approx([0.0, 25.0])  # bar
    assert line.y == [0.0, -12.5]  # per cent


@pytest.mark.parametrize(("count", "length"), [(1, 8), (4, 8), (1, 80), (12, 60)])
def test_pictures_stay_readable_with_five_effects_and_long_names(named, count, length):
    """Axes that collapse are a warning of matplotlib, and so an error here."""
    five = tuple(replace(named.effects[0], name=name) for name in [*CATALOGUE][:5])
    logs = tuple(replace(named.measured[0], name=f"{i:02}" * (length // 2)) for i in range(count))
    squares = np.repeat(named.gap.squares, count, axis=1)
    gap = replace(named.gap, logs=tuple(log.name for log in logs), squares=squares)
    runs = dict.fromkeys(("replays_before", "replays_after", "measured"), logs)
    diagnosis = replace(named, effects=five, gap=gap, **runs)
    sheet = diagnosis_sheet(diagnosis)
    for figure in (sheet.overview(), *(sheet.figure(name) for name in sheet.names)):
        figure.canvas.draw()
        page_box = figure.get_window_extent()
        for ax in figure.axes:
            least_share = 0.3 if len(figure.axes) > 1 else 0.7
            assert ax.get_window_extent().width > least_share * page_box.width
            free_from = page_box.x0
            for text in ax.texts:
                box = text.get_window_extent()
                assert free_from <= box.x0
                free_from = box.x1
            assert free_from <= page_box.x1
    page = page_of(diagnosis_facts(diagnosis))
    assert all(log.name in page for log in logs)


def test_withdrawn_effects_have_a_row(named):
    diagnosis = replace(unknown(named), withdrawn=(("rear_proportioning", "mass_error"),))
    reason = dict(diagnosis_facts(diagnosis).rows)["Not named"]
    assert "rear proportioning" in reason
    assert "mass error" in reason
    assert to_dict(diagnosis)["withdrawn"] == [["rear_proportioning", "mass_error"]]
