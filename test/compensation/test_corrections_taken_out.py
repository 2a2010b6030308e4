"""The compensator takes out what its model knows to be wrong with the signals and the crane file."""

import math
from dataclasses import replace

import pytest

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, model_from_text, model_to_text

CRANE, SEED = load_crane("crane_150t"), load_model("a6vm215_crane2")
KNOWN = (
    Correction("pressure_offset", 6 * BAR, groups=("active",)), Correction("pressure_scale", 0.02, groups=("active",)),
    Correction("displacement_offset", 3 * CM3_PER_REV, groups=("passive",)), Correction("tare_load", 4e3),
    Correction("wire_weight", 20.0), Correction("layer_radius", 0.05, layers=(6,)), Correction("inertia", 0.3),
)  # fmt: skip
ERRING = replace(SEED, corrections=KNOWN)
RADII = tuple(radius - (0.05 if k == 5 else 0.0) for k, radius in enumerate(CRANE.drum.layer_radii))
DECLARED = replace(CRANE, drum=replace(CRANE.drum, layer_radii=RADII), inertia=CRANE.inertia - 0.3)
SETTINGS = CompensatorConfig(ramp_time=0.2)


def true_sample(k):
    groups = {
        "active": GroupSample(90 * BAR, 25 * BAR, 160 * CM3_PER_REV),
        "passive": GroupSample(290 * BAR, 25 * BAR, 70 * CM3_PER_REV),
    }
    return Sample(
        0.02 * k, 80.0, speed_reference=80.0, groups=groups, hook_load=55e3, wire_layer=6.0, wire_out=100.0,
        oil_temperature=40.0,
    )  # fmt: skip


def logged_sample(k):
    sample = true_sample(k)
    active, passive = sample.groups["active"], sample.groups["passive"]
    active.pressure_a = active.pressure_a * 1.02 + 6 * BAR
    active.pressure_b *= 1.02
    passive.displacement += 3 * CM3_PER_REV
    sample.hook_load -= 4e3 + 20.0 * sample.wire_out
    return sample


def test_erring_signals_and_crane_file_give_the_right_feedforward():
    right, wrong = FeedforwardCompensator(CRANE, SEED, SETTINGS), FeedforwardCompensator(DECLARED, ERRING, SETTINGS)
    plain = FeedforwardCompensator(DECLARED, SEED, SETTINGS)
    for k in range(100):
        good, found, uncorrected = (
            right.step(true_sample(k)),
            wrong.step(logged_sample(k)),
            plain.step(logged_sample(k)),
        )
        assert found.friction_torque == pytest.approx(good.friction_torque, rel=1e-9, abs=1e-9)
        assert found.pressure == pytest.approx(good.pressure, rel=1e-9, abs=1e-6)
    assert good.friction_torque > 100.0
    assert abs(uncorrected.friction_torque / good.friction_torque - 1.0) > 0.03, "the errors must matter here"


def test_a_model_with_corrections_is_taken_over_while_running():
    right, each = FeedforwardCompensator(CRANE, SEED, SETTINGS), FeedforwardCompensator(DECLARED, SEED, SETTINGS)
    for k in range(50):
        each.step(logged_sample(k))
    each.load_model(model_from_text(model_to_text(ERRING)))
    for k in range(50, 200):
        found = each.step(logged_sample(k))
    for k in range(200):
        good = right.step(true_sample(k))
    assert found.friction_torque == pytest.approx(good.friction_torque, rel=1e-9)


def test_a_model_with_a_delay_is_refused_by_name_and_the_good_one_kept():
    each = FeedforwardCompensator(CRANE, SEED, SETTINGS)
    with pytest.raises(InputError, match="signal_delay"):
        each.load_model(replace(SEED, corrections=(Correction("signal_delay", 0.05),)))
    assert each.model is SEED
    assert each.status()["refused_models"] == 1


def test_what_cannot_be_taken_out_is_like_a_lost_input_and_said():
    """The wire's weight in the load cell needs the wire that is out: without it the load would be a wrong one."""
    each = FeedforwardCompensator(DECLARED, ERRING, SETTINGS)
    assert each.step(logged_sample(0)).valid
    found = each.step(replace(logged_sample(1), wire_out=math.nan))
    assert not found.valid
    assert each.status()["missing"] == "wire_weight cannot be taken out without wire_out"


def test_a_load_is_held_by_the_drum_of_the_model_that_was_taken_over():
    each = FeedforwardCompensator(DECLARED, SEED, SETTINGS)
    outer, inner = CRANE.drum.layer_radii[5], DECLARED.drum.layer_radii[5]
    assert each.step(true_sample(0)).drum_torque == pytest.approx(55e3 * GRAVITY * inner)
    each.load_model(replace(SEED, corrections=tuple(c for c in KNOWN if c.name == "layer_radius")))
    assert each.step(true_sample(1)).drum_torque == pytest.approx(55e3 * GRAVITY * outer)
