"""What of a search stands by the locked runs beside its names: side findings, delays, rivals, the model as given."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import search as search_module
from winch_friction.discrepancy import several
from winch_friction.discrepancy import standing as module
from winch_friction.discrepancy.answer import MISSING, NOTHING, UNEXPLAINED, Verdict
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate, Shape
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import Size
from winch_friction.discrepancy.engine.crossfit import left_of_first_halves, same_columns
from winch_friction.discrepancy.engine.selection import Finding, Selection
from winch_friction.discrepancy.proof import Trial
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction.term import Parameter

RNG = np.random.default_rng(0)
ORIGIN = (SimpleNamespace(reversal_gain=None, opposing=True, linear=()), None)
SLOTS = tuple(Slot(name, "", (k,), origin=ORIGIN) for k, name in enumerate(("one", "two", "three", "four")))


@dataclass(frozen=True)
class Searched:
    """A search of these names, with what else it found."""

    selection: Selection
    verdict: Verdict = Verdict(MISSING)
    ripple: object = None
    flow: tuple = ()
    reversal: object = None
    given: object = None
    left: tuple = ()
    cross: object = None

    @property
    def explanation(self):
        return self.selection.base if self.verdict.kind in (UNEXPLAINED, NOTHING) else self.selection.final


def explained(slots):
    return SimpleNamespace(slots=tuple(slots), names=tuple(dict.fromkeys(slot.name for slot in slots)))


def searched(*slots, **more):
    found = tuple(Finding(slot, (), 0.0, 0.1, 1.0) for slot in slots)
    cross = SimpleNamespace(explain=explained, excess=lambda each: 0.2 if each.slots else 1.0)
    return Searched(Selection(explained(()), explained(slots), found), **{"cross": cross, **more})


def side(left=1.0, **more):
    """Runs that keep so many floors."""
    size = Size(left, (left, left))
    known = {
        "runs": (),
        "least_noise": 0.1,
        "floor": 1.0,
        "excused": 1.0,
        "slowest": 0.0,
        "noise_floor": 1.0,
        "size_before": size,
        "size_after": size,
    }
    return SimpleNamespace(**known | more)


@pytest.mark.parametrize("shows", [False, True])
def test_what_was_found_beside_the_moving_samples_stays_where_the_locked_runs_show_it(monkeypatch, shows):
    """All three of them, asked of the locked runs alone."""
    asked = []

    def holds_on(*more):
        asked.append(more)
        return shows

    monkeypatch.setattr(module.angle, "holds_on", holds_on)
    monkeypatch.setattr(module.flow_balance, "holds_on", lambda found, *more: holds_on(*more))
    other = SimpleNamespace(holds_on=holds_on)
    runs = [SimpleNamespace(name=name) for name in ("train", "locked")]
    given = SimpleNamespace(runs=runs, prepared=["of train", "of locked"], crane=None, model=None)
    search = searched(ripple="ripple", flow=(other,), reversal=other, given=given)
    found = module._replicated(search, SimpleNamespace(holdout=("locked",)), RNG)
    assert (bool(found.ripple), bool(found.flow), bool(found.reversal)) == (shows,) * 3
    assert asked[0][1:3] == asked[1] == (runs[1:], ["of locked"])
    assert asked[2][0] == ("locked",)


FILE = SimpleNamespace(parameter_names=(), covariance=None)


@pytest.mark.parametrize(("tied", "refused"), [(-0.9, False), (0.0, True), (0.9, True)])
def test_of_two_amounts_that_are_tied_in_the_file_each_may_be_none_but_not_both(tied, refused):
    """A break-away of two amounts, each some 2 deviations from none and tied by -0.86, was named by sign flips at 7e-10
    and refused: together they are 7 deviations from none."""
    parameters = tuple(Parameter(name, "1", 1.0) for name in ("a", "b"))
    slot = Slot("one", "", (0, 1), origin=(SimpleNamespace(linear=parameters), Shape("")))
    found = {"one": {name: ParameterEstimate(2.2, 1.0, "1") for name in ("a", "b")}}
    file = SimpleNamespace(parameter_names=("K1", "a", "b"), covariance=np.eye(3))
    file.covariance[1, 2] = file.covariance[2, 1] = tied
    full = SimpleNamespace(repaired=SimpleNamespace(parameters=found, model=file), holdout=side(1.2))
    assert bool(module.may_be_none((slot,), full, SimpleNamespace(holdout=side(1.2)))) is refused


@pytest.mark.parametrize(("tied", "refused"), [(0.9, False), (0.5, True), (0.0, True)])
def test_an_amount_is_asked_with_its_shape_as_it_was_found(tied, refused):
    """A smaller amount of a steeper law is as much: an oil that thins, 3e-12 by the jackknife, was refused for an
    amount 2.5 deviations from none, of which nearly all was its law's steepness."""
    candidate, shape = SimpleNamespace(linear=(Parameter("a", "1", 1.0),)), Shape("", {"steepness": 1.0})
    slot = Slot("one", "", (0,), origin=(candidate, shape))
    found = {"one": {"a": ParameterEstimate(2.2, 1.0, "1"), "steepness": ParameterEstimate(1.0, 1.0, "1")}}
    file = SimpleNamespace(parameter_names=("K1", "steepness", "a"), covariance=np.eye(3))
    file.covariance[1, 2] = file.covariance[2, 1] = tied
    full = SimpleNamespace(repaired=SimpleNamespace(parameters=found, model=file), holdout=side(1.2))
    assert bool(module.may_be_none((slot,), full, SimpleNamespace(holdout=side(1.2)))) is refused


