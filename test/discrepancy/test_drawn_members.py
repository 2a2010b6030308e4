"""The curves that data draw and the laws beside a cause's own: where they are looked for, and over what."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates import families as module
from winch_friction.discrepancy.candidates import friction
from winch_friction.discrepancy.candidates.candidate import Shape
from winch_friction.discrepancy.candidates.families import CURVES, FLOW, LEFT, LOAD, SPEED, free_members, literature
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import symbols, term_named
from winch_friction.physics.friction.symbols import WINCH_SIGNALS
from winch_friction.records.model_file import load_model

COUNT = 400
AT = np.linspace(0.0, 1.0, COUNT)


def group(count, displacement):
    one = np.ones(COUNT)
    return SimpleNamespace(
        count=count, displacement=displacement * one, pressure=1e7 * (1.0 + AT), pressure_sum=2e7 * one
    )


def run(used=AT >= 0.0, load=4e5):
    """A run whose speed and load rise all the way, with two groups of motors."""
    point = {"speed_magnitude": 200.0 * AT, "drum_torque": load * (1.0 + AT)}
    return SimpleNamespace(
        time=AT, used=used, speed=200.0 * AT, groups=(group(3, 2e-5), group(8, 1e-5)), gear_ratio=250.0,
        drum_torque=point["drum_torque"], constants=(("max_displacement", 4e-5),),
        point=[point.get(each.name, np.zeros(COUNT)) for each in WINCH_SIGNALS],
    )  # fmt: skip


def row_of(signal):
    return next(row for row in CURVES if row.signals == (signal,))


def test_a_curve_bends_where_the_winch_has_moved():
    """A winch that rests shows every pressure and no friction."""
    slow = run(used=AT < 0.25)
    knots = module._free(row_of(SPEED), [slow]).term.table.knots[0][1]
    assert knots[-1] < 50.0 < 0.3 * 200.0


@pytest.mark.parametrize(("load", "drawn"), [(4e5, True), (0.0, False)])
def test_a_signal_of_one_value_draws_no_curve(load, drawn):
    assert (module._free(row_of(LOAD), [run(load=load)]) is not None) is drawn
    still = run()
    still.point[[each.name for each in WINCH_SIGNALS].index("drum_torque")] = np.full(COUNT, 4e5)
    assert module._free(row_of(LOAD), [still]) is None


@pytest.mark.parametrize(("spread", "drawn"), [(0.9, False), (1.1, True), (20.0, True)])
def test_an_oil_that_was_warmer_by_more_than_a_kelvin_draws_a_curve(spread, drawn):
    """Its zero means nothing, so that a share of its reading is no measure of what a sensor tells apart."""
    warm = run()
    warm.point[[each.name for each in WINCH_SIGNALS].index("oil_temperature")] = 40.0 + spread * AT
    assert (module._free(row_of("oil_temperature"), [warm]) is not None) is drawn


def test_a_groups_flow_is_that_of_its_motors_and_what_is_left_of_their_stroke_is_of_each():
    own = run()
    assert module._values(FLOW, own)[-1] == pytest.approx(0.5 * (3 * 2e-5 + 8 * 1e-5) * 200.0)
    assert module._values(LEFT, own)[-1] == pytest.approx(0.5 * (2e-5 + 3e-5))


def test_a_curve_that_the_model_has_already_is_not_drawn_again():
    model, runs = load_model("a6vm215_crane2"), [run()]
    names = [each.term.name for each in free_members(runs, model)]
    has = SimpleNamespace(term_names=(*model.term_names, names[0]))
    assert [each.term.name for each in free_members(runs, has)] == names[1:]


def test_a_finer_curve_bends_in_the_middle_of_every_interval_as_well():
    coarse = module._free(row_of(LOAD), [run()])
    few, many = (each.term.table.knots[0][1] for each in (coarse, coarse.finer(coarse.shapes([])[0])))
    assert len(many) == 2 * len(few) - 1
    assert set(few) <= set(many)


def test_thick_oil_never_drags_less():
    """The other laws of viscosity are differences from a reference: their amounts have a sign all the same."""
    laws = [each for each in module.literature() if each.name == "viscosity_temperature"]
    assert len(laws) >= 3
    for law in laws:
        assert all(shape.bounds[0] == 0.0 for shape in law.shapes([]))


def test_of_a_laws_shapes_those_are_tried_that_these_runs_could_show():
    shapes = [Shape(f"{k}", {"v": float(k)}) for k in range(4)]
    own = module._possible(lambda values, runs: values["v"] < len(runs), lambda _: shapes, [run(), run()])
    assert own == shapes[:2]


def test_a_loss_of_the_flow_through_each_motor_is_a_lines_and_a_ports():
    """Whichever way, up to the square of the flow: the equations are one, no run tells the two apart, and neither may
    be larger; where a line was sized by the flow of all motors, it was named alone for a port's loss."""
    both = [each for each in module.literature() if each.law_name == "line_each_motor"]
    assert {each.name for each in both} == {"line_pressure_drop", "port_turbulence"}
    sizes = [each.plausible * each.scale(each.linear[0], {"line_pressure_drop": 2.5, "Pa": 0.7}) for each in both]
    assert sizes == [both[0].plausible * both[0].linear[0].typical] * 2


