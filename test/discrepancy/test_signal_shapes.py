"""Which shapes errors of the signals are looked for in, what columns they have, and what correction they become."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates import feedback, lateness
from winch_friction.discrepancy.candidates import signals as module
from winch_friction.discrepancy.candidates.candidate import (
    ALL,
    ALONE,
    BALANCING,
    BESIDE,
    OTHER,
    ParameterEstimate,
    Shape,
    Sides,
    driving_alone,
    group_columns,
    group_shapes,
    groups_of,
    own_group_shapes,
)
from winch_friction.discrepancy.candidates.creep import creeping_candidates, creeping_columns, gathering_columns
from winch_friction.discrepancy.candidates.lateness import DELAYS, PRESSURES, SMALL_DELAY, SPEED, delay_columns
from winch_friction.discrepancy.candidates.signals import (
    bent_columns,
    bowed_warm_columns,
    scale_columns,
    signal_candidates,
)
from winch_friction.discrepancy.catalogue import of_one_group
from winch_friction.physics.friction.correction import THERMAL_REFERENCE

TIME = 0.02 * np.arange(101)
SIDES = Sides(None, ("active",), ("passive",))


def group(count, balances, a=150e5, b=25e5, name="main"):
    one = np.ones(len(TIME))
    return SimpleNamespace(
        name=name,
        count=count,
        displacement=2e-5 * one,
        pressure=(a - b) * one,
        pressure_sum=(a + b) * one,
        balances=balances,
    )


BOTH = group(3, True, name="active"), group(8, False, name="passive")


def run(groups=BOTH, start=0.0, dt=0.02, **channels):
    return SimpleNamespace(
        time=TIME, groups=groups, start=start, dt=dt, channels={k: v * np.ones(len(TIME)) for k, v in channels.items()},
        predicted=TIME**2, from_speed=3.0 * TIME,
    )  # fmt: skip


@pytest.mark.parametrize(("which", "motors"), [(ALL, 11), (BALANCING, 3), (OTHER, 8)])
def test_a_zero_error_is_one_of_the_motors_whose_transducers_it_speaks_of(which, motors):
    column = group_columns(module.offset_law, run(), {"groups": which})
    assert column == pytest.approx(motors * 2e-5)


def test_a_single_group_has_no_other_side():
    assert [each.label for each in group_shapes([run((group(3, True),))])] == ["all groups"]
    assert [each.carried for each in group_shapes([run()])] == [False, False, True]


@pytest.mark.parametrize(("which", "hoisting", "compensating"), [(ALONE, 11, 0), (BESIDE, 0, 3), (BALANCING, 11, 3)])
def test_the_driving_group_of_hoisting_and_that_of_heave_compensation_may_be_off_by_themselves(
    which, hoisting, compensating
):
    hoist = run((group(11, True),))
    for one, motors in ((hoist, hoisting), (run(), compensating)):
        assert group_columns(module.offset_law, one, {"groups": which}) == pytest.approx(motors * 2e-5)
    assert [each.label for each in own_group_shapes([hoist, run()])] == [
        "the main group alone",
        "the active group alone",
    ]
    sides = Sides(None, ("active", "main"), ("passive",), driving_alone([hoist, run()]))
    assert groups_of(Shape("", {"groups": which}), sides) == {
        ALONE: ("main",), BESIDE: ("active",), BALANCING: ("active", "main")
    }[which]  # fmt: skip


def test_a_group_that_drives_in_either_mode_has_one_pair_of_transducers():
    both = [run((group(3, True, name="active"),)), run()]
    assert own_group_shapes(both) == own_group_shapes(both[:1]) == []
    assert of_one_group(both) == []
    hoist = run((group(11, True),))
    assert [each.name for each in of_one_group([hoist, *both[1:]])] == [
        "pressure_offset", "pressure_scale", "swivel_offset",
    ]  # fmt: skip
    assert len(of_one_group([hoist, *both[1:]])[1].shapes([])) == 4


def test_a_gain_of_port_a_takes_the_pressure_of_port_a_alone():
    one = run((group(1, True),))
    assert scale_columns(one, {"groups": ALL, "port_a": 1.0}) == pytest.approx(2e-5 * 150e5)
    assert scale_columns(one, {"groups": ALL, "port_a": 0.0}) == pytest.approx(2e-5 * 125e5)
    straight, bent = bent_columns(one, {"groups": ALL, "port_a": 1.0}).T
    assert bent / straight == pytest.approx(150e5)
    straight, bent = bent_columns(one, {"groups": ALL, "port_a": 0.0}).T  # a^2 - b^2
    assert bent == pytest.approx(2e-5 * (150e5**2 - 25e5**2))


def test_a_zero_that_shifts_with_the_oil_is_none_at_the_temperature_that_it_is_stated_at():
    cold, usual = (run(oil_temperature=THERMAL_REFERENCE + k) for k in (-10.0, 0.0))
    values = {"groups": ALL}
    constant, warm, bow = bowed_warm_columns(module.offset_law, cold, values)[0]
    assert (warm / constant, bow / constant) == pytest.approx((-10.0, 100.0))
    assert bowed_warm_columns(module.offset_law, usual, values)[0, 1:] == pytest.approx(0.0)


@pytest.mark.parametrize(("start", "grown"), [(-50.0, 0.0), (100.0, 0.5), (900.0, 1.0)])
def test_a_zero_that_creeps_begins_with_the_first_run_and_settles(start, grown):
    values = {"groups": ALL, "from": 0.0, "to": 202.0}
    constant, crept = creeping_columns(run(start=start), values)[50]
    assert crept / constant == pytest.approx(grown, abs=1e-9)


@pytest.mark.parametrize(("start", "share"), [(-50.0, 0.0), (100.0, 0.5), (900.0, 1.0)])
def test_a_load_that_gathers_has_its_weight_its_inertia_and_its_friction(start, share):
    one = np.ones(len(TIME))
    own = SimpleNamespace(**vars(run(start=start)), load=5e4 * one, radius=1.1 * one, gear_ratio=250.0,
                          load_acceleration=0.2 * one, load_friction=500.0 * one)  # fmt: skip
    constant, gathered = gathering_columns(own, {"from": 0.0, "to": 202.0})[50]
    assert constant == pytest.approx(1.1 / 250.0 * (9.81 + 0.2) + 500.0 / 5e4)
    assert gathered == pytest.approx(share * constant)


def blind(law_name, *runs):
    (candidate,) = [each for each in (*signal_candidates(), *creeping_candidates()) if each.law_name == law_name]
    return candidate.blind(runs) is not None


@pytest.mark.parametrize(("hours", "creeps", "gathers"), [(0.5, False, False), (12.0, True, False), (30.0, True, True)])
def test_a_creep_is_looked_for_over_days_and_runs_enough(hours, creeps, gathers):
    runs = [run(start=3600.0 * hours * k / 5.0) for k in range(6)]
    for law, told in (("creeping zero", creeps), ("gathers over the days", gathers)):
        assert blind(law, *runs) is not told
        assert blind(law, *runs[:5])


@pytest.mark.parametrize(("degrees", "untold"), [(10.0, True), (20.0, False)])
def test_a_bow_is_looked_for_over_warmth_enough(degrees, untold):
    runs = [run(oil_temperature=30.0 + k * degrees) for k in range(2)]
    assert blind("thermal zero that bends", *runs) is untold


def test_a_zero_that_bends_with_the_oil_becomes_a_zero_a_slope_and_a_bow():
    (law,) = [each for each in signal_candidates() if each.law_name == "thermal zero that bends"]
    found = {
        name: ParameterEstimate(size, 0.1 * size, "Pa") for name, size in (("p_0", 3e4), ("p_T", 400.0), ("p_TT", 5.0))
    }
    told = law.corrects(found, Shape("", {"groups": 0.0}), Sides(None, ("active",), ("passive",)))
    assert {each.name: each.value for each in told} == {
        "pressure_offset": 3e4, "pressure_thermal_zero": 400.0, "pressure_thermal_bow": 5.0,
    }  # fmt: skip


def test_a_gain_of_the_transducers_is_of_a_per_cent_and_of_two_where_it_is_another_beyond_a_pressure():
    """The sizes by which a found one is called plausible."""
    assert (module.e_p.typical, feedback.b_p.typical) == (0.01, 0.02)


# -- delays
def test_a_late_speed_makes_what_follows_from_it_early_and_late_pressures_everything():
    """Over the delay itself: of a square, ahead by 0.1 s, the slope is taken 0.05 s further on."""
    one = run()
    speed = delay_columns(one, {"ahead": 0.1, "behind": 0.0, "late": SPEED})
    pressures = delay_columns(one, {"ahead": 0.0, "behind": 0.1, "late": PRESSURES})
    assert speed[50] == pytest.approx(3.0)
    assert pressures[50] == pytest.approx(2.0 * TIME[50] - 0.1)


def test_a_small_delay_is_looked_for_either_way_alike():
    """Its sign is not known: of a square the slope is the one at the instant itself."""
    of_square = SimpleNamespace(time=np.arange(101) * 0.01, from_speed=(np.arange(101) * 0.01) ** 2)
    np.testing.assert_allclose(delay_columns(of_square, SMALL_DELAY)[5:-5, 0], 2.0 * of_square.time[5:-5])


@pytest.mark.parametrize(
    ("dt", "heave", "small"),
    [(0.02, False, ["small, of the speed"]), (0.02, True, ["small, of the speed", "small, of the pressures"]),
     (0.05, True, [])],
)  # fmt: skip
def test_a_delay_of_less_than_a_sample_is_how_a_log_was_made(dt, heave, small):
    """And where no heave is logged, a late speed and early pressures are one thing."""
    found = lateness._delay_shapes([run(dt=dt, **({"heave_velocity": 0.0} if heave else {}))])
    assert [each.label for each in found if "small" in each.label] == small
    assert len(found) == len(small) + 2 * len(DELAYS)
    for each in found:  # a speed that is late has a positive delay, pressures that are late a negative one
        low, high = each.bounds
        assert low < high
        assert "about" not in each.label or (low > 0.0) is ("speed late" in each.label)


@pytest.mark.parametrize(("late", "name", "value"), [(SPEED, "signal_delay", 0.1), (PRESSURES, "pressure_delay", -0.1)])
def test_pressures_that_are_late_are_corrected_as_such(late, name, value):
    found = {"tau": ParameterEstimate(0.1, 0.01, "s")}
    (own,) = lateness._to_delay(found, Shape("", {"late": late}), SIDES)
    assert (own.name, own.value, own.std) == (name, value, 0.01)
    (clock,) = lateness._to_delay(found, Shape("", {"late": late, "by_time": 1.0}), SIDES)  # by 0.1 s after 100 s
    assert (clock.name, clock.value) == (name.replace("delay", "clock"), pytest.approx(value / 100.0))


@pytest.mark.parametrize(("which", "groups"), [(ALL, ()), (BALANCING, ("active",)), (OTHER, ("passive",))])
def test_a_correction_names_the_groups_that_its_shape_speaks_of(which, groups):
    found = {"e_p": ParameterEstimate(0.01, 0.001, "1"), "c_p": ParameterEstimate(1e-10, 1e-11, "1/Pa")}
    for port, ending in ((0.0, ""), (1.0, "_a")):
        bent = module.to(("pressure_scale", module.e_p), ("pressure_curvature", module.c_p))
        own = bent(found, Shape("", {"groups": which, "port_a": port}), SIDES)
        assert [each.name for each in own] == [f"pressure_scale{ending}", f"pressure_curvature{ending}"]
        assert all(tuple(each.groups) == groups for each in own)
