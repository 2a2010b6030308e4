"""Play a bag to a fresh compensator and estimator; what the recorded nodes said stays out.

ros2 launch winch_friction replay.launch.py bag:=/path/to/bag
"""

from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchContext, LaunchDescription

PACKAGE = "winch_friction"
# outputs of the recorded nodes would answer beside those of the fresh ones; --clock makes the time
NOT_PLAYED = ".*/(compensator|estimator|simulator)/.*|.*/friction_model|/diagnostics|/clock|/rosout|/parameter_events"

CLOCK_RATE = "200"  # Hz; a watchdog of 0.1 s that goes by this clock sees it move


def generate_launch_description() -> LaunchDescription:
    """The two nodes with one parameter file, and the player."""
    return LaunchDescription([*arguments(), OpaqueFunction(function=nodes), player()])


def nodes(context: LaunchContext) -> list[LifecycleNode]:
    """Once it is known what the command line says. The watchdog goes by the recording's clock, not by how busy this
    machine is."""
    own = {**given(context, {"use_sim_time": bool, "autostart": bool}), "watchdog_clock": "ros"}
    return [lifecycle_node(name, own) for name in ("compensator", "estimator")]


def arguments() -> list[DeclareLaunchArgument]:
    """What the command line may say."""
    default_file = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "nodes", "crane.yaml"])
    return [
        DeclareLaunchArgument("bag", description="The bag to play"),
        DeclareLaunchArgument("params_file", default_value=default_file, description="Parameters of both nodes"),
        DeclareLaunchArgument("namespace", default_value="", description="Namespace of the recorded topics"),
        DeclareLaunchArgument("use_sim_time", default_value="true", description="Take the time from the player"),
        DeclareLaunchArgument(
            "autostart", default_value="", description="Configure and activate at start, or as the file"
        ),
        DeclareLaunchArgument("rate", default_value="1.0", description="Recorded seconds per second"),
        DeclareLaunchArgument("delay", default_value="5.0", description="Seconds that the nodes get to start, s"),
        DeclareLaunchArgument("log_level", default_value="info", description="Least severity that is logged"),
    ]


def lifecycle_node(name: str, own: dict[str, ParameterValue | bool | str]) -> LifecycleNode:
    """One node of this package."""
    return LifecycleNode(
        package=PACKAGE,
        executable=name,
        name=name,
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        parameters=[ParameterFile(LaunchConfiguration("params_file"), allow_substs=True), own],
        arguments=["--ros-args", "--log-level", LaunchConfiguration("log_level")],
    )


def given(context: LaunchContext, kinds: dict[str, type]) -> dict[str, ParameterValue | bool | str]:
    """Launch arguments that are parameters and were given: what the command line does not say, the file says."""
    said = {name: LaunchConfiguration(name) for name in kinds}
    return {name: ParameterValue(each, value_type=kinds[name]) for name, each in said.items() if each.perform(context)}


def player() -> ExecuteProcess:
    """`ros2 bag play` with a clock."""
    options = ["--clock", CLOCK_RATE, "--rate", LaunchConfiguration("rate"), "--delay", LaunchConfiguration("delay")]
    return ExecuteProcess(
        cmd=["ros2", "bag", "play", LaunchConfiguration("bag"), *options, "--exclude-regex", NOT_PLAYED],
        output="screen",
    )
