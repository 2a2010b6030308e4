"""What the locked runs bear out: by how much, of which of them, and what a drift is stated by."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import linregress

from winch_friction.discrepancy import drift
from winch_friction.discrepancy import proof as module
from winch_friction.discrepancy.drift import drift_note
from winch_friction.discrepancy.engine.chance import Size
from winch_friction.discrepancy.engine.noise import Made
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.proof import adds, drive_of, leaves_too_much, worse_runs
from winch_friction.discrepancy.thresholds import LIMITS

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


@pytest.mark.parametrize(("before", "after", "share"), [(1.0, 0.5, 0.24 / 0.99), (1.0, 0.05, 0.0), (0.5, 0.5, 1.0)])
def test_the_share_that_names_leave_is_one_of_the_square_above_the_floor(before, after, share):
    assert module.share_left(side(after, before, noise_floor=0.06, least_noise=0.08)) == pytest.approx(share)


@pytest.mark.parametrize(
    ("fewer", "nameless", "minor"),
    [
        (0.25, 2.0, True),  # 0.05 of 3.98, above a floor of 0.1
        (0.25, 0.5, False),  # the same, of 0.24
        (0.4, 6.0, False),  # a small part of the whole, but plainly more than the floor
    ],
)
def test_what_a_second_name_takes_is_measured_beside_what_all_of_them_take(fewer, nameless, minor):
    assert module.is_minor(side(nameless), side(fewer), side(0.19)) is minor


@pytest.mark.parametrize(("left", "of_nobody"), [(0.116, True), (0.117, False)])
def test_what_is_nobodys_lies_within_a_third_of_the_floors_square(left, of_nobody):
    """The square root of 1.35 times the floor of 0.1."""
    assert module.nobodys(side(left, noise_floor=0.06, least_noise=0.08)) is of_nobody


@pytest.mark.parametrize(("left", "which"), [(0.9, "training"), (0.9, "locked")])
def test_what_is_left_is_said_of_the_runs_that_it_is_left_of(left, which):
    why = (module.leaves_most if which == "training" else leaves_too_much)(side(left, 1.0, 0.06, 0.08))
    assert why == f"81 % of the {which} gap's square above the noise is left (1 to 0.9)"


def test_names_that_fit_only_their_own_runs_are_said_with_what_is_left_of_either():
    """3 times the floor of these, and a tenth of the others: a floor is none's merit, so it is held against one."""
    why = module.fits_only_its_own(side(0.01, noise_floor=0.06, least_noise=0.08), side(0.3, None, 0.06, 0.08))
    assert why == "fits the runs that it was chosen on (0.01 left) and not the locked ones (0.3 left)"
    assert not module.fits_only_its_own(side(0.2, noise_floor=0.06, least_noise=0.08), side(0.3, None, 0.06, 0.08))


def blocked(run, position, after):
    run, position = np.array(run), np.array(position)
    return SimpleNamespace(
        after=np.array(after, float), blocks=SimpleNamespace(run=run, position=position, segment=10 * run + position)
    )


def test_two_files_are_compared_over_the_blocks_that_both_can_use():
    """Of a run a block's number is its place on the run's own grid, whatever else is usable."""
    first = blocked([0, 0, 1, 1], [0, 2, 0, 3], [1.0, 2.0, 3.0, 4.0])
    second = blocked([0, 0, 1, 1, 1], [1, 2, 0, 2, 3], [5.0, 6.0, 7.0, 8.0, 9.0])
    refit, repaired, segment, run = module._common(first, second)
    assert (refit.tolist(), repaired.tolist()) == ([2.0, 3.0, 4.0], [6.0, 7.0, 9.0])
    assert (segment.tolist(), run.tolist()) == ([2, 10, 13], [0, 1, 1])
    assert [len(each) for each in module._common(first, blocked([2], [0], [1.0]))] == [0, 0, 0, 0]


def test_a_gap_is_related_to_the_drive_by_their_norms():
    assert module._relative(np.array([3.0, 4.0]), np.array([30.0, -40.0])) == pytest.approx(0.1)
    assert module._relative(np.zeros(0), np.zeros(0)) == 0.0


HOURS, EVEN = np.arange(8.0), np.array([1, -1, -1, 1, 1, -1, -1, 1])


