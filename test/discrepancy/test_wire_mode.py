"""The load on its elastic wire."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from winch_friction.discrepancy.preparation import wire_mode
from winch_friction.discrepancy.preparation.grid import smooth
from winch_friction.discrepancy.preparation.suspended_load import Hung, Mode, SuspendedLoad
from winch_friction.discrepancy.preparation.wire_mode import DAMPING_RATIOS, swinging_load, wire_stiffnesses
from winch_friction.discrepancy.preparation.wires import agreed_damping, denies, pooled_damping, shared_damping

DT, MASS, LEVER = 0.02, 55e3, 1.136 / 250
TIME = np.arange(0.0, 120.0, DT)


def motion(time):
    """Acceleration of the wire's top: a wave with a kick at every reversal."""
    return 0.6 * np.sin(0.7 * time) + 0.8 * np.exp(-(((time % 4.5) - 2.0) ** 2) / 0.01)


def hung(swing, rigid, length=None):
    """The acceleration behind the mode that was found."""
    mode = swing.mode
    return Hung(rigid, DT, length if mode.follows else None).acceleration(mode.frequency, mode.damping)


def test_the_mode_is_the_oscillators():
    frequency, ratio = 7.0, 0.08

    def oscillator(t, y):  # relative to the top of the wire
        return [y[1], -motion(t) - 2 * ratio * frequency * y[1] - frequency**2 * y[0]]

    exact = solve_ivp(oscillator, (0, TIME[-1]), [0.0, 0.0], t_eval=TIME, method="DOP853", max_step=0.05, rtol=1e-6)
    expected = -2 * ratio * frequency * exact.y[1] - frequency**2 * exact.y[0]
    found = Hung(motion(TIME), DT).acceleration(frequency, ratio)
    assert np.abs(found - expected)[500:].std() < 0.04 * expected.std()


@pytest.mark.parametrize("length", [50.0, None])
def test_the_swing_is_found_and_taken_out(length):
    stiffness = 3e8 / 50.0
    load = Hung(motion(TIME), DT).acceleration(np.sqrt(stiffness / MASS), 0.06)
    noise = 5.0 * np.random.default_rng(1).standard_normal(len(TIME))
    step = np.sign(np.cos(0.7 * TIME))
    gap = MASS * LEVER * (load - motion(TIME)) + 30.0 * step + noise
    tried = wire_stiffnesses(3e8, None if length is None else np.full(len(TIME), length))
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    swing = swinging_load(gap, everywhere, motion(TIME), DT, MASS, lever, tried, step[:, None])
    assert swing.mode.frequency == pytest.approx(np.sqrt(stiffness / MASS), rel=0.02)
    assert 0.03 <= swing.mode.damping <= 0.1
    left = gap + MASS * LEVER * (motion(TIME) - hung(swing, motion(TIME))) - 30.0 * step
    assert left[500:].std() < 0.25 * (gap - 30.0 * step)[500:].std()


@pytest.mark.parametrize(("damping", "noise"), [(0.05, 5.0), (0.0, 100.0)], ids=["swings", "rigid"])
def test_a_run_says_how_much_may_swing_and_what_of_it_each_damping_leaves(damping, noise):
    """By these runs are weighed against each other: what a single one takes for its mode is not in it."""
    stated, rigid = 7.0, motion(TIME)
    load = Hung(rigid, DT).acceleration(stated, damping) if damping else rigid
    own = noise * np.random.default_rng(4).standard_normal(len(TIME))
    gap = MASS * LEVER * (load - rigid) + own
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    swing = swinging_load(gap, everywhere, rigid, DT, MASS, lever, (stated**2 * MASS,))
    assert (swing.mode.damping > 0.0) is (damping > 0.0)
    assert swing.variance == pytest.approx(gap.var(), rel=1e-6)
    by_ratio = [(gap + MASS * LEVER * (rigid - Hung(rigid, DT).acceleration(stated, r))).var() for r in DAMPING_RATIOS]
    assert np.array(swing.left) * swing.variance == pytest.approx(np.array(by_ratio), rel=0.05)
    if damping:
        assert DAMPING_RATIOS[int(np.argmin(swing.left))] == damping
        assert min(swing.left) * swing.variance == pytest.approx(own.var(), rel=0.05)


