"""A crane as friction sees it: its drum's layers, its motors, and what a hanging load is at the motor shaft."""

import math
from dataclasses import replace

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run, Sample
from winch_friction.physics.winch.crane import (
    Crane,
    Drive,
    Drum,
    at_its_speeds,
    driving_group,
    run_drum_torque,
    sample_load,
)

DRUM = Drum((0.8, 0.9, 1.0))
CRANE = Crane("c", 250.0, DRUM, {"active": 3, "passive": 8}, 1.5)


@pytest.mark.parametrize("layer", [0.0, 0.4, -1.0, 4.0, 3.6, math.inf])
def test_a_layer_beyond_the_drum_is_none_and_refused(layer):
    assert not DRUM.has(layer)
    with pytest.raises(InputError, match=r"the drum has layers 1 \.\.\. 3"):
        DRUM.radius(layer)


@pytest.mark.parametrize(("layer", "radius"), [(1.0, 0.8), (2.2, 0.9), (3.0, 1.0), (math.nan, 1.0)])
def test_a_layer_is_counted_from_one_and_without_one_the_outer_is_assumed(layer, radius):
    assert DRUM.has(layer)
    assert DRUM.radius(layer) == radius


def test_a_load_is_a_torque_at_the_drum_and_an_inertia_at_the_shaft():
    assert CRANE.drum_torque(1e4, 2.0) == pytest.approx(1e4 * 9.81 * 0.9, rel=1e-3)
    assert CRANE.load_inertia(1e4, 2.0) == pytest.approx(1e4 * (0.9 / 250.0) ** 2)
    assert (CRANE.motor_total(("active",)), CRANE.motor_total(())) == (3, 11)


@pytest.mark.parametrize("layer", [1.0, 2.0, 3.0, math.nan])
def test_a_load_turns_with_the_radius_of_its_own_layer(layer):
    """Both by the energy: m g v = T omega_drum, and m v^2 = J omega_motor^2."""
    radius = 1.0 if math.isnan(layer) else (0.8, 0.9, 1.0)[int(layer) - 1]
    rope = radius / 250.0  # m/s per rad/s of the motor
    assert CRANE.drum_torque(2e3, layer) / 250.0 == pytest.approx(2e3 * GRAVITY * rope)
    assert CRANE.load_inertia(2e3, layer) == pytest.approx(2e3 * rope**2)
    run = Run("r", {"time": np.zeros(2), "wire_layer": np.full(2, layer)})
    assert run_drum_torque(run, CRANE, 2e3) == pytest.approx(np.full(2, CRANE.drum_torque(2e3, layer)))
    shown = Run("r", {**run.columns, "hook_load": np.array([1e3, 3e3])})
    assert run_drum_torque(shown, CRANE, 2e3) / CRANE.drum_torque(1e3, layer) == pytest.approx([1.0, 3.0])


@pytest.mark.parametrize(
    ("shown", "load"),
    [({"hook_load": 5e3, "rope_force": 9.81e4}, 5e3), ({"rope_force": 9.81e4}, 1e4), ({"hook_load": 0.0}, 0.0)],
)
def test_a_hook_load_comes_before_what_the_ropes_force_carries(shown, load):
    assert sample_load(Sample(0.0, 0.0, **shown)) == pytest.approx(load, rel=1e-3)


def test_without_either_no_load_is_known():
    assert math.isnan(sample_load(Sample(0.0, 0.0)))


@pytest.mark.parametrize(
    ("groups", "driving"),
    [(("passive", "active"), "active"), (("main", "active"), "active"), (("passive", "main"), "main"),
     (("port", "starboard"), "port"), (("passive",), "passive")],
)  # fmt: skip
def test_the_group_that_closes_the_balance_is_the_active_one_then_the_main_one(groups, driving):
    assert driving_group(groups) == driving


def test_a_winch_without_named_groups_has_one_motor():
    assert replace(CRANE, groups={}).motor_total(()) == 1


@pytest.mark.parametrize(("rated", "scale"), [(0.0, 1.0), (400.0, 1.0), (100.0, 1.0), (50.0, 0.5), (2.0, 0.02)])
def test_settings_that_were_left_alone_go_with_a_slow_motor_and_no_others(rated, scale):
    crane, own = replace(CRANE, rated_speed=rated), EstimatorConfig(excitation_speed=7.0)
    assert crane.speed_scale == pytest.approx(scale)
    found = at_its_speeds(own, crane, "stick_speed", "excitation_speed")
    assert (found.stick_speed, found.excitation_speed) == pytest.approx((3.0 * scale, 7.0))
    assert found.speed_noise == own.speed_noise


@pytest.mark.parametrize(("kind", "unit"), [("hydraulic", "bar"), ("electric", "N*m"), ("power", "N*m")])
def test_people_read_bar_of_a_hydraulic_drive_and_a_torque_of_any_other(kind, unit):
    assert Drive(kind).unit == unit


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("speed", "known"), [(4.9, False), (5.0, True), (50.0, True)])
def test_a_power_is_a_torque_either_way_where_the_shaft_turns(way, speed, known):
    power = replace(CRANE, drive=Drive("power"))
    sample = Sample(0.0, way * speed, mechanical_power=way * speed * 30.0)
    run = Run("r", {"time": np.zeros(1), "motor_speed": np.array([way * speed]),
                    "mechanical_power": np.array([way * speed * 30.0])})  # fmt: skip
    for found in (power.drive.of_sample(sample, power), float(power.drive.of_run(run, power)[0])):
        assert found == pytest.approx(30.0 if known else math.nan, nan_ok=True)
    assert bool(power.drive.lacking(sample)) is not known
