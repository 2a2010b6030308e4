"""Parts of a balance by figures: pressures that a torque takes, what hangs on which radius, and how it swings."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import expansion, repair
from winch_friction.discrepancy.preparation import balance, suspended_load, wire_mode
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.suspended_load import Mode, SuspendedLoad
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.winch import Drum

ONE = np.ones(3)


def group(name, balances, count=2.0, swash=3e-5, drop=1e7, low=1e6):
    drop = drop * ONE
    return GroupSignals(name, count, drop, np.abs(drop) + 2.0 * low, low * ONE, swash * ONE, balances, drop)


def torque(groups):
    return sum(g.count * g.displacement * g.pressure for g in groups)


# -- pressures
@pytest.mark.parametrize("wanted", [900.0, -300.0])
def test_the_driving_group_has_the_pressure_that_the_torque_takes_beside_the_passive_one(wanted):
    """The passive motors carry 4 * 2e-5 * 1e7 = 800 N m."""
    groups = (group("active", True), group("passive", False, 4.0, 2e-5))
    driving, passive = balance.with_predicted_pressure(groups, wanted * ONE)
    assert driving.pressure == pytest.approx((wanted - 800.0) / 6e-5 * ONE)
    assert torque((driving, passive)) == pytest.approx(wanted * ONE)
    # port A and port B: the higher one is the drop above the lower
    assert driving.pressure_sum == pytest.approx(np.abs(driving.pressure) + 2e6)
    assert passive is groups[1]


def test_motors_that_are_swung_back_have_the_pressure_that_is_logged():
    """Next to no stroke tells nothing of the pressure: of a drive that sets its torque by the stroke it would be
    thousands of bar, and each step of the fixed point would multiply what friction grows with it."""
    own = replace(group("main", True, drop=3e7), displacement=np.array([3e-5, 3e-6, -3e-7]))
    (found,) = balance.with_predicted_pressure((own,), 60.0 * ONE, 4e-6)
    assert found.pressure == pytest.approx(np.array([1e6, 3e7, 3e7]))
    assert found.pressure_sum == pytest.approx(found.pressure + 2e6)


def test_an_error_of_the_passive_pressures_is_taken_out_of_them_alone():
    groups = (group("active", True), group("passive", False, 4.0, 2e-5), group("other", False, 1.0, 2e-5))
    found = balance.without_error(groups, 50.0 * ONE)
    assert found[0] is groups[0]
    assert torque(found) == pytest.approx(torque(groups) - 50.0)
    assert all(own.pressure == pytest.approx(1e7 - 50.0 / 1e-4) for own in found[1:])  # every bar alike
    assert all(own.displacement == pytest.approx(2e-5 * ONE) for own in found[1:])


@pytest.mark.parametrize(("error", "share"), [(80.0, 0.1), (-80.0, -0.1), (8000.0, 0.5), (-8000.0, -0.5)])
def test_an_error_of_the_passive_displacements_is_a_share_of_them_and_never_most(error, share):
    groups = (group("active", True), group("passive", False, 4.0, 2e-5))
    found = balance.without_error(groups, 0.0 * ONE, error * ONE)[1]
    assert found.displacement == pytest.approx(2e-5 * (1.0 - share) * ONE)
    assert found.pressure == pytest.approx(1e7 * ONE)
    nothing = balance.without_error((group("passive", False, drop=0.0),), 0.0 * ONE, error * ONE)[0]
    assert nothing.displacement == pytest.approx(3e-5 * ONE)  # nothing is carried, so nothing tells


@pytest.mark.parametrize(
    ("values", "filled"), [([1.0, np.nan, 3.0, np.nan], [1.0, 2.0, 3.0, 3.0]), ([np.nan] * 2, [0.0] * 2)]
)
def test_what_is_not_known_is_drawn_straight(values, filled):
    assert balance._filled(np.array(values)).tolist() == filled


def test_a_state_is_a_sum_over_what_was_before_with_what_is_kept_of_it():
    keep, add = np.array([0.5, 0.9, 0.2, 0.7, 0.6]), np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    z, expected = 10.0, []
    for k in range(5):
        z = keep[k] * z + add[k]
        expected.append(z)
    assert balance._recursion(10.0, keep, add.copy()) == pytest.approx(expected)
    assert keep.tolist() == [0.5, 0.9, 0.2, 0.7, 0.6]


def test_a_balances_gap_is_what_was_measured_beyond_what_is_predicted_and_a_simulation_stands_where_there_is_one():
    own = balance.Balance(7.0 * ONE, 5.0 * ONE, (), (), (), 1.0)
    assert own.gap.tolist() == [2.0] * 3
    assert own.simulated_torque is own.predicted
    assert balance.Balance(7.0 * ONE, 5.0 * ONE, (), (), (), 1.0, 6.0 * ONE).simulated_torque.tolist() == [6.0] * 3


# -- what hangs
LOAD = SuspendedLoad(1000.0 * ONE, 0.9 * ONE, 0.009 * ONE, 0.5 * ONE, -0.2 * ONE)


def test_a_load_hangs_by_its_weight_on_the_radius_and_swings_on_the_lever():
    assert LOAD.drum_torque == pytest.approx(1000.0 * GRAVITY * 0.9 * ONE)
    assert LOAD.inertial_torque == pytest.approx(1000.0 * 0.009 * 0.5 * ONE)
    assert LOAD.heave_torque == pytest.approx(-1000.0 * 0.009 * 0.2 * ONE)


@pytest.mark.parametrize(("damping", "length", "followed"), [(0.1, None, None), (0.1, 5.0 * ONE, None), (0.0, None, 0)])
def test_both_accelerations_go_behind_the_same_wire(monkeypatch, damping, length, followed):
    asked = []

    class Hung:
        def __init__(self, *behind):
            self.behind = behind

        def acceleration(self, *mode):
            asked.append((*self.behind[1:], *mode))
            return 2.0 * self.behind[0]

    monkeypatch.setattr(suspended_load, "Hung", Hung)
    found = LOAD.on_wire(0.02, Mode(3.0, damping, share=0.8), length)
    if followed == 0:
        assert found is LOAD
        return
    assert asked == [(0.02, None, 0.8, 3.0, damping)] * 2
    assert (found.acceleration[0], found.heave[0]) == (1.0, -0.4)
    assert found.mass is LOAD.mass


@pytest.mark.parametrize(
    ("hanging", "wire", "swings"), [(900.0, 300.0, 700.0), (900.0, 0.0, 900.0), (900.0, 850.0, 900.0)]
)
def test_a_third_of_a_wires_mass_swings_along(hanging, wire, swings):
    """Of what is nearly all wire nothing is known."""
    assert suspended_load.swinging_mass(hanging, wire) == pytest.approx(swings)


@pytest.mark.parametrize(("load", "wire"), [(500.0, 500.0), (900.0, 100.0), (300.0, 700.0)])
def test_of_a_heavy_wire_what_hangs_near_the_drum_does_not_swing(load, wire):
    """A wire of forty pieces with a load at its end: the first mode's effective mass, as a share of all that hangs."""
    masses = np.full(40, wire / 40.0)
    masses[-1] = load + 0.5 * wire / 40.0
    springs = 2.0 * np.eye(40) - np.eye(40, k=1) - np.eye(40, k=-1)
    springs[-1, -1] = 1.0
    shape = np.linalg.eigh(springs / np.sqrt(masses[:, None] * masses))[1][:, 0] / np.sqrt(masses)
    effective = (masses @ shape) ** 2 / (masses @ shape**2)
    assert wire_mode.swing_share(load + wire, wire) == pytest.approx(effective / (load + wire), rel=0.05)


