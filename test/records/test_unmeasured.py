"""A channel that hangs and samples that jump are missing ones, and what lives is left alone."""

import numpy as np
import pytest

from winch_friction.physics.signals import Run
from winch_friction.records.runs import without_broken

TIME = 0.02 * np.arange(3000)


def log(rng=None, **changed):
    rng = rng or np.random.default_rng(1)
    noise = {name: 2e4 * rng.standard_normal(len(TIME)) for name in ("pressure_a", "pressure_b")}
    columns = {
        "time": TIME, "motor_speed": np.round(50.0 * np.sin(0.1 * TIME), 1),
        "main.pressure_a": 2e7 + 1e6 * np.sign(np.sin(0.1 * TIME)) + noise["pressure_a"],
        "main.pressure_b": 2e6 + noise["pressure_b"], "main.displacement": np.full(len(TIME), 3e-5),
        "hook_load": np.full(len(TIME), 5e4),
    }  # fmt: skip
    for name, (at, values) in changed.items():
        columns[name.replace("__", ".")] = columns[name.replace("__", ".")].copy()
        columns[name.replace("__", ".")][at] = values
    return Run("r.csv", columns)


def mended(run):
    (one,), broken = without_broken([run])
    notes = [each.sentence for each in broken]
    return {name: int(np.isnan(values).sum()) for name, values in one.columns.items() if np.isnan(values).any()}, notes


def test_what_lives_is_left_alone():
    """Steps of friction, a constant setting, a load of one number, a speed that rests on its digits."""
    assert mended(log()) == ({}, [])
    assert mended(log(motor_speed=(slice(500, 560), 45.0))) == ({}, [])


def test_a_pressure_that_stands_still_beside_one_that_lives_was_not_measured():
    held = log(main__pressure_a=(slice(500, 700), 2.1e7))
    assert mended(held) == ({"main.pressure_a": 199}, ["r.csv: main.pressure_a stands still for 3.98 s"])
    short = log(main__pressure_a=(slice(500, 540), 2.1e7))  # 0.8 s: a slow transmitter
    assert mended(short) == ({}, [])


@pytest.mark.parametrize(("until", "lost"), [(1590, 39), (1560, 0), (1565, 0)])
def test_a_pressure_that_leaps_when_it_wakes_stood_still_however_short_it_was(until, lost):
    """A bus that dropped out for 0.8 s kept ten times the noise in one run of a null; a slow transmitter does not leap,
    and what repeats for some samples does so by chance."""
    held = log(main__pressure_a=(slice(1550, until), 2.1e7))  # friction turns over at sample 1571
    if until == 1565:  # within FEWEST samples, and the step is there
        held.columns["main.pressure_a"][1565:] -= 2e6
    notes = ["r.csv: main.pressure_a stands still for 0.78 s"] if lost else []
    assert mended(held) == ({"main.pressure_a": lost} if lost else {}, notes)


@pytest.mark.parametrize(("later", "lost"), [(0, 24), (1, 0)])
def test_what_stands_still_with_another_that_lives_was_not_measured(later, lost):
    """To the sample, as a bus drops out; quiet transducers rest on their digits each for a while of its own."""
    at = slice(500, 525), slice(500 + later, 525)
    held = log(main__pressure_a=(at[0], 2.1e7), main__pressure_b=(at[1], 2e6))
    held.columns["motor_speed"] = 50.0 * np.sin(0.1 * TIME)  # that lives meanwhile
    assert mended(held)[0] == (dict.fromkeys(("main.pressure_a", "main.pressure_b"), lost) if lost else {})


def test_a_log_that_stands_still_as_a_whole_is_no_single_sensor():
    both = log(main__pressure_a=(slice(500, 700), 2.1e7), main__pressure_b=(slice(500, 700), 2e6))
    assert mended(both)[0] == {}
    held = log()
    held.columns["main.pressure_b"] = np.repeat(held["main.pressure_b"][::5], 5)  # a transmitter of 10 Hz
    held.columns["main.pressure_b"][500:600] = held["main.pressure_b"][500]
    assert mended(held) == ({}, [])
    coarse = log()
    coarse.columns["main.pressure_a"] = np.round(coarse["main.pressure_a"], -6)  # a digit of 10 bar
    assert mended(coarse) == ({}, [])


