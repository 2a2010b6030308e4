"""A console that nobody reads holds up no torque.

A line of the log is written by the thread that serves the inputs, also by ROS's own libraries. Where nobody takes it
away (a terminal that was stopped by Ctrl-S, a remote login that hangs, a launch that was stopped) the write waits, and
the last torque stood for as long: 375 N m, `valid`.
"""

import os
import sys
import threading
import time
from contextlib import suppress

STDOUT, STDERR = 1, 2
LAST_LINES = 0.5  # s that the end waits for the console
AGAIN = 0.05  # s; for a console that somebody else has set not to wait


class Console:
    """Leads what this process prints through a pipe that never waits; a thread of its own hands it to the console.

    What does not fit into the pipe (64 kB) while nobody reads is lost. Printing goes as before after `end`.
    """

    def __init__(self, descriptors: tuple[int, ...] = (STDOUT, STDERR)) -> None:
        self._led: list[tuple[int, int, threading.Thread]] = []
        for each in descriptors:
            with suppress(OSError):  # a daemon may have none
                self._lead(each)

    def _lead(self, descriptor: int) -> None:
        console = os.dup(descriptor)
        if descriptor == STDERR and os.isatty(console):  # rcutils sees a pipe
            os.environ.setdefault("RCUTILS_COLORIZED_OUTPUT", "1")
        source, sink = os.pipe()
        os.set_blocking(sink, False)
        os.dup2(sink, descriptor)
        os.close(sink)
        pump = threading.Thread(target=_pump, args=(source, console), name="console", daemon=True)
        pump.start()
        self._led.append((descriptor, console, pump))

    def end(self) -> None:
        """Hand over the last lines, as far as the console takes them, and print as before."""
        with suppress(OSError, ValueError):
            sys.stdout.flush()
            sys.stderr.flush()
        for descriptor, console, _ in self._led:
            os.dup2(console, descriptor)  # the pipe's last writer goes, and the pump with it
        for _, console, pump in self._led:
            pump.join(LAST_LINES)
            if not pump.is_alive():
                os.close(console)
        self._led.clear()


def _pump(source: int, console: int) -> None:
    """Until nobody can write any more, or the console is gone."""
    with suppress(OSError):
        while text := os.read(source, 65536):
            while text:
                try:
                    text = text[os.write(console, text) :]
                except BlockingIOError:
                    time.sleep(AGAIN)
    os.close(source)
