"""Steps 2 and 3 on logged cycles of known truth, and every way in which a log can be unusable."""

from dataclasses import replace

import numpy as np
import pytest
from cycles import SPEEDS, TABLE_2, cycle, cycles

from winch_friction.identification.fit_data import modelled
from winch_friction.identification.friction_curve import _branch, curve_data, friction_curve, winch_points
from winch_friction.identification.plateaus import Plateau, PlateauRule, find_plateaus
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run


def test_every_plateau_is_found_once(truth, crane):
    plateaus = find_plateaus(cycle(truth, crane, "a", 215, 79), crane)
    found = sorted(round(each.speed / RPM) for each in plateaus)
    assert found == sorted([*SPEEDS, *(-speed for speed in SPEEDS)])
    for each in plateaus:
        assert each.end - each.start < 5.0  # transients are cut off
        assert each.speed_std < 1.6 * RPM
        assert each.displacement == pytest.approx(215 * CM3_PER_REV)
        assert each.drum_torque == pytest.approx(crane.drum_torque(79e3))
        assert 0.0 < each.pressure_error < 0.1 * BAR


def test_means_are_the_truth(truth, crane):
    from cycles import drive_pressure

    plateaus = find_plateaus(cycle(truth, crane, "a", 164, 109, seed=3), crane)
    for each in plateaus:
        expected = drive_pressure(truth, crane, np.array([each.speed]), 164 * CM3_PER_REV, 109e3)[0]
        assert abs(each.pressure_drop - expected) < 6 * max(each.pressure_error, 0.02 * BAR)


def test_a_plateaus_error_is_that_of_the_mean_of_its_four_parts(truth, crane):
    """A load that swings slowly: the parts differ, their mean is twice as sure as one of them."""
    run = cycle(truth, crane, "a", 215, 79, speeds=(500,), noise=0.0)
    swinging = run["main.pressure_a"] + 2.0 * BAR * np.sin(0.9 * run.time)
    for each in find_plateaus(replace(run, columns={**run.columns, "main.pressure_a": swinging}), crane):
        inside = (run.time >= each.start) & (run.time <= each.end)
        drop = (swinging - run["main.pressure_b"])[inside]
        parts = [part.mean() for part in np.array_split(drop, 4)]
        assert each.pressure_error == pytest.approx(np.std(parts, ddof=1) / 2.0, rel=1e-6)


def test_ramps_and_standstill_are_no_plateaus(truth, crane):
    run = cycle(truth, crane, "a", 215, 79, noise=0.0)
    time = run.time
    ramp = replace(run, columns={**run.columns, "motor_speed": 0.5 * time})
    still = replace(run, columns={**run.columns, "motor_speed": np.zeros_like(time)})
    assert find_plateaus(ramp, crane) == []  # 5 rpm/s: slow enough for the slope alone
    down = replace(run, columns={**run.columns, "motor_speed": 100.0 - 0.5 * time})
    assert find_plateaus(down, crane) == []
    assert find_plateaus(still, crane) == []


def test_a_change_of_displacement_ends_a_plateau(truth, crane):
    run = cycle(truth, crane, "a", 215, 79, speeds=(500,))
    moved = run["main.displacement"] * np.where(run.time < 3.0, 1.0, 0.8)
    plateaus = find_plateaus(replace(run, columns={**run.columns, "main.displacement": moved}), crane)
    for each in plateaus:
        assert not each.start < 3.0 < each.end


def test_what_settles_is_no_part_of_a_plateau_and_a_change_of_layer_ends_it(crane):
    """Two levels of 8 s: the first second of each, and what is out of the band about its end, is still on the way."""
    time = np.arange(0.0, 16.0, 0.02)
    level = np.where(time < 8.0, 300.0, 600.0)
    late = np.where((time > 8.0) & (time < 10.0), -40.0, 0.0)  # 2 s of 560 rpm, of constant speed themselves
    late += np.where((time > 10.0) & (time < 10.5), 60.0, 0.0)
    columns = {
        "time": time, "motor_speed": (level + late) * RPM, "main.pressure_a": np.full(len(time), 150e5),
        "main.pressure_b": np.full(len(time), 25e5), "main.displacement": np.full(len(time), 215 * CM3_PER_REV),
        "hook_load": np.full(len(time), 50e3), "wire_layer": np.where(time < 13.0, 2.0, 3.0),
    }  # fmt: skip
    found = find_plateaus(Run("steps", columns), crane, PlateauRule(slope=200.0 * RPM, drift=50.0 * RPM))
    first, *others = [(each.start, each.end) for each in found]
    assert first[0] == pytest.approx(1.6, abs=0.05)  # behind half of the window over which a slope is taken
    assert first[1] < 8.0
    assert min(start for start, _ in others) > 10.5
    assert all(not start < 13.0 <= end for start, end in others)


