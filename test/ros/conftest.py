"""Every test here starts real nodes over DDS; the bench itself is in `dds_bench`."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from dds_bench import Bench


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    here = Path(__file__).parent
    own = {path for path in {item.path for item in items} if here in path.parents}
    for item in items:
        if item.path in own:
            item.add_marker(pytest.mark.ros)


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    """A domain of the test's own."""
    made = Bench(tmp_path)
    yield made
    made.close()
