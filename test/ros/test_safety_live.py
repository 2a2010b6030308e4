"""What may not end a node, and how a node that ends leaves the torque: real processes over DDS."""

import math
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from dds_bench import CRANE, Bench, diagnostics, efforts
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from winch_friction.nodes.inputs import pressure_message
from winch_friction.nodes.qos import LATCHED, OUTPUT, SENSOR, fresh
from winch_friction.online.compensator import read_mark
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Sample
from winch_friction.records.topics import crane_topics

SLEW = 1.5e4  # N m/s, the compensator's own limit


@pytest.fixture
def fed(bench: Bench) -> tuple[Bench, list]:
    """A compensator that has faded in, its diagnostics at their usual rate."""
    bench.start("compensator", ramp_time=0.3)
    torque = bench.listen("compensator/friction_torque")
    bench.announce()
    bench.drive(1.0)
    assert abs(efforts(torque)[-1]) > 50.0
    return bench, torque


# whoever starts the tests by nohup has SIGHUP ignored, the nodes inherit that, and rightly do not end
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def alive(bench: Bench, name: str = "compensator") -> bool:
    return bench.processes[name].poll() is None


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_the_last_message_of_a_process_is_zero(fed: tuple[Bench, list], number: signal.Signals) -> None:
    bench, torque = fed
    at_work = efforts(torque)[-1]
    bench.processes["compensator"].send_signal(number)
    bench.spin(3.0, lambda: not alive(bench) and efforts(torque)[-1] == 0.0)
    said = efforts(torque)
    assert said[-1] == 0.0
    assert bench.processes["compensator"].wait(5.0) == 0
    assert not read_mark(torque[-1].header.frame_id)[0]
    ramp = said[max(k for k, each in enumerate(said) if each == at_work) :]
    assert len(ramp) >= 3  # not a step
    assert max(abs(b - a) for a, b in zip(ramp[:-1], ramp[1:], strict=True)) < 0.5 * abs(at_work)


def test_transitions_that_there_are_not_are_answered(fed: tuple[Bench, list]) -> None:
    bench, torque = fed
    node = bench.remote("compensator")
    assert node.state() == "active"
    client = bench.node.create_client(ChangeState, "compensator/change_state")
    assert client.wait_for_service(5.0)
    ids = (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE, Transition.TRANSITION_CLEANUP, 200)
    for number in ids:
        future = client.call_async(ChangeState.Request(transition=Transition(id=number)))
        bench.executor.spin_until_future_complete(future, timeout_sec=5.0)
        assert not future.result().success
    assert node.state() == "active"
    bench.drive(0.6)
    assert abs(efforts(torque)[-1]) > 0.0
    node.change("deactivate")
    bench.spin(0.3)
    assert efforts(torque)[-1] == 0.0
    node.change("activate")
    assert alive(bench)


def test_hostile_models_neither_end_nor_hold_up_the_node(fed: tuple[Bench, list]) -> None:
    bench, torque = fed
    models = bench.node.create_publisher(String, "friction_model", LATCHED)
    bench.spin(3.0, lambda: models.get_subscription_count() > 0)
    before = len(torque)
    for text in ("[" * 20_000, "x: [" * 900, "a: b\n" * 400_000, "terms: &a [*a]", "\0", "- " * 5000):
        models.publish(String(data=text))
        bench.drive(0.3)
    assert alive(bench)
    stamps = [each.header.stamp.sec + 1e-9 * each.header.stamp.nanosec for each in torque[before:]]
    # 2.5 s when they were parsed in line; 0.05 s on a quiet machine, 0.6 s on one that has much else to do
    assert max(b - a for a, b in zip(stamps[:-1], stamps[1:], strict=True)) < 1.2
    assert bench.says("compensator", "model refused")


def test_diagnostics_tell_the_truth_within_a_second(fed: tuple[Bench, list]) -> None:
    bench, _ = fed
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    bench.drive(1.2)
    inputs = diagnostics(seen, "compensator: inputs")
    for topic in crane_topics(CRANE).inputs:
        assert {f"{topic} rate", f"{topic} age", f"{topic} publishers", f"{topic} plausible"} <= set(inputs), topic
    assert inputs["winch/reference publishers"] == "1"
    bench.spin(0.8)
    assert _level(seen, "compensator: inputs") == 2
    assert "winch/joint_states: silent" in diagnostics(seen, "compensator: inputs")["message"]
    assert _level(seen, "compensator: feedforward") == 2
    bench.time += 0.8
    second = bench.node.create_publisher(JointState, "winch/reference", OUTPUT)
    bench.drive(1.0)
    assert "winch/reference: 2 publishers" in diagnostics(seen, "compensator: inputs")["message"]
    bench.node.destroy_publisher(second)
    bench.time += 0.2
    bench.drive(1.2, held_behind(bench, bench.time))
    assert "winch/active/pressure_a: its stamps are " in diagnostics(seen, "compensator: inputs")["message"]
    bench.remote("compensator").change("deactivate")
    bench.spin(0.3)
    assert diagnostics(seen, "compensator: feedforward")["message"] == "not active"


