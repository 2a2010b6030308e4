"""Scenario files: the shipped ones run, bad ones are refused in one line."""

import numpy as np
import pytest

from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import config_directory
from winch_friction.simulation import load_scenario, simulate
from winch_friction.simulation.campaigns import PAPER_TESTS, gap_campaign, paper_tests
from winch_friction.simulation.plant_file import load_plant
from winch_friction.simulation.scenario import scenario_from_content

SHIPPED = sorted(path.stem for path in (config_directory() / "scenarios").glob("*.yaml"))
GOOD = {"name": "x", "duration": 10, "mode": "ahc", "load": 55000, "displacement": 3.4e-5}


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_scenarios_run(name, crane, model):
    scenario = load_scenario(name)
    assert scenario.name == name
    result = simulate(scenario.override({"duration": 8.0, "sensors.dropout_rate": 0.0}), crane, model)
    assert all(np.isfinite(column).all() for column in result.run.columns.values())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"wave": 1}, r"unknown key 'wave'; remove it"),
        ({"sea": {"kind": "regular", "amplitude": 1, "period": 9, "hs": 2}}, r"unknown key 'sea.regular.hs'"),
        ({"sea": {"kind": "storm"}}, r"sea: .*'storm'"),
        ({"load": {"value": 55, "unit": "bar"}}, r"load: in kg: unit 'bar' cannot be used"),
        ({"load": "heavy"}, r"load: in kg must be a finite number"),
        ({"load": -1}, r"load: must be greater than 0, found -1"),
        ({"mode": "manual"}, r"mode: unexpected value; permitted: 'normal', 'ahc', found 'manual'"),
        ({"duration": float("nan")}, r"duration: in s must be a finite number"),
        ({"sensors": {"rate": 400}}, r"sensors.rate 400 Hz is above the control rate"),
        ({"sensors": {"rate": 30}}, r"whole number of control periods"),
        ({"boost_schedule": [[5, 2e6], [1, 3e6]]}, r"boost_schedule: times must not go back: 1 s stands behind 5 s"),
        ({"profile": {"points": [[0, 0], [9, 50], [4, 0]]}}, r"points: times must not go back"),
        ({"duration": 0.01}, r"duration 0.01 s holds no two samples at 50 Hz"),
        ({"profile": {"points": [1, 2]}}, r"list of \[time s, value in rad/s\] pairs"),
        ({"schema": "winch_friction.crane/1"}, r"a scenario file is asked for"),
        ({"name": 3}, r"name: str type expected, found 3"),
        ({"wire_layer": 1.5}, r"wire_layer: must be a whole number, found 1.5"),
        ({"presliding": 0}, r"presliding: must be greater than 0"),
        ({"profile": {"pump_shares": [0.5, 2]}}, r"profile.pump_shares.1: must be at most 1, found 2"),
        ({"sensors": {"rate": float("nan")}}, r"sensors.rate: value must be a finite number"),
        ({"sensors": {"rate": 10**400}}, r"sensors.rate: value must be a finite number"),
        ({"sensors": []}, r"sensors: must be a mapping of keys"),
        ({"sensors": {"skew": []}}, r"sensors.skew: must be a mapping of keys"),
        ({"mismatch": {3: 1.0}}, r"mismatch: keys must be strings, found 3"),
        ({"mismatch": {"leakage": float("inf")}}, r"mismatch.leakage: value must be a finite number"),
    ],
)
def test_bad_scenarios_are_refused_in_one_line(changes, message):
    with pytest.raises(InputError, match=message) as error:
        scenario_from_content({**GOOD, **changes}, "bad.yaml")
    assert str(error.value).startswith("bad.yaml: ")
    assert "\n" not in str(error.value)


def test_a_missing_key_is_named():
    with pytest.raises(InputError, match="displacement: field required"):
        scenario_from_content({k: v for k, v in GOOD.items() if k != "displacement"})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"displacement": 300 * CM3_PER_REV}, "is outside the motors'"),
        ({"mismatch": {"leakige": 1.2}}, "mismatch.leakige is not a plant parameter"),
        ({"wire_layer": 9}, "wire_layer 9 does not exist"),
        ({"hidden": {"gremlins": 1.0}}, "hidden effect 'gremlins' is not known"),
        ({"plant": "no_such_plant"}, "neither a file nor a shipped name in plants"),
    ],
)
def test_scenarios_that_do_not_fit_crane_or_plant(changes, message, crane, model):
    with pytest.raises(InputError, match=message):
        simulate(scenario_from_content({**GOOD, **changes}), crane, model)


def test_an_electric_crane_is_refused(ahc, model):
    from winch_friction.records.crane_file import load_crane

    with pytest.raises(InputError, match="electric"):
        simulate(ahc, load_crane("emps"), model)


def test_units_are_converted():
    scenario = scenario_from_content(
        GOOD
        | {
            "mode": "normal",
            "load": {"value": 55, "unit": "t"},
            "displacement": {"value": 215, "unit": "cm^3/rev"},
            "profile": {"points": [[0, 0], [1, {"value": 100, "unit": "rpm"}]]},
        }
    )
    assert scenario.load == 55e3
    assert scenario.displacement == pytest.approx(215 * CM3_PER_REV)
    assert scenario.profile.points[1] == (1.0, pytest.approx(100 * RPM))


def test_override_checks_again():
    scenario = scenario_from_content(GOOD)
    assert scenario.override({"sensors.rate": 25.0}).sensors.rate == 25.0
    assert scenario.sensors.rate == 50.0
    with pytest.raises(InputError, match="load"):
        scenario.override({"load": -5})


def test_bad_plant_files(tmp_path):
    text = (config_directory() / "plants" / "winch_150t.yaml").read_text()
    bad = tmp_path / "plant.yaml"
    bad.write_text(text.replace("leakage: 5.0e-12 ", "leakage: -1 "))
    with pytest.raises(InputError, match=r"plant.yaml: leakage: "):
        load_plant(bad)


def test_shipped_paper_tests_are_the_papers():
    assert len(PAPER_TESTS) == len(paper_tests()) == 12
    for built in paper_tests():
        shipped = load_scenario(built.name)
        assert shipped.load == pytest.approx(built.load)
        assert shipped.displacement == pytest.approx(built.displacement)
        assert shipped.profile.pump_shares == built.profile.pump_shares


def test_the_gap_campaign_is_what_the_workflow_was_promised():
    runs = gap_campaign(3)
    assert [run.mode for run in runs] == ["normal"] * 8 + ["ahc"] * 4
    assert all(170 <= run.duration <= 240 and run.sensors.rate == 50.0 for run in runs)
    assert len({run.start_time for run in runs}) == 12
    assert gap_campaign(3) == runs != gap_campaign(4)