def test_by_much_more_than_the_square_of_its_flow_no_line_loses():
    runs = [SimpleNamespace(speed=np.linspace(-200.0, 200.0, 101), dt=0.02, groups=(1,))]
    of = {each.name: each for each in module.literature() if each.law_name == "line_each_motor"}
    tried = {name: {shape.values["n_le"] for shape in law.shapes(runs)} for name, law in of.items()}
    assert tried["port_turbulence"] - tried["line_pressure_drop"] == {2.6}
    steepest = next(s for s in of["line_pressure_drop"].shapes(runs) if s.values == {"n_le": 2.0, "b_le": 0.0})
    finer = [shape.values["n_le"] for shape in of["line_pressure_drop"].refined(steepest).shapes(runs)]
    assert 2.0 < max(finer) <= 2.5
    assert not friction.line({"n_le": 2.6}, runs)


@pytest.mark.parametrize(
    ("groups", "sides"), [((1,), ""), ((2, 2), "driving passive"), ((1, 2), "driving active passive")]
)
def test_a_line_of_one_side_is_looked_for_where_there_are_two_sides(groups, sides):
    """And one that drives both alone and beside another is only then told from one that does so beside it."""
    runs = [SimpleNamespace(groups=(None,) * count) for count in groups]
    laws = {f"line_{side}": side for side in ("driving", "active", "passive")}
    own = {law.law_name: law.shapes(runs) for law in module.literature() if law.law_name in laws}
    assert {laws[name] for name, shapes in own.items() if shapes} == set(sides.split())
    assert all(
        {s.values[f"n_l{laws[name][0]}"] for s in shapes} == {1.0, 1.75, 2.0} for name, shapes in own.items() if shapes
    )
    assert not friction.line({"n_lp": 2.6}, runs)


@pytest.mark.parametrize("way", [-1.0, -0.5, 0.5, 1.0])
def test_motors_of_one_displacement_churn_as_a_line_loses(way):
    """Churning by 0.4 of its mean more one way was a line's alone: churning was tried in one sense of rotation only."""
    laws = {each.law_name: each for each in module.literature()}
    runs = [SimpleNamespace(speed=np.linspace(-200.0, 200.0, 101), dt=0.02, groups=(1,))]
    line, churning = (
        {shape.values[b] for shape in laws[law].shapes(runs)}
        for law, b in (("line_pressure_power", "b_l"), ("churning_one_way", "b_cw"))
    )
    assert way in line & churning


@pytest.mark.parametrize(("name", "values"), [
    ("low_displacement_each_way", (3.0, 1.0, 1.0, 2.0)), ("viscosity_each_way", (0.03, 0.01, 40.0)),
    ("brake_each_way", (3.0, 1.0)), ("high_pressure_each_way", (3.0, 1.0, 2.0)),
])  # fmt: skip
def test_a_loss_of_another_amount_each_way_is_three_times_as_much_hoisting(name, values):
    term = term_named(name)
    at = {symbols.w: 50.0, symbols.p: 1e7, symbols.D: 1e-5, symbols.X: 3e-5, symbols.oil_temperature: 10.0}
    at |= dict(zip((p.symbol for p in term.parameters), values, strict=True))
    up, down = (float(term.equation.subs({**at, symbols.s: way})) for way in (1.0, -1.0))
    assert up == pytest.approx(3.0 * down)
    assert down > 0.0


