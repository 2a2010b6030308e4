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
HEAVE = "winch/heave_velocity"


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


def test_a_part_of_a_message_that_stays_away_is_named_and_not_its_stamps(heard: Heard) -> None:
    """Read was: winch/joint_states: its stamps are 3.3 s behind the speed's. They were the speed's."""
    speed = TOPICS.inputs[SPEED]
    for k in range(200):
        heard.now += 0.02
        sample = Sample(heard.now, motor_speed=50.0, shaft_angle=1.0 * k, groups={})
        message = dict(TOPICS.encode(sample, MESSAGES))[SPEED]
        if k > 100:
            message.position = []
        heard.gate.take(speed, message, heard.now, heard.now)
        if k in (100, 150, 199):
            summary = heard.health.report().summary
            assert (f"{SPEED}: comes without shaft_angle now" in summary) is (k > 100)
            assert "behind" not in summary


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


def test_a_motion_sensor_that_fell_silent_is_told_what_to_send_in_words_that_stay(heard: Heard) -> None:
    """Its silence is no crane that stands still; a text of its own for every second buried all others in a log."""
    said = set()
    arrivals = heard.gate.arrivals[HEAVE]
    arrivals.messages = 1
    for silence in (3.0, 17.0):
        arrivals.arrived = heard.now - silence
        said.add(heard.health.report().summary)
    assert len(said) == 1
    assert f"{HEAVE}: silent for more than 0.5 s: send 0 where the crane stands still" in said.pop()


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
    report = heard.health.report()
    assert ("comes after the speed" in report.summary) is said
    assert report.level == (WARN if said else OK)


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


# -- whoever publishes
class Heeded:
    """The subscriptions of a node: of each topic how many publishers match, how many there are, and their types."""

    late = 3

    def __init__(self) -> None:
        self.found: dict[str, tuple[int, int, tuple[str, ...]]] = {}
        self.node = SimpleNamespace(
            count_publishers=lambda name: self.found[name][1],
            get_publishers_info_by_topic=lambda name: [SimpleNamespace(topic_type=t) for t in self.found[name][2]],
        )

    def subscriptions(self) -> dict[str, object]:
        def one(topic: str) -> object:
            return SimpleNamespace(topic_name=topic, get_publisher_count=lambda: self.found[topic][0])

        return {topic: one(topic) for topic in self.found}


@pytest.fixture
def watched() -> Heard:
    made = Heard()
    made.heeded = Heeded()
    made.health = InputHealth(made.gate, made.heeded, lambda: {SPEED, PRESSURE}, lambda: made.now, patience=0.1)
    return made


def test_publishers_are_counted_by_whether_they_are_heard(watched: Heard) -> None:
    watched.heeded.found = {SPEED: (1, 1, ()), LOAD: (0, 1, ("std_msgs/msg/Float64",))}
    watched.hear(0.5)
    values = watched.health.report().values
    assert (values[f"{SPEED} publishers"], values[f"{SPEED} matched"]) == (1, 1)
    assert (values[f"{LOAD} publishers"], values[f"{LOAD} matched"]) == (1, 0)
    assert (values[f"{PRESSURE} publishers"], values[f"{PRESSURE} matched"]) == (0, 0)  # not subscribed
    assert values["late"] == 3


@pytest.mark.parametrize(("topic", "level"), [(PRESSURE, ERROR), (LOAD, WARN)])
@pytest.mark.parametrize(
    ("matched", "publishers", "said"),
    [(1, 1, "inputs arrive"), (2, 2, "{topic}: 2 publishers"),
     (1, 3, "{topic}: 3 publishers; {topic}: 2 of 3 publishers do not match its quality of service")],
)  # fmt: skip
def test_more_than_one_publisher_and_one_that_is_not_heard_are_said(
    watched: Heard, topic: str, level: int, matched: int, publishers: int, said: str
) -> None:
    own = TOPICS.inputs[topic].type_name
    watched.heeded.found = {topic: (matched, publishers, (own,) * publishers)}
    watched.hear(0.5)
    report = watched.health.report()
    assert report.summary == said.format(topic=topic)
    assert report.level == (level if publishers > 1 else OK)


@pytest.mark.parametrize(
    ("topic", "types", "said"),
    [
        (PRESSURE, ("std_msgs/msg/Float64",),
         "1 of 1 publishers send std_msgs/msg/Float64, not sensor_msgs/msg/FluidPressure; or name 'active.pressure_a' "
         "in float64_inputs"),
        (PRESSURE, ("std_msgs/msg/String", "std_msgs/msg/Bool"),
         "2 of 2 publishers send std_msgs/msg/Bool, std_msgs/msg/String, not sensor_msgs/msg/FluidPressure"),
        (LOAD, ("sensor_msgs/msg/JointState", "std_msgs/msg/Float64"),
         "2 of 2 publishers send sensor_msgs/msg/JointState, not std_msgs/msg/Float64"),
    ],
)  # fmt: skip
def test_publishers_of_another_type_are_told_by_it(
    watched: Heard, topic: str, types: tuple[str, ...], said: str
) -> None:
    watched.heeded.found = {topic: (0, len(types), types)}
    watched.hear(0.5)
    summary = watched.health.report().summary
    assert f"{topic}: {said}" in summary.split("; " if "; or" not in said else "\n")
    assert ("float64_inputs" in summary) is ("float64_inputs" in said)


