"""Models that arrive as text: parsed and made ready beside the control thread, bounded in size and rate; the newest
one is kept."""

import gc
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.records.model_file import model_from_text

LARGEST = 96 * 1024  # characters; a model of 30 parameters with its correlations has 20 thousand
MOST_BRACKETS, DEEPEST = 2000, 100  # lists and mappings that open (a correlation has one a parameter), columns
PERIOD = 1.0  # s between two models that are looked at


# -- a reader beside the control
_readers, _counting = 0, threading.Lock()


@contextmanager
def without_collections() -> Iterator[None]:
    """No search for cycles among the process's objects until the last reader has ended.

    It holds every thread for 0.06 s where a node has just been configured, and for as long again as a large file has
    objects: the torque stood for up to 0.2 s, again and again, while one was read. What it leaves in cycles goes
    afterwards.
    """
    global _readers
    with _counting:
        _readers += 1
        gc.disable()
    try:
        yield
    finally:
        with _counting:
            _readers -= 1
            if _readers == 0:
                gc.enable()


# -- models as text
def parse(text: str, where: str, ready: Callable[[FrictionModel], None] = lambda _: None) -> FrictionModel:
    """A model from text of unknown origin, made `ready`; raises `InputError` for whatever is wrong with it."""
    if len(text) > LARGEST:
        raise InputError(f"{where}: {len(text)} characters are no model; the largest has {LARGEST}")
    if text.count("[") + text.count("{") > MOST_BRACKETS or "\n" + DEEPEST * " " in text:
        raise InputError(f"{where}: nested too deeply for a model")
    try:
        ready(model := model_from_text(text, where))
        return model
    except InputError:
        raise
    except Exception as error:  # a parser meets what nobody thought of: RecursionError, OverflowError
        raise InputError(f"{where}: not a model ({type(error).__name__})") from error


@dataclass
class ModelIntake:
    """Takes texts in, hands models that were made `ready` and refusals out.

    `beside`: a thread of its own parses, one text every `PERIOD` s, the newest that came; else `offer` parses at once,
    as a simulation that runs faster than the clock needs it.
    """

    ready: Callable[[FrictionModel], None] = lambda _: None
    beside: bool = True
    clock: Callable[[], float] = lambda: 0.0
    waiting: bool = field(default=False, init=False)  # whether there may be anything to `take`
    _text: str | None = field(default=None, init=False)
    _done: deque[FrictionModel | InputError] = field(default_factory=deque, init=False)  # never replaced: two threads
    _worker: threading.Thread | None = field(default=None, init=False)
    _looked: float = field(default=float("-inf"), init=False)

    def offer(self, text: str) -> None:
        """A text has come; it replaces one that waits."""
        self._text = text
        self.waiting = True
        if not self.beside:
            self._parse()

    def take(self) -> list[FrictionModel | InputError]:
        """What has been parsed since; starts on what waits. To be called often: it never waits."""
        self.waiting = False  # and then told anew: a text may come, and one be done, in the middle of it
        busy = self._worker is not None and self._worker.is_alive()
        if self._text is not None and not busy and self.clock() - self._looked >= PERIOD:
            self._looked = self.clock()
            self._worker = threading.Thread(target=self._parse_beside, name="model", daemon=True)
            self._worker.start()
        done = [self._done.popleft() for _ in range(len(self._done))]
        parsing = self._worker is not None and self._worker.is_alive()
        if parsing or self._done or self._text is not None:
            self.waiting = True
        return done

    def _parse_beside(self) -> None:
        with without_collections():
            self._parse()

    def _parse(self) -> None:
        text, self._text = self._text, None
        try:
            self._done.append(parse(text or "", "friction_model", self.ready))
        except InputError as error:
            self._done.append(error)
