"""What may be chance: few runs and many, rivals, how often one wins, and what a signal predicts of what is left."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.engine import chance
from winch_friction.discrepancy.engine.blocks import Blocks, Slot, grams
from winch_friction.discrepancy.engine.chance import (
    _closest,
    _designs,
    _frequency,
    _near_curve,
    chance_of_no_gain,
    dependences,
    does_as_well,
    least_part,
    near,
    rivals_of,
    rms,
    rms_with_interval,
    sign_flip_p_value,
)
from winch_friction.discrepancy.engine.crossfit import Explanation
from winch_friction.discrepancy.thresholds import LIMITS

RUNS, BLOCKS = 8, 60
RUN = np.repeat(np.arange(RUNS), BLOCKS)
SEGMENT = 2 * RUN + np.tile(np.arange(BLOCKS) >= BLOCKS // 2, RUNS)
SIGN = np.tile([1.0, -1.0], RUNS * BLOCKS // 2)


def loses(slot, losses):
    return Explanation((slot,), np.asarray(losses, float), np.zeros(0), 0.0, np.zeros((0, 0)))


@pytest.mark.parametrize(("runs", "wide"), [(3, False), (RUNS, True)])
def test_runs_are_redrawn_only_where_there_are_many(runs, wide):
    """Three that are unlike by plan say nothing of what a fourth would be."""
    run = np.repeat(np.arange(runs), BLOCKS)
    size = rms_with_interval(1.0 + run, np.arange(len(run)) // 10, run, np.random.default_rng(0))
    assert (size.interval[1] - size.interval[0] > 0.1 * size.value) is wide
    assert size.interval[0] <= size.value <= size.interval[1]


def test_no_chance_is_smaller_than_so_many_draws_can_tell():
    zero = np.zeros(RUNS * BLOCKS)
    chance = chance_of_no_gain(zero + 5.0, zero, SEGMENT, RUN, np.random.default_rng(0))
    assert chance == pytest.approx(1.0 / (1.0 + LIMITS.bootstrap_draws))


@pytest.mark.parametrize(("own", "share"), [([1.0, 1.0], 0.0), ([0.1, 0.1], 1.0)])
def test_an_effect_wins_where_it_leaves_less_than_the_best_of_the_others(own, share):
    others = [np.array([0.5, 0.5]), np.array([2.0, 2.0])]
    assert _frequency(np.array(own), others, np.random.default_rng(0)) == share


@pytest.mark.parametrize(("same", "more", "rival"), [(False, 0.01, True), (True, 0.01, False), (True, 1e-4, True)])
def test_beside_a_higher_order_only_the_same_column_is_another_name(same, more, rival):
    """A hundredth behind does as well for any purpose, but what is left of a level beside its slope is small."""
    own, other = Slot("level", "", (1,)), Slot("tare", "", (2,))
    left = {None: 3.0, "level": 1.0, "tare": 1.0 + 2.0 * more}

    def explain(slots):
        name = slots[0].name if slots else None
        return replace(loses(own, np.full(40, left[name])), slots=tuple(slots))

    cross = SimpleNamespace(
        explain=explain, floor=40.0, fit_beside=lambda *_: None, train_loss=lambda slots: (explain(slots).loss, None),
        problem=SimpleNamespace(slots=(own, other), grams=SimpleNamespace(count=np.ones(40))),
    )  # fmt: skip
    found, _ = rivals_of(cross, explain((own,)), explain(()), 0, np.random.default_rng(0), same)
    assert (found == (other,)) is rival


@pytest.mark.parametrize("less", [1e-9, -1e-9])
def test_of_rivals_that_are_one_over_the_runs_the_first_listed_comes_first(less):
    """A set has room for few: a brake's drag is Coulomb friction as well, and rounding cut it out of its own set."""
    own, brake, coulomb = Slot("stribeck", "", (1,)), Slot("brake", "", (2,)), Slot("coulomb", "", (3,))
    left = {None: 3.0, own: 1.0, brake: 1.001, coulomb: 1.001 * (1.0 - less)}

    def explain(slots):
        return replace(loses(own, np.full(40, left[slots[0] if slots else None])), slots=tuple(slots))

    cross = SimpleNamespace(
        explain=explain, floor=40.0, fit_beside=lambda *_: None, train_loss=lambda slots: (explain(slots).loss, None),
        problem=SimpleNamespace(slots=(own, brake, coulomb), grams=SimpleNamespace(count=np.ones(40))),
    )  # fmt: skip
    found, _ = rivals_of(cross, explain((own,)), explain(()), 0, np.random.default_rng(0))
    assert found == (brake, coulomb)


