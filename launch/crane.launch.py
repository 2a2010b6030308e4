"""Compensator and estimator beside a crane's control stack.

ros2 launch winch_friction crane.launch.py params_file:=/path/to/my_crane.yaml namespace:=crane_1
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchContext, LaunchDescription

PACKAGE = "winch_friction"


def generate_launch_description() -> LaunchDescription:
    """The two nodes with one parameter file."""
    return LaunchDescription([*arguments(), OpaqueFunction(function=nodes)])


def nodes(context: LaunchContext) -> list[LifecycleNode]:
    """Once it is known what the command line says."""
    own = given(context, {"use_sim_time": bool, "autostart": bool})
    return [lifecycle_node(name, own) for name in ("compensator", "estimator")]


def arguments() -> list[DeclareLaunchArgument]:
    """What the command line may say."""
    default_file = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "nodes", "crane.yaml"])
    return [
        DeclareLaunchArgument("params_file", default_value=default_file, description="Parameters of both nodes"),
        DeclareLaunchArgument("namespace", default_value="", description="Namespace, one per crane"),
        DeclareLaunchArgument(
            "use_sim_time", default_value="", description="Take the time from /clock, or as the file"
        ),
        DeclareLaunchArgument(
            "autostart", default_value="", description="Configure and activate at start, or as the file"
        ),
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
