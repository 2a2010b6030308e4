"""The whole loop: a simulated 150 t crane in a sea, its compensator and its estimator.

ros2 launch winch_friction ahc_simulation.launch.py scenario:=ahc_irregular rate:=1.0

Its time is the topic `clock` of its namespace, which the nodes take for their `/clock`: two loops in two namespaces
do not share one. Without a namespace that is `/clock`.
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare

from launch import LaunchContext, LaunchDescription

PACKAGE = "winch_friction"


def generate_launch_description() -> LaunchDescription:
    """The three nodes with one parameter file; the simulator also takes scenario, rate and seed from here."""
    return LaunchDescription([*arguments(), OpaqueFunction(function=nodes)])


def nodes(context: LaunchContext) -> list[LifecycleNode]:
    """Once it is known what the command line says; the simulator makes the time, so it does not take it from /clock."""
    own = given(context, {"use_sim_time": bool, "autostart": bool})
    simulation = given(context, {"autostart": bool, "scenario": str, "rate": float, "seed": int})
    clock = ParameterValue(LaunchConfiguration("use_sim_time"), value_type=bool)
    simulator = lifecycle_node("simulator", {**simulation, "publish_clock": clock, "use_sim_time": False})
    return [simulator, *(lifecycle_node(name, own) for name in ("compensator", "estimator"))]


def arguments() -> list[DeclareLaunchArgument]:
    """What the command line may say."""
    default_file = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "nodes", "ahc_simulation.yaml"])
    return [
        DeclareLaunchArgument("params_file", default_value=default_file, description="Parameters of the three nodes"),
        DeclareLaunchArgument("namespace", default_value="", description="Namespace, one per crane"),
        DeclareLaunchArgument("use_sim_time", default_value="true", description="Take the time from the simulator"),
        DeclareLaunchArgument(
            "autostart", default_value="", description="Configure and activate at start, or as the file"
        ),
        DeclareLaunchArgument("scenario", default_value="", description="Shipped scenario, or a file"),
        DeclareLaunchArgument("rate", default_value="", description="Simulated seconds per second"),
        DeclareLaunchArgument("seed", default_value="", description="Which sea"),
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
        remappings=[("/clock", "clock")],
        arguments=["--ros-args", "--log-level", LaunchConfiguration("log_level")],
    )


def given(context: LaunchContext, kinds: dict[str, type]) -> dict[str, ParameterValue | bool | str]:
    """Launch arguments that are parameters and were given: what the command line does not say, the file says."""
    said = {name: LaunchConfiguration(name) for name in kinds}
    return {name: ParameterValue(each, value_type=kinds[name]) for name, each in said.items() if each.perform(context)}