def test_of_two_amounts_one_that_is_sure_is_enough():
    """With one degree of freedom more the two together would be less sure than the first is alone."""
    parameters = tuple(Parameter(name, "1", 1.0) for name in ("a", "b"))
    slot = Slot("one", "", (0, 1), origin=(SimpleNamespace(linear=parameters), Shape("")))
    found = {"one": {"a": ParameterEstimate(3.1, 1.0, "1"), "b": ParameterEstimate(0.0, 1.0, "1")}}
    file = SimpleNamespace(parameter_names=("a", "b"), covariance=np.eye(2))
    full = SimpleNamespace(repaired=SimpleNamespace(parameters=found, model=file), holdout=side(1.2))
    assert not module.may_be_none((slot,), full, SimpleNamespace(holdout=side(1.2)))


@pytest.mark.parametrize(("left", "refused"), [(1.197, True), (1.19, False), (0.5, False)])
def test_what_takes_of_the_locked_gap_what_a_balance_tells_is_some(left, refused):
    """An inertia at 20 Hz, 2.6 deviations from none, halved what a refit left of the locked runs, 0.3 bar of 0.15."""
    slot = Slot("one", "", (0,), origin=(SimpleNamespace(linear=(Parameter("a", "1", 1.0),)), Shape("")))
    found = {"one": {"a": ParameterEstimate(2.6, 1.0, "1")}}
    full = SimpleNamespace(repaired=SimpleNamespace(parameters=found, model=FILE), holdout=side(left))
    assert bool(module.may_be_none((slot,), full, SimpleNamespace(holdout=side(1.2)))) is refused


@pytest.mark.parametrize(("left", "std", "refused"), [(1.2, 0.5, True), (1.2, 0.1, False), (3.0, 0.5, False)])
def test_an_amount_that_may_be_none_is_no_finding_where_a_refit_leaves_noise(left, std, refused):
    """Of a null 0.20 +- 0.087 bar of a line's loss were named; the refit left 1.3 of the noise without it."""
    amount, other = Parameter("a", "1", 1.0), Parameter("not in the file", "1", 1.0)
    slot = Slot("one", "", (0,), origin=(SimpleNamespace(linear=(amount, other)), Shape("")))
    found = {"one": {"a": ParameterEstimate(-1.0, std, "1"), "shape": ParameterEstimate(1.0, 0.0, "1")}}
    full = SimpleNamespace(repaired=SimpleNamespace(parameters=found, model=FILE), holdout=side(left))
    why = module.may_be_none((slot,), full, SimpleNamespace(holdout=side(left)))
    assert why.startswith("one: ") if refused else not why


