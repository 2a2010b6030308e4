"""By what a ripple, a leak and what shows after reversals are told from nothing, each rule by itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import search
from winch_friction.discrepancy.detectors import flow_balance, ripple, ripple_waves
from winch_friction.discrepancy.detectors.flow_balance import FEWEST_RUNS
from winch_friction.discrepancy.detectors.lost_flow import ORDINARY, Leakage
from winch_friction.discrepancy.detectors.ripple import SMALLEST, TERM, Ripple
from winch_friction.discrepancy.expansion import Expansion
from winch_friction.discrepancy.search import ReversalFinding
from winch_friction.physics.fluid import LEAKAGE_LAWS

RNG = np.random.default_rng(0)


# -- a ripple
@pytest.mark.parametrize(("size", "found"), [(0.5, False), (2.0, True)])
def test_a_ripple_that_is_of_no_use_to_anybody_is_none(size, found):
    assert Ripple(3.0, size * SMALLEST, 1e-6, 1e-30, 100.0).found is found


@pytest.mark.parametrize(("sine", "cosine"), [(0.01, 0.0), (0.0, 0.01)])
def test_a_known_ripple_has_its_size_whatever_its_phase(sine, cosine):
    values = {"a_r": sine, "b_r": cosine, "k_r": 3.0}
    model = SimpleNamespace(term_names=(TERM,), value=values.get)
    assert ripple._known(Ripple(3.0, 0.005, 1e-5, 1e-30, 100.0), model)
    assert not ripple._known(Ripple(3.0, 0.009, 1e-5, 1e-30, 100.0), model)


@pytest.mark.parametrize(("terms", "ways"), [((TERM,), [True]), ((), [False, True])])
def test_beside_a_known_ripple_the_inertia_is_taken_out(monkeypatch, terms, ways):
    asked = []
    monkeypatch.setattr(ripple, "_tables", lambda *more: asked.append(more[-1]) or [])
    assert ripple.angle_ripple([], [], None, SimpleNamespace(term_names=terms)) is None
    assert asked == ways


@pytest.mark.parametrize(("turned", "shared"), [(0.0, True), (1.0, True), (np.pi, False)])
def test_one_ripple_is_written_where_the_runs_share_its_phase(monkeypatch, turned, shared):
    """With the deviation that the noise of a line in so many samples gives it. Where they cancel, one wave fits best
    beside the ripple, and says nothing of it."""
    angle, static, noise = np.linspace(0.0, 60.0, 4000), np.full(4000, 1000.0), 20.0
    scatter = np.random.default_rng(1).standard_normal((2, 4000))
    waves = [
        10.0 * np.sin(3.0 * angle + phase) + noise * own for phase, own in zip((0.0, turned), scatter, strict=True)
    ]
    tables = iter([(angle, wave, static) for wave in waves])
    monkeypatch.setattr(ripple_waves, "_unsmoothed", lambda *_: next(tables))
    runs = [SimpleNamespace(used=np.ones(1, bool), drum_torque=np.ones(1), present={"shaft_angle"})] * 2
    found = ripple_waves.in_phase([None, None], runs, None, Ripple(3.01, 0.01, 1e-4, 1e-30, 100.0))
    assert (found is not None) is shared
    if not turned:
        assert found["k_r"].value == pytest.approx(3.0, abs=0.01)
        assert np.hypot(found["a_r"].value, found["b_r"].value) == pytest.approx(0.01, rel=0.1)
        assert found["a_r"].std == pytest.approx(noise / 1000.0 * np.sqrt(2.0 / 8000.0), rel=0.05)


# -- a leak
@pytest.mark.parametrize(
    ("slip", "p", "after", "found"),
    [(1.5, 0.001, 0.1, True), (1.05, 0.001, 0.1, False), (1.5, 0.02, 0.1, False), (1.5, 0.001, 0.75, False)],
)
def test_a_leak_is_more_than_ordinary_sure_and_most_of_what_is_lost(slip, p, after, found):
    each = Leakage({}, slip * ORDINARY, 0.05 * ORDINARY, p, 1.0, after)
    assert each.found is found


def test_stretches_of_two_runs_tell_no_leak():
    rows = np.zeros((40, 7))
    rows[:, 0] = np.arange(40) % FEWEST_RUNS
    assert flow_balance._enough(rows)
    assert not flow_balance._enough(rows % (FEWEST_RUNS - 1))


@pytest.mark.parametrize(
    ("lost", "holds"),
    [((1.0, 1.0, 1.0), True), ((1.0, 1.0, 3.0), False), ((1.0,), False), ((3.0,) * 5, False), ((3.0,) * 6, True)],
)
def test_of_a_few_stretches_a_leak_explains_each(lost, holds):
    """Of three rad/s by one it leaves two; that six of six get better is one in 64 by chance, and enough."""
    rows = np.array([[0.0, each, 0.0, 0.0, 1.0, *[0.0] * (len(LEAKAGE_LAWS) - 1)] for each in lost])
    assert Leakage({"slip_leakage": (1.0, 0.1)}, 0.0, 0.0, 0.0, 1.0, 0.0).explains(rows) is holds


def test_a_leak_explains_runs_beside_the_error_of_the_speeds_scale_that_goes_with_it():
    """Of a reading that is 2 % off: without the leak 5 % would fit best, and leave half a rad/s of each."""
    speed = np.array([20.0, 40.0, 60.0, 80.0])
    lost = 0.02 * speed + 1.0
    others = [0.0] * (len(LEAKAGE_LAWS) - 1)
    rows = np.array([[0.0, own, at, 0.0, 1.0, *others] for own, at in zip(lost, speed, strict=True)])
    found = {"slip_leakage": (1.0, 0.1)}
    assert Leakage(found, 0.0, 0.0, 0.0, 1.0, 0.0, beside=(0.02,), alone=(0.03,)).explains(rows)
    assert not Leakage(found, 0.0, 0.0, 0.0, 1.0, 0.0, beside=(-0.02,), alone=(0.03,)).explains(rows)


def test_a_plateau_has_lasted_before_its_samples_count_and_what_does_not_move_does_not():
    """The speed follows a step by and by, and stands for a while: neither is lost to a leak."""
    time = np.arange(0.0, 20.0, 0.02)
    command = np.where(time < 10.0, 50.0, 100.0)
    late, stands = (time > 9.9) & (time < 11.0), (time > 2.0) & (time < 3.0)
    speed = np.where(late, 50.0, np.where(stands, 0.0, command)) - 1.0
    group = SimpleNamespace(balances=True, pressure=np.full(len(time), 150e5), displacement=np.full(len(time), 3e-5))
    prepared = SimpleNamespace(
        time=time, start=0.0, dt=0.02, used=~stands, speed=speed, acceleration=0.0 * time, groups=[group], channels={}
    )
    rows = flow_balance._segments(_Run(time, command), prepared, 3, 1.0)
    assert rows[:, 0].tolist() == [3.0] * len(rows)
    np.testing.assert_allclose(rows[:, 1], 1.0)


def test_the_first_stretch_begins_with_the_record():
    """Five seconds each: one rad/s is lost in the first, two in the second, and none has a sample of the other."""
    time = np.arange(0.0, 10.0, 0.02)
    lost = np.where(time < 4.99, 1.0, 2.0)
    group = SimpleNamespace(balances=True, pressure=np.full(len(time), 150e5), displacement=np.full(len(time), 3e-5))
    prepared = SimpleNamespace(
        time=time, start=0.0, dt=0.02, used=np.ones(len(time), bool), speed=50.0 - lost, acceleration=0.0 * time,
        groups=[group], channels={},
    )  # fmt: skip
    rows = flow_balance._segments(_Run(time, np.full(len(time), 50.0)), prepared, 3, 1.0)
    np.testing.assert_allclose(rows[:, 1], [1.0, 2.0], rtol=1e-9)


class _Run:
    def __init__(self, time, command):
        self.time, self._command = time, command

    def __getitem__(self, name):
        return self._command


@pytest.mark.parametrize(("named", "asked"), [("accumulator_thermal", ["plain"]), ("stribeck", ["plain", "passive"])])
def test_beside_a_gas_only_runs_without_it_say_what_shows_after_reversals(monkeypatch, named, asked):
    """What its law has wrong is largest where the passive side's motion turns: a break-away was named beside it."""
    used = np.ones(search.FEWEST_BLOCKS, bool)
    runs = [
        SimpleNamespace(name=name, used=used, groups=range(count)) for name, count in (("plain", 1), ("passive", 2))
    ]
    monkeypatch.setattr(search, "expand_around", lambda *_, **__: Expansion(tuple(runs), None, None))
    seen = []

    def build(chosen, *_, **__):
        seen.extend(run.name for run in chosen)
        raise StopIteration

    monkeypatch.setattr(search, "build_problem", build)
    explanation = SimpleNamespace(slots=(SimpleNamespace(name=named),))
    with pytest.raises(StopIteration):
        search.after_reversals(None, None, explanation, [], ["plain", "passive"], RNG, lambda each: each)
    assert seen == asked