@pytest.mark.parametrize("off", [-0.035, -0.012, 0.0, 0.02])
@pytest.mark.parametrize("inertia", [0.0, 0.3], ids=["as stated", "inertia off"])
def test_the_swing_follows_a_wire_that_is_paid_out_in_the_run(off, inertia):
    """A tenth of the length is a twentieth of the frequency; an inertia that is wrong must not pass for it."""
    stated, rigid = 2.8, motion(TIME)
    load = Hung(rigid, DT).acceleration(stated * (1.0 + off), 0.06)
    noise = 5.0 * np.random.default_rng(2).standard_normal(len(TIME))
    gap = MASS * LEVER * (load - (1.0 + inertia) * rigid) + noise
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    step = np.sign(np.cos(0.7 * TIME))[:, None]
    swing = swinging_load(gap, everywhere, rigid, DT, MASS, lever, (stated**2 * MASS,), step, rigid[:, None])
    assert swing.mode.frequency == pytest.approx(stated * (1.0 + off), rel=0.002)
    left = gap + MASS * LEVER * ((1.0 + inertia) * rigid - hung(swing, rigid))
    assert left[500:].std() < 1.6 * noise.std()


@pytest.mark.parametrize("follows", [True, False])
def test_a_stiffness_that_follows_the_wire_is_told_from_one_that_does_not(follows):
    """Thirty metres paid out from two hundred: the load on a spring of EA over what is out, integrated."""
    length = 200.0 + 30.0 * np.sin(0.05 * TIME)
    frequency, ratio = 2.8, 0.06

    middle = float(np.median(length))

    def spring(t):
        return frequency**2 * middle / (200.0 + 30.0 * np.sin(0.05 * t) if follows else middle)

    def oscillator(t, y):
        return [y[1], -motion(t) - 2 * ratio * frequency * y[1] - spring(t) * y[0]]

    exact = solve_ivp(oscillator, (0, TIME[-1]), [0.0, 0.0], t_eval=TIME, method="DOP853", max_step=0.05, rtol=1e-6)
    load = -2 * ratio * frequency * exact.y[1] - spring(TIME) * exact.y[0]
    gap = MASS * LEVER * (load - motion(TIME)) + 5.0 * np.random.default_rng(3).standard_normal(len(TIME))
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    stated = (frequency**2 * MASS,)
    swing = swinging_load(gap, everywhere, motion(TIME), DT, MASS, lever, stated, length=length)
    assert swing.mode.follows == follows
    left = gap + MASS * LEVER * (motion(TIME) - hung(swing, motion(TIME), length))
    blind = swinging_load(gap, everywhere, motion(TIME), DT, MASS, lever, stated)
    without = gap + MASS * LEVER * (motion(TIME) - hung(blind, motion(TIME)))
    assert left[500:].std() < 0.08 * gap[500:].std()
    assert not follows or left[500:].std() < 0.5 * without[500:].std()


def test_a_lift_to_twice_the_length_swings_by_its_own_length_at_every_moment():
    """From 22 m to 49: by the length in the middle it denied the swing that it has, and its gap stayed in a null."""
    length, frequency, ratio = 22.0 + 27.0 * TIME / TIME[-1], 9.0, 0.05
    middle = float(np.median(length))

    def oscillator(t, y):
        spring = frequency**2 * middle / float(np.interp(t, TIME, length))
        return [y[1], -motion(t) - 2 * ratio * np.sqrt(spring) * y[1] - spring * y[0]]

    exact = solve_ivp(oscillator, (0, TIME[-1]), [0.0, 0.0], t_eval=TIME, method="DOP853", max_step=0.05, rtol=1e-6)
    spring = frequency**2 * middle / length
    load = -2 * ratio * np.sqrt(spring) * exact.y[1] - spring * exact.y[0]
    noise = 60.0 * np.random.default_rng(3).standard_normal(len(TIME))
    gap, everywhere = MASS * LEVER * (load - motion(TIME)) + noise, np.ones(len(TIME), bool)
    stated, lever = (frequency**2 * MASS,), np.full(len(TIME), LEVER)
    step = np.sign(np.cos(0.7 * TIME))[:, None]
    swing = swinging_load(gap, everywhere, motion(TIME), DT, MASS, lever, stated, step, length=length)
    assert swing.mode.follows
    assert swing.mode.damping == pytest.approx(ratio, rel=0.5)
    assert min(swing.left) < 0.6


