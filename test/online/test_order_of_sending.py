"""An input without a stamp belongs to the first speed that was sent after it, whichever of the two came first."""

import math

import pytest
from sea import CRANE, PERIOD, SEED, TOPICS, swell

from winch_friction.online.compensator import CompensatorService
from winch_friction.records.bag_write import MESSAGES

LOAD = "winch/hook_load"
START = 1000.0


@pytest.mark.parametrize(("sent", "behind"), [(0.001, 1), (-0.001, 0), (None, 0)])
def test_a_load_that_was_sent_after_the_speed_is_not_yet_its_own(sent, behind):
    """A node that was paused finds both waiting and takes the load in first: a recording of the same, in the order of
    sending, would give another torque."""
    service, loads = CompensatorService(CRANE, SEED, TOPICS), []
    step = service.law.step
    service.law.step = lambda sample, *rest: (loads.append(sample.hook_load), step(sample, *rest))[1]
    for k in range(10):
        now = START + k * PERIOD
        messages = dict(TOPICS.encode(swell(now), MESSAGES))
        load = MESSAGES.make("std_msgs/msg/Float64", data=55e3 + 100.0 * k)
        for topic, message in {**messages, LOAD: load}.items():
            if topic not in (LOAD, TOPICS.speed_topic):
                service.take(TOPICS.inputs[topic], message, now, now, now)
        service.take(TOPICS.inputs[LOAD], load, now, now, None if sent is None else now + sent)
        service.take(TOPICS.inputs[TOPICS.speed_topic], messages[TOPICS.speed_topic], now, now, now)
    assert loads[behind:] == [55e3 + 100.0 * k for k in range(10 - behind)]
    assert all(math.isnan(each) for each in loads[:behind])