@pytest.mark.parametrize(("law", "n", "m", "port"), [
    ("power", 1.63, 3.6, True), ("power", 1.63, 3.7, False), ("one_way", 1.0, 5.0, False), ("one_way", 2.0, 3.0, True),
])  # fmt: skip
def test_a_port_that_grows_much_faster_with_the_displacement_than_its_flow_is_none(monkeypatch, law, n, m, port):
    """Of the pumps' own line to four active motors, beside six passive ones, a fit to the end made w^1.6 D^5."""
    of = {"power": ("n_pp", "m_pp"), "one_way": ("n_po", "m_po")}[law]
    values = {name: ParameterEstimate(value, 0.1, "1") for name, value in zip(of, (n, m), strict=True)}
    rules = ("unproven", "leaves_too_much", "leaves_most", "fits_only_its_own", "within_a_sample", "within_a_step")
    for name in (*rules, "within_load_cells", "told_by_chance", "may_be_none"):
        monkeypatch.setattr(module, name, lambda *_: "")
    search = searched(replace(SLOTS[0], name="port_turbulence"))
    full = Trial(search, SimpleNamespace(parameters={"port_turbulence": values}), side(), side())
    trial, why = module._stands(search, SimpleNamespace(holdout=side(3.0)), lambda _: full, RNG)
    assert (trial is full) is port
    assert (why == "") is port
    if not port:
        assert why.startswith(f"port_turbulence: a loss with speed^{n:.3g} and displacement^{m:.3g} is no port's")


@pytest.mark.parametrize("law", ["in some runs", "since a date", "by another amount in each run"])
def test_a_law_that_chooses_its_runs_says_all_of_what_is_there_or_does_not_stand(law):
    """A drag in hoisting alone, in four runs of twelve, was "a feedback's zero in some runs" that left 2.3 noises."""
    one, other = replace(SLOTS[0], law=law), SLOTS[1]
    refused = module._chosen_not_whole((other, one), side(2.3))
    assert refused == "one: a law that chooses its runs has to say all of it, and leaves 2.3 where the noise is 1"
    assert not module._chosen_not_whole((other, one), side(1.9))
    assert not module._chosen_not_whole((other,), side(2.3))


def test_a_law_that_chooses_its_runs_and_leaves_much_does_not_stand(monkeypatch):
    for name in ("unproven", "leaves_too_much", "leaves_most", "fits_only_its_own", "within_a_sample"):
        monkeypatch.setattr(module, name, lambda *_: "")
    search = searched(replace(SLOTS[0], law="in some runs"))
    full = Trial(search, SimpleNamespace(parameters={}), side(), side(2.3))
    assert "has to say all" in module._stands(search, SimpleNamespace(holdout=side(9.0)), lambda _: full, RNG)[1]


def test_a_name_whose_amount_may_be_none_does_not_stand(monkeypatch):
    rules = ("unproven", "leaves_too_much", "leaves_most", "fits_only_its_own", "within_a_sample", "within_a_step")
    for name in (*rules, "within_load_cells", "told_by_chance"):
        monkeypatch.setattr(module, name, lambda *_: "")
    asked = []
    monkeypatch.setattr(module, "may_be_none", lambda *given: asked.append(given) or "it may be none")
    search = searched(SLOTS[0])
    full, refit = Trial(search, SimpleNamespace(parameters={}), side(), side()), SimpleNamespace(holdout=side(3.0))
    assert module._stands(search, refit, lambda _: full, RNG) == (None, "it may be none")
    assert asked == [((SLOTS[0],), full, refit)]


@pytest.mark.parametrize("opposing", [False, True])
def test_a_name_that_load_cells_have_by_chance_does_not_stand_if_it_acts_one_way(monkeypatch, opposing):
    rules = ("unproven", "leaves_too_much", "leaves_most", "fits_only_its_own", "within_a_sample", "within_a_step")
    for name in (*rules, "within_load_cells", "may_be_none", "_chosen_not_whole"):
        monkeypatch.setattr(module, name, lambda *_: "")
    asked = []
    monkeypatch.setattr(module, "told_by_chance", lambda trial: asked.append(trial) or "by chance")
    origin = (SimpleNamespace(opposing=opposing, name=SLOTS[0].name, linear=()), None)
    search = searched(replace(SLOTS[0], origin=origin))
    full, refit = Trial(search, SimpleNamespace(parameters={}), side(), side()), SimpleNamespace(holdout=side(3.0))
    stands = module._stands(search, refit, lambda _: full, RNG)
    assert (stands, asked) == (((full, ""), []) if opposing else ((None, "by chance"), [full]))


