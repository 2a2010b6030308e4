"""What makes a verdict: what is left where nothing swings and where something does, large gaps, ripples, and size."""

import pickle
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import answer
from winch_friction.discrepancy.adequacy import Check
from winch_friction.discrepancy.answer import (
    AMBIGUOUS,
    MISSING,
    NOTHING,
    UNEXPLAINED,
    Combination,
    Effect,
    GapOptions,
    GapResult,
    Side,
    Verdict,
    decide,
    keeps_something,
    named,
    steady_excess,
    unexplained_share,
)
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate, Untestable
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import Dependence, Size
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.engine.selection import Considered
from winch_friction.discrepancy.thresholds import LIMITS

SIZE = 1000  # blocks
STEADY = np.arange(SIZE) < SIZE // 2
SWINGS = np.where(STEADY, 0.0, 1.0)  # acceleration


def left(steady, swinging):
    """A remainder of so much above the noise variance where the shaft keeps its speed, and where it does not."""
    return np.sqrt(1.0 + np.where(STEADY, steady, swinging))


class Crossed(SimpleNamespace):
    inside_excess = CrossFit.inside_excess


def crossed(acceleration=SWINGS, matters=0.0):
    problem = SimpleNamespace(
        matters=matters, blocks=SimpleNamespace(features={"acceleration": acceleration}), unresolved=np.zeros(SIZE)
    )
    return Crossed(
        problem=problem, remainder=lambda each: each, at_bound=lambda *_: False,
        excess=lambda each: float(np.mean(each**2 - 1.0)),
    )  # fmt: skip


class _Remainder(np.ndarray):
    names = ("wave",)


def verdict(before, after=None, depends=(), matters=0.0, plain=(), **more):
    """Of one named effect, or of none without `after`."""
    names = ("wave", *plain)
    found = [SimpleNamespace(slot=Slot(each, "", (), plain=each in plain), rivals=()) for each in names]
    final = (before if after is None else after).view(_Remainder)
    selection = SimpleNamespace(base=before, final=final, found=[] if after is None else found, untold="")
    return decide(crossed(matters=matters), selection, list(depends), **more)


@pytest.mark.parametrize(("rippled", "kind"), [(False, UNEXPLAINED), (True, NOTHING)])
def test_twice_the_noise_is_something_unless_a_ripple_may_be_a_part_of_it(rippled, kind):
    assert verdict(left(4.0, 4.0), rippled=rippled).kind == kind


@pytest.mark.parametrize(
    ("share", "swinging", "kind"),
    [(0.1, 2.0, UNEXPLAINED), (0.06, 2.0, MISSING), (0.1, 0.5, MISSING)],  # 0.25 of the noise is nobody's effect
)
def test_what_is_left_while_the_speed_changes_counts_where_a_signal_predicts_it(share, swinging, kind):
    found = verdict(left(4.0, 4.0), left(0.0, swinging), [Dependence("acceleration", share, 1e-3)])
    assert found.kind == kind
    assert found.leaves is (kind == UNEXPLAINED)


@pytest.mark.parametrize(("kept", "kind"), [(5.0, UNEXPLAINED), (3.0, MISSING), (1.9, MISSING)])
def test_of_a_large_gap_a_smaller_share_is_something(kept, kind):
    """Four per cent of a hundred times the noise, although it is less than 15."""
    assert verdict(left(100.0, 100.0), left(kept, kept)).kind == kind


@pytest.mark.parametrize(("size", "kind"), [(0.2, UNEXPLAINED), (0.05, NOTHING)])
def test_what_a_signal_predicts_is_nothing_where_it_is_smaller_than_what_matters(size, kind):
    depends = [Dependence("speed", 0.2, 1e-3, size)]
    assert verdict(left(0.2, 0.2), depends=depends, matters=0.1).kind == kind


@pytest.mark.parametrize("count", [LIMITS.most_named - 1, LIMITS.most_named + 2])
def test_plain_terms_of_a_bare_model_may_be_several(count):
    assert verdict(left(4.0, 4.0), left(0.0, 0.0), plain=[f"plain {k}" for k in range(count)]).kind == MISSING


