"""Start a node, spin it in one thread, end it properly; bad input is one line and exit code 2."""

import sys
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy._rclpy_pybind11 import RCLError
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from winch_friction.physics.errors import InputError

BAD_INPUT = 2


def run(make: Callable[[], Any], arguments: Sequence[str] | None = None) -> int:
    """Make the node, start it as its `autostart` says, and spin until it is told to end."""
    try:
        rclpy.init(args=None if arguments is None else list(arguments))
        node = make()
    except InputError as error:
        return _refuse(error)
    except rclpy.exceptions.ROSInterruptException:
        return 0
    except Exception as error:
        if type(error).__module__.startswith("rclpy"):  # unreadable parameter file, invalid remap, invalid name
            return _refuse(error)
        raise
    try:
        return _start(node) or _spin(node)
    finally:
        node.save()
        node.destroy_node()
        rclpy.try_shutdown()


def _start(node: Any) -> int:
    if node.options.autostart:
        done = node.trigger_configure()
        if done.name != "SUCCESS" or node.trigger_activate().name != "SUCCESS":
            return BAD_INPUT
    return 0


def _spin(node: Any) -> int:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except RCLError:
        if rclpy.ok():  # otherwise the signal came between two waits
            raise
    finally:
        executor.remove_node(node)
    return 0


def _refuse(error: Exception) -> int:
    print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
    rclpy.try_shutdown()
    return BAD_INPUT
