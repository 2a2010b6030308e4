"""The parts of the torque balance in numbers by hand: what hangs, what swings, what rubs, and errors within limits."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.signal import freqz

from winch_friction.commissioning import balance, diagnose, mistakes
from winch_friction.commissioning.balance import closure, friction_point, static_torque, typical_friction
from winch_friction.commissioning.view import GroupView, RunView, broken_cells, usable, view_of, views_of
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction.compiled import ORDER
from winch_friction.physics.friction.symbols import GROUP_SIGNALS
from winch_friction.physics.signals import Run

TIME = np.arange(80) * 0.2
SPEED = 100.0 * np.sin(0.8 * TIME)
ONE = np.ones(80)
LEVER = 1.0 / 250.0  # m of wire per rad
RATED = 10.0 * 3e-5 * 300e5  # N m, ten motors at 300 bar


def view(**more):
    known = {
        "name": "run", "time": TIME, "speed": SPEED, "acceleration": 2.0 * ONE, "load": 5e4 * ONE,
        "layer": ONE, "radius": ONE, "gear_ratio": 250.0, "inertia": 1.5, "motors": 10.0, "max_displacement": 3e-5,
        "heave": None, "heave_acceleration": 0.0 * ONE,
        "groups": {"main": GroupView(10.0, 100e5 * ONE, 150e5 * ONE, 3e-5 * ONE)},
    }  # fmt: skip
    return RunView(**{**known, **more})


@pytest.mark.parametrize(
    ("names", "roles"), [("main", [0.0]), ("active passive", [1, -1]), ("passive active", [-1, 1])]
)
def test_the_point_of_a_view_knows_which_of_the_groups_drives(names, roles):
    point = friction_point(view(groups=dict.fromkeys(names.split(), GroupView(5.0, ONE, ONE, ONE))))
    own = [each.name for each in GROUP_SIGNALS]
    at = [len(ORDER) + len(own) * k + own.index("role") for k in range(len(roles))]
    assert [float(point[k][0]) for k in at] == roles


# -- what hangs, swings and rubs
def test_a_load_hangs_at_its_lever_and_a_measured_torque_is_it():
    np.testing.assert_allclose(static_torque(view()), 5e4 * GRAVITY * LEVER)
    np.testing.assert_allclose(static_torque(view(load_torque=7.0 * ONE)), 7.0)


@pytest.mark.parametrize("heave", [0.0, 0.5, -0.008, -0.5])
def test_a_load_is_moved_by_winch_and_crane_tip_together(heave):
    found = balance._swing(view(heave_acceleration=heave * ONE))
    np.testing.assert_allclose(found, 5e4 * LEVER * (2.0 * LEVER + heave), atol=1e-9)
    assert not balance._swing(view(load_torque=ONE)).any()
    assert not balance._swing(view(load=np.nan * ONE)).any()


@pytest.mark.parametrize(
    ("speed", "load", "share", "of_the_load"),
    [
        (200.0, 0.0, 0.02 + 0.04, 0.0),
        (100.0, 0.0, 0.02 + 0.01, 0.0),
        (600.0, 0.0, 0.02 + 0.36, 0.0),
        (1200.0, 0.0, 0.02 + 0.36, 0.0),  # no law means anything out there
        (0.1, 5e4, 0.02, 0.045),
        (0.1, -5e4, 0.02, 0.045),
        (0.1, np.nan, 0.02, 0.0),
    ],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_typical_friction_is_a_share_of_what_the_motors_give_and_of_the_load(speed, load, share, of_the_load, sign):
    found = typical_friction(view(speed=sign * speed * ONE, load=load * ONE))
    expected = share * RATED + of_the_load * 5e4 * GRAVITY * LEVER
    np.testing.assert_allclose(found, sign * expected, rtol=1e-5)


def test_typical_friction_grows_no_more_beyond_the_rated_torque():
    found = typical_friction(view(speed=0.1 * ONE, load=1e9 * ONE))
    np.testing.assert_allclose(found, (0.02 + 0.045) * RATED, rtol=1e-5)


@pytest.mark.parametrize("bounce", [0.5, 2.0])
def test_a_load_on_its_wire_swings_at_its_own_frequency_with_a_ropes_damping(bounce):
    """Of the standing load nothing is lost, and at resonance it is 1 / (2 * 0.04) times as much."""
    _, (still, ringing) = freqz(*balance._mode(bounce, 0.2), worN=[0.0, bounce * 0.2])
    assert abs(still) == pytest.approx(1.0)
    assert abs(ringing) == pytest.approx(np.sqrt(1.0 + 0.08**2) / 0.08, rel=1e-6)


def test_no_wire_swings_a_load_by_more_than_its_weight_or_faster_than_it_is_seen():
    load, rigid = 10.0 * ONE, 100.0 * np.sin(2.0 * TIME)
    found = balance._bouncing(view(bounce=2.0), load, rigid)
    assert (found.min(), found.max()) == (-10.0, 10.0)
    for bounce in (0.0, 5.1):  # a fifth of a second is one rad at 5 rad/s
        assert not balance._bouncing(view(bounce=bounce), load, rigid).any()


@pytest.mark.parametrize(("weight", "torque"), [(1e4, 40.0), (-1e4, 0.0), (1e9, 0.3 * RATED), (np.nan, 0.0)])
def test_a_wire_weighs_at_the_lever_and_never_lifts(weight, torque):
    error = balance._unweighed(view(wire=weight * ONE), RATED)
    np.testing.assert_allclose(error.torque, torque)
    assert (error.lower, error.upper) == (0.0, 1.2)
    assert not balance._unweighed(view(), RATED).torque.any()


def test_without_a_load_cell_a_winch_may_carry_anything_that_hangs():
    known, hydraulic, electric = (
        balance._offset(3, 50.0, k, h) for k, h in ((True, True), (False, True), (False, False))
    )
    assert (known.sigma, known.lower, known.upper) == (0.01, -4.0, 4.0)
    assert (hydraulic.sigma, hydraulic.lower, hydraulic.upper) == (1.2, -0.01, 1.0)
    assert (electric.sigma, electric.lower, electric.upper) == (1.2, -1.0, 1.0)
    np.testing.assert_array_equal(known.torque, 50.0)


# -- the fit
@pytest.mark.parametrize("seed", range(8))
def test_errors_within_their_limits_fit_as_well_as_can_be(seed):
    """Against scipy's bounded least squares, with the unit prior as rows of its own."""
    generator = np.random.default_rng(seed)
    design, target = generator.standard_normal((30, 4)), 3.0 * generator.standard_normal(30)
    limits = np.column_stack([-generator.uniform(0.05, 0.5, 4), generator.uniform(0.05, 0.5, 4)])
    found = balance._bounded(design.T @ design + np.eye(4), design.T @ target, limits)
    whole, ends = np.vstack([design, np.eye(4)]), np.concatenate([target, np.zeros(4)])
    np.testing.assert_allclose(found, lsq_linear(whole, ends, limits.T).x, atol=1e-6)


