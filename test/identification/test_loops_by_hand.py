"""The practice with fits that answer as they are told: what is fitted to what, when it ends, what is said of it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification import system_fit, system_identification
from winch_friction.identification.motor_models import MOTOR_MODELS, grown, motor_model_named, room
from winch_friction.identification.system_fit import EQUATION_8, EQUATION_10, Loop, combined, second_loop, system_start
from winch_friction.identification.system_identification import SystemIdentification, Test, cost_of, winch_seed
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, Parameter, term_named
from winch_friction.physics.friction.correction import Correction

COULOMB, VISCOUS = term_named("motor_coulomb"), term_named("viscous")
MOTOR = FrictionModel("motor", (COULOMB,), (14.0,), bounds={"K4": (0.0, 99.0)}, constants={"density": 900.0},
                      covariance=np.array([[4.0]]))  # fmt: skip
SYSTEM = FrictionModel("system", (VISCOUS,), (0.2,), bounds={"C5": (0.0, 7.0)},
                       constants={"density": 800.0, "gear_ratio": 250.0}, covariance=np.array([[0.09]]))  # fmt: skip


# -- paper 1's models
def test_a_motor_of_twice_the_size_rubs_twice_and_chokes_less():
    """Papers 1 and 2: friction with the volume, ports with its square of length, K3 a share."""
    double = 430.0 * CM3_PER_REV
    assert {name: grown(name, double) for name in ("K1", "K2", "K3", "K4", "K5", "Cf")} == pytest.approx(
        {"K1": 2.0, "K2": 2.0 ** (-4.0 / 3.0), "K3": 1.0, "K4": 2.0, "K5": 2.0, "Cf": 1.0}
    )
    assert grown("K4", 215.0 * CM3_PER_REV) == pytest.approx(1.0)
    own = Parameter("K4", "N*m", 14.0, lower=1.0, upper=200.0)
    assert (room(own, double), room(own, 0.25 * double)) == (pytest.approx((1.0, 400.0)), (1.0, 200.0))


def test_the_models_are_what_the_paper_says_of_them():
    assert motor_model_named("MJ4") is motor_model_named("mj4") is MOTOR_MODELS["mj4"]
    found = {name: (each.year, each.kind, each.displacement[0], each.signed) for name, each in MOTOR_MODELS.items()}
    assert found == {
        "wilson": (1948, "physical", "f", False), "schlosser": (1961, "physical", "f", False),
        "thoma": (1969, "physical", "v", False), "pacey": (1979, "physical", "v", False),
        "huhtala": (1997, "numerical", "v", True), "ortwig": (2002, "numerical", "v", True),
        "jeong": (2007, "physical", "f", False), **dict.fromkeys(("mj1", "mj2", "mj3"), (2017, "physical", "v", False)),
        **dict.fromkeys(("mj4", "mj5", "mj6"), (2017, "physical and numerical", "v", False)),
    }  # fmt: skip


@pytest.mark.parametrize("name", sorted({each for model in MOTOR_MODELS.values() for each in model.terms}))
def test_a_typical_term_costs_what_one_of_a_motors_losses_costs(name):
    """At 2000 rpm, full swivel and the side of 200 bar that is its own: 0.5 to 100 N m of about 1000."""
    term, largest = term_named(name), 215.0 * CM3_PER_REV
    model = FrictionModel(
        name, (term,), tuple(p.typical for p in term.parameters), constants={"max_displacement": largest}
    )
    points = [point_of(pressure, largest) for pressure in (150e5, 300e5)]
    assert 0.5 < max(float(model.torque(point)) for point in points) < 100.0
    for each in term.parameters:
        assert each.shape or each.upper >= 10.0 * each.typical  # a fit has room


def point_of(pressure, displacement):
    from winch_friction.identification.supplier_table import motor_points

    return motor_points(209.4, pressure, displacement)


# -- motor and system in one
def test_motor_and_system_stand_side_by_side_and_the_motors_constants_count():
    both = combined(MOTOR, SYSTEM, "both")
    assert (both.name, both.term_names, both.values) == ("both", ("motor_coulomb", "viscous"), (14.0, 0.2))
    assert (dict(both.bounds)["K4"], dict(both.bounds)["C5"]) == ((0.0, 99.0), (0.0, 7.0))
    assert dict(both.constants) == {"density": 900.0, "gear_ratio": 250.0}
    assert both.covariance.tolist() == [[4.0, 0.0], [0.0, 0.09]]
    for one, other in ((MOTOR.with_covariance(None), SYSTEM), (MOTOR, SYSTEM.with_covariance(None))):
        assert combined(one, other, "both").covariance is None
    assert Loop(3, MOTOR, SYSTEM, 1.0, 2).model.name == "loop_3"


def test_a_system_is_the_papers_terms_at_their_typical_values():
    assert EQUATION_8 == ("stribeck", "coulomb", "viscous", "gear_load_loss")
    assert system_start().term_names == EQUATION_10 == ("stribeck", "viscous", "gear_load_loss")
    start = system_start(EQUATION_8)
    assert start.values == tuple(parameter.typical for parameter in start.parameters)


class Data:
    """Observations that know what was taken off them."""

    def __init__(self, *without):
        self.off = without

    def without(self, model):
        return Data(*self.off, model.name)


def looped(monkeypatch, costs, terms=EQUATION_10, **options):
    """The loops where the system's fits cost this much one after the other; and what was fitted to what."""
    asked, left = [], list(costs)

    def fit(start, data, method="least_squares", **options):
        asked.append((start.name, data.off, method, options))
        if start.name.startswith("system"):
            found = replace(SYSTEM, name=f"system {len(costs) - len(left)}")
            assert start.term_names == terms
            return SimpleNamespace(model=found, cost=left.pop(0), evaluations=100)
        return SimpleNamespace(model=replace(MOTOR, name=start.name + "'"), cost=-1.0, evaluations=7)

    monkeypatch.setattr(system_fit, "fit", fit)
    return second_loop(Data(), MOTOR, terms, **options), asked