@pytest.mark.parametrize(("free", "near_it"), [(False, True), (True, False)])
def test_a_curve_of_another_cause_is_measured_like_any_law(free, near_it):
    """It bends as freely as the curve that was found: leaving more, it is no rival for its stiffness."""
    own, other = Slot("wear", "", (1,), free=True), Slot("oil", "", (2,), free=free)
    current, trial, without = (loses(s, np.full(40, x)) for s, x in ((own, 2.0), (other, 2.5), (own, 30.0)))
    assert _near_curve(SimpleNamespace(floor=40.0), trial, current, without, 0) is near_it


def remainder(features, weight=1.0, unresolved=0.0):
    """Blocks with these signals, each run a fold, in units of the noise."""
    zero = np.zeros(RUNS * BLOCKS)
    blocks = Blocks(zero, zero[:, None], RUN, SEGMENT, zero + weight, features, SIGN, np.tile(np.arange(BLOCKS), RUNS))
    return SimpleNamespace(
        problem=SimpleNamespace(blocks=blocks, grams=grams(blocks)), fold_of_block=RUN, unresolved=unresolved
    )


def noise(seed=0):
    return np.random.default_rng(seed).standard_normal(RUNS * BLOCKS)


def told(cross, left):
    (found,) = dependences(cross, left, np.random.default_rng(0))
    return found


def test_a_signal_of_which_each_run_has_one_value_predicts_the_others_by_a_line():
    """No run says what hats between the others' values are."""
    found = told(remainder({"oil_temperature": 1.0 * RUN}), 3.0 * (RUN - 3.5) + noise())
    assert found.share > 0.9
    assert found.p_value < 0.01


def test_what_matters_to_nobody_is_a_part_of_what_is_left():
    speed = np.tile(np.linspace(-1.0, 1.0, BLOCKS), RUNS)
    left = 3.0 * speed + noise()
    whole = told(remainder({"speed": speed}), left)
    half = told(remainder({"speed": speed}, unresolved=float(left @ left)), left)
    assert half.share == pytest.approx(0.5 * whole.share)


def test_what_a_signal_predicts_does_not_hang_on_the_gaps_unit():
    speed = np.tile(np.linspace(-1.0, 1.0, BLOCKS), RUNS)
    bar, torque = (told(remainder({"speed": speed}, weight), 3.0 * speed**2 + noise()) for weight in (1.0, 0.02))
    assert torque.share == pytest.approx(bar.share)
    assert torque.size == pytest.approx(50.0 * bar.size)


# -- what stands in for what was found
A, B, CURVE, PLAIN = (
    Slot("found", "", (1,)), Slot("other", "", (2,)), Slot("other", "", (3,), law="curve", free=True),
    Slot("coulomb", "", (4,), plain=True),
)  # fmt: skip


def crossed(left, slots, floor=0.0):
    """A cross-fit that leaves so much of each set of slots."""

    def explain(own):
        loss = left[tuple(own)]
        return replace(loses(A, np.full(40, loss / 40.0)), slots=tuple(own))

    return SimpleNamespace(
        explain=explain, fit_beside=lambda *_: None, train_loss=lambda own: (left[tuple(own)], None), floor=floor,
        excess=lambda found: found.loss - floor,
        problem=SimpleNamespace(slots=slots, grams=SimpleNamespace(count=np.ones(1))),
    )  # fmt: skip


