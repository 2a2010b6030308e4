"""The drive: what the motors' torque is known by."""

import math

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GroupSample, Run, Sample
from winch_friction.physics.winch import Crane, Drive, Drum
from winch_friction.physics.winch.crane import run_drive_torque, sample_drive_torque
from winch_friction.records.crane_file import crane_from_content, load_crane


def crane(drive, groups=None):
    return Crane("c", 100.0, Drum((1.0,)), {"active": 3, "passive": 8} if groups is None else groups, 1.0, drive=drive)


TIME = np.arange(4.0)
SPEED = np.array([100.0, -50.0, 2.0, 10.0])
CASES = {
    "hydraulic": (
        Drive(),
        {
            "active.pressure_a": TIME * 1e5 + 5e6, "active.pressure_b": TIME * 0.0 + 2e6,
            "active.displacement": TIME * 0.0 + 2e-5, "passive.pressure_a": TIME * 0.0 + 1e7,
            "passive.pressure_b": TIME * 0.0 + 3e6, "passive.displacement": TIME * 0.0 + 1e-5,
        },
        3 * 2e-5 * (3e6 + TIME * 1e5) + 8 * 1e-5 * 7e6,
    ),
    "electric": (Drive("electric"), {"motor_torque": TIME + 1.0}, 11 * (TIME + 1.0)),
    "power": (Drive("power"), {"mechanical_power": SPEED * 7.0}, np.array([7.0, 7.0, np.nan, 7.0])),
    "current": (Drive("current", 2.5), {"motor_current": TIME - 1.0}, 11 * 2.5 * (TIME - 1.0)),
}  # fmt: skip


@pytest.mark.parametrize("kind", CASES)
def test_sample_and_run_say_the_same_torque(kind):
    drive, columns, torque = CASES[kind]
    run = Run("r", {"time": TIME, "motor_speed": SPEED, **columns})
    np.testing.assert_allclose(run_drive_torque(run, crane(drive)), torque)
    np.testing.assert_allclose([sample_drive_torque(s, crane(drive)) for s in run.samples()], torque)
    for sample, expected in zip(run.samples(), torque, strict=True):
        assert bool(drive.lacking(sample)) == math.isnan(expected)


@pytest.mark.parametrize("kind", CASES)
def test_what_is_missing_is_named(kind):
    drive, columns, _ = CASES[kind]
    lacking = drive.lacking(Sample(0.0, 100.0, groups={"active": GroupSample(1e5, math.nan, 1e-5)}))
    assert lacking == (("active.pressure_b",) if drive.hydraulic else drive.channels)
    first = next(iter(columns))
    run = Run("r", {"time": TIME, "motor_speed": SPEED, **{k: v for k, v in columns.items() if k != first}})
    with pytest.raises(InputError, match=first):
        run_drive_torque(run, crane(drive))


def test_without_groups_a_hydraulic_sample_says_so():
    assert Drive().lacking(Sample(0.0, 1.0)) == ("motor groups",)


CONTENT = {
    "schema": "winch_friction.crane/1", "name": "c", "gear_ratio": 20, "drum": {"layer_radii": [0.5]},
    "groups": {"main": 2}, "inertia": 3.0, "absolute_torque_limit": 100,
}  # fmt: skip


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("electric", Drive("electric")),
        ("power", Drive("power")),
        ({"kind": "electric"}, Drive("electric")),
        ({"kind": "current", "torque_constant": 12.5}, Drive("current", 12.5)),
        ({"kind": "current", "torque_constant": {"value": 12.5, "unit": "N*m/A"}}, Drive("current", 12.5)),
    ],
)
def test_crane_files_name_their_drive(given, expected):
    assert crane_from_content(CONTENT | {"drive": given}, "c.yaml").drive == expected


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("steam", "c.yaml: drive must be one of hydraulic, electric, power, current, found 'steam'"),
        ("current", "needs a torque_constant above 0"),
        ({"kind": "electric", "torque_constant": 3}, "no other"),
        ({"kind": "current", "torque_constant": -3}, "torque_constant above 0"),
        ({"kind": "current", "constant": 3}, "unknown key 'constant'"),
        ({"torque_constant": 3}, "key 'kind' is missing"),
        (7, "kind must be a string"),
    ],
)
def test_a_drive_that_cannot_be_is_refused(given, message):
    with pytest.raises(InputError, match=message):
        crane_from_content(CONTENT | {"drive": given}, "c.yaml")


def test_shipped_cranes_keep_theirs():
    assert load_crane("crane_150t").drive == Drive()
    assert load_crane("emps").drive == Drive("electric")
