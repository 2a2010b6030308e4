"""The feedforward as a pressure: bounded by what the crane is rated for, and no faster than the torque may be."""

import math
from dataclasses import replace

import pytest

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.compensation.parts import CarryingPressure, carried
from winch_friction.physics.channels import BAR
from winch_friction.physics.signals import GroupSample, Sample

PERIOD = 0.02
MOTORS = 3


@pytest.fixture(name="crane")
def _crane(crane_150t):
    return crane_150t


@pytest.fixture(name="seed")
def _seed(crane2_model):
    return crane2_model


def compensator(crane, seed, **settings):
    return FeedforwardCompensator(crane, seed, CompensatorConfig(ramp_time=0.2, **settings))


def hoisting(crane, time, share):
    """55 t at full speed, the active motors' displacement at this share of the largest."""
    groups = {
        "active": GroupSample(50 * BAR, 25 * BAR, share * crane.max_displacement),
        "passive": GroupSample(275 * BAR, 25 * BAR, crane.max_displacement / 3.0),
    }
    return Sample(time, 100.0, 100.0, groups=groups, hook_load=55e3)


def driven(each, crane, shares):
    return [each.step(hoisting(crane, k * PERIOD, share)) for k, share in enumerate(shares)]


def test_with_a_displacement_that_stays_it_is_the_torque(crane, seed):
    for said in driven(compensator(crane, seed), crane, [0.74] * 50):
        expected = said.friction_torque / (MOTORS * 0.74 * crane.max_displacement)
        assert said.pressure == pytest.approx(expected, rel=1e-12)
    assert said.pressure > 30 * BAR


@pytest.mark.parametrize("rated", [450 * BAR, 0.0, 300 * BAR])
def test_motors_that_swing_out_ask_for_no_more_than_they_are_rated_for(crane, seed, rated):
    """At a tenth of the displacement it was 500 bar, and 2000 N m would have been 1950."""
    crane = replace(crane, rated_pressure=rated, absolute_torque_limit=1e5)
    each = compensator(crane, seed.with_values({"C6": 1.4 * seed.value("C6")}), scale=1.3)
    said = driven(each, crane, [0.3] * 50 + [0.1] * 50)
    assert max(s.pressure for s in said) == pytest.approx(rated or 450 * BAR)
    assert each.status()["pressure_clamps"] > 0
    assert said[-1].friction_torque > 400.0


def test_a_limit_of_ones_own_is_kept(crane, seed):
    each = compensator(crane, seed, pressure_limit=20 * BAR)
    assert max(s.pressure for s in driven(each, crane, [1.0] * 50)) == 20 * BAR


def test_a_feedback_that_drops_lets_it_grow_no_faster_than_the_slew_limit(crane, seed):
    each = compensator(crane, seed, slew_limit=3e3)
    said = driven(each, crane, [0.4] * 50 + [0.15] * 50)
    full = said[-1].friction_torque / (MOTORS * 0.15 * crane.max_displacement)
    assert said[-1].pressure == pytest.approx(full)
    most = 3e3 * PERIOD / (MOTORS * 0.15 * crane.max_displacement)
    steps = [after.pressure - before.pressure for before, after in zip(said[49:], said[50:], strict=False)]
    assert max(steps) <= most * (1.0 + 1e-9)
    assert max(steps) > 0.5 * most


def test_it_is_let_go_with_the_torque(crane, seed):
    each = compensator(crane, seed)
    said = driven(each, crane, [0.3] * 50 + [0.1] * 2)
    end = said[-1].time
    left = [each.decay(end + 0.1 + 0.02 * k) for k in range(40)]
    assert left[-1].friction_torque == left[-1].pressure == 0.0
    for s in left:
        assert abs(s.pressure) <= s.friction_torque / (MOTORS * 0.1 * crane.max_displacement) * (1.0 + 1e-9)