def test_of_causes_that_a_curve_may_be_each_has_the_law_that_leaves_least():
    """Found is a curve: of the other cause its own curve is as good, although a law speaks for it."""
    law = replace(B, law="law")
    found = [loses(law, [2.0]), loses(CURVE, [1.0]), loses(A, [3.0])]
    assert [each.slots[-1] for each in _closest(found)] == [CURVE, A]


@pytest.mark.parametrize(("loss", "close"), [(54.0, ["other"]), (56.0, [])])
def test_what_takes_half_of_what_an_effect_takes_is_looked_at_closer(loss, close):
    cross = crossed({(): 100.0, (A,): 10.0, (B,): loss}, (A, B))
    assert [slot.name for slot in near(cross, cross.explain((A,)))] == close


def test_nothing_stands_in_for_what_every_machine_has():
    """It comes first anyhow."""
    cross = crossed({(): 100.0, (PLAIN,): 10.0, (B,): 12.0}, (PLAIN, B))
    assert near(cross, cross.explain((PLAIN,))) == []


def test_a_law_that_takes_little_is_not_near_a_curve_however_small_the_gap_is():
    """It leaves less than twice what the curve does, but of 3 above the floor it takes hardly a third of the 2.9."""
    curve = replace(A, free=True)
    cross = crossed({}, (), floor=0.0)
    current, without = loses(curve, [2.0]), loses(curve, [3.0])
    assert _near_curve(cross, loses(B, [2.4]), current, without, 0)
    assert not _near_curve(cross, loses(B, [2.6]), current, without, 0)


def test_the_least_needed_of_several_names_is_what_is_asked_for():
    """Of 90 that both save, 60 are lost without the one and 9 without the other."""
    cross = crossed({(): 100.0, (A, B): 10.0, (A,): 19.0, (B,): 70.0}, (A, B))
    assert least_part(cross, cross.explain((A, B)), ("found", "other")) == pytest.approx(0.1)


def test_where_a_signal_is_absent_it_predicts_nothing():
    """Half of the runs have no temperature: what they keep is not what a missing one says."""
    degrees = np.where(RUN < 4, np.sin(np.arange(RUNS * BLOCKS) / 7.0), np.nan)
    for design in _designs(degrees, SIGN):
        assert not design[RUN >= 4].any()
        assert design[RUN < 4].any()


DELAYED, OTHER = Slot("signal_delay", "late", (0,)), Slot("inertia_error", "", (1,))


@pytest.mark.parametrize(
    ("losses", "excess", "most"),
    [
        ((50.0, 90.0), 10.0, DELAYED),
        ((75.0, 90.0), 10.0, None),  # too little of it
        ((50.0, 40.0), 10.0, OTHER),
        ((50.0, 90.0), 0.1, None),  # nothing is missing
    ],
)
def test_what_takes_most_is_looked_at_closer_though_it_is_not_sure(monkeypatch, losses, excess, most):
    """Of 100 above a floor of 10 a third is asked for."""
    trials = [SimpleNamespace(slots=(slot,), loss=loss) for slot, loss in zip((DELAYED, OTHER), losses, strict=True)]
    monkeypatch.setattr(chance, "candidate_trials", lambda *_: trials)
    cross = SimpleNamespace(excess=lambda _: excess, floor=10.0)
    assert chance.most_of_it(cross, SimpleNamespace(slots=(), loss=100.0)) is most