def test_what_a_line_takes_goes_with_the_flow_and_with_how_thick_the_oil_is():
    """Of ISO VG 46 by Walther's law: at 20 degC 2.7 times the 46 cSt that it has at 40."""
    term = term_named("line_laminar")
    known = {symbols.n: 4.0, symbols.D: 1e-5, symbols.w: 50.0, term.parameters[0].symbol: 4e5}

    def torque(**other):
        at = {
            **known,
            symbols.oil_temperature: 40.0,
            **{getattr(symbols, name): value for name, value in other.items()},
        }
        return float(term.equation.subs(at))

    assert torque() == pytest.approx(4e5 * (4.0 * 1e-5 * 50.0 / 0.02) * 1e-5)
    assert torque(w=100.0) == pytest.approx(2.0 * torque())
    assert torque(oil_temperature=20.0) == pytest.approx(2.7 * torque(), rel=0.1)
    assert [each.name for each in module.literature() if each.law_name == "line_laminar"] == ["line_pressure_drop"]


def test_a_turbulent_line_is_at_one_displacement_what_a_motor_churns():
    """Both go with the fourth root of the viscosity and a power of the speed: churning alone was named for a hose."""
    line, churns = term_named("line_turbulent"), term_named("churning_viscous")
    size = {line.parameters[0].symbol: 4e5, line.parameters[1].symbol: 1.75}
    own = {churns.parameters[0].symbol: 2.0, churns.parameters[1].symbol: 1.75}
    ratios = []
    for oil, speed, stroke in ((5.0, 30.0, 1e-5), (50.0, 30.0, 1e-5), (20.0, 200.0, 1e-5), (20.0, 200.0, 2e-5)):
        at = {symbols.n: 2.0, symbols.D: stroke, symbols.w: speed, symbols.oil_temperature: oil, symbols.s: 1.0}
        ratios.append(float(line.equation.subs(size | at)) / float(churns.equation.subs(own | at)))
    assert ratios[1:] == pytest.approx([ratios[0], ratios[0], 2.0**2.75 * ratios[0]], rel=2e-2)
    assert [each.name for each in module.literature() if each.law_name == "line_turbulent"] == ["line_pressure_drop"]


@pytest.mark.parametrize(("name", "share"), [("gear_load_onset", 1.0), ("sheave_onset", 1.0 / 250.0)])
def test_from_a_load_on_a_loss_grows_with_what_is_beyond(name, share):
    term = term_named(name)
    amount, onset = (p.symbol for p in term.parameters)

    def torque(load):
        at = {amount: 3.0 * (1.0 if name == "gear_load_onset" else 1e-5), onset: 4e5, symbols.gear_ratio: 250.0}
        return float(term.equation.subs({**at, symbols.T_d: load}))

    size = 3.0 if name == "gear_load_onset" else 3e-5 * 5e5 * share
    assert torque(3e5) == torque(4e5) == 0.0
    assert torque(9e5) == pytest.approx(size)
    assert torque(1.4e6) == pytest.approx(2.0 * size)
    tried = [each for each in module.literature() if each.law_name == name]
    runs = [SimpleNamespace(drum_torque=np.array([1e5, 1e6]))]
    assert [shape.values[onset.name] for shape in tried[0].shapes(runs)] == pytest.approx([1.5e5, 3e5, 4.5e5, 6e5])


