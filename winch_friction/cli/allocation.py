"""How a verb's process keeps house, for one that makes and lets go objects and arrays all the time.

A search takes some 100 000 arrays of 0.1 to 2 MB. glibc gives what is free at the end of its heap back to the system at
once, and every page that is taken again costs a fault: 240 000 of them in a `gap` of twelve runs, a tenth of its
processor time. The environment's `MALLOC_..._` variables would do the same, but a process cannot set its own.

Python looks for garbage in cycles after every 700 new objects, and ever again goes through all that SymPy and numba
hold, which is no garbage: another tenth. What a search lets go has no cycles and is freed without that.
"""

import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager

# glibc's malloc.h; bytes
M_TRIM_THRESHOLD, KEPT_FREE = -1, 128 << 20  # a quarter of what a search of an hour holds at its peak
M_TOP_PAD, TAKEN_AHEAD = -2, 16 << 20
M_MMAP_THRESHOLD, ON_THEIR_OWN = -3, 4 << 20  # larger arrays still go back at once: they make the peak
RARELY = (20_000, 10, 20)  # objects more, looks at the youngest, looks at the middle: some twenty looks in a search


@contextmanager
def search_at_hand() -> Iterator[None]:
    """Keep what is freed, and look for garbage rarely until the end."""
    keep_freed_memory()
    before = gc.get_threshold()
    gc.set_threshold(*RARELY)
    try:
        yield
    finally:
        gc.set_threshold(*before)


def keep_freed_memory() -> bool:
    """Let this process keep what it has freed for what it takes next; False where the C library is not glibc."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return False
    pairs = ((M_MMAP_THRESHOLD, ON_THEIR_OWN), (M_TRIM_THRESHOLD, KEPT_FREE), (M_TOP_PAD, TAKEN_AHEAD))
    return {mallopt(option, size) for option, size in pairs} == {1}