# -- figures of their own
def test_a_size_is_a_root_mean_square_over_blocks_however_many_a_segment_has():
    values, segment = np.array([3.0, -3.0, 3.0, 5.0]), np.array([0, 0, 0, 1])
    whole = np.sqrt((27.0 + 25.0) / 4.0)
    assert rms(values) == pytest.approx(whole)
    assert rms(values[:0]) == 0.0
    size = rms_with_interval(values, segment, np.zeros(4, int), np.random.default_rng(0))
    assert size.value == pytest.approx(whole)
    assert size.interval == pytest.approx((3.0, 5.0))  # either segment twice
    nothing = rms_with_interval(values[:0], segment[:0], segment[:0], np.random.default_rng(0))
    assert (nothing.value, nothing.interval) == (0.0, (0.0, 0.0))


@pytest.mark.parametrize(("before", "after", "chance"), [(1.0, 2.0, 1.0), (1.0, 1.0, 1.0), (2.0, 1.0, 0.0)])
def test_a_gain_is_a_square_that_falls_from_before_to_after(before, after, chance):
    found = chance_of_no_gain(
        np.full(len(RUN), before), np.full(len(RUN), -after), SEGMENT, RUN, np.random.default_rng(0)
    )
    assert found == pytest.approx(chance, abs=2e-3)


def test_nothing_is_no_gain():
    assert chance_of_no_gain(np.zeros(0), np.zeros(0), SEGMENT[:0], RUN[:0], np.random.default_rng(0)) == 1.0


@pytest.mark.parametrize(
    ("gains", "low", "high"),
    [
        (np.ones(20), 1.0 / (1.0 + LIMITS.flips), 1e-3),  # no less than so many flips can tell
        (-np.ones(20), 1.0, 1.0),
        (np.tile([1.0, -1.0], 10), 0.5, 0.65),  # as often as not, ties included
        (np.ones(3), 0.1, 0.15),  # of three, all with the same sign, one in eight
    ],
)
def test_a_sign_flips_chance_is_that_of_a_mean_above_nothing(gains, low, high):
    assert low <= sign_flip_p_value(gains) <= high


@pytest.mark.parametrize(
    ("trial", "does"),
    [
        (10.0, True),
        (12.66, True),  # within 3 % of the 90 that the effect saves, however sure
        (13.0, False),
        (60.0, False),
        (8.0, True),
    ],
)
def test_a_rival_that_is_surely_worse_does_as_well_within_a_small_share_of_what_is_saved(trial, does):
    own, without, other = (loses(A, np.full(40, loss / 40.0)) for loss in (10.0, 100.0, trial))
    assert does_as_well(other, own, without, np.random.default_rng(0)) is does


def test_a_rival_that_is_not_surely_worse_saves_half_of_what_an_effect_saves():
    rng = np.random.default_rng(0)
    own, without = loses(A, np.full(40, 0.25)), loses(A, np.full(40, 2.5))
    scattered = np.full(40, 0.25)
    scattered[:2] += [20.0, -3.0]  # 17 of 90 behind, in one segment
    assert does_as_well(loses(B, scattered), own, without, rng)
    scattered[0] += 30.0  # 47 of 90
    assert not does_as_well(loses(B, scattered), own, without, rng)


def test_what_a_signal_predicts_has_the_size_of_its_wave():
    """A straight line over the speed, hoisting and lowering apart: one for friction, one for what is lost one way."""
    speed = np.tile(np.linspace(-1.0, 1.0, BLOCKS), RUNS)
    wave = 4.0 * speed
    found = told(remainder({"speed": speed}, 0.5), wave + 0.1 * noise())
    assert found.size == pytest.approx(2.0 * rms(wave), rel=0.1)
    assert found.share == pytest.approx(1.0, abs=0.1)
    assert found.signal == "speed"


def test_the_least_needed_of_three_is_what_the_whole_lacks_least_without():
    third = Slot("third", "", (4,))
    cross = crossed({(): 100.0, (A, B, third): 10.0, (B, third): 40.0, (A, third): 37.0, (A, B): 55.0}, (A, B, third))
    names = ("found", "other", "third")
    assert least_part(cross, cross.explain((A, B, third)), names) == pytest.approx(0.3)
    assert least_part(cross, cross.explain((A, B, third)), names[:1]) == pytest.approx(1.0 / 3.0)