@pytest.mark.parametrize(("steady", "excess"), [(LIMITS.fewest_steady, 0.0), (LIMITS.fewest_steady - 1, None)])
def test_the_steady_blocks_speak_alone_where_there_are_enough_of_them(steady, excess):
    """One jolt, a thousand times what a sea does, does not make the sea steady."""
    acceleration = np.where(np.arange(SIZE) < steady, 0.0, 1.0)
    acceleration[-1] = 1000.0
    remainder = np.where(np.arange(SIZE) < steady, 1.0, 3.0)
    whole = 8.0 * (SIZE - steady) / SIZE
    assert steady_excess(crossed(acceleration), remainder) == pytest.approx(whole if excess is None else excess)


def test_a_combinations_interval_is_one_of_95_per_cent():
    low, high = Combination("x + y", 3.0, 0.5, "kg", "tied").content()["interval"]
    assert (low, high) == pytest.approx((3.0 - 0.98, 3.0 + 0.98))


def test_what_a_user_has_chosen_goes_to_other_processes():
    """Many cranes are searched at once."""
    chosen = GapOptions(seed=3, plan=False)
    assert pickle.loads(pickle.dumps(chosen)) == chosen


# -- what is written
@pytest.mark.parametrize(("law_name", "free", "law", "kind"), [
    ("", False, "wave", "literature"), ("bent", True, "bent", "free"),
])  # fmt: skip
def test_an_effect_is_written_with_each_of_its_figures_in_its_own_place(law_name, free, law, kind):
    known = {"a": ParameterEstimate(2.0, 0.3, "kg")}
    own = Effect(
        "wave", ("other",), "all groups", r"\tau", known, 0.01, 0.4, 0.9, "just after reversals", law_name, free,
        Combination("a + b", 5.0, 0.5, "kg", "tied"),
    )  # fmt: skip
    content = own.content()
    assert content.pop("identifiable_combination")["expression"] == "a + b"
    assert content == {
        "name": "wave", "indistinguishable_from": ["other"], "variant": "all groups", "law": law, "law_kind": kind,
        "latex": r"\tau", "parameters": {"a": {"value": 2.0, "std": 0.3, "unit": "kg"}},
        "evidence": {"p_value": 0.01, "cv_gain": 0.4, "selection_frequency": 0.9, "where": "just after reversals"},
    }  # fmt: skip


def kept(names, number, blocks=2, after=1.0):
    """Runs of these names whose figures all begin with their number: 2.1 before, 2.2 after, ..."""
    of = {name: SimpleNamespace(name=name) for name in names}
    whole = SimpleNamespace(y=np.zeros(blocks * len(names)), run=np.repeat(np.arange(len(names)), blocks))
    return Side(
        tuple(of.values()), whole, 0.0 * whole.y, after + 0.0 * whole.y, Size(number + 0.1, (number, number + 0.15)),
        Size(number + 0.2, (number + 0.05, number + 0.25)), number + 0.3, number + 0.4, (number + 0.5, number + 0.6),
    )  # fmt: skip


def result(**more):
    own = {
        "verdict": "ambiguous", "refused": "why", "effects": (), "unit": "bar", "train": kept("abc", 1.0),
        "holdout": kept("de", 2.0), "depends": (Dependence("speed", 0.2, 1e-3),), "unexplained_share": 0.7,
        "considered": (Considered("wave", "all", 0.3, 0.04, 1, "taken"),),
        "untestable": (Untestable("air", r"V", "a command", "it shows there"),), "model": None, "seed_model": None,
    }  # fmt: skip
    written = GapResult(**{**own, **more})
    written.__dict__["regions"] = (SimpleNamespace(where="hoisting", share_of_gap=0.6, mean_residual=-1.5),)
    return written.content()