def test_curve_recovers_total_friction(truth, crane):
    curves = [friction_curve(find_plateaus(run, crane), crane) for run in cycles(truth, crane, TABLE_2, noise=0.0)]
    data = curve_data(curves)
    error = np.abs(data.torque - modelled(truth, data))
    # what remains is the straight line between plateaus on a curved characteristic
    assert error.max() < 0.6
    assert np.median(error) < 0.15
    steps = np.diff(curves[0].speed) / RPM
    np.testing.assert_allclose(steps, 25.0)
    assert curves[2].load_torque == pytest.approx(crane.drum_torque(109e3) / 250 / 11)


def test_equal_speed_although_leakage_shifts_the_directions(truth, crane):
    up = cycle(truth, crane, "up", 215, 79, speeds=(53, 106, 212, 424, 848), directions=(1,), noise=0.0)
    down = cycle(truth, crane, "up", 215, 79, speeds=(47, 94, 188, 376, 752), directions=(-1,), noise=0.0)
    curve = friction_curve([*find_plateaus(up, crane), *find_plateaus(down, crane)], crane)
    assert curve.speed[0] / RPM == pytest.approx(75.0)
    assert curve.speed[-1] / RPM == pytest.approx(750.0)
    data = curve_data([curve])
    assert np.abs(data.torque - modelled(truth, data)).max() < 1.5  # few plateaus: chords of a curve


def test_another_wire_layer_on_the_way_down_is_not_taken_for_friction(truth, crane):
    up = cycle(truth, crane, "a", 215, 79, directions=(1,), noise=0.0)
    down = cycle(truth, crane, "a", 215, 79, directions=(-1,), noise=0.0)
    plateaus = [*find_plateaus(up, crane), *find_plateaus(down, crane)]
    lower = [
        replace(each, drum_torque=0.94 * each.drum_torque,
                pressure_drop=each.pressure_drop - 0.06 * each.drum_torque / (250 * 11 * each.displacement))
        if each.speed < 0 else each
        for each in plateaus
    ]  # fmt: skip
    same, other = friction_curve(plateaus, crane), friction_curve(lower, crane)
    np.testing.assert_allclose(other.friction_torque, same.friction_torque, rtol=1e-6)


def test_one_direction_only(truth, crane):
    plateaus = find_plateaus(cycle(truth, crane, "test_9.csv", 215, 79, directions=(1,)), crane)
    with pytest.raises(InputError, match=r"^test_9.csv: no lowering at constant speed was found"):
        friction_curve(plateaus, crane)


def test_too_few_plateaus(truth, crane):
    plateaus = find_plateaus(cycle(truth, crane, "test_9.csv", 215, 79, speeds=(500,)), crane)
    with pytest.raises(InputError, match=r"^test_9.csv: hoisting has one constant speed only"):
        friction_curve(plateaus, crane)


def test_no_overlap(truth, crane):
    fast = find_plateaus(cycle(truth, crane, "t.csv", 215, 79, speeds=(500, 900), directions=(1,)), crane)
    slow = find_plateaus(cycle(truth, crane, "t.csv", 215, 79, speeds=(100, 200), directions=(-1,)), crane)
    with pytest.raises(
        InputError, match=r"^t.csv: the speeds of hoisting and lowering do not overlap \(500-900 rpm and"
    ):
        friction_curve([*fast, *slow], crane)


def test_nan_is_named_by_row_and_column(truth, crane):
    run = cycle(truth, crane, "t.csv", 215, 79)
    values = run["main.pressure_a"].copy()
    values[41] = np.nan
    with pytest.raises(InputError, match=r"^t.csv row 43: column 'main.pressure_a' is not a finite number"):
        find_plateaus(replace(run, columns={**run.columns, "main.pressure_a": values}), crane)


@pytest.mark.parametrize("column", ["main.pressure_b", "hook_load"])
def test_missing_column(truth, crane, column):
    run = cycle(truth, crane, "t.csv", 215, 79)
    columns = {name: values for name, values in run.columns.items() if name != column}
    with pytest.raises(InputError, match=rf"t.csv: column '{column}' is missing"):
        find_plateaus(replace(run, columns=columns), crane)


def test_too_short(truth, crane):
    run = cycle(truth, crane, "t.csv", 215, 79)
    short = replace(run, columns={name: values[:10] for name, values in run.columns.items()})
    with pytest.raises(InputError, match="t.csv: 10 samples are too few"):
        find_plateaus(short, crane)


