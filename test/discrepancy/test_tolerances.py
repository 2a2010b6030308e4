"""A delay within a sample and a zero within a transducer's step are no names, whatever they take off a gap."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import estimates
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.candidates.signals import within_load_cells
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.estimates import (
    MIMICS,
    InFile,
    SeedRefuted,
    _cost,
    _inflated,
    _surprise,
    agreed,
    estimates_of,
    in_file,
    of_part,
    takes_little,
    together,
    try_seed,
    widened,
    within_a_sample,
    within_a_step,
)
from winch_friction.discrepancy.regressors import key_of
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.correction import Correction

WARMTH = np.linspace(-1.0, 1.0, 201)


@pytest.mark.parametrize(("late", "step", "named"), [(0.004, 0.02, False), (0.014, 0.01, True), (0.014, 0.02, True)])
def test_a_delay_within_half_a_sample_is_no_name(late, step, named):
    found, side = {"tau": SimpleNamespace(value=-late)}, SimpleNamespace(runs=[SimpleNamespace(dt=step)])
    assert (within_a_sample({"signal_delay": found}, side) == "") is named
    assert within_a_sample({}, side) == ""


@pytest.mark.parametrize("name", ["pressure_offset", "torque_offset", "tare_load"])
@pytest.mark.parametrize(
    ("zero", "drift", "named"),
    [(0.0, 0.2, False), (0.1, 0.15, False), (0.2, 0.0, True), (0.0, 0.3, True), (-0.2, 0.0, True), (-0.1, 0.0, False)],
)
def test_a_zero_within_a_step_is_no_name_however_it_moves(zero, drift, named, name):
    """0.2 bar over the warmth are 0.12 in the mean; a 12-bit transducer of 600 bar steps by 0.15 bar. 13 kg of 15 t,
    by which a load cell and a drive's torque were off, were a tare of a winch that lacks nothing."""
    zeros = Slot(name, "thermal zero shift", (1, 2))
    x = np.column_stack([np.full(201, 9.0), np.ones(201), WARMTH])
    problem = SimpleNamespace(
        blocks=SimpleNamespace(x=x), columns=lambda slots: (0, *(c for s in slots for c in s.columns))
    )
    fitted = SimpleNamespace(slots=(zeros,), beta=np.array([5.0, zero, drift]))
    assert (within_a_step(SimpleNamespace(problem=problem), [fitted], 0.1) == "") is named


def test_what_does_as_well_as_a_zero_within_a_step_is_no_name_either():
    """Once the tare was refused its rival, a gear's friction one way that hardly follows the load, had its name."""
    zero, gear = Slot("tare_load", "", (1,)), Slot("gear_asymmetry", "", (2,))
    x = np.column_stack([np.full(201, 9.0), np.ones(201), 1.0 + 0.01 * WARMTH])
    problem = SimpleNamespace(
        blocks=SimpleNamespace(x=x), columns=lambda slots: (0, *(c for s in slots for c in s.columns))
    )
    one, other = (SimpleNamespace(slots=(slot,), beta=np.array([5.0, 0.1])) for slot in (gear, zero))
    assert within_a_step(SimpleNamespace(problem=problem), [one], 0.1) == ""
    assert within_a_step(SimpleNamespace(problem=problem), [one, other], 0.1)


def test_another_name_of_that_size_is_none_of_a_transducers_zeros():
    gain = Slot("pressure_scale", "", (1, 2))
    problem = SimpleNamespace(blocks=SimpleNamespace(x=np.ones((9, 3))), columns=lambda slots: (0, 1, 2))
    fitted = SimpleNamespace(slots=(gain,), beta=np.array([0.0, 0.01, 0.0]))
    assert within_a_step(SimpleNamespace(problem=problem), [fitted], 0.1) == ""


