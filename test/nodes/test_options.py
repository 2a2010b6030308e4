"""Parameters come from the option dataclasses, bounded and described."""

import pytest
from rclpy.exceptions import ParameterUninitializedException

from winch_friction.compensation import CompensatorConfig
from winch_friction.nodes.options import NodeOptions
from winch_friction.nodes.parameters import OptionParameters, check_qualities
from winch_friction.nodes.simulator import SimulatorNodeOptions
from winch_friction.physics.errors import InputError


class Board:
    """A parameter board with rclpy's interface: values and descriptors, nothing else."""

    def __init__(self, overrides: dict | None = None) -> None:
        self.values, self.descriptors, self._overrides = {}, {}, overrides or {}

    def get_name(self) -> str:
        return "board"

    def has_parameter(self, name: str) -> bool:
        return name in self.values

    def declare_parameter(self, name: str, default: object, descriptor: object) -> None:
        self.values[name] = self._overrides.get(name, default)
        self.descriptors[name] = descriptor

    def get_parameter(self, name: str) -> object:
        if self.values[name] is None:
            raise ParameterUninitializedException(name)
        return type("P", (), {"value": self.values[name]})()


def test_every_option_is_a_described_parameter() -> None:
    board, options = Board(), OptionParameters(CompensatorConfig, keys=lambda: {"gains": {"stribeck": 1.0}})
    options.declare(board)
    assert all(descriptor.description for descriptor in board.descriptors.values())
    assert board.values["gains.stribeck"] == 1.0
    limits = board.descriptors["scale"].floating_point_range[0]
    assert (limits.from_value, limits.to_value) == (0.0, 1.3)


def test_options_come_back_as_they_were_declared() -> None:
    board, options = Board({"scale": 0.8, "max_ages.hook_load": 3.0}), OptionParameters(CompensatorConfig)
    options.declare(board)
    assert options.read(board) == CompensatorConfig(
        scale=0.8, max_ages={"hook_load": 3.0, "oil_temperature": 30.0, "wire_layer": 30.0, "wire_out": 2.0}
    )


def test_changes_are_checked_together_without_being_taken_over() -> None:
    board, options = Board(), OptionParameters(CompensatorConfig)
    options.declare(board)
    with pytest.raises(InputError, match="cycle at reversal"):
        options.read(board, {"velocity_source": "measured", "drive": "torque"})
    assert board.values["velocity_source"] == "reference"


def test_a_simulator_without_pace_or_lockstep_is_refused() -> None:
    board, options = Board({"rate": 0.0}), OptionParameters(SimulatorNodeOptions)
    options.declare(board)
    with pytest.raises(InputError, match="needs lockstep"):
        options.read(board)


def test_an_empty_list_of_strings_survives_ros() -> None:
    board, options = Board(), OptionParameters(NodeOptions)
    options.declare(board)
    assert board.values["float64_inputs"] == [""]  # rclpy cannot tell the type of an empty list
    assert options.read(board) == NodeOptions()


def overridden(policy: str, value: object) -> Board:
    board = Board()
    board._parameter_overrides = {f"qos_overrides./winch/joint_states.subscription.{policy}": Override(value)}
    return board


class Override:
    def __init__(self, value: object) -> None:
        self.value = value


@pytest.mark.parametrize(
    ("policy", "value", "said"),
    [
        ("reliability", "maybe", "one of reliable, best_effort"),
        ("reliability", 1, "one of reliable, best_effort"),
        ("durability", "unknown", "one of volatile, transient_local"),
        ("history", "", "one of keep_last, keep_all"),
        ("depth", -5, "a whole number 0"),
        ("depth", 10**12, "a whole number 0"),
        ("depth", "deep", "a whole number 0"),
        ("depth", True, "a whole number 0"),
    ],
)
def test_a_quality_of_service_that_there_is_not_is_refused_by_its_parameter(
    policy: str, value: object, said: str
) -> None:
    with pytest.raises(InputError, match=rf"qos_overrides./winch/joint_states.subscription.{policy}' must be {said}"):
        check_qualities(overridden(policy, value))


@pytest.mark.parametrize(
    ("policy", "value"),
    [
        ("reliability", "best_effort"),
        ("durability", "TRANSIENT_LOCAL"),
        ("history", "keep_all"),
        ("depth", 1),
        ("deadline", 5),
    ],
)
def test_a_quality_of_service_that_there_is_passes(policy: str, value: object) -> None:
    check_qualities(overridden(policy, value))


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("groups", r'must be a list of texts, found none, or \[\].*\[""\] stands for none'),
        ("crane", "must be a text, found none$"),
    ],
)
def test_a_list_without_entries_is_told_by_its_parameter(name: str, said: str) -> None:
    """ROS tells no type of [], and of the parameter that has none it said "is not initialized: groups"."""
    with pytest.raises(InputError, match=rf"^board: parameter '{name}' {said}"):
        OptionParameters(NodeOptions).declare(Board({name: None}))