def test_what_does_not_stand_in_the_end_is_said():
    """A leak of 6 rad/s in the training runs, of which the locked ones bore out no law, ended without a word."""
    leak, air, ripple = (SimpleNamespace(effect=SimpleNamespace(name=n, where="there")) for n in ("leak", "air", "r"))
    search = searched(ripple=ripple, flow=(leak, air))
    assert module.not_borne_out(search, search) == []
    one, other = module.not_borne_out(search, replace(search, ripple=None, flow=(air,)))
    assert one.startswith("leak: the training runs show it (there), but")
    assert other.startswith("r: ")
    assert module.not_borne_out(searched(ripple=None, flow=()), search) == []
    again = SimpleNamespace(effect=SimpleNamespace(name="leak", where="in other runs"))  # by another amount
    assert module.not_borne_out(search, replace(search, flow=(again, air))) == []


def tried_with(monkeypatch, search, left_of, worse_of=lambda _: (), sets=()):
    """What stands of a search without names that hold; the locked runs keep what `left_of` says of each file."""
    monkeypatch.setattr(module, "_replicated", lambda own, *_: own)
    monkeypatch.setattr(module, "_sets", lambda *_: iter(sets))
    monkeypatch.setattr(search_module, "dependences", lambda *_: [])
    monkeypatch.setattr(module, "worse_runs", lambda of, _: worse_of(of))
    monkeypatch.setattr(module, "tried", lambda _, own: Trial(own, None, side(), side(left_of(own))))
    monkeypatch.setattr(module, "as_given", lambda _, own: Trial(own, "as given", side(), side()))
    search = replace(search, cross=SimpleNamespace(remainder=lambda _: None))
    return module.standing(SimpleNamespace(split=None, rng=RNG), search)


@pytest.mark.parametrize("ripple", [None, "ripple"])
def test_a_name_is_judged_beside_the_ripple_that_its_file_has_as_well(monkeypatch, ripple):
    """Else the ripple's removal is its merit: a loss that took nothing was named beside one of 0.8 bar."""
    asked = []

    def stands(each, refit, *_):
        asked.append(refit.holdout.size_after.value)
        return None, "no"

    monkeypatch.setattr(module, "_stands", stands)
    monkeypatch.setattr(module, "_judged", lambda trial, why, rng: trial.search)
    search = searched(SLOTS[0], ripple=ripple)
    tried_with(monkeypatch, search, lambda own: 0.2 if own.ripple else 0.8, sets=[search])
    assert asked == [0.2 if ripple else 0.8]


@pytest.mark.parametrize(("worse", "kept"), [((), 0.5), (("run 3",), 1.0)])
def test_a_side_finding_is_written_where_it_makes_no_locked_run_worse(monkeypatch, worse, kept):
    search = searched(ripple="ripple")
    stands = tried_with(
        monkeypatch, search, lambda own: 0.5 if own.ripple else 1.0,
        lambda of: worse if of.size_after.value == 0.5 else (),
    )  # fmt: skip
    assert stands.holdout.size_after.value == kept
    assert stands.search.verdict.kind == (NOTHING if worse else MISSING)


@pytest.mark.parametrize(("worse", "given"), [((), False), (("run 3",), True)])
def test_a_refit_to_what_nothing_explains_is_not_written_where_it_makes_a_locked_run_worse(monkeypatch, worse, given):
    search = searched(SLOTS[0], verdict=Verdict(UNEXPLAINED))
    stands = tried_with(monkeypatch, search, lambda _: 3.0, lambda _: worse)
    assert (stands.repaired == "as given") is given
    assert stands.search.verdict.kind == UNEXPLAINED