def test_the_speed_is_called_by_its_first_channel_and_heard_by_none_of_its_own_name(watched: Heard) -> None:
    watched.heeded.found = {SPEED: (0, 1, ("std_msgs/msg/Float64",))}
    assert "or name 'motor_speed' in float64_inputs" in watched.health.report().summary


def test_what_is_worst_is_said_first_and_gives_the_level(heard: Heard) -> None:
    heard.hear(1.0)
    heard.health.report()
    heard.hear(2.5, without=(PRESSURE, LOAD))
    report = heard.health.report()
    assert report.level == ERROR
    assert report.summary == f"{PRESSURE}: silent for more than 0.1 s; {LOAD}: silent for more than 2 s"


def test_never_heard_is_told_with_its_publishers_and_only_of_what_is_needed(watched: Heard) -> None:
    watched.heeded.found = {PRESSURE: (1, 2, (TOPICS.inputs[PRESSURE].type_name,) * 2)}
    watched.hear(0.5, without=(PRESSURE, LOAD))
    report = watched.health.report()
    assert f"{PRESSURE}: never heard, 1 publishers" in report.summary.split("; ")
    assert LOAD not in report.summary


@pytest.mark.parametrize(("topic", "level"), [(PRESSURE, ERROR), ("winch/passive/pressure_a", WARN)])
def test_what_is_refused_is_counted_with_its_reason_and_its_ages_grow(heard: Heard, topic: str, level: int) -> None:
    heard.hear(0.5)
    heard.health.report()
    for count in (3, 2):
        heard.gate.arrivals[topic].refused += count
        heard.gate.arrivals[topic].reason = "nobody believes it"
        report = heard.health.report()
        assert (report.level, report.summary) == (level, f"{topic}: {count} refused, nobody believes it")
        assert report.values[f"{topic} reason"] == "nobody believes it"
    assert report.values[f"{topic} refused"] == 5
    assert report.values[f"{topic} messages"] == 25
    assert f"{LOAD} reason" not in report.values
    heard.now += 0.05
    values = heard.health.report().values
    assert values[f"{topic} age"] == pytest.approx(0.05)
    assert values["silence"] == pytest.approx(0.05)
    heard.hear(0.5, without=(LOAD,))
    assert heard.health.report().values["hook_load age"] == pytest.approx(0.55)


@pytest.mark.parametrize(("topic", "behind", "said"), [(PRESSURE, 0.3, True), (PRESSURE, 0.08, False)])
def test_stamps_that_are_behind_the_speeds_are_an_error_of_what_is_needed(
    heard: Heard, topic: str, behind: float, said: bool
) -> None:
    heard.hear(1.0, ahead=-behind)
    report = heard.health.report()
    assert (f"{topic}: its stamps are 0.3 s behind the speed's" in report.summary) is said
    assert report.level == (ERROR if said else OK)


def test_messages_that_come_after_their_speed_are_counted_anew_by_each_report(heard: Heard) -> None:
    heard.hear(1.0)
    heard.gate.arrivals[PRESSURE].after += 30
    assert "comes after the speed" in heard.health.report().summary
    for _ in range(2):
        heard.hear(0.4)  # twenty messages, none behind its speed
        assert "comes after the speed" not in heard.health.report().summary


def test_what_is_behind_or_ahead_is_told_by_its_worst_channel_beyond_its_own_limit(
    heard: Heard, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of channels that may be a tenth of a second old, and of a load that may be two."""
    heard.hear(0.1)
    gate, health = heard.gate, heard.health
    for ages, lag in (
        ({"motor_speed": 0.15, "shaft_angle": 0.5, "motor_torque": 0.09}, 0.5), ({"motor_speed": 0.12}, 0.12),
        ({"motor_speed": 0.09}, 0.0), ({"hook_load": 9.0}, 0.0),
    ):  # fmt: skip
        monkeypatch.setattr(gate, "ages", lambda ages=ages: ages)
        assert health._lag(SPEED) == lag
    stamps = {"motor_speed": 1000.4, "shaft_angle": 1000.7, "hook_load": 1001.5}
    monkeypatch.setattr(gate.hold, "stamp", lambda column, time: stamps.get(column, float("nan")))
    gate.last_stamp, gate.last_arrival = 1000.0, 70.0
    assert health._ahead(SPEED, 70.0) == pytest.approx(0.7)
    assert health._ahead(SPEED, 70.25) == pytest.approx(0.45)  # it came as much later
    assert health._ahead(SPEED, 69.0) == pytest.approx(0.7)
    assert health._ahead(SPEED, 70.65) == 0.0
    assert health._ahead(LOAD, 70.0) == 0.0


def test_no_silence_is_said_before_the_watchdogs_own_patience(heard: Heard) -> None:
    patient = InputHealth(heard.gate, heard.health._inputs, lambda: {PRESSURE}, lambda: heard.now, patience=0.7)
    assert [patient._limit(PRESSURE, needed) for needed in (True, False)] == [0.7, 0.7]
    assert patient._limit(LOAD, True) == 2.0
