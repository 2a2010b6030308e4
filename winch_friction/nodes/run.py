"""Start a node, spin it in one thread, end it properly; bad input is one line and exit code 2."""

import gc
import signal
import sys
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import get_default_context

from winch_friction.nodes.console import Console
from winch_friction.nodes.loop import Loop
from winch_friction.nodes.parameters import overruled
from winch_friction.nodes.usage import HELP, refuse_own_arguments, usage
from winch_friction.physics.errors import InputError

BAD_INPUT = 2
MOST_DEFECTS = 1000  # of the executor itself in a row, with nothing done in between


class Ending:
    """Whether SIGINT, SIGTERM or SIGHUP (the terminal was closed, the remote login broke) came. rclpy's own handlers
    would take the context down before the last ramp is published."""

    def __init__(self) -> None:
        self.asked = False
        for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if each is not signal.SIGHUP or signal.getsignal(each) is not signal.SIG_IGN:  # nohup: it is to go on
                signal.signal(each, self._ask)

    def _ask(self, *_: Any) -> None:
        self.asked = True


def run(make: Any, arguments: Sequence[str] | None = None) -> int:
    """Make the node, start it as its `autostart` says, and spin until it is told to end; printing waits for nobody.

    `arguments` are those of a command line, its program first; `sys.argv` without any.
    """
    gc.freeze()  # what is imported stands to the end; each look through it for garbage holds the control for 0.04 s
    gc.enable()
    if set(HELP) & set((sys.argv if arguments is None else arguments)[1:]):
        print(usage(make.executable, (make.__doc__ or "").partition("\n")[0], make.told_by))
        return 0
    ending, console = Ending(), Console()
    try:
        return _run(make, arguments, ending)
    finally:
        console.end()


def _run(make: Callable[[], Any], arguments: Sequence[str] | None, ending: Ending) -> int:
    try:
        given = None if arguments is None else list(arguments)
        refuse_own_arguments((sys.argv if given is None else given)[1:])
        _begin(given)
        node = make()
        node.told_to_end = lambda: ending.asked
        for each in overruled(node, sys.argv if given is None else given):
            node.get_logger().warning(each)
    except InputError as error:
        return _refuse(error)
    except rclpy.exceptions.ROSInterruptException:
        return 0
    except Exception as error:
        if type(error).__module__.startswith("rclpy"):  # unreadable parameter file, invalid remap, invalid name
            return _refuse(error)
        raise
    try:
        return _start(node, ending) or _spin(node, ending)
    finally:
        node.end()
        node.destroy_node()
        rclpy.try_shutdown()


def _begin(arguments: list[str] | None) -> None:
    """Without a log file where none can be written: a disk that is full or read-only is no reason not to begin."""
    try:
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:
        if "initialize logging" not in str(error):
            raise
        why = " ".join(str(error).split()).partition(", at ")[0]
        get_default_context(shutting_down=True)  # what failed to begin cannot begin again: the next one is another
        given = [*(sys.argv if arguments is None else arguments), "--ros-args", "--disable-external-lib-logs"]
        rclpy.init(args=given, signal_handler_options=SignalHandlerOptions.NO)
        print(f"warning: no log file is kept ({why}); set ROS_LOG_DIR to a folder that can be written", file=sys.stderr)


def _start(node: Any, ending: Ending) -> int:
    if node.options.autostart and not ending.asked:
        done = node.trigger_configure()
        if done.name != "SUCCESS":
            return BAD_INPUT
        if not ending.asked and node.trigger_activate().name != "SUCCESS":
            return BAD_INPUT
    return 0


def _spin(node: Any, ending: Ending) -> int:
    loop, defects = Loop(node), 0
    try:
        while not ending.asked and rclpy.ok() and defects < MOST_DEFECTS:
            try:
                loop.once()
                defects = 0
            except (KeyboardInterrupt, ExternalShutdownException):
                break
            except Exception:
                defects += 1
                node.report_defect("executor")
    finally:
        loop.end()
    return 0 if defects < MOST_DEFECTS else 1


def _refuse(error: Exception) -> int:
    said = str(error).partition(", at /")[0]  # the line of rcl's source
    if type(error).__name__ == "UnknownROSArgsError":  # of rclpy's compiled part; it says a list
        said = f"{said.strip('[]')}: no argument of ROS; --help says which there are"
    for each in getattr(error, "problems", (said,)):
        print(f"error: {' '.join(each.split())}", file=sys.stderr)
    rclpy.try_shutdown()
    return BAD_INPUT
