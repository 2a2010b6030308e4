"""Messages without a stamp from a machine whose clock is another one."""

from types import SimpleNamespace

import pytest
from std_msgs.msg import Float64

from winch_friction.nodes import inputs as of_nodes
from winch_friction.nodes.inputs import LONGEST_WAY, ROS, Inputs, sent_at
from winch_friction.online.compensator import CompensatorService
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.topics import crane_topics

PERIOD, START = 0.02, 1.8e9  # s; Unix time


def info(now, ahead=0.0, late=1e-4):
    """What the middleware tells of a message sent at `now` s by a clock that is ahead."""
    return {"source_timestamp": round((now + ahead) * 1e9), "received_timestamp": round((now + late) * 1e9)}


def heard(monkeypatch, crane, seed, ahead):
    """The hook loads that the compensator works with while one grows by a kilogram every sample, s of the speed's and
    of the load's clock ahead of ours."""
    topics = crane_topics(crane)
    service, now, waiting = CompensatorService(crane, seed, topics), [START], {}
    node = SimpleNamespace(ros_now=lambda: now[0], service_now=lambda: now[0], guarded=lambda action: action)
    inputs = Inputs(node, service, lambda _: None)
    monkeypatch.setattr(inputs, "_subscribe", lambda source, callback, group=None: source.topic)
    monkeypatch.setattr(of_nodes, "drain", lambda topic: waiting.pop(topic, []))
    inputs.open()
    loads, step = [], service.law.step
    monkeypatch.setattr(
        service.law, "step", lambda sample, *rest: (loads.append(sample.hook_load), step(sample, *rest))[1]
    )
    groups = {"active": GroupSample(50e5, 25e5, crane.max_displacement), "passive": GroupSample(275e5, 25e5, 1e-5)}
    for k in range(200):
        now[0] = START + k * PERIOD
        sample = Sample(now[0], 50.0, 50.0, groups=groups, hook_load=55e3 + k)
        for topic, message in topics.encode(sample, ROS):
            if topic == topics.speed_topic:
                inputs._on_speed(message, info(now[0] + 1e-5, ahead[0]))
            else:
                waiting[topic] = [(message, info(now[0], ahead[1] if isinstance(message, Float64) else 0.0))]
    return [load - 55e3 for load in loads]


@pytest.mark.parametrize(
    "ahead", [(0.0, 0.0), (0.0, 0.3), (0.0, 9.0), (0.0, -9.0), (-9.0, 0.0), (9.0, 0.0), (0.0, 3600.0)]
)
def test_a_load_is_read_when_it_comes_whatever_its_senders_clock_says(monkeypatch, crane_150t, crane2_model, ahead):
    """Of a clock 9 s ahead it waited for a speed that was sent 9 s later, and counted as measured then."""
    loads = heard(monkeypatch, crane_150t, crane2_model, ahead)
    assert loads[1:] == pytest.approx(range(1, 200), abs=1.0)  # the first may belong to the next speed


def test_the_order_of_sending_holds_as_long_as_a_clock_may_be_ours():
    assert sent_at(info(START, 0.0, late=0.05)) == pytest.approx(START)
    assert sent_at(info(START, 0.0, late=LONGEST_WAY + 0.01)) == pytest.approx(START + LONGEST_WAY + 0.01)
    assert sent_at(info(START, 1e-3, late=0.0)) == pytest.approx(START, abs=2e-7)


def test_a_middleware_that_does_not_say_when_it_received_leaves_the_order_of_sending():
    assert sent_at({"source_timestamp": 10**18, "received_timestamp": 0}) == pytest.approx(1e9)
    assert sent_at({"source_timestamp": 10**18}) == pytest.approx(1e9)
