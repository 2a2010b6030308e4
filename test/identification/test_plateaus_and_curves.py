"""Steps 2 and 3 on logged cycles of known truth, and every way in which a log can be unusable."""

from dataclasses import replace

import numpy as np
import pytest
from cycles import SPEEDS, TABLE_2, cycle, cycles

from winch_friction.identification.fit_data import modelled
from winch_friction.identification.friction_curve import _branch, _common_grid, curve_data, friction_curve, winch_points
from winch_friction.identification.plateaus import (
    Plateau,
    PlateauRule,
    _changes,
    _level_from,
    _statistics,
    find_plateaus,
)
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.compiled import ORDER
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
    speeds = (100.0, 104.0, 108.0, 111.0, 300.0)  # the second level has two as well
    found = _branch([level(speed, speed) for speed in speeds], +1, "t", 5.0 * RPM)
    np.testing.assert_allclose(found[0] / RPM, [102.0, 109.5, 300.0])
    np.testing.assert_allclose(found[1] / BAR, [102.0, 109.5, 300.0])


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


# -- the rule and the statistics, by figures
def logged(speed, step=0.02, **more):
    """At these speeds in rpm, with everything else as constant as can be."""
    one = np.ones(len(speed))
    columns = {
        "time": step * np.arange(len(speed)), "motor_speed": np.asarray(speed) * RPM, "main.pressure_a": 150e5 * one,
        "main.pressure_b": 25e5 * one, "main.displacement": 215 * CM3_PER_REV * one, "hook_load": 5e4 * one,
    }  # fmt: skip
    return Run("log", {**columns, **more})


LAX = {"drift": 1e3, "band": 1e3}  # so that the slope alone decides


@pytest.mark.parametrize(
    ("speed", "rule", "found"),
    [
        (np.full(184, 50.0), {}, False),  # 3.68 s: half a window at either end, the first second: 1.48 s are left
        (np.full(188, 50.0), {}, True),
        (np.full(250, 3.9), {}, False),
        (np.full(250, -4.1), {}, True),
        (100.0 + 11.5 * np.linspace(0.0, 5.0, 250), {"relative_slope": 0.0, **LAX}, True),
        (100.0 + 12.5 * np.linspace(0.0, 5.0, 250), {"relative_slope": 0.0, **LAX}, False),
        (-500.0 * np.exp(0.0194 * np.linspace(0.0, 5.0, 250)), {"slope": 0.0, **LAX}, True),
        (-500.0 * np.exp(0.0206 * np.linspace(0.0, 5.0, 250)), {"slope": 0.0, **LAX}, False),
        (-1000.0 + 4.7 * np.linspace(-2.5, 2.5, 250), {}, True),  # 3 rpm/s and 2 per mille of the speed a second
        (-1000.0 - 4.7 * np.linspace(-2.5, 2.5, 250), {}, True),
        (1000.0 - 5.3 * np.linspace(-2.5, 2.5, 250), {}, False),
        (-1000.0 - 5.3 * np.linspace(-2.5, 2.5, 250), {}, False),
    ],
)
def test_what_is_steady_long_and_fast_enough_is_a_plateau_and_what_is_hardly_less_is_none(crane, speed, rule, found):
    assert len(find_plateaus(logged(speed), crane, PlateauRule(**rule))) == found


@pytest.mark.parametrize("final", [50.0, -50.0])
def test_the_band_is_eight_rpm_and_two_per_cent_about_where_the_speed_ends(final):
    mean = final + np.array([40.0, 9.2, -8.8, 8.8, -9.2, 8.8, -8.8, 5.0, 0.0, 99.0])
    assert _level_from(mean * RPM, 0, 9, PlateauRule()) == 5
    assert _level_from(mean * RPM, 6, 9, PlateauRule()) == 6


