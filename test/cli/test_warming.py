"""What an installation compiles is there for the first start."""

import subprocess
import sys

import pytest

from winch_friction.cli import warming

# what numba compiles, and not reads, in a process of its own
COMPILED = """
from numba.core import event
from winch_friction.cli import warming

with event.install_recorder("numba:compile") as seen:
    assert [name for name, _ in warming.warmed()] == ["estimator's filter", "simulated plant", "laws of a search"]
print(len(seen.buffer))
"""


def compiled():
    done = subprocess.run([sys.executable, "-c", COMPILED], capture_output=True, text=True, check=True, timeout=120)
    return int(done.stdout)


def test_once_warmed_nothing_is_compiled_again():
    said = []
    assert warming.main(said.append) == 0
    assert len(said) == 3
    assert compiled() == 0


@pytest.mark.parametrize("error", [ImportError("no numba"), RuntimeError("no place"), OSError("full")])
def test_where_it_cannot_be_kept_the_installation_goes_on(monkeypatch, error):
    def refuse():
        raise error

    monkeypatch.setattr(warming, "_filter", refuse)
    said = []
    assert warming.main(said.append) == 0
    assert str(error) in said[0]
