"""What `gap` leaves in its folder: the files of this result and nothing of an earlier one."""

from types import SimpleNamespace

import pytest

import winch_friction as wf
from winch_friction.cli.gap_output import write_result
from winch_friction.records.strict_yaml import shipped

SCENARIO = "experiment_loads"
TEXT = shipped("scenarios", SCENARIO).read_text(encoding="utf-8")
PLANNED = {"next_experiment": {"scenario": f"{SCENARIO}.yaml"}}
NOTHING_PLANNED = {"next_experiment": None}


def write(out, content):
    result = SimpleNamespace(
        model=wf.load_model("a6vm215_crane2"), proposals=(), next_scenario=TEXT if content["next_experiment"] else ""
    )
    write_result(out, result, content, [])
    return {each.name for each in out.iterdir()}


@pytest.mark.parametrize("own", [False, True])
def test_the_scenario_of_an_earlier_call_goes_unless_somebody_has_made_it_his_own(tmp_path, own):
    assert write(tmp_path, PLANNED) == {"gap.json", "model.yaml", f"{SCENARIO}.yaml"}
    if own:
        (tmp_path / f"{SCENARIO}.yaml").write_text(TEXT.replace("duration: ", "duration:  "), encoding="utf-8")
    assert (f"{SCENARIO}.yaml" in write(tmp_path, NOTHING_PLANNED)) is own


@pytest.mark.parametrize(
    "before", [None, "", "[]", '{"next_experiment": null}', '{"next_experiment": {"scenario": "x"}}']
)
def test_a_result_that_planned_nothing_takes_nothing_away(tmp_path, before):
    if before is not None:
        (tmp_path / "gap.json").write_text(before)
    (tmp_path / f"{SCENARIO}.yaml").write_text(TEXT, encoding="utf-8")
    assert write(tmp_path, NOTHING_PLANNED) == {"gap.json", "model.yaml", f"{SCENARIO}.yaml"}


def test_the_same_scenario_again_stays(tmp_path):
    write(tmp_path, PLANNED)
    assert f"{SCENARIO}.yaml" in write(tmp_path, PLANNED)