@pytest.mark.parametrize(
    ("node", "part", "topic", "kind", "qos"),
    [
        ("compensator", "feedforward", "/compensator/friction_torque", JointState, OUTPUT),
        ("estimator", "filter", "/friction_model", String, LATCHED),
    ],
)
def test_a_second_node_on_the_same_output_is_said(
    bench: Bench, node: str, part: str, topic: str, kind: type, qos: object
) -> None:
    bench.start(node)
    seen = bench.listen("/diagnostics", DiagnosticArray)
    bench.announce()
    bench.drive(1.2)
    assert "publishers" not in diagnostics(seen, f"{node}: {part}")["message"]
    second = bench.node.create_publisher(kind, topic, qos)
    bench.drive(1.5)
    assert f"{topic} has 2 publishers: does another {node} run?" in diagnostics(seen, f"{node}: {part}")["message"]
    assert _level(seen, f"{node}: {part}") == 2
    bench.node.destroy_publisher(second)
    bench.drive(1.5)
    assert "publishers" not in diagnostics(seen, f"{node}: {part}")["message"]


def held_behind(bench: Bench, stamp: float) -> Callable[[Sample], None]:
    """A pressure that goes on to come, under a stamp that stands still."""

    def change(sample: Sample) -> None:
        sample.groups["active"].pressure_a = math.nan
        bench.publisher("winch/active/pressure_a").publish(pressure_message(stamp, 100e5))

    return change


def _level(messages: list[DiagnosticArray], part: str) -> int:
    for message in reversed(messages):
        for status in message.status:
            if status.name.endswith(part):
                return status.level[0]
    raise AssertionError(f"nothing said of {part}")


def test_an_estimator_without_a_pressure_says_that_it_waits(bench: Bench, tmp_path: Path) -> None:
    bench.start("estimator", diagnostics_period=0.2, checkpoint=Path("/proc/nothing/here.json"))
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    bench.announce()
    bench.drive(0.6)

    def lose(sample: object) -> None:
        sample.groups["active"].pressure_a = math.nan

    bench.drive(0.8, lose)
    assert "waiting for active.pressure_a" in diagnostics(seen, "estimator: filter")["message"]
    assert "winch/active/pressure_a: silent" in diagnostics(seen, "estimator: inputs")["message"]
    with pytest.raises(InputError, match="save"):
        bench.remote("estimator").trigger("save")
    assert alive(bench, "estimator")
    assert bench.stop("estimator") == 0


def test_a_terms_file_cannot_end_the_process(bench: Bench, tmp_path: Path) -> None:
    bench.start("compensator", autostart=False)
    node = bench.remote("compensator")
    ways = ("import sys\nsys.exit(3)\n", "raise KeyboardInterrupt\n", "class Mine(BaseException): ...\nraise Mine\n")
    for number, text in enumerate(ways):
        file = tmp_path / f"mine_{number}.py"
        file.write_text(text)
        node.set({"terms_file": str(file)})
        with pytest.raises(InputError, match="refused to configure"):
            node.change("configure")
        assert node.state() == "unconfigured"
        assert bench.says("compensator", f"{file}: ")
    assert bench.says("compensator", "sys.exit")


def test_quality_of_service_of_one_topic_stays_its_own(bench: Bench) -> None:
    override = "qos_overrides./winch/joint_states.subscription"
    bench.start("compensator", **{f"{override}.reliability": "reliable", f"{override}.depth": 7})
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    bench.announce()
    for topic in ("/winch/reference", "/winch/active/pressure_a"):
        (info,) = bench.node.get_subscriptions_info_by_topic(topic)
        assert info.qos_profile.reliability.name == "BEST_EFFORT", topic
    bench.node.create_publisher(JointState, "winch/joint_states", fresh(SENSOR))
    bench.spin(2.5)
    assert "1 of 2 publishers do not match" in diagnostics(seen, "compensator: inputs")["message"]