@pytest.mark.parametrize(("share", "pressed"), [(0.0, 0.0), (-0.04, 0.0), (0.01, 0.1)])
def test_motors_that_are_swung_out_are_asked_for_nothing(crane, seed, share, pressed):
    """They carry no friction whatever their pressure: 293 bar went out at a displacement of zero, `valid`."""
    each = compensator(crane, seed)
    said = driven(each, crane, [share] * 50)[-1]
    assert said.friction_torque > 200.0
    floor = said.friction_torque / (MOTORS * 0.1 * crane.max_displacement)
    assert said.pressure == pytest.approx(pressed * floor, rel=1e-9)
    assert said.valid  # the torque is


def test_a_crane_of_unknown_motors_that_are_swung_out_is_answered(crane):
    groups = {"active": GroupSample(50 * BAR, 25 * BAR, 0.0)}
    bare = replace(crane, max_displacement=0.0)
    assert carried(Sample(0.0, 0.0, groups=groups), bare, CompensatorConfig())[0] == 0.0


# -- the part itself
def test_it_never_has_another_sign_than_the_torque():
    each = CarryingPressure(1e7)
    assert each.of(100.0, 1e4, 0.0, 1e5) == 0.0  # no time has passed to grow in
    assert each.of(100.0, 1e4, 0.02, 1e9) == 1e6
    assert each.of(-100.0, 1e4, 0.04, 1e3) == pytest.approx(-0.02 * 1e3 * 1e4)  # from zero on, whatever was before
    assert each.of(1.0, 1e4, 0.06, 1e9) == 1e4
    assert each.of(0.0, 1e4, 0.04, 1e5) == 0.0


def test_a_step_back_in_time_lets_it_grow_by_nothing():
    each = CarryingPressure(1e7)
    each.of(0.0, 1e4, 10.0, 1e5)
    assert each.of(100.0, 1e4, 9.0, 1e5) == 0.0
    assert each.of(100.0, 1e4, 9.02, 1e3) == pytest.approx(0.02 * 1e3 * 1e4)


def test_a_group_that_is_not_there_carries_nothing():
    each = CarryingPressure(math.inf)
    each.of(0.0, 1e4, 0.0, 1e5)
    assert each.of(100.0, 1e4, 1.0, 1e5) == 1e6
    assert each.of(100.0, 0.0, 1.02, 1e5) == 0.0


@pytest.mark.parametrize(
    ("groups", "name", "carries"),
    [(["active", "passive"], "active", "active"), (["active", "passive"], "passive", "passive"),
     (["active", "passive"], "main", ""), (["main"], "active", "main"), ([], "active", "")],
)  # fmt: skip
@pytest.mark.parametrize(
    ("share", "counted"), [(0.5, 0.5), (0.1, 0.1), (0.05, 0.2), (0.0, math.inf), (-0.04, math.inf)]
)
def test_the_group_that_was_set_carries_it_or_the_only_one(crane, groups, name, carries, share, counted):
    """At half the floor half its pressure; swung out none, and none past centre, where it would push the other way."""
    members = {each: GroupSample(50 * BAR, 25 * BAR, share * crane.max_displacement) for each in groups}
    found = carried(Sample(0.0, 0.0, groups=members), crane, CompensatorConfig(pressure_group=name))[0]
    motors = crane.groups.get(carries, math.inf)
    assert found == pytest.approx(1.0 / (motors * counted * crane.max_displacement))


@pytest.mark.parametrize(
    ("limit", "rated", "bound"),
    [(math.inf, 450, 450), (math.inf, 0, 450), (200, 450, 200), (600, 450, 450), (600, 0, 450), (200, 0, 200)],
)
def test_its_bound_is_the_lower_of_what_was_set_and_what_the_crane_is_rated_for(crane, limit, rated, bound):
    own = CarryingPressure.on(replace(crane, rated_pressure=rated * BAR), CompensatorConfig(pressure_limit=limit * BAR))
    assert own.absolute == pytest.approx(bound * BAR)