def drifting(slope, temperature=(), hours=HOURS, names=()):
    """Hours of runs whose loss along the motion grows by so much of a drive of 100 from the first to the last; every
    second run drives with 50 and the others with 150, and the first alone may have a temperature."""
    loss = 100.0 * slope * (hours - hours[0]) / max(np.ptp(hours), 1.0) + 0.01 * EVEN[: len(hours)]
    runs = [
        Driven(
            start=3600.0 * hour, present=frozenset(temperature if k == 0 else ()), used=np.ones(2, bool),
            gap=np.zeros(2), predicted=np.full(2, 50.0 if k % 2 else 150.0), unit_torque=1.0,
        )
        for k, hour in enumerate(hours)
    ]  # fmt: skip
    direction = np.tile([1.0, -1.0, 0.0, 0.0, 0.0], len(hours))
    blocks = SimpleNamespace(run=np.repeat(np.arange(len(hours)), 5), direction=direction)
    kept = np.repeat(loss, 5) * direction + 50.0 * (direction == 0.0)
    return drift_note([SimpleNamespace(runs=runs, blocks=blocks, after=kept)], names, "bar")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({}, True),
        ({"slope": -0.05}, True),  # it may fall as well
        ({"slope": 0.015}, False),  # less than 2 % of the drive is no one's concern, however sure
        ({"slope": -0.015}, False),
        ({"slope": 0.028}, True),  # of the mean drive, that of five runs of eight or four alike
        ({"temperature": ("oil_temperature",)}, False),
        ({"names": ("wear_drift",)}, False),
        ({"names": ("tare_load",)}, True),
        ({"hours": np.arange(6.0)}, True),
        ({"hours": np.arange(5.0)}, False),
        ({"hours": np.zeros(8)}, False),
    ],
)
def test_a_drift_is_said_of_enough_runs_where_it_matters_and_nothing_tells_it_apart(more, said):
    """Over the blocks that move; what is left at rest is no loss along the motion."""
    assert bool(drifting(**{"slope": 0.05, **more})) is said


def test_a_drift_is_said_per_hour_and_with_its_sign():
    assert drifting(-0.05, hours=3.0 + 2.0 * np.arange(8.0)).startswith("over 14.0 h the loss along the motion changes")
    assert "changes by -5 " in drifting(-0.05, hours=3.0 + 2.0 * np.arange(8.0))


@pytest.mark.parametrize("at", [[0.0, 1.0, 2.0, 3.0], [1.0, 2.0]])
def test_a_gap_after_is_read_at_the_times_of_the_gap_before_and_in_bar_of_its_own_run(monkeypatch, at):
    """A run that a correction of time has shortened has no value outside."""
    monkeypatch.setattr(module, "block_size", lambda _: 1)
    monkeypatch.setattr(module, "timing_column", lambda run: np.full(len(run.time), 30.0))
    old = SimpleNamespace(
        time=np.arange(4.0), start=100.0, used=np.ones(4, bool), gap=np.full(4, 50.0), unit_torque=10.0,
        direction=np.array([1.0, 1.0, -1.0, -1.0]), channels={"load": np.arange(4.0)},
        made=lambda size: Made(size, (4.0,)),
    )  # fmt: skip
    at = np.array(at)
    new = SimpleNamespace(
        time=at - at[0], start=100.0 + at[0], gap=20.0 * at, unit_torque=20.0,
        used_at=lambda when: np.ones(len(when), bool),
    )  # fmt: skip
    found = module._blocks(old, new, 2.0)
    assert found.position.tolist() == at.astype(int).tolist()
    assert found.made == Made(1, (4.0,))
    assert found.y == pytest.approx(np.full(len(at), 5.0))
    assert found.x == pytest.approx(np.column_stack([at, np.full(len(at), 3.0)]))
    assert found.features["load"] == pytest.approx(at)
    assert found.direction == pytest.approx(np.where(at < 2, 1.0, -1.0))


# -- by figures of either side
def test_what_a_name_takes_beside_others_is_the_root_of_what_the_squares_differ_by():
    """From 0.5 to 0.49 that is 0.0995, ten times what the two differ by."""
    fewer = side(0.5)
    assert adds(fewer, side(0.49, least_noise=0.09), np.random.default_rng(0))
    assert not adds(fewer, side(0.49, least_noise=0.11), np.random.default_rng(0))
    assert not adds(side(0.49), side(0.5, least_noise=0.0), np.random.default_rng(0))