@pytest.mark.parametrize(
    ("costs", "count"),
    [([100.0, 99.5], 2), ([100.0, 98.9, 98.5], 3), ([100.0, 101.0], 2), ([100.0, 99.0, 98.0, 98.0], 4),
     ([0.9**k for k in range(10)], 10)],
)  # fmt: skip
def test_loops_go_on_while_each_gains_a_hundredth(costs, count, monkeypatch):
    loops, _ = looped(monkeypatch, costs)
    assert [loop.cost for loop in loops] == costs[:count]
    assert [loop.number for loop in loops] == list(range(1, count + 1))
    assert [loop.evaluations for loop in loops] == [100] + [107] * (count - 1)


def test_each_loop_fits_the_motor_beside_the_last_system_and_the_system_beside_that_motor(monkeypatch):
    loops, asked = looped(monkeypatch, [100.0, 90.0, 80.0, 70.0], EQUATION_8, max_loops=3)
    assert [(name, off) for name, off, *_ in asked] == [
        ("system", ("motor",)),
        ("motor", ("system 0",)), ("system", ("motor'",)),
        ("motor'", ("system 1",)), ("system", ("motor''",)),
    ]  # fmt: skip
    assert [(loop.motor.name, loop.system.name) for loop in loops] == [
        ("motor", "system 0"), ("motor'", "system 1"), ("motor''", "system 2"),
    ]  # fmt: skip


# -- the whole practice
def cycle_of(name, drum=(1e5, 2e5, 9e5)):
    plateaus = tuple(SimpleNamespace(drum_torque=each) for each in drum)
    return Test(SimpleNamespace(name=name), plateaus, f"curve {name}")


@pytest.mark.parametrize(("torques", "told"), [((1e5, 1.21e5), True), ((1e5, 1.19e5), False), ((1e5,), False),
                                               ((-1e5, -2e5), False), ((-1e3, 1e5), True)])  # fmt: skip
