"""Units: the Modelica spellings, what they mean, and what is refused."""

from math import pi

import pytest

from cosim import DeclarationError
from cosim.units import parse, rate_unit

# exponents over kg, m, s, A, K, mol, cd, rad, from the SI brochure's definitions
MEANINGS = {
    "1": ((0, 0, 0, 0, 0, 0, 0, 0), 1.0),
    "m": ((0, 1, 0, 0, 0, 0, 0, 0), 1.0),
    "mm": ((0, 1, 0, 0, 0, 0, 0, 0), 1e-3),
    "kg": ((1, 0, 0, 0, 0, 0, 0, 0), 1.0),
    "g": ((1, 0, 0, 0, 0, 0, 0, 0), 1e-3),
    "m/s2": ((0, 1, -2, 0, 0, 0, 0, 0), 1.0),
    "m.s-2": ((0, 1, -2, 0, 0, 0, 0, 0), 1.0),
    "km/h": ((0, 1, -1, 0, 0, 0, 0, 0), 1 / 3.6),
    "N": ((1, 1, -2, 0, 0, 0, 0, 0), 1.0),
    "kN": ((1, 1, -2, 0, 0, 0, 0, 0), 1e3),
    "N.s/m": ((1, 0, -1, 0, 0, 0, 0, 0), 1.0),
    "N.m": ((1, 2, -2, 0, 0, 0, 0, 0), 1.0),
    "N.m/rad": ((1, 2, -2, 0, 0, 0, 0, -1), 1.0),
    "kg.m2": ((1, 2, 0, 0, 0, 0, 0, 0), 1.0),
    "1/kg": ((-1, 0, 0, 0, 0, 0, 0, 0), 1.0),
    "rad/s": ((0, 0, -1, 0, 0, 0, 0, 1), 1.0),
    "deg": ((0, 0, 0, 0, 0, 0, 0, 1), pi / 180),
    "rev/min": ((0, 0, -1, 0, 0, 0, 0, 1), 2 * pi / 60),
    "Hz": ((0, 0, -1, 0, 0, 0, 0, 0), 1.0),
    "Pa": ((1, -1, -2, 0, 0, 0, 0, 0), 1.0),
    "W/(m2.K)": ((1, 0, -3, 0, -1, 0, 0, 0), 1.0),
    "V/A": ((1, 2, -3, -2, 0, 0, 0, 0), 1.0),
    "Ohm": ((1, 2, -3, -2, 0, 0, 0, 0), 1.0),
    "m/s3": ((0, 1, -3, 0, 0, 0, 0, 0), 1.0),
    "min": ((0, 0, 1, 0, 0, 0, 0, 0), 60.0),  # a minute, not a milli-inch
}


@pytest.mark.parametrize("spelling", MEANINGS)
def test_modelica_spellings(spelling: str) -> None:
    exponents, factor = MEANINGS[spelling]
    unit = parse(spelling)
    assert unit.exponents == exponents
    assert unit.factor == pytest.approx(factor, rel=1e-15)
    assert unit.offset == 0


def test_celsius_has_an_offset() -> None:
    unit = parse("degC")
    assert (unit.exponents, unit.factor, unit.offset) == ((0, 0, 0, 0, 1, 0, 0, 0), 1.0, 273.15)
    a, b = unit.conversion(parse("K"))
    assert a * 20 + b == 293.15


def test_conversion_there_and_back_is_the_identity() -> None:
    for one, other in (("km/h", "m/s"), ("degC", "K"), ("deg", "rad"), ("bar", "Pa")):
        a, b = parse(one).conversion(parse(other))
        c, d = parse(other).conversion(parse(one))
        assert c * (a * 7.5 + b) + d == pytest.approx(7.5, rel=1e-14)


def test_a_radian_is_not_nothing() -> None:
    assert not parse("N.m/rad").same_dimension(parse("N.m"))
    assert not parse("rad/s").same_dimension(parse("Hz"))


def test_different_spellings_of_one_unit_are_equal() -> None:
    assert parse("N.s/m").equals(parse("kg/s"))
    assert parse("J").equals(parse("N.m"))
    assert not parse("mm").equals(parse("m"))


@pytest.mark.parametrize(
    ("spelling", "sentence"),
    [
        ("furlong", "cannot read unit 'furlong': the symbol 'furlong' is not known"),
        ("m/s/s", "cannot read unit 'm/s/s': write one division, such as N.s/m or W/(m2.K)"),
        ("", "cannot read unit '': write one division, such as N.s/m or W/(m2.K)"),
        ("m/", "cannot read unit 'm/': write one division, such as N.s/m or W/(m2.K)"),
        ("m^2", "cannot read unit 'm^2': 'm^2' is not a symbol with an exponent, such as m or s2"),
        ("degC/s", "cannot read unit 'degC/s': 'degC' has an offset and cannot be part of a product"),
        ("1.5", "cannot read unit '1.5': '5' is not a symbol with an exponent, such as m or s2"),
    ],
)
def test_what_cannot_be_read_is_named(spelling: str, sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        parse(spelling)
    assert str(caught.value) == sentence


@pytest.mark.parametrize(
    ("unit", "rate"),
    [("m", "m/s"), ("m/s", "m/s2"), ("1", "1/s"), ("rad/s", "rad/s2"), ("N.s/m", "N.s/(m.s)"), ("N.s", "N.s/s")],
)
def test_the_unit_of_a_derivative(unit: str, rate: str) -> None:
    assert rate_unit(unit) == rate
    per_second = parse("1/s").exponents
    assert parse(rate).exponents == tuple(a + b for a, b in zip(parse(unit).exponents, per_second, strict=True))