@pytest.mark.parametrize("beside", [{"ripple": "ripple"}, {"flow": ("leak",)}])
def test_a_leak_is_missing_as_a_ripple_is(beside):
    judged = module._judged(Trial(searched(**beside), None, side(), side()), "", RNG)
    assert judged.verdict.kind == MISSING
    assert module._judged(Trial(searched(), None, side(), side()), "", RNG).verdict.kind == NOTHING


@pytest.mark.parametrize("worse", [(), ("run 3",), ("run 3", "run 5")])
def test_what_shows_just_after_reversals_makes_no_locked_run_worse(monkeypatch, worse):
    monkeypatch.setattr(module, "worse_runs", lambda *_: worse)
    search = searched(reversal=SimpleNamespace(slot=SLOTS[0]))
    trial = Trial(search, None, side(), side())
    said = f"{SLOTS[0].name}: the gap of {', '.join(worse)} grows"  # two runs were said as one, `run 3run 5`
    assert module._stands(search, trial, lambda _: trial, RNG) == ((None, said) if worse else (trial, ""))


@pytest.mark.parametrize(("late", "stands"), [(0.007, False), (0.014, True)])
def test_a_delay_within_half_a_sample_of_the_slowest_log_does_not_stand(monkeypatch, late, stands):
    monkeypatch.setattr(module, "unproven", lambda *_: "")
    monkeypatch.setattr(module, "leaves_too_much", lambda _: "")
    monkeypatch.setattr(module, "within_load_cells", lambda *_: "")
    monkeypatch.setattr(module, "told_by_chance", lambda _: "")
    search, own = searched(Slot("signal_delay", "", (0,), origin=ORIGIN)), side()
    own.runs = (SimpleNamespace(dt=0.01), SimpleNamespace(dt=0.02))
    found = SimpleNamespace(parameters={"signal_delay": {"tau": SimpleNamespace(value=late)}})
    trial = Trial(search, found, side(), own)
    full, why = module._stands(search, trial, lambda _: trial, RNG)
    assert (full is trial) is stands
    assert ("7 ms is how a log of a sample every 20 ms is made" in why) is not stands


@pytest.mark.parametrize(("free", "stands"), [(False, True), (True, False)])
def test_a_curve_that_leaves_much_of_the_training_runs_does_not_stand_by_the_locked_ones(monkeypatch, free, stands):
    monkeypatch.setattr(module, "unproven", lambda *_: "")
    monkeypatch.setattr(module, "leaves_too_much", lambda _: "")
    monkeypatch.setattr(module, "within_load_cells", lambda *_: "")
    monkeypatch.setattr(module, "told_by_chance", lambda _: "")
    search = searched(replace(SLOTS[0], free=free), verdict=Verdict(UNEXPLAINED, "it leaves much", leaves=True))

    def trial_of(own):
        return Trial(own, SimpleNamespace(parameters={}), side(), side())

    assert (module._stands(search, trial_of(search), trial_of, RNG)[0] is not None) is stands


@pytest.mark.parametrize(("plain", "sets"), [(False, 2), (True, 1)])
def test_fewer_names_are_tried_unless_one_is_what_every_machine_has(monkeypatch, plain, sets):
    monkeypatch.setattr(module, "_with_at_most", lambda count, own, _: own)
    assert len(list(module._sets(searched(SLOTS[0], replace(SLOTS[1], plain=plain)), RNG))) == sets


@pytest.mark.parametrize(("other", "apart"), [("one", [True]), ("two", [])])
def test_of_one_cause_by_two_laws_it_is_asked_whether_it_is_two(monkeypatch, other, apart):
    asked = []
    monkeypatch.setattr(module, "_with_at_most", lambda count, own, _: own)
    monkeypatch.setattr(module, "decided", lambda own, *_: own)
    monkeypatch.setattr(module, "select", lambda cross, rng, apart=False: asked.append(apart))
    list(module._sets(searched(SLOTS[0], replace(SLOTS[1], name=other, law="bent")), RNG))
    assert asked == apart


