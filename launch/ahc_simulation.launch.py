"""The whole loop: a simulated 150 t crane in a sea, its compensator and its estimator.

ros2 launch winch_friction ahc_simulation.launch.py scenario:=ahc_irregular rate:=1.0

Its time is the topic `clock` of its namespace, which the nodes take for their `/clock`: two loops in two namespaces
do not share one. Without a namespace that is `/clock`.
"""

from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchDescription

PACKAGE = "winch_friction"


def generate_launch_description() -> LaunchDescription:
    """The three nodes with one parameter file; the simulator also takes scenario, rate and seed from here."""
    simulator = lifecycle_node("simulator", overrides() | simulation_overrides())
    return LaunchDescription(
        [*arguments(), simulator, *(lifecycle_node(name, overrides()) for name in ("compensator", "estimator"))]
    )


def arguments() -> list[DeclareLaunchArgument]:
    """What the command line may say."""
    default_file = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "nodes", "ahc_simulation.yaml"])
    return [
        DeclareLaunchArgument("params_file", default_value=default_file, description="Parameters of the three nodes"),
        DeclareLaunchArgument("namespace", default_value="", description="Namespace, one per crane"),
        DeclareLaunchArgument("use_sim_time", default_value="true", description="Take the time from the simulator"),
        DeclareLaunchArgument("autostart", default_value="true", description="Configure and activate at start"),
        DeclareLaunchArgument("scenario", default_value="ahc_irregular", description="Shipped scenario, or a file"),
        DeclareLaunchArgument("rate", default_value="1.0", description="Simulated seconds per second"),
        DeclareLaunchArgument("seed", default_value="1", description="Which sea"),
        DeclareLaunchArgument("log_level", default_value="info", description="Least severity that is logged"),
    ]


def lifecycle_node(name: str, own: dict[str, ParameterValue | bool]) -> LifecycleNode:
    """One node of this package."""
    return LifecycleNode(
        package=PACKAGE,
        executable=name,
        name=name,
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        parameters=[ParameterFile(LaunchConfiguration("params_file"), allow_substs=True), own],
        remappings=[("/clock", "clock")],
        arguments=["--ros-args", "--log-level", LaunchConfiguration("log_level")],
    )


def overrides() -> dict[str, ParameterValue | bool]:
    """Launch arguments that are parameters of every node."""
    names = ("use_sim_time", "autostart")
    return {name: ParameterValue(LaunchConfiguration(name), value_type=bool) for name in names}


def simulation_overrides() -> dict[str, ParameterValue | bool]:
    """Launch arguments that only the simulator reads; it makes the time, so it does not take it from /clock."""
    types = {"scenario": str, "rate": float, "seed": int}
    own = {name: ParameterValue(LaunchConfiguration(name), value_type=kind) for name, kind in types.items()}
    return {
        **own,
        "publish_clock": ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool),
        "use_sim_time": False,
    }