def test_a_refit_is_held_against_the_floor_that_the_names_leave():
    """A late signal in a quick sea looks like noise as long as it is there."""
    refit, repaired = side(1.0, noise_floor=0.99), side(0.5, noise_floor=0.06, least_noise=0.08)
    assert module.left_beside_a_refit(refit, repaired) == pytest.approx(0.24 / 0.99)


@pytest.mark.parametrize(
    ("refit", "repaired", "said"),
    [
        ({}, {}, ""),
        ({"noise_floor": 2.0, "least_noise": 9.0}, {}, ""),  # what the refit's own noise is has no say
        ({}, {"noise_floor": 1.2}, "a mere refit of the model leaves the locked runs at their noise"),
        ({}, {"least_noise": 3.0}, "which is less than any balance closes"),
        ({}, {"interval": (0.4, 3.1)}, "the locked gap of 3 does not fall surely (to 0.5)"),
    ],
)
def test_names_are_proven_by_the_noise_and_the_balance_that_they_leave(monkeypatch, refit, repaired, said):
    monkeypatch.setattr(module, "worse_runs", lambda *_: ())
    interval = repaired.pop("interval", (2.9, 3.1))
    fitted, named = side(1.0, before=3.0, **refit), side(0.5, before=3.0, **repaired)
    for each in (fitted, named):
        each.size_before, each.excused = Size(3.0, interval), each.floor
    why = module.unproven("wave", fitted, named, np.random.default_rng(0))
    assert (said in why) if said else why == ""
    if "least_noise" in repaired:
        assert why == "wave takes 3 off the locked gap, which is less than any balance closes"


def test_names_are_refused_where_a_locked_run_grows_or_none_has_a_block(monkeypatch):
    fitted, named = side(1.0, before=3.0), side(0.5, before=3.0)
    for each in (fitted, named):
        each.size_before, each.excused, each.slowest = Size(3.0, (2.9, 3.1)), each.floor, 0.0
    monkeypatch.setattr(module, "worse_runs", lambda own, _: ("run 1", "run 4") if own is named else ("none",))
    assert module.unproven("wave", fitted, named, np.random.default_rng(0)) == "wave: the gap of run 1, run 4 grows"
    monkeypatch.setattr(module, "worse_runs", lambda *_: ())
    named.blocks.y = np.zeros(0)
    assert "no usable block" in module.unproven("wave", fitted, named, np.random.default_rng(0))


@pytest.mark.parametrize(("share", "refused"), [(0.01, True), (-0.01, False)])
def test_most_of_the_training_runs_gap_and_a_part_of_the_locked_ones_may_not_be_left(share, refused):
    for which, most in ((module.leaves_most, LIMITS.outdone), (leaves_too_much, LIMITS.left_over)):
        left = float(np.sqrt(0.01 + (most + share) * (1.0 - 0.01)))
        assert bool(which(side(left, 1.0, 0.06, 0.08))) is refused


def test_two_models_are_compared_over_the_runs_that_were_asked(monkeypatch):
    """Run a has three blocks with noise of 3 and a balance that closes to 1, run c one of 4 and 2."""
    least, noise = {"a": 1.0, "c": 2.0}, {0: 3.0, 1: 4.0}
    blocks = SimpleNamespace(
        run=np.array([0, 0, 0, 1]),
        y=np.array([3.0, 0.0, 0.0, 4.0]),
        x=np.array([[1.0, 9.0], [0, 9], [0, 9], [2.0, 9.0]]), features={},
    )  # fmt: skip
    tables, asked = [], []

    def noise_of(values, skew, _, k, least, made):
        asked.append((values.tolist(), skew.tolist()))
        return noise[k] * (least == k + 1) * (made is None)  # of the slow run as of the quick one

    def blocks_of(old, new, length):
        of = (old.name + old.of, new.name + new.of, length)
        return SimpleNamespace(of=of, made=Made(1, (1.0,)) if old.name == "a" else None)

    monkeypatch.setattr(module, "_blocks", blocks_of)
    monkeypatch.setattr(module, "joined", lambda own, weights: tables.extend(own) or (blocks if weights else None))
    monkeypatch.setattr(module, "segment_length", lambda total: total)
    monkeypatch.setattr(module, "least_noise_of", lambda old: least[old.name])
    monkeypatch.setattr(module, "_noise", noise_of)
    monkeypatch.setattr(module, "drive_of", lambda own: {"a1": 10.0, "c1": 20.0}.get(own.name + own.of, 99.0))
    before, after = (
        SimpleNamespace(prepared=tuple(SimpleNamespace(name=name, of=of, time=np.arange(3.0)) for name in "abc"))
        for of in "12"
    )
    found = module.beside(before, after, ("c", "a"))
    assert [each.of for each in tables] == [
        ("a1", "a2", 4.0),
        ("c1", "c2", 4.0),
    ]  # segments go with all of the runs' time
    assert asked == [([1.0, 0.0, 0.0, 2.0], [9.0] * 4)] * 2  # noise is what the repaired model leaves
    assert [run.name for run in found.runs] == ["a", "c"]
    assert (found.before.tolist(), found.after.tolist()) == ([3.0, 0.0, 0.0, 4.0], [1.0, 0.0, 0.0, 2.0])
    assert found.noise_floor == pytest.approx(np.sqrt((3 * 9.0 + 16.0) / 4.0))
    assert found.least_noise == pytest.approx(np.sqrt((3 * 1.0 + 4.0) / 4.0))
    drive = np.sqrt(3 * 100.0 + 400.0)
    assert found.relative == (pytest.approx(5.0 / drive), pytest.approx(np.sqrt(5.0) / drive))
    assert np.isnan(found.size_before.value)
    assert found.slowest == 0.0
    blocks.features = {"motor_speed": np.array([30.0, 20.0, 10.0, 40.0])}
    monkeypatch.setattr(module, "_of_slowest", lambda values, own: (values.tolist(), own))
    assert module.beside(before, after, ("c", "a")).slowest == ([1.0, 0.0, 0.0, 2.0], blocks)


