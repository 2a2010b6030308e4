"""Rules of single candidates by figures: who is plain, what a run must hold, where a shape lies and what it becomes."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates import creep, families, feedback, friction, geometry, lateness
from winch_friction.discrepancy.candidates.candidate import ALL, BALANCING, Candidate, ParameterEstimate, Shape, Sides
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import Scope, term_named
from winch_friction.physics.friction.table import Table

SIZE = 200
ONES = np.ones(SIZE)
VISCOUS = term_named("viscous")


# -- what a bare model lacks
@pytest.mark.parametrize(
    ("parameters", "terms", "plain", "is_plain"),
    [(3, (), True, True), (4, (), True, False), (3, ("viscous",), True, False), (3, ("coulomb",), True, True),
     (0, (), False, False)],
)  # fmt: skip
def test_plain_is_what_a_model_of_three_parameters_or_fewer_lacks(parameters, terms, plain, is_plain):
    model = SimpleNamespace(parameters=[None] * parameters, term_names=terms)
    own = Candidate("viscous", term=VISCOUS, plain=plain, plausible=7.0)
    assert own.plain_in(model) is is_plain
    assert own.most_in(model) == (LIMITS.unbounded if is_plain else 7.0)


def test_a_hydraulic_effect_may_show_where_one_run_has_pressures():
    runs = [SimpleNamespace(present=frozenset(), groups=groups) for groups in ((), ("main",))]
    assert Candidate("wave", "law", hydraulic=True).untestable(runs) is None
    assert Candidate("wave", "law", hydraulic=True).untestable(runs[:1]).needs == "pressures"


@pytest.mark.parametrize(("name", "law", "opposing"), [
    ("low_displacement_loss", "", True), ("low_displacement_loss", "low_displacement_each_way", False),
    ("brake_drag", "", True), ("brake_drag", "brake_each_way", False), ("gear_asymmetry", "", False),
    ("pressure_scale", "", False),
])  # fmt: skip
def test_what_drags_more_one_way_acts_one_way_in_part(name, law, opposing):
    """Half of it adds to the load: at 5 Hz such a loss took the place of load cells that were off by chance."""
    assert {each.opposing for each in all_candidates() if (each.name, each.law_name) == (name, law)} == {opposing}


# -- what is late
def test_a_delay_of_each_side_lies_within_a_quarter_of_itself_in_typical_sizes():
    """Of 50 ms; pressures that are late are a speed that is early."""
    run = SimpleNamespace(dt=0.05, channels={})
    shapes = {each.label: each for each in lateness._delay_shapes([run])}
    assert len(shapes) == 2 * len(lateness.DELAYS)
    speed, pressures = (shapes[f"{side} late, about 100 ms"] for side in ("speed", "pressures"))
    assert speed.bounds == pytest.approx((1.6, 2.5))
    assert speed.values == {"ahead": 0.1, "behind": 0.0, "late": lateness.SPEED}
    assert pressures.bounds == pytest.approx((-2.5, -1.6))
    assert pressures.values == {"ahead": 0.0, "behind": 0.1, "late": lateness.PRESSURES}


def test_the_slowest_log_says_which_delays_are_looked_for():
    fast, slow, slower = (SimpleNamespace(dt=dt, channels={}) for dt in (0.02, 0.05, 0.1))
    assert any(each.label.startswith("small") for each in lateness._delay_shapes([fast, fast]))
    assert not any(each.label.startswith("small") for each in lateness._delay_shapes([fast, slow]))


@pytest.mark.parametrize(("slowest", "least"), [
    (0.05, 0.05), (0.055, 0.05), (0.06, 0.07), (0.1, 0.1), (0.125, 0.14), (0.2, 0.2), (0.25, 0.28), (0.3, None),
])  # fmt: skip
def test_a_slow_log_shows_the_delays_of_a_sample_and_more(slowest, least):
    """Below 18 Hz none was looked for, and 0.2 s at 15 Hz, three samples, stayed unexplained."""
    runs = [SimpleNamespace(dt=dt, channels={}) for dt in (0.02, slowest)]
    steps = [each.values["ahead"] for each in lateness._delay_shapes(runs) if each.label.startswith("speed late")]
    assert steps == [each for each in lateness.DELAYS if least is not None and each >= least]
    assert (lateness._too_slow(runs) is None) is (least is not None)


# -- radius and inertia
def hung(tension=False, **more):
    own = {
        "load": 4e4 * ONES, "radius": 1.0 * ONES, "gear_ratio": 100.0, "load_acceleration": 0.0 * ONES,
        "load_friction": 0.0 * ONES, "acceleration": 50.0 * ONES, "tension_measured": tension, "time": ONES,
        "channels": {"wire_layer": np.where(np.arange(SIZE) < 100, 1.4, 1.6)},
    }  # fmt: skip
    return SimpleNamespace(**{**own, **more})


@pytest.mark.parametrize("tension", [False, True])
def test_a_radius_acts_on_the_weight_and_on_the_inertia_unless_the_force_was_measured(tension):
    """40 t on a metre behind a gear of 100: 3923 N m at rest, and 4 kg m^2 that the shaft accelerates by 50 rad/s^2."""
    own = 4e4 * GRAVITY / 100.0 + (0.0 if tension else 4.0 * 50.0)
    assert geometry.radius_columns(hung(tension), {"layer": 0.0}) == pytest.approx(np.full((SIZE, 1), own))
    second = geometry.radius_columns(hung(tension), {"layer": 2.0})[:, 0]
    assert second == pytest.approx(np.where(np.arange(SIZE) < 100, 0.0, own))


FRICTION_STEP = 15e5 * np.sign(np.sin(0.6 * np.arange(0.0, 60.0, 0.1) + 0.1))  # Pa, of the driving side's drop


def driven(*others):
    sides = [SimpleNamespace(balances=True, logged=130e5 + FRICTION_STEP)]
    return SimpleNamespace(groups=sides + [SimpleNamespace(balances=False, logged=each) for each in others])


def test_a_gas_is_looked_for_where_one_run_has_a_passive_side():
    one, two = driven(), driven(180e5 + 6e5 * np.cos(0.6 * np.arange(0.0, 60.0, 0.1)))
    assert creep._no_passive_group([one, two]) is None
    assert creep._no_passive_group([one, one]) is not None


@pytest.mark.parametrize(("share", "shows"), [(1.0, False), (0.55, False), (0.45, True), (0.0, True)])
def test_no_gas_presses_on_motors_that_carry_the_friction_of_the_others(share, shows):
    """Of 250 t on two groups of four motors on one line a tare that grew in each run had got a gas beside its name."""
    offset = 8e5  # Pa, of one line's transducer: a difference that stays tells nothing
    same = driven(130e5 + share * FRICTION_STEP + offset)
    assert (creep._no_passive_group([same, same]) is None) is shows


# -- the displacement's feedback
def swung(*shares, balances=True, pressure=1e7, total=3e7, used=None):
    group = SimpleNamespace(
        name="main", balances=balances, count=2, pressure=pressure * ONES, pressure_sum=total * ONES,
        displacement=np.resize(shares, SIZE) * 1e-5,
    )  # fmt: skip
    return SimpleNamespace(
        groups=[group], constants=(("max_displacement", 1e-5),), time=ONES,
        used=np.ones(SIZE, bool) if used is None else used,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("runs", "told"),
    [
        ([swung(0.3), swung(0.5), swung(0.9)], True),
        ([swung(0.3), swung(0.31), swung(0.5), swung(0.52)], False),  # less than a tenth apart they are one
        ([swung(0.3), swung(0.5), swung(0.9, balances=False)], False),  # what closes the balance
        ([swung(0.3, 0.3, 0.3, 0.9), swung(0.5)], False),  # one of each run
    ],
)
def test_a_bow_shows_between_three_displacements_of_the_driving_side_that_lie_apart(runs, told):
    assert (feedback._few_strokes(runs) is None) is told


def test_an_s_shows_between_four_displacements_that_lie_apart():
    """Two amounts and a zero go through any three."""
    (law,) = [each for each in feedback.feedback_candidates() if each.law_name == "bends twice over the stroke"]
    runs = [swung(share) for share in (0.3, 0.5, 0.7, 0.9)]
    assert law.blind(runs[:3]) == ("more displacements", "a bow or an S shows between 4 displacements that lie apart")
    assert law.blind(runs) is None


def test_a_bow_is_a_gain_against_a_curvature_that_bends_what_the_gain_has_made():
    """Right at both ends: at half a stroke of 2e-5 a bow of 1e-6 is a gain of a fifth."""
    sides = Sides(SimpleNamespace(max_displacement=2e-5), ("main",), ())
    found = {"D_0": ParameterEstimate(3e-7, 1e-9, "m^3/rad"), "D_b": ParameterEstimate(5e-7, 2e-8, "m^3/rad"),
             "e_D": ParameterEstimate(0.05, 0.003, "1")}  # fmt: skip
    zero, scale, curvature = feedback._to_bow(found, Shape("", {"groups": BALANCING}), sides)
    assert (zero.name, scale.name, curvature.name) == (
        "displacement_offset", "displacement_scale", "displacement_curvature",
    )  # fmt: skip
    assert zero.value == 3e-7
    assert (scale.value, scale.std) == pytest.approx((0.05 + 4.0 / 2e-5 * 5e-7, np.hypot(0.003, 4.0 / 2e-5 * 2e-8)))
    assert curvature.value == pytest.approx(-4.0 / 2e-5**2 * 5e-7 / 1.15**2)
    assert [each.groups for each in (zero, scale, curvature)] == [("main",)] * 3


def test_beyond_a_pressure_each_port_adds_what_it_has_more():
    """Ports at 200 and 100 bar: beyond 150 bar 50 of the first, beyond 80 bar 120 less 20, beyond 250 none."""
    run = swung(0.5)
    for at, more in ((150e5, 50e5), (80e5, 100e5), (250e5, 0.0)):
        column = feedback.bent_pressure_columns(run, {"groups": ALL, "beyond": at})[:, 1]
        assert column == pytest.approx(2 * 0.5e-5 * more * ONES)
    assert feedback._high(run.groups[0]) == pytest.approx(200e5)
    assert feedback._high(swung(0.5, pressure=-1e7).groups[0]) == pytest.approx(200e5)  # whichever port is the higher


def test_a_bent_transducer_becomes_a_gain_and_a_bend_each_with_its_own_size():
    found = {"e_p": ParameterEstimate(0.01, 1e-3, "1"), "b_p": ParameterEstimate(-0.03, 2e-3, "1")}
    shape, sides = Shape("", {"groups": ALL, "beyond": 9e6}), Sides(None, ("main",), ())
    told = [(each.name, each.value, each.std, each.beyond) for each in feedback._to_pressure(found, shape, sides)]
    assert told == [("pressure_scale", 0.01, 1e-3, None), ("pressure_bend", -0.03, 2e-3, 9e6)]


def test_pressures_count_that_moving_samples_have_seen():
    wide = swung(0.5, used=np.arange(SIZE) < 150)
    wide.groups[0].pressure = np.where(np.arange(SIZE) < 150, 1e7, 9e7)
    (covered,) = feedback._covered([wide, swung(0.5, used=np.zeros(SIZE, bool))], {"groups": ALL})
    assert covered == pytest.approx(np.full(150, 2e7))


def test_a_feedbacks_curve_bends_between_displacements_of_which_each_run_has_one():
    """However much of a run was swung in for a moment; where most runs have the same stroke nothing can bend."""
    runs = [swung(share, share, share, share, 1.0) for share in (0.2, 0.4, 0.6, 0.8, 0.9)]
    (shape,) = feedback._curve_shapes(runs)
    at = [shape.values[f"beyond_{k}"] for k in (1, 2, 3)]
    assert at == pytest.approx(np.quantile([0.2e-5, 0.4e-5, 0.6e-5, 0.8e-5, 0.9e-5], (0.1, 0.4, 0.7)))
    assert feedback._curve_shapes([swung(share) for share in (0.2, 0.2, 0.2, 0.2, 0.2, 0.5, 0.6, 0.7, 0.8)]) == []


# -- friction
def test_what_goes_with_the_load_shows_where_one_run_has_one():
    none, some = SimpleNamespace(drum_torque=0.0 * ONES), SimpleNamespace(drum_torque=ONES)
    assert friction.no_load([none, some]) is None
    assert friction.no_load([none, none]) == ("hook_load", "no run has a load")


def test_a_shape_is_refined_where_it_is_a_positive_quantity_on_a_grid():
    """A power of a direction may be negative, and has no logarithm."""
    law = term_named("line_pressure_power")
    own = friction.friction_candidate(law, {"n_l": (1.0, 2.0), "b_l": (-1.0, 1.0)})
    assert own.continuous == ("n_l",)
    assert friction.friction_candidate(law, {"n_l": (1.0,), "b_l": (-1.0, 1.0)}).continuous == ()
    assert [p.name for p in own.linear] == [p.name for p in law.parameters if not p.shape]


def test_widths_and_loads_are_shares_of_the_largest_of_all_runs():
    runs = [SimpleNamespace(top_speed=top, drum_torque=torque * ONES) for top, torque in ((50.0, 4e5), (200.0, 1e5))]
    assert [each.values["C4"] for each in friction._stribeck_shapes(runs)] == pytest.approx([10.0, 15.0, 22.0, 34.0])
    assert [each.values["x"] for each in friction.loads("x", (0.1, 0.5))(runs)] == pytest.approx([4e4, 2e5])
    assert [each.values["x"] for each in friction.loads("x", (0.5,))([SimpleNamespace(drum_torque=-ONES)])] == [0.5]


def test_a_sudden_change_lies_between_two_runs_with_two_on_either_side():
    runs = [SimpleNamespace(start=1000.0 * k, time=np.array([0.0, 600.0])) for k in (4, 0, 1, 3, 2)]
    found = [each.values["t"] for each in friction.between_runs("t")(runs)]
    assert found == pytest.approx([1800.0, 2800.0])  # in the middle of what lies between


@pytest.mark.parametrize("speeds", [(5.0, 20.0), (20.0, 5.0)])
def test_two_stribeck_curves_melt_into_one_between_them(speeds):
    """Two of the same width are one of that width; of two widths the one lies between, and begins where both began."""
    one, other = ({"C1": 2e-5, "C3": 30.0, "C4": speed} for speed in speeds)
    same = friction._one_stribeck(one, one)
    assert same == pytest.approx({"C1": 4e-5, "C3": 60.0, "C4": speeds[0]}, rel=1e-3)
    both = friction._one_stribeck(one, other)
    assert 5.0 < both["C4"] < 20.0
    assert both["C3"] == pytest.approx(60.0, rel=0.15)
    assert both["C1"] == pytest.approx(4e-5, rel=0.15)


def test_a_curve_of_the_load_weighs_as_much_as_one_without_at_400_kn_m_on_the_drum():
    """Then neither width is nearer to the one that is left."""
    of_load, plain = {"C1": 5.0 / 4e5, "C3": 0.0}, {"C1": 0.0, "C3": 5.0}
    one, other = (
        friction._one_stribeck({**narrow, "C4": 10.0}, {**wide, "C4": 40.0})["C4"]
        for narrow, wide in ((of_load, plain), (plain, of_load))
    )
    assert one == pytest.approx(other, rel=1e-3)
    assert 10.0 < one < 40.0


def test_an_oil_is_tried_that_thins_by_half_to_two_thirds_over_twenty_kelvin():
    """ISO VG 46 of index 100 goes from 46 mm2/s at 40 degC to 21 at 60, a water glycol by a third."""
    (own,) = [each for each in families.literature() if each.law_name == "viscosity_exponential"]
    left = [float(np.exp(-20.0 * each.values["b_ve"])) for each in own.shapes([])]
    assert 0.33 < min(left) < 0.5 < max(left) < 0.7


def test_a_port_is_looked_for_where_oil_through_it_could_be():
    """D (D w)^n, and one power more of a passage that narrows with the stroke; other laws of the cause are as they
    were."""
    ports = [each for each in families.literature() if each.name == "port_turbulence"]
    runs = [SimpleNamespace(speed=np.array([200.0]), groups=("main",))]
    shapes = {each.law_name: [shape.values for shape in each.shapes(runs)] for each in ports}
    power = {(v["n_pp"], v["m_pp"]) for v in shapes["port_power"]}
    assert {(2.0, 4.0), (1.5, 3.0), (3.0, 4.0)} <= power
    assert (1.5, 4.0) not in power
    assert len(shapes["port_one_way"]) == 2 * len(families.ONE_WAY)
    assert all(each.possible({"n_le": 2.0, "b_le": 0.0}, runs) for each in ports)


@pytest.mark.parametrize(("travel", "possible"), [(0.28, False), (0.32, True)])
def test_presliding_is_told_over_three_times_the_travel_in_which_nobody_knows_when_the_shaft_turned(
    monkeypatch, travel, possible
):
    monkeypatch.setattr(friction, "blurred_travel", lambda _: 0.1)
    assert friction.presliding({"d_z": travel}, []) is possible


def test_the_travel_that_is_blurred_is_that_of_three_samples_after_a_real_reversal():
    """By 40 rad/s^2 and 0.02 s a shaft goes by 0.4, 1.2 and 2.0 rad/s after it: 0.072 rad; a tremble is none."""
    time = 0.02 * np.arange(400)
    speed = 40.0 * (time - 4.01)
    trembles = np.where(np.arange(400) % 2 == 0, 0.1, -0.1)
    run = SimpleNamespace(speed=speed, dt=0.02)
    assert friction.blurred_travel([run]) == pytest.approx(0.072)
    assert friction.blurred_travel([SimpleNamespace(speed=trembles, dt=0.02)]) == 0.0


# -- what the data draw
def test_a_signal_of_the_motors_is_the_mean_of_all_groups_whichever_way_it_acts():
    groups = [
        SimpleNamespace(count=2, pressure=p * ONES, displacement=d * ONES) for p, d in ((3e7, 1e-5), (-1e7, 3e-5))
    ]
    run = SimpleNamespace(groups=groups, constants=(("max_displacement", 4e-5),), speed=-10.0 * ONES, time=ONES)
    assert families._values(families.PRESSURE, run) == pytest.approx(2e7)
    assert families._values(families.LEFT, run) == pytest.approx(2e-5)
    assert families._values(families.SWASH, run) == pytest.approx(2e-5)
    assert families._values(families.FLOW, run) == pytest.approx(0.5 * 2.0 * (1e-5 + 3e-5) * 10.0)
    assert families._of_group(families.LEFT, groups[0], run) == pytest.approx(3e-5)


def test_a_hinge_bends_by_its_slope_over_all_that_lies_beyond_it():
    """Over 6: the first hinge has no bend, the second goes over five sixths and the third over two."""
    form = families.bending(Table("x", (("wire_out", (0.0, 1.0, 4.0, 6.0)),), shape="convex_rising", anchor="low"))
    assert form == pytest.approx(np.diag([0.0, (6.0 / 5.0 / 3.0) ** 2, (6.0 / 2.0 / 3.0) ** 2]))


@pytest.mark.parametrize(
    ("scope", "times", "typical"),
    [
        (Scope.SHAFT, (), 200.0),  # a twentieth of 4000 N m at the motor
        (Scope.SYSTEM, (), 20.0),  # of each of ten motors
        (Scope.MOTOR, (families.PRESSURE,), 200.0 / 2e7 / 10.0),
    ],
)
def test_a_curves_typical_size_is_a_twentieth_of_the_loads_torque_shared_by_the_motors(
    monkeypatch, scope, times, typical
):
    tables = []
    monkeypatch.setattr(families, "_covered", lambda signal, runs: np.linspace(1e7, 3e7, 50))
    monkeypatch.setattr(families, "_table", lambda row, knots, size: tables.append(size))
    monkeypatch.setattr(families, "tabulated", lambda _: SimpleNamespace(parameters=(), name="curve"))
    groups = [SimpleNamespace(count=4), SimpleNamespace(count=6)]
    run = SimpleNamespace(drum_torque=np.array([-4e5, 4e5, 4e5]), gear_ratio=100.0, groups=groups)
    own = families._free(families.Free("cause", (families.LOAD,), times, scope), [run])
    assert tables == [pytest.approx(typical)]
    assert (own.name, own.law_name, own.free, own.hydraulic) == ("cause", "curve", True, scope is Scope.MOTOR)
    assert own.finer(None) is not None
    assert own.finer(None).finer is None  # once
    surface = families._free(families.Free("cause", (families.LOAD, families.SPEED), times, scope), [run])
    assert surface.finer is None
    tables[1:] = []
    run.drum_torque = np.zeros(3)  # an empty hook: of 1 N m at the motor
    families._free(families.Free("cause", (families.LOAD,), times, scope), [run])
    assert tables[1:] == [pytest.approx(typical / 4000.0)]


@pytest.mark.parametrize("side", ["both", "hoisting", "lowering"])
def test_a_curve_that_acts_one_way_says_which(side):
    row = families.Free("line_pressure_drop", (families.SPEED,), (families.SWASH,), Scope.MOTOR, side=side)
    table = families._table(row, [np.arange(3.0)], 2.0)
    assert (table.side, table.typical, table.unit, table.place) == (side, 2.0, "Pa", "motor")
