"""What a callback raises is said once and ends nothing; speeds that come too late are dropped."""

import inspect
import signal
from types import SimpleNamespace

import pytest

from winch_friction.nodes import loop, run
from winch_friction.nodes.inputs import ROS, Inputs
from winch_friction.nodes.loop import Guarded, answered, said_aloud
from winch_friction.nodes.run import BAD_INPUT, Ending
from winch_friction.physics.errors import InputError
from winch_friction.records.topics import TopicMap, joint_state, stamp_header


class Node(Guarded):
    def __init__(self) -> None:
        self.logged: list[str] = []

    def get_logger(self) -> SimpleNamespace:
        return SimpleNamespace(error=self.logged.append)


def test_an_exception_ends_nothing_and_does_not_fill_the_log() -> None:
    node, called = Node(), []

    def callback(message: int, info: int) -> None:
        called.append(message)
        raise ZeroDivisionError("a defect")

    guarded = node.guarded(callback)
    for k in range(100):
        guarded(k, 0)
    assert len(called) == 100
    assert len(node.logged) == 1
    assert "a defect" in node.logged[0]
    assert list(inspect.signature(guarded).parameters) == ["message", "info"]


@pytest.mark.parametrize("error", [InputError("no"), OSError("no"), KeyError("no")])
def test_a_service_answers_whatever_happens(error: Exception) -> None:
    def action() -> str:
        raise error

    response = answered(action, SimpleNamespace())
    assert not response.success
    assert "no" in response.message


def test_of_speeds_that_waited_only_the_latest_are_obeyed() -> None:
    topics = TopicMap(groups=())
    source = topics.inputs[topics.speed_topic]
    waiting = [
        (joint_state(ROS, stamp_header(10.0 + 0.02 * k, ROS), "winch_motor", velocity=1.0), {}) for k in range(75)
    ]
    latest, every = (Inputs(None, SimpleNamespace(), print, age) for age in (0.1, float("inf")))
    assert len(latest._in_time(source, waiting)) in (5, 6)
    assert latest.late >= 69
    assert len(every._in_time(source, waiting)) == 75


@pytest.mark.parametrize(("before", "asked"), [(signal.SIG_DFL, True), (signal.SIG_IGN, False)])
def test_a_terminal_that_is_closed_is_an_end_but_not_under_nohup(before: signal.Handlers, asked: bool) -> None:
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    kept = {each: signal.getsignal(each) for each in numbers}
    try:
        signal.signal(signal.SIGHUP, before)
        ending = Ending()
        signal.raise_signal(signal.SIGHUP)
        assert ending.asked is asked
    finally:
        for each, handler in kept.items():
            signal.signal(each, handler)


@pytest.mark.parametrize(("good", "status"), [(True, 0), (False, 1)])
def test_defects_end_a_node_only_in_a_row(monkeypatch: pytest.MonkeyPatch, good: bool, status: int) -> None:
    """One a day would have ended it after three years of sailing."""
    turns = iter(range(10_000))

    class Turning:
        def __init__(self, node: object) -> None:
            self.node = node

        def once(self) -> None:
            turn = next(turns)
            ending.asked = turn > 3 * run.MOST_DEFECTS
            if turn % 2 or not good:
                raise RuntimeError("a defect of the executor")

        def end(self) -> None:
            self.node = None

    ending = SimpleNamespace(asked=False)
    monkeypatch.setattr(run, "Loop", Turning)
    monkeypatch.setattr(run.rclpy, "ok", lambda: True)
    assert run._spin(SimpleNamespace(report_defect=lambda where: None), ending) == status


def test_a_service_says_what_was_done_and_of_a_defect_what_it_was() -> None:
    response = answered(lambda: "", SimpleNamespace())
    assert (response.success, response.message) == (True, "")
    for error, said in ((InputError("no model"), "no model"), (OSError("no disk"), "no disk"),
                        (RuntimeError("oh"), "RuntimeError: oh")):  # fmt: skip
        assert raised(error).message == said


def raised(error: Exception) -> SimpleNamespace:
    def action() -> str:
        raise error

    return answered(action, SimpleNamespace())


def test_defects_are_counted_between_two_lines_of_the_log(monkeypatch: pytest.MonkeyPatch) -> None:
    node, now = Node(), [100.0]
    monkeypatch.setattr(loop.time, "monotonic", lambda: now[0])

    def failing() -> None:
        raise RuntimeError("oh")

    for at in (100.0, 100.5, 100.9, 101.0, 101.5, 102.1):
        now[0] = at
        node.guarded(failing)()
    assert [each.partition(":")[0] for each in node.logged] == [f"failing failed ({n} so far)" for n in (1, 4, 6)]