def test_the_slowest_blocks_are_a_tenth_and_enough_to_tell():
    """Whichever way they move."""
    slow = np.r_[np.linspace(-2.0, -1.0, 100), np.linspace(1.0, 2.0, 100)]
    speed = np.r_[np.linspace(50.0, 60.0, 900), np.linspace(-60.0, -50.0, 900), slow]
    left = np.where(np.abs(speed) < 3.0, 3.0, 1.0)
    assert module._of_slowest(left, SimpleNamespace(features={"motor_speed": speed})) == pytest.approx(3.0)
    more = SimpleNamespace(features={"motor_speed": np.r_[speed, np.full(1000, 99.0)]})  # three hundred then
    own = np.sqrt((200 * 9.0 + 100 * 1.0) / 300)
    assert module._of_slowest(np.r_[left, np.ones(1000)], more) == pytest.approx(own)
    few = SimpleNamespace(features={"motor_speed": speed[-300:-1]})
    assert module._of_slowest(left[-300:-1], few) == pytest.approx(3.0)  # a hundred at least, of twice as many
    assert module._of_slowest(left[-199:], SimpleNamespace(features={"motor_speed": speed[-199:]})) == 0.0
    assert module._of_slowest(left, SimpleNamespace(features={})) == 0.0


def test_noise_is_what_neither_a_late_signal_nor_its_change_leaves(monkeypatch):
    asked = []
    monkeypatch.setattr(module, "noise_of_run", lambda *each: asked.append(each) or 7.0)
    blocks = SimpleNamespace(run=np.array([0, 1, 1, 1]), position=np.array([5, 1, 2, 4]))
    values, skew = np.array([9.0, 1.0, 2.0, 3.0]), np.array([4.0, 0.0, 1.0, 4.0])
    how = Made(1, (1.0,))
    assert module._noise(values, skew, blocks, 1, 0.5, how) == 7.0
    own, position, least, late, made = asked[0]
    assert made is how
    assert (own.tolist(), position.tolist(), least) == ([1.0, 2.0, 3.0], [1, 2, 4], 0.5)
    assert late.tolist() == [[0.0, 1.0], [1.0, 2.0], [4.0, 3.0]]
    assert module._noise(values, skew, blocks, 0, 0.5, how) == 7.0
    assert asked[1][3].tolist() == [4.0]
    assert module._noise(values, skew, blocks, 2, 0.5, how) == 0.0


def test_the_loss_of_a_run_is_the_median_of_what_is_left_along_its_motion():
    runs = (SimpleNamespace(start=5.0), SimpleNamespace(start=7.0), SimpleNamespace(start=9.0))
    blocks = SimpleNamespace(run=np.array([0, 0, 0, 0, 2, 1]), direction=np.array([1.0, -1.0, 1.0, 0.0, -1.0, 0.0]))
    own = SimpleNamespace(
        runs=runs, blocks=blocks, after=np.array([2.0, -3.0, 90.0, 500.0, 4.0, 1.0]), before=np.full(6, 77.0)
    )
    assert drift._losses(own) == [(5.0, 3.0), (9.0, -4.0)]


