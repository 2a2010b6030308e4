"""What a search asks in which order, and by which figures what shows just after reversals is a finding."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import search
from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, Verdict
from winch_friction.discrepancy.candidates.candidate import MOVING, REVERSALS, Candidate, Shape
from winch_friction.discrepancy.candidates.lateness import DELAY, SMALL, tau
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.selection import Selection
from winch_friction.discrepancy.search import ReversalFinding, long_delay, too_short
from winch_friction.discrepancy.thresholds import LIMITS

RNG = np.random.default_rng(0)


# -- just after reversals
def reversing(
    monkeypatch, gone=1.0, p=0.004, gain=1.5, own=0.0, least=None, bound=False, travel=1.0, blocks=200,
    named=(), tried=2,
):  # fmt: skip
    """What is found where a base leaves 10, the noise 4, and the best of two effects takes `gone` of the six between:
    what was asked, and the finding."""
    asked = SimpleNamespace(tried=(), runs=(), kept=())
    candidate = Candidate("bristles", reversal_gain=least, shortest=("z", 0.5), law="z", law_name="l", free=True)
    other = Candidate("other")
    slots = [
        Slot(each.name, "d", (k,), origin=(each, Shape("d", {"z": travel})))
        for k, each in enumerate((other, candidate))
    ]
    base = SimpleNamespace(loss=10.0, losses=np.full(4, 2.5), slots=())
    trials = [
        SimpleNamespace(loss=loss, losses=np.full(4, loss / 4.0), slots=(slot,))
        for loss, slot in zip((9.99, 10.0 - 6.0 * gone), slots, strict=True)
    ]
    explained = iter([base, SimpleNamespace(loss=10.0 + own)])  # and what nothing explains
    cross = SimpleNamespace(
        explain=lambda kept: next(explained), floor=4.0,
        gain=lambda before, after: gain if (before, after) == (base, trials[1]) else -1.0,
        at_bound=lambda trial, slot: bound and (trial, slot) == (trials[1], slots[1]),
    )  # fmt: skip

    def expand(given, expansion, explanation, tried, turning):
        assert turning
        asked.tried = [each.name for each in tried]
        runs = [
            SimpleNamespace(name=name, used=np.arange(blocks + 50) < count)
            for name, count in (("train", blocks), ("locked", blocks), ("still", 0))
        ]
        return search.Expansion(tuple(runs), SimpleNamespace(slot_like=lambda slot: slot.name), None)

    def build(chosen, layout, by_sample):
        assert by_sample
        asked.runs = [run.name for run in chosen]

    def flip(gains, rng):
        assert gains == pytest.approx(np.array([np.full(4, 0.0025), np.full(4, 1.5 * gone)]))
        return np.array([1e-9, p])

    monkeypatch.setattr(search, "expand_around", expand)
    monkeypatch.setattr(search, "build_problem", build)
    monkeypatch.setattr(search, "CrossFit", lambda _: cross)
    monkeypatch.setattr(search, "candidate_trials", lambda *_: trials[:tried])
    monkeypatch.setattr(search, "flip_p_values", flip)
    monkeypatch.setattr(search, "blurred_travel", lambda _: 0.0)
    every = [
        Candidate("moves", regime=MOVING), Candidate("moves too", regime=MOVING, reversal_rival=True),
        Candidate("turns", regime=REVERSALS, reversal_rival=True), Candidate("named", regime=MOVING),
        Candidate("oil", regime="flow", reversal_rival=True),
    ]  # fmt: skip
    explanation = SimpleNamespace(slots=tuple(Slot(name, "", ()) for name in named))
    found = search.after_reversals(None, None, explanation, every, ["train", "still"], RNG, lambda each: each)
    return asked, found


def test_what_takes_most_just_after_reversals_is_the_finding_of_the_training_runs(monkeypatch):
    asked, found = reversing(monkeypatch, named=("named",))
    assert asked.tried == ["moves too", "turns", "named"]
    assert asked.runs == ["train"]
    assert (found.slot.name, found.p_value, found.gain) == ("bristles", 0.004, 1.5)
    assert (found.fitted.loss, found.base.loss) == (pytest.approx(4.0), 10.0)
    own = found.effect({"z": 1})
    assert (own.name, own.rivals, own.variant, own.law, own.parameters) == ("bristles", (), "d", "z", {"z": 1})
    assert (own.p_value, own.gain, own.selection_frequency) == (0.004, 1.5, 1.0)
    assert (own.where, own.law_name, own.free) == ("just after reversals", "l", True)
    assert reversing(monkeypatch)[0].tried == ["moves too", "turns"]


@pytest.mark.parametrize(
    ("changed", "is_one"),
    [
        ({"tried": 0}, False),
        ({"p": 0.006}, False),
        ({"gain": 0.99}, False),
        ({"gain": 0.3, "least": 0.25}, True),
        ({"gain": 0.3, "least": 0.35}, False),
        ({"bound": True}, False),
        ({"travel": 0.5}, False),  # over before the instant is known
        ({"travel": 0.51}, True),
        ({"blocks": 199}, False),
        ({"gone": LIMITS.reversal_share - 0.01}, False),
        ({"gone": LIMITS.reversal_share + 0.01}, True),
        # six times what a named effect may leave of itself
        ({"named": ("named",), "own": 6.0 / LIMITS.small_left_over - 1.0}, True),
        ({"named": ("named",), "own": 6.0 / LIMITS.small_left_over + 1.0}, False),
        ({"named": ("named",), "own": -1e9}, True),
        ({"own": 1e9}, True),  # nothing is named
    ],
)
def test_what_shows_just_after_reversals_is_sure_useful_plausible_and_most_of_it(monkeypatch, changed, is_one):
    assert (reversing(monkeypatch, **changed)[1] is not None) == is_one


@pytest.mark.parametrize(("least", "blur", "value", "short"), [
    (0.5, 0.2, 0.5, True), (0.5, 0.2, 0.51, False), (0.2, 0.5, 0.5, True), (0.2, 0.5, 0.51, False),
])  # fmt: skip
def test_a_travel_is_too_short_within_its_own_bound_or_the_runs_blur(monkeypatch, least, blur, value, short):
    monkeypatch.setattr(search, "blurred_travel", lambda _: blur)
    own = Candidate("c", shortest=("z", least))
    assert too_short(own, Shape("", {"z": value, "other": 0.0}), []) is short
    assert not too_short(Candidate("c"), Shape("", {"z": value}), [])


def test_nothing_shows_after_reversals_in_runs_that_were_not_asked_or_have_none(monkeypatch):
    runs = [SimpleNamespace(name=name, used=np.array([any_])) for name, any_ in (("a", False), ("b", True))]
    finding = ReversalFinding(None, 0.0, 1.0, None, None, None, SimpleNamespace(runs=runs))
    monkeypatch.setattr(search, "build_problem", None)
    assert not finding.holds_on(["a"], RNG)
    assert not finding.holds_on([], RNG)


# -- a delay that its first derivative does not tell
SMALL_ONE, LONGER, LATER = {"ahead": 1.0, "behind": 1.0}, {"ahead": 1.0, "behind": 0.0}, {"ahead": 0.0, "behind": 1.0}


@pytest.mark.parametrize(
    ("size", "shape", "law", "fitted", "long"),
    [
        (0.49, SMALL_ONE, "", True, False), (0.51, SMALL_ONE, "", True, True), (-0.51, SMALL_ONE, "", True, True),
        (0.51, SMALL_ONE, "", False, False), (0.51, SMALL_ONE, "clock", True, False), (0.0, LONGER, "", False, True),
        (0.0, LATER, "", False, True), (0.0, LONGER, "clock", False, False),
    ],
)  # fmt: skip
def test_a_small_delay_that_was_fitted_large_or_one_of_the_longer_ones_is_long(size, shape, law, fitted, long):
    """Half of the longest small one; of the longer ones the signal is late or early."""
    slot = Slot(DELAY, "", (0,), origin=(None, Shape("", shape)), law=law)
    cross = SimpleNamespace(size=lambda explanation, own: size * SMALL * tau.typical)
    explanation = SimpleNamespace(slots=(slot,) if fitted else ())
    other = Slot("tare_load", "", (1,))
    assert long_delay([other, slot], cross, explanation) == (slot if long else None)


# -- the steps
@dataclass(frozen=True)
class Explained:
    """An explanation of these slots."""

    slots: tuple = ()
    names: tuple = ()


BASE = Explained()


def searching(monkeypatch, kind, found=(), ripple=None, flow=(), reversal=None, continuous=(), also=None, passing=None):
    """A search whose every step is told here: what was asked of each."""
    asked = SimpleNamespace(
        most=[], left=[], reversed=0, expanded=0, decided=[], known=None, cleaned=[], laid=[], late=[]
    )
    own = Candidate("own", regime=MOVING, continuous=continuous)
    slot = Slot("own", "", (0,), origin=(own, Shape("", {})))
    final = Explained((slot,) if found else ())
    cross = SimpleNamespace(remainder=lambda explanation: explanation)
    run = SimpleNamespace(name="a")

    class Around:
        """Runs around a point, of which the training runs are asked."""

        def __init__(self, *_):
            self.runs = (run,)

        def cross(self, names, known=()):
            asked.cleaned.append((tuple(names), tuple(known)))
            return cross

    def select(_, rng, most):
        asked.most.append(most)
        return Selection(BASE, final, found)

    def expand(*_):
        asked.expanded += 1
        return Around()

    def reverse(*_):
        asked.reversed += 1
        return reversal

    def decide(_, selection, left, rippled):
        asked.decided.append(rippled)
        return Verdict(kind)

    def testable(known, prepared, model):
        asked.known = [each.name for each in known]
        return list(known), ["blind"]

    for name, value in {
        "Expansion": Around, "layout_of": lambda _, known, *__: asked.laid.extend(known),
        "base_of": lambda *_: None, "select": select,
        "near": lambda *_: (),
        "expand_around": expand, "after_reversals": reverse, "decide": decide, "testable": testable,
        "passing_delay": lambda *_: passing,
        "without_delay": lambda _, known, suspect, *__: asked.late.append(suspect) or known,
        "most_of_it": lambda *_: None, "dependences": lambda _, left, __: asked.left.append(left) or ["depends"],
        "_cleaned": lambda expansion, *_, **__: expansion, "_waves": lambda *_: {},
    }.items():  # fmt: skip
        monkeypatch.setattr(search, name, value)
    monkeypatch.setattr(search.flow_balance, "shown_by", lambda *_: (flow, ["unseen"]))
    given = SimpleNamespace(
        model=None, prepared=[run], runs=[SimpleNamespace(name="a")], crane=None, once=lambda key, make: ripple
    )
    options = SimpleNamespace(candidates=[own, Candidate("turns", regime=REVERSALS)])
    study = search.Study(SimpleNamespace(train=("a",)), None, options, RNG)
    return asked, search.search_runs(study, given, also), final


@pytest.mark.parametrize("kind", [MISSING, AMBIGUOUS, NOTHING, UNEXPLAINED])
@pytest.mark.parametrize("beside", [{}, {"reversal": "r"}, {"ripple": "r"}, {"flow": ("f",)}])
def test_nothing_is_missing_only_where_nothing_shows_beside_the_moving_samples(monkeypatch, kind, beside):
    asked, found, final = searching(monkeypatch, kind, **beside)
    shown = bool(beside) and not (kind == UNEXPLAINED and "reversal" in beside)
    assert found.verdict.kind == (MISSING if kind == NOTHING and shown else kind)
    assert asked.reversed == (kind != UNEXPLAINED)
    assert found.reversal == (beside.get("reversal") if kind != UNEXPLAINED else None)
    assert (found.ripple, found.flow) == (beside.get("ripple"), beside.get("flow", ()))
    assert found.untestable == ("blind", "unseen")
    assert asked.decided == ["ripple" in beside]
    assert found.explanation is (BASE if found.verdict.kind in (UNEXPLAINED, NOTHING) else final)


def test_what_a_gap_depends_on_is_told_of_what_stands(monkeypatch):
    finding = (SimpleNamespace(slot=None, rivals=()),)
    asked, found, final = searching(monkeypatch, MISSING, finding)
    assert (asked.left, found.left) == ([final], ("depends",))
    asked, found, final = searching(monkeypatch, UNEXPLAINED, finding)
    assert asked.left == [final, BASE]


def test_runs_are_prepared_around_what_was_found_once_and_again_for_a_shape_from_a_grid(monkeypatch):
    finding = (SimpleNamespace(slot=None, rivals=()),)
    for continuous, times in (((), 1), (("z",), LIMITS.most_expansions)):
        asked, _, final = searching(monkeypatch, MISSING, finding, continuous=continuous)
        assert asked.expanded == times
        assert asked.most == [1] + times * [LIMITS.most_effects]
        assert asked.cleaned == [(("a",), ())] + times * [(("a",), final.slots)]


def test_a_delay_that_passes_is_suspected_where_nothing_else_is(monkeypatch):
    asked, *_ = searching(monkeypatch, MISSING, passing="a passing delay")
    assert asked.late == ["a passing delay"]
    finding = (SimpleNamespace(slot=None, rivals=()),)
    asked, *_ = searching(monkeypatch, MISSING, finding, passing="a passing delay")
    assert asked.late == []


def test_a_law_of_last_resort_is_one_cause_alone(monkeypatch):
    asked, _, _ = searching(monkeypatch, MISSING, also=lambda prepared, model: [Candidate("last", regime=MOVING)])
    assert asked.known == ["own", "turns", "last"]
    assert [each.name for each in asked.laid] == ["own", "last"]  # what turns is looked for just after reversals
    assert set(asked.most) == {1}


# -- the same search with other names
def made(**more):
    slot = Slot("own", "", (0,))
    selection = Selection(BASE, Explained((slot,)), ("finding",))
    cross = SimpleNamespace(remainder=lambda explanation: explanation)
    known = {
        "given": None,
        "train": (),
        "at_seed": None,
        "expansion": None,
        "cross": cross,
        "selection": selection,
        "left": (),
        "verdict": Verdict(MISSING),
        "reversal": "r",
        "ripple": "w",
        "flow": ("f",),
        "untestable": (),
    }
    return search.Search(**{**known, **more})  # fmt: skip


def test_a_search_without_any_name_has_none_beside_the_moving_samples_either():
    found = search.nameless(made())
    assert (found.selection.final, found.selection.found) == (BASE, ())
    assert (found.reversal, found.ripple, found.flow) == (None, None, ())


def test_what_is_decided_anew_is_told_by_its_own_remainder(monkeypatch):
    monkeypatch.setattr(search, "dependences", lambda cross, left, rng: [left])
    monkeypatch.setattr(
        search, "decide", lambda cross, selection, left, rippled: Verdict(str(rippled), selection.found)
    )
    other = Selection(BASE, Explained(), ("another",))
    for ripple, rippled in (("w", "True"), (None, "False")):
        found = search.decided(made(ripple=ripple), other, RNG)
        assert (found.selection, found.left) == (other, (Explained(),))
        assert found.verdict == Verdict(rippled, ("another",))
    gone = search.unexplained(made(), "too small", RNG)
    assert (gone.verdict, gone.left) == (Verdict(UNEXPLAINED, "too small"), (BASE,))
    for kind in (UNEXPLAINED, MISSING):
        monkeypatch.setattr(search, "decide", lambda *_, kind=kind: Verdict(kind))
        assert search.refused(made(), RNG) == (kind == UNEXPLAINED)


def test_a_ripple_is_taken_out_of_each_run_by_its_own_wave(monkeypatch):
    runs = (SimpleNamespace(name="a"), SimpleNamespace(name="b"))
    monkeypatch.setattr(search, "waves_of", lambda own, ripple: {run.name: f"{ripple} of {run.name}" for run in own})
    monkeypatch.setattr(search, "without_ripple", lambda run, ripple, wave: (run.name, ripple, wave))
    own = search.Expansion(runs, None, None)
    waves = search._waves(own, "wave")
    assert search._cleaned(own, "wave", waves).runs == (("a", "wave", "wave of a"), ("b", "wave", "wave of b"))
    assert search._waves(own, None) == {}
    assert search._cleaned(own, None, {}) is own
    assert replace(own).runs is runs
