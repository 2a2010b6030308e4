"""Where the command begins: before anything is loaded, so that Ctrl-C has its one line from the first moment on."""

import os
import signal
from types import FrameType

from winch_friction.cli.interrupts import end, listen

SAID, STATUS = b"winch-friction: interrupted\n", 130


def main() -> None:
    """Entry point of the console script.

    While libraries are loaded nothing is begun: an interrupt ends the process there and then, for an exception out of
    the middle of an import is a traceback, or another error. Where the work is done, one ends it without a word.
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:  # whoever called has it ignored
        return _program()
    signal.signal(signal.SIGINT, _leave)
    try:
        _program(heard=True)
    except KeyboardInterrupt:
        _leave()
    finally:
        end()
    return None


def _program(heard: bool = False) -> None:
    """Load the program, let interrupts be its own matter, and run it."""
    from winch_friction.cli.main import main as program

    if heard:
        listen()
    program()


def _leave(number: int = signal.SIGINT, frame: FrameType | None = None) -> None:
    """End here: nothing has been begun that would have to be put in order."""
    try:
        os.write(2, SAID)
    finally:  # nobody may be there to read it
        os._exit(STATUS)


if __name__ == "__main__":
    main()
