"""Identifiers: given or not, and refused where they are none."""

import pytest

from calib.line.station.identity import TITLES, Identity


def test_absent_ones_are_left_out():
    assert Identity().given() == {}
    assert Identity("1", "2", "3", "4").given() == dict(zip(TITLES, "1234", strict=True))


@pytest.mark.parametrize("value", ["", "  ", "a\nb", "a\x00", "x" * 65])
def test_what_is_no_identifier(value):
    name, why = Identity(vin=value).flaw()
    assert name == "vin"
    assert why


def test_any_printable_one_will_do():
    assert Identity(serial="<Ä \"'&>", rxswin="R79 4711").flaw() is None


@pytest.mark.parametrize(
    ("vin", "usual"),
    [("WVWZZZ1JZXW000001", True), ("123", False), ("WVWZZZ1JZXW00000O", False), (None, True)],
)
def test_a_vin_of_another_form_than_iso_3779_is_told_and_taken(vin, usual):
    identity = Identity(vin=vin)
    assert (identity.doubt() == "") == usual
    assert identity.flaw() is None
