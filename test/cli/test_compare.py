"""Comparing two models where the crane never is."""

import pytest

from winch_friction.cli.main import run


@pytest.mark.parametrize(("loads", "warned"), [("15,55,100", False), ("55,5000", True)])
def test_a_load_beyond_the_crane_is_said_with_what_its_file_gives(capsys, loads, warned):
    assert run(["compare", "a6vm215_crane1", "a6vm215_crane2", "--loads", loads]) == 0
    said = capsys.readouterr().err
    assert ("--loads 5000: beyond what crane 'crane_150t' holds" in said) == warned
    assert ("0 to 540 t" in said) == warned


def test_a_load_that_is_no_mass_is_refused(capsys):
    assert run(["compare", "a6vm215_crane1", "a6vm215_crane2", "--loads=-3"]) == 2
    assert "hanging mass" in capsys.readouterr().err
