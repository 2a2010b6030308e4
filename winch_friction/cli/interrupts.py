"""Ctrl-C while the work is done, also where a library loses it.

An interrupt is an exception in whatever runs at that moment. In a destructor Python drops it and the work goes on (a
compiler's, at a first simulation: it ended 12 s later, with status 0); in the middle of compiling another error is made
of it, which is no defect of ours.
"""

import signal
import sys
from types import FrameType
from typing import Any

AGAIN = 0.02  # s after which one that was dropped is raised once more: the destructor that it fell into is over


class _State:
    """Of this process: whether Ctrl-C was ever pressed while the work was done."""

    asked = False


def asked() -> bool:
    """Whether somebody interrupted the work: what it raises from then on is the interrupt's, whatever it is called."""
    return _State.asked


def listen() -> None:
    """From now on Ctrl-C is a `KeyboardInterrupt` that is not lost."""
    signal.signal(signal.SIGINT, _pressed)
    signal.signal(signal.SIGALRM, _pressed)
    sys.unraisablehook = _dropped


def end() -> None:
    """All is done: an interrupt ends the process without a word, and one that is still due says nothing."""
    signal.signal(signal.SIGALRM, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _pressed(number: int, frame: FrameType | None) -> None:
    _State.asked = True
    signal.default_int_handler(number, frame)


def _dropped(what: Any) -> None:
    if what.exc_type is KeyboardInterrupt:
        signal.setitimer(signal.ITIMER_REAL, AGAIN)
    else:
        sys.__unraisablehook__(what)
