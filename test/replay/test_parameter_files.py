"""ROS parameter files of the nodes at the desk: what sets nothing, or is no value, is refused."""

import pytest

from winch_friction.compensation import CompensatorConfig
from winch_friction.physics.errors import InputError
from winch_friction.records.input_mapping import bag_options_of
from winch_friction.replay.settings import settings_from_file


@pytest.mark.parametrize(
    "text",
    [
        "compensater:\n  ros__parameters: {scale: 0.3}\n",
        "winch: {compensator: {ros__parameters: {scale: 0.3}}}\n",
        "schema: winch_friction.scenario/1\nname: x\n",
    ],
)
def test_a_parameter_file_that_would_set_nothing_is_refused(tmp_path, text):
    params = tmp_path / "params.yaml"
    params.write_text(text)
    with pytest.raises(InputError, match=r"params.yaml: no parameters of compensator or estimator.* found [a-z]"):
        settings_from_file(params)
    with pytest.raises(InputError, match=r"params.yaml: no parameters of compensator or estimator.* found [a-z]"):
        bag_options_of(params)  # of gap, identify and convert: gauge pressures would be taken for absolute ones


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("compensator: {ros__parameters: {model_delay: fast}}", "params.yaml: model_delay must be a finite number"),
        ("estimator: {ros__parameters: {max_age: -0.1}}", "params.yaml: estimator: max_age must be above 0 s"),
        ("compensator: {ros__parameters: {follow_model_topic: 'no'}}", "follow_model_topic must be true or false"),
        ("compensator: {ros__parameters: [1]}", "ros__parameters must hold names with values"),
    ],
)
def test_a_parameter_that_is_no_value_is_refused_in_one_line(tmp_path, text, said):
    params = tmp_path / "params.yaml"
    params.write_text(text)
    with pytest.raises(InputError, match=said):
        settings_from_file(params)


@pytest.mark.parametrize("node", ["/**", "/winch_1/estimator", "compensator"])
def test_a_parameter_file_of_one_node_will_do(tmp_path, node):
    params = tmp_path / "params.yaml"
    params.write_text(f"{node}:\n  ros__parameters: {{max_age: 0.3}}\n")
    assert settings_from_file(params)


def test_age_limits_that_a_file_does_not_name_are_the_nodes(tmp_path):
    """A node keeps its defaults beside the one that is set; in a replay the others fell to max_age."""
    params = tmp_path / "params.yaml"
    params.write_text("compensator: {ros__parameters: {max_ages: {hook_load: 3.0}}}\n")
    ages = settings_from_file(params).phases[0].config.max_ages
    assert ages == {**CompensatorConfig().max_ages, "hook_load": 3.0}