def test_the_score_counts_forty_samples_and_the_stretching():
    """One column of ones: of a residual of 2 the ridge takes 40 / 41."""
    design, target, free = np.ones((200, 1)), np.full(200, 0.5), np.array([[-np.inf, np.inf]])
    theta, score, left = balance._robust_ridge(design, target, free)
    np.testing.assert_allclose(theta, 0.5 * 40.0 / 41.0, rtol=1e-3)
    np.testing.assert_allclose(left, 0.5 / 41.0, rtol=0.05)
    assert score == pytest.approx(float(40.0 * left[0] ** 2 + theta[0] ** 2), rel=1e-3)


def test_what_closes_is_said_in_newton_metres():
    """The motors hold the load and typical friction; then 20 N m more than that, which no error of these is."""
    held = static_torque(view())
    rubbing = held + typical_friction(view()) + 1.5 * 2.0 + balance._swing(view())
    drop = rubbing / (10.0 * 3e-5)
    found = closure(view(groups={"main": GroupView(10.0, drop, drop + 50e5, 3e-5 * ONE)}), None)
    assert found.before == pytest.approx(0.0, abs=1e-6)
    assert found.score == pytest.approx(0.0, abs=1e-6)
    assert found.level == pytest.approx(held[0])
    other = closure(view(groups={"main": GroupView(10.0, 1.2 * drop, drop + 50e5, 3e-5 * ONE)}), None)
    moving = view().moving
    assert other.before == pytest.approx(float(np.sqrt(np.mean((0.2 * rubbing[moving]) ** 2))))
    assert other.level == pytest.approx(held[0])
    assert 1.0 < other.after < other.before


# -- a run in blocks
def test_a_block_beside_a_turn_has_no_certain_direction():
    speed = np.array([50.0, 50.0, 50.0, -50.0, -50.0, -50.0, 1.0, 3.0, 50.0, np.nan])
    found = view(speed=speed).moving
    assert found.tolist() == [True, True, False, False, True, False, False, True, False, False]


