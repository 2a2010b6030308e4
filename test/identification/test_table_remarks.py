"""A slip in one row and a speed in another unit are said of a supplier's table; a good table is left alone."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from winch_friction.identification.motor_identification import identify_motor, motor_seed
from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.identification.supplier_table import FitRange
from winch_friction.identification.table_remarks import remarks_on
from winch_friction.physics.channels import BAR
from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import shipped

TABLES = ("a6vm170", "a6vm215")


@cache
def table(name="a6vm215"):
    return read_supplier_table(shipped("suppliers", f"{name}_generated", ".csv"))


def said(read):
    return remarks_on(identify_motor(read, ["mj4"], with_complex=False, force=True))


@pytest.mark.parametrize("name", TABLES)
def test_a_table_that_the_model_fits_is_left_alone(name):
    assert said(table(name)) == []


def test_a_digit_in_the_wrong_place_is_named_by_its_operating_point():
    loss = table().torque_loss.copy()
    loss[6] = (1.0 - 0.0917) * table().nominal_torque[6]  # 9.17 % for 91.7 %
    (remark,) = said(replace(table(), torque_loss=loss))
    assert "at 400 rpm, 100 bar and 183 cm^3/rev 90.8 % of D dp are lost" in remark
    many = np.where(np.arange(len(loss)) % 60 == 0, 0.9 * table().nominal_torque, table().torque_loss)
    assert len(said(replace(table(), torque_loss=many))) == 3


def test_a_speed_in_turns_per_second_ends_at_parameters_that_no_motor_has():
    (remark,) = said(replace(table(), speed=table().speed / 60.0))
    assert remark.startswith("a6vm215_generated.csv: K1, K2 of 'mj4' end at the largest value that any motor has")


@pytest.mark.parametrize("times", [2.0 * np.pi / 60.0, 1.0 / 60.0], ids=["rad/s under rpm", "turns a second under rpm"])
def test_a_model_that_no_motor_has_is_not_taken_for_a_seed(times):
    """At the speed that the motor truly turns at, its K2 alone lost twice the motor's torque; a warning was all."""
    wrong = replace(table(), speed=table().speed * times)
    with pytest.raises(
        InputError, match=r"^a6vm215_generated.csv: K1, K2 of 'mj4' end at .*; identify --force takes the fit"
    ):
        identify_motor(wrong, ["mj4"], with_complex=False)
    forced = identify_motor(wrong, ["mj4"], with_complex=False, force=True)
    assert "K1, K2" in motor_seed(forced, "forced", {}).provenance["forced"]
    assert "forced" not in motor_seed(identify_motor(table(), ["mj4"], with_complex=False), "good", {}).provenance


def test_displacements_beyond_the_stated_largest_are_another_motors():
    (remark,) = said(replace(table(), max_displacement=0.9 * table().max_displacement))
    assert "displacements up to 215 cm^3/rev, and the motor's largest is given as 193.5: the table of another" in remark
    assert said(replace(table(), max_displacement=0.99 * table().max_displacement)) == []


def test_pressures_that_were_rounded_in_another_unit_stay_within_the_range():
    psi = table().pressure / BAR * 14.5038
    rounded = replace(table(), pressure=np.where(psi > 3000.0, np.ceil(psi), np.floor(psi)) / 14.5038 * BAR)
    assert FitRange.usual(rounded).left_out(rounded) == ""
