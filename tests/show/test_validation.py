"""Facts of a validation: the ECU beside the best estimate and the truth, and the verdict."""

import pytest

from calib.estimation.limits import Judgement
from calib.show.facts import FAILED, PASSED
from calib.show.validation import Validated, validation_facts
from tests.estimation.test_validate import made_validation
from tests.support.tables import stored_as

ECU = {
    "ecu_valid_share": 0.953,
    "ecu_pad_friction_f": 0.31,
    "ecu_interval_f": 0.1,
    "ecu_pad_friction_r": 0.27,
    "ecu_interval_r": 0.2,
}
BEST = {"valid_share": 0.961, "interval_f": 0.05, "interval_r": 0.1}
TRUTH = {"true_pad_friction_f": 0.30, "true_pad_friction_r": 0.28, "true_pad_level": 0.75}


def facts_of(*results):
    return validation_facts(Validated(stored_as("sedan@1"), results))


def ecu_beside_best(facts):
    """Return the table of the ECU beside the best estimate."""
    (part,) = (part for part in facts.parts if part.title.startswith("The ECU"))
    return part.tables[0]


def test_the_ecu_stands_first_and_every_row_names_its_stop():
    stop = made_validation("wet", 0.30, 0.39, **ECU, **BEST, **TRUTH, ecu_normalised_error_f=1.0)
    facts, e = facts_of(stop), stop.estimate
    (row,), table = facts.tables[0].rows, ecu_beside_best(facts)
    valid = e.ecu.valid
    axles = 2.0 * e.ecu.torque_f.value[valid].mean(), 2.0 * e.ecu.torque_r.value[valid].mean()
    torques = [float(cell.partition("\xa0")[0]) for cell in row[1:4]]
    assert torques == pytest.approx([*axles, e.ecu.torque_sum.value[valid].mean()], abs=0.5)
    assert facts.tables[0].verdicts == [PASSED]
    assert {row[0] for row in table.rows} == {"wet"}
    assert row[1:4] == table.rows[0][2:5]  # the torques of the two tables are equal
    assert [row[5].partition("\xa0")[0] for row in table.rows[:2]] == ["0.310", "0.300"]
    assert [row[5].rpartition("\xa0")[2] for row in table.rows[:2]] == ["0.031", "0.015"]
    assert [row[8].partition("\xa0")[0] for row in table.rows[:2]] == ["95.3", "96.1"]


@pytest.mark.parametrize("ecu", [{"ecu_valid_share": 0.0}, ECU])
def test_without_an_answer_there_is_no_number(ecu):
    """An ECU has no number either if no sample of its stop counts."""
    facts = facts_of(made_validation("a", None, None, **(ecu | {"valid_share": 0.0})))
    rows = ecu_beside_best(facts).rows
    assert len(rows) == 2
    assert not any(cell[:1].isdigit() for row in rows for cell in row[5:8])
    assert [row[8].partition("\xa0")[0] for row in rows] == ["0.0", "0.0"]


@pytest.mark.parametrize(
    ("metric", "proved"),
    [("ecu_normalised_error_f", True), ("ecu_reference_f", True), ("ecu_pad_level", False)],
)
def test_the_verdict_is_passed_only_with_a_truth_or_a_reference(metric, proved):
    facts = facts_of(made_validation("a", **{metric: 1.0}))
    assert facts.word.startswith("Passed") == proved
    assert facts.tables[0].rows[0][-1].startswith("passed") == proved


def test_the_metric_that_fails_is_named():
    bad = Judgement("ecu_reference_r", None, 3.5, value=4.2)
    failed = made_validation("b", judgements=[bad], **ECU, ecu_reference_r=4.2)
    facts = facts_of(made_validation("a", **ECU), failed)
    assert facts.verdict == FAILED
    assert [row[0] for row in facts.tables[0].rows] == ["b", "a"]  # the failed one first
    assert facts.tables[0].verdicts == [FAILED, PASSED]
    (text,) = [text for name, text in facts.rows if "ecu_reference_r" in text]
    assert "4.2" in text
    assert "3.5" in text
