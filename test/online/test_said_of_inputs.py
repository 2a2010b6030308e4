"""What is said of an input names what is wrong with it, and nothing else."""

import pytest
from sea import PERIOD, SEED, TOPICS, Fed, swell

from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.signals import Sample
from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import crane_topics

LOAD, PRESSURE, SPEED = "winch/hook_load", "winch/active/pressure_a", "winch/joint_states"


@pytest.fixture
def fed() -> Fed:
    made = Fed()
    made.run(1.0)
    return made


def test_inputs_whose_stamps_stand_still_do_not_come_after_the_speed_of_their_instant(fed: Fed) -> None:
    """Of every input it was said to publish the speed last, although the order was right and the clock had stopped."""
    frozen = fed.now

    def freeze(sample: object) -> None:
        sample.time = frozen

    fed.run(1.0, freeze)
    assert fed.service.inputs.arrivals[PRESSURE].after <= 1
    assert fed.service.inputs.arrivals[SPEED].reason == "stamp stands still"


@pytest.mark.parametrize(("crane", "model", "said"), [("worm_drive", "worm_viscous", True), ("crane_150t", "", False)])
def test_a_torque_beyond_any_motor_is_told_where_the_drive_is_known_by_it(crane: str, model: str, said: bool) -> None:
    """The estimator waited for `motor_torque`, and of the inputs it was said that they arrive."""
    machine, seed = load_crane(crane), load_model(model) if model else SEED
    topics = crane_topics(machine)
    service = EstimatorService(machine, seed, topics)
    for k in range(5):
        now = 1000.0 + k * PERIOD
        sample = Sample(time=now, motor_speed=1.0, motor_torque=1e9, groups={})
        for topic, message in topics.encode(sample, MESSAGES):
            service.take(topics.inputs[topic], message, now, now)
    speed = service.inputs.arrivals[SPEED]
    assert (speed.refused, "motor_torque: 1e+09 N*m is outside" in speed.reason) == ((5, True) if said else (0, False))
    assert service.last is not None  # the speed itself is taken


def test_speeds_that_come_in_the_wrong_order_are_told_from_a_clock_that_stands(fed: Fed) -> None:
    """Swapped in pairs on the way, half of them were said to have a stamp that stands still: one looks at the sender's
    clock then, and not at the network."""
    for k in range(10):
        for place in (k + 1, k) if k % 2 == 0 else ():
            message = dict(fed.messages(swell(fed.now + place * PERIOD)))[SPEED]
            at = fed.now + (k + 2) * PERIOD
            fed.service.take(TOPICS.inputs[SPEED], message, at, at)
    assert fed.service.inputs.arrivals[SPEED].reasons == {"stamp before that of the last message": 5}


def test_a_stamp_that_fell_back_is_told_from_a_message_that_shows_nothing(fed: Fed) -> None:
    def far_back(sample: object) -> None:
        sample.time = 0.0

    fed.run(PERIOD, far_back)
    assert fed.service.inputs.arrivals[PRESSURE].reason == "stamp before that of the last message"
    assert fed.service.inputs.arrivals[SPEED].reason == "stamp far behind"


@pytest.mark.parametrize(("topic", "joint"), [("winch/active/displacement", "active_swash"), (SPEED, "winch_motor")])
def test_a_message_without_its_joint_is_told_by_the_joints_name(fed: Fed, topic: str, joint: str) -> None:
    """Of the speed it was said that it is `no number`, which sends whoever reads it to the encoder."""
    source = fed.service.inputs.topics.inputs[topic]
    (message,) = (each for name, each in fed.messages(_now(fed)) if name == topic)
    message.name = ["another"]
    for names in (["another"], [joint, joint]):
        message.header.stamp.nanosec += 1_000_000
        message.name = names
        assert fed.service.take(source, message, fed.now, fed.now) is None
        reason = fed.service.inputs.arrivals[topic].reason
        assert reason.startswith(
            f"joint '{joint}' stands in it twice" if joint in names else f"without the joint '{joint}'"
        )


@pytest.mark.parametrize(("topic", "said"), [
    (PRESSURE, "active.pressure_a: 9.9e+07 Pa is outside -1e+07 ... 6e+07 Pa"),
    (LOAD, "hook_load: 5.5e+07 kg is outside -1.5e+04 ... 3e+05 kg"),
])  # fmt: skip
def test_a_value_that_cannot_be_is_said_with_its_unit(fed: Fed, topic: str, said: str) -> None:
    """It is a wrong unit as often as not."""

    def change(sample: object) -> None:
        sample.groups["active"].pressure_a = 9.9e7
        sample.hook_load = 5.5e7

    fed.run(PERIOD, change)
    assert fed.service.inputs.arrivals[topic].reason == said


def _now(fed: Fed) -> object:
    from sea import swell

    fed.now += PERIOD
    return swell(fed.now)