def test_few_cells_that_no_sensor_shows_are_broken_and_many_are_a_unit():
    pressure = np.full(100, 1e7)
    pressure[[5, 7]] = 1e12
    assert broken_cells("main.pressure_a", pressure).tolist() == [5, 7]
    assert np.flatnonzero(np.isnan(usable("main.pressure_a", pressure))).tolist() == [5, 7]
    assert pressure[5] == 1e12  # the run keeps its own
    pressure[9] = -1e12
    assert not broken_cells("main.pressure_a", pressure).size
    assert broken_cells("main.pressure_a", np.array([1e7, 1e12])).tolist() == [1]  # one of few is one


def run_of(crane, **more):
    time = np.arange(500) * 0.02
    one = np.ones(500)
    columns = {
        "time": 7.0 + time, "motor_speed": 50.0 + 3.0 * time, "main.pressure_a": 120e5 * one,
        "main.pressure_b": 20e5 * one, "main.displacement": 3e-5 * one, "hook_load": 4e4 * one,
        "wire_out": 900.0 - 0.5 * time,
    }  # fmt: skip
    return Run("run", {**columns, **more})


def test_blocks_of_a_fifth_of_a_second_stand_for_their_middles(crane_150t):
    found = view_of(run_of(crane_150t), crane_150t)
    np.testing.assert_allclose(found.time[:2], [7.1, 7.3])
    np.testing.assert_allclose(found.acceleration, 3.0)
    np.testing.assert_allclose(found.speed[0], 50.0 + 3.0 * 0.09)
    main = found.groups["main"]
    assert (main.count, main.drop[0], main.pressure_sum[0]) == (11.0, pytest.approx(100e5), pytest.approx(140e5))
    np.testing.assert_allclose(found.rates["wire_out"], 0.5)
    np.testing.assert_allclose(found.wire[0], 24.5 * GRAVITY * (900.0 - 0.045))
    np.testing.assert_allclose(found.radius, 1.136)  # nobody says the layer: the outer one
    # a wire of 3e8 N over its mean length, and the load
    assert found.bounce == pytest.approx(np.sqrt(3e8 / (900.0 - 0.5 * 4.99) / 4e4), rel=1e-3)


@pytest.mark.parametrize(("layer", "radius"), [(1.0, 0.8), (2.0, 0.867), (0.0, 0.8), (9.0, 1.136), (np.nan, 1.136)])
def test_a_layer_that_the_drum_has_not_is_its_nearest(layer, radius, crane_150t):
    found = view_of(run_of(crane_150t, wire_layer=np.full(500, layer)), crane_150t)
    np.testing.assert_allclose(found.radius, radius)


def test_errors_are_of_the_largest_torque_that_any_run_shows(crane_150t):
    """Half as much again, between 0.3 of the rated torque and all of it."""
    one = np.ones(500)
    light, heavy = (run_of(crane_150t, **{"main.pressure_a": (20.0 + bar) * 1e5 * one}) for bar in (30.0, 120.0))
    rated, seen = 11 * crane_150t.max_displacement * 300e5, 11 * 3e-5 * 120e5
    for runs, size in (((light, heavy), 1.5 * seen), ((light,), 0.3 * rated), ((heavy, heavy), 1.5 * seen)):
        found = [each.error_torque for each in views_of([(run, crane_150t) for run in runs])]
        assert found == pytest.approx([size] * len(runs))
    assert view(seen_torque=0.9 * RATED).error_torque == RATED
    assert view().error_torque == RATED  # nobody has looked at the others


# -- units: what stands in the log over what its header says
REV = 2.0 * np.pi
SIZES = {
    "kg": 1.0, "t": 1e3, "kN": 1e3 / GRAVITY, "lb": 0.45359237, "Pa": 1.0, "kPa": 1e3, "bar": 1e5, "MPa": 1e6,
    "psi": 6894.757, "rad/s": 1.0, "deg/s": REV / 360.0, "rpm": REV / 60.0, "1/s": REV, "m^3/rad": 1.0,
    "cm^3/rad": 1e-6, "cm^3/rev": 1e-6 / REV, "l/rev": 1e-3 / REV, "mm^3/rev": 1e-9 / REV,
}  # fmt: skip
TABLES = (mistakes.LOAD_UNITS, mistakes.PRESSURE_UNITS, mistakes.SPEED_UNITS, mistakes.DISPLACEMENT_UNITS)


@pytest.mark.parametrize(("factor", "words"), [each for table in TABLES for each in table])
def test_a_unit_under_another_is_put_right_by_the_quotient_of_the_two(factor, words):
    written, header = words.split(" under ")
    assert factor == pytest.approx(SIZES[written] / SIZES[header.strip("[]")], rel=1e-5)