@pytest.mark.parametrize("after", [0.3, 1.0, 2.0])
def test_an_interrupt_during_the_start_is_a_clean_end(after: float) -> None:
    command = [sys.executable, "-m", "winch_friction.nodes.compensator"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    time.sleep(after)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=20.0)
    assert "Traceback" not in said
    assert process.returncode in (0, -signal.SIGINT)


@pytest.fixture
def sailing(bench: Bench) -> tuple[Bench, list, Callable[..., None]]:
    """A simulator in real time, fed by the test, and what it applies."""
    bench.start("simulator", scenario="ahc_irregular", rate=1.0, seed=3)
    truth = bench.listen("simulator/truth")
    torque = bench.node.create_publisher(JointState, "compensator/friction_torque", OUTPUT)
    assert bench.spin(90.0, lambda: torque.get_subscription_count() > 0 and len(truth) > 5)

    def feed(seconds: float, *effort: float) -> None:
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            torque.publish(JointState(name=["winch_motor"], effort=list(effort)))
            bench.spin(0.02)

    return bench, truth, feed


def test_the_consumer_lets_an_old_torque_go_and_takes_no_nonsense(
    sailing: tuple[Bench, list, Callable[..., None]],
) -> None:
    bench, truth, feed = sailing
    feed(0.6, 300.0)
    assert truth[-1].effort[1] == pytest.approx(300.0)
    feed(0.05)  # an empty array
    feed(0.05, math.nan)
    assert alive(bench, "simulator")
    feed(0.2, 300.0)
    bench.spin(1.0)  # the compensator is gone
    assert truth[-1].effort[1] == 0.0
    applied = [each.effort[1] for each in truth]
    assert all(map(math.isfinite, applied))
    assert max(abs(b - a) for a, b in zip(applied[-60:-1], applied[-59:], strict=True)) < 100.0


def test_two_loops_in_two_namespaces_have_a_clock_each(bench: Bench) -> None:
    """As `ahc_simulation.launch.py` starts them."""
    arguments = ("-r", "__ns:=/north", "-r", "/clock:=clock")
    bench.start("simulator", *arguments, name="north_simulator", rate=1.0)
    bench.start("compensator", *arguments, name="north", use_sim_time=True, ramp_time=0.3, watchdog_timeout=5.0)
    own, common = bench.listen("north/clock", Clock), bench.listen("/clock", Clock)
    torque = bench.listen("north/compensator/friction_torque")
    assert bench.spin(90.0, lambda: len(torque) > 100 and bool(own))
    assert not common
    assert bench.node.count_publishers("/clock") == 0


def test_the_estimators_torque_does_not_stand_while_an_input_is_lost(bench: Bench) -> None:
    """It repeated the last one for as long as the pressures stayed away: of one direction, through every wave."""
    bench.start("estimator")
    learned = bench.listen("estimator/friction_torque")
    bench.announce()
    bench.drive(1.5)
    assert abs(learned[-1].effort[0]) > 50.0
    assert learned[-1].header.frame_id.startswith("valid")
    before = len(learned)

    def without_pressures(sample: Sample) -> None:
        for group in sample.groups.values():
            group.pressure_a = group.pressure_b = math.nan

    bench.drive(1.0, without_pressures)
    after = learned[before + 15 :]
    assert len(after) > 10
    assert efforts(after) == [0.0] * len(after)
    assert {each.header.frame_id.split()[0] for each in after} == {"invalid"}


def test_a_slew_limit_that_cannot_let_go_is_refused_when_it_is_set(fed: tuple[Bench, list]) -> None:
    """The parameter said 500, the law kept 15 000 with a traceback, and every setting after that was ignored."""
    bench, torque = fed
    node = bench.remote("compensator")
    assert abs(efforts(torque)[-1]) > 150.0
    with pytest.raises(InputError, match="cannot let go of"):
        node.set({"slew_limit": 500.0})
    with pytest.raises(InputError, match="load 400000 kg is more than this crane can have"):
        node.set({"load": 400e3})
    node.set({"scale": 0.3})
    bench.drive(1.5)
    assert "Traceback" not in bench.log("compensator")
    assert 10.0 < max(map(abs, efforts(torque)[-20:])) < 250.0
    node.set({"scale": 0.0})
    bench.drive(1.5)
    node.set({"slew_limit": 500.0})
