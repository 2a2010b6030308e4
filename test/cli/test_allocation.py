"""Memory that was freed is kept for what is taken next."""

import subprocess
import sys

import pytest

FAULTS = """
import resource, sys
import numpy as np
from winch_friction.cli.allocation import keep_freed_memory

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
