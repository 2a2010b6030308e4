"""What candidates are made of: whose transducers, grids of shapes, corrections, what comes and fades, by figures."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates import creep, geometry
from winch_friction.discrepancy.candidates.candidate import (
    ALL,
    ALONE,
    BALANCING,
    BESIDE,
    OTHER,
    Candidate,
    ParameterEstimate,
    Shape,
    Sides,
    _between,
    affected_groups,
    correction,
    driving_alone,
    group_columns,
    group_shapes,
    groups_of,
    label_of,
    own_group_shapes,
)
from winch_friction.physics.channels import BAR
from winch_friction.physics.friction.declared_correction import DECLARED


def group(name, balances, **more):
    return SimpleNamespace(name=name, balances=balances, **more)


MAIN, ACTIVE, PASSIVE = group("main", True), group("active", True), group("passive", False)
HOISTING, COMPENSATING = (MAIN,), (ACTIVE, PASSIVE)


def of(*sides):
    return [SimpleNamespace(groups=groups, time=np.zeros(2)) for groups in sides]


# -- whose
@pytest.mark.parametrize(
    ("which", "hoisting", "compensating", "names"),
    [
        (ALL, ["main"], ["active", "passive"], ()),
        (BALANCING, ["main"], ["active"], ("main", "active")),
        (OTHER, [], ["passive"], ("passive",)),
        (ALONE, ["main"], [], ("main",)),
        (BESIDE, [], ["active"], ("active",)),
    ],
)
def test_a_shape_speaks_of_its_groups_in_every_run_and_its_file_of_the_same(which, hoisting, compensating, names):
    alone, beside = of(HOISTING, COMPENSATING)
    values = {"groups": which}
    assert [each.name for each in affected_groups(alone, values)] == hoisting
    assert [each.name for each in affected_groups(beside, values)] == compensating
    size = {"main": 1.0, "active": 10.0, "passive": 100.0}
    found = group_columns(lambda own: np.full(2, size[own.name]), beside, values)
    assert found.tolist() == [[sum(size[name] for name in compensating)]] * 2
    sides = Sides(None, ("main", "active"), ("passive",), ("main",))
    assert groups_of(Shape("", values), sides) == names


def test_sides_are_told_apart_where_a_run_has_both_and_the_passive_one_is_carried():
    assert [(each.label, each.carried) for each in group_shapes(of(HOISTING))] == [("all groups", False)]
    both = group_shapes(of(HOISTING, COMPENSATING))
    assert [(each.values["groups"], each.carried) for each in both] == [(ALL, False), (BALANCING, False), (OTHER, True)]
    assert [each.part for each in both] == ["", "1", "2"]


@pytest.mark.parametrize(
    ("runs", "labels"),
    [
        ((HOISTING, COMPENSATING), {"the main group alone": ALONE, "the active group alone": BESIDE}),
        ((HOISTING,), {}),
        ((COMPENSATING,), {}),
        (((ACTIVE,), COMPENSATING), {}),  # the same motors, which are one driving group
        (((PASSIVE,), COMPENSATING), {"the passive group alone": ALONE, "the active group alone": BESIDE}),
    ],
)
def test_a_driving_group_speaks_alone_where_compensation_drives_by_another(runs, labels):
    assert {each.label: each.values["groups"] for each in own_group_shapes(of(*runs))} == labels


def test_who_drives_alone_is_said_once_and_in_order():
    assert driving_alone(of(HOISTING, (ACTIVE,), HOISTING, COMPENSATING)) == ("active", "main")


# -- grids
@pytest.mark.parametrize(("value", "low", "high"), [(2.0, 1.0, 8.0), (1.0, 0.5, 2.0), (8.0, 2.0, 32.0)])
def test_a_grid_is_refined_towards_its_neighbours_and_past_its_end_as_far(value, low, high):
    """In the logarithm, five points either way, none of them the neighbour itself."""
    found = sorted(_between(value, (8.0, 1.0, 2.0, 2.0)))
    expected = [value * (end / value) ** (k / 6.0) for end in (low, high) for k in range(1, 6)]
    assert found == pytest.approx(sorted([value, *expected]))


def test_a_grid_of_one_has_nothing_between():
    assert _between(3.0, (3.0, 3.0)) == [3.0]


def shapes(*values):
    return lambda _: [Shape(label_of(own), own) for own in values]


def test_one_axis_at_a_time_is_refined_beside_the_coarse_grid():
    coarse = [{"a": a, "b": b, "c": 5.0} for a in (1.0, 4.0) for b in (3.0, 9.0)]
    own = Candidate("wave", shapes=shapes(*coarse), continuous=("a", "b"))
    finer = own.refined(Shape("", coarse[0]))
    assert finer.continuous == ()
    found = [each.values for each in finer.shapes([])]
    assert found[:4] == coarse
    assert all((each["a"] == 1.0) != (each["b"] == 3.0) and each["c"] == 5.0 for each in found[4:])
    assert len(found) == 4 + 2 * 10
    assert finer.shapes([])[4].label == label_of(found[4])


def test_what_is_no_more_of_its_cause_is_not_tried():
    own = Candidate("wave", shapes=shapes({"a": 1.0}, {"a": 64.0}), continuous=("a",))
    every = own.refined(Shape("", {"a": 1.0})).shapes([])
    assert sorted(each.values["a"] for each in every[2:]) == pytest.approx([2.0**k for k in range(-5, 6) if k])
    few = Candidate("wave", shapes=own.shapes, continuous=("a",), possible=lambda values, _: values["a"] < 5.0)
    assert sorted(each.values["a"] for each in few.refined(Shape("", {"a": 1.0})).shapes([])[2:])[-1] == pytest.approx(
        4.0
    )
    assert Candidate("wave").refined(Shape("")) == Candidate("wave")


# -- what is said of it
@pytest.mark.parametrize(
    ("more", "needs"),
    [
        ({"needs": ("hook_load",)}, None),
        ({"needs": ("hook_load", "wire_out", "oil_temperature")}, "wire_out"),
        ({"hydraulic": True}, "pressures"),
        ({"blind": lambda runs: ("a faster log", "too slow")}, "a faster log"),
        ({"blind": lambda runs: None}, None),
        ({"blind": lambda runs: None if len(runs) == 2 else ("more runs", "one is none")}, None),  # of all runs
    ],
)
def test_what_runs_cannot_show_says_what_it_needs(more, needs):
    """What one run alone lacks is not there throughout."""
    runs = [SimpleNamespace(present=frozenset(own), groups=()) for own in (("hook_load", "wire_out"), ("hook_load",))]
    found = Candidate("wave", "law", **more).untestable(runs)
    assert (found and found.needs) == needs
    assert found is None or (found.name, found.law) == ("wave", "law")


@pytest.mark.parametrize(("factor", "times", "cut"), [(1.0, 0.5, False), (-2.0, 0.25, False), (1.0, 3.0, True)])
def test_a_correction_is_a_multiple_of_its_estimate_inside_its_bounds_and_says_where_they_cut_it(factor, times, cut):
    most = DECLARED["tare_load"].parameter.upper
    own = correction("tare_load", ParameterEstimate(times * most, 7.0, "kg"), factor)
    assert own.value == pytest.approx(most if cut else factor * times * most)
    assert own.std == pytest.approx(abs(factor) * 7.0)
    assert own.source == "winch-friction gap" + f", cut at its bound from {factor * times * most:g} kg" * cut
    below = correction("tare_load", ParameterEstimate(-3.0 * most, 7.0, "kg"))
    assert below.value == DECLARED["tare_load"].parameter.lower


# -- what comes over the runs
@pytest.mark.parametrize(("start", "share"), [(0.0, 0.0), (150.0, 0.25), (290.0, 0.95), (900.0, 1.0)])
def test_what_gathers_has_come_in_proportion_to_the_time(start, share):
    run = SimpleNamespace(
        start=start, time=np.zeros(2), load=np.full(2, 5e4), radius=np.ones(2), gear_ratio=100.0,
        load_acceleration=np.zeros(2), load_friction=np.zeros(2),
    )  # fmt: skip
    constant, grown = creep.gathering_columns(run, {"from": 100.0, "to": 300.0})[1]
    assert constant == pytest.approx(9.80665 / 100.0, rel=1e-3)
    assert grown == pytest.approx(share * constant)


def test_what_creeps_does_so_from_the_first_run_to_a_share_of_the_whole_time():
    runs = [SimpleNamespace(start=start, time=np.array([0.0, lasts])) for start, lasts in ((500.0, 9.0), (100.0, 1000))]
    own = creep._creeping_shapes(
        lambda _: [Shape("all", {"groups": 0.0}), Shape("one", {"groups": 2.0}, carried=True)], runs
    )
    assert [(each.values["from"], each.values["to"]) for each in own[:3]] == [
        (100.0, 400.0),
        (100.0, 700.0),
        (100.0, 1100.0),
    ]
    assert [each.label for each in own[:3]] == [
        f"all, within {share} % of the time".replace(" %", "%") for share in (30, 60, 100)
    ]
    assert [each.carried for each in own] == [False] * 3 + [True] * 3
    assert [each.values["groups"] for each in own] == [0.0] * 3 + [2.0] * 3


@pytest.mark.parametrize(("count", "apart", "shows"), [(6, 3700.0, True), (5, 3700.0, False), (6, 3500.0, False)])
def test_what_creeps_shows_in_many_runs_that_lie_apart(count, apart, shows):
    runs = [SimpleNamespace(start=7e5 + apart * k / (count - 1)) for k in range(count)]
    assert (creep._one_date(runs) is None) is shows
    assert creep._one_date(runs, 86400.0) is not None


def test_what_creeps_and_what_gathers_become_a_constant_and_a_part_with_its_time():
    found = {
        name: ParameterEstimate(size, 1.0, "") for name, size in
        (("p_0", 1.0 * BAR), ("p_d", 2.0 * BAR), ("m_h", 300.0), ("m_d", 400.0))
    }  # fmt: skip
    shape, sides = Shape("", {"groups": OTHER, "from": 10.0, "to": 20.0}), Sides(None, ("main",), ("passive",))
    told = [(each.name, each.value, each.groups, tuple(each.during)) for each in creep._to_creep(found, shape, sides)]
    during = ((10.0, 20.0),)
    assert told == [
        ("pressure_offset", 1.0 * BAR, ("passive",), ()), ("pressure_creep", 2.0 * BAR, ("passive",), during),
    ]  # fmt: skip
    told = [(each.name, each.value, tuple(each.during)) for each in creep._to_gather(found, shape, sides)]
    assert told == [("tare_load", 300.0, ()), ("tare_creep", 400.0, during)]


# -- what hangs
def test_shapes_of_a_tare_and_of_a_radius_are_those_that_the_runs_log():
    def run(*layers, **channels):
        return SimpleNamespace(channels={**channels, **({"wire_layer": np.array(layers)} if layers else {})})

    assert [each.label for each in geometry._tare_shapes([run()])] == ["hook"]
    told = {each.label: each.values for each in geometry._tare_shapes([run(), run(wire_out=np.zeros(1))])}
    assert told == {
        "hook": {"hook": 1.0, "wire": 0.0}, "wire": {"hook": 0.0, "wire": 1.0},
        "hook and wire": {"hook": 1.0, "wire": 1.0},
    }  # fmt: skip
    assert [each.values["layer"] for each in geometry._radius_shapes([run(), run(2.0, 2.1)])] == [0.0]
    layers = [each.values["layer"] for each in geometry._radius_shapes([run(2.0, 3.9), run(1.0)])]
    assert layers == [0.0, 1.0, 2.0, 4.0, geometry.ONE_DEPTH, geometry.THICKER, -4.0]


@pytest.mark.parametrize(("hook", "wire", "names"), [
    (1.0, 0.0, ["tare_load"]), (0.0, 1.0, ["wire_weight"]), (1.0, 1.0, ["tare_load", "wire_weight"]),
])  # fmt: skip
def test_a_tare_becomes_a_mass_and_a_wires_weight(hook, wire, names):
    found = {"m_h": ParameterEstimate(900.0, 9.0, "kg"), "mu_w": ParameterEstimate(12.0, 0.1, "kg/m")}
    made = geometry._to_mass(found, Shape("", {"hook": hook, "wire": wire}), None)
    assert [each.name for each in made] == names
    assert {each.name: each.value for each in made}.items() <= {"tare_load": 900.0, "wire_weight": 12.0}.items()


# -- the gas
def test_a_warm_gas_presses_more_at_first_and_what_is_compressed_relaxes():
    """Passive motors that carry 2 * 3e-5 m^3/rad at a port of 200 bar: an excess of 1 % is 12 N m, and fades."""
    port, time = 200e5, np.arange(0.0, 400.0, 0.1)
    passive = group(
        "passive", False, count=2.0, displacement=np.full(len(time), 3e-5), logged=np.full(len(time), port - 4e5),
        pressure_sum=np.full(len(time), port + 4e5),
    )  # fmt: skip
    run = SimpleNamespace(groups=(ACTIVE, passive), time=time, dt=0.1)
    warmth, heat = creep.accumulator_columns(run, {"tau": 60.0}).T
    assert 0.01 * warmth[0] == pytest.approx(-12.0)
    assert warmth[600] / warmth[0] == pytest.approx(np.exp(-1.0))
    assert not heat.any()  # nothing was compressed
    half = len(time) // 2
    passive.pressure_sum = passive.pressure_sum + 2.0 * port * (np.arange(len(time)) >= half)  # twice the pressure
    heat = creep.accumulator_columns(run, {"tau": 60.0})[:, 1]
    assert not heat[:half].any()
    assert heat[-1] == pytest.approx(2.0 * 3e-5 * 2.0 * port * np.log(2.0) * (1.0 - np.exp(-200.0 / 60.0)), rel=1e-2)
    slow = creep.two_parts_columns(run, {"tau": 60.0})
    assert slow.shape == (len(time), 3)
    assert slow[600, 2] / slow[0, 2] == pytest.approx(np.exp(-60.0 / 300.0))
    assert not creep.accumulator_columns(SimpleNamespace(groups=(ACTIVE,), time=time, dt=0.1), {"tau": 60.0}).any()


def test_a_gas_becomes_corrections_of_the_passive_side_with_their_times():
    found = {name: ParameterEstimate(size, 1e-3, "1") for name, size in (("e_T", 0.01), ("e_S", 0.02), ("g_T", 0.5))}
    sides, shape = Sides(None, ("active",), ("passive",)), Shape("", {"tau": 30.0})
    told = {
        each.name: (each.value, each.time_constant, each.groups) for each in creep._to_two_parts(found, shape, sides)
    }
    assert told == {
        "accumulator_warmth": (0.01, 30.0, ("passive",)), "accumulator_heat": (0.5, 30.0, ("passive",)),
        "accumulator_slow_warmth": (0.02, 150.0, ("passive",)),
    }  # fmt: skip
