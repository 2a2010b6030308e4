"""Play a bag to a fresh compensator and estimator; what the recorded nodes said stays out.

ros2 launch winch_friction replay.launch.py bag:=/path/to/bag
"""

from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchDescription

PACKAGE = "winch_friction"
# outputs of the recorded nodes would answer beside those of the fresh ones; --clock makes the time
NOT_PLAYED = ".*/(compensator|estimator|simulator)/.*|.*/friction_model|/diagnostics|/clock|/rosout|/parameter_events"

CLOCK_RATE = "200"  # Hz; a watchdog of 0.1 s that goes by this clock sees it move


def generate_launch_description() -> LaunchDescription:
    """The two nodes with one parameter file, and the player."""
    nodes = [lifecycle_node(name) for name in ("compensator", "estimator")]
    return LaunchDescription([*arguments(), *nodes, player()])


def arguments() -> list[DeclareLaunchArgument]:
    """What the command line may say."""
    default_file = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "nodes", "crane.yaml"])
    return [
        DeclareLaunchArgument("bag", description="The bag to play"),
        DeclareLaunchArgument("params_file", default_value=default_file, description="Parameters of both nodes"),
        DeclareLaunchArgument("namespace", default_value="", description="Namespace of the recorded topics"),
        DeclareLaunchArgument("use_sim_time", default_value="true", description="Take the time from the player"),
        DeclareLaunchArgument("autostart", default_value="true", description="Configure and activate at start"),
        DeclareLaunchArgument("rate", default_value="1.0", description="Recorded seconds per second"),
        DeclareLaunchArgument("delay", default_value="5.0", description="Seconds that the nodes get to start, s"),
        DeclareLaunchArgument("log_level", default_value="info", description="Least severity that is logged"),
    ]


def lifecycle_node(name: str) -> LifecycleNode:
    """One node of this package."""
    return LifecycleNode(
        package=PACKAGE,
        executable=name,
        name=name,
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        parameters=[ParameterFile(LaunchConfiguration("params_file"), allow_substs=True), overrides()],
        arguments=["--ros-args", "--log-level", LaunchConfiguration("log_level")],
    )


def overrides() -> dict[str, ParameterValue | str]:
    """Launch arguments that are parameters of every node; the watchdog goes by the recording's clock, not by how busy
    this machine is."""
    names = ("use_sim_time", "autostart")
    own = {name: ParameterValue(LaunchConfiguration(name), value_type=bool) for name in names}
    return {**own, "watchdog_clock": "ros"}


def player() -> ExecuteProcess:
    """`ros2 bag play` with a clock."""
    options = ["--clock", CLOCK_RATE, "--rate", LaunchConfiguration("rate"), "--delay", LaunchConfiguration("delay")]
    return ExecuteProcess(
        cmd=["ros2", "bag", "play", LaunchConfiguration("bag"), *options, "--exclude-regex", NOT_PLAYED],
        output="screen",
    )
