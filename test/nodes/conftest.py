"""What several tests of nodes need that send nothing to another process."""

from collections.abc import Iterator
from typing import Any

import pytest

from winch_friction.records.domain import unused_domain


@pytest.fixture
def context() -> Iterator[Any]:
    """A context of the test's own, in a domain that nobody uses."""
    import rclpy
    from rclpy.context import Context

    made = Context()
    rclpy.init(context=made, domain_id=unused_domain())
    yield made
    rclpy.shutdown(context=made)