def test_friction_that_goes_with_the_load_asks_for_two_loads(torques, told):
    tests = [cycle_of("t", (each, each, 50.0 * each)) for each in torques]  # one odd plateau moves no median
    if told:
        system_identification._check_loads(tests)
        return
    with pytest.raises(InputError, match=rf"{len(torques)} test\(s\) of one load \({min(torques) / 1e3:.4g} kN m"):
        system_identification._check_loads(tests)


def observed(monkeypatch, measured, model):
    """Curves whose measured and modelled torques are these, N m per motor."""
    asked = []
    data = SimpleNamespace(torque=np.array(measured))
    monkeypatch.setattr(system_identification, "curve_data", lambda curves: asked.append(list(curves)) or data)
    monkeypatch.setattr(system_identification, "modelled", lambda each, data: np.array(model))
    return asked


def test_a_cost_is_the_sum_of_squares_over_all_tests(monkeypatch):
    asked = observed(monkeypatch, [3.0, 5.0, 7.0], [1.0, 6.0, 7.0])
    assert cost_of(MOTOR, [cycle_of("a"), cycle_of("b")]) == 5.0
    assert asked == [["curve a", "curve b"]]


def found_with(**more):
    joint = SimpleNamespace(model=replace(combined(MOTOR, SYSTEM, "joint"), constants={"density": 900.0}))
    known = {
        "tests": (cycle_of("a"), cycle_of("b")), "held_out": (cycle_of("c"),),
        "motor": replace(MOTOR, corrections=(Correction("pressure_offset", 1e5),)), "fits": {}, "held_out_costs": (),
        "loops": tuple(Loop(k, replace(MOTOR, values=(float(k),)), SYSTEM, 1.0, 1) for k in (1, 2, 3)),
        "joint": joint, "ties": (), "unseen": ("K1 - C5",), "bootstrap": None,
    }  # fmt: skip
    return SystemIdentification(**{**known, **more})


def test_the_papers_tables_are_of_the_first_and_of_the_last_loop(monkeypatch):
    found = found_with()
    assert (found.first_loop.name, found.first_loop.values) == ("first loop", (1.0, 0.2))
    assert (found.last_loop.name, found.last_loop.values) == ("second loop", (3.0, 0.2))
    asked = observed(monkeypatch, [1.0], [1.0])
    _ = found.data
    assert asked == [["curve a", "curve b"]]


def test_a_seed_says_where_it_comes_from_and_keeps_what_was_corrected(monkeypatch):
    asked = observed(monkeypatch, [3.0, 5.0], [1.0, 6.0])
    crane = SimpleNamespace(name="ours", gear_ratio=180.0)
    found = found_with()
    seed = winch_seed(found, crane, "seed", {"date": "today"})
    assert asked == [["curve a", "curve b"]]
    assert (seed.name, seed.crane, seed.values) == ("seed", "ours", (14.0, 0.2))
    assert seed.corrections == found.motor.corrections
    assert dict(seed.constants) == {"gear_ratio": 180.0, "density": 900.0}
    said = dict(seed.provenance)
    assert (said["crane"], said["tests"], said["cost_eq9"], said["date"]) == ("ours", ["a", "b"], 5.0, "today")
    assert said["not_determined_by_these_tests"] == ["K1 - C5"]