@pytest.mark.parametrize("share", [0.55, 0.8, 1.0, 1.25])
def test_a_wire_that_is_softer_or_stiffer_than_stated_is_found(share):
    """Twenty metres between drum and tip beside fifty paid out, a modulus from a catalogue."""
    stated, frequency = 3e8 / 50.0, np.sqrt(share * 3e8 / 50.0 / MASS)
    load = Hung(motion(TIME), DT).acceleration(frequency, 0.06)
    gap = MASS * LEVER * (load - motion(TIME)) + 5.0 * np.random.default_rng(1).standard_normal(len(TIME))
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    swing = swinging_load(gap, everywhere, motion(TIME), DT, MASS, lever, (stated,))
    assert swing.mode.frequency == pytest.approx(frequency, rel=0.02)
    assert swing.mode.damping == pytest.approx(0.06, rel=0.2)


def test_noise_alone_does_not_move_the_stated_stiffness():
    stated = 3e8 / 50.0
    load = Hung(motion(TIME), DT).acceleration(np.sqrt(stated / MASS), 0.06)
    swinging = MASS * LEVER * (load - motion(TIME))
    gap = swinging + 0.7 * swinging.std() * np.random.default_rng(1).standard_normal(len(TIME))
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    swing = swinging_load(gap, everywhere, motion(TIME), DT, MASS, lever, (stated,))
    assert swing.mode.frequency == np.sqrt(stated / MASS)


def test_a_rigid_wire_stays_rigid():
    gap = 5.0 * np.random.default_rng(2).standard_normal(len(TIME))
    rigid = motion(TIME)
    swing = swinging_load(gap, np.ones(len(TIME), bool), rigid, DT, MASS, np.full(len(TIME), LEVER), (6e6,))
    assert swing.mode.damping == 0.0


def test_a_delay_is_not_taken_for_a_wire():
    rigid = motion(TIME)
    torque = MASS * LEVER * rigid
    late = np.interp(TIME - 0.05, TIME, torque) - torque + 5.0 * np.random.default_rng(3).standard_normal(len(TIME))
    shift = np.gradient(torque)[:, None]
    swing = swinging_load(late, np.ones(len(TIME), bool), rigid, DT, MASS, np.full(len(TIME), LEVER), (3e6,), shift)
    assert swing.mode.damping == 0.0


@pytest.mark.parametrize(("kick", "frequency"), [(10.0, 6.0), (75.0, 3.0)])
def test_the_damper_stays_what_it_is_on_a_wire_four_times_as_long(kick, frequency):
    """c / (2 m) is the rate at which a swing dies out, whatever its stiffness: half of it in ln 2 / (0.02 * 6) s."""
    length = np.where(TIME < 70.0, 50.0, 200.0)
    swing = Hung(np.exp(-(((TIME - kick) / 0.1) ** 2)), DT, length).acceleration(6.0, 0.02)
    after, later = swing[int((kick + 1.0) / DT) :], int(np.log(2.0) / (0.02 * 6.0) / DT)
    first, second = (np.abs(after[begin : begin + 500]).max() for begin in (0, later))
    assert second == pytest.approx(0.5 * first, rel=0.1)
    assert (np.diff(np.sign(after[:1500])) != 0).sum() == pytest.approx(30.0 * frequency / np.pi, abs=1.5)


def test_where_only_short_stretches_count_no_means_are_taken(monkeypatch):
    rigid, frequency = smooth(motion(TIME), 25), 1.5
    gap = MASS * LEVER * (Hung(rigid, DT).acceleration(frequency, 0.06) - rigid)
    given = gap, np.arange(len(TIME)) % 5 < 4, rigid, DT, MASS, np.full(len(TIME), LEVER), (frequency**2 * MASS,)
    found = swinging_load(*given)
    monkeypatch.setattr(wire_mode, "FINE", 0.0)
    assert found == swinging_load(*given)
    assert found.mode.damping > 0.0


