"""What the locked runs bear out: by how much, of which of them, and what a drift is stated by."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import linregress

from winch_friction.discrepancy import proof as module
from winch_friction.discrepancy.engine.chance import Size
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.proof import adds, drift_note, drive_of, leaves_too_much, worse_runs

RUNS, BLOCKS = 8, 100
RUN = np.repeat(np.arange(RUNS), BLOCKS)
SIGN = np.tile([1.0, -1.0], RUNS * BLOCKS // 2)


def side(after, before=None, noise_floor=0.01, least_noise=0.1):
    """Locked runs that keep this of each block."""
    after = np.broadcast_to(after, RUN.shape) * SIGN
    before = after if before is None else np.broadcast_to(before, RUN.shape) * SIGN
    size = float(np.sqrt(np.mean(after**2)))
    blocks = SimpleNamespace(
        run=RUN, segment=RUN * 10 + np.tile(np.arange(BLOCKS), RUNS) // 10, position=np.arange(len(RUN)), y=before
    )
    return SimpleNamespace(
        runs=tuple(SimpleNamespace(name=f"run {k}") for k in range(RUNS)), blocks=blocks, before=before, after=after,
        size_before=Size(float(np.sqrt(np.mean(before**2))), (0.0, 0.0)), size_after=Size(size, (size, size)),
        noise_floor=noise_floor, least_noise=least_noise, floor=float(np.hypot(noise_floor, least_noise)),
    )  # fmt: skip


@pytest.mark.parametrize(("fewer", "worth"), [(0.09, False), (0.3, True)])
def test_a_further_name_takes_more_off_than_a_balance_closes_by(fewer, worth):
    """What is sure in every segment may be less than any balance of a winch can tell."""
    assert adds(side(fewer), side(0.05), np.random.default_rng(0)) is worth


@pytest.mark.parametrize(
    ("refit", "after", "share"),
    [(1.0, 0.5, 0.25), (1.0, 0.9, 0.81), (1.0, 0.12, 0.0), (0.14, 0.12, 0.0), (0.14, 0.135, 0.86), (0.05, 0.2, 3e10)],
)
def test_what_names_leave_is_held_against_what_a_mere_refit_leaves(refit, after, share):
    """Of the square above a floor of 0.1; up to 1.3 times that is noise, of which a share says nothing."""
    found = module.left_beside_a_refit(side(refit), side(after))
    assert found == pytest.approx(share, rel=0.1, abs=1e-9)


@pytest.mark.parametrize(("after", "holds"), [(0.5, True), (0.8, True), (0.9, False), (0.97, False)])
def test_a_name_that_a_mere_refit_nearly_replaces_is_not_proven(monkeypatch, after, holds):
    """It lies surely below the gap of 3 that the given model leaves, and surely below the refit's of 1."""
    refit, repaired = (side(left, before=3.0) for left in (1.0, after))
    for each in (refit, repaired):
        each.size_before = Size(3.0, (2.9, 3.1))
        each.excused = each.floor
    why = module.unproven("wave", refit, repaired, np.random.default_rng(0))
    assert (not why) is holds
    assert ("mere refit leaves" in why) is not holds


@pytest.mark.parametrize(
    ("before", "after", "worse"),
    [
        (0.02, 0.13, False),  # at the floor still
        (0.02, 0.17, True),
        (0.2, 0.235, False),  # by less than a tenth of it and of what no balance closes
        (0.2, 0.26, True),
        (1.0, 1.05, False),
        (1.0, 1.2, True),
    ],
)
def test_a_run_is_worse_where_it_leaves_the_floor_and_what_it_was(before, after, worse):
    kept = np.where(RUN == 3, after, 0.05)
    assert worse_runs(side(kept, np.where(RUN == 3, before, 0.05)), np.random.default_rng(0)) == ("run 3",) * worse


@pytest.mark.parametrize(
    ("runs", "chance", "worse"), [(1, 4e-3, 1), (1, 6e-3, 0), (2, 4e-3, 0), (2, 2.4e-3, 2), (8, 1.9e-3, 8)]
)
def test_of_many_locked_runs_each_must_be_surer_to_be_worse(monkeypatch, runs, chance, worse):
    """One of eight seems worse by chance eight times as often; but no chance is smaller than so many draws can tell."""
    monkeypatch.setattr(module, "chance_of_no_gain", lambda *_: chance)
    own = side(0.3, 0.1)
    own.runs = own.runs[:runs]
    assert len(worse_runs(own, np.random.default_rng(0))) == worse


@pytest.mark.parametrize(("after", "enough"), [(0.19, False), (0.21, True)])
def test_a_large_share_of_a_small_gap_is_no_more_than_twice_the_floor(after, enough):
    """Of 0.22 bar where the floor is 0.1 hardly anything is taken."""
    assert bool(leaves_too_much(side(after, 0.23))) is enough


class Driven(SimpleNamespace):
    drive_torque = PreparedRun.drive_torque


def test_the_drive_of_a_run_is_what_was_measured():
    run = Driven(
        used=np.array([True, True, False]),
        gap=np.array([30.0, 30.0, 1e3]),
        predicted=np.full(3, 100.0),
        unit_torque=2.0,
    )
    assert drive_of(run) == pytest.approx(65.0)


def test_a_drift_is_said_with_the_interval_and_the_chance_of_its_line():
    hours = np.arange(9.0)
    loss = 2.0 * hours + 4.0 * np.array([1.0, -1.0, 0.5, 1.0, -1.5, -1.0, 1.0, 0.0, 0.5])
    runs = [
        Driven(
            start=3600.0 * hour, present=frozenset(), used=np.ones(4, bool), gap=np.zeros(4),
            predicted=np.full(4, 100.0), unit_torque=1.0,
        )
        for hour in hours
    ]  # fmt: skip
    direction = np.tile([1.0, -1.0], 18)
    blocks = SimpleNamespace(run=np.repeat(np.arange(9), 4), direction=direction)
    said = drift_note([SimpleNamespace(runs=runs, blocks=blocks, after=np.repeat(loss, 4) * direction)], [], "bar")
    line = linregress(hours, loss)
    assert 1e-3 < line.pvalue < 0.01
    wanted = f"changes by {8.0 * line.slope:+.3g} ± {8.0 * 1.96 * line.stderr:.2g} bar (95 %, p = {line.pvalue:.1g})"
    assert wanted in said