def test_a_level_falls_by_a_run_in_and_grows_again_by_wear():
    term = term_named("wear_bathtub")
    fall, rise, begin, lag = (p.symbol for p in term.parameters)

    def level(at):
        values = {fall: 4.0, rise: 0.5, begin: 1000.0, lag: 100.0}
        return float(term.equation.subs({**values, symbols.time: at}))

    assert level(500.0) == level(1000.0) == pytest.approx(4.0)
    assert level(1100.0) == pytest.approx(4.0 * np.exp(-1.0) + 0.5)
    assert level(3000.0) == pytest.approx(10.0, abs=1e-6)
    assert not any(p.lower < 0.0 for p in term.parameters if not p.shape)  # else it is any drift at all
    tried = next(each for each in module.literature() if each.law_name == "wear_bathtub")
    runs = [SimpleNamespace(start=at, time=np.array([0.0, 100.0])) for at in (1000.0, 1900.0)]
    assert [shape.values["tau_wb"] for shape in tried.shapes(runs)] == pytest.approx([100.0, 200.0, 400.0])


@pytest.mark.parametrize(("name", "shares"), [
    ("wear_under_load", {"since the first run": (0.0, 1.0), "around the middle of the dates": (-0.5, 0.5)}),
    ("wear_under_load_run_in", {"t_wr = 1000, tau_wr = 100": (1.0, 0.0)}),
    ("wear_under_load_sudden", {"t_we = 1500": (0.0, 1.0)}),
])  # fmt: skip
def test_what_carries_the_load_wears_in_proportion_to_it(name, shares):
    """A dry contact loses a coefficient of friction times its load: a worn sheave is no worn seal."""
    (tried,) = [each for each in module.literature() if each.law_name == name]
    assert (tried.name, tried.presumes, tried.linear[0].unit) == ("wear_drift", ("gear_load_loss",), "1")
    starts = (1000.0, 1200.0, 1700.0, 1900.0)
    runs = [SimpleNamespace(start=at, time=np.array([0.0, 100.0]), load=np.full(2, at)) for at in starts]
    assert tried.blind(runs) is None
    assert tried.blind(runs[2:]) is not None  # at one load it is a wear like any other
    shapes = {shape.label: shape.values for shape in tried.shapes(runs)}

    def torque(label, at, load):
        values = {p.symbol: shapes[label].get(p.name, 0.02) for p in tried.term.parameters}
        return float(tried.term.equation.subs(
            {**values, symbols.time: at, symbols.T_d: load, symbols.gear_ratio: 250.0}))  # fmt: skip

    assert len(tried.linear) == 1  # with two amounts it would be a loss that does not change as well
    for label, (first, last) in shares.items():
        assert torque(label, 1000.0, 5e5) == pytest.approx(0.02 * first * 5e5 / 250.0)
        assert torque(label, 2000.0, 5e5) == pytest.approx(0.02 * last * 5e5 / 250.0, abs=0.01)
        assert torque(label, 1400.0, 1e6) == pytest.approx(2.0 * torque(label, 1400.0, 5e5))
    if name == "wear_under_load":  # a line that began long before is hardly a drift
        assert set(shapes) == set(shares)


def test_a_wear_under_load_is_drawn_either_way_under_a_name_of_its_own():
    own = [row for row in CURVES if row.cause == "wear_drift"]
    assert [(row.shape, row.presumes) for row in own if row.times == (LOAD,)] == [
        ("rising", ("gear_load_loss",)), ("falling", ("gear_load_loss",))]  # fmt: skip
    assert len({module.name_of(row) for row in own}) == len(own) == 5


def test_a_length_adds_by_steps_as_well():
    """A sinker that leaves the deck, a load that enters the water: not ever more with the wire paid out."""
    own = [row for row in module.SURFACES if row.cause == "tare_load"]
    assert [row.shape for row in own] == ["convex_rising", "rising"]
    assert len({module.name_of(row) for row in own}) == 2
    assert not any(row.opposing for row in own)


def test_every_curve_and_surface_has_a_name_of_its_own():
    """By which a slot is found again: by what multiplies it, its signals, its way and, where causes differ in it, its
    shape."""
    rows = (*CURVES, *module.SURFACES)
    names = [module.name_of(row) for row in rows]
    assert len(set(names)) == len(names)
    assert all(name.startswith(f"free_{row.cause}") for name, row in zip(names, rows, strict=True))
    assert {"free_wear_drift", "free_wear_drift_falling", "free_wear_drift_convex"} < set(names)
    assert {"free_low_displacement_loss_pressure", "free_low_displacement_loss_falling"} < set(names)
    assert {"free_line_pressure_drop_displacement_hoisting", "free_line_pressure_drop_displacement_lowering"} < set(
        names
    )
    assert {"free_tare_load", "free_tare_load_rising", "free_notch_loss_pressure_speed_magnitude"} < set(names)
    assert {"free_stribeck_drum_torque_hoisting", "free_stribeck_drum_torque_lowering"} < set(names)