@pytest.mark.parametrize(
    ("share", "warmth", "friction", "granted", "named"),
    [
        (-7e-4, 1.5e-5, 0.02, 2e-4, False),  # what a null had: 0.02 % from run to run, in order with the oil by chance
        (-7e-4, 4.5e-5, 0.02, 2e-4, True),  # more than cells repeat to
        (-7e-4, 1.5e-5, 0.02, -8e-4, True),  # with what the base grants beyond a calibrated cell's tolerance
        (-7e-4, 1.5e-5, 0.2, 2e-4, True),  # no level alone: it changes within the runs
        (0.0, 0.0, 0.0, 0.0, False),
        (0.0, 1.5e-5, 0.09, 2e-4, True),  # friction, of which a little is levels, as a break-away's at low speed is
        (-2e-4, 0.0, 0.03, 2e-4, False),
    ],
)
def test_levels_that_load_cells_repeat_to_are_no_name(share, warmth, friction, granted, named):
    """Of a null whose load cell was off by another 0.03 % in each run a gain "shifted with the oil"."""
    oil = np.repeat(np.linspace(-20.0, 15.0, 12), 40)
    load, way = np.repeat(np.linspace(60.0, 500.0, 12), 40), np.tile([1.0, -1.0], 240)
    x = np.column_stack([5e-4 * load, load, oil * load, way])
    base = SimpleNamespace(names=("weight",), scale=np.array([5e-4]), upper=np.array([2.0]))
    blocks = SimpleNamespace(x=x, run=np.repeat(np.arange(12), 40))
    problem = SimpleNamespace(blocks=blocks, base=base, columns=lambda _: (0, 1, 2, 3))
    fitted = SimpleNamespace(slots=("one",), beta=np.array([granted / 5e-4, share, warmth, friction]))
    cross, none = SimpleNamespace(problem=problem), SimpleNamespace(slots=())
    assert (within_load_cells(cross, [none, fitted], 0.1) == "") is named
    blocks.x = x * np.array([0.0, 1.0, 1.0, 1.0])  # no load was weighed
    assert within_load_cells(cross, [none, fitted], 0.1) == ""


@pytest.mark.parametrize(
    ("whole", "left", "little"),
    [(0.77, 0.72, True), (0.77, 0.3, False), (-0.8, -0.9, True), (0.0, -0.5, True), (9.0, 4.6, True)],
)
def test_names_that_take_less_than_half_of_what_a_refit_leaves_take_little(whole, left, little):
    """A ripple's remains were 0.77 of the noise's square; a high-pressure loss took a fifteenth of it and was named."""
    assert (
        takes_little(SimpleNamespace(excess=lambda each: {"refit": whole, "names": left}[each]), "refit", "names")
        is little
    )


def test_a_delay_is_held_against_the_slowest_log_and_both_are_said_in_ms():
    found = {"tau": SimpleNamespace(value=0.001), "tau_2": SimpleNamespace(value=-0.009)}
    side = SimpleNamespace(runs=[SimpleNamespace(dt=0.01), SimpleNamespace(dt=0.02)])
    why = within_a_sample({"signal_delay": found}, side)
    assert why == "a delay of 9 ms is how a log of a sample every 20 ms is made"


def test_a_zero_within_a_step_is_said_with_its_size_and_the_step():
    zeros = Slot("pressure_offset", "", (1,))
    problem = SimpleNamespace(blocks=SimpleNamespace(x=np.full((9, 2), 2.0)), columns=lambda _: (0, 1))
    fitted = SimpleNamespace(slots=(zeros,), beta=np.array([5.0, 0.04]))
    why = within_a_step(SimpleNamespace(problem=problem), [fitted], 0.1)
    assert why == f"a zero of 0.08 is within the {0.1 * LIMITS.step:.2g} by which a transducer steps"


# -- estimates
def shaped(label, law="", **values):
    linear = (SimpleNamespace(name="a", unit="kg"), SimpleNamespace(name="b", unit="kg/m"))
    parameters = [*linear, *(SimpleNamespace(name=name, unit="s") for name in values)]
    candidate = SimpleNamespace(linear=linear, term=SimpleNamespace(parameters=parameters) if values else None)
    return Slot("wave", label, (1, 2), law=law, origin=(candidate, SimpleNamespace(values=values)))


def known_by(slots, seen=(1.0, 1.0, 1.0)):
    return SimpleNamespace(problem=SimpleNamespace(slots=slots), total_g=np.diag(seen))


