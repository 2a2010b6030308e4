"""Memory that was freed is kept for what is taken next, and garbage is looked for less often."""

import gc
import subprocess
import sys

import pytest

from winch_friction.cli.gap import search_at_hand

FAULTS = """
import resource, sys
import numpy as np
from winch_friction.cli.gap import keep_freed_memory

held = keep_freed_memory() if sys.argv[1] == "kept" else None
for _ in range(300):
    arrays = [np.ones(1 << 16) for _ in range(8)]  # half a megabyte each, let go together
    del arrays
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt, held)
"""


def faults(how):
    done = subprocess.run([sys.executable, "-c", FAULTS, how], capture_output=True, text=True, check=True, timeout=60)
    count, held = done.stdout.split()
    return int(count), held


def test_arrays_that_come_and_go_cost_no_new_pages():
    (kept, held), (usual, _) = faults("kept"), faults("usual")
    if held == "False":
        pytest.skip("the C library is not glibc")
    assert usual > 3 * kept


def looks(work):
    """How often a piece of work makes Python look for garbage."""
    before = sum(each["collections"] for each in gc.get_stats())
    work()
    return sum(each["collections"] for each in gc.get_stats()) - before


def test_garbage_is_looked_for_rarely_and_then_as_before():
    thresholds = gc.get_threshold()

    def work():
        return [[k] for k in range(100_000)]

    usual = looks(work)
    with search_at_hand():
        assert 0 < looks(work) < usual / 10
    assert gc.get_threshold() == thresholds
