"""What the diagnostics say of the inputs: rates between two reports, what was never heard, what was refused since."""

from types import SimpleNamespace

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes.base import ERROR, OK, WARN
from winch_friction.nodes.rates import InputHealth
from winch_friction.online.compensator import CompensatorService
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import crane_topics, stamp_header

CRANE = load_crane("crane_150t")
TOPICS = crane_topics(CRANE)
SPEED, PRESSURE, LOAD = "winch/joint_states", "winch/active/pressure_a", "winch/hook_load"


class Heard:
    """A service whose inputs are reported on, at steady `now` s."""

    def __init__(self) -> None:
        self.now = 100.0
        self.gate = CompensatorService(CRANE, load_model("a6vm215_crane2"), TOPICS).inputs
        none = SimpleNamespace(subscriptions=dict, late=0)
        self.health = InputHealth(self.gate, none, lambda: {SPEED, PRESSURE}, lambda: self.now, patience=0.1)

    def hear(
        self,
        seconds: float,
        period: float = 0.02,
        without: tuple[str, ...] = (),
        pressure: float = 1e7,
        ahead: float = 0.0,
    ) -> None:
        """Messages for a while; the clock of whoever sends the pressure is `ahead` s of the speed's."""
        for _ in range(round(seconds / period)):
            self.now += period
            groups = {name: GroupSample(pressure, 25e5, CRANE.max_displacement) for name in ("active", "passive")}
            sample = Sample(self.now, motor_speed=50.0, speed_reference=50.0, hook_load=55e3, groups=groups)
            for topic, message in TOPICS.encode(sample, MESSAGES):
                if topic == PRESSURE:
                    message.header = stamp_header(self.now + ahead, MESSAGES)
                if topic not in without:
                    self.gate.take(TOPICS.inputs[topic], message, self.now, self.now)


@pytest.fixture
def heard() -> Heard:
    return Heard()


def test_a_rate_is_that_since_the_last_report(heard: Heard) -> None:
    for period, rate in ((0.02, 50.0), (0.05, 20.0), (0.02, 50.0)):
        heard.hear(1.0, period)
        assert heard.health.report().values[f"{SPEED} rate"] == pytest.approx(rate, rel=0.01)
    assert heard.health.report().values[f"{SPEED} rate"] == 0.0


def test_an_input_that_was_never_heard_is_an_error_once_the_speed_was(heard: Heard) -> None:
    """Before, the machine may just not be on."""
    assert heard.health.report().level == WARN
    heard.hear(0.5, without=(PRESSURE,))
    report = heard.health.report()
    assert report.level == ERROR
    assert f"{PRESSURE}: never heard" in report.summary


def test_what_was_refused_is_said_until_the_next_report(heard: Heard) -> None:
    heard.hear(0.5)
    assert (heard.health.report().level, heard.health.report().summary) == (OK, "inputs arrive")
    heard.hear(0.1, pressure=9.9e7)
    report = heard.health.report()
    assert f"{PRESSURE}: 5 refused" in report.summary
    assert report.values[f"{PRESSURE} plausible"] is False
    heard.hear(0.5)
    assert heard.health.report().summary == "inputs arrive"


@pytest.mark.parametrize(("topic", "silent", "level"), [
    (PRESSURE, 0.08, OK), (PRESSURE, 0.3, ERROR), (LOAD, 1.5, OK), (LOAD, 2.5, WARN),
])  # fmt: skip
def test_a_silence_is_said_when_the_input_counts_as_lost(heard: Heard, topic: str, silent: float, level: int) -> None:
    heard.hear(1.0)
    heard.hear(silent, without=(topic,))
    assert heard.health.report().level == level


def test_an_optional_input_may_pause_longer_than_a_needed_one(heard: Heard) -> None:
    """Half a second, or its own age limit where that is more."""
    limits = [
        heard.health._limit(topic, needed) for topic in ("winch/heave_velocity", LOAD) for needed in (True, False)
    ]
    assert limits == pytest.approx([0.1, 0.5, 2.0, 2.0])


@pytest.mark.parametrize(("after", "said"), [(24, False), (26, True)])
def test_a_message_that_is_overtaken_now_and_then_is_no_wrong_order(heard: Heard, after: int, said: bool) -> None:
    heard.hear(1.0)
    heard.health.report()
    heard.hear(1.0)  # fifty messages
    heard.gate.arrivals[PRESSURE].after += after
    assert ("comes after the speed" in heard.health.report().summary) is said


@pytest.mark.parametrize(("ahead", "said"), [(0.3, True), (0.08, False)])
def test_a_clock_that_is_ahead_of_the_speeds_is_said(heard: Heard, ahead: float, said: bool) -> None:
    """Its values are taken as late as its stamps say: a command turned the torque against the speed at each reversal,
    the feedforward faded every time, and `inputs arrive`."""
    heard.hear(1.0)
    heard.health.report()
    heard.hear(0.5, ahead=ahead)
    words = f"{PRESSURE}: its stamps are 0.3 s ahead of the speed's"
    assert (words in heard.health.report().summary) is said
    heard.now += 0.09  # what comes while the next speed is waited for is ahead of the last one
    assert (words in heard.health.report().summary) is said
    heard.hear(0.5)  # stamps that are set back are refused until they are where they were
    heard.health.report()
    heard.hear(0.5)
    assert heard.health.report().summary == "inputs arrive"


def test_a_needed_input_is_silent_from_its_age_limit_on(heard: Heard) -> None:
    heard.hear(1.0)
    heard.now += 0.09
    assert heard.health.silent() == frozenset()
    heard.now += 0.02
    assert heard.health.silent() == {SPEED, PRESSURE}
