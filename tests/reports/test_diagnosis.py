"""The page of a diagnosis, from an answer that is written down here."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lxml import html

from calib.diagnosis.candidate import Candidate
from calib.diagnosis.channels import ChannelNoise
from calib.diagnosis.diagnose import Diagnosis, Named, ParameterEstimate, Where
from calib.diagnosis.gap import CHANNELS, ChannelGap, Gap
from calib.diagnosis.prove import Step, Withdrawn
from calib.diagnosis.remainder import Remainder
from calib.diagnosis.unexplained import UnexplainedTerm
from calib.logs.read import read_log
from calib.physics.effects.effects import Effects, EmpiricalTerm
from calib.physics.magic_formula import MagicFormula
from calib.physics.model import Model
from calib.physics.vehicle_file import read_vehicle
from calib.reports.diagnosis import report_html

CASE = Path(__file__).parents[2] / "sample_logs" / "hidden" / "case_0"
LEFT = Remainder(3.5, 40.0, "v", "stop", 7.25, (1e6, 2e6), (10.0, 20.0), (3.0, 6.0))
MARKUP = "<img src=x onerror=alert(1)>&\"'"


def estimate(value):
    return ParameterEstimate(value, "1", (value - 0.1, value + 0.1))


@pytest.fixture(scope="module")
def named():
    """Drag is missing; a replay equals its log, since the page reads both alike."""
    log = replace(read_log(CASE / "holdout" / "stop_a.parquet"), name=MARKUP)
    model = Model(read_vehicle(CASE / "vehicle.toml"), 0.4, 0.4, MagicFormula(20.0, 0.8), Effects())
    where = Where("a_x", "body", (0.0, 5e6), (10.0, 30.0), None)
    drag = Named(
        "aerodynamic_drag", {"drag_area": estimate(0.66)}, where, 2.5, 1.75, None,
        ("rolling_resistance",), f"coast down {MARKUP}",
    )  # fmt: skip
    gap = Gap(8.25, 1.5, 0.875, dict.fromkeys(CHANNELS, ChannelGap(0.5, 0.125, 0.0625)), {
        MARKUP: (8.25, 1.5)})  # fmt: skip
    return Diagnosis(
        "named", (drag,), None, {"pad_friction_f": estimate(0.375), "tyre_peak": estimate(0.8)},
        gap, model, model, (log,), (log,), (log,), 3.5, 1.0, LEFT, (),
        (Step((), 3.5, 8.0), Step(("aerodynamic_drag",), 1.0, 0.25)),
        ChannelNoise(np.zeros((6, 3)), np.ones(6), "unbraked parts"),
    )  # fmt: skip


def unknown(named):
    term = EmpiricalTerm("rear_brakes", "pressure", (0.0, 2.5e6), (0.0, -0.125))
    model = named.model_after
    base = Candidate((), None, Effects(), None, None, 0.0, 1)
    rest = UnexplainedTerm(
        term, "rear", "pressure", 0.75, 0.0, None, base, (("body", "speed", 0.5),)
    )
    after = replace(model, effects=replace(model.effects, terms=(term,)))
    return replace(named, verdict="unknown", effects=(), unexplained=rest, model_after=after)


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


def test_an_unknown_cause_is_described_by_its_term(named):
    page = read(unknown(named))
    assert texts(page, "//header/p")[0] == "Unknown cause"
    assert texts(page, "//h2")[0] == "Place and driver of the cause"
    assert rows(page, "The empirical term") == [["0", "+0.00 %"], ["25", "-12.50 %"]]  # bar
    assert rows(page, "Other places") == [["body", "speed", "50 %"]]


def test_what_is_left_beside_a_name_is_in_headline_colour_and_text(named):
    rest = unknown(named).unexplained
    page = read(replace(named, unexplained=rest))
    assert texts(page, "//header/p")[0] == "Named and something else"
    assert page.xpath("string(//header/@class)") == "ambiguous"  # not the colour of a name
    (left,) = [t for t in texts(page, "//header/p") if t.startswith("Something else is left")]
    assert "3.5 times the sensors' noise" in left
    assert "10 to 20 bar and 36 to 72 km/h" in left
    assert "What is left" in texts(page, "//h2")
    assert page.xpath("string(//header/@class)") != read(named).xpath("string(//header/@class)")
    assert not any("Something else" in text for text in texts(read(named), "//p"))


def test_the_course_of_the_search_and_what_was_withdrawn_are_told(named):
    wrong = Withdrawn(("rear_proportioning",), -1.39)
    page = read(replace(unknown(named), withdrawn=(wrong,)))
    assert rows(page, "The course of the search") == [
        ["none", "3.500", "8.00"],
        ["aerodynamic drag", "1.000", "0.25"],
    ]
    assert any("grow by 139 %" in text for text in texts(page, "//header/p"))


def test_without_a_gap_there_is_one_replay_and_no_cause(named):
    page = read(replace(named, verdict="no_gap", effects=()))
    assert texts(page, "//header//dd") == ["8.2", "1"]
    assert len(rows(page, "Gap by channel")[0]) == 3
    assert "None explained enough." in texts(page, "//h2[.='Effects that were tried']/../p")[0]
    assert rows(page, "Gap by log") == [[MARKUP, "8.25"]]


def test_markup_in_names_stays_text_and_nothing_is_fetched(named):
    page = read(named)
    assert not page.xpath("//script|//*[@onerror]")
    assert page.xpath("string(//h1)") == MARKUP
    sources = page.xpath("//*/@src|//*/@href")
    assert sources
    assert all(source.startswith("data:") for source in sources)