def test_a_transition_that_raises_is_said_by_its_name_and_raises_still() -> None:
    node = Node()

    @said_aloud
    def on_configure(node: Node, state: str) -> None:
        if state == "bad":
            raise RuntimeError("oh")

    assert on_configure(node, "good") is None
    with pytest.raises(RuntimeError, match="oh"):
        on_configure(node, "bad")
    assert len(node.logged) == 1
    assert node.logged[0].startswith("on_configure failed:")


@pytest.mark.parametrize(("configured", "activated", "ended", "status", "asked"), [
    ("SUCCESS", "SUCCESS", False, 0, ["configure", "activate"]),
    ("FAILURE", "SUCCESS", False, BAD_INPUT, ["configure"]),
    ("SUCCESS", "FAILURE", False, BAD_INPUT, ["configure", "activate"]),
    ("SUCCESS", "SUCCESS", True, 0, []),
])  # fmt: skip
def test_a_node_starts_as_far_as_it_comes(
    configured: str, activated: str, ended: bool, status: int, asked: list[str]
) -> None:
    calls: list[str] = []

    def transition(name: str, done: str) -> SimpleNamespace:
        calls.append(name)
        return SimpleNamespace(name=done)

    node = SimpleNamespace(
        options=SimpleNamespace(autostart=True), trigger_configure=lambda: transition("configure", configured),
        trigger_activate=lambda: transition("activate", activated),
    )  # fmt: skip
    assert run._start(node, SimpleNamespace(asked=ended)) == status
    assert calls == asked
    node.options.autostart = False
    assert run._start(node, SimpleNamespace(asked=False)) == 0
    assert calls == asked
    node.options.autostart = True
    ending = SimpleNamespace(asked=False)
    node.trigger_configure = lambda: setattr(ending, "asked", True) or transition("configure", "SUCCESS")
    assert run._start(node, ending) == 0
    assert calls == [*asked, "configure"]  # told to end meanwhile


def test_bad_input_is_one_line_a_problem_and_status_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run.rclpy, "try_shutdown", lambda: None)
    assert run._refuse(InputError("no  crane", "no model")) == 2
    assert run._refuse(RuntimeError("of\n two lines")) == 2
    assert capsys.readouterr().err.splitlines() == ["error: no crane", "error: no model", "error: of two lines"]


class Answering(Guarded):
    """A lifecycle node's part that is asked for transitions; `change` is the library's answer."""

    def __init__(self, change: object) -> None:
        self.logged: list[tuple[str, str]] = []
        self.steady_clock = None
        self._service_change_state = SimpleNamespace(callback=change)
        self._state_machine = SimpleNamespace(
            current_state=(2, "inactive"), available_transitions=[(3, "activate", 0, ""), (2, "cleanup", 0, "")]
        )
        self.answer_every_transition()

    def get_logger(self) -> SimpleNamespace:
        return SimpleNamespace(
            error=lambda text: self.logged.append(("error", text)),
            warning=lambda text, **_: self.logged.append(("warning", text)),
        )


@pytest.mark.parametrize(
    ("number", "label", "answered", "said"),
    [
        (3, "", True, []),
        (0, "activate", True, []),
        (2, "cleanup", True, []),
        (7, "", False, [("warning", "refused transition 7: not one of state 'inactive'")]),
        (3, "deactivate", False, [("warning", "refused transition deactivate: not one of state 'inactive'")]),
    ],
)
def test_a_transition_is_asked_for_by_its_name_or_else_its_number(
    number: int, label: str, answered: bool, said: list[tuple[str, str]]
) -> None:
    asked: list[object] = []
    node = Answering(lambda request, response: asked.append(request) or response)
    request = SimpleNamespace(transition=SimpleNamespace(id=number, label=label))
    response = node._service_change_state.callback(request, SimpleNamespace(success=True))
    assert (response.success, asked, node.logged) == (answered, [request] if answered else [], said)


def test_a_transition_that_the_library_raises_on_is_refused() -> None:
    def raises(request: object, response: object) -> None:
        raise RuntimeError("oh")

    node = Answering(raises)
    request = SimpleNamespace(transition=SimpleNamespace(id=3, label="activate"))
    response = node._service_change_state.callback(request, SimpleNamespace(success=True))
    assert not response.success
    assert node.logged == [("error", "refused transition 'activate': oh")]


@pytest.mark.parametrize(
    ("ready", "found"), [((), False), (("timer",), True), (("service",), True), (("client",), True),
                         (("subscription",), False), (("guard_condition",), False)]
)  # fmt: skip
def test_timers_services_and_clients_wake_a_node(ready: tuple[str, ...], found: bool) -> None:
    waiting = SimpleNamespace(get_ready_entities=lambda kind: [1] if kind in ready else [])
    assert loop._ready(waiting) is found