def test_a_pressure_that_leaps_to_zero_and_back_was_not_measured():
    """Of a workboat's port A 0.3 to 1.5 s were zero under load: 25 bar of gap, named by nothing."""
    off = log(main__pressure_a=(slice(500, 530), 0.0))
    assert mended(off) == ({"main.pressure_a": 30}, ["r.csv: main.pressure_a drops to zero for 0.6 s"])
    led = log()
    led.columns["main.pressure_a"][400:700] *= np.abs(np.linspace(-1.0, 1.0, 300)).clip(0.2) - 0.2  # and kept there
    assert mended(led) == ({}, [])
    torque = log(main__pressure_a=(slice(500, 530), 0.0))
    torque.columns["motor_torque"] = torque.columns.pop("main.pressure_a")
    assert mended(torque) == ({}, [])  # a drive that is switched off has none


@pytest.mark.parametrize("value", [0.0, 6.5535e7, -1e6])
def test_single_samples_that_jump_are_lost_telegrams(value):
    lost = log(main__pressure_a=([100, 900, 1700], value), motor_speed=([300], 900.0))
    assert mended(lost) == (
        {"motor_speed": 1, "main.pressure_a": 3},
        ["r.csv: motor_speed jumps in 1 single sample",
         "r.csv: main.pressure_a jumps in 3 single samples"],
    )  # fmt: skip


def test_the_friction_of_a_reversal_is_no_lost_telegram():
    """In a sparse log a ramp's inertia rises to the reversal, where twice the friction is gone within a sample."""
    time = 0.08 * np.arange(1000)
    speed = 60.0 * np.cos(0.5 * time)
    after = np.flatnonzero(np.diff(np.sign(speed)) != 0.0)[1::2] + 1  # from lowering to hoisting
    noise = 2e4 * np.random.default_rng(1).standard_normal((2, len(time)))
    pressure = 2e7 + 1.2e6 * np.sign(speed) + noise[0]
    pressure[after - 1] += 4e6  # the ramp's last sample
    columns = {"time": time, "motor_speed": speed, "main.pressure_a": pressure, "main.pressure_b": 2e6 + noise[1]}
    assert len(after) > 3
    assert mended(Run("r.csv", columns)) == ({}, [])
    columns["main.pressure_a"][after[0] + 30] = 0.0  # away from it one is
    assert mended(Run("r.csv", columns)) == (
        {"main.pressure_a": 1},
        ["r.csv: main.pressure_a jumps in 1 single sample"],
    )


def test_a_winch_that_sticks_and_slips_is_no_lost_telegram():
    """A load of 85 t that creeps down slips ten times a second: at 50 Hz nobody had measured the peaks, it was said."""
    slip = np.round(-10.0 * np.maximum(np.cos(2.0 * np.pi * TIME[:39] / 0.1), 0.0) - 2.0, 1)
    slipping = log(motor_speed=(slice(0, 39), slip))
    assert np.ptp(slip) > 5.0
    assert mended(slipping) == ({}, [])
    near = log(motor_speed=([300, 302, 306], 900.0))  # lost ones beside each other are
    assert mended(near)[0] == {"motor_speed": 3}
    at_ends = log(motor_speed=([1, -2], 900.0))
    assert mended(at_ends)[0] == {"motor_speed": 2}
    among = log(main__pressure_a=([99, 101, 103], np.nan))
    among.columns["main.pressure_a"][102] = 0.0
    assert mended(among)[1] == []  # a value alone between cells without one has no neighbours


def test_what_jumps_in_more_than_one_of_a_hundred_is_how_the_sensor_is():
    assert mended(log(main__pressure_a=(slice(10, None, 50), 0.0)))[0] == {}


