"""Parameters come from the option dataclasses, bounded and described."""

import math
from dataclasses import dataclass
from typing import Any

import pytest
from rclpy.exceptions import InvalidParameterValueException, ParameterUninitializedException

from winch_friction.compensation import CompensatorConfig
from winch_friction.nodes.options import FIXED, NodeOptions
from winch_friction.nodes.parameters import (
    OptionParameters,
    check_qualities,
    declare,
    declare_all,
    overruled,
    unknown_parameters,
)
from winch_friction.nodes.simulator import SimulatorNodeOptions
from winch_friction.physics.errors import InputError, Limits, check, option


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


# -- what is said of a parameter
@dataclass(frozen=True)
class Few:
    """Options of every kind."""

    plain: float = option(1.0, doc="any number")
    share: float = option(0.5, lower=0.0, upper=1.0, doc="a share")
    wait: float = option(2.0, lower=0.5, unit="s", doc="how long")
    unset: float = option(float("nan"), lower=0.0, upper=9.0, unit="m", may_be_nan=True, doc="perhaps")
    count: int = option(3, lower=1, upper=7, doc="how many")
    many: int = option(3, lower=-2, doc="at least")
    flag: bool = option(False, lower=0, upper=1, doc="whether")
    word: str = option("one", choices=("one", "two"), doc="which")
    some: tuple[str, ...] = option((), doc="names")
    gains: dict[str, float] = option({"a": 1.0, "b": 2.0}, lower=0.0, upper=5.0, doc="by name")

    def __post_init__(self) -> None:
        check(self)


def declared(*, overrides: dict | None = None, **arguments: Any) -> tuple[Board, OptionParameters[Few]]:
    board, options = Board(overrides), OptionParameters(Few, **arguments)
    options.declare(board)
    return board, options


def test_a_description_has_what_it_is_its_unit_its_choices_and_its_range() -> None:
    found = declared(fixed=("share", "count"))[0].descriptors
    assert {name: each.description for name, each in found.items()} == {
        "plain": "any number", "share": "a share", "wait": "how long [s]", "unset": "perhaps [m]", "count": "how many",
        "many": "at least", "flag": "whether", "word": "which One of: one, two.", "some": "names", "gains.a": "by name",
        "gains.b": "by name",
    }  # fmt: skip
    assert [name for name, each in found.items() if each.read_only] == ["share", "count"]
    floats = {n: (r[0].from_value, r[0].to_value) for n, each in found.items() if (r := each.floating_point_range)}
    assert floats == {"share": (0.0, 1.0), "wait": (0.5, float("inf")), "gains.a": (0.0, 5.0), "gains.b": (0.0, 5.0)}
    whole = {n: (r[0].from_value, r[0].to_value) for n, each in found.items() if (r := each.integer_range)}
    assert whole == {"count": (1, 7), "many": (-2, 2**62)}


def test_a_mapping_has_the_keys_of_its_default_and_those_that_are_known_now() -> None:
    known = {"gains": {"b": 3, "c": 4}}
    board, options = declared(keys=lambda: known, skip=("plain", "word"))
    assert {name: value for name, value in board.values.items() if "gains" in name} == {
        "gains.a": 1.0, "gains.b": 3.0, "gains.c": 4.0,
    }  # fmt: skip
    assert all(type(value) is float for name, value in board.values.items() if "gains" in name)
    assert "plain" not in board.values
    assert "word" not in options.names
    board.values["gains.a"], known["gains"]["d"] = 0.25, 5
    options.declare(board)  # what is declared keeps its value
    assert options.read(board).gains == {"a": 0.25, "b": 3.0, "c": 4.0, "d": 5.0}
    assert options.read(board, {"gains.c": 4.5, "share": 0.75, "elsewhere": 9}) == Few(
        share=0.75, unset=board.values["unset"], gains={"a": 0.25, "b": 3.0, "c": 4.5, "d": 5.0}
    )
    assert options.read(board, {}).share == 0.5


def test_a_bad_setting_is_told_by_the_nodes_name() -> None:
    board, options = declared()
    with pytest.raises(InputError, match=r"^board: parameters: share must be 0 \.\.\. 1, found 2$"):
        options.read(board, {"share": 2.0})


class Refusing(Board):
    """As rclpy: an override of another type, or out of its range, is refused."""

    def __init__(self, **given: object) -> None:
        super().__init__()
        self._parameter_overrides = {name: Override(value) for name, value in given.items()}

    def declare_parameter(self, name: str, default: object, descriptor: object) -> None:
        if name in self._parameter_overrides:
            value = self._parameter_overrides[name].value
            raise InvalidParameterValueException(name, value, "range")
        super().declare_parameter(name, default, descriptor)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("share", 7.5, "0 ... 1, found 7.5"),
        ("share", "much", "a number 0 ... 1, found 'much'"),
        ("wait", 1, "a number 0.5 ... inf s, found 1: write 1.0"),
        ("wait", 0, "a number 0.5 ... inf s, found 0"),
        ("wait", True, "a number 0.5 ... inf s, found True"),
        ("count", 9, "1 ... 7, found 9"),
        ("count", 2.0, "a whole number 1 ... 7, found 2.0"),
        ("flag", 1, "true or false, found 1"),
        ("word", 1, "a text, found 1"),
        ("some", "one", "a list of texts, found 'one'"),
        ("plain", "one", "a number -inf ... inf, found 'one'"),
    ],
)
def test_an_override_is_refused_with_what_it_must_be(name: str, value: object, said: str) -> None:
    with pytest.raises(InputError) as refused:
        OptionParameters(Few).declare(Refusing(**{name: value}))
    assert str(refused.value) == f"board: parameter '{name}' must be {said}"