def test_rivals_stand_by_what_they_leave_each_cause_once(monkeypatch):
    """Found is a curve: of another cause both the law that speaks for it and its own curve would do."""
    own = replace(A, free=True)
    slots = (replace(B, law="law"), replace(B, law="curve", free=True), Slot("third", "", (5,)), Slot("bad", "", (6,)))
    losses = dict(zip(slots, (20.0, 19.0, 15.0, 200.0), strict=True))
    cross = crossed({(): 100.0, (own,): 14.9, **{(slot,): loss for slot, loss in losses.items()}}, slots)
    monkeypatch.setattr(chance, "does_as_well", lambda trial, *_: trial.loss < 100.0)
    found, _ = rivals_of(cross, cross.explain((own,)), cross.explain(()), 0, np.random.default_rng(0))
    assert [(slot.name, slot.law) for slot in found] == [("third", ""), ("other", "law")]
    monkeypatch.setattr(chance, "heads", lambda cross, before, trials: list(trials))
    again, _ = rivals_of(cross, cross.explain((own,)), cross.explain(()), 0, np.random.default_rng(0))
    assert [slot.name for slot in again] == ["third", "other"]


@pytest.mark.parametrize("same", [True, False])
def test_beside_a_higher_order_nobody_asks_how_often_an_effect_wins(same):
    """Another column leaves less in every segment: it would win always."""
    cross = crossed({(): 100.0, (A,): 10.0, (B,): 9.0}, (A, B))
    _, frequency = rivals_of(cross, cross.explain((A,)), cross.explain(()), 0, np.random.default_rng(0), same)
    assert frequency == (1.0 if same else 0.0)


def test_the_four_that_leave_least_are_looked_at_closer():
    others = [Slot(f"no {k}", "", (k,)) for k in range(1, 7)]
    losses = dict(zip(others, (30.0, 15.0, 25.0, 12.0, 20.0, 60.0), strict=True))
    cross = crossed({(): 100.0, (A,): 10.0, **{(slot,): loss for slot, loss in losses.items()}}, (A, *others))
    assert [slot.name for slot in near(cross, cross.explain((A,)))] == ["no 4", "no 2", "no 5", "no 3"]


def test_other_laws_of_the_same_cause_are_looked_at_closer_and_its_curves_are_not():
    """A grid of octaves may lie well for one law and badly for the true one: a Gauss curve at 23 rad/s, of which 16 and
    32 were asked, left more than a Lorentz curve, and was never asked between them."""
    laws = [replace(A, law=f"law {k}", columns=(k,)) for k in range(1, 7)]
    curve = replace(A, law="curve", columns=(7,), free=True)
    losses = dict(zip([*laws, curve], (30.0, 15.0, 60.0, 12.0, 20.0, 25.0, 11.0), strict=True))
    cross = crossed({(): 100.0, (A,): 10.0, (B,): 40.0, **{(law,): n for law, n in losses.items()}}, (A, B, *losses))
    closer = [(slot.name, slot.law) for slot in near(cross, cross.explain((A,)))]
    assert closer == [(A.name, f"law {k}") for k in (4, 2, 5, 6)] + [(B.name, B.law)]


@pytest.mark.parametrize(("left", "closer"), [(0.3, []), (0.4, ["law"])])
def test_a_law_that_leaves_but_noise_has_no_better_one_of_its_cause(left, closer):
    """A true Walther oil was called an oil of another reference temperature, which fits the noise a little better."""
    law = replace(A, law="law", columns=(2,))
    cross = crossed({(): 100.0, (A,): 5.0 + left, (law,): 15.0}, (A, law), floor=5.0)
    assert [slot.law for slot in near(cross, cross.explain((A,)))] == closer


