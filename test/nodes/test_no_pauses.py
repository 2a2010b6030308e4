"""A file that is read beside the control lets the interpreter walk through no heap meanwhile."""

import gc
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes.beside import Beside
from winch_friction.online.intake import ModelIntake, without_collections
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.records.model_file import load_model, model_to_text


def test_nothing_is_collected_while_a_file_is_read_and_again_afterwards() -> None:
    assert gc.isenabled()
    assert Beside[bool]().get(gc.isenabled, lambda: None) is False
    assert gc.isenabled()


def test_a_reader_that_was_given_up_collects_nothing_until_it_ends() -> None:
    hangs, seen, each = threading.Event(), [], Beside[None](longest=0.05)

    def work() -> None:
        hangs.wait()
        seen.append(gc.isenabled())

    with pytest.raises(InputError, match="not read within"):
        each.get(work, lambda: None)
    hangs.set()
    each._worker.join(1.0)
    assert seen == [False]
    assert gc.isenabled()


def test_the_last_of_two_readers_and_one_that_fails_let_it_go_on() -> None:
    first = without_collections()
    with first:
        with ThreadPoolExecutor(1) as pool, pytest.raises(ZeroDivisionError):
            pool.submit(fails).result()
        assert not gc.isenabled()
    assert gc.isenabled()


def fails() -> None:
    with without_collections():
        raise ZeroDivisionError


@pytest.mark.parametrize("beside", [True, False])
def test_a_learned_model_is_parsed_beside_the_control_without_collections(beside: bool) -> None:
    """A simulation that parses at once has no control that would wait."""
    seen: list[bool] = []

    def ready(_: FrictionModel) -> None:
        seen.append(gc.isenabled())

    intake = ModelIntake(ready, beside)
    intake.offer(model_to_text(load_model("a6vm215_crane2")))
    intake.take()
    if intake._worker is not None:
        intake._worker.join(10.0)
    assert seen == [not beside]
    assert gc.isenabled()
