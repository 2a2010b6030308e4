"""What is believed: how far the gate opens and when, and what an outlier may do to the noise."""

import math
import time

import pytest
from scipy.stats import chi2

from winch_friction.estimation import EstimatorConfig
from winch_friction.estimation.trust import (
    RESTART_AFTER,
    WIDE_FOR,
    Consistency,
    InnovationGate,
    VarianceFactor,
    nis_band,
)

CONFIG = EstimatorConfig(gate=5.0)


def shut_out(gate: InnovationGate) -> None:
    for _ in range(RESTART_AFTER):
        gate.rejected(20.0)


def test_the_gate_is_wide_for_a_while_after_it_shut_out_a_run_of_samples():
    gate = InnovationGate(CONFIG)
    assert not gate.admits(10.0, 6.0, 1.0)
    shut_out(gate)
    assert gate.exhausted
    gate.restarted(10.0)
    assert not gate.exhausted
    assert gate.admits(10.0 + 0.9 * WIDE_FOR, 6.0, 1.0)
    assert not gate.admits(10.0 + 0.9 * WIDE_FOR, 16.0, 1.0)
    assert not gate.admits(10.0 + 1.1 * WIDE_FOR, 6.0, 1.0)


def test_a_clock_that_is_set_back_does_not_open_the_gate():
    gate = InnovationGate(CONFIG)
    shut_out(gate)
    gate.restarted(10.0)
    assert not gate.admits(9.9, 6.0, 1.0)


@pytest.mark.parametrize(("passed", "again"), [(1, True), (RESTART_AFTER - 1, True), (RESTART_AFTER, False)])
def test_one_sample_that_passes_is_no_run_of_them(passed, again):
    """Taken anew, the speed may be so unsure that one of them is believed: the gate shut out as before."""
    gate = InnovationGate(CONFIG)
    shut_out(gate)
    gate.restarted(10.0)
    for _ in range(passed):
        gate.accepted()
    shut_out(gate)
    assert gate.exhausted_again is again


def test_a_gap_without_rejections_leaves_the_gate_as_it_was():
    gate = InnovationGate(CONFIG)
    gate.restarted(10.0)
    assert not gate.admits(10.1, 6.0, 1.0)


def test_samples_without_an_innovation_shut_out_nothing():
    gate = InnovationGate(CONFIG)
    for _ in range(2 * RESTART_AFTER):
        gate.rejected(math.nan)
    assert not gate.exhausted


def test_one_sample_far_off_moves_the_noise_as_one_at_three_sigma():
    far, near = VarianceFactor(5.0), VarianceFactor(5.0)
    far.step(1e4, 0.02)
    near.step(9.0, 0.02)
    assert far.value == near.value == pytest.approx(1.0 + 8.0 * 0.02 / 5.0)


def test_no_step_waits_for_the_band_of_the_largest_window():
    """A second's work stood in the step that closed the first window: the speed was lost over it."""
    largest = 100_000
    consistency = Consistency(largest)
    longest = 0.0
    for _ in range(largest):
        began = time.thread_time()
        consistency.step(1.0)
        longest = max(longest, time.thread_time() - began)
    assert consistency.windows == consistency.inside == 1
    assert longest < 0.05
    assert nis_band(largest) == pytest.approx([chi2.ppf(each, largest) / largest for each in (0.025, 0.975)], rel=1e-9)


@pytest.mark.parametrize(("nis", "limit"), [(0.0, 0.05), (9.0, 100.0), (1e6, 100.0)])
def test_the_noise_is_taken_for_wrong_by_a_factor_of_tens_at_most(nis, limit):
    factor = VarianceFactor(1.0)
    for _ in range(200):
        factor.step(nis, 0.2)
    assert factor.value == limit


def test_each_window_has_its_own_mean_and_counts_where_it_is_inside_both_ends_of_the_band():
    each = Consistency(50)
    lower, upper = nis_band(50)
    assert (each.share_inside, each.last_mean, each.windows) == (1.0, 1.0, 0)
    means = (0.9 * lower, 1.01 * lower, 1.0, 0.99 * upper, 1.1 * upper, 1.0)
    for mean, inside in zip(means, (0, 1, 2, 3, 3, 4), strict=True):
        for k in range(50):
            each.step(mean + (0.1 if k % 2 else -0.1))
        assert each.last_mean == pytest.approx(mean)
        assert each.inside == inside
    assert each.windows == 6
    assert each.share_inside == pytest.approx(4.0 / 6.0)


def test_samples_that_pass_between_rejected_ones_are_no_run_of_them():
    gate = InnovationGate(CONFIG)
    shut_out(gate)
    gate.restarted(10.0)
    for _ in range(3):
        for _ in range(RESTART_AFTER - 1):
            gate.accepted()
        gate.rejected(20.0)
    shut_out(gate)
    assert gate.exhausted_again
