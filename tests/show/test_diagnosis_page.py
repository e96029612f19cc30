"""The page of a diagnosis, from an answer that is written down in `tests.support`."""

from dataclasses import replace

import pytest
from lxml import html

from calib.base.warning import PlausibilityWarning
from calib.car.effects.catalogue import effect_named
from calib.diagnosis.explanation.base import Ground
from calib.diagnosis.proof.prove import SearchStep, Withdrawn
from calib.diagnosis.search.offsets import LogOffsets
from calib.diagnosis.undecided.confusion import Confusion, Explanation, Pair
from calib.diagnosis.undecided.drives import ShowingDrive
from calib.diagnosis.written.document import to_dict
from calib.show.diagnosis_page import report_html
from tests.support.written_diagnosis import MARKUP, named_drag, unknown


@pytest.fixture(scope="module")
def named():
    return named_drag()


def read(found):
    return html.document_fromstring(report_html(found, MARKUP))


def texts(page, path):
    return [" ".join(node.text_content().split()) for node in page.xpath(path)]


def rows(page, caption):
    (table,) = page.xpath(f"//table[starts-with(caption, '{caption}')]")
    return [texts(row, "./th|./td") for row in table.xpath("./tbody/tr")]


def test_a_named_cause_has_its_card_its_numbers_and_its_rivals(named):
    page = read(named)
    assert texts(page, "//header//dd") == ["8.2", "1.5", "87.5 %", "1"]
    assert texts(page, "//h2")[0] == "Aerodynamic drag"
    assert texts(page, "//h3")[-1] == "Effects that cannot be distinguished from it"
    assert any("falls by 1.75." in text for text in texts(page, "//p"))
    assert rows(page, "Gap by channel")[0] == ["a_x [m/s^2]", "0.5000", "0.1250", "0.0625"]
    assert rows(page, "Base parameters")[0][0] == "pad friction, front"
    assert rows(page, "Base parameters")[1][3] == ""  # a vehicle file says nothing of the tyres


def test_warnings_of_the_logs_are_on_the_page_and_in_the_document(named):
    warning = PlausibilityWarning("pressure_zero", MARKUP, 0.8, (-0.5, 0.5), ("the zero",), "zero")
    warned = replace(named, warnings=(warning,))
    (row,) = rows(read(warned), "What speaks against the result")
    assert row == [f"{MARKUP}: pressure zero", "0.8 bar; expected -0.5 to 0.5", "the zero", "zero"]
    assert "Warnings" not in texts(read(named), "//h2")
    (said,) = to_dict(warned)["warnings"]
    assert (said["code"], said["measured"]) == ("pressure_zero", 0.8)


def test_an_unknown_cause_is_described_by_its_term(named):
    page = read(unknown(named))
    assert texts(page, "//header/p")[0] == "Unknown cause"
    assert texts(page, "//h2")[0] == "Place and driver of the cause"
    assert rows(page, "The empirical term") == [["0", "+0.00 %"], ["25", "-12.50 %"]]  # bar
    assert rows(page, "Other places") == [["body", "speed", "50 %"]]


def test_what_is_left_beside_a_name_is_in_headline_colour_and_text(named):
    rest = unknown(named)
    page = read(replace(named, unexplained=rest.unexplained, left=rest.left))
    assert texts(page, "//header/p")[0] == "Named and something else"
    assert page.xpath("string(//header/@class)") == "ambiguous"  # not the colour of a name
    (left,) = [t for t in texts(page, "//header/p") if t.startswith("Something else is left")]
    assert "3.5 times the sensors' noise" in left
    assert "10 to 20 bar and 36 to 72 km/h" in left
    assert "What is left" in texts(page, "//h2")
    assert page.xpath("string(//header/@class)") != read(named).xpath("string(//header/@class)")
    assert not any("Something else" in text for text in texts(read(named), "//p"))


def test_slopes_and_pads_of_single_logs_are_told(named):
    slopes = LogOffsets("road_grade", "grade", "1", {"north": 0.012, "south": -0.012})
    pads = {"north": Ground(1.02, 0.99, 1.0, 1.0), "south": Ground()}
    page = read(replace(named, offsets=slopes, own_pads=pads))
    (text,) = [t for t in texts(page, "//p") if "road slope of its own" in t]
    assert "north +1.2 %, south -1.2 %" in text
    assert "north +2.0, -1.0, +0.0; south +0.0, +0.0, +0.0" in text
    zeros = LogOffsets("accelerometer_bias", "bias", "m/s^2", {"monday": 0.08})
    assert any("monday +0.08" in t for t in texts(read(replace(named, offsets=zeros)), "//p"))


def test_the_course_of_the_search_and_what_was_withdrawn_are_told(named):
    wrong = Withdrawn(("rear_proportioning",), -1.39)
    page = read(replace(unknown(named), withdrawn=(wrong,)))
    assert rows(page, "The course of the search") == [
        ["nothing", "3.500", "", "8.00", ""],
        ["aerodynamic drag", "1.000", "-2.500", "0.25", "-7.75"],
    ]
    assert any("grow by 139 %" in text for text in texts(page, "//header/p"))


