"""Files that are read while the control goes on: a torque may not wait for a disk."""

import threading
import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from winch_friction.online.intake import without_collections
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.term import load_file

LOOK = 0.002  # s between two looks at the inputs meanwhile: a tenth of a period at 50 Hz
LONGEST = 4.0  # s; whoever ends a process waits for five, and the last ramp has to be published by then

T = TypeVar("T")


class Beside(Generic[T]):
    """One piece of work at a time in a thread of its own, while the thread that asks for it goes on with something
    else every `LOOK` s.

    rclpy answers a service in the thread that serves the inputs: a model of megabytes, a file of terms that imports for
    seconds or a disk that does not answer would hold the torque where it is.
    """

    def __init__(self, longest: float = LONGEST) -> None:
        self.longest = longest  # s
        self._worker: threading.Thread | None = None

    def get(
        self, work: Callable[[], T], meanwhile: Callable[[], None], told_to_end: Callable[[], bool] = lambda: False
    ) -> T:
        """What `work` returns; raises what it raises. `InputError` where it takes longer than `longest`, where the
        process was `told_to_end` meanwhile, or where the work before has not ended yet: it is left to itself, and what
        it has read by then is read quickly again."""
        if self._worker is not None and self._worker.is_alive():
            raise InputError("what was asked for before is still being read; ask again later")
        done: list[T] = []
        raised: list[BaseException] = []

        def carry_out() -> None:
            try:
                with without_collections():
                    done.append(work())
            except BaseException as error:  # handed to whoever asked
                raised.append(error)

        self._worker = threading.Thread(target=carry_out, name="beside", daemon=True)
        self._worker.start()
        until = time.monotonic() + self.longest
        while self._worker.is_alive() and time.monotonic() < until:
            if told_to_end():
                raise InputError("the node was told to end: nothing read, nothing changed")
            meanwhile()
            self._worker.join(LOOK)
        if raised:
            raise raised[0]
        if not done:
            raise InputError(f"not read within {self.longest:g} s, nothing changed; ask again once it can be read")
        return done[0]


def read_terms(path: str) -> list[Any]:
    """The terms that a user's file declares; whatever it raises is an `InputError`. None for no file."""
    if not path:
        return []
    try:
        return list(load_file(path))
    except (SystemExit, KeyboardInterrupt, GeneratorExit) as error:
        raise InputError(f"{path}: it wants to end the program (sys.exit)") from error
    except InputError:
        raise
    except BaseException as error:  # whatever its author derived from the root of all exceptions
        raise InputError(f"{path}: {type(error).__name__}: {error}") from error