@pytest.mark.parametrize(("seen", "names"), [((1.0, 1.0, 1.0), ["a", "b"]), ((1.0, 1.0, 0.0), ["a"])])
def test_an_amplitude_of_which_the_runs_say_nothing_is_no_estimate(seen, names):
    own = shaped("all")
    found = estimates_of(own, np.array([2.0, 3.0]), np.array([0.2, 0.3]), known_by((own,), seen))
    every = {"a": ParameterEstimate(2.0, 0.2, "kg"), "b": ParameterEstimate(3.0, 0.3, "kg/m")}
    assert found == {name: every[name] for name in names}


@pytest.mark.parametrize(
    ("at", "others", "std"),
    [
        (5.0, (4.0, 7.0), 0.5),  # a tenth of it, for the grid is wider
        (5.0, (), 0.5),
        (1000.0, (990.0, 1030.0), 5.0),  # half the way to the next one
        (-1000.0, (-990.0, -1030.0), 5.0),
        (1000.0, (990.0, 1200.0), 100.0),
    ],
)
def test_a_shape_is_known_to_a_tenth_or_to_half_the_way_to_the_next(at, others, std):
    """Of its own law alone, and an amplitude of it is one although the runs hardly see it."""
    own = shaped("own", t=at)
    slots = (own, *(shaped("", t=other) for other in others), shaped("", "bent", t=at + 0.1))
    found = estimates_of(own, np.array([2.0, 3.0]), np.array([0.2, 0.3]), known_by(slots, (1.0, 0.0, 0.0)))
    assert set(found) == {"a", "b", "t"}
    assert found["t"] == ParameterEstimate(at, pytest.approx(std), "s")


def test_what_two_laws_of_a_cause_both_have_adds_and_the_rest_of_either_stays():
    a, b, c = (ParameterEstimate(value, std, "kg") for value, std in ((3.0, 0.3), (-1.0, 0.4), (7.0, 0.1)))
    both = together({"x": a, "y": c}, {"x": b, "z": c})
    assert both == {"x": ParameterEstimate(2.0, pytest.approx(0.5), "kg"), "y": c, "z": c}


def test_an_estimate_is_what_its_correction_has_beside_what_the_model_had():
    """By a factor that may turn its sign; its deviation has none."""
    read = InFile("offset", -2.0, 3.0).read(Correction("pressure_offset", 9.0, 4.0), "Pa")
    assert read == ParameterEstimate(-3.0, 2.0, "Pa")
    assert InFile("offset", 1.0, 0.0).read(Correction("pressure_offset", 9.0), "Pa").std == 0.0


def test_estimates_stand_where_both_laws_say_that_they_stand():
    one, other = InFile("a", 1.0, 0.0), InFile("b", 1.0, 0.0)
    found = agreed({"x": one, "y": one, "z": one}, {"x": one, "y": other, "w": other})
    assert found == {"x": one, "y": None, "z": one, "w": other}


# -- the seed
def test_a_seed_is_widened_by_as_much_as_its_refutation_allows(crane2_model):
    given = SimpleNamespace(model=crane2_model)
    factor = LIMITS.seed_reach / LIMITS.prior_bound
    found = _widened(given)
    np.testing.assert_allclose(found.std, factor * np.array(crane2_model.std))
    assert found.values == crane2_model.values


def _widened(given):
    @dataclass(frozen=True)
    class Whole:
        model: object

    return widened(Whole(given.model)).model


def test_a_careless_seed_costs_its_data_its_shift_and_one_factor():
    """Four deviations of 3: their mean square is 9, and by a factor of 3 each is what one expects."""
    shift = np.array([3.0, -3.0, 3.0, -3.0])
    price = LIMITS.effect_price / 2.0
    assert _inflated(100.0, shift) == pytest.approx(100.0 / LIMITS.prior_weight + 4.0 + 4.0 * np.log(9.0) + price)
    small = np.array([0.5, -0.5])  # no seed is better than it says
    assert _inflated(100.0, small) == pytest.approx(100.0 / LIMITS.prior_weight + 0.5 + price)


