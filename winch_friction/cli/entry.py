"""Where the command begins: before anything is loaded, so that Ctrl-C has its one line from the first moment on."""

import os
import signal
from collections.abc import Callable
from types import FrameType

SAID, STATUS = b"winch-friction: interrupted\n", 130

Handler = Callable[[int, FrameType | None], object]


def main() -> None:
    """Entry point of the console script.

    While libraries are loaded nothing is begun: an interrupt ends the process there and then, for an exception out of
    the middle of an import is a traceback, or another error. Where the work is done, one ends it without a word.
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:  # whoever called has it ignored
        return _program(None)
    signal.signal(signal.SIGINT, _leave)
    try:
        _program(signal.default_int_handler)
    except KeyboardInterrupt:
        _leave()
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return None


def _program(handler: Handler | None) -> None:
    """Load the program, let interrupts be its own matter, and run it."""
    from winch_friction.cli.main import main as program

    if handler is not None:
        signal.signal(signal.SIGINT, handler)
    program()


def _leave(number: int = signal.SIGINT, frame: FrameType | None = None) -> None:
    """End here: nothing has been begun that would have to be put in order."""
    try:
        os.write(2, SAID)
    finally:  # nobody may be there to read it
        os._exit(STATUS)


if __name__ == "__main__":
    main()