def test_what_the_practice_is_given_goes_where_it_belongs(monkeypatch):
    asked = {}
    stub = lambda name, answer: (
        lambda *given, **named: asked.setdefault(name, []).append((given, named)) or answer(*given)
    )
    loops = [Loop(1, MOTOR, SYSTEM, 4.0, 1), Loop(2, MOTOR, SYSTEM, 3.0, 1)]
    answers = {
        "corrected_crane": lambda crane, corrections: f"right {crane}", "as_main": lambda crane: f"main {crane}",
        "corrected": lambda run, crane, motor: (f"right {run}", crane),
        "run_as_main": lambda run, crane: f"{run} as main",
        "read_test": lambda run, crane, rule: cycle_of(run, (1e5 if "a" in run.split() else 3e5,) * 3),
        "curve_data": lambda curves: curves, "second_loop": lambda data, motor: loops,
        "supplier_prior": lambda motor, spread: "prior",
        "winch_prior": lambda prior, system, name: (prior, system, name),
        "observations": lambda plateaus, crane: [plateaus, crane],
        "joint_fit": lambda rows, prior, spread: SimpleNamespace(model="joint model"),
        "fit_system": lambda data, motor, terms, *rest: (terms, *rest), "cost_of": lambda model, tests: len(tests),
        "ties": lambda model, rows: [model], "unseen_directions": lambda joint: [joint.model],
        "bootstrap": lambda *given: "bootstrap",
    }  # fmt: skip
    for name, answer in answers.items():
        monkeypatch.setattr(system_identification, name, stub(name, answer))
    found = system_identification.identify_system(
        ["a", "b"], "crane", MOTOR, "spread", held_out=["c", "d", "e"], resamples=9, seed=5, rule="rule",
        complex_options={"restarts": 3},
    )  # fmt: skip
    crane = "main right crane"
    runs = [f"right {each} as main" for each in "abcde"]
    assert [given for given, _ in asked["read_test"]] == [(run, crane, "rule") for run in runs]
    assert all(given[1] == "crane" and given[2] is MOTOR for given, _ in asked["corrected"])
    assert [each.run.name for each in found.tests] == runs[:2]
    assert [each.run.name for each in found.held_out] == runs[2:]
    assert (found.motor, found.loops, found.held_out_costs) == (MOTOR, tuple(loops), (3, 3))
    assert [given[0].name for given, _ in asked["cost_of"]] == ["loop_1", "loop_2"]
    assert asked["winch_prior"] == [(("prior", SYSTEM, "joint fit"), {})]
    rows = [[each.plateaus for each in found.tests], crane]
    assert asked["joint_fit"][0][0] == (rows, ("prior", SYSTEM, "joint fit"), "spread")
    assert {name: terms for name, (terms, *_) in found.fits.items()} == {
        "eq 8, least squares": EQUATION_8, "eq 10, least squares": EQUATION_10,
        "eq 8, complex": EQUATION_8, "eq 10, complex": EQUATION_10,
    }  # fmt: skip
    assert [(given[3:], named) for given, named in asked["fit_system"]] == [((), {})] * 2 + [
        (("complex",), {"seed": 5, "restarts": 3})
    ] * 2
    assert (found.ties, found.unseen, found.bootstrap) == (("joint model",), ("joint model",), "bootstrap")
    given, named = asked["bootstrap"][0]
    assert (given[0], given[1], given[2], given[3]) == (
        [each.plateaus for each in found.tests],
        crane,
        found.joint,
        "spread",
    )
    assert named == {"resamples": 9, "seed": 5}
    bare = system_identification.identify_system(["a", "b"], "crane", MOTOR, "spread")
    assert (bare.held_out, bare.held_out_costs, bare.bootstrap, len(asked["bootstrap"])) == ((), (), None, 1)
    with pytest.raises(InputError, match="no logged test was given"):
        system_identification.identify_system([], "crane", MOTOR, "spread")


def test_a_test_is_read_by_its_own_group_and_rule(monkeypatch):
    asked = []
    monkeypatch.setattr(system_identification, "find_plateaus", lambda *given: asked.append(given) or ["plateau"])
    monkeypatch.setattr(system_identification, "friction_curve", lambda *given: asked.append(given) or "curve")
    run = SimpleNamespace(name="r")
    found = system_identification.read_test(run, "crane", "rule", "active")
    assert (found.run, found.plateaus, found.curve) == (run, ("plateau",), "curve")
    assert asked == [(run, "crane", "rule", "active"), (["plateau"], "crane", "active")]
    monkeypatch.setattr(system_identification, "find_plateaus", lambda *given: [])
    with pytest.raises(InputError, match="^r: no stretch of constant speed"):
        system_identification.read_test(run, "crane")