def test_slow_motors_have_the_same_plateaus_in_proportion(crane):
    rng = np.random.default_rng(7)
    level = np.repeat([2.0, 5.0, 30.0, 300.0, -3.0, -5.0, -320.0, 900.0], 250)
    creeping = level + np.convolve(4.0 * rng.normal(size=len(level)), np.ones(50) / 50.0, mode="same")
    creeping = np.append(creeping, 300.0 + 54.0 * np.exp(-np.arange(700) / 150.0))  # within the slope, not the band
    slow = replace(crane, rated_speed=20.0)
    assert slow.speed_scale < 0.5
    found, wanted = find_plateaus(logged(slow.speed_scale * creeping), slow), find_plateaus(logged(creeping), crane)
    assert len(wanted) > 3
    assert [(each.start, each.end) for each in found] == [(each.start, each.end) for each in wanted]


def test_a_hole_in_the_log_changes_no_window(crane):
    """The usual step counts for the window, and the time between two samples for a slope over the hole."""
    speed = np.repeat([100.0, 300.0], 300)
    run = logged(speed)
    late = run.time + np.where(np.arange(600) < 300, 0.0, 100.0)
    found = find_plateaus(replace(run, columns={**run.columns, "time": late}), crane)
    wanted = find_plateaus(run, crane)
    assert found[0].samples == pytest.approx(wanted[0].samples, abs=31)
    assert found[-1].end == pytest.approx(wanted[-1].end + 100.0)
    assert found[0].start == wanted[0].start


@pytest.mark.parametrize(("share", "moves"), [(1.018, False), (1.022, True), (0.982, False), (0.978, True)])
def test_a_displacement_is_on_the_move_from_two_per_cent_over_the_window_on(share, moves):
    shown = 3e-5 * np.repeat([1.0, share], 50)
    moved = _changes(shown, 10)
    assert moved.any() == moves
    assert not moved[:30].any()
    assert not moved[70:].any()


@pytest.mark.parametrize(("rows", "few"), [(19, True), (20, False)])
def test_twenty_samples_are_enough_to_look_at(crane, rows, few):
    if few:
        with pytest.raises(InputError, match="log: 19 samples are too few"):
            find_plateaus(logged(np.full(rows, 50.0)), crane)
    else:
        assert find_plateaus(logged(np.full(rows, 50.0)), crane) == []


def test_a_plateaus_figures_are_those_of_its_own_samples():
    n = 12
    speed, drop, torque = np.arange(n) ** 2.0, 1e5 * np.arange(n) ** 3.0, 1e5 + np.arange(n) ** 2.0
    more = {"main.pressure_a": 25e5 + drop, "main.displacement": 3e-5 + 1e-7 * np.arange(n) ** 2.0}
    own = slice(3, 11)
    found = _statistics(logged(speed / RPM, **more), "main", torque, own)
    assert (found.run, found.start, found.end, found.samples) == ("log", 0.06, 0.2, 8)
    assert found.speed == pytest.approx(np.sum(np.arange(3, 11) ** 2) / 8.0)
    assert found.speed_std == pytest.approx(np.sqrt(np.mean((np.arange(3, 11) ** 2 - found.speed) ** 2)))
    assert found.pressure_drop == pytest.approx(np.mean(np.arange(3, 11) ** 3) * 1e5)
    assert found.displacement == pytest.approx(3e-5 + 1e-7 * found.speed)
    assert found.drum_torque == pytest.approx(1e5 + found.speed)
    parts = [np.mean([k**3.0, (k + 1) ** 3.0]) * 1e5 for k in (3, 5, 7, 9)]
    assert found.pressure_error == pytest.approx(np.std(parts, ddof=1) / 2.0)


