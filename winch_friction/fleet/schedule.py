"""Work on Dask with back-pressure, in the order in which it ends."""

import contextlib
import signal
from collections.abc import Callable, Collection, Iterator, Sequence
from itertools import islice
from multiprocessing import active_children, resource_tracker
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

T = TypeVar("T")
AHEAD = 4  # pieces of work per thread handed to the scheduler at a time: busy workers, small queues
RETRIES = 2  # for a worker that was killed; a piece of work that fails gives an outcome, not an error
PATIENCE = 30.0  # s for a scheduler to answer


def on_this_process(work: Callable[..., T], pieces: Sequence[tuple[Any, ...]]) -> Iterator[T]:
    """One after the other, here."""
    return (work(*piece) for piece in pieces)


def on_dask(
    work: Callable[..., T], pieces: Sequence[tuple[Any, ...]], workers: int | None, address: str
) -> Iterator[T]:
    """On the scheduler at `address`, or on a cluster of processes on this machine; results as they come."""
    from dask.distributed import Client, LocalCluster, as_completed

    with contextlib.ExitStack() as stack:
        local = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 40}
        others = active_children()
        with _interrupts_held():
            cluster = address or stack.enter_context(LocalCluster(**local))
            stack.push(_ended_at_once(others))
        client = stack.enter_context(Client(cluster, timeout=PATIENCE))
        waiting = iter(pieces)

        def submitted(count: int) -> list[Any]:
            return [client.submit(work, *piece, pure=False, retries=RETRIES) for piece in islice(waiting, count)]

        ended = as_completed(submitted(AHEAD * max(1, sum(client.nthreads().values()))))
        for future in ended:
            yield future.result()
            future.release()
            for more in submitted(1):
                ended.add(more)


def _ended_at_once(others: Collection[BaseProcess]) -> Callable[..., None]:
    """On the way out by an interrupt or an error, kill this process's workers: a piece of work in their middle was
    waited for, up to 4.7 s, and a worker that missed its scheduler meanwhile left a traceback."""

    def end(kind: type[BaseException] | None, *_: object) -> None:
        for each in active_children() if kind else ():
            if each not in others:
                each.kill()

    return end


@contextlib.contextmanager
def _interrupts_held() -> Iterator[None]:
    """Ctrl-C goes to every process of a terminal: what begins meanwhile never hears it, and is ended by this process,
    which hears it afterwards. Workers that heard it left a traceback each."""
    resource_tracker.ensure_running()  # where it begins with the first process it lets SIGINT through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