@pytest.mark.parametrize("follows", [False, True])
def test_means_tell_a_slow_mode_as_all_samples_do(monkeypatch, follows):
    rigid, frequency = smooth(motion(TIME), 25), 2.5
    length = np.linspace(40.0, 60.0, len(TIME)) if follows else None
    load = Hung(rigid, DT, length).acceleration(frequency, 0.06)
    lever, moving = np.full(len(TIME), LEVER), np.abs(np.sin(0.7 * TIME)) > 0.1
    gap = MASS * LEVER * (load - rigid) + 30.0 * np.sin(0.7 * TIME)
    friction, inertia, stated = np.sin(0.7 * TIME)[:, None], rigid[:, None], (1.04 * frequency) ** 2 * MASS
    given = (gap, moving, rigid, DT, MASS, lever, (stated,), friction, inertia, length)
    by_means = swinging_load(*given)
    monkeypatch.setattr(wire_mode, "FINE", 0.0)
    by_all = swinging_load(*given)
    assert by_means.mode.frequency == pytest.approx(frequency, rel=0.003)
    assert by_means.mode[:2] == pytest.approx(by_all.mode[:2], rel=0.02)
    assert by_means.mode.follows == by_all.mode.follows == (True if follows else None)
    assert by_means.variance == pytest.approx(by_all.variance, rel=0.02)
    assert np.array(by_means.left) == pytest.approx(np.array(by_all.left), rel=0.1, abs=0.01)


def test_stretches_of_motion_have_levels_of_their_own():
    rigid = motion(TIME)
    moving = np.abs(np.sin(0.7 * TIME)) > 0.1
    load = Hung(rigid, DT).acceleration(7.0, 0.25)
    friction = np.where(moving, 400.0 * np.sign(np.sin(0.7 * TIME)), 5e3)
    gap = MASS * LEVER * (load - rigid) + friction
    swing = swinging_load(gap, moving, rigid, DT, MASS, np.full(len(TIME), LEVER), (49.0 * MASS,))
    assert swing.mode.damping == pytest.approx(0.25, rel=0.05)


@pytest.mark.parametrize(
    ("ratios", "expected"), [((0.06, 0.06, 0.061), 0.06), ((0.24, 0.71, 0.36), 0.33), ((0.02, 0.6, 0.02), None)]
)
def test_runs_agree_on_a_ratio_or_on_a_damper_or_not_at_all(ratios, expected):
    masses, stiffness = (61e3, 20e3, 55e3), (3.1e6, 1.0e6, 1.6e6)
    modes = [(np.sqrt(k / m), z, m) for z, m, k in zip(ratios, masses, stiffness, strict=True)]
    found = agreed_damping(modes)
    if expected is None:
        assert found is None
    else:
        assert found(np.sqrt(1.6e6 / 55e3), 55e3) == pytest.approx(expected, rel=0.1)


def test_runs_that_agree_on_an_overdamped_mode_have_a_noisy_motion_sensor_and_a_rigid_wire():
    """Where the load is held, noise is most of the acceleration, and the more a mode swings the more of it stays."""
    assert agreed_damping([(3.1, 0.65, 160e3), (2.7, 0.65, 150e3), (2.7, 0.65, 150e3), (4.2, 0.46, 80e3)]) is None


@pytest.mark.parametrize(("ratios", "expected"), [
    ([0.059, 0.063, 0.0, 0.061, 0.06, 0.257, 0.33], 0.06),  # four of seven, and what heave compensation blurs
    ([0.059, 0.063, 0.0, 0.0, 0.0, 0.06, 0.061, 0.0], None),  # not most of them
    ([0.06, 0.061, 0.059], None),  # three may be chance
    ([0.06, 0.061, 0.059, *[0.0] * 3], None),  # of which nothing is known
    ([0.03, 0.06, 0.12, 0.24, 0.45], None),  # each another one
    ([0.45, 0.46, 0.44, 0.45, 0.46], None),  # so damped that anything slow looks like it
])  # fmt: skip
def test_most_runs_tell_the_damping_of_their_wire(ratios, expected):
    modes = [(5.0 + 2.0 * k, ratio, 2e4) for k, ratio in enumerate(ratios)]
    found = shared_damping(modes)
    assert (found is None) if expected is None else found(9.0, 3e4) == pytest.approx(expected, rel=0.05)