def test_a_speed_that_hangs_leaps_when_it_wakes_and_one_that_rests_does_not():
    speed = np.round(50.0 * np.sin(0.1 * TIME), 2)
    hung = log(motor_speed=(slice(0, None), speed))
    hung.columns["motor_speed"][500:700] = speed[500]  # 4 s, in which the winch goes on by 7 rad/s
    assert mended(hung) == ({"motor_speed": 199}, ["r.csv: motor_speed stands still for 3.98 s"])
    gone = log(motor_speed=(slice(0, None), speed))
    gone.columns["motor_speed"][500:700] = 0.0  # read as nothing at full speed
    assert mended(gone)[0] == {"motor_speed": 199}
    held = log(motor_speed=(slice(0, None), np.round(np.clip(speed, -20.0, 20.0), 2)))  # the joystick at its end stop
    assert mended(held) == ({}, [])
    begun = np.where(TIME < 10.0, 0.0, np.round(20.0 - 20.0 * np.cos(TIME - 10.0), 1))
    started = log(motor_speed=(slice(0, None), begun))
    assert mended(started) == ({}, [])


def swell(top, period=5.0, digit=0.15, **more):
    speed = np.round(60.0 * np.sin(2.0 * np.pi / period * TIME) / digit) * digit
    return log(motor_speed=(slice(None), np.clip(speed, -top, top)), **more)


def test_a_speed_that_is_cut_off_at_the_end_of_its_range_was_not_measured():
    """Lifts and heave compensation of a drive that logs no more than 1000 rpm: 13 bar of gap, named by nothing."""
    missing, notes = mended(swell(45.0))
    assert len(notes) == 1
    assert notes[0].startswith("r.csv: motor_speed is cut off at an end of its range for 2")
    assert missing == {"motor_speed": pytest.approx(1400, abs=60)}


def test_the_end_of_a_range_is_the_same_in_every_run():
    lift = np.concatenate([np.zeros(500), 0.1 * np.arange(1250), 0.1 * np.arange(1250)[::-1]])
    noise = 0.15 * np.round(np.random.default_rng(1).standard_normal(3000))
    up = log(motor_speed=(slice(None), np.minimum(lift + noise * (lift > 0.0), 45.0)))
    assert mended(up)[1] == []  # by itself it may have gone so fast
    runs, told = without_broken([up, swell(45.0)])
    assert [each.what.partition(" for ")[0] for each in told] == ["is cut off at an end of its range"] * 2
    assert np.isnan(runs[0]["motor_speed"]).sum() > 1000


@pytest.mark.parametrize("digit", [0.01, 0.15, 0.6, 2.0])
def test_a_crest_that_rests_on_a_coarse_digit_is_no_end_of_a_range(digit):
    assert mended(swell(1e9, digit=digit)) == ({}, [])
    assert mended(swell(1e9, 20.0, digit)) == ({}, [])


def test_a_plateau_is_no_end_of_a_range():
    """An ideal ramp up and down, a speed that is never below zero and rests there, a transmitter that holds."""
    up_and_down = np.clip(200.0 * (np.abs((TIME / 10.0) % 1.0 - 0.5) - 0.25), -45.0, 45.0)
    assert mended(log(motor_speed=(slice(None), np.clip(up_and_down, -10.0, 10.0)))) == ({}, [])
    noise = 0.15 * np.round(np.random.default_rng(2).standard_normal(3000))
    lifts = np.maximum(60.0 * np.sin(1.2 * TIME) + 50.0, 0.0)
    assert mended(log(motor_speed=(slice(None), lifts + noise * (lifts > 1.0)))) == ({}, [])
    held = swell(45.0)
    held.columns["motor_speed"] = np.repeat(held["motor_speed"][::5], 5)
    assert mended(held) == ({}, [])


@pytest.mark.parametrize("rows", [2, 3, 4])
def test_a_run_of_two_rows_is_looked_at_as_any_other(rows):
    """The look for reversals made three of two rows, and `check` and `gap` ended with a traceback."""
    speed = np.array([5.0, -5.0, 5.0, -5.0])[:rows]
    run = Run("short", {"time": 0.1 * np.arange(rows), "motor_speed": speed, "main.pressure_a": 1e5 * speed})
    [found], told = without_broken([run])
    assert not told
    assert np.array_equal(found["motor_speed"], speed)
