"""Compensator and estimator beside a crane's control stack.

ros2 launch winch_friction crane.launch.py params_file:=/path/to/my_crane.yaml namespace:=crane_1
"""

from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchDescription

PACKAGE = "winch_friction"


def generate_launch_description() -> LaunchDescription:
    """The two nodes with one parameter file."""
    return LaunchDescription([*arguments(), *(lifecycle_node(name) for name in ("compensator", "estimator"))])


def arguments() -> list[DeclareLaunchArgument]:
    """What the command line may say."""
    default_file = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "nodes", "crane.yaml"])
    return [
        DeclareLaunchArgument("params_file", default_value=default_file, description="Parameters of both nodes"),
        DeclareLaunchArgument("namespace", default_value="", description="Namespace, one per crane"),
        DeclareLaunchArgument("use_sim_time", default_value="false", description="Take the time from /clock"),
        DeclareLaunchArgument("autostart", default_value="true", description="Configure and activate at start"),
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


def overrides() -> dict[str, ParameterValue]:
    """Launch arguments that are parameters of every node."""
    names = ("use_sim_time", "autostart")
    return {name: ParameterValue(LaunchConfiguration(name), value_type=bool) for name in names}