@pytest.mark.parametrize(
    ("predict", "laws", "signals"),
    [
        ((), ("wire_out", "hook_load"), ["wire_out", "hook_load"]),
        ((Dependence("speed", 0.2, 1e-3),), ("wire_out",), ["speed"]),
        ((), None, []),
    ],
)
def test_what_no_signal_predicts_depends_on_those_that_its_law_reads(predict, laws, signals):
    """Of a groove every 9 m gap.json said that it depends on nothing, and had its law three lines further down."""
    law = [SimpleNamespace(declared=SimpleNamespace(reads=laws), content=lambda stem: stem)] * (laws is not None)
    assert result(depends=predict, proposals=law)["unexplained"]["depends_on"] == signals


def test_the_answer_is_written_with_each_of_its_figures_in_its_own_place():
    content = result()
    assert content["gap"] == {
        "unit": "bar",
        "train": {"before": 1.1, "after": 1.2, "relative_before": 1.5, "relative_after": 1.6},
        "holdout": {
            "before": 2.1, "after": 2.2, "relative_before": 2.5, "relative_after": 2.6, "noise_floor": 2.3,
            "before_ci": [2.0, 2.15], "after_ci": [2.05, 2.25], "runs": ["d", "e"],
        },
    }  # fmt: skip
    assert content["regions"] == [{"where": "hoisting", "share_of_gap": 0.6, "mean_residual": -1.5}]
    assert content["unexplained"] == {"depends_on": ["speed"], "share_of_gap": 0.7, "reason": "why"}
    assert content["untestable"] == [{"name": "air", "needs": "a command", "because": "it shows there"}]
    assert content["considered"] == [
        {"name": "wave", "variant": "all", "stage": 1, "cv_gain": 0.3, "p_value": 0.04, "outcome": "taken"}
    ]
    assert (content["schema"], content["verdict"], content["next_experiment"]) == ("winch_friction.gap/2",) + (
        "ambiguous", None,
    )  # fmt: skip


def test_proposals_are_numbered_from_one_as_their_files_are():
    law = SimpleNamespace(content=lambda stem: stem, declared=SimpleNamespace(reads=("wire_out",)))
    content = result(proposals=[law] * 2, next_experiment={"scenario": "a.yaml"})
    assert content["proposals"] == ["proposal_1", "proposal_2"]
    assert content["next_experiment"] == {"scenario": "a.yaml"}


def test_of_locked_runs_without_a_block_no_figure_is_written():
    none = result(holdout=kept("d", 2.0, blocks=0))["gap"]["holdout"]
    assert none.pop("runs") == ["d"]
    assert set(none.values()) == {None}


def test_a_floor_is_noise_and_what_no_balance_closes_and_excuses_a_step_of_the_transducers():
    side = replace(kept("a", 1.0), noise_floor=0.3, least_noise=0.4)
    assert side.floor == pytest.approx(0.5)
    assert side.excused == pytest.approx(np.hypot(0.3, 0.4 * LIMITS.step))


def test_what_each_run_keeps_is_in_floors_and_the_one_that_keeps_most_comes_first():
    side = replace(kept("abc", 1.0), noise_floor=0.3, least_noise=0.4, after=np.array([1.0, -1, 3, -3, 2, 2]))
    assert {run.name: list(own) for run, own in side.left_by_run}["b"] == pytest.approx([6.0, -6.0])
    assert list(side.most_left_first.items()) == [(n, pytest.approx(v)) for n, v in (("b", 6), ("c", 4), ("a", 2))]


@pytest.mark.parametrize(
    ("depends", "said"),
    [
        ([("a", 0.3, 1e-4), ("b", 0.2, 0.5), ("c", 0.1, 0.01)], "ac"),  # those that are sure
        ([("a", 0.3, 1e-4), ("c", LIMITS.least_named_share, 1e-4)], "a"),  # and large enough to be named
        ([("a", 0.3, 0.5), ("b", 0.0, 0.5), ("c", -0.1, 0.5)], "a"),  # of none that is sure what predicts anything
        ([(name, 0.1, 1e-4) for name in "abcde"], "abcde"[: LIMITS.most_signals]),
    ],
)
def test_the_signals_that_are_named_are_those_that_are_sure_or_else_those_that_predict(depends, said):
    assert [each.signal for each in named([Dependence(*each) for each in depends])] == list(said)


