"""What begins anew remembers nothing of before: what is believed, what was read last, what was heard last."""

import pytest
from sea import CRANE, TOPICS, Fed

from winch_friction.online.before_doubt import UNSEEN, WIRE_UNSEEN, BeforeDoubt
from winch_friction.online.consumer import HeldTorque
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.sample_stream import Plausibility


class Law:
    """An estimator that knows one thing more at every look."""

    def __init__(self) -> None:
        self.looks = 0

    def snapshot(self) -> dict[str, int]:
        self.looks += 1
        return {"look": self.looks}

    def model(self) -> None:
        return None


@pytest.mark.parametrize("step", [0.0, -3600.0, 3600.0, 20.0])
def test_what_is_known_is_believed_after_as_many_seconds_of_samples(step: float) -> None:
    """After an hour's step back nothing newer was believed for an hour; after one ahead, or a gap, what was learned a
    tenth of a second before it was believed at once."""
    each = BeforeDoubt(Law())
    for k in range(round(10.0 * UNSEEN)):
        each.step(5000.0 + 0.1 * k + (step if k >= 3 else 0.0), doubted=False)
        assert each.believed.content == {"look": 1}
    for k in range(round(10.0 * UNSEEN), round(20.0 * UNSEEN)):
        each.step(5000.0 + 0.1 * k + step, doubted=False)
    assert each.believed.content == {"look": 2}


@pytest.mark.parametrize("shift", [0.0, -3600.0, 3600.0])
def test_what_was_known_a_while_ago_is_gone_back_to_whatever_became_of_the_clock(shift: float) -> None:
    """Seconds of samples count: an hour that a clock was set by is no hour of learning."""
    each = BeforeDoubt(Law())
    for k in range(1500):
        each.step(5000.0 + 0.1 * k + (shift if k >= 750 else 0.0), doubted=False)
    newest = each.believed
    each.go_back(0.0)
    assert each.believed is newest
    each.go_back(20.0)
    assert 20.0 <= 149.9 - each.believed.at <= 20.0 + 3.0 * UNSEEN
    each.go_back(WIRE_UNSEEN)
    assert WIRE_UNSEEN <= 149.9 - each.believed.at <= WIRE_UNSEEN + 3.0 * UNSEEN
    each.go_back()
    assert each.believed.content == {"look": 1}
    for k in range(150):
        each.step(9000.0 + 0.1 * k, doubted=False)
    each.begin()
    begun = each.believed
    each.go_back(0.0)
    assert each.believed is begun


def test_a_reading_of_another_time_does_not_make_the_first_one_too_fast() -> None:
    each = Plausibility(ChannelRanges(CRANE, TOPICS.groups))
    assert each.refusal("motor_speed", 10.0, 100.0) == ""
    assert "from the last" in each.refusal("motor_speed", 10.02, -300.0)
    each.forget()
    assert each.refusal("motor_speed", 10.04, -300.0) == ""


def test_a_consumer_that_begins_anew_takes_any_number() -> None:
    each = HeldTorque()
    assert each.take(100.0, 1.0, "valid 500")
    each.clear()
    assert each.value(1.0) == 0.0
    assert each.take(50.0, 1.02, "valid 1")
    assert each.torque == 50.0


def test_what_was_doubted_is_not_doubted_any_more_once_all_begins_anew() -> None:
    fed = Fed()
    fed.run(1.5, lambda sample: setattr(sample, "speed_reference", -sample.speed_reference))
    assert fed.service.contradictions
    fed.service.reset()
    fed.run(0.1)
    assert not fed.service.contradictions