def test_names_cost_their_data_what_the_base_moves_and_a_price_each():
    cross = SimpleNamespace(problem=SimpleNamespace(base=SimpleNamespace(shift=np.array([1.0, -1.0, 9.0]))))
    own = SimpleNamespace(beta=np.array([1.0, 0.0, 5.0, 7.0]), train_loss=100.0, slots=("a", "b", "c"))
    wanted = 100.0 / LIMITS.prior_weight + 2.0**2 + 1.0 + 3.0 * LIMITS.effect_price
    assert _cost(cross, own, 2) == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("posterior", "shift", "sigma", "marginal"),
    [
        ((0.0, 0.0), (3.0, 0.0), 2.54, (3.0, 0.0)),  # chi-squared of two: 9.0 is one in 90
        ((0.0, 1.0), (3.0, 9.0), 3.0, (3.0, 0.0)),  # of the second the data say nothing
        ((0.75, 0.75), (1.5, 0.0), 0.0, (0.0, 0.0)),  # a quarter of the prior's variance is hardly told
        ((0.0, 0.36), (0.0, -2.4), 2.54, (0.0, -3.0)),
    ],
)
def test_a_shift_surprises_by_what_the_data_could_have_told_of_it(posterior, shift, sigma, marginal):
    problem = SimpleNamespace(covariance=lambda *_: np.diag([*posterior, 7.0]), columns=lambda _: (0, 1, 2))
    found, each = _surprise(SimpleNamespace(problem=problem, total_g=None), np.array(shift), 2)
    assert found == pytest.approx(sigma, abs=0.01)
    assert each == pytest.approx(marginal)


def test_a_refuted_seed_is_written_with_its_shifts_and_what_they_pass_for():
    assert SeedRefuted({"K1": 3.5, "C2": -4.0}, 5.0, ("viscous",)).content() == {
        "parameters": ["K1", "C2"], "sigma": 5.0, "shifts": {"K1": 3.5, "C2": -4.0}, "mimics": ["viscous"],
    }  # fmt: skip


# -- where a file says an estimate
TARE, SCALE = Correction("tare_load", 40.0), Correction("pressure_scale", 0.01)


def placed(corrects, a=8.0, b=0.5):
    found = {"a": ParameterEstimate(a, 2.0, "kg"), "b": ParameterEstimate(b, 0.1, "1")}
    slot = Slot("wrong", "", (1,), origin=(SimpleNamespace(corrects=corrects), "shape"))
    return in_file(slot, found, "sides", {key_of(TARE): TARE})


def at(found):
    return found["a"].value, found["b"].value


@pytest.mark.parametrize("a", [8.0, 0.0, -3.0])
def test_an_estimate_stands_in_the_one_correction_that_it_alone_moves_by_so_much_beside_what_was_there(a):
    def corrects(found, shape, sides):
        assert (shape, sides) == ("shape", "sides")
        return [replace(TARE, value=-2.0 * at(found)[0] + 1.0), replace(SCALE, value=0.25 * at(found)[1])]

    found = placed(corrects, a)
    assert found["a"] == InFile(key_of(TARE), pytest.approx(-2.0), 40.0)
    assert found["b"] == InFile(key_of(SCALE), pytest.approx(0.25), 0.0)


def test_what_is_cut_at_a_bound_has_the_slope_that_it_has_inside():
    found = placed(lambda found, *_: [replace(TARE, value=min(3.0 * at(found)[0], TARE.bounds[1]))], 1e6)
    assert found == {"a": InFile(key_of(TARE), pytest.approx(3.0), 40.0), "b": None}


@pytest.mark.parametrize(
    "corrects",
    [
        None,
        lambda found, *_: [replace(TARE, value=at(found)[0] + at(found)[1])],  # two in one
        lambda found, *_: [replace(TARE, value=at(found)[0]), replace(SCALE, value=0.001 * at(found)[0])],  # one in two
        lambda found, *_: [TARE],
    ],
)
def test_an_estimate_that_shares_a_correction_or_goes_into_several_stands_nowhere(corrects):
    assert placed(corrects) == {"a": None, "b": None}


