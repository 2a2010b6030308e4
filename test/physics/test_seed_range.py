"""How far a learned parameter may lie from its seed: by its size, and by sigma where it has no size of its own."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.seed_range import refuse_outside_seed, seed_range


def model(value, std, **bounds):
    """A constant torque that may have either sign, beside a Coulomb friction that may not."""
    terms = (term_named("torque_offset"), term_named("coulomb"))
    return FrictionModel("m", terms, (value, 8.0), np.diag([std**2, 4.0]), bounds)


@pytest.mark.parametrize(
    ("value", "std", "reach"),
    [
        (2.0, 5.0, 15.0),  # three sigma reach further than half of it
        (-2.0, 5.0, 15.0),
        (20.0, 1.0, 10.0),  # half of it reaches further than three sigma
        (-20.0, 1.0, 10.0),
        (0.0, 2.0, 6.0),
        (0.0, 0.0, 1.0),  # neither: its typical size
    ],
)
def test_a_parameter_of_either_sign_may_move_by_sigma(value, std, reach):
    found = seed_range(model(value, std), 0.5)
    assert found["T_0"] == pytest.approx((value - reach, value + reach))


def test_a_parameter_moves_by_its_own_sigma_wherever_it_stands():
    terms = (term_named("coulomb"), term_named("torque_offset"))
    behind = FrictionModel("m", terms, (8.0, 2.0), np.diag([2.0**2, 5.0**2]))
    assert seed_range(behind, 0.5) == {"C2": pytest.approx((4.0, 12.0)), "T_0": pytest.approx((-13.0, 17.0))}


def test_a_signed_seed_without_covariance_moves_by_its_typical_size():
    bare = model(0.1, 1.0).with_covariance(None)
    assert seed_range(bare, 0.5)["T_0"] == pytest.approx((-0.9, 1.1))


def test_a_parameter_of_one_sign_moves_by_its_share_alone():
    assert seed_range(model(0.0, 1.0), 0.5)["C2"] == pytest.approx((4.0, 12.0))  # sigma 2 does not count


def test_bounds_hold_in_either_case():
    assert seed_range(model(2.0, 5.0, T_0=(-3.0, 4.0), C2=(6.0, 9.0)), 0.5) == {"T_0": (-3.0, 4.0), "C2": (6.0, 9.0)}


def test_what_lies_outside_is_refused_on_either_side():
    seed = model(2.0, 1.0)
    for value in (-1.0, 5.0):
        refuse_outside_seed(seed.with_values({"T_0": value}), seed, 0.5)
    for value in (-1.1, 5.1):
        with pytest.raises(InputError, match="T_0"):
            refuse_outside_seed(replace(seed.with_values({"T_0": value}), name="learned"), seed, 0.5)


@pytest.mark.parametrize(("beyond", "refused"), [(1e-11, False), (1e-6, True)])
def test_a_value_at_the_edge_is_not_refused_for_the_rounding_of_its_file(crane2_model, beyond, refused):
    edge = crane2_model.with_values({"K2": 1.5 * (1.0 + beyond) * crane2_model.value("K2")})
    if refused:
        with pytest.raises(InputError, match="parameter K2"):
            refuse_outside_seed(edge, crane2_model, 0.5)
    else:
        refuse_outside_seed(edge, crane2_model, 0.5)


def test_what_lies_just_outside_is_told_apart_from_the_edge(crane2_model: FrictionModel) -> None:
    """It read 'K1 = 0.006075 is outside 0.002025 ... 0.006075'."""
    beside = crane2_model.with_values({"K1": 1.5000001 * crane2_model.value("K1")})
    with pytest.raises(InputError, match=r"K1 = 0\.0060750004\d* is outside .* 0\.006075, "):
        refuse_outside_seed(beside, crane2_model, 0.5)