def test_a_share_of_the_largest_displacement_is_put_right_to_it(crane_150t):
    """What a motor that is swivelled out shows, as it is read, times the factor."""
    largest = crane_150t.max_displacement
    shares = mistakes._displacement_table(crane_150t)[len(mistakes.DISPLACEMENT_UNITS) :]
    read = {
        "a fraction of the largest displacement, read as m^3/rad": 1.0,
        "a fraction under [cm^3/rev]": SIZES["cm^3/rev"],
        "per cent under [cm^3/rev]": 100.0 * SIZES["cm^3/rev"],
        "per cent, read as m^3/rad": 100.0,
    }
    assert {words: pytest.approx(factor * read[words]) for factor, words in shares} == dict.fromkeys(read, largest)


def test_either_port_may_have_a_transducer_of_another_unit_of_a_hundred_times_at_most(crane_150t):
    """An input of 0 to 600 read in MPa for bar, kPa or psi; nobody reads a transducer of Pa as one of bar."""
    told = {each.channel: set() for each in mistakes._units([view(rates={})], crane_150t, ("main",))}
    for each in mistakes._units([view(rates={})], crane_150t, ("main",)):
        told[each.channel].add(round(each.factor, 4))
    assert told["pressure_a"] == told["pressure_b"] == {10.0, 0.1, 0.0689, 14.5038, 0.01, 100.0}
    assert min(told["pressure"]) < 1e-4


def test_a_speed_and_its_command_are_both_in_rpm_or_in_rad_s_where_they_are_in_another_unit(crane_150t):
    """One PLC writes both; what a drive's own log has beside it, 1/s or deg/s, stands in one column."""
    both = mistakes._units([view(rates={"speed_reference": 100.0 * ONE})], crane_150t, ("main",))
    said = [each.words for each in both if each.words.startswith("motor_speed and speed_reference hold")]
    assert [each.rpartition(" hold ")[2] for each in said] == ["rad/s under [rpm]", "rpm under [rad/s]"]


@pytest.mark.parametrize(("seen", "doubted"), [(80, True), (50, True), (0, False)])
def test_a_load_that_was_measured_for_a_while_may_be_in_another_unit(crane_150t, seen, doubted):
    load = np.where(np.arange(80) < seen, 5e4, np.nan)
    told = {each.channel for each in mistakes._units([view(load=load, rates={})], crane_150t, ("main",))}
    assert ("hook_load" in told) is doubted


@pytest.mark.parametrize(("slow", "moves"), [(2.9, False), (3.1, True), (-3.1, True), (-2.9, False)])
def test_a_block_moves_from_three_per_cent_of_the_largest_speed_on(slow, moves):
    speed = np.where(np.arange(80) < 40, np.sign(slow) * 100.0, slow)
    assert view(speed=speed).moving[50:].tolist() == [moves] * 30


# -- mistakes that only some runs can hold
def test_a_layer_is_doubted_unless_every_run_lies_on_it(crane_150t):
    def doubted(*layers):
        found = list(mistakes._layers([view(layer=layer * ONE) for layer in layers], crane_150t))
        return {int(each.factor): float(each.undo(view()).radius[0]) for each in found}

    radii = dict(enumerate(crane_150t.drum.layer_radii, 1))
    assert doubted(2.0) == {k: r for k, r in radii.items() if k != 2}
    assert doubted(2.0, 3.0) == radii
    words = [each.words for each in mistakes._layers([view(layer=2.0 * ONE)], crane_150t)]
    assert words[0] == "the wire lies on layer 1, not where wire_layer says"
    # a drum of one layer has no other that the wire could lie on, whatever is logged
    flat = replace(crane_150t, drum=replace(crane_150t.drum, layer_radii=crane_150t.drum.layer_radii[:1]))
    assert list(mistakes._layers([view(layer=2.0 * ONE)], flat)) == []


def test_a_tare_is_a_twentieth_of_what_the_weakest_run_holds_at_most():
    weak = view(groups={"main": GroupView(5.0, ONE, ONE, ONE)})
    most = 0.05 * 0.5 * RATED / (GRAVITY * LEVER)
    for tare, said in ((0.99 * most, True), (1.01 * most, False), (0.0, False), (-100.0, False)):
        found = [each.cause for each in mistakes.free_mistakes([view(), weak], {}, tare)]
        assert found == (["tare"] if said else [])