def test_zeros_of_several_feedbacks_are_told_apart_by_their_labels():
    every, port, other = (
        Slot("zero", label, (k,), part=part)
        for k, (label, part) in enumerate(
            (("all groups, both ports", ""), ("main, port A", "a"), ("main, port B", "b"))
        )
    )
    stranger = Slot("delay", "late", (9,), part="c")
    found = {"offset": 1.0}
    assert of_part(port, [port, stranger], found) is found
    assert of_part(port, [port, other], found) == {"offset of main": 1.0}
    assert of_part(port, [every, port], found) == {"offset of main, beside that of all": 1.0}
    assert of_part(every, [every, port], found) == {"offset of all groups": 1.0}


# -- the seed on trial
MODEL = FrictionModel(
    "seed", (term_named("coulomb"), term_named("viscous"), term_named("brake_drag")), (50.0, 1.0, 5.0), np.eye(3)
)
NAMES = MODEL.parameter_names
BOUND, ORDINARY = LIMITS.prior_bound, LIMITS.ordinary_shift


def tried(monkeypatch, shift, sigma=9.0, marginal=(0.0,), names=(), else_=False, cost=100.0, named=0.0, model=MODEL):
    """A trial of a base that is off by `shift` already and moves by nothing more; `cost`: of the freed base."""
    base = SimpleNamespace(parameters=3, shift=np.array([*shift, 77.0]))
    wide = SimpleNamespace(problem=SimpleNamespace(base=base), train_loss=lambda _: (cost, np.zeros(4)))
    monkeypatch.setattr(estimates, "_wide", lambda _: wide)
    monkeypatch.setattr(estimates, "_surprise", lambda *_: (sigma, np.array(marginal)))
    monkeypatch.setattr(estimates, "_something_else", lambda *_: else_)
    monkeypatch.setattr(estimates, "_cost", lambda *_: named)
    monkeypatch.setattr(estimates, "_inflated", lambda loss, shift: loss)
    slots = tuple(SimpleNamespace(name=name) for name in names)
    findings = [SimpleNamespace(slot=slot, rivals=(SimpleNamespace(name=f"not {slot.name}"),)) for slot in slots]
    selection = SimpleNamespace(final=SimpleNamespace(slots=slots), found=findings)
    search = SimpleNamespace(given=SimpleNamespace(model=model), cross=None, selection=selection)
    return try_seed(search, None)


FAR, CARELESS = (BOUND + 1.0, -BOUND - 3.0, 0.1), (BOUND + 1.0, -ORDINARY + 0.1, 0.1)


@pytest.mark.parametrize(
    ("asked", "enough", "refuted"),
    [
        ({"sigma": LIMITS.seed_sigma - 0.01}, False, False),
        ({"sigma": LIMITS.seed_sigma + 0.01}, True, True),
        ({"sigma": 0.0, "marginal": (0.0, -LIMITS.seed_marginal - 0.01)}, True, True),
        ({"sigma": 0.0, "marginal": (0.0, -LIMITS.seed_marginal + 0.01)}, False, False),
        (
            {"sigma": 0.0, "names": ("viscous",), "named": 101.0},
            True,
            False,
        ),  # it does what the name does, and surprises nobody
        ({"sigma": 0.0, "names": ("viscous",), "named": 99.0 - LIMITS.effect_price}, False, False),
        ({"else_": True}, False, False),
        ({"names": ("viscous",), "named": 101.0}, True, True),
        # a careless seed is off in several parameters, and has the price of a name more
        ({"names": ("viscous",), "named": 101.0 - LIMITS.effect_price}, True, True),
        ({"names": ("viscous",), "named": 99.0 - LIMITS.effect_price}, False, False),
        ({"names": ("viscous",), "named": 99.0, "shift": (BOUND + 1.0, 0.0, 0.0)}, False, False),
        ({"names": ("viscous",), "named": 99.0, "shift": (BOUND + 1.0, ORDINARY + 0.1, 0.0)}, False, False),
        ({"names": (), "named": -1e9}, True, True),
        ({"model": MODEL.with_covariance(None)}, False, False),
    ],
)
def test_a_seed_is_refuted_where_its_shift_surprises_and_does_all_that_the_names_do(
    monkeypatch, asked, enough, refuted
):
    found = tried(monkeypatch, **{"shift": CARELESS, **asked})
    assert (found.enough, found.refuted is not None) == (enough, refuted)


