"""Units as exponents of the base units."""

import pytest

from winch_friction.physics.channels import dimension_of, product, quotient_unit
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import registered_terms
from winch_friction.physics.friction.symbols import SIGNAL_OF_SYMBOL


def test_units_that_mean_the_same_have_the_same_exponents():
    assert dimension_of("N*m") == dimension_of("J") == dimension_of("Pa*m^3/rad") == {"kg": 1, "m": 2, "s": -2}
    assert dimension_of("1") == dimension_of("rad") == {}
    assert product(("N*m*s/rad", 1.0), ("rad/s", 1.0)) == dimension_of("N*m")


@pytest.mark.parametrize("unit", ["", "bar", "N m", "*N", "N**m", "N*m)", "furlong"])
def test_what_is_no_si_unit_is_refused(unit):
    with pytest.raises(InputError, match="is not a product of SI units"):
        dimension_of(unit)


def test_every_declared_unit_is_understood():
    for term in registered_terms().values():
        for parameter in term.parameters:
            dimension_of(parameter.unit)
    for signal in SIGNAL_OF_SYMBOL.values():
        dimension_of(signal.unit)


@pytest.mark.parametrize(
    "factors", [(("rad/s", 1.0),), (("Pa", 2.0),), (("m", 1.0), ("degC", -1.0)), (("m^3/rad", 1.5),)]
)
def test_a_quotient_undoes_its_factors(factors):
    unit = quotient_unit("N*m", *factors)
    assert product((unit, 1.0), *factors) == dimension_of("N*m")