def test_of_a_light_wire_all_that_hangs_swings():
    assert (wire_mode.swing_share(900.0, 0.0), wire_mode.swing_share(900.0, 850.0)) == (1.0, 1.0)


def test_what_does_not_swing_moves_as_on_a_rigid_wire():
    rigid = np.sin(0.3 * np.arange(200.0))
    whole, part = (suspended_load.Hung(rigid, 0.02, None, share).acceleration(7.0, 0.1) for share in (1.0, 0.75))
    assert part == pytest.approx(0.75 * whole + 0.25 * rigid)


@pytest.mark.parametrize("speed", [60.0, -60.0])
def test_a_rope_that_climbs_onto_a_larger_layer_is_faster_after_half_a_turn(speed):
    """Half a turn is 314 rad of the shaft and takes 5 s; a drum that hardly moves does not spread it for ever."""
    lever = np.where(np.arange(1000) < 500, 0.008, 0.009)
    motion = SimpleNamespace(speed=np.full(1000, speed))
    found = suspended_load._climbing(lever, motion, CRANE, 0.02)
    assert np.sum(found) * 0.02 == pytest.approx(0.001 * speed)
    (climbs,) = np.nonzero(found)
    assert (climbs[0], climbs[-1]) == (500 - 131, 500 + 131)
    slow = suspended_load._climbing(lever, SimpleNamespace(speed=np.full(1000, 0.1)), CRANE, 0.02)
    assert np.count_nonzero(slow) == 501
    assert not suspended_load._climbing(np.full(1000, 0.008), motion, CRANE, 0.02).any()


