"""A crane that is set while a node works: it counts from the next `configure` on, and is not accepted before."""

from typing import Any

import pytest
from rclpy.parameter import Parameter

from winch_friction.nodes.compensator import CompensatorNode
from winch_friction.nodes.estimator import EstimatorNode


@pytest.mark.parametrize("kind", [CompensatorNode, EstimatorNode], ids=lambda kind: kind.executable)
def test_another_crane_is_refused_while_a_node_is_built_on_one(context: Any, kind: type) -> None:
    """It was accepted without a word, and the torque stayed that of the crane before; `ros2 param get` told the other
    one, and the next cleanup and configure, for whatever reason, changed the machine."""
    node = kind(context=context)
    node.trigger_configure()
    node.trigger_activate()
    (done,) = node.set_parameters([Parameter("crane", value="worm_drive")])
    assert not done.successful
    assert done.reason == "'worm_drive' as crane counts from configure on, 'crane_150t' is in use: cleanup first"
    assert node.get_parameter("crane").value == node.crane.name == "crane_150t"
    (again,) = node.set_parameters([Parameter("crane", value="crane_150t")])  # of a file that is loaded once more
    assert again.successful
    node.trigger_deactivate()
    assert not node.set_parameters([Parameter("crane", value="worm_drive")])[0].successful
    node.trigger_cleanup()
    assert node.set_parameters([Parameter("crane", value="worm_drive")])[0].successful
    node.end()
    node.destroy_node()
