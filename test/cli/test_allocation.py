"""Memory that was freed is kept for what is taken next, and garbage is looked for less often."""

import gc
import subprocess
import sys

import pytest

from winch_friction.cli import gap
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


BETWEEN = """
import os, sys
import numpy as np
from winch_friction.cli.gap import give_freed_memory_back, keep_freed_memory

keep_freed_memory()
kept = []
for _ in range(400):  # what stays lies between what goes
    gone = np.ones(1 << 16)
    kept.append(np.ones(1 << 13))
    kept.append(gone)
kept = kept[::2]
del gone
held = lambda: int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
before = held()
print(give_freed_memory_back(), before - held())
"""


def test_what_a_step_has_freed_goes_back_before_the_next():
    done = subprocess.run([sys.executable, "-c", BETWEEN], capture_output=True, text=True, check=True, timeout=60)
    given, less = done.stdout.split()
    if given == "False":
        pytest.skip("the C library is not glibc")
    assert int(less) > 100e6


def test_every_step_gives_back(monkeypatch):
    given = []
    monkeypatch.setattr(gap, "give_freed_memory_back", lambda: given.append(1))
    with gap.stepping("work", 2) as tell:
        tell("first")
        tell("second")
    assert len(given) == 2


def looks(work):
    """How often a piece of work makes Python look for garbage."""
    before = sum(each["collections"] for each in gc.get_stats())
    work()
    return sum(each["collections"] for each in gc.get_stats()) - before


@pytest.fixture
def thresholds():
    """Those that Python has of itself; the tests' own are as rare as a search's."""
    before, of_python = gc.get_threshold(), (700, 10, 10)
    gc.set_threshold(*of_python)
    yield of_python
    gc.set_threshold(*before)


def test_garbage_is_looked_for_rarely_and_then_as_before(thresholds):
    def work():
        return [[k] for k in range(100_000)]

    usual = looks(work)
    with search_at_hand():
        assert 0 < looks(work) < usual / 10
    assert gc.get_threshold() == thresholds
