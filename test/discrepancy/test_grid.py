"""A run on its grid of time: holes, cells that lack, windows, spikes and lags, each on a few samples."""

import numpy as np
import pytest

from winch_friction.discrepancy import adequacy
from winch_friction.discrepancy.preparation.grid import (
    digit_of,
    dilated,
    lagged,
    noise_level,
    samples_of,
    speed_window,
    spikes_of,
    thinned,
    uniform,
)
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run

DT = 0.02  # s


def test_a_hole_in_a_log_is_no_measurement_and_a_late_sample_is():
    time = DT * np.arange(200.0)
    time[100:] += 3.0
    time[50] += 0.5 * DT
    grid = uniform(Run("r", {"time": time, "motor_speed": np.sin(time)}))
    inside = (grid.time > time[99] + 0.5 * DT) & (grid.time < time[100] - 0.5 * DT)
    outside = (grid.time < time[99] - 0.5 * DT) | (grid.time > time[100] + 0.5 * DT)
    assert not grid.valid[inside].any()
    assert grid.valid[outside].all()
    assert inside.sum() == pytest.approx(3.0 / DT, abs=2)


def test_a_cell_that_lacks_is_bridged_and_not_taken_for_measured():
    values = np.arange(100.0)
    values[40:50] = np.nan
    grid = uniform(Run("r", {"time": DT * np.arange(100.0), "motor_speed": values}))
    assert grid.columns["motor_speed"] == pytest.approx(np.arange(100.0))
    assert not grid.valid[40:50].any()
    assert grid.valid[:40].all()
    assert grid.valid[50:].all()


def test_a_clock_that_leaps_by_days_is_said_and_not_filled_up():
    time = DT * np.arange(100.0)
    time[50:] += 864_000.0
    with pytest.raises(InputError, match=r"leaps by 8.64e\+05 s at 0.98 s"):
        uniform(Run("r", {"time": time, "motor_speed": time}))


def test_the_noise_of_a_record_is_that_of_a_sample_whatever_it_follows():
    rng = np.random.default_rng(0)
    at = np.arange(4000.0)
    values = 30.0 * np.sin(at / 60.0) + np.where(at > 2000, 500.0, 0.0) + 0.4 * rng.standard_normal(4000)
    assert noise_level(values) == pytest.approx(0.4, rel=0.1)


def _of(count, period, name="r"):
    return Run(name, {"time": period * np.arange(count), "motor_speed": np.arange(float(count))})


def test_a_long_and_fast_record_becomes_one_of_eightieths():
    run = _of(60_000 + 4, 1e-3)
    (slow,) = thinned([run])
    assert np.median(np.diff(slow.time)) == pytest.approx(0.012)
    assert slow.columns["motor_speed"][:2] == pytest.approx([5.5, 17.5])
    assert len(slow) == 60_004 // 12  # what fills no mean is left out
    short = _of(60_000 - 1, 1e-3)
    assert thinned([short])[0] is short


