"""Every benchmark runs: none may rot unseen."""

import json
import math
import os

import pytest

import bench
from winch_friction.cli import main


@pytest.fixture(autouse=True)
def own_environment():
    """What a benchmark sets for its nodes (a domain, threads) ends with it: the next test's doctor found it wrong."""
    before = dict(os.environ)
    yield
    os.environ.clear()
    os.environ.update(before)


WITH_NODES = {"live", "dds"}  # beside the other tests of nodes: what only computes would keep them waiting


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=pytest.mark.ros) if each in WITH_NODES else each for each in bench.NAMES]
)
def test_every_benchmark_gives_numbers(name, capsys):
    assert main.run(["bench", name, "--smoke", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert rows
    for row in rows.values():
        assert math.isfinite(row["value"])
        assert row["value"] > 0.0
    if name == "fits":  # a hundredth of the complex method's evaluations, which no machine changes
        assert rows["fit of MJ4: model evaluations"]["ratio"] > 100


def test_an_unknown_benchmark_is_refused_with_those_there_are(capsys):
    assert main.run(["bench", "nothing"]) == 2
    assert "estimator" in capsys.readouterr().err
