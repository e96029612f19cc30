"""Units against pint, an independent table, and against their definitions."""

import numpy as np
import pint
import pytest

from calib.base.names import CHANNELS, TRUTH_UNITS
from calib.base.units import QUANTITIES, UnknownUnit, si_of, spelling, to_si

# Pint's names. Its own reading of three of ours would be wrong: "Nm" is a nanometre to it, "g" a
# gram, and a Hz one radian per second.
PINT = {
    "s": {
        "s": "second",
        "ms": "millisecond",
        "us": "microsecond",
        "min": "minute",
        "h": "hour",
        "d": "day",
    },
    "Pa": {u: u for u in ("Pa", "hPa", "kPa", "MPa", "bar", "mbar", "psi")},
    "m/s^2": {"m/s^2": "m/s^2", "g": "standard_gravity"},
    "rad/s": {
        "rad/s": "rad/s",
        "deg/s": "deg/s",
        "rpm": "turn/minute",
        "U/min": "turn/minute",
        "1/min": "turn/minute",
        "Hz": "turn/second",
    },
    "m/s": {
        "m/s": "m/s",
        "mm/s": "mm/s",
        "cm/s": "cm/s",
        "km/h": "km/h",
        "kph": "km/h",
        "mph": "mile/hour",
        "kn": "knot",
    },
    "degC": {"degC": "degC", "K": "kelvin", "degF": "degF"},
    "rad": {"rad": "radian", "mrad": "milliradian", "deg": "degree"},
    "N": {"N": "newton", "daN": "decanewton", "kN": "kilonewton"},
    "N*m": {"N*m": "newton*meter", "Nm": "newton*meter", "kN*m": "kilonewton*meter"},
    "kg": {"kg": "kilogram", "t": "metric_ton", "lb": "pound"},
    "m": {"m": "meter", "cm": "centimeter", "mm": "millimeter", "in": "inch"},
    "m^2": {"m^2": "meter^2", "cm^2": "centimeter^2", "mm^2": "millimeter^2"},
    "kg*m^2": {"kg*m^2": "kilogram*meter^2", "kg*cm^2": "kilogram*centimeter^2"},
    "1": {"1": "", "-": "", "%": "percent"},
    "1/K": {"1/K": "1/kelvin", "1/degC": "1/delta_degC", "%/K": "percent/kelvin"},
    "1/Pa": {"1/Pa": "1/pascal", "1/bar": "1/bar", "1/MPa": "1/megapascal", "%/bar": "percent/bar"},
    "s/m": {"s/m": "second/meter", "h/km": "hour/kilometer", "%/(km/h)": "percent*hour/kilometer"},
    "J": {"J": "joule", "kJ": "kilojoule", "MJ": "megajoule"},
    "W": {"W": "watt", "kW": "kilowatt"},
}
CASES = [(si, ours, theirs) for si, units in PINT.items() for ours, theirs in units.items()]


@pytest.fixture(scope="module")
def registry():
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


@pytest.mark.parametrize(("si", "ours", "theirs"), CASES)
def test_agrees_with_pint(registry, si, ours, theirs):
    values = np.array([-12.5, 0.0, 3.7, 1234.0])
    expected = registry.Quantity(values, theirs).to(PINT[si][si]).magnitude
    np.testing.assert_allclose(to_si(values, ours, si), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("variant", "plain", "si"),
    [
        ("m/s²", "m/s^2", "m/s^2"),
        ("N·m", "N*m", "N*m"),
        ("N.m", "N*m", "N*m"),
        ("N m", "N*m", "N*m"),
        ("kg·m²", "kg*m^2", "kg*m^2"),
        ("cm²", "cm^2", "m^2"),
        ("m·s⁻²", "m/s^2", "m/s^2"),
        ("min⁻¹", "rpm", "rad/s"),
        ("℃", "degC", "degC"),
        ("deg C", "degC", "degC"),
        ("km / h", "km/h", "m/s"),
    ],
)
def test_spellings_mean_the_same(variant, plain, si):
    assert to_si(7.5, variant, si) == to_si(7.5, plain, si)


@pytest.mark.parametrize(
    ("unit", "si", "words"),
    [
        ("g", "kg", ("'g'", "mass", "acceleration", "kg, t, lb")),
        ("Nm", "m", ("'Nm'", "length", "torque")),
        ("bar", "m/s", ("pressure", "speed")),
        ("furlong", "m", ("'furlong'", "length", "known: m, cm")),
        ("Kpa", "Pa", ("unknown unit 'Kpa'", "kPa")),
        ("", "Pa", ("unknown unit ''", "pressure")),
        ("1/s", "rad/s", ("unknown unit",)),  # a radian or a revolution per second?
        ("mPa", "Pa", ("unknown unit 'mPa'",)),  # a millipascal is no megapascal
        ("km/h", "rad/s", ("speed", "angular speed")),
    ],
)
def test_refuses_what_it_does_not_know(unit, si, words):
    with pytest.raises(UnknownUnit) as error:
        to_si(1.0, unit, si)
    assert all(word in str(error.value) for word in words)


def test_every_unit_of_the_table_was_compared_with_pint():
    compared = {(si, spelling(ours)) for si, ours, _ in CASES}
    assert compared == {(si, unit) for si, (_, units) in QUANTITIES.items() for unit in units}


def test_every_channel_converts_and_its_quantity_is_found():
    for quantity in CHANNELS.values():
        assert si_of(quantity.unit) == quantity.si
        to_si(1.0, quantity.unit, quantity.si)
    for unit in TRUTH_UNITS.values():
        assert si_of(unit) == unit