def on_layers(run, crane, layer):
    """The run as it is with other wire layers in use than the outer one, loads alone."""
    radius = np.array([crane.drum.radius(each) for each in layer]) - crane.drum.radius(6)
    more = run["hook_load"] * 9.81 * radius / (crane.gear_ratio * 11 * run["main.displacement"])
    return replace(run, columns={**run.columns, "main.pressure_a": run["main.pressure_a"] + more, "wire_layer": layer})


def test_a_layer_that_changes_within_a_direction_is_no_friction(truth, crane):
    """Hoisting faster and faster from layer 5 to 6 and back again: both layers stand in both directions, but at one
    speed they differ, by half a dozen bar."""
    run = cycle(truth, crane, "a", 215, 79)
    slow, up = np.abs(run["motor_speed"]) < 300 * RPM, run["motor_speed"] > 0.0
    moved = friction_curve(find_plateaus(on_layers(run, crane, np.where(up == slow, 5.0, 6.0)), crane), crane)
    stayed = friction_curve(find_plateaus(run, crane), crane)
    assert moved.friction_torque == pytest.approx(stayed.friction_torque, abs=0.05)  # N m, of 41


def test_a_layer_holds_until_another_one_is_said(truth, crane):
    """A slow channel of a log that writes it once a second."""
    run = cycle(truth, crane, "a", 215, 79)
    layer = np.where(run.time < 60.0, 5.0, 6.0)
    every = on_layers(run, crane, layer)
    sparse = replace(every, columns={**every.columns, "wire_layer": np.where(np.arange(len(run)) % 25, np.nan, layer)})
    found, wanted = find_plateaus(sparse, crane), find_plateaus(every, crane)
    assert [each.drum_torque for each in found] == pytest.approx([each.drum_torque for each in wanted], rel=1e-9)


def test_a_slow_motor_has_its_plateaus_and_its_curve(truth, crane):
    """60 rpm at most: plateaus of 2 and 4 rpm were rest, and a curve in steps of 25 rpm had two points."""
    slow, speeds = replace(crane, rated_speed=70 * RPM), (2, 4, 7, 11, 16, 23, 35, 48, 60)
    run = cycle(truth, slow, "slow", 215, 79, speeds=speeds, noise=0.05)
    plateaus = find_plateaus(run, slow)
    assert sorted(round(each.speed / RPM) for each in plateaus) == sorted(d * s for s in speeds for d in (1, -1))
    curve = friction_curve(plateaus, slow)
    assert len(curve.speed) > 25
    x = winch_points(curve.speed, 0.5 * (curve.pressure_up + curve.pressure_down), curve.displacement,
                     curve.drum_torque, 11)  # fmt: skip
    np.testing.assert_allclose(11 * curve.friction_torque, truth.torque(x), rtol=0.03)
    ramp = np.interp(run.time, [0.0, run.time[-1]], [5.0, 60.0]) * RPM
    assert find_plateaus(replace(run, columns={**run.columns, "motor_speed": ramp}), slow) == []


def level(speed, pressure=100.0):
    return Plateau("t", 0.0, 5.0, 250, speed * RPM, 0.0, pressure * BAR, 0.0, 215 * CM3_PER_REV, 1e6)


def test_speeds_within_five_rpm_of_the_first_are_one_and_a_chain_of_them_is_not():
    speeds = (100.0, 104.0, 108.0, 300.0)
    found = _branch([level(speed, speed) for speed in speeds], +1, "t", 5.0 * RPM)
    np.testing.assert_allclose(found[0] / RPM, [102.0, 108.0, 300.0])
    np.testing.assert_allclose(found[1] / BAR, [102.0, 108.0, 300.0])


def test_tests_with_other_motors_on_the_shaft_are_fitted_apart(crane):
    plateaus = [level(sign * speed, 100.0 + sign) for sign in (1.0, -1.0) for speed in (100.0, 300.0)]
    curves = [friction_curve(plateaus, crane), friction_curve(plateaus, crane, "active")]
    assert len(curve_data(curves[:1]).torque) == len(curves[0].speed)
    with pytest.raises(InputError, match="differ in their number of motors"):
        curve_data(curves)


def test_a_plateau_is_as_long_as_it_is_whenever_it_was_logged(truth, crane):
    run = cycle(truth, crane, "a", 215, 79)
    dated = replace(run, columns={**run.columns, "time": run.time + 1.7e9})
    rule = PlateauRule(duration=2.0)
    long = [(each.start, each.end) for each in find_plateaus(run, crane, rule)]
    late = [(each.start - 1.7e9, each.end - 1.7e9) for each in find_plateaus(dated, crane, rule)]
    np.testing.assert_allclose(late, long, atol=1e-5)
    assert find_plateaus(dated, crane, PlateauRule(duration=60.0)) == []
