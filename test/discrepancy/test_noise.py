"""The noise of a slow log, whose blocks share samples and whose sensors may be slower than a sample."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from winch_friction.discrepancy.engine import noise as module
from winch_friction.discrepancy.engine.noise import Made, noise_of_run, seen_of
from winch_friction.discrepancy.preparation.grid import smooth
from winch_friction.discrepancy.preparation.prepare import PreparedRun

AFTER_SIMPSON = (1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0)
WHITE = Made(1, (1.0,))  # blocks that share no samples


def of(correlation, count, seed=1):
    white = np.random.default_rng(seed).standard_normal(count + 50)
    return lfilter([np.sqrt(1.0 - correlation**2)], [1.0, -correlation], white)[50:]


def noise_of(values, made=None):
    return noise_of_run(values, np.arange(len(values)), made=made)


def made_of(dt, size, window=3):
    return PreparedRun.made(SimpleNamespace(dt=dt, window=window), size)


@pytest.mark.parametrize("window", [3, 5])
@pytest.mark.parametrize("correlation", [0.0, 0.3, 0.51])
def test_the_noise_of_a_slow_log_is_told_whole(correlation, window):
    """A pressure with a filter of 0.3 s, logged every 0.2 s, has 0.51 from sample to sample; taken for white a half of
    what is left of it behind both means was lost, and a quarter of a white one."""
    values = 0.3 * np.convolve(smooth(of(correlation, 12_000), window), AFTER_SIMPSON, "valid")
    assert noise_of(values, made_of(0.2, 1, window)) == pytest.approx(np.std(values), rel=0.1)
    assert noise_of(values) < 0.86 * np.std(values)


def test_so_it_is_of_two_samples_to_a_block():
    values = np.convolve(of(0.3, 24_002), AFTER_SIMPSON, "valid").reshape(-1, 2).mean(axis=1)
    assert noise_of(values, made_of(0.1, 2)) == pytest.approx(np.std(values), rel=0.05)


def test_a_quicker_log_is_left_as_it_was():
    assert made_of(0.055, 4) is None
    assert made_of(0.056, 4).samples == 4


def test_white_blocks_are_told_to_be_hardly_noisier_than_they_are():
    """Of forty short runs: chance alone makes neighbours go together by a little in a half of them."""
    told = [noise_of(of(0.0, 300, seed), WHITE) for seed in range(40)]
    assert 0.95 < np.median(told) < 1.08
    assert max(told) < 1.4


def test_blocks_of_which_nobody_says_how_they_are_made_are_white():
    assert seen_of(np.ones((40, 12)), None) == 1.0


def test_how_a_block_is_made_adds_up_to_a_mean():
    assert made_of(0.2, 1).weights == pytest.approx(
        (0.0, *AFTER_SIMPSON, 0.0)
    )  # three samples are no parabola's to smooth
    assert len(made_of(0.1, 2, 5).weights) == 8
    assert sum(made_of(0.1, 2, 5).weights) == pytest.approx(1.0)


def test_what_an_effect_does_in_a_sixth_of_the_time_is_no_colour():
    """After every other reversal it makes a hump; the quiet windows tell."""
    count = 6000
    noise = np.convolve(of(0.0, count + 2), AFTER_SIMPSON, "valid")
    humps = np.where(np.arange(count) % 120 < 20, 6.0 * np.sin(np.arange(count) / 2.0), 0.0)
    assert noise_of(noise + humps, made_of(0.2, 1)) == pytest.approx(np.std(noise), rel=0.15)


def test_few_windows_tell_the_weights_share_alone():
    projector = np.eye(12) - 1.0 / 12.0
    values = np.convolve(of(0.55, 400), AFTER_SIMPSON, "valid")
    many = np.lib.stride_tricks.sliding_window_view(values, 12)[::6] @ projector
    few = many[: module.FEWEST_WINDOWS - 1]
    assert seen_of(many, made_of(0.2, 1)) < seen_of(few, made_of(0.2, 1)) < 1.0
    assert seen_of(few, WHITE) == pytest.approx(1.0, abs=0.01)


def test_short_runs_tell_together_how_their_noise_goes_on():
    """Forty seconds each, one of them twice as loud: alone each would tell another colour, and weigh by chance."""
    runs = [size * of(0.5, 200, seed) for seed, size in enumerate((0.3, 0.3, 0.6, 0.3, 0.3, 0.3, 0.3, 0.3))]
    made = [WHITE] * len(runs)
    at = [np.arange(200)] * len(runs)
    together = module.noise_of_runs(runs, at, [0.1] * len(runs), [None] * len(runs), made)
    alone = [noise_of(run, made[0]) for run in runs]
    white = np.array([noise_of(run) for run in runs])
    assert np.ptp(white / together) == pytest.approx(0.0, abs=1e-9)
    assert np.ptp(white / alone) > 0.05
    assert np.median(together) == pytest.approx(0.3, rel=0.1)
    assert together[2] > 1.5 * together[1]


def test_a_log_of_another_rate_has_its_own_colour():
    slow, quick = np.convolve(of(0.0, 3002), AFTER_SIMPSON, "valid"), of(0.0, 3000, 2)
    found = module.noise_of_runs([slow, quick], [np.arange(3000)] * 2, [0.1] * 2, [None] * 2, [made_of(0.2, 1), WHITE])
    assert found == pytest.approx([np.std(slow), np.std(quick)], rel=0.06)


def test_where_one_run_is_quick_the_noise_of_all_is_told_alike():
    """The worm drive logs a creeping speed at 4 Hz and quick ones at 20 and more: told whole, the creeping ones counted
    a fifth, and the curve that shows in them was no rival any more."""
    slow, quick = of(0.5, 3000), of(0.5, 3000, 2)
    at, made = [np.arange(3000)] * 2, [made_of(0.2, 1), made_of(0.05, 4)]
    found = module.noise_of_runs([slow, quick], at, [0.1] * 2, [None] * 2, made)
    assert found == [noise_of(slow), noise_of(quick)]
    assert module.alike(made) == [None, None]
    assert module.alike(made[:1]) == made[:1]


def test_a_loud_runs_quiet_windows_are_heard_beside_a_quiet_run():
    """A still run of white noise, a tenth as loud, has all of the quieter half of the windows."""
    runs = [0.03 * of(0.0, 800), *(0.3 * of(0.55, 200, seed) for seed in range(2, 10))]
    made = [WHITE] * len(runs)
    at = [np.arange(len(run)) for run in runs]
    together = module.noise_of_runs(runs, at, [0.01] * len(runs), [None] * len(runs), made)
    assert noise_of(runs[1]) / together[1] < 0.91
