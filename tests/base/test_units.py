"""Units against pint, an independent table, and against their definitions."""

import numpy as np
import pint
import pytest

from calib.base.names import CHANNELS, TRUTH_UNITS
from calib.base.units import QUANTITIES, UnknownUnit, si_of, to_si

PINT = {
    "g": "standard_gravity", "Hz": "turn/second", "kn": "knot", "t": "metric_ton",
    "U/min": "turn/minute", "1/min": "turn/minute", "rpm": "turn/minute", "kph": "km/hour",
    "1": "", "-": "", "%": "percent", "1/degC": "1/delta_degC", "%/K": "percent/kelvin",
    "%/bar": "percent/bar", "%/(km/h)": "percent*hour/kilometer", "in": "inch", "d": "day",
}  # fmt: skip
"""Units that have another name in pint. "g" is a gram to it, and a Hz one radian per second."""

CASES = [(si, unit) for si, (_, units) in QUANTITIES.items() for unit in units]


@pytest.fixture(scope="module")
def registry():
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


@pytest.mark.parametrize(("si", "ours"), CASES)
def test_agrees_with_pint(registry, si, ours):
    values = np.array([-12.5, 0.0, 3.7, 1234.0])
    theirs = registry.Quantity(values, PINT.get(ours, ours))
    expected = theirs.to(PINT.get(si, si)).magnitude
    np.testing.assert_allclose(to_si(values, ours, si), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("variant", "plain", "si"),
    [
        ("m/s²", "m/s^2", "m/s^2"),
        ("N·m", "N*m", "N*m"),
        ("N.m", "N*m", "N*m"),
        ("N m", "N*m", "N*m"),
        ("Nm", "N*m", "N*m"),
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
def test_unknown_units_and_units_of_other_quantities_are_refused(unit, si, words):
    with pytest.raises(UnknownUnit) as error:
        to_si(1.0, unit, si)
    assert all(word in str(error.value) for word in words)


def test_every_channel_converts_and_its_quantity_is_found():
    units = [(channel.unit, channel.si) for channel in CHANNELS.values()]
    for unit, si in [*units, *((unit, unit) for unit in TRUTH_UNITS.values())]:
        assert si_of(unit) == si
        assert np.isfinite(to_si(1.0, unit, si))