DENYING, UNTOLD = (3.0,) * len(DAMPING_RATIOS), (1.01,) * len(DAMPING_RATIOS)


@pytest.mark.parametrize(("left", "expected"), [
    ([UNTOLD] * 6, 0.08),  # a load too light to show a swing has no say
    ([UNTOLD] * 4 + [DENYING] * 2, 0.08),
    ([DENYING] * 6, None),  # half of those that can tell
    ([()] * 6, None),  # nothing is known of them
])  # fmt: skip
def test_a_run_that_cannot_tell_whether_its_load_swings_has_no_vote(left, expected):
    modes = [(3.0, 0.08, 1e5)] * 6 + [(8.0, 0.0, 2e4)] * 6
    found = shared_damping(modes, [()] * 6 + left)
    assert (found is None) if expected is None else found(9.0, 3e4) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize(("alike", "expected"), [(6, 0.05), (3, None)])
def test_runs_that_agree_closely_tell_beside_others_that_seem_damped_otherwise(alike, expected):
    """Heave compensation whose motion sensor is noisy, and an inertia that is wrong, beside plain hoists."""
    apart = [(5.0, ratio, 1e5) for ratio in (0.11, 0.2, 0.29, 0.43, 0.016, 0.6)]
    found = shared_damping([(3.0 + k, 0.05 * (1.0 + 0.02 * k), 2e5) for k in range(alike)] + apart)
    assert (found is None) if expected is None else found(9.0, 3e4) == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(("by_the_largest", "expected"), [(0.45, 0.27), (0.09, None)], ids=["rope", "filter"])
def test_a_heavily_damped_rope_is_told_from_a_filter_by_what_more_damping_leaves(by_the_largest, expected):
    """A soft rope of ratio 0.27 was taken for rigid, and what swung on it for a delay."""
    left = (40.0, 17.0, 8.0, 5.0, 3.0, 1.4, 0.6, 0.16, 0.08, 0.5 * (0.08 + by_the_largest), by_the_largest)
    modes = [(1.5 + 0.3 * k, 0.27 + 0.002 * k, 5e4) for k in range(4)] + [(2.0, 0.0, 3e4)] * 4
    found = shared_damping(modes, [left] * 4 + [UNTOLD] * 4)
    assert (found is None) if expected is None else found(2.0, 4e4) == pytest.approx(expected, rel=0.03)
    filtered = (*left[:9], 0.085, 0.09)
    assert shared_damping(modes, [left] * 3 + [filtered] + [UNTOLD] * 4) is None  # each of them has to tell


SWINGS = (0.9, 0.5, 0.2, 0.12, 0.2, *[0.5] * 6)  # of 0.05
LIKE_A_FILTER = (1.5, 1.0, 0.8, 0.6, 0.5, *[0.4] * 6)
ALIKE_BY_ANY = (0.32, *[0.3] * 10)  # a wrong inertia, which swings by no mode


@pytest.mark.parametrize(("light", "heavy", "expected"), [
    (0.1, SWINGS, 0.05),  # what hardly swings says little, and a noisy motion sensor rings on a computed wire as well
    (9.0, SWINGS, None),  # the rigid ones swing most
    (0.1, [0.4 + share for share in SWINGS], None),  # it leaves more than a single run may
    (0.1, LIKE_A_FILTER, None),
    (0.1, ALIKE_BY_ANY, None),
])  # fmt: skip
def test_all_runs_together_tell_the_damping_where_votes_are_at_odds(light, heavy, expected):
    """Heave compensation alone: light loads are computed to ring by the noise of the sea, some heavy ones seem damped
    like a filter."""
    modes = [(3.0, 0.05, 1e5)] * 4 + [(5.0, 0.4, 6e4)] * 2 + [(9.0, 0.0, 1e4)] * 3
    left = [heavy] * 4 + [LIKE_A_FILTER] * 2 + [(3.0, *[2.0] * 10)] * 3
    assert shared_damping(modes, left) is None
    found = pooled_damping(modes, left, [1.0] * 4 + [0.2] * 2 + [light] * 3)
    assert (found is None) if expected is None else found(3.0, 1e5) == pytest.approx(expected, rel=0.11)