@pytest.mark.parametrize(
    ("kind", "found", "before", "after", "share"),
    [
        (MISSING, True, 110.0, 30.0, 0.2), (MISSING, True, 110.0, 5.0, 0.0), (MISSING, True, 20.0, 60.0, 1.0),
        (UNEXPLAINED, False, 110.0, 30.0, 1.0), (NOTHING, False, 110.0, 30.0, 0.0),
    ],
)  # fmt: skip
def test_the_share_that_no_name_explains_is_one_of_what_lies_above_the_noise(kind, found, before, after, share):
    base, final = SimpleNamespace(loss=before), SimpleNamespace(loss=after)
    selection = SimpleNamespace(base=base, final=final, found=["one"] * found)
    assert unexplained_share(SimpleNamespace(floor=10.0), selection, Verdict(kind)) == pytest.approx(share)


# -- by figures of its own
def found_are(*slots, rivals=(), before=None, after=None, depends=(), beyond=(), untold=""):
    """The verdict on these slots, of which the names in `beyond` are at their bound and in `rivals` have another."""
    found = [SimpleNamespace(slot=own, rivals=("other",) * (own.name in rivals)) for own in slots]

    class Final(np.ndarray):
        names = tuple(dict.fromkeys(own.name for own in slots))

    cross = crossed()
    cross.at_bound = lambda _, slot: slot.name in beyond
    base, final = (left(4.0, 4.0) if before is None else before), (left(0.0, 0.0) if after is None else after)
    return decide(cross, SimpleNamespace(base=base, final=final.view(Final), found=found, untold=untold), list(depends))


A, B, C = (Slot(name, "", (), most=6.0) for name in ("a", "b", "c"))
LAW = replace(B, law="another")


def test_a_name_that_many_others_do_as_well_as_is_refused_for_that_alone():
    """Whoever asks once more asks for the levels of runs where nothing else speaks against the name."""
    verdict = found_are(A, untold="five others do as well")
    assert (verdict.kind, verdict.refused, verdict.untold, verdict.leaves) == (
        UNEXPLAINED, "five others do as well", True, False,
    )  # fmt: skip
    assert not found_are(A, after=left(4.0, 4.0), untold="five others do as well").untold


@pytest.mark.parametrize(
    ("slots", "kind", "said"),
    [
        ((A, B), MISSING, ""),
        ((A, B, LAW), MISSING, ""),  # two laws of one cause are one effect
        ((A, B, C), UNEXPLAINED, "it would take 3 effects at once to imitate it (a, b, c)"),
    ],
)
def test_two_causes_are_an_answer_and_three_an_imitation(slots, kind, said):
    found = found_are(*slots)
    assert (found.kind, found.refused) == (kind, said)


@pytest.mark.parametrize("beyond", ["a", "b"])
def test_any_name_of_an_implausible_size_refuses_all(beyond):
    found = found_are(A, B, beyond=(beyond,))
    assert found.kind == UNEXPLAINED
    assert found.refused == f"{beyond} would need an implausible size, 6 times what is typical or more"


@pytest.mark.parametrize(("rivals", "kind"), [("", MISSING), ("a", AMBIGUOUS), ("b", AMBIGUOUS), ("ab", AMBIGUOUS)])
def test_one_name_that_has_another_makes_an_answer_ambiguous(rivals, kind):
    assert found_are(A, B, rivals=rivals).kind == kind


@pytest.mark.parametrize(("steady", "kind"), [(2.9, NOTHING), (3.1, UNEXPLAINED)])
def test_without_a_name_three_times_the_noise_is_something_where_nothing_swings(steady, kind):
    """However much swings on the wire, which no friction model is to answer for."""
    assert verdict(left(steady, 90.0)).kind == kind


SURE, UNSURE = ([Dependence("speed", 0.2, p)] for p in (1e-3, 0.02))


