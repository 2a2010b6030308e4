"""What is absent has a meaning, the outer wire layer, a crane that stands still; what was there and falls silent is
lost."""

import math
from dataclasses import replace

import pytest
from sea import CRANE, PERIOD, SEED, TOPICS, Fed, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.winch.crane import Drum
from winch_friction.records.bag_write import MESSAGES

QUICK = CompensatorConfig(ramp_time=0.2, max_ages={"hook_load": 2.0, "wire_layer": 1.0})


def on_layer(number):
    def change(sample):
        sample.wire_layer = number

    return change


def test_a_layer_that_falls_silent_is_lost_and_not_the_outer_one():
    """On the innermost layer the load's torque became 1.42 times what it was, `valid`."""
    fed = Fed(QUICK)
    fed.run(2.0)
    assert fed.published[-1][1].state == "active"  # never said: the outer one is assumed
    fed.run(2.0, on_layer(1.0))
    assert fed.run(0.9)[-1].state == "active"  # held for its time
    fed.run(0.6)
    assert (fed.torque, fed.published[-1][1].valid) == (0.0, False)
    assert fed.service.status(fed.now)["missing"] == "wire_layer"
    assert fed.run(1.0, on_layer(1.0))[-1].state == "active"


@pytest.mark.parametrize(("said", "state"), [(0.0, "waiting"), (7.0, "waiting"), (math.nan, "active")])
def test_a_layer_that_is_never_believed_is_no_outer_one(said, state):
    """A PLC that counts from 0 says 0 on the innermost layer; one that says no number says nothing."""
    fed = Fed(QUICK)
    last = [each.state for each in fed.run(1.0)][-1]
    assert last == "active"
    fed = Fed(QUICK)
    topic = "winch/wire_layer"
    for _ in range(50):
        fed.now += PERIOD
        fed.hear(
            fed.service.take(TOPICS.inputs[topic], MESSAGES.make("std_msgs/msg/Float64", data=said), fed.now, fed.now)
        )
        fed.send(swell(fed.now))
    assert fed.published[-1][1].state == state


@pytest.mark.parametrize(("times", "end"), [(1, "active"), (2, "stale")])
def test_one_stray_layer_does_not_stop_the_winch_for_good_and_a_sender_of_such_does(times, end):
    """A single `7` of a drum of six layers, on a crane that never says its layer, stopped learning and feedforward for
    ever; who says it again two seconds later is a sender, and once silent nobody knows the layer."""
    fed, learning = Fed(QUICK), EstimatorService(CRANE, SEED, TOPICS)
    fed.run(1.0)
    source, stray = TOPICS.inputs["winch/wire_layer"], MESSAGES.make("std_msgs/msg/Float64", data=7.0)

    def learns():
        for topic, message in fed.messages(swell(fed.now)):
            learning.take(TOPICS.inputs[topic], message, fed.now, fed.now)
        return "wire_layer" not in learning.missing

    for _ in range(times):
        fed.hear(fed.service.take(source, stray, fed.now, fed.now))
        learning.take(source, stray, fed.now, fed.now)
        fed.run(2.0)
        assert fed.published[-1][1].state == "stale"
        assert not learns()
    fed.run(27.0)
    assert fed.published[-1][1].state == "stale"
    fed.run(4.0)
    assert fed.published[-1][1].state == end
    assert learns() == (end == "active")


def test_a_wire_that_does_not_stretch_has_no_length_to_lose():
    gate = EstimatorService(replace(CRANE, wire_stiffness=math.inf), SEED, TOPICS).inputs
    gate.fill(replace(swell(1000.0), wire_out=1500.0))
    assert math.isnan(gate.fill(swell(1003.0)).wire_out)


def test_a_drum_of_one_layer_has_none_to_lose():
    fed = Fed(QUICK)
    fed.service = CompensatorService(replace(CRANE, drum=Drum((1.136,))), SEED, TOPICS, QUICK)
    fed.run(2.0, on_layer(1.0))
    assert fed.run(2.0)[-1].state == "active"


@pytest.mark.parametrize(("column", "value"), [("heave_velocity", 0.3), ("wire_layer", 1.0), ("wire_out", 1500.0)])
def test_the_estimator_rests_without_what_was_there(column, value):
    """Without its motion sensor the crane stood still, and 30 N m of friction were learned besides; without its counter
    1500 m of wire were 50 m."""
    service = EstimatorService(CRANE, SEED, TOPICS)
    service.inputs.hold.max_ages = {"hook_load": 2.0, "wire_layer": 0.1, "wire_out": 0.1}

    def learn(seconds, value):
        begin = service.inputs.last_stamp if math.isfinite(service.inputs.last_stamp) else 1000.0
        for k in range(1, round(seconds / PERIOD) + 1):
            sample = swell(begin + k * PERIOD)
            setattr(sample, column, value)
            service.take_row(sample)

    learn(1.0, math.nan)
    assert service.missing == ()
    learn(1.0, value)
    learn(0.5, math.nan)
    assert (service.missing, service.last.accepted) == ((column,), False)
    learn(0.1, value)
    assert service.missing == ()


@pytest.mark.parametrize(
    ("name", "value", "channel", "shown"),
    [("wire_weight", 24.5, "wire_out", 800.0), ("pressure_thermal_zero", 3e5, "oil_temperature", 60.0)],
)
def test_what_a_correction_reads_is_needed_like_what_a_term_reads(name, value, channel, shown):
    """Without it the errors that the model knows of stayed in the sample: 20 t of wire, 60 bar of a warm transducer."""
    model = replace(SEED, corrections=(Correction(name, value),))
    fed, learning = Fed(QUICK), EstimatorService(CRANE, model, TOPICS)
    fed.service = CompensatorService(CRANE, model, TOPICS, QUICK)
    said = f"{name} cannot be taken out without {channel}"
    for given, missing in ((math.nan, said), (shown, ""), (math.nan, said)):
        fed.run(1.0, lambda sample, given=given: setattr(sample, channel, given))
        assert (fed.published[-1][1].valid, fed.service.status(fed.now)["missing"]) == (not missing, missing)
        sample = swell(fed.now)
        setattr(sample, channel, given)
        learning.inputs.hold.max_ages = {}
        learning.take_row(sample)
        assert (said in learning.missing, learning.last.accepted) == (bool(missing), not missing)