def test_all_bad_overrides_of_all_settings_are_said_at_once() -> None:
    board = Refusing(share=7.5, count=9, rate=-1.0)
    with pytest.raises(InputError) as refused:
        declare_all(board, [OptionParameters(Few), OptionParameters(SimulatorNodeOptions)])
    assert [each.split("'")[1] for each in refused.value.problems] == ["share", "count", "rate"]
    assert "wait" in board.values  # the others are declared


def test_what_rclpy_refuses_for_another_reason_is_said_in_its_words() -> None:
    class Other(Refusing):
        def declare_parameter(self, name: str, default: object, descriptor: object) -> None:
            raise InvalidParameterValueException("share", 1.0, "two\n  lines")

    with pytest.raises(InputError, match="^board: parameter 'plain': .*two lines"):
        OptionParameters(Few, skip=[name for name in Few.__dataclass_fields__ if name != "plain"]).declare(Other())


@pytest.mark.parametrize("word", ["", "one", "two"])
def test_a_choice_is_one_of_those_or_the_default(word: str) -> None:
    board, limits = Board({"word": word}), Limits(choices=("one", "two"))
    declare(board, "word", "", limits)
    assert board.values["word"] == word
    with pytest.raises(InputError, match="^board: parameter 'word' must be one of one, two, found 'three'$"):
        declare(Board({"word": "three"}), "word", "", limits)


def test_an_override_that_is_no_parameter_is_said_with_what_may_be_meant() -> None:
    board, options = declared()
    given = ("wiat", "gains", "share", "qos_overrides./x.publisher.depth", "elsewhere")
    board._parameter_overrides = {name: Override(1) for name in given}
    assert unknown_parameters(board, [options]) == [
        "parameter 'elsewhere' is not known and has no effect",
        "parameter 'gains' is not known and has no effect; did you mean gains.b or gains.a?",
        "parameter 'wiat' is not known and has no effect; did you mean wait?",
    ]


@pytest.mark.parametrize(
    ("given", "held", "stands"),
    [
        ("-p share:=0.5", 0.9, False), ("--param share:=0.5", 0.9, False), ("-p share:=0.90", 0.9, True),
        ("-p share:=5e-1", 0.5, True), ("-p share:=.nan", math.nan, True), ("-p share:=true", True, True),
        ("-p share:=true", False, False), ("-p share:=[a, b]", ("a", "b"), True), ("-p share:=[a]", ["b"], False),
        ("-p share:=one", "two", False), ("-p share:=0.5 -p share:=0.9", 0.9, True), ("-p share:=[", 0.9, False),
        ("-p board:share:=0.5", 0.9, True), ("-p other:=0.5", 0.9, True), ("-- -p share:=0.5", 0.9, True),
        ("-p", 0.9, True),
    ],
)  # fmt: skip
def test_what_a_parameter_file_overrules_of_the_command_line_is_said(given: str, held: object, stands: bool) -> None:
    """rclpy obeys the section of a file that names the node, without a word: a scale of 0.9 where 0.5 was typed."""
    board = Board()
    board._parameter_overrides = {"share": Override(held)}
    arguments = given.replace("[a, b]", "[a,b]").split()
    assert overruled(board, ["board", "-p", "share:=7", "--ros-args", *arguments]) == (
        []
        if stands
        else [
            f"-p {arguments[-1]} has no effect: a parameter file says {held} in the section of this node; "
            f"write -p board:{arguments[-1]}"
        ]
    )


@pytest.mark.parametrize(("depth", "taken"), [(0, True), (100_000, True), (100_001, False), (-1, False)])
def test_a_queue_is_at_most_as_deep_as_the_middleware_takes(depth: int, taken: bool) -> None:
    if taken:
        check_qualities(overridden("depth", depth))
    else:
        with pytest.raises(InputError, match=r"a whole number 0 \.\.\. 100000, found"):
            check_qualities(overridden("depth", depth))


def test_only_qualities_of_service_are_looked_at_and_all_bad_ones_are_said() -> None:
    board = Board()
    board._parameter_overrides = {
        "mine.depth": Override("deep"), "qos_overrides./b.publisher.depth": Override(-1),
        "qos_overrides./a.publisher.history": Override("all"),
        "qos_overrides./a.publisher.durability": Override("volatile"),
    }  # fmt: skip
    with pytest.raises(InputError) as refused:
        check_qualities(board)
    assert [each.split("'")[1] for each in refused.value.problems] == [
        "qos_overrides./a.publisher.history", "qos_overrides./b.publisher.depth",
    ]  # fmt: skip


def test_what_is_read_with_the_model_may_change_and_everything_else_of_a_node_may_not() -> None:
    assert set(FIXED) == set(NodeOptions.__dataclass_fields__) - {"crane", "model_file", "terms_file"}