def test_a_step_that_spares_an_effect_says_so(named):
    steps = (*named.steps, SearchStep(("hydraulic_lag",), 1.125, 0.5))
    assert rows(read(replace(named, steps=steps)), "The course")[-1] == [
        "hydraulic lag, without aerodynamic drag", "1.125", "+0.125", "0.50", "+0.25"
    ]  # fmt: skip


def test_a_step_with_the_same_effects_is_a_better_fit_of_them(named):
    steps = (*named.steps, SearchStep(named.steps[-1].names, 0.875, 0.25))
    assert rows(read(replace(named, steps=steps)), "The course")[-1] == [
        "the same, fitted anew", "0.875", "-0.125", "0.25", "+0.00"
    ]  # fmt: skip


def test_a_name_with_which_the_hold_outs_are_no_better_is_not_blue(named):
    worse = replace(named, gap=replace(named.gap, after=8.5, closed=-0.03))
    page = read(worse)
    assert texts(page, "//header/p")[0] == "Named, and the hold-outs are no better"
    assert page.xpath("string(//header/@class)") == "unknown"
    told = texts(page, "//header/p")[1]
    assert "does not shrink: 8.2 times the sensors' noise before, 8.5" in told


def test_the_headline_says_how_much_is_closed_and_what_is_left(named):
    assert texts(read(named), "//header/p")[:2] == [
        "Named",
        "Missing from the model: aerodynamic drag. 87.5 % of the gap on the hold-outs is closed; "
        "1.5 times the sensors' noise is left.",
    ]


def test_the_gap_is_told_by_log_and_channel_over_the_noise(named):
    table = rows(read(named), "Gap by log and channel")
    assert table[0] == [MARKUP, "8.25", "1.50", "82 %", ""]
    assert table[1] == ["a_x", "0.50", "0.50", "within noise", "0.0625 m/s^2"]
    assert table[2] == ["omega_fl", "8.00", "2.00", "75 %", "0.0625 rad/s"]
    assert table[6] == ["v", "4.00", "8.00", "-100 %, worse", "0.0625 m/s"]


def test_explanations_that_fit_alike_are_a_matrix_with_the_drive_for_each_pair(named):
    assert "What these logs cannot tell apart" not in texts(read(named), "//h2")
    alike = Confusion(
        (Explanation(("road_grade",), 1.0), Explanation(("mass_error", "hydraulic_lag"), 1.0025)),
        (Pair(0, 1, 3.0, "coast", 48.0),),
    )
    page = read(replace(named, verdict="ambiguous", confusion=alike))
    assert rows(page, "Explanations that fit") == [
        ["A: road grade", "1.000", "", "", "3"],
        ["B: mass error and hydraulic lag", "1.002", "+0.0025", "3", ""],
    ]
    assert rows(page, "The drive that tells") == [["A or B", "coast", "48 sigma"]]


def test_what_the_logs_could_not_show_has_the_drive_that_would(named):
    assert "What these logs could not show" not in texts(read(named), "//h2")
    unseen = (
        ShowingDrive(effect_named("road_grade").card, "coast", 48.0),
        ShowingDrive(effect_named("mass_error").card, "stop", 3.0),
        ShowingDrive(effect_named("residual_torque").card, "stop", 0.0),
    )
    names = tuple(drive.effect for drive in unseen)
    page = read(replace(named, not_resolved=names, drives=unseen))
    assert [row[2:] for row in rows(page, "The drive in which")] == [
        ["coast", "48 sigma"],
        ["none that was tried; most of all stop", "3 sigma"],
        ["none", "0 sigma"],
    ]
    assert rows(page, "The drive in which")[2][1] == "residual pressure 1.5 bar"


def test_no_number_is_called_a_mean_squared_innovation(named):
    """A reader is told what 1 means wherever the number stands."""
    page = read(named)
    assert "mean squared innovation" not in page.text_content().lower()
    assert page.text_content().lower().count("unexplained error (1 = noise)") >= 3


def test_without_a_gap_there_is_one_replay_and_no_cause(named):
    page = read(replace(named, verdict="no_gap", effects=()))
    assert texts(page, "//header//dd") == ["8.2", "1"]
    assert len(rows(page, "Gap by channel")[0]) == 3
    assert "None explained enough." in texts(page, "//h2[.='Effects that were tried']/../p")[0]
    assert rows(page, "Gap by log")[:2] == [
        [MARKUP, "8.25", ""],
        ["a_x", "0.50", "0.0625 m/s^2"],
    ]


def test_markup_in_names_stays_text_and_nothing_is_fetched(named):
    page = read(named)
    assert not page.xpath("//script|//*[@onerror]")
    assert page.xpath("string(//h1)") == MARKUP
    sources = page.xpath("//*/@src|//*/@href")
    assert sources
    assert all(source.startswith("data:") for source in sources)