def test_runs_whose_ratios_differ_agree_on_the_damper_that_they_share():
    """Light loads on a short wire, heavy ones on a long one: other ratios by one damper."""
    damper, points = 4e4, [(3.0, 4e4), (4.0, 8e4), (2.5, 3e4), (6.0, 9e4), (5.0, 6e4)]  # N s/m; rad/s, kg
    found = shared_damping([(own, damper / (2.0 * own * load), load) for own, load in points])
    assert found(4.0, 5e4) == pytest.approx(damper / (2.0 * 4.0 * 5e4), rel=0.05)


def test_three_runs_that_agree_will_not_do_beside_one_that_rings_otherwise():
    modes = [(5.0, ratio, 2e4) for ratio in (0.06, 0.061, 0.059, 0.2)] + [(8.0, 0.0, 2e4)] * 6
    assert shared_damping(modes, [()] * 4 + [UNTOLD] * 6) is None
    assert shared_damping(modes[:3] + modes[4:], [()] * 3 + [UNTOLD] * 6) is not None


def test_one_damper_for_all_runs_is_told_from_one_ratio():
    """By one damper the ratio is the larger the lighter the load: the grid of a run's shares tells at which."""
    modes = [(np.sqrt(1e6 / mass), 0.0, mass) for mass in (2e4, 4e4, 8e4, 1.6e5)]
    damper = 0.04 * 2.0 * np.sqrt(1e6 * 4e4)  # N s/m
    own = [damper / (2.0 * frequency * mass) for frequency, _, mass in modes]
    left = [tuple(np.minimum(0.05 + np.log(np.array(DAMPING_RATIOS) / ratio) ** 2, 1.0)) for ratio in own]
    found = pooled_damping(modes, left, [1.0] * 4)
    assert [found(frequency, mass) for frequency, _, mass in modes] == pytest.approx(own, rel=0.15)
    small = pooled_damping(modes, left, [1e-6] * 4)  # of runs that all swing little, nothing else is told
    assert [small(frequency, mass) for frequency, _, mass in modes] == pytest.approx(own, rel=0.15)
    assert pooled_damping(modes[:3], left[:3], [1.0] * 3) is None  # three may be chance
    assert pooled_damping(modes, [()] * 4, [1.0] * 4) is None


def test_a_light_load_leaves_as_much_with_a_swing_as_without_and_a_heavy_one_on_a_rigid_wire_far_more():
    rigid = 0.5 * np.sin(0.6 * TIME) + 0.3 * np.sin(1.7 * TIME + 1.0)
    gap = 100.0 * np.random.default_rng(2).standard_normal(len(TIME))
    for mass, denied in ((0.02 * MASS, False), (20.0 * MASS, True)):
        swing = swinging_load(gap, np.ones(len(TIME), bool), rigid, DT, mass, np.full(len(TIME), LEVER), (9.0 * mass,))
        assert swing.mode.damping == 0.0
        assert denies(swing.left, 0.08) is denied


@pytest.mark.parametrize(
    ("left", "expected"), [([UNTOLD] * 3, 0.06), ([UNTOLD] * 2, None), ([UNTOLD] * 5 + [DENYING], None)]
)
def test_three_runs_that_agree_will_do_where_as_many_do_not_object(left, expected):
    modes = [(5.0, ratio, 2e4) for ratio in (0.06, 0.061, 0.059)] + [(8.0, 0.0, 2e4)] * len(left)
    found = shared_damping(modes, [()] * 3 + left)
    assert (found is None) if expected is None else found(5.0, 2e4) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize(("heard", "noise"), [(True, False), (False, True)])
def test_a_run_tells_whether_what_is_fast_in_its_motion_is_a_sensors_noise(heard, noise):
    """A held load: what its measured motion has at the wire's mode is felt by the motors, or by the sensor alone."""
    rng = np.random.default_rng(3)
    slow, fast = 0.3 * np.sin(0.7 * TIME), 0.03 * rng.standard_normal(len(TIME))
    gap = 20.0 * rng.standard_normal(len(TIME)) - MASS * LEVER * (0.0 if heard else 1.0) * fast
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    swing = swinging_load(gap, everywhere, slow + fast, DT, MASS, lever, (6.0**2 * MASS,))
    assert swing.mode.damping == 0.0
    assert swing.noise is noise


