"""Every test here starts real nodes over DDS; the bench itself is in `dds_bench`."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from dds_bench import Bench


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.ros)


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    """A domain of the test's own."""
    made = Bench(tmp_path)
    yield made
    made.close()