@pytest.mark.parametrize(("apart", "first"), [(4.5, 125.0), (5.5, 100.0)])
@pytest.mark.parametrize("rated", [None, 10.0])
def test_speeds_less_than_five_rpm_apart_are_one_or_less_of_slow_motors(crane, rated, apart, first):
    """One level, at the mean of both, begins beyond the grid's 100 rpm."""
    own = replace(crane, rated_speed=rated) if rated else crane
    speeds = [own.speed_scale * each for each in (100.0, 100.0 + apart, 200.0)]
    curve = friction_curve([level(sign * speed, 100.0 + sign) for sign in (1.0, -1.0) for speed in speeds], own)
    wanted = np.arange(first, 201.0, 25.0) * own.speed_scale
    np.testing.assert_allclose(curve.speed / RPM, wanted)


def test_a_curve_begins_and_ends_on_the_grid_though_means_are_rounded():
    for off in (-1e-13, 1e-13):
        speeds = np.array([100.0, 300.0]) * RPM * (1.0 + off)
        np.testing.assert_allclose(_common_grid(speeds, speeds, "t", 25.0 * RPM) / RPM, np.arange(100.0, 301.0, 25.0))


def test_a_curve_has_the_means_of_its_plateaus_and_a_friction_below_nothing_is_said_as_that(crane):
    plateaus = [
        replace(level(sign * speed, 100.0 - 2.0 * sign), displacement=swept * CM3_PER_REV, drum_torque=1e6)
        for sign, speed, swept in ((1, 100, 206.0), (1, 300, 207.0), (-1, 100, 209.0), (-1, 300, 210.0))
    ]
    curve = friction_curve(plateaus, crane)
    assert curve.displacement == pytest.approx(208.0 * CM3_PER_REV)
    assert (curve.drum_torque, curve.motors) == (1e6, 11)
    assert curve.load_torque == pytest.approx(1e6 / 250.0 / 11.0)
    np.testing.assert_allclose(curve.friction_pressure, -2.0 * BAR)
    np.testing.assert_allclose(curve.friction_torque, -2.0 * BAR * 208.0 * CM3_PER_REV)


def test_where_the_stroke_sets_the_torque_friction_shows_in_the_stroke(crane):
    """At one pressure both ways the difference of the pressures is none, and so was the friction."""
    strokes = {1.0: 130 * CM3_PER_REV, -1.0: 100 * CM3_PER_REV}
    plateaus = [replace(level(s * speed, 200.0), displacement=strokes[s]) for s in strokes for speed in (100.0, 300.0)]
    curve = friction_curve(plateaus, crane)
    np.testing.assert_allclose(curve.friction_torque, 0.5 * 30 * CM3_PER_REV * 200 * BAR)


@pytest.mark.parametrize(
    ("shown", "said"),
    [
        (0.0, r"t: displacement 0 cm\^3/rev from 0 to 5 s while the winch turns: is the feedback dead"),
        (-40.0, r"t: displacement -40 cm\^3/rev from 0 to 5 s"),
        (2.0, r"t: displacement 2 cm\^3/rev from 0 to 5 s"),
        (100.0, r"t: displacements of 100 and 215 cm\^3/rev in one test: give each as its own"),
    ],
)
def test_a_test_without_a_displacement_or_with_several_is_refused(crane, shown, said):
    """Divided by none, or with the mean of all: a traceback, or a model without friction."""
    plateaus = [level(sign * speed) for sign in (1.0, -1.0) for speed in (100.0, 300.0)]
    with pytest.raises(InputError, match=said):
        friction_curve([*plateaus, replace(plateaus[0], displacement=shown * CM3_PER_REV)], crane)


def test_no_test_is_nothing_to_fit():
    with pytest.raises(InputError, match="^friction tests: no test is left to fit$"):
        curve_data([])


def test_friction_while_lowering_is_asked_by_its_magnitude():
    one = np.ones(2)
    point = dict(zip(ORDER, winch_points(np.array([-20.0, 30.0]), 1e7 * one, 3e-5 * one, 1e5 * one, 11), strict=False))
    assert point["speed"].tolist() == [20.0, 30.0]
    assert point["direction"].tolist() == [1.0, 1.0]
    assert point["motor_total"].tolist() == [11.0, 11.0]