def test_samples_within_half_a_turn_of_where_the_layer_changes_are_on_neither():
    angle = 10.0 * np.arange(200.0)  # of the shaft: a turn of the drum in 62.8 samples
    load = SuspendedLoad(angle, np.where(angle < 1000.0, 0.8, 0.85), angle, angle, angle)
    assert (load.on_one_layer(angle, 100.0) == (np.abs(angle - 1000.0) > 100.0 * np.pi)).all()
    assert SuspendedLoad(angle, 0.8 + 0.0 * angle, angle, angle, angle).on_one_layer(angle, 100.0).all()
    down = angle[::-1].copy()  # off the drum, through two changes that lie 700 rad apart
    radius = 0.8 + 0.05 * (down >= 600.0) + 0.05 * (down >= 1300.0)
    near = np.min([np.abs(down - changed) for changed in (590.0, 1290.0)], axis=0)
    assert (SuspendedLoad(down, radius, down, down, down).on_one_layer(down, 100.0) == (near > 100.0 * np.pi)).all()


CRANE = SimpleNamespace(
    gear_ratio=100.0, drum=SimpleNamespace(radius=lambda layer: 0.8 if np.isnan(layer) else 0.8 + 0.05 * layer)
)


@pytest.mark.parametrize(
    ("columns", "force"),
    [
        ({"load_torque": 80.0 * ONE}, 80.0 * 100.0 / 0.8),
        ({"rope_force": 7000.0 * ONE}, 7000.0),
        ({"rope_force": 7000.0 * ONE, "hook_load": ONE}, None),  # what was weighed is at rest
        ({"rope_force": 7000.0 * ONE, "hook_load": ONE, "load_torque": 80.0 * ONE}, 1e4),
        ({}, None),
    ],
)
def test_a_ropes_force_is_what_was_measured_of_it(columns, force):
    found = suspended_load._tension(SimpleNamespace(columns=columns), 0.8 * ONE, CRANE)
    assert (found is None) is (force is None)
    assert found is None or found == pytest.approx(force * ONE)


def test_a_radius_is_that_of_the_layer_that_is_nearest():
    grid = SimpleNamespace(time=np.arange(4.0), columns={"wire_layer": np.array([1.0, 1.4, 1.6, 3.0])})
    assert suspended_load._radius(grid, CRANE) == pytest.approx([0.85, 0.85, 0.9, 0.95])
    assert suspended_load._radius(SimpleNamespace(time=np.arange(2.0), columns={}), CRANE) == pytest.approx([0.8, 0.8])


@pytest.mark.parametrize(("known", "mass"), [(500.0, 500.0), (float("nan"), 0.0)])
def test_a_load_that_nobody_weighed_is_the_known_one_and_moves_with_rope_and_crane(known, mass):
    motion = SimpleNamespace(acceleration=20.0 * ONE, angle=np.arange(3.0), window=1)
    grid = SimpleNamespace(time=np.arange(3.0), dt=1.0, columns={})
    load = suspended_load.load_of(grid, motion, CRANE, known)
    assert load.mass.tolist() == [mass] * 3
    assert load.lever == pytest.approx(0.008 * ONE)
    assert load.acceleration == pytest.approx(0.16 * ONE)
    assert not load.heave.any()
    assert not load.tension_measured


@pytest.mark.parametrize(
    ("change", "load", "made"),
    [
        ({}, 500.0, 1),
        ({}, 501.0, 2),
        ({}, float("nan"), 2),
        ({"drum": Drum((0.81,))}, 500.0, 2),
        ({"wire_mass": 9.0}, 500.0, 2),
        ({"inertia": 9.0}, 500.0, 1),
    ],
)
def test_a_load_is_made_anew_where_what_it_hangs_on_has_changed(monkeypatch, change, load, made):
    asked = []
    monkeypatch.setattr(suspended_load, "load_of", lambda *args: asked.append(args) or len(asked))
    own = SimpleNamespace(drum=Drum((0.8,)), wire_mass=8.0, inertia=1.0)
    seen = SimpleNamespace(grid="grid", motion="motion", load={})
    assert suspended_load.load_seen(seen, own, 500.0) == 1
    other = SimpleNamespace(**{**vars(own), **change})
    assert suspended_load.load_seen(seen, other, load) == made
    assert suspended_load.load_seen(seen, other, float(load)) == made, "a number that is none is the same each time"
    assert asked[-1][:3] == ("grid", "motion", other if made == 2 else own)