def test_a_message_goes_with_its_info_and_none_goes_nowhere() -> None:
    class Handle:
        def __enter__(self) -> None: ...
        def __exit__(self, *_: object) -> None: ...
        def take_message(self, kind: object, raw: bool) -> object:
            return left.pop(0)

    left, heard = [("message", "info"), None], []
    speed = SimpleNamespace(handle=Handle(), msg_type=None, raw=False, callback=lambda *of: heard.append(of))
    loop._take(speed), loop._take(speed)
    assert heard == [("message", "info")]
    assert loop._speed(SimpleNamespace()) is None
    assert loop._speed(SimpleNamespace(inputs=SimpleNamespace(speed=speed))) is speed


# -- from the beginning to the end of a process
class Library:
    """rclpy as far as a process begins and ends it; `refuses` are what its first beginnings raise."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *refuses: Exception) -> None:
        self.calls: list[object] = []
        self.refuses = list(refuses)
        monkeypatch.setattr(run.rclpy, "init", self.init)
        monkeypatch.setattr(run.rclpy, "try_shutdown", lambda: self.calls.append("shutdown"))
        monkeypatch.setattr(run, "get_default_context", lambda shutting_down: self.calls.append("another context"))

    def init(self, args: list[str] | None, signal_handler_options: object) -> None:
        assert signal_handler_options == run.SignalHandlerOptions.NO
        self.calls.append(args)
        if self.refuses:
            raise self.refuses.pop(0)


def test_a_process_that_cannot_write_its_log_begins_without_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    library = Library(monkeypatch, RuntimeError("failed to initialize logging: no\n space, at ./src/rcl.c:1"))
    run._begin(["node", "--x"])
    assert library.calls == [
        ["node", "--x"],
        "another context",
        ["node", "--x", "--ros-args", "--disable-external-lib-logs"],
    ]
    assert capsys.readouterr().err == (
        "warning: no log file is kept (failed to initialize logging: no space); set ROS_LOG_DIR to a folder that can "
        "be written\n"
    )
    monkeypatch.setattr(run.sys, "argv", ["own"])
    library.refuses.append(RuntimeError("initialize logging"))
    run._begin(None)
    assert library.calls[-1] == ["own", "--ros-args", "--disable-external-lib-logs"]
    library.refuses.append(RuntimeError("another"))
    with pytest.raises(RuntimeError, match="another"):
        run._begin([])


@pytest.mark.parametrize(("started", "spun", "status"), [(0, 0, 0), (BAD_INPUT, 0, BAD_INPUT), (0, 1, 1)])
def test_a_node_is_ended_whatever_became_of_it(
    monkeypatch: pytest.MonkeyPatch, started: int, spun: int, status: int
) -> None:
    library, ending = Library(monkeypatch), SimpleNamespace(asked=False)
    node = SimpleNamespace(
        end=lambda: library.calls.append("end"), destroy_node=lambda: library.calls.append("destroy"),
        get_logger=lambda: SimpleNamespace(warning=library.calls.append),
    )  # fmt: skip
    monkeypatch.setattr(run, "overruled", lambda node, given: [f"no effect: {' '.join(given)}"])
    monkeypatch.setattr(run, "_start", lambda *of: library.calls.append("start") or started)
    monkeypatch.setattr(run, "_spin", lambda *of: library.calls.append("spin") or spun)
    assert run._run(lambda: node, ("a", "--ros-args"), ending) == status
    assert library.calls == [
        ["a", "--ros-args"],
        "no effect: a --ros-args",
        "start",
        *([] if started else ["spin"]),
        "end",
        "destroy",
        "shutdown",
    ]
    assert not node.told_to_end()
    ending.asked = True
    assert node.told_to_end()


@pytest.mark.parametrize(
    ("error", "status"),
    [(InputError("no crane"), 2), (run.rclpy.exceptions.ROSInterruptException(), 0),
     (run.rclpy.exceptions.InvalidParameterException("p"), 2), (ZeroDivisionError("a defect"), None)],
)  # fmt: skip
def test_a_node_that_cannot_be_made_is_one_line_unless_that_is_a_defect(
    monkeypatch: pytest.MonkeyPatch, error: Exception, status: int | None
) -> None:
    Library(monkeypatch)

    def make() -> None:
        raise error

    if status is None:
        with pytest.raises(ZeroDivisionError):
            run._run(make, ("node",), SimpleNamespace(asked=False))
    else:
        assert run._run(make, ("node",), SimpleNamespace(asked=False)) == status