def test_a_refuted_seed_tells_the_parameters_that_want_most_and_what_names_they_would_pass_for(monkeypatch):
    found = tried(monkeypatch, FAR, sigma=4.0, marginal=(0.0, -8.0, 1.0), names=("churning",), named=1e9).refuted
    assert list(found.shifts) == [NAMES[1], NAMES[0]]
    assert found.shifts == {NAMES[1]: -BOUND - 3.0, NAMES[0]: BOUND + 1.0}
    assert found.sigma == 8.0
    own = [name for each in (NAMES[1], NAMES[0]) for name in MIMICS.get(each, ())]
    assert found.mimics == tuple(dict.fromkeys(["churning", "not churning", *own]))
    alone = tried(monkeypatch, (0.1, -0.9 * BOUND, 0.2), sigma=6.0, marginal=(1.0,)).refuted
    assert (alone.shifts, alone.sigma) == ({NAMES[1]: -0.9 * BOUND}, 6.0)


def test_a_freed_base_has_room_for_its_reach_inside_its_bounds(monkeypatch):
    """Of what it has moved from the seed already, by `shift`, the room is taken off."""
    monkeypatch.setattr(estimates, "CrossFit", lambda problem: problem)
    reach = LIMITS.seed_reach
    base = SimpleNamespace(parameters=3, shift=np.array([1.0, -1.0, 0.0]), scale=np.array([0.5, 0.1, 0.1]))

    @dataclass(frozen=True)
    class Part:
        """A layout, or the problem that has it."""

        lower: object = None
        upper: object = None
        layout: object = None
        base: object = None

    layout = Part(np.array([-1.0, -1.0, -1.0, -7.0]), np.array([1.0, 1.0, 1.0, 7.0]))
    bounds = {NAMES[0]: (48.0, 51.5), NAMES[1]: (-1e9, 1e9), NAMES[2]: (8.0, 1e9)}
    at_bound = replace(MODEL, values=(50.0, 1.0, 9.0), bounds=bounds)
    search = SimpleNamespace(
        cross=SimpleNamespace(problem=Part(layout=layout, base=base)),
        given=SimpleNamespace(model=at_bound), expansion=SimpleNamespace(model=MODEL),
    )  # fmt: skip
    found = estimates._wide(search).layout
    assert found.lower == pytest.approx([-4.0, -reach + 1.0, 0.0, -7.0])
    assert found.upper == pytest.approx([3.0, reach + 1.0, reach, 7.0])
    assert layout.lower.tolist() == [-1.0, -1.0, -1.0, -7.0]


@pytest.mark.parametrize(
    ("freed", "named", "steady", "something"),
    [
        (5.0, 5.0 / LIMITS.as_much + 0.1, 0.0, False),  # hardly more than the names keep
        (5.0, 5.0 / LIMITS.as_much - 0.1, 0.0, True),
        (5.0, None, 0.0, True),
        (0.0, None, 5.0, True),  # what does not change from block to block counts as well
        (0.0, None, 0.0, False),
    ],
)
def test_a_freed_base_that_keeps_what_the_names_do_not_is_not_the_cause(monkeypatch, freed, named, steady, something):
    monkeypatch.setattr(estimates, "telling", lambda wide, depends: depends)
    monkeypatch.setattr(estimates, "dependences", lambda *_: ["depends"])
    monkeypatch.setattr(estimates, "steady_excess", lambda *_: steady)
    monkeypatch.setattr(estimates, "keeps_something", lambda after, before, depends: (after, before) == (5.0, 8.0))
    final = SimpleNamespace(slots=() if named is None else ("name",))
    wide = SimpleNamespace(inside_excess=lambda each: freed if each == "freed" else 8.0, remainder=lambda each: each)
    cross = SimpleNamespace(inside_excess=lambda each: named)
    search = SimpleNamespace(selection=SimpleNamespace(base="base", final=final), cross=cross)
    assert estimates._something_else(wide, "freed", search, None) is something