# -- corrections that are moved, and what a file says
@pytest.mark.parametrize(("value", "way"), [(0.0, 1.0), (2e4, -1.0)])
def test_a_correction_is_moved_by_half_of_its_deviation_inside_its_bounds(monkeypatch, value, way):
    monkeypatch.setattr(expansion, "correction_std", lambda _: 100.0)
    own = Correction("tare_load", value)
    step, moved = expansion._moved(own)
    assert step == pytest.approx(way * 50.0)
    assert moved.value == pytest.approx(value + step)
    assert own.bounds[0] <= moved.value <= own.bounds[1]


@pytest.mark.parametrize(("share", "way"), [(0.0, 2.0), (1.0, -2.0), (0.25, 1.5), (0.75, -1.5)])
def test_a_correction_that_is_less_sure_than_its_bounds_are_wide_is_moved_to_the_farther_one(monkeypatch, share, way):
    """A zero at its bound, of which runs of few displacements say next to nothing: by no step, nothing can be told."""
    monkeypatch.setattr(expansion, "correction_std", lambda _: 1e9)
    lower, upper = Correction("tare_load", 0.0).bounds
    step, moved = expansion._moved(Correction("tare_load", lower + share * (upper - lower)))
    assert step == pytest.approx(way * 0.5 * (upper - lower))
    assert moved.value == (upper if way > 0.0 else lower)


@dataclass(frozen=True)
class Prepared:
    name: str
    gap: np.ndarray
    used: np.ndarray
    unit_torque: float
    start: float = 5.0

    @property
    def time(self):
        return np.arange(len(self.gap))

    used_at = PreparedRun.used_at


def test_a_misfit_is_that_of_the_runs_alike_each_in_its_own_unit():
    """3 bar and 4 bar, however long either is; of what does not move nothing is asked."""
    first = Prepared("a", np.array([30.0, -30.0, 999.0]), np.array([True, True, False]), 10.0)
    second = Prepared("b", np.full(99, 8.0), np.ones(99, bool), 2.0)
    still = Prepared("c", np.full(9, 8.0), np.zeros(9, bool), 2.0)
    given, at_rest = SimpleNamespace(prepared=(first, second, still)), SimpleNamespace(prepared=(still,))
    assert expansion.misfit(given, given) == pytest.approx(np.sqrt(12.5))
    assert expansion.misfit(at_rest, at_rest) == 0.0


def test_a_model_that_takes_a_jerk_for_a_spike_does_not_fit_better_for_it():
    """The 100 kW winch: three samples of 14 000 that one step of a fit left out were worth more than the step."""
    jerk = np.where(np.arange(50) == 20, 60.0, 1.0)
    whole = SimpleNamespace(prepared=(Prepared("a", jerk, np.ones(50, bool), 1.0),))
    without = SimpleNamespace(prepared=(Prepared("a", 1.01 * jerk, np.arange(50) != 20, 1.0),))
    assert expansion.misfit(without, whole) == pytest.approx(1.01)
    assert expansion.misfit(whole, without) == pytest.approx(1.0)


def test_which_groups_close_the_balance_somewhere_and_which_never_do():
    def run(*groups):
        return SimpleNamespace(groups=[SimpleNamespace(name=name, balances=balances) for name, balances in groups])

    given = SimpleNamespace(
        crane="crane", prepared=(run(("main", True)), run(("b", True), ("p", False)), run(("a", True), ("p", False)))
    )
    sides = repair._sides(given)
    assert (sides.crane, sides.balancing, sides.passive) == ("crane", ("a", "b", "main"), ("p",))
    assert sides.alone == ("main",)


@pytest.mark.parametrize(("std", "told"), [(0.5, True), (9.8, True), (9.95, False)])
def test_what_was_freed_and_of_which_the_fit_tells_nothing_keeps_the_drafts_deviation(crane2_model, std, told):
    """Freed to ten times a deviation of 1; the seed's own parameters are never freed."""
    names = crane2_model.parameter_names
    own = np.diag([std**2, *[25.0] * (len(names) - 1)])
    model = crane2_model.with_covariance(own)
    drafted = SimpleNamespace(std=np.array([1.0, *[0.5] * (len(names) - 1)]))
    found = repair._as_found(model, drafted, SimpleNamespace(parameter_names=names[1:]))
    assert found.std[0] == pytest.approx(std if told else std / LIMITS.loosened)
    np.testing.assert_allclose(found.std[1:], 5.0)


@pytest.mark.parametrize(
    ("value", "inside", "said"), [(30.0, 30.0, ""), (3e4, 2e4, ", cut at its bound from 30000 kg")]
)
def test_a_correction_that_is_changed_says_where_it_is_cut_and_no_longer_where_it_was(value, inside, said):
    before = Correction("tare_load", 5.0, 9.0, source="an owner, cut at its bound from 7 kg")
    after = repair._changed(before, value, 2.0)
    assert (after.value, after.std, after.source) == (inside, 2.0, "an owner" + said)
