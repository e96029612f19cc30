"""Facts of a diagnosis, from an answer that is written down in `tests.support`."""

from dataclasses import replace

import pytest

from calib.base.warning import PlausibilityWarning
from calib.car.effects.catalogue import CATALOGUE
from calib.diagnosis.explanation.base import Ground
from calib.diagnosis.proof.prove import SearchStep, Withdrawn
from calib.diagnosis.search.offsets import LogOffsets
from calib.diagnosis.undecided.confusion import Confusion, Explanation, Pair
from calib.diagnosis.undecided.drives import ShowingDrive
from calib.diagnosis.written.document import to_dict
from calib.show.diagnosis import KINDS, facts, outcome
from calib.show.diagnosis_page import report
from calib.show.html import page_of
from tests.support.written_diagnosis import LEFT, MARKUP, QUIET, named_drag, unknown


@pytest.fixture(scope="module")
def named():
    return named_drag()


def tables(found):
    """Rows of all tables by the first two words of their captions."""

    def walk(part):
        yield from part.tables
        for inner in part.parts:
            yield from walk(inner)

    return {
        " ".join(table.caption.split()[:2]): list(table.rows)
        for table in walk(report(found, MARKUP))
    }


def worse(found):
    return replace(found, gap=replace(found.gap, after=found.gap.before, closed=0.0))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda found: found, "named"),
        (lambda found: replace(found, left=LEFT), "rest"),
        (lambda found: replace(found, unexplained=unknown(found).unexplained), "rest"),
        (worse, "worse"),
        (lambda found: worse(replace(found, verdict="ambiguous")), "worse"),
        (lambda found: replace(found, verdict="ambiguous"), "ambiguous"),
        (lambda found: replace(found, verdict="ambiguous", left=LEFT), "ambiguous_rest"),
        (unknown, "unknown"),
        (lambda found: replace(found, verdict="no_gap", effects=()), "no_gap"),
    ],
)
def test_a_name_is_good_only_if_the_hold_outs_say_so(named, change, expected):
    found = change(named)
    told = facts(found, "car")
    assert outcome(found) == expected
    assert (told.word, told.verdict) == KINDS[expected]
    assert page_of(report(found, "car")).count("<section>") >= 3


def test_a_named_cause_has_its_numbers_and_its_card(named):
    told = facts(named, MARKUP)
    assert [text for _, text in told.numbers] == ["8.2", "1.5", "87.5 %", "1"]
    (effect,) = told.parts
    assert effect.title == "Aerodynamic drag"
    assert dict(effect.rows)["Cause"] == CATALOGUE["aerodynamic_drag"].card.cause
    gap = tables(named)
    assert gap["Gap by"][0] == (MARKUP, "8.25", "1.50", "")
    assert gap["Gap by"][1][1:] == ("0.50", "0.50", "0.0625 m/s^2")
    assert gap["Gap by"][6][1:] == ("4.00", "8.00", "0.0625 m/s")
    assert gap["Base parameters"][1][3] == ""  # a vehicle file says nothing of the tyres


def test_warnings_of_the_logs_are_told(named):
    warning = PlausibilityWarning("pressure_zero", MARKUP, 0.8, (-0.5, 0.5), ("the zero",), "zero")
    warned = replace(named, warnings=(warning,))
    assert facts(warned, "car").warnings == (warning,)
    assert to_dict(warned)["warnings"][0]["measured"] == 0.8


def test_an_unknown_cause_is_described_by_its_term(named):
    told = tables(unknown(named))
    assert told["The empirical"] == [("0", "+0.00 %"), ("25", "-12.50 %")]  # bar
    assert told["Other places"] == [("body", "speed", "50 %")]


@pytest.mark.parametrize(("left", "where"), [(LEFT, True), (QUIET, False)])
def test_what_is_left_says_where_the_replays_show_it(named, left, where):
    rest = replace(named, unexplained=unknown(named).unexplained, left=left)
    assert ("10 to 20 bar and 36 to 72 km/h" in dict(facts(rest, "car").rows)["Left over"]) == where


def test_slopes_and_pads_of_single_logs_are_told(named):
    slopes = LogOffsets("road_grade", "grade", "1", {"north": 0.012, "south": -0.012})
    pads = {"north": Ground(1.02, 0.99, 1.0, 1.0), "south": Ground()}
    told = replace(named, offsets=slopes, own_pads=pads, sides={"f": 0.003})
    rows = tables(told)["States of"]
    assert [value for _, of, value in rows if of == "north"] == [
        "+2.0", "-1.0", "+0.0", "+0.0", "+0.012"
    ]  # fmt: skip
    assert rows[-1] == ("left wheel slower than right [%]", "front axle", "+0.30")


def test_the_course_of_the_search_and_what_was_withdrawn_are_told(named):
    found = replace(unknown(named), withdrawn=(Withdrawn(("rear_proportioning",), -1.39),))
    assert "139 %" in dict(facts(found, "car").rows)["Not named"]
    last = named.steps[-1].names
    steps = (*named.steps, SearchStep(("hydraulic_lag",), 1.125, 0.5), SearchStep(last, 0.9, 0.25))
    steps += (SearchStep(last, 0.875, 0.25),)
    assert tables(replace(named, steps=steps))["The search:"] == [
        ("nothing", "3.500", "", "8.00", ""),
        ("aerodynamic drag", "1.000", "-2.500", "0.25", "-7.75"),
        ("hydraulic lag, without aerodynamic drag", "1.125", "+0.125", "0.50", "+0.25"),
        ("aerodynamic drag, without hydraulic lag", "0.900", "-0.225", "0.25", "-0.25"),
        ("the same, fitted anew", "0.875", "-0.025", "0.25", "+0.00"),
    ]


def test_explanations_that_fit_alike_have_the_drive_for_each_pair(named):
    alike = Confusion(
        (Explanation(("road_grade",), 1.0), Explanation(("mass_error", "hydraulic_lag"), 1.0025)),
        (Pair(0, 1, 3.0, "coast", 48.0),),
    )
    told = tables(replace(named, verdict="ambiguous", confusion=alike))
    assert told["Explanations that"] == [
        ("A: road grade", "1.000", ""),
        ("B: mass error and hydraulic lag", "1.002", "+0.0025"),
    ]
    assert told["How far"] == [("A or B", "3 sigma", "coast", "48 sigma")]


def test_what_the_logs_could_not_show_has_the_drive_that_would(named):
    unseen = (
        ShowingDrive(CATALOGUE["road_grade"].card, "coast", 48.0),
        ShowingDrive(CATALOGUE["residual_torque"].card, "stop", 0.0),
    )
    found = replace(named, not_resolved=tuple(drive.effect for drive in unseen), drives=unseen)
    first, last = tables(found)["What these"]
    assert first[2:] == ("coast", "48 sigma")
    assert last[1] == "residual pressure 1.5 bar"
    assert last[2].endswith("stop")


def test_without_a_gap_there_is_one_replay_and_no_cause(named):
    found = replace(named, verdict="no_gap", effects=())
    assert [text for _, text in facts(found, "car").numbers] == ["8.2", "1"]