def test_what_comes_with_the_shafts_angle_is_looked_for_in_the_training_runs_alone(monkeypatch):
    """A ripple that only locked runs show is theirs to judge, not to find."""
    runs = [SimpleNamespace(name=name) for name in ("a", "locked", "b")]
    seen = []

    def detect(own_runs, own_prepared, *_):
        seen.append(([run.name for run in own_runs], list(own_prepared)))
        raise StopIteration

    monkeypatch.setattr(search.angle, "detect", detect)
    given = SimpleNamespace(model=None, prepared=[0, 1, 2], runs=runs, crane=None, once=lambda _, make: make())
    study = SimpleNamespace(split=SimpleNamespace(train=("a", "b")), rng=RNG)
    with pytest.raises(StopIteration):
        search.search_runs(study, given)
    assert seen == [(["a", "b"], [0, 2])]


# -- after reversals
def test_beside_a_delay_nothing_is_looked_for_after_reversals():
    explanation = SimpleNamespace(slots=(SimpleNamespace(name="signal_delay"),))
    assert search.after_reversals(None, None, explanation, [], (), RNG, None) is None


@pytest.mark.parametrize(("loud", "quiet", "holds"), [(0.5, 0.5, True), (0.5, 1.5, False)])
def test_what_shows_after_reversals_holds_by_the_locked_runs_each_in_its_own_noise(monkeypatch, loud, quiet, holds):
    """One whose sensors are ten times as loud has no more to say for being loud; the training runs have nothing."""
    runs = [SimpleNamespace(name=name, used=np.ones(1, bool)) for name in ("train", "loud", "quiet")]
    asked = []

    def build(chosen, _, by_sample=False):
        assert by_sample  # the mean of a block, of a second or more, holds next to nothing of what a reversal shows
        asked.extend(run.name for run in chosen)
        x = np.column_stack([np.ones(400), np.repeat([10.0 * loud, quiet], 200)])
        y = np.repeat([10.0, 1.0], 200)
        blocks = SimpleNamespace(
            y=y, x=np.column_stack([0.0 * y, y - x[:, 1]]), weight=1.0 / y, segment=np.arange(400) // 20,
            run=np.repeat([0, 1], 200),
        )  # fmt: skip
        return SimpleNamespace(blocks=blocks)

    monkeypatch.setattr(search, "build_problem", build)
    cross = SimpleNamespace(problem=SimpleNamespace(columns=lambda slots: tuple(range(1 + len(slots)))))
    base, fitted = (SimpleNamespace(slots=slots, beta=np.ones(1 + len(slots))) for slots in ((), ("bristles",)))
    expansion = SimpleNamespace(runs=runs, layout=None)
    finding = ReversalFinding(None, 0.0, 0.5, cross, fitted, base, expansion)
    assert finding.holds_on(("loud", "quiet"), RNG) is holds
    assert asked == ["loud", "quiet"]
