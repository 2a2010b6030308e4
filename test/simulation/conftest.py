import pytest

from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation import load_scenario


@pytest.fixture(scope="session")
def crane():
    return load_crane("crane_150t")


@pytest.fixture(scope="session")
def model():
    return load_model("a6vm215_crane2")


@pytest.fixture(scope="session")
def ahc():
    return load_scenario("ahc_55t_215").override({"duration": 60.0})


@pytest.fixture(scope="session")
def cycle():
    return load_scenario("test_02").override({"duration": 60.0})
