"""What tells how large a speed is, and what the first line of a check says where only that is wrong."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.commissioning.check import quick_check
from winch_friction.commissioning.commissioning import check
from winch_friction.commissioning.kinematics import tells_speed
from winch_friction.commissioning.view import views_of
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run
from winch_friction.records.strict_yaml import config_directory


def example_of_the_worm_drive(name):
    from winch_friction.importing.carry_out import import_log
    from winch_friction.importing.mapping import load_map

    folder = config_directory() / "examples" / "worm_drive"
    return import_log(folder / name, load_map(folder / "map.yaml"), load_crane("worm_drive"))


@pytest.mark.parametrize("name", ["20.csv", "n20.csv", "n60.csv"])
def test_a_measured_torque_tells_no_speed(name):
    """Of a worm drive, most of whose torque is friction, the speed was said to be the drum's: that made room for it."""
    run, crane = example_of_the_worm_drive(name), load_crane("worm_drive")
    found = quick_check([run], crane, load_model("worm_viscous"))
    assert found
    assert not [each for each in found if "motor_speed holds" in each.sentence]
    heavy = replace(crane, inertia=1e4 * crane.inertia)
    slow, quick = (tells_speed(views_of([(run, each)])[0], each) for each in (crane, heavy))
    assert (slow, quick) == (False, True)


@pytest.mark.parametrize(("inertia", "told"), [(0.1, False), (0.3, True)])
def test_an_inertia_of_a_fiftieth_of_the_torque_tells_the_speed(inertia, told):
    """100 rad/s^2 to and fro, of 0.1 and 0.3 kg m^2, beside 1000 N m: 1 % and 3 % of it."""
    to_and_fro = np.resize([100.0, -100.0], 20)
    drive = 1000.0 * np.sign(to_and_fro)
    view = SimpleNamespace(rates={}, inertia=inertia, acceleration=to_and_fro, drive_torque=drive)
    crane = SimpleNamespace(drive=SimpleNamespace(kind="electric"))
    assert tells_speed(view, crane) == told
    assert tells_speed(SimpleNamespace(rates={"wire_out": to_and_fro}), crane)


def test_one_run_that_leaves_the_balance_open_is_not_one_of_them():
    run, crane = example_of_the_worm_drive("20.csv"), load_crane("worm_drive")
    sentence = check([run], crane, load_model("worm_viscous"), dict).sentence
    assert "nothing contradicts 1 run of crane 'worm_drive', but it leaves more of the torque balance open" in sentence


def test_a_channel_that_is_wrong_beside_the_balance_is_in_the_first_line(crane_150t, crane2_model):
    """The balance closed, and was said to be open, and that to be friction."""
    run = read_run(config_directory() / "examples" / "practice_150t" / "test_02.parquet")
    turned = replace(run, columns={**run.columns, "wire_out": 400.0 - run["wire_out"]})
    result = check([turned], crane_150t, crane2_model, dict)
    assert result.plausible
    assert (
        "1 run of crane 'crane_150t' closes the torque balance, but wire_out contradicts motor_speed" in result.sentence
    )
    assert result.sentence.endswith("times the speed")
    assert check([run], crane_150t, crane2_model, dict).sentence.endswith("closes the torque balance")


@pytest.mark.parametrize(
    ("channel", "factor", "unit"),
    [("wire_out", 1000.0, "mm under [m]"), ("speed_reference", 30.0 / 3.14159, "rpm under [rad/s]")],
)
def test_a_channel_that_tells_the_speed_in_another_unit_is_refused(crane_150t, crane2_model, channel, factor, unit):
    """A wire in mm in two runs of ten was "0.998 times the speed", and a stroke of a winch that lacks nothing."""
    folder = config_directory() / "examples" / "practice_150t"
    runs = [read_run(folder / f"test_0{k}.parquet") for k in (2, 3, 4)]
    columns = {"speed_reference": runs[1]["motor_speed"], **runs[1].columns}
    runs[1] = replace(runs[1], columns={**columns, channel: factor * columns[channel]})
    (found,) = [each for each in quick_check(runs, crane_150t, crane2_model, dict) if each.contradicts]
    assert found.sentence.startswith(f"{channel} contradicts motor_speed")
    assert f" times the speed ({unit}?); with that put right" in found.sentence
    assert channel == "speed_reference" or " in test_03.parquet: it tells " in found.sentence
