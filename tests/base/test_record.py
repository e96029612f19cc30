"""Schemas of files: quantities, tables by name, and all mistakes in one message."""

from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field

from calib.base.errors import LimitsError, SettingsError
from calib.base.record import FileSchema, OneOf, QuantityMark, Section, by_name, validated
from calib.base.settings_file import read_settings
from calib.base.toml import quantity, written_quantity

SI = ("s", "Pa", "m/s^2", "rad/s", "m/s", "degC", "rad", "N*m", "kg", "m^2", "kg*m^2", "1", "1/K")


class Wheel(Section):
    """A wheel."""

    radius: Annotated[float, QuantityMark("m", 0.1, 1.0)]
    make: Annotated[str, OneOf(("round", "square"))] = "round"


class CarFile(FileSchema):
    """A car."""

    name: str
    spare: Wheel | None = None
    wheels: list[Wheel] = Field(default_factory=list)
    seats: int | None = None
    by_place: by_name("ByPlace", {"front": Wheel, "rear": Wheel}, "Wheels.") | None = None


WHOLE = {"schema": 1, "name": "a", "wheels": [{"radius": "30 cm"}]}


def refusal(**changes):
    with pytest.raises(LimitsError) as error:
        validated({**WHOLE, **changes}, CarFile, "car", LimitsError)
    return str(error.value)


def test_a_table_by_name_has_quantities_in_si_in_the_order_of_the_file():
    tables = {"rear": {"radius": "30 cm"}, "front": {"radius": "0.4 m"}}
    file = validated({**WHOLE, "by_place": tables}, CarFile, "car", LimitsError)
    radii = [(name, wheel.radius) for name, wheel in file.by_place.entries()]
    assert radii == [("rear", 0.3), ("front", 0.4)]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"name": 5}, "car: name: 5; expected text in quotes"),
        ({"seats": True}, "car: seats: True; expected a whole number"),
        ({"wheels": 3}, "car: wheels: 3; expected [[wheels]] with double brackets"),
        ({"spare": 3}, "car: spare: 3 is not a table; expected [spare]"),
        ({"spare": {}}, "car: spare: key 'radius' is missing; expected a value for 'radius'"),
        ({"spare": {"radios": "1 m"}}, "car: spare: unknown key 'radios'; did you mean 'radius'?"),
        ({"xyz": 1}, "car: unknown key 'xyz'; expected one of schema, name, spare, wheels, seats"),
        (
            {"wheels": [{"radius": "0.3 m"}, {"radius": "3 m"}]},
            "car: wheels[1].radius: 3 m is not believable; expected 0.1 to 1 m; "
            "check the sign, the unit and the decimal point",
        ),
        (
            {"spare": {"radius": "1 m", "make": "rond"}},
            "car: spare.make: 'rond'; expected one of 'round', 'square'; did you mean 'round'?",
        ),
        (
            {"by_place": {"front": {"radius": "1 m", "mak": ""}}},
            "car: by_place.front: unknown key 'mak'; did you mean 'make'?",
        ),
        ({"schema": 2, "name": 5}, "car: schema 2; expected schema = 1"),
    ],
)
def test_one_error_is_one_line(changes, says):
    assert refusal(**changes).startswith(says)


def test_several_errors_are_one_message():
    assert refusal(name=5, spare={"radius": 1, "make": 2}) == (
        "car: 3 errors\n"
        "  name: 5; expected text in quotes\n"
        '  spare.radius: 1 has no unit; expected a unit, such as "1 m"\n'
        "  spare.make: 2; expected one of 'round', 'square'"
    )


def test_json_says_where_it_ends_too_early():
    with pytest.raises(LimitsError, match=r"not JSON .*line 1 column 13"):
        validated(b'{"schema": 1,', CarFile, "car", LimitsError)


@given(value=st.floats(allow_nan=False, allow_infinity=False), si=st.sampled_from(SI))
def test_a_written_quantity_reads_back_to_the_last_bit(value, si):
    assert quantity(written_quantity(value, si), si, None, LimitsError) == value


def test_a_message_lists_a_hundred_mistakes_and_counts_the_rest(tmp_path):
    path = tmp_path / "brake-cal.toml"
    path.write_text("schema = 1\n" + "".join(f"key_{i} = 1\n" for i in range(300)))
    with pytest.raises(SettingsError) as error:
        read_settings(path)
    first, *lines = str(error.value).splitlines()
    assert first.startswith(f"{path}: 300 errors")
    assert len(lines) == 101
    assert lines[-1] == "  and 200 more"


def test_a_misspelt_schema_key_is_an_error():
    with pytest.raises(LimitsError, match="no schema"):
        validated({"schem": 1, "name": "a"}, CarFile, "car", LimitsError)
