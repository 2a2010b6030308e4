"""What was compiled once for a model's equations is found again by the next process."""

import os
import subprocess
import sys

HITS = """
from winch_friction.records.model_file import load_model
from winch_friction.simulation.plant.friction_kernel import friction_kernel
kernel = friction_kernel(load_model("a6vm215_crane2"))
print(kernel.keep_alive[1].cache_hits)
"""


def hits(environment):
    done = subprocess.run([sys.executable, "-c", HITS], capture_output=True, text=True, check=True, env=environment)
    return int(done.stdout)


def test_a_second_process_compiles_nothing(tmp_path):
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    assert hits(environment) == 0
    assert hits(environment) == 1
    assert list((tmp_path / "winch_friction" / "numba").glob("equations_*.py"))