def test_what_speed_changes_of_a_cause_of_load_or_stroke_is_drawn():
    """A worm's flanks that push apart faster than they slide, a swash plate that tips: of speed as well, and with a
    level of their own where it stands still. A loss of a gear that grows with speed is anybody's."""
    found = {row.cause: row for row in module.SURFACES if SPEED in row.signals and len(row.signals) == 2}
    assert not found["gear_asymmetry"].opposing
    assert (found["gear_asymmetry"].shape, found["gear_asymmetry"].anchor) == ("rising", "low none")
    stroke = found["low_displacement_loss"]
    assert (stroke.shape, stroke.anchor, stroke.times) == ("falling rising", "high none", ("pressure",))
    assert module.shapes_over("gear_load_loss", SPEED) == {"falling"}
    assert (
        module.shapes_over("gear_asymmetry", SPEED) == module.shapes_over("low_displacement_loss", SPEED) == {"rising"}
    )


def test_what_a_cause_may_look_like_is_said_for_each_of_its_signals():
    assert module.shapes_over("wear_drift", "time") == {"rising", "falling", "convex_rising"}
    assert module.shapes_over("high_pressure_mixed", SPEED) == {"falling"}
    assert module.shapes_over("high_pressure_mixed", "pressure") == {"rising", "convex_rising"}
    assert module.shapes_over("wear_drift", "pressure") == module.shapes_over("nothing", "time") == set()


def test_knots_are_quantiles_the_outermost_ones_and_none_too_near_another():
    values = np.linspace(0.0, 100.0, 1001)
    assert module._knots(values, (0.02, 0.5, 0.98)) == pytest.approx([2.0, 50.0, 98.0])
    assert module._knots(values, (0.0, 0.01, 0.5, 0.99, 1.0)) == pytest.approx([0.0, 50.0, 100.0])
    assert module._knots(np.full(9, 7.0), (0.02, 0.5, 0.98)).tolist() == [7.0]
    assert module._knots(np.array([]), (0.02, 0.98)).tolist() == []
    assert module._knots(np.array([1.0 / 3.0, 2.0]), (0.0, 1.0)).tolist() == [0.333333333, 2.0]


def test_a_curve_has_more_knots_than_a_surface_and_a_finer_one_has_them_in_between():
    curve, surface = row_of(SPEED), module.SURFACES[0]
    assert module._shares(surface) == LIMITS.surface_knots
    fine = module._shares(curve, fine=True)
    assert len(fine) == 2 * len(curve.knots) - 1
    assert fine[::2] == curve.knots
    assert fine[1::2] == pytest.approx([0.5 * (a + b) for a, b in itertools.pairwise(curve.knots)])


@pytest.mark.parametrize(
    ("times", "unit"),
    [((), "N*m"), ((module.SWASH,), "Pa"), ((LEFT,), "Pa"), ((LOAD,), "1"), ((SPEED,), "N*m*s/rad")],
)
def test_what_multiplies_a_curve_leaves_it_the_unit_of_a_torque_less(times, unit):
    assert module._unit(times) == unit


def test_a_law_of_one_direction_is_there_for_each_of_the_two():
    """Which way a gear or a valve loses more is nothing that its kind tells."""
    one_way = [each for each in literature() if each.law_name.endswith(("one_way", "one way", "one direction alone"))]
    assert len(one_way) >= 5
    for each in one_way:
        (uneven,) = {name for shape in each.shapes([]) for name in shape.values if name.startswith("b_")}
        weights = {shape.values[uneven] for shape in each.shapes([])}
        assert weights == {-weight for weight in weights}, each.law_name
        assert {-1.0, 1.0} <= weights, each.law_name
