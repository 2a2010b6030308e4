"""How the C library gives memory back to the system, for a verb that makes and lets go arrays all the time.

A search takes some 100 000 arrays of 0.1 to 2 MB. glibc gives what is free at the end of its heap back to the system at
once, and every page that is taken again costs a fault: 240 000 of them in a `gap` of twelve runs, a tenth of its
processor time. The environment's `MALLOC_..._` variables would do the same, but a process cannot set its own.
"""

import ctypes

# glibc's malloc.h; bytes
M_TRIM_THRESHOLD, KEPT_FREE = -1, 128 << 20  # a quarter of what a search of an hour holds at its peak
M_TOP_PAD, TAKEN_AHEAD = -2, 16 << 20
M_MMAP_THRESHOLD, ON_THEIR_OWN = -3, 4 << 20  # larger arrays still go back at once: they make the peak


def keep_freed_memory() -> bool:
    """Let this process keep what it has freed for what it takes next; False where the C library is not glibc."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return False
    pairs = ((M_MMAP_THRESHOLD, ON_THEIR_OWN), (M_TRIM_THRESHOLD, KEPT_FREE), (M_TOP_PAD, TAKEN_AHEAD))
    return {mallopt(option, size) for option, size in pairs} == {1}