def test_what_stands_beside_an_effect_is_no_law_of_its_own():
    """Of two effects the laws of each are asked in its own place."""
    law = replace(A, law="law", columns=(2,))
    cross = crossed({(): 100.0, (A,): 50.0, (B,): 60.0, (A, B): 10.0, (B, A): 10.0, (B, law): 15.0}, (A, B, law))
    assert [(slot.name, slot.law) for slot in near(cross, cross.explain((A, B)))] == [(A.name, "law")]


@pytest.mark.parametrize(("loss", "taken"), [(72.0, True), (74.0, False)])
def test_a_good_part_of_a_gap_is_one_of_what_lies_above_the_floor(monkeypatch, loss, taken):
    """Three tenths of the 90 above a floor of 10 are 27."""
    monkeypatch.setattr(chance, "candidate_trials", lambda *_: [SimpleNamespace(slots=(B,), loss=loss)])
    cross = SimpleNamespace(excess=lambda _: 10.0, floor=10.0)
    assert (chance.most_of_it(cross, SimpleNamespace(slots=(), loss=100.0)) is B) is taken


def test_of_a_line_and_hats_what_predicts_more_speaks_for_a_signal_and_the_best_signal_leads():
    """A bent dependence is told by hats; and two signals stand by what they take, the surer one behind."""
    speed = np.tile(np.linspace(-1.0, 1.0, BLOCKS), RUNS)
    phase = np.sin(np.arange(RUNS * BLOCKS) / 5.0)
    left = 3.0 * speed + 6.0 * np.abs(speed) + 1.0 * phase + 0.2 * noise()
    bent, other = dependences(remainder({"phase": phase, "speed": speed}), left, np.random.default_rng(0))
    assert (bent.signal, other.signal) == ("speed", "phase")
    assert bent.p_value > other.p_value
    assert bent.share > other.share > 0.0
    (line,) = dependences(remainder({"speed": speed}), 3.0 * speed + 0.2 * noise(), np.random.default_rng(0))
    assert bent.size > 1.5 * line.size