def test_of_two_names_each_gives_way_to_its_rivals_where_the_locked_runs_refuse_them(monkeypatch):
    """Last of all, and in its own place: beside a coarse law of the first, a wrong second one may do better."""
    monkeypatch.setattr(module, "_with_at_most", lambda count, own, _: replace(own, selection=explained_by(own, count)))
    monkeypatch.setattr(module, "with_fewer", lambda _, own, slots, rng: replace(own, final=explained(slots)))
    monkeypatch.setattr(module, "decided", lambda own, selection, _: replace(own, selection=selection))

    def explained_by(own, count):
        return replace(own.selection, final=explained(own.selection.final.slots[:count]))

    def asked(*slots):
        search = searched(*slots)
        found = [replace(each, rivals=(SLOTS[2 + k % 2],)) for k, each in enumerate(search.selection.found)]
        own = replace(search, selection=replace(search.selection, found=tuple(found)))
        return [each.selection.final.names for each in module._sets(own, RNG)]

    assert asked(*SLOTS[:2]) == [("one", "two"), ("one",), ("three", "two"), ("one", "four")]
    assert asked(*SLOTS[:3])[-1] == ("one",)  # of three, what company imitates is too much


def test_a_name_has_no_more_rivals_than_a_set_has_room_for(monkeypatch):
    """Three dropped names do as well alone; a set has room for three in all."""
    monkeypatch.setattr(several, "adds", lambda *_: False)
    every, one = searched(*SLOTS), searched(SLOTS[0])
    found = several._with_those_as_good_alone(
        Trial(one, None, side(), side()), every, SLOTS[1:], lambda own: Trial(own, None, side(), side()), RNG
    )
    assert found.search.selection.found[0].rivals == SLOTS[1 : LIMITS.most_names]


def test_what_does_as_well_as_a_step_of_a_transducer_does_not_stand(monkeypatch):
    """A search that lists a gear before the tare within a step, which does as well, has found neither."""
    search = searched(SLOTS[0])
    search = replace(search, selection=replace(search.selection, found=(Finding(SLOTS[0], SLOTS[1:2], 0.0, 0.1, 1.0),)))
    full = SimpleNamespace(train=side(), holdout=side(), repaired=SimpleNamespace(parameters={}), search=search)
    for name in ("unproven", "leaves_too_much", "leaves_most", "fits_only_its_own", "within_a_sample"):
        monkeypatch.setattr(module, name, lambda *_: "")
    monkeypatch.setattr(module, "nobodys", lambda _: False)

    def within(cross, fitted, least):
        return "a step" if any("two" in each.names for each in fitted) else ""

    monkeypatch.setattr(module, "within_a_step", within)
    stands, why = module._stands(search, SimpleNamespace(holdout=side()), lambda _: full, RNG)
    assert (stands, why) == (None, "a step")


# -- an effect with an instant, placed by the locked runs' first halves
def shaped(name, columns, law=""):
    return Slot(name, f"at {columns}", columns, law=law, origin=ORIGIN)


def test_shapes_that_are_one_over_the_training_runs_are_those_of_the_same_law_with_the_same_columns():
    x = np.arange(12.0).reshape(4, 3)
    x = np.column_stack([x, x[:, 0], 2.0 * x[:, 0], x[:, 0]])
    own, same, larger, bent, other = (
        shaped("step", (0,)), shaped("step", (3,)), shaped("step", (4,)), shaped("step", (5,), "bent"),
        shaped("wave", (5,)),
    )  # fmt: skip
    cross = SimpleNamespace(
        problem=SimpleNamespace(blocks=SimpleNamespace(x=x), slots=(own, same, larger, bent, other))
    )
    assert same_columns(cross, own) == [same]
    assert same_columns(cross, larger) == []


