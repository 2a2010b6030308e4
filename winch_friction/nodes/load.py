"""Hands a model file to a running compensator, as `ros2 param set` and `ros2 service call` would."""

import argparse
import sys
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor

from winch_friction.nodes.remote import RemoteNode, looking_on
from winch_friction.physics.errors import InputError

PATIENCE = 15.0  # s; the node runs already, so nothing has to be compiled


def main() -> int:
    """Load the model; a refusal is said in one line, leaves the old model at work and is exit status 2."""
    parser = argparse.ArgumentParser()
    parser.add_argument("model")
    parser.add_argument("--terms-file", default="")
    parser.add_argument("--namespace", default="")
    parser.add_argument("--node", default="compensator")
    options = parser.parse_args()
    try:
        node = looking_on("winch_friction_load", options.namespace)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    refusal = ""
    try:
        print(handed_over(RemoteNode(node, executor, options.node, PATIENCE), options.model, options.terms_file))
    except InputError as error:
        refusal = str(error)
    finally:
        executor.shutdown()  # before the node: its wait set holds what the node destroys
        node.destroy_node()
        rclpy.try_shutdown()
    if refusal:  # last, so that nothing that the end says stands behind it
        print(refusal, file=sys.stderr)
    return 2 if refusal else 0


def handed_over(remote: RemoteNode, model: str, terms_file: str = "") -> str:
    """The node's own words on the model it took; after a refusal its parameters are what they were."""
    wanted: dict[str, Any] = {"model_file": model} | ({"terms_file": terms_file} if terms_file else {})
    before = {name: remote.get(name).string_value for name in wanted}
    remote.set(wanted)
    try:
        return remote.trigger("load_model")
    except InputError:
        remote.set(before)
        raise


if __name__ == "__main__":
    raise SystemExit(main())
