"""What an estimator says where it cannot keep what it learns."""

import errno
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import estimator
from winch_friction.nodes.estimator import EstimatorNode
from winch_friction.physics.errors import InputError
from winch_friction.records.checkpoint import read_checkpoint


class Node:
    """As much of an estimator's node as its `save` looks at."""

    def __init__(self) -> None:
        self.own = SimpleNamespace(checkpoint="/kept/here.json")
        self.service = SimpleNamespace(snapshot=dict)
        self._unkept, self._kept, self.logged = "", None, []
        self._keep = lambda: EstimatorNode._keep(self)

    def get_logger(self) -> SimpleNamespace:
        return SimpleNamespace(error=self.logged.append)


@pytest.mark.parametrize(
    "error", [OSError(errno.ENOSPC, "No space left on device"), InputError("No space left on device")]
)
def test_a_full_disk_is_said_once_with_the_file_and_again_after_it_was_not(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    """Every minute one more line, which named neither the file nor what is at stake."""
    node, full = Node(), [True]

    def write(*_: object) -> None:
        if full[0]:
            raise error

    monkeypatch.setattr(estimator, "write_checkpoint", write)
    for _ in range(5):
        EstimatorNode.save(node)
    (said,) = node.logged
    assert said == node._unkept
    assert "/kept/here.json: No space left on device" in said
    assert "what is learned is lost when the node ends" in said
    full[0] = False
    EstimatorNode.save(node)
    assert node._unkept == ""
    full[0] = True
    EstimatorNode.save(node)
    assert len(node.logged) == 2


def test_what_somebody_else_keeps_in_the_same_file_stays(tmp_path: Path) -> None:
    """Two winches with one parameter file: each wrote over the other's, and began with it after a restart."""
    north, south = Node(), Node()
    for each, number in ((north, 1), (south, 2)):
        each.own.checkpoint = str(tmp_path / "c.json")
        each.service.snapshot = lambda number=number: {"number": number}
    EstimatorNode.save(north)
    EstimatorNode.save(north)
    EstimatorNode.save(south)
    assert read_checkpoint(tmp_path / "c.json") == {"number": 1}
    assert not north.logged
    assert "c.json: not what this estimator wrote there" in south.logged[0]
    (tmp_path / "c.json").unlink()  # whoever clears it up lets it go on
    EstimatorNode.save(south)
    assert south._unkept == ""
