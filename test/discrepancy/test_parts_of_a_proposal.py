"""A proposal's parts by figures: its entry and sentence, what the samples have seen, and constants moved to the fit."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import proposals, vocabulary
from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, Verdict
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.engine.grammar import Factor, Law, Scored
from winch_friction.discrepancy.proposals import Proposal, explained, propose
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.vocabulary import BY_NAME

RNG = np.random.default_rng(0)
TERM = SimpleNamespace(equation="k * w", latex="k w", opposing=True, name="t")
K, C = ParameterEstimate(0.5, 0.1, "N*m*s/rad"), ParameterEstimate(7.0, 1.0, "s")


def proposal(before=3.0, after=1.5, noise=1.0, **more):
    declared = SimpleNamespace(sentence="friction with speed", term=TERM, reads=("motor_speed",))
    return Proposal(declared, {"k": K, "c": C}, "text", "model", before, after, noise, "bar", 0.004, **more)


def test_a_proposals_entry_says_what_it_leaves_and_where_its_files_are():
    own = proposal().content("law_1")
    assert own == {
        "equation": "k * w", "latex": "k w", "opposing": True, "reads": ["motor_speed"],
        "parameters": {"k": {"value": 0.5, "std": 0.1, "unit": "N*m*s/rad"},
                       "c": {"value": 7.0, "std": 1.0, "unit": "s"}},
        "terms_file": "law_1.py", "model_file": "law_1.yaml",
        "holdout": {"before": 3.0, "after": 1.5, "noise_floor": 1.0, "closed": 0.75, "unit": "bar"},
        "p_value": 0.004, "sentence": proposal().sentence,
    }  # fmt: skip


def test_a_proposals_sentence_has_its_amount_with_its_deviation_and_never_closes_more_than_all(monkeypatch):
    monkeypatch.setattr(proposals, "beside", lambda value, std: f"{value}+-{std}")
    monkeypatch.setattr(proposals, "amount_in_words", lambda number, unit: f"{number} {unit}")
    said = "friction with speed, 0.5+-0.1 N*m*s/rad; closes {} % of the gap; what it is, the data do not say"
    assert proposal().sentence == said.format(75)
    assert proposal(after=0.8).sentence == said.format(100)


@pytest.mark.parametrize(("share", "worth"), [(-0.01, False), (0.01, True)])
def test_a_law_is_worth_its_words_by_what_it_closes_of_the_square_above_the_noise(share, worth):
    removed = (LIMITS.proposal_gain + share) * (9.0 - 1.0)
    assert proposal(after=float(np.sqrt(9.0 - removed))).worthwhile is worth


@pytest.mark.parametrize("kind", [MISSING, AMBIGUOUS, NOTHING])
def test_where_something_is_named_or_missing_nothing_is_proposed(monkeypatch, kind):
    monkeypatch.setattr(proposals, "_laws", None)
    assert propose(SimpleNamespace(search=SimpleNamespace(verdict=Verdict(kind))), (), None, RNG) == ()


def test_three_laws_are_proposed_at_most_and_they_are_searched_on_the_training_runs(monkeypatch):
    asked = []

    def laws(search, runs, rng):
        asked.extend(run.name for run in runs)
        return [(k, 0.1 * k) for k in range(6)]

    def proven(refit, train, scored, p_value, evaluate, rng):
        asked.append((scored, p_value, train, evaluate))
        return proposal(weight=scored)

    monkeypatch.setattr(proposals, "_laws", laws)
    monkeypatch.setattr(proposals, "_proven", proven)
    monkeypatch.setattr(proposals, "adds", lambda *_: False)
    runs = tuple(SimpleNamespace(name=name) for name in "abc")
    search = SimpleNamespace(verdict=Verdict(UNEXPLAINED), expansion=SimpleNamespace(runs=runs))
    found = propose(SimpleNamespace(search=search), ("c", "a"), "evaluate", RNG)
    assert [each.weight for each in found] == [0, 1, 2]
    assert asked == ["a", "c", *((k, 0.1 * k, ("c", "a"), "evaluate") for k in range(LIMITS.most_proposals))]


def test_no_more_laws_are_put_to_the_locked_runs_than_so_many(monkeypatch):
    """Of ten that they refuse, one after the other, each costs a preparation of all runs."""
    asked = []
    monkeypatch.setattr(proposals, "_laws", lambda *_: [(k, 0.1) for k in range(LIMITS.proposals_tried + 4)])
    monkeypatch.setattr(proposals, "_proven", lambda *each: asked.append(each))
    search = SimpleNamespace(verdict=Verdict(UNEXPLAINED), expansion=SimpleNamespace(runs=()))
    assert propose(SimpleNamespace(search=search), (), None, RNG) == ()
    assert len(asked) == LIMITS.proposals_tried


@pytest.mark.parametrize(("off", "says"), [(-0.01, False), (0.01, True)])
def test_an_equation_explains_from_where_on_it_closes_nearly_all(off, says):
    left = 3.0 - 2.0 * (LIMITS.closes_nearly_all + off)
    assert explained(UNEXPLAINED, [proposal(), proposal(after=left)]) is says
    assert explained(MISSING, []) is explained(AMBIGUOUS, []) is True
    assert explained(NOTHING, []) is False


@pytest.mark.parametrize(("loss", "weight"), [(200.0, 2), (0.0, 3)])
def test_a_laws_order_is_the_log_of_what_it_leaves_and_a_price_for_what_there_is_to_read(loss, weight):
    own = SimpleNamespace(loss=loss, law=SimpleNamespace(weight=weight))
    assert proposals._order(own, 400.0) == pytest.approx(np.log(max(loss, 1e-9) / 400.0) + LIMITS.word_price * weight)


# -- what the samples have seen
def run(speed, used, name="a", drop=(), **channels):
    time = 0.5 * np.arange(len(speed))
    groups = [SimpleNamespace(pressure=np.full(len(speed), each), count=2 + k) for k, each in enumerate(drop)]
    return SimpleNamespace(
        name=name, speed=np.array(speed), used=np.array(used, bool), time=time, groups=groups, channels=channels,
        dt=0.5, gap=np.zeros(len(speed)), direction=np.ones(len(speed)), unit_torque=4.0,
    )  # fmt: skip


ONE, TWO = run([-1.0, 2.0, -5.0], [1, 0, 1], drop=(1e7, -3e7)), run([4.0, 9.0], [1, 0], "b")


def test_a_word_has_seen_what_moved_and_of_groups_their_mean():
    speed, pressure, wire = (BY_NAME[name] for name in ("motor_speed", "pressure", "wire_out"))
    assert vocabulary.covered(speed, [ONE, TWO]).tolist() == [1.0, 5.0, 4.0]
    assert vocabulary.covered(pressure, [ONE, TWO]).tolist() == [2e7, 2e7]  # the other has no group
    assert vocabulary.covered(pressure, [TWO]).tolist() == []
    told, silent = (run([1.0, 1.0], [1, 1], **known) for known in ({"wire_out": np.array([3.0, 4.0])}, {}))
    assert vocabulary.covered(wire, [told, told]).tolist() == [3.0, 4.0, 3.0, 4.0]
    assert vocabulary.covered(wire, [told, silent]).tolist() == []  # a run that lacks it says nothing of it


def test_a_factor_of_the_groups_has_a_row_for_each_of_the_most_there_are():
    speed, above = Factor("linear", "motor_speed"), Factor("above", "motor_speed", (("c", 1.5),))
    square = Factor("square", "pressure")
    rows = [each.tolist() for each in vocabulary._columns([speed, above], [square], ONE, 3)]
    assert rows == [[1.0, 2.0, 5.0], [0.0, 0.5, 3.5], [1e14] * 3, [9e14] * 3, [0.0] * 3]
    lag = next(vocabulary._columns([Factor("lag", "motor_speed", (("c", 2.0),))], [], TWO, 0))
    assert lag[0] < 9.0
    assert 4.0 <= lag[1] < 6.0  # a quarter of the way in half a second of two


def test_evaluated_factors_are_in_their_own_rows_over_the_blocks_of_all_runs(monkeypatch):
    asked = []

    def first_of(used, size):
        asked.append((used.tolist(), size))
        return lambda values: values[:1]

    monkeypatch.setattr(vocabulary, "block_means", first_of)
    monkeypatch.setattr(vocabulary, "block_size", lambda own: len(own.time))
    speed, square, linear = Factor("linear", "motor_speed"), Factor("square", "pressure"), Factor("linear", "pressure")
    found = vocabulary.evaluated([square, speed, linear], [ONE, TWO], 2)
    assert found[speed].tolist() == [[1.0, 4.0]]
    assert found[square].tolist() == [[1e14, 0.0], [9e14, 0.0]]
    assert found[linear].tolist() == [[1e7, 0.0], [3e7, 0.0]]
    assert asked == [([True, False, True], 3), ([True, False], 2)]
    assert vocabulary.evaluated([], [ONE], 2) == {}


def test_a_search_of_laws_knows_each_runs_unit_and_its_motors(monkeypatch):
    asked = {}

    def grammar(cross, base, torque, direction, members):
        asked.update(torque=torque.tolist(), members=members.tolist(), direction=direction)
        return SimpleNamespace(search=lambda values, fit: [] if fit is None else None)

    monkeypatch.setattr(proposals, "Grammar", grammar)
    monkeypatch.setattr(proposals, "covered", lambda word, runs: word.name)
    kinds = {"motor_speed": ("linear", "step"), "pressure": ("root",)}
    monkeypatch.setattr(proposals, "factors", lambda word, seen: [Factor(k, word.name) for k in kinds.get(seen, ())])
    monkeypatch.setattr(
        proposals, "evaluated", lambda words, runs, most: asked.update(words=words, most=most, runs=runs)
    )
    blocks = SimpleNamespace(run=np.array([0, 1, 1]), y=np.zeros(3), direction="ways")
    cross = SimpleNamespace(
        problem=SimpleNamespace(blocks=blocks), explain=lambda _: SimpleNamespace(loss=9.0), floor=1.0
    )
    two = run([4.0, 9.0], [1, 0], "b", drop=(1e7,))
    two.unit_torque = 8.0
    search = SimpleNamespace(cross=cross, expansion=SimpleNamespace(runs=(ONE, two, run([1.0], [1], "locked"))))
    assert proposals.near_laws(search, ("a", "b"), RNG, ("step",)) == []
    assert [each.name for each in asked["runs"]] == ["a", "b"]
    assert asked["torque"] == [0.25, 0.125, 0.125]
    assert asked["members"] == [[2.0, 2.0, 2.0], [3.0, 0.0, 0.0]]
    assert (asked["most"], asked["direction"]) == (2, "ways")
    assert [(each.kind, each.signal) for each in asked["words"]] == [("linear", "motor_speed"), ("root", "pressure")]


# -- constants moved to the fit
def test_constants_move_to_where_the_law_fits_best_but_a_counts_do_not(monkeypatch):
    monkeypatch.setattr(proposals, "evaluated", lambda factors, runs, most: tuple(factors))

    def inside(law):
        at = dict(law.factors[0].constants)
        return (np.log(at["c"] / 70.0)) ** 2 + (np.log(at["h"] / 3.3)) ** 2 + law.factors[1].constants[0][1] ** 2

    class Fitted:
        """A grammar by which a hump about 70 of width 3.3 fits best."""

        def screened(self, law, values):
            assert values == law.factors
            return Scored(law, 1.0, inside(law), np.inf, np.zeros(0))

        def judged(self, best, values):
            assert values == best.law.factors
            return SimpleNamespace(judged=best)

    hump = Factor("hump", "motor_speed", (("c", 80.0), ("h", 3.0)))
    law = Law((hump, Factor("about", "wire_layer", (("c", 2.0),))), True)
    found = proposals._tuned(Fitted(), Scored(law, 1.0, inside(law), np.inf, np.zeros(0)), [], 1).judged
    at = dict(found.law.factors[0].constants)
    assert at["c"] == pytest.approx(70.0, rel=0.5 * 0.25 * 0.5 ** (LIMITS.tuning_rounds - 1))
    assert at["h"] == pytest.approx(3.3, rel=0.5 * 0.25 * 0.5 ** (LIMITS.tuning_rounds - 1))
    assert found.law.factors[1] == law.factors[1]
    assert found.law.opposing
    first = sorted({80.0 * (1.0 + s) for s in (-0.25, -0.125, 0.125, 0.25)})
    tried = []
    monkeypatch.setattr(
        Fitted, "screened", lambda _, law, __: tried.append(law) or Scored(law, 1.0, 9.0, 9.0, np.zeros(0))
    )
    proposals._tuned(
        Fitted(),
        Scored(Law((Factor("above", "motor_speed", (("c", 80.0),)),), True), 1.0, 1.0, 1.0, np.zeros(0)),
        [],
        1,
    )
    assert sorted(law.factors[0].constants[0][1] for law in tried[:4]) == pytest.approx(first)
    assert len(tried) == 4 * LIMITS.tuning_rounds
    assert tried[-1].factors[0].constants[0][1] == pytest.approx(
        80.0 * (1.0 + 0.25 * 0.5 ** (LIMITS.tuning_rounds - 1)), rel=1e-3
    )


# -- put to the locked runs
class Asked(Exception):
    """What a law is declared as is known; no fit is wanted."""


@pytest.mark.parametrize(
    ("kinds", "tried"),
    [
        ((("lag", "motor_speed"), ("lag", "drum_torque")), False),
        ((("lag", "motor_speed"), ("fade", "run_time")), False),
        ((("lag", "motor_speed"), ("linear", "drum_torque")), True), ((("fade", "run_time"),), True),
        ((("fade", "motor_speed"), ("lag", "motor_speed")), True),
    ],
)  # fmt: skip
def test_a_proposal_has_one_memory_at_most(monkeypatch, kinds, tried):
    def declare(*_):
        raise Asked

    monkeypatch.setattr(proposals, "declare", declare)
    law = Law(tuple(Factor(kind, signal, (("c", 5.0),)) for kind, signal in kinds), True)
    own = Scored(law, 1.0, 1.0, 1.0, np.zeros(0))
    if tried:
        with pytest.raises(Asked):
            proposals._proven(None, (), own, 0.0, None, RNG)
    else:
        assert proposals._proven(None, (), own, 0.0, None, RNG) is None
