"""Every benchmark runs: none may rot unseen."""

import json
import math

import pytest

import bench
from winch_friction.cli import main


@pytest.mark.slow
@pytest.mark.parametrize("name", bench.NAMES)
def test_every_benchmark_gives_numbers(name, capsys):
    assert main.run(["bench", name, "--smoke", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert rows
    for row in rows.values():
        assert math.isfinite(row["value"])
        assert row["value"] > 0.0


def test_an_unknown_benchmark_is_refused_with_those_there_are(capsys):
    assert main.run(["bench", "nothing"]) == 2
    assert "estimator" in capsys.readouterr().err


@pytest.mark.slow
def test_a_fit_takes_a_hundredth_of_the_complex_methods_evaluations(capsys):
    assert main.run(["bench", "fits", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert rows["fit of MJ4: model evaluations"]["ratio"] > 100