def test_an_effect_stands_at_the_instant_that_leaves_least_of_the_locked_runs_first_halves():
    """The second halves would say another one, but on them the names are proven."""
    early, late, other = shaped("step", (0,)), shaped("step", (1,)), shaped("wave", (2,))
    run = np.repeat([0, 1], 4)
    blocks = SimpleNamespace(run=run, position=np.tile(np.arange(4), 2))
    first = np.tile([True, True, False, False], 2)
    left = {early.label: np.where(first, 3.0, 0.0), late.label: np.where(first, 1.0, 9.0)}
    locked = SimpleNamespace(problem=SimpleNamespace(blocks=blocks), remainder=lambda each: -left[each.slots[1].label])
    assert left_of_first_halves(locked, SimpleNamespace(slots=(other, late))) == pytest.approx(4.0)

    @dataclass(frozen=True)
    class Explained:
        slots: tuple

    def cross_of(names, known):
        assert (names, known) == (("locked",), (other, early))
        return locked

    found = tuple(Finding(slot, (), 0.0, 0.1, 1.0) for slot in (other, early))
    search = replace(
        searched(other, early), selection=Selection(Explained(()), Explained((other, early)), found),
        cross=SimpleNamespace(explain=Explained),
    )  # fmt: skip
    asked = Placed(**vars(search), expansion=SimpleNamespace(cross=cross_of))
    told = module._told(asked, 1, [early, late], SimpleNamespace(holdout=("locked",)))
    assert told.selection.final.slots == (other, late)
    assert [each.slot for each in told.selection.found] == [other, late]


@dataclass(frozen=True)
class Placed(Searched):
    expansion: object = None


@pytest.mark.parametrize(
    ("train", "locked", "which", "left"),
    [(1.0, 5.0, "locked", "5"), (5.0, 1.0, "training", "5"), (5.0, 6.0, "locked", "6")],
)
def test_without_a_name_it_is_said_which_runs_keep_more_than_noise(monkeypatch, train, locked, which, left):
    monkeypatch.setattr(module, "unexplained", lambda search, why, rng: why)
    trial = Trial(searched(), None, side(train), side(locked))
    why = module._judged(trial, "a reason", None)
    assert why == f"a reason; a refit without a name leaves the {which} runs {left}, noise 1"
    assert module._judged(trial, "", None).startswith("a refit")


@pytest.mark.parametrize("which", ["locked", "training"])
def test_nothing_is_missing_only_where_the_slowest_blocks_keep_no_more_than_noise(monkeypatch, which):
    """A break-away that no law told left 1.3 noises of the locked runs, and 2.6 of their slowest tenth."""
    monkeypatch.setattr(module, "unexplained", lambda search, why, rng: why)
    sides = {"locked": side(1.3), "training": side(1.2)}
    quiet = Trial(searched(), None, sides["training"], sides["locked"])
    assert module._judged(quiet, "", None).verdict.kind == NOTHING
    sides[which] = side(1.3, slowest=1.9)
    trial = Trial(searched(), None, sides["training"], sides["locked"])
    assert module._judged(trial, "", None).verdict.kind == NOTHING
    sides[which].slowest = 2.1
    said = f"noise 1; the slowest tenth of the {which} ones keeps 2.1"
    assert module._judged(trial, "", None).endswith(said)
    beside = Trial(searched(ripple="a slow one is in the blocks' means"), None, sides["training"], sides["locked"])
    assert module._judged(beside, "", None).verdict.kind == MISSING


@pytest.mark.parametrize(("slowest", "refused"), [(1.2, True), (1.3, False)])
def test_a_name_for_low_speeds_is_not_asked_what_it_takes_of_all(monkeypatch, slowest, refused):
    rules = ("unproven", "leaves_too_much", "leaves_most", "fits_only_its_own", "within_a_sample", "within_a_step")
    for name in (*rules, "within_load_cells", "told_by_chance", "may_be_none", "_chosen_not_whole"):
        monkeypatch.setattr(module, name, lambda *_: "")
    monkeypatch.setattr(module, "takes_little", lambda *_: True)
    search = searched(SLOTS[0])
    full = Trial(search, SimpleNamespace(parameters={}), side(), side())
    trial, why = module._stands(search, SimpleNamespace(holdout=side(1.1, slowest=slowest)), lambda _: full, RNG)
    assert (trial is None, "too little of the locked runs" in why) == (refused, refused)


def test_a_file_says_who_made_it_of_what_and_by_which_chance():
    study = SimpleNamespace(split=SimpleNamespace(train=("a", "b")), options=SimpleNamespace(seed=7))
    assert module._provenance(study, searched(verdict=Verdict(UNEXPLAINED))) == {
        "repaired_by": "winch-friction gap", "verdict": UNEXPLAINED, "trained_on": ["a", "b"], "seed": 7,
    }  # fmt: skip
