"""Crane and seed of the estimator's tests."""

import pytest

from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model


@pytest.fixture(scope="session")
def crane():
    return load_crane("crane_150t")


@pytest.fixture(scope="session")
def seed():
    return load_model("a6vm215_crane2")
