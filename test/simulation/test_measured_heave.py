"""A ship's measured heave as the sea of a scenario: sailed as measured, refused with the reason where it cannot be."""

import numpy as np
import pytest

from winch_friction.cli.demo.legs import voyage_legs
from winch_friction.physics.errors import InputError
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.strict_yaml import config_directory
from winch_friction.simulation import load_scenario, simulate
from winch_friction.simulation.motion.measured import load_heave

LOG = config_directory() / "examples" / "ship_heave" / "seapath.csv"
SCENARIO = config_directory() / "scenarios" / "ahc_measured_heave.yaml"


def test_the_motion_goes_through_the_measured_heights_and_its_speed_is_their_slope():
    table = np.genfromtxt(LOG, delimiter=",", skip_header=1)
    heave = load_heave(LOG)
    at = table[:, 0] - table[0, 0]
    assert heave.motion(at)[:, 0] == pytest.approx(table[:, 1] - table[:, 1].mean(), abs=1e-9)
    fine = np.arange(100.0, 200.0, 0.01)
    height, speed, acceleration = heave.motion(fine).T
    assert speed[1:-1] == pytest.approx(((height[2:] - height[:-2]) / 0.02), abs=1e-3)
    assert acceleration[1:-1] == pytest.approx(((speed[2:] - speed[:-2]) / 0.02), abs=1e-2)
    assert np.std(height) == pytest.approx(1.1, abs=0.3)


def test_a_motion_that_starts_later_is_the_records_own_from_there_on():
    time = np.arange(0.0, 20.0, 0.5)
    assert load_heave(LOG, 30.0).motion(time) == pytest.approx(load_heave(LOG).motion(30.0 + time))


def test_the_shipped_scenario_is_sailed_in_that_motion():
    scenario = load_scenario("ahc_measured_heave").override({"duration": 60.0})
    done = simulate(scenario, load_crane("crane_150t"), load_model("a6vm215_crane2"), seed=1)
    speed = 0.6 * load_heave(LOG).motion(done.run.time)[:, 1]
    late = done.run.time > 12.0  # faded in by then
    assert np.corrcoef(done.run["heave_velocity"][late], speed[late])[0, 1] > 0.99


def test_a_scenario_finds_its_motion_beside_itself(tmp_path):
    (tmp_path / "own.csv").write_text("time [s],heave [cm]\n" + "".join(f"{k},{100 * (k % 5)}\n" for k in range(80)))
    (tmp_path / "own.yaml").write_text(SCENARIO.read_text().replace("../examples/ship_heave/seapath.csv", "own.csv"))
    sea = load_scenario(tmp_path / "own.yaml").sea
    assert load_heave(tmp_path / "own.csv").lasts == 79.0
    assert sea.file == str((tmp_path / "own.csv").resolve())
    assert load_heave(tmp_path / "own.csv").motion(np.array([4.0]))[0, 0] == pytest.approx(2.0)


def test_the_demo_s_legs_carry_the_motion_with_them(tmp_path):
    legs = voyage_legs("ahc_measured_heave")
    written = load_scenario(legs[1].write(tmp_path))
    assert written.sea.file == str(LOG.resolve())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time [s],height [m]\n0,1\n1,2\n", "no column heave"),
        ("time [s],heave [m]\n0,1\n1,2\n5,1\n6,0\n", "line 4: 4 s without a height"),
        ("time [s],heave [m]\n0,1\n1,\n2,1\n3,0\n", "line 3: heave is no number"),
        ("time [s],heave [m]\n0,1\n1,1_0\n2,1\n3,0\n", "line 3: heave is no number"),
        ("time [s],heave [m],Größe\n0,1\n1,2\n2,1\n3,0\n", "save it as UTF-8"),
        ("time [s],heave [m]\n0,1\n1,2\n1,3\n3,0\n", "time must increase"),
        ("time [s],heave [m]\n0,100\n1,900\n2,100\n3,0\n", "unit right"),
    ],
)
def test_what_is_no_motion_is_refused_with_the_reason(tmp_path, text, said):
    (tmp_path / "heave.csv").write_text(text, encoding="cp1252")
    with pytest.raises(InputError, match=said):
        load_heave(tmp_path / "heave.csv")


def test_a_record_that_ends_before_the_scenario_is_refused():
    with pytest.raises(InputError, match="lasts 712.9"):
        load_heave(LOG, start=600.0).motion(np.array([0.0, 200.0]))
    with pytest.raises(InputError, match="no such motion file"):
        load_heave(LOG.with_name("missing.csv"))