@pytest.mark.parametrize(
    ("old", "new", "there"),
    [
        ([1, 1, 1, 1], [1, 1, 1, 1], [0, 1, 2, 3]),
        ([1, 0, 1, 1], [1, 1, 1, 1], [0, 2, 3]),
        ([1, 1, 1, 1], [1, 1, 0, 1], [0, 1, 3]),
        ([0, 1, 1, 1], [1, 1, 1, 0], [1, 2]),
    ],
)
def test_a_gap_is_compared_where_either_model_leaves_a_sample_in_the_regime(monkeypatch, old, new, there):
    """The repaired one may prepare a run otherwise: a stroke that is corrected, a delay that is taken out."""
    monkeypatch.setattr(module, "block_size", lambda _: 1)
    monkeypatch.setattr(module, "timing_column", lambda run: np.zeros(len(run.time)))
    first = SimpleNamespace(
        time=np.arange(4.0), start=5.0, used=np.array(old, bool), gap=np.ones(4), unit_torque=1.0,
        direction=np.ones(4), channels={}, made=lambda size: None,
    )  # fmt: skip
    second = SimpleNamespace(
        time=np.arange(4.0), start=5.0, gap=np.ones(4), unit_torque=1.0,
        used_at=lambda when: np.array(new, bool)[(when - 5.0).astype(int)],
    )  # fmt: skip
    assert module._blocks(first, second, 2.0).position.tolist() == there


def left(value, low, high, floor=1.0, excused=1.0):
    return SimpleNamespace(size_after=Size(value, (low, high)), floor=floor, excused=excused)


@pytest.mark.parametrize(
    ("own", "there", "far"),
    [
        (left(1.9, 1.4, 2.5), True, False),  # within its interval
        (left(1.9, 1.6, 2.5), False, False),
        (left(2.1, 1.4, 9.0), False, True),  # a wide interval does not excuse what is plainly more
        (left(1.9, 1.7, 2.5, excused=1.2), True, False),  # zeros within a step are excused
        (left(2.1, 1.4, 2.5, excused=1.5), False, True),  # but twice the floor is twice that of the noise
    ],
)
def test_what_is_left_is_noise_by_the_lower_end_of_its_interval_and_twice_the_floor_at_most(own, there, far):
    assert (bool(module.at_the_floor(own)), bool(module.far_off(own))) == (there, far)


@pytest.mark.parametrize(("chance", "holds"), [(0.024, True), (0.026, False)])
def test_a_proof_is_as_sure_as_one_in_forty(monkeypatch, chance, holds):
    """By the blocks of the refit and of the names, in this order: that the names gain nothing beside the refit."""
    monkeypatch.setattr(module, "worse_runs", lambda *_: ())
    fitted, named = side(1.0, before=3.0), side(0.5, before=3.0)
    for each in (fitted, named):
        each.size_before, each.excused, each.slowest = Size(3.0, (2.9, 3.1)), each.floor, 0.0
    pairs = []
    monkeypatch.setattr(module, "chance_of_no_gain", lambda a, b, *_: pairs.append((abs(a[0]), abs(b[0]))) or chance)
    assert (not module.unproven("wave", fitted, named, np.random.default_rng(0))) is holds
    assert adds(fitted, named, np.random.default_rng(0)) is holds
    assert pairs == [(1.0, 0.5)] * 2


def test_next_to_nothing_beside_a_refit_is_too_little_only_where_the_refit_is_at_its_floor(monkeypatch):
    """From 0.3 to 0.29 that is 0.08 of a balance that closes to 0.25; the refit's own floor is 0.05, or 0.25."""
    monkeypatch.setattr(module, "worse_runs", lambda *_: ())
    monkeypatch.setattr(module, "chance_of_no_gain", lambda *_: 0.0)
    named = side(0.29, before=3.0, noise_floor=0.06, least_noise=0.25)
    for least, holds in ((0.04, True), (0.25, False)):
        fitted = side(0.3, before=3.0, noise_floor=0.03, least_noise=least)
        for each in (fitted, named):
            each.size_before, each.excused, each.slowest = Size(3.0, (2.9, 3.1)), each.floor, 0.0
        assert (not module.unproven("wave", fitted, named, np.random.default_rng(0))) is holds
