"""The demo's parts that need no processes; the whole of it runs in test/ros/test_loop.py."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from winch_friction.cli.demo import processes
from winch_friction.cli.demo.learned import learned_parameters
from winch_friction.cli.demo.legs import voyage_legs
from winch_friction.cli.demo.measures import measure, near_reversal, of_leg
from winch_friction.cli.demo.plan import efficiency_model, make_plan
from winch_friction.cli.demo.recording import Recording
from winch_friction.cli.demo.tuning import efficiency_compensator, search_efficiency
from winch_friction.cli.main import run
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.compiled import operating_point
from winch_friction.physics.friction.scaled import scaled_system
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.crane_file import load_crane
from winch_friction.records.strict_yaml import config_directory
from winch_friction.simulation.scenario import load_scenario


def test_a_folder_with_other_files_is_not_touched(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "thesis.tex").write_text("precious")
    assert run(["demo", "--out", str(tmp_path)]) == 2
    assert "holds other files" in capsys.readouterr().err
    assert (tmp_path / "thesis.tex").read_text() == "precious"


def test_the_efficiency_factor_is_a_share_of_the_load_torque() -> None:
    crane = load_crane("crane_150t")
    point = operating_point(
        direction=1.0, speed=50.0, drum_torque=600e3, groups=[(3, 1e7, 1e7, 3e-5), (8, 2e7, 3e7, 1e-5)], motor_total=11
    )
    lost = (1.0 / 0.9 - 1.0) * 600e3 / crane.gear_ratio  # what hoisting takes beyond the load, at 90 %
    assert efficiency_model(crane, 0.9).torque(point) == pytest.approx(lost)


def test_only_the_system_turns_harder(crane2_model) -> None:
    harder = scaled_system(crane2_model, 1.3)
    assert harder.value("C6") == pytest.approx(1.3 * crane2_model.value("C6"))
    assert harder.value("C4") == crane2_model.value("C4")
    assert harder.value("K4") == crane2_model.value("K4")


def test_the_window_around_reversals() -> None:
    time = np.arange(0.0, 10.0, 0.1)
    near = near_reversal(time, np.where(time < 5.0, 1.0, -1.0))
    assert time[near].min() == pytest.approx(4.8)
    assert time[near].max() == pytest.approx(6.0)


def _plan(folder: Path):
    return make_plan(folder, "ahc_irregular", voyage_legs("ahc_irregular"), 0.82, 60.0, 1, 1.3)


def _recording(phases: int, errors, share: float) -> Recording:
    """A recording of so many phases with a constant position error each, and a constant share of friction fed."""
    times = [1000.0 + 70.0 * k + np.arange(0.0, 60.0, 0.1) for k in range(phases)]
    error = np.concatenate([np.full(len(time), errors[k]) for k, time in enumerate(times)])
    time = np.concatenate(times)
    speed = 500.0 * RPM * np.sin(time)
    friction = 400.0 * np.sign(speed)
    truth = np.column_stack([time, error, speed, friction, friction])
    fed = np.column_stack([time, share * friction, speed])
    return Recording(truth, fed, fed, [])


def test_the_voyage_has_loads_and_displacements(tmp_path: Path) -> None:
    legs = voyage_legs("ahc_irregular")
    assert len({leg.load for leg in legs}) >= 2
    assert len({leg.displacement for leg in legs}) >= 2
    assert legs[0].key == (55.0, 215.0)
    assert len({str(leg.scenario.sea) for leg in legs}) == 1
    for leg in legs:
        written = load_scenario(leg.write(tmp_path))
        assert written == leg.scenario


def test_what_belongs_to_the_first_load_stays_there(tmp_path: Path) -> None:
    own = tmp_path / "own.yaml"
    own.write_text(
        (config_directory() / "scenarios" / "ahc_irregular.yaml").read_text()
        + "passive_displacement: {value: 60, unit: cm^3/rev}\n"
    )
    first, *others = voyage_legs(str(own))
    assert first.scenario.passive_displacement == pytest.approx(60 * CM3_PER_REV)
    assert {leg.scenario.passive_displacement for leg in others} == {None}


@pytest.mark.parametrize(("scenario", "said"), [("nope", "nope"), ("test_05", "no heave compensation")])
def test_a_scenario_that_cannot_be_sailed_is_refused_before_anything_starts(
    scenario: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("winch_friction.cli.demo.processes.subprocess.Popen", None)
    earlier = tmp_path / "demo"
    earlier.mkdir()
    for name in ("plan.json", "demo.json"):
        (earlier / name).write_text("{}")
    assert run(["demo", "--out", str(earlier), "--scenario", scenario]) == 2
    error = capsys.readouterr().err.strip()
    assert said in error
    assert "\n" not in error
    assert {path.name for path in earlier.iterdir()} == {"plan.json", "demo.json"}, "nothing of an earlier demo is lost"


def test_every_phase_is_one_leg_with_one_feedforward(tmp_path: Path) -> None:
    plan = _plan(tmp_path)
    assert len(plan.phases) == len(plan.legs) * 4
    assert [phase.feedforward.name for phase in plan.phases[:: len(plan.legs)]] == [
        "none", "efficiency", "seed", "learned",
    ]  # fmt: skip
    assert "efficiency 0.82" in plan.phases[len(plan.legs)].title
    parameter_file, _ = plan.write()
    simulator = yaml.safe_load(parameter_file.read_text())["/**/simulator"]["ros__parameters"]
    assert [load_scenario(each) for each in (simulator["scenario"], *simulator["legs"])] == [
        leg.scenario for leg in plan.legs
    ]


def test_gains_are_those_of_the_same_leg(tmp_path: Path) -> None:
    plan = _plan(tmp_path)
    legs = len(plan.legs)
    errors = [0.010 * (k % legs + 1) * (1.0 - 0.2 * (k // legs)) for k in range(4 * legs)]
    rows = measure(plan, _recording(4 * legs, errors, 0.9))
    assert [row.residual for row in rows] == pytest.approx(errors)
    for leg in plan.legs:
        assert [row.gain for row in of_leg(rows, leg.name)] == pytest.approx([0.0, 0.2, 0.4, 0.6])


def test_errors_are_those_of_the_model_behind_the_feedforward(tmp_path: Path) -> None:
    plan = _plan(tmp_path)
    legs = len(plan.legs)
    rows = measure(plan, _recording(len(plan.phases), [0.004] * len(plan.phases), 0.9))
    learned, tuned = rows[3 * legs], rows[legs]
    assert learned.friction_error_share[:3] == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert tuned.friction_error_share[1] == pytest.approx(0.1)
    assert np.isnan(learned.friction_error[3])  # the sea did not go there: no figure, not a zero


def test_an_interrupted_recording_is_said() -> None:
    with pytest.raises(InputError, match="3 phases, expected 4"):
        _recording(3, [0.0] * 3, 1.0).phases(4)


def test_no_factor_beside_it_is_better_than_the_one_that_is_found(crane_150t, crane2_model) -> None:
    leg = voyage_legs("ahc_irregular")[0].scenario.override({"duration": 40.0})
    truth = scaled_system(crane2_model, 1.3)
    tried: list[float] = []
    search = search_efficiency(crane_150t, truth, leg, 1, tried.append)
    assert sorted(tried) == list(search.efficiencies)
    assert search.best == pytest.approx(0.82, abs=0.03)  # at 55 t the true friction is a fifth of the load's torque
    at = search.efficiencies.index(search.best)
    assert search.efficiencies[at - 1] == pytest.approx(search.best - 0.01)
    assert search.efficiencies[at + 1] == pytest.approx(search.best + 0.01)
    assert search.residuals[at] < min(search.residuals[at - 1], search.residuals[at + 1])
    assert search.residuals[at] < 0.3 * max(search.residuals)


def test_the_factor_is_tuned_as_it_is_used(tmp_path: Path, crane_150t) -> None:
    """In full, in the search as in the voyage: 55 t at 0.8 is a quarter of the load's torque."""
    assert _plan(tmp_path).feedforwards[1].scale == 1.0
    each = efficiency_compensator(crane_150t, 0.8)
    groups = {"active": GroupSample(1e7, 2.5e6, 3.4e-5), "passive": GroupSample(2.7e7, 2.5e6, 1.1e-5)}
    for k in range(200):
        out = each.step(Sample(0.02 * k, 100.0, speed_reference=100.0, groups=groups, hook_load=55e3))
    assert out.friction_torque == pytest.approx(0.25 * crane_150t.drum_torque(55e3) / crane_150t.gear_ratio, rel=1e-3)


def test_learned_parameters_stand_beside_sigma_and_truth(crane2_model) -> None:
    truth = scaled_system(crane2_model, 1.3)
    rows = {each.name: each for each in learned_parameters(crane2_model, crane2_model, truth)}
    std = float(crane2_model.std[crane2_model.parameter_names.index("C6")])
    assert rows["C6"].sigmas == pytest.approx(-0.3 * crane2_model.value("C6") / std)
    assert rows["K4"].sigmas == 0.0
    assert rows["C6"].as_dict()["sigmas_from_truth"] == rows["C6"].sigmas


def test_all_that_the_demo_starts_meet_in_one_domain(monkeypatch):
    """Whatever other programs draw: they once were in one each, and waited for each other in vain."""
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    drawn = {processes.quiet_environment()["ROS_DOMAIN_ID"] for _ in range(20)}
    assert len(drawn) == 1
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    assert processes.quiet_environment()["ROS_DOMAIN_ID"] == "42"