@pytest.mark.parametrize(
    ("period", "of"), [(1 / 50, 1), (1 / 159, 1), (1 / 161, 2), (6e-3, 2), (1 / 200, 2), (1 / 250, 3)]
)
def test_many_fast_records_together_are_means_over_an_eightieth_of_a_second_at_most(period, of):
    runs = [_of(30_000, period, f"r{k}") for k in range(10)]
    assert [len(run) for run in thinned(runs)] == [30_000 // of] * 10
    fewer = [*runs[:9], _of(30_000 - 1, period, "r9")]
    assert all(a is b for a, b in zip(thinned(fewer), fewer, strict=True))


def test_among_many_a_slow_record_an_empty_one_and_one_without_a_clock_stay_as_they_are():
    one, none = _of(1, 1e-3, "one"), _of(0, 1e-3, "none")
    back = Run("back", {"time": np.array([0.0, 1e-3, 1e-3]), "motor_speed": np.zeros(3)})
    slow, lost = (
        _of(500, 0.02, "slow"),
        Run("lost", {"time": np.array([0.0, np.nan, 2e-3]), "motor_speed": np.zeros(3)}),
    )
    runs = [_of(300_000, 1e-3, "fast"), slow, one, none, back, lost]
    assert [own is run for own, run in zip(thinned(runs), runs, strict=True)] == [False, True, True, True, True, True]


def test_a_search_reads_many_fast_records_as_their_means(monkeypatch, crane_150t, crane2_model):
    class Read(Exception):
        pass

    def told(runs):
        raise Read([len(run) for run in runs])

    monkeypatch.setattr(adequacy, "long_enough", told)  # the first that reads them
    with pytest.raises(Read) as caught:
        find_gap([_of(30_000, 6e-3, f"r{k:02d}") for k in range(10)], crane_150t, crane2_model)
    assert caught.value.args == ([15_000] * 10,)


@pytest.mark.parametrize(("seconds", "samples"), [(0.3, 15), (0.32, 17), (0.01, 5), (0.1, 5)])
def test_a_window_has_a_middle(seconds, samples):
    assert samples_of(seconds, DT) == samples


def test_a_coarse_encoder_is_smoothed_longer_but_not_for_ever():
    at = DT * np.arange(4000.0)
    clean = 100.0 * np.sin(at)
    coarse = 3.0 * np.round(clean / 3.0)
    awful = clean + 20.0 * np.random.default_rng(0).standard_normal(4000)
    windows = [speed_window(each, DT) * DT for each in (clean, coarse, awful)]
    assert windows[0] == pytest.approx(0.3, abs=DT)
    assert windows[0] < windows[1] <= windows[2]
    assert windows[2] == pytest.approx(3.0 * 0.3, abs=2 * DT)


def test_a_window_is_as_long_as_the_noise_of_its_samples_asks():
    """Steps rarer than every other sample leave no median; four times the samples average as much out in half the
    widening; a winch that stands has nothing to smooth."""
    at = DT * np.arange(4000.0)
    rarely = np.round(2.0 * np.sin(0.1 * at))  # steps of 1 rad/s, one in some hundred samples
    assert speed_window(rarely, DT) * DT > 1.3 * 0.3
    noisy = 100.0 * np.sin(at) + 0.8 * np.random.default_rng(1).standard_normal(4000)
    assert speed_window(noisy, DT) * DT == pytest.approx(2.52 * 0.3, rel=0.05)
    assert speed_window(noisy, DT / 4.0) * DT / 4.0 == pytest.approx(1.587 * 0.3, rel=0.05)
    assert speed_window(np.zeros(4000), DT) * DT == pytest.approx(0.3, abs=DT)
    assert speed_window(np.array([1.0, 2.0]), DT) * DT == pytest.approx(0.3, abs=DT)


# -- spikes
def spiky(*places, rest=0):
    gap = np.random.default_rng(0).standard_normal(2000)
    gap[list(places)] += 80.0
    moving = np.ones(2000, bool)
    moving[:rest] = False
    return np.flatnonzero(spikes_of(gap, moving, DT))


def test_a_spike_is_left_out_with_its_surroundings():
    margin = int(0.1 / DT)
    assert spiky(700).tolist() == list(range(700 - margin, 700 + margin + 1))


def test_what_is_there_often_is_no_spike():
    assert not spiky(*range(50, 2000, 60)).size


def test_a_spike_while_the_winch_rests_is_nobodys():
    assert not spiky(100, rest=200).size


def test_a_lag_begins_settled():
    """A winch at work has a memory from before the log."""
    found = lagged(np.array([5.0, 5.0, 5.0, 6.0]), 0.5, 2.0)
    assert found == pytest.approx([5.0, 5.0, 5.0, 5.0 + 1.0 - np.exp(-0.25)])


def test_a_margin_wider_than_the_record_covers_it_and_no_more():
    mask = np.array([False, True, False, False])
    assert dilated(mask, 1).tolist() == [True, True, True, False]
    assert dilated(mask, 6).tolist() == [True] * 4


def test_the_digit_of_a_coarse_transducer_is_told_and_none_of_a_fine_one():
    """Pa: ten bits over 400 bar step by 0.39 bar, and a channel held over three samples repeats as often."""
    rng = np.random.default_rng(4)
    fine = 2e7 + 4e6 * np.sin(DT * np.arange(4000)) + rng.normal(0.0, 3e4, 4000)
    step = 4e7 / 1024
    assert digit_of(np.round(fine / step) * step) == pytest.approx(step)
    assert digit_of(fine) == 0.0
    assert digit_of(np.repeat(fine, 3)) < 1e3
    assert digit_of(np.round(fine[:200] / step) * step) == 0.0  # too few values to tell chance from a digit