@pytest.mark.parametrize(
    ("before", "after", "depends", "kept"),
    [
        ((2.0, 2.0), (0.5, 0.0), SURE, 25),  # a quarter of what there is, which a signal predicts
        ((2.0, 2.0), (0.5, 0.0), UNSURE, None),
        ((2.0, 2.0), (0.5, 0.0), (), None),
        ((2.0, 2.0), (0.25, 0.25), SURE, None),  # a quarter of the noise is nobody's effect
        ((1.0, 200.0), (0.5, 0.0), SURE, 50),  # the steady blocks are held against the steady ones
        ((200.0, 200.0), (0.0, 2.0), SURE, None),  # what swings: more than noise, and a hundredth of what was there
        ((4.0, 4.0), (0.0, 2.0), SURE, 25),
        ((1.0, 1.0), (0.0, 0.6), SURE, None),  # three tenths of the noise are nobody's effect
        ((1.0, 99.0), (0.8, 9.2), SURE, 80),  # said is the larger share of the two, here of the steady blocks
        ((99.0, 1.0), (9.2, 90.8), SURE, 100),
    ],
)
def test_a_share_that_a_sure_signal_predicts_is_left_of_the_steady_blocks_or_of_all(before, after, depends, kept):
    found = found_are(A, before=left(*before), after=left(*after), depends=depends)
    assert found.refused == ("" if kept is None else f"a leaves {kept} % of the gap above the noise floor")
    assert found.kind == (MISSING if kept is None else UNEXPLAINED)


@pytest.mark.parametrize(
    ("excess", "before", "share", "keeps"),
    [
        (0.5, 2.0, 0.05, True),  # half of what a signal must predict where there is no name
        (0.5, 2.0, 0.03, False),
        (1.6, 4.0, 0.0, True),  # that much needs no signal
        (1.4, 4.0, 0.0, False),
        (0.3, 0.4, 0.5, False),
        (1.6, 20.0, 0.5, False),
        (2.1, 50.0, 0.0, True),
        (2.1, 60.0, 0.0, False),
    ],
)
def test_what_is_kept_is_something_by_its_size_its_share_and_what_points_at_it(excess, before, share, keeps):
    assert keeps_something(excess, before, [Dependence("speed", share, 1e-3)]) is keeps


def test_a_shaft_that_brakes_is_not_steady():
    slows = np.where(STEADY, 0.0, -1.0)
    assert steady_excess(crossed(slows), left(0.5, 7.0)) == pytest.approx(0.5)


def test_regions_are_those_of_the_training_runs_as_the_model_was_given(monkeypatch):
    monkeypatch.setattr(answer, "find_regions", lambda blocks, gap, read_as: [(blocks, gap, read_as)])
    train = replace(kept("abc", 1.0), before=np.arange(6.0))
    whole = GapResult(MISSING, "", (), "bar", train, kept("de", 2.0), (), 0.0, (), (), None, None)
    assert whole.regions == ((train.blocks, train.before, answer.READ_AS),)


def test_what_else_was_said_is_written_as_it_was_said():
    content = result(
        notes=("slow log",), adequacy=(Check("rate", 20.0, 5.0, "Hz", True),), provenance={"seed": 3},
        seed_refuted=[SimpleNamespace(content=lambda: {"parameter": "K4"})],
    )  # fmt: skip
    assert (content["notes"], content["provenance"]) == (["slow log"], {"seed": 3})
    assert content["seed_refuted"] == [{"parameter": "K4"}]
    assert list(content["adequacy"][0].values()) == ["rate", 20.0, 5.0, "Hz", True]


def test_the_shaft_is_steady_by_a_share_of_its_largest_acceleration_and_not_of_its_usual_one():
    """Six blocks of ten hardly accelerate, the others fifty times as much."""
    calm = np.arange(SIZE) < 600
    found = steady_excess(crossed(np.where(calm, 0.02, 1.0)), np.sqrt(1.0 + np.where(calm, 0.5, 7.0)))
    assert found == pytest.approx(0.5)