def test_a_block_that_turns_both_ways_is_of_neither_direction():
    way = np.where(np.arange(RUNS * BLOCKS) % 3 == 0, 0.0, SIGN)
    speed = np.tile(np.linspace(-1.0, 1.0, BLOCKS), RUNS)
    for design in _designs(speed, way):
        up, down = design[:, : design.shape[1] // 2], design[:, design.shape[1] // 2 :]
        assert not design[way == 0.0].any()
        assert not up[way < 0.0].any()
        assert not down[way > 0.0].any()
        assert up[way > 0.0].any(axis=1).all()
        assert down[way < 0.0].any(axis=1).all()


# -- by figures of their own, once more
def test_an_interval_is_one_of_95_per_cent_as_theory_has_it():
    """The root mean square of n independent normal values varies by 1 / sqrt(2 n) of itself; of few runs each stays."""
    count = 900
    values = np.random.default_rng(3).standard_normal(count)
    size = rms_with_interval(values, np.arange(count), np.arange(count) // 300, np.random.default_rng(0))
    spread = 1.96 / np.sqrt(2.0 * count) * size.value
    assert size.interval == pytest.approx((size.value - spread, size.value + spread), abs=0.15 * spread)
    assert size.value == pytest.approx(np.sqrt(np.mean(values**2)), rel=1e-12)


def test_of_unlike_segments_a_size_is_that_of_all_and_not_of_the_middle_draw():
    """One of four segments keeps ten times as much: it is drawn once or not at all more often than not."""
    values, segment = np.array([1.0, 1.0, 1.0, 10.0]), np.arange(4)
    size = rms_with_interval(values, segment, np.zeros(4, int), np.random.default_rng(0))
    assert size.value == pytest.approx(np.sqrt(103.0 / 4.0))
    assert size.interval == pytest.approx((1.0, np.sqrt((3 * 100.0 + 1.0) / 4.0)), rel=0.02)


@pytest.mark.parametrize(("runs", "redrawn"), [(7, False), (8, True), (9, True)])
def test_from_eight_runs_on_whole_runs_are_redrawn(runs, redrawn):
    """All segments of a run alike: with every run in place there is nothing to redraw."""
    run = np.repeat(np.arange(runs), 5)
    size = rms_with_interval(1.0 + run, np.arange(len(run)), run, np.random.default_rng(0))
    assert (size.interval[0] < 0.99 * size.value < size.value < 0.99 * size.interval[1]) is redrawn


def test_redrawn_runs_keep_all_of_their_segments_and_no_others():
    """Weights of a run's segments sum to its number times how often it is drawn, of all runs to the number of runs."""
    of_run = np.array([0] * 3 + [1] * 5 + [2] * 2 + [3, 4, 5, 6, 7])
    weights = chance._redrawn(of_run, np.random.default_rng(0))
    sizes = np.bincount(of_run)
    times = np.array([weights[:, of_run == k].sum(axis=1) / sizes[k] for k in range(8)])
    assert weights.shape == (LIMITS.bootstrap_draws, len(of_run))
    np.testing.assert_allclose(times, np.round(times))
    np.testing.assert_allclose(times.sum(axis=0), 8.0)
    np.testing.assert_allclose(times.mean(axis=1), 1.0, atol=0.12)
    assert len({tuple(each) for each in times.T}) > 100


@pytest.mark.parametrize("k", [0, 1])
def test_a_rival_stands_in_the_place_of_one_effect_beside_all_others(k):
    third = Slot("third", "", (7,))
    two = (A, third) if k == 0 else (third, A)
    left = {(third,): 60.0, two: 10.0, (third, A): 10.0, (third, B): 11.0}
    cross = crossed(left, (A, third, B))
    found, _ = rivals_of(cross, cross.explain(two), cross.explain((third,)), k, np.random.default_rng(0))
    assert found == (B,)


@pytest.mark.parametrize(("behind", "alike"), [(0.085, True), (0.095, False), (-0.085, True), (-0.095, False)])
def test_the_same_column_differs_by_less_than_a_thousandth_of_what_is_saved(monkeypatch, behind, alike):
    """Of 90, which are saved of 100."""
    monkeypatch.setattr(chance, "heads", lambda cross, before, trials: list(trials))
    cross = crossed({(): 100.0, (A,): 10.0, (B,): 10.0 + behind}, (A, B))
    found, _ = rivals_of(cross, cross.explain((A,)), cross.explain(()), 0, np.random.default_rng(0), same=True)
    assert (found == (B,)) is alike


def test_an_effect_wins_against_the_best_of_the_others_whichever_that_is_and_a_tie_is_won():
    worse, better = np.full(9, 2.0), np.full(9, 0.5)
    own = np.full(9, 1.0)
    for others, share in (([worse, better], 0.0), ([better, worse], 0.0), ([worse, worse], 1.0), ([own, worse], 1.0)):
        assert _frequency(own, others, np.random.default_rng(0)) == share
    assert _frequency(own, [], np.random.default_rng(0)) == 1.0


def test_hats_stand_at_even_quantiles_from_the_least_to_the_largest_value():
    """Of one direction they sum to one, and each is one at its own quantile."""
    values = np.linspace(0.0, 1.0, RUNS * BLOCKS) ** 2
    line, hats = _designs(values, np.ones(RUNS * BLOCKS))
    up = hats[:, : LIMITS.knots]
    assert (line.shape[1], hats.shape[1]) == (4, 2 * LIMITS.knots)
    np.testing.assert_allclose(up.sum(axis=1), 1.0)
    peaks = values[np.argmax(up, axis=0)]
    np.testing.assert_allclose(peaks, np.quantile(values, np.arange(LIMITS.knots) / (LIMITS.knots - 1)), atol=5e-3)
