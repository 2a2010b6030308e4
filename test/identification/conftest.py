import sys
from pathlib import Path

import pytest

from winch_friction.identification.prior import load_unit_spread
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[2]))


@pytest.fixture(scope="session")
def crane():
    return load_crane("crane_150t")


@pytest.fixture(scope="session")
def truth():
    """Crane 2 of paper 2."""
    return load_model("a6vm215_crane2")


@pytest.fixture(scope="session")
def spread():
    return load_unit_spread()
