"""Driving other nodes from outside: lifecycle, parameters, switches; each call says in one line what went wrong."""

from collections.abc import Mapping
from typing import Any

import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.validate_namespace import validate_namespace
from std_srvs.srv import SetBool, Trigger

from winch_friction.physics.errors import InputError

PATIENCE = 60.0  # s; a first start compiles
# a server may see a request before it has discovered where the answer goes, and that answer is lost: questions are
# asked again; what changes the node is asked for once, and only after a question was answered
QUESTIONS = 12
CHANGING = ("change_state", "set_parameters", "enable", "reset", "save", "load_model")

TRANSITIONS = {
    "configure": Transition.TRANSITION_CONFIGURE,
    "activate": Transition.TRANSITION_ACTIVATE,
    "deactivate": Transition.TRANSITION_DEACTIVATE,
    "cleanup": Transition.TRANSITION_CLEANUP,
}


def looking_on(name: str, namespace: str) -> Node:
    """A node that looks on from outside; `InputError` for a namespace or a ROS_DOMAIN_ID that there cannot be."""
    try:
        validate_namespace(f"/{namespace.removeprefix('/')}")  # a node that fails over it warns of itself besides
        rclpy.init(args=[])
        return rclpy.create_node(name, namespace=namespace, start_parameter_services=False)
    except Exception as error:
        if not type(error).__module__.startswith("rclpy"):
            raise
        rclpy.try_shutdown()
        raise InputError(" ".join(str(error).split()).rstrip(" ^")) from error


class RemoteNode:
    """Another node, by its name in this node's namespace."""

    def __init__(self, node: Node, executor: Executor, name: str, patience: float = PATIENCE) -> None:
        self._node, self._executor, self.name, self._patience = node, executor, name, patience
        self._clients: dict[str, Any] = {}

    def state(self) -> str:
        """Its lifecycle state: unconfigured, inactive, active, finalized."""
        return str(self._call(GetState, "get_state", GetState.Request()).current_state.label)

    def change(self, *transitions: str) -> None:
        """Take it through lifecycle transitions; `InputError` when it refuses."""
        self.state()
        for each in transitions:
            request = ChangeState.Request(transition=Transition(id=TRANSITIONS[each]))
            if not self._call(ChangeState, "change_state", request).success:
                raise InputError(f"{self.name}: refused to {each}; its log says why")

    def set(self, values: Mapping[str, Any]) -> None:
        """Set parameters together; `InputError` with the node's reason when it refuses."""
        parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
        answer = self._call(SetParameters, "set_parameters", SetParameters.Request(parameters=parameters))
        for name, result in zip(values, answer.results, strict=True):
            if not result.successful:
                raise InputError(f"{self.name}: parameter '{name}': {result.reason}")

    def get(self, name: str) -> Any:
        """A parameter's value message."""
        return self._call(GetParameters, "get_parameters", GetParameters.Request(names=[name])).values[0]

    def switch(self, service: str, on: bool) -> str:
        """Call a SetBool service."""
        return self._said(service, self._call(SetBool, service, SetBool.Request(data=on)))

    def trigger(self, service: str) -> str:
        """Call a Trigger service."""
        return self._said(service, self._call(Trigger, service, Trigger.Request()))

    def _said(self, service: str, answer: Any) -> str:
        if not answer.success:
            raise InputError(f"{self.name}: {service}: {answer.message}")
        return str(answer.message)

    def _call(self, service_type: Any, service: str, request: Any) -> Any:
        if service not in self._clients:
            self._clients[service] = self._node.create_client(service_type, f"{self.name}/{service}")
        client = self._clients[service]
        if not client.wait_for_service(timeout_sec=self._patience):
            raise InputError(f"{self.name}: not there after {self._patience:g} s; did it start? In this ROS_DOMAIN_ID?")
        asked = 1 if service in CHANGING else QUESTIONS
        for _ in range(asked):
            future = client.call_async(request)
            self._executor.spin_until_future_complete(future, timeout_sec=self._patience / asked)
            if future.done():
                return future.result()
            client.remove_pending_request(future)
        raise InputError(f"{self.name}: no answer from {service} within {self._patience:g} s")
