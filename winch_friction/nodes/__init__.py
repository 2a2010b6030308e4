"""ROS 2 nodes: thin shells that convert, call a service and publish. The only place that imports rclpy."""

import gc
import os
import signal
import sys

_NODES = ("compensator", "estimator", "simulator")


def _started_as_a_node() -> bool:
    """Whether this process is one of the nodes, and not a program that imports something from here."""
    modules = tuple(f"{__name__}.{node}" for node in _NODES)
    return os.path.basename(sys.argv[0]) in _NODES or any(each in modules for each in sys.orig_argv)


if _started_as_a_node():
    # the imports take seconds: until `run` listens, there is nothing to end but the process
    for _each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(_each, lambda *_: os._exit(0))
    # no look for garbage while modules are loaded, none of which is any: an eighth of a start. `run` ends that
    gc.disable()
