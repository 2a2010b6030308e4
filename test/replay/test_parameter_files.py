"""ROS parameter files of the nodes at the desk: what sets nothing, or is no value, is refused."""

import math

import pytest

from winch_friction.compensation import CompensatorConfig
from winch_friction.physics.errors import InputError
from winch_friction.records.input_mapping import bag_options_of
from winch_friction.replay.settings import longest_held, settings_for_rate, settings_from_file, settings_from_metadata


@pytest.mark.parametrize(
    "text",
    [
        "compensater:\n  ros__parameters: {scale: 0.3}\n",
        "winch: {compensater: {ros__parameters: {scale: 0.3}}}\n",
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


@pytest.mark.parametrize("node", ["/**", "/**/*", "/winch_1/estimator", "compensator"])
def test_a_parameter_file_of_one_node_will_do(tmp_path, node):
    params = tmp_path / "params.yaml"
    params.write_text(f"{node}:\n  ros__parameters: {{max_age: 0.3}}\n")
    found = settings_from_file(params)
    assert 0.3 in (found.phases[0].config.max_age, found.estimator_max_age)


TWO = """
/**/*: {ros__parameters: {model_delay: 0.3}}
/north/compensator: {ros__parameters: {scale: 0.6}}
south: {compensator: {ros__parameters: {scale: 0.4}}, estimator: {ros__parameters: {max_age: 0.3}}}
"""


def test_a_file_of_two_winches_is_read_as_ros_reads_it(tmp_path):
    """The last one's settings were taken for whichever winch was replayed, without a word."""
    params = tmp_path / "params.yaml"
    params.write_text(TWO)
    for namespace, scale, max_age in (("north", 0.6, 0.1), ("/south/", 0.4, 0.3), ("/", 0.9, 0.1)):
        found = settings_from_file(params, namespace)
        assert (found.phases[0].config.scale, found.estimator_max_age) == (scale, max_age)
        assert found.model_delay == 0.3
        assert bag_options_of(params, namespace)["namespace"] == namespace
    for read in (settings_from_file, bag_options_of):
        with pytest.raises(InputError, match=r"params.yaml: parameters of several winches: /north, /south; choose one"):
            read(params)
    params.write_text(TWO.replace("south: ", "ship/north: "))  # told by the end of its name, as in a bag
    assert settings_from_file(params, "ship/north").phases[0].config.scale == 0.4


def test_age_limits_that_a_file_does_not_name_are_the_nodes(tmp_path):
    """A node keeps its defaults beside the one that is set; in a replay the others fell to max_age."""
    params = tmp_path / "params.yaml"
    params.write_text("compensator: {ros__parameters: {max_ages: {hook_load: 3.0}}}\n")
    ages = settings_from_file(params).phases[0].config.max_ages
    assert ages == {**CompensatorConfig().max_ages, "hook_load": 3.0}


# -- what a recording and a file say, setting by setting
def test_each_setting_of_a_file_is_the_one_that_it_is_called(tmp_path):
    params = tmp_path / "params.yaml"
    params.write_text(
        "compensator:\n  ros__parameters: {scale: 0.7, max_age: 0.21, model_delay: 0.31, watchdog_timeout: 0.41, "
        "stamp_window: 0.51, follow_model_topic: false}\n"
        "estimator:\n  ros__parameters: {gate: 4.0, max_age: 0.61, model_period: 7.1}\n"
    )
    found = settings_from_file(params)
    (phase,) = found.phases
    assert (phase.config.scale, phase.config.max_age, phase.follow_models, phase.enabled) == (0.7, 0.21, False, True)
    assert (found.model_delay, found.watchdog_timeout, found.stamp_window) == (0.31, 0.41, 0.51)
    assert (found.estimator.gate, found.estimator_max_age, found.model_period) == (4.0, 0.61, 7.1)


def test_a_slow_log_has_one_age_limit_for_both():
    found = settings_for_rate(3.0)
    assert (found.phases[0].config.max_age, found.estimator_max_age) == (3.0, 3.0)
    assert longest_held() == 10.0


def test_what_a_recording_says_of_its_phases_is_taken_and_the_rest_is_the_nodes():
    assert settings_from_metadata({}, "bag") is None
    said = [
        {"parameters": {"scale": 0.5}},
        {"name": "off", "enabled": False, "start": 12.5, "parameters": {"follow_model_topic": False}},
        {"parameters": {"model_file": "a6vm215_crane1"}},
    ]
    found = settings_from_metadata({"phases": said, "estimator": {"gate": 6.0}}, "bag")
    first, second, third = found.phases
    assert (first.start, first.enabled, first.follow_models, first.config.scale) == (-math.inf, True, True, 0.5)
    assert (second.start, second.enabled, second.follow_models, second.name) == (12.5, False, False, "off")
    assert math.isnan(third.start)
    assert (third.enabled, third.follow_models, third.seed.name, first.seed) == (True, True, "a6vm215_crane1", None)
    assert found.estimator.gate == 6.0
    with pytest.raises(InputError, match=r"bag: phases\[2\]: unknown key 'scal'"):
        settings_from_metadata({"phases": [{}, {"parameters": {"scal": 1.0}}]}, "bag")
