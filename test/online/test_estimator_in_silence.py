"""An estimator's last torque does not stand: where no speed comes it says once that nothing is known."""

import math

import pytest
from sea import CRANE, SEED, TOPICS, swell

from winch_friction.online.estimator import EstimatorService
from winch_friction.online.inputs import ServiceOptions
from winch_friction.records.bag_write import MESSAGES

START, PERIOD, TIMEOUT = 1000.0, 0.02, 0.1  # s


class Heard:
    """An estimator that hears a swell; `now` is the steady clock, s."""

    def __init__(self) -> None:
        self.service = EstimatorService(CRANE, SEED, TOPICS, options=ServiceOptions(TIMEOUT))
        self.now = START

    def hear(self, seconds: float, stamp: float = math.nan, pressures: bool = True) -> None:
        for _ in range(round(seconds / PERIOD)):
            self.now += PERIOD
            sample = swell(self.now)
            sample.time = self.now if math.isnan(stamp) else stamp
            for topic, message in TOPICS.encode(sample, MESSAGES):
                if pressures or "pressure" not in topic:
                    self.service.take(TOPICS.inputs[topic], message, self.now, self.now)
            assert not math.isnan(stamp) or self.service.tick(self.now) is None


@pytest.fixture
def heard() -> Heard:
    made = Heard()
    made.hear(1.0)
    assert abs(made.service.last.friction_torque) > 50.0
    return made


def test_a_silence_is_said_once_under_the_stamp_of_the_last_sample(heard: Heard) -> None:
    """A later one would answer samples that are still to come: a simulation in lockstep would not wait for those."""
    last = heard.service.last.time
    assert heard.service.tick(heard.now + 0.99 * TIMEOUT) is None
    said = heard.service.tick(heard.now + 3.0 * TIMEOUT)
    assert said is not None
    assert said.time == last
    assert math.isnan(said.friction_torque)
    assert not said.accepted
    assert said.state == "waiting"
    assert heard.service.tick(heard.now + 10.0) is None
    heard.now += 10.0
    heard.hear(0.5)
    assert heard.service.tick(heard.now + 1.0) is not None  # the next silence


def test_stamps_that_stand_still_are_a_silence(heard: Heard) -> None:
    heard.hear(0.5, stamp=heard.now)
    assert heard.service.tick(heard.now) is not None


def test_what_is_zero_already_does_not_stand(heard: Heard) -> None:
    heard.hear(1.0, pressures=False)
    assert math.isnan(heard.service.last.friction_torque)
    assert heard.service.tick(heard.now + 1.0) is None


def test_the_end_is_a_silence_that_waits_for_nothing(heard: Heard) -> None:
    assert math.isnan(heard.service.ending().friction_torque)
    assert heard.service.ending() is None
    assert EstimatorService(CRANE, SEED, TOPICS).ending() is None


def test_a_sample_that_the_filter_does_not_take_in_is_told_as_rejected(heard: Heard) -> None:
    """'learning' stood there while nothing was learned."""
    assert heard.service.status(heard.now)["state"] == "learning"
    heard.service.last = heard.service.last._replace(accepted=False)
    assert heard.service.status(heard.now)["state"] == "rejected"
    assert heard.service.status(heard.now + 1.0)["state"] == "waiting"
