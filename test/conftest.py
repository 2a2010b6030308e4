"""What all tests share: the shipped crane and models, and the real data beside the project where it is there."""

import gc
from pathlib import Path

import pytest
from longest_first import SECONDS

from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

gc.disable()  # while tests are collected: whatever that makes stands to the end, an eighth of its time
SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest.hookimpl(trylast=True)  # the tests of `ros/` get their mark in a file of their own
def pytest_collection_modifyitems(items):
    """Long files first; within a file, and among the others, as they stand. Live nodes get two more tries."""
    here = Path(__file__).parent
    seconds = {path: SECONDS.get(path.relative_to(here).as_posix(), 0) for path in {item.path for item in items}}
    items.sort(key=lambda item: -seconds[item.path])
    for item in items:
        if item.get_closest_marker("ros"):
            # processes judged by the clock: a machine that stood still for a moment is no defect, and a defect fails
            # three times. pytest says at the end which needed it
            item.add_marker(pytest.mark.flaky(reruns=2))


def pytest_collection_finish():
    """Ten thousand tests and all that they import stand to the end: the collector need not go through them again."""
    gc.collect()
    gc.freeze()
    gc.enable()
    gc.set_threshold(50_000, 20, 20)  # after 700 objects, as Python has it, it is a fortieth of the tests' time


@pytest.fixture(scope="session")
def crane_150t():
    return load_crane("crane_150t")


@pytest.fixture(scope="session")
def crane2_model():
    return load_model("a6vm215_crane2")


@pytest.fixture(scope="session")
def shared_data():
    """Directory of the real data; the test is skipped where it is not there."""
    if not SHARED.is_dir():
        pytest.skip(f"the real data are not beside the project ({SHARED})")
    return SHARED