def test_a_load_whose_swing_is_not_heard_moves_as_on_a_rigid_wire():
    ones = np.ones(len(TIME))
    load = SuspendedLoad(MASS * ones, ones, LEVER * ones, motion(TIME), motion(TIME))
    assert load.on_wire(DT, Mode(6.0, 0.06, None, unheard=True), None) is load
    assert np.ptp(load.on_wire(DT, Mode(6.0, 0.06), None).acceleration - load.acceleration) > 0.1


def left_by_ringing(own, least):
    """What a run leaves by a mode of each damping ratio, `own` its best one."""
    return tuple(np.minimum(least + np.log(np.array(DAMPING_RATIOS) / own) ** 2, 1.5))


FOLLOWED_BY_ANY = (0.11, 0.09, 0.08, *[0.075] * 4, *[0.072] * 4)  # a sea on kilometres of wire


def test_what_all_runs_leave_tells_a_ratio_from_dampers_that_are_alike_by_chance():
    """Joystick runs ring down alike; of as many seas that any damping follows five seem to have one damper."""
    calm = [(2.0 + k, 0.05, 1e4) for k in range(5)]
    seas = [(1.0 + 0.2 * k, 2e4 / (2.0 * (1.0 + 0.2 * k) * 3e4), 3e4) for k in range(5)]
    left = [left_by_ringing(0.05, 0.005)] * 5 + [FOLLOWED_BY_ANY] * 5
    found = shared_damping(calm + seas, left)
    assert found(3.0, 1e4) == pytest.approx(0.05)
    assert found(1.0, 3e4) == pytest.approx(0.05)


def test_runs_that_ring_down_to_nothing_say_more_than_seas_that_any_damping_follows():
    """However much more these swing."""
    modes = [(2.0 + k, 0.0, 1e4) for k in range(3)] + [(1.0 + 0.2 * k, 0.0, 3e4) for k in range(5)]
    left = [left_by_ringing(0.05, 0.005)] * 3 + [(0.6, 0.3, 0.16, 0.12, 0.1, 0.09, 0.08, 0.08, 0.08, 0.08, 0.09)] * 5
    found = pooled_damping(modes, left, [1.0] * 3 + [30.0] * 5)
    assert found(3.0, 1e4) == pytest.approx(0.05, rel=0.12)


def test_one_load_that_swings_plainly_outweighs_many_runs_that_hold_noise_alone():
    """A null of a 12 t winch kept 1.6 bar: one hoist of twelve runs swung, by ten times what the others held."""
    rung, noise = (5.9, 1.7, 0.45, 0.17, 0.11, 0.18, 0.31, 0.46, 0.61, 0.74, 0.83), (*[1.0] * 9, 0.9, 0.85)
    modes, left = [(7.2, 0.069, 8e3)] + [(8.0, 0.0, 5e3)] * 8, [rung] + [noise] * 8
    found = pooled_damping(modes, left, [7.0] + [0.25] * 8)
    assert found is not None
    assert found(7.2, 8e3) == pytest.approx(0.07, rel=0.15)
    assert pooled_damping(modes, left, [7.0] * 9) is None  # they swing as much, and by no mode
    filtered = (5.9, 1.7, 0.9, 0.6, 0.5, 0.45, 0.42, 0.4, 0.4, 0.4, 0.4)
    assert pooled_damping(modes, [filtered] + [noise] * 8, [7.0] + [0.25] * 8) is None


@pytest.mark.parametrize("ratio", [0.03, 0.085, 0.28])
def test_the_damping_is_as_sure_as_the_swing(ratio):
    """What of a plain swing is left is noise: a parabola over tabled dampings a third apart is off by up to a tenth,
    which left 0.5 bar of a soft rope's 3 where the noise was 0.2."""
    stated, rigid = 7.0, motion(TIME)
    load = Hung(rigid, DT).acceleration(stated, ratio)
    gap = MASS * LEVER * (load - rigid) + 0.5 * np.random.default_rng(3).standard_normal(len(TIME))
    everywhere, lever = np.ones(len(TIME), bool), np.full(len(TIME), LEVER)
    found = swinging_load(gap, everywhere, rigid, DT, MASS, lever, (stated**2 * MASS,)).mode
    assert found.damping == pytest.approx(ratio, rel=0.01)
