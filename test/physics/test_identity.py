"""Which crane a model belongs to, and what it assumes where it does not say how sure it is."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import (
    ASSUMED_STD,
    contradictions,
    refuse_other_crane,
    refuse_other_motor,
    unstated,
    with_stated_std,
)
from winch_friction.physics.winch import Drive
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model


@pytest.mark.parametrize("name", ["a6vm215", "a6vm215_crane1", "a6vm215_crane2", "a6vm215_crane2_loop2"])
def test_shipped_models_belong_to_the_shipped_crane(name, crane_150t):
    refuse_other_crane(load_model(name), crane_150t)


def test_shipped_models_name_their_crane():
    assert load_model("a6vm215_crane2").crane == "crane_150t"
    assert load_model("emps_viscous").crane == "emps"
    assert load_model("a6vm215").crane == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"name": "crane_50t"}, "made for crane 'crane_150t'"),
        ({"gear_ratio": 180.0}, "gear ratio is 250, the crane's 180"),
        ({"max_displacement": 170 * CM3_PER_REV}, "largest displacement is 215 cm^3/rev, the crane's 170"),
        ({"drive": Drive("electric")}, "need pressures, the crane's drive is electric"),
    ],
)
def test_a_model_of_another_crane_is_refused(change, said, crane_150t):
    with pytest.raises(InputError) as error:
        refuse_other_crane(load_model("a6vm215_crane2"), replace(crane_150t, **change))
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_motors_may_have_served_another_winch(crane_150t):
    motors = load_model("a6vm215_crane2").only("motor")
    refuse_other_motor(motors, replace(crane_150t, name="other", gear_ratio=90.0))
    with pytest.raises(InputError, match="largest displacement"):
        refuse_other_motor(motors, replace(crane_150t, max_displacement=170 * CM3_PER_REV))


def test_all_contradictions_are_said_at_once(crane_150t):
    other = replace(crane_150t, name="x", gear_ratio=100.0, max_displacement=1e-5)
    assert len(contradictions(load_model("a6vm215_crane2"), other)) == 3


def test_a_model_that_names_no_crane_fits_any_of_its_motors(crane_150t):
    model = replace(load_model("a6vm215_crane2"), crane="")
    refuse_other_crane(model, replace(crane_150t, name="sister"))
    refuse_other_crane(load_model("emps_viscous"), load_crane("emps"))


def test_what_the_discrepancy_workflow_assumes_is_what_is_said():
    assert LIMITS.default_relative_std == ASSUMED_STD


def test_a_model_without_std_says_what_is_assumed():
    model = load_model("a6vm215_crane2")
    same, said = with_stated_std(model)
    assert same is model
    assert said == ""
    bare = model.with_covariance(None)
    assumed, said = with_stated_std(bare)
    assert "20 % of each value" in said
    assert model.name in said
    np.testing.assert_allclose(assumed.std, 0.2 * np.array(model.values))
    assert unstated(bare) == [said]
    assert unstated(model) == []
    zero = bare.with_values({"C3": 0.0})
    typical = {p.name: p.typical for p in zero.parameters}["C3"]
    assert with_stated_std(zero)[0].std[zero.parameter_names.index("C3")] == pytest.approx(0.02 * typical)


@pytest.mark.parametrize("asked", [lambda m: m.value("K99"), lambda m: m.with_values({"K1": 0.0, "K99": 1.0})])
def test_a_parameter_that_the_model_does_not_have_is_refused_with_those_that_it_has(asked):
    with pytest.raises(InputError, match="^model 'a6vm215' has no parameter K99; it has K1, K2, K3, K4, K5$"):
        asked(load_model("a6vm215"))