def test_a_displacement_that_is_negative_at_times_swivels_over_centre():
    turned = view(groups={"main": GroupView(10.0, ONE, ONE, np.where(TIME < 1.0, np.nan, -ONE))})
    swivelled = view(groups={"main": GroupView(10.0, ONE, ONE, np.where(TIME < 1.0, ONE, -ONE))})
    assert mistakes._negative(turned, "main")
    assert np.nanmin(mistakes._upright(turned).groups["main"].displacement) == 1.0
    assert not mistakes._negative(swivelled, "main")
    assert not mistakes._negative(turned, "other")
    np.testing.assert_array_equal(mistakes._upright(swivelled).groups["main"].displacement,
                                  swivelled.groups["main"].displacement)  # fmt: skip


def test_a_sign_of_the_heave_may_be_wrong_though_some_runs_have_none(crane_150t):
    """Runs at the quay, where the crane stands still, beside those at sea."""

    def doubted(*heaves):
        found = mistakes._signs([view(heave=heave, rates={}) for heave in heaves], ("main",), crane_150t)
        return "heave_velocity" in {each.channel for each in found}

    assert doubted(None, ONE)
    assert not doubted(None, None)


def test_a_delay_is_looked_for_beside_the_likeliest_mistake_alone(monkeypatch):
    """It takes whole records to try."""
    monkeypatch.setattr(diagnose, "_free", lambda views: [])
    firsts = [mistakes.Mistake("scale", name, name, 1.0, lambda each: each) for name in ("hook_load", "displacement")]
    late = mistakes.Mistake("delay", "motor_speed", "late", 1.0, lambda each: each)
    found = diagnose._beside(firsts, [*firsts, late], [view()])
    assert [tuple(part.channel for part in each.parts) for each in found] == [("hook_load", "motor_speed")]


def test_every_two_common_mistakes_of_different_things_are_tried_together():
    """The sign of one channel, two ports or two groups exchanged, and a usual unit; a rare unit, a scale or a delay as
    one of two explains whatever there is."""
    causes = {"sign": "motor_speed", "ports": "main", "groups": "active", "scale": "hook_load", "delay": "motor_speed"}
    known = [mistakes.Mistake(cause, channel, cause, 1.0, lambda each: each) for cause, channel in causes.items()]
    units = ("hook_load holds kg under [t]", "hook_load holds lb under [t]")
    known += [mistakes.Mistake("unit", "hook_load", words, 0.0, lambda each: each, 1e-3) for words in units]
    found = {tuple(part.words.split(" ")[-1] for part in each.parts) for each in diagnose.common_pairs(known)}
    alone = ("sign", "ports", "groups", "[t]")
    assert found == {(first, second) for k, first in enumerate(alone) for second in alone[k + 1 :]}


def test_the_eight_that_leave_least_of_the_worst_runs_are_tried_on_every_run(monkeypatch):
    bench = diagnose._Bench([view()], np.array([900.0]), None)
    monkeypatch.setattr(bench, "_undone", lambda mistake, own: 10.0 * mistake.cost)
    monkeypatch.setattr(bench, "_tried", lambda mistake: diagnose.Hypothesis(mistake, -mistake.cost, (), ()))
    asked = [mistakes.Mistake("unit", "hook_load", "", float(cost), lambda each: each) for cost in range(12)]
    assert [each.mistake.cost for each in bench.ranked(asked[::-1])] == [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0]


@pytest.mark.parametrize(("blocks", "said"), [(80, True), (5, True), (4, False)])
def test_the_mass_that_a_load_lacks_is_told_by_a_run_of_five_blocks(blocks, said):
    """Of 500 kg more than the cell says: ten motors of 30 cm^3/rad each hold it, beside friction and inertia."""
    as_told = view()
    drive = static_torque(as_told) + typical_friction(as_told) + 1.5 * 2.0 + 500.0 * GRAVITY * LEVER
    shown = np.where(np.cumsum(as_told.moving) <= blocks, drive / (10.0 * 3e-5), np.nan)
    found = diagnose._free([view(groups={"main": GroupView(10.0, shown, 150e5 * ONE, 3e-5 * ONE)})])
    assert [each.factor for each in found if each.cause == "tare"] == [pytest.approx(500.0)] * said
    assert bool(found) == said


@pytest.mark.parametrize("names", [("main",), ("active", "passive")])
def test_a_group_s_own_scale_is_asked_where_another_group_tells_it(monkeypatch, names):
    """The only group's scale is the load's, which is asked already."""
    asked = {}
    monkeypatch.setattr(diagnose, "free_mistakes", lambda views, factors, tare: asked.update(factors) or [])
    diagnose._free([view(groups={name: GroupView(10.0, 90e5 * ONE, 150e5 * ONE, 3e-5 * ONE) for name in names})])
    assert set(asked) == {"load", *(names if len(names) > 1 else ())}
