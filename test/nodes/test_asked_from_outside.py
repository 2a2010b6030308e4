"""What is asked of another node, and what is made of its answers."""

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import GetParameters, SetParameters
from std_srvs.srv import SetBool, Trigger

from winch_friction.nodes import doctor
from winch_friction.nodes import load as of_load
from winch_friction.nodes import remote as of_remote
from winch_friction.nodes.load import handed_over
from winch_friction.nodes.remote import CHANGING, QUESTIONS, RemoteNode
from winch_friction.physics.errors import InputError


class Asked(RemoteNode):
    """A remote node whose calls are noted and answered by `answers` service -> list of answers."""

    def __init__(self, **answers: list[Any]) -> None:
        super().__init__(None, None, "compensator", 1.0)
        self.answers, self.calls = answers, []

    def _call(self, service_type: Any, service: str, request: Any) -> Any:
        self.calls.append((service_type, service, request))
        return self.answers[service].pop(0)


def state(label: str) -> Any:
    return SimpleNamespace(current_state=SimpleNamespace(label=label))


def done(success: bool, message: str = "") -> Any:
    return SimpleNamespace(success=success, message=message)


def test_transitions_are_asked_for_by_number_after_the_state_was_answered() -> None:
    node = Asked(get_state=[state("unconfigured")], change_state=[done(True)] * 4)
    node.change("configure", "activate", "deactivate", "cleanup")
    assert [(kind, service) for kind, service, _ in node.calls] == [
        (GetState, "get_state"), *[(ChangeState, "change_state")] * 4,
    ]  # fmt: skip
    assert [request.transition.id for _, _, request in node.calls[1:]] == [
        Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE, Transition.TRANSITION_DEACTIVATE,
        Transition.TRANSITION_CLEANUP,
    ]  # fmt: skip


def test_a_refused_transition_is_named_and_none_is_asked_for_after_it() -> None:
    node = Asked(get_state=[state("inactive")], change_state=[done(True), done(False), done(True)])
    with pytest.raises(InputError, match="^compensator: refused to activate; its log says why$"):
        node.change("configure", "activate", "deactivate")
    assert len(node.calls) == 3


def test_parameters_are_set_together_and_the_refused_one_is_named() -> None:
    taken, refused = SimpleNamespace(successful=True, reason=""), SimpleNamespace(successful=False, reason="too large")
    node = Asked(set_parameters=[SimpleNamespace(results=each) for each in ([taken, taken], [taken, refused])])
    node.set({"scale": 1.0, "crane": "mine"})
    ((kind, _, request),) = node.calls
    assert kind is SetParameters
    assert [(each.name, each.value.double_value, each.value.string_value) for each in request.parameters] == [
        ("scale", 1.0, ""), ("crane", 0.0, "mine"),
    ]  # fmt: skip
    with pytest.raises(InputError, match="^compensator: parameter 'slew': too large$"):
        node.set({"scale": 1.0, "slew": 9.0})


@pytest.mark.parametrize("on", [True, False])
def test_a_switch_is_set_as_asked_and_its_words_come_back(on: bool) -> None:
    node = Asked(enable=[done(True, "as you wish"), done(False, "not active")])
    assert node.switch("enable", on) == "as you wish"
    kind, _, request = node.calls[0]
    assert (kind, request.data) == (SetBool, on)
    with pytest.raises(InputError, match="^compensator: enable: not active$"):
        node.switch("enable", on)


def test_a_trigger_says_what_was_done_or_why_not_and_a_parameter_is_asked_by_name() -> None:
    node = Asked(
        reset=[done(True, ""), done(False, "not active")], get_parameters=[SimpleNamespace(values=["first", "another"])]
    )
    assert node.trigger("reset") == ""
    assert node.calls[0][0] is Trigger
    with pytest.raises(InputError, match="^compensator: reset: not active$"):
        node.trigger("reset")
    assert node.get("scale") == "first"
    kind, _, request = node.calls[-1]
    assert (kind, request.names) == (GetParameters, ["scale"])


class Client:
    """A service that answers the `after`-th question; `left` are questions still open."""

    def __init__(self, after: int, there: bool = True) -> None:
        self.after, self.there, self.asked, self.left, self.waits = after, there, 0, 0, []

    def wait_for_service(self, timeout_sec: float) -> bool:
        self.waits.append(timeout_sec)
        return self.there

    def call_async(self, request: Any) -> Any:
        self.asked += 1
        self.left += 1
        number = self.asked
        return SimpleNamespace(done=lambda: number >= self.after, result=lambda: ("answer", number))

    def remove_pending_request(self, future: Any) -> None:
        self.left -= 1

    def spin_until_future_complete(self, future: Any, timeout_sec: float) -> None:
        self.waits.append(timeout_sec)


def remote(client: Client, made: list[str]) -> RemoteNode:
    node = SimpleNamespace(create_client=lambda kind, name: made.append(name) or client)
    return RemoteNode(node, client, "compensator", 12.0)


def test_a_question_is_asked_again_within_the_same_patience_and_by_one_client() -> None:
    client, made = Client(after=3), []
    node = remote(client, made)
    assert node._call(None, "get_state", None) == ("answer", 3)
    assert client.waits == [12.0, *[12.0 / QUESTIONS] * 3]
    assert client.left == 1  # the answered one
    node._call(None, "get_state", None)
    node._call(None, "get_parameters", None)
    assert made == ["compensator/get_state", "compensator/get_parameters"]


@pytest.mark.parametrize("service", CHANGING)
def test_what_changes_a_node_has_all_the_patience_at_once(service: str) -> None:
    client = Client(after=2)
    with pytest.raises(InputError, match=f"^compensator: no answer from {service} within 12 s$"):
        remote(client, [])._call(None, service, None)
    assert (client.asked, client.left, client.waits) == (1, 0, [12.0, 12.0])


def test_what_changes_a_node_is_known_by_name() -> None:
    assert set(CHANGING) == {"change_state", "set_parameters", "enable", "reset", "save", "load_model"}


def test_a_node_that_is_not_there_is_asked_nothing() -> None:
    client = Client(after=1, there=False)
    with pytest.raises(InputError, match="^compensator: not there after 12 s; did it start"):
        remote(client, [])._call(None, "get_state", None)
    assert client.asked == 0


# -- a model file handed over
class Parameters:
    """A node with a model and a file of terms; `load_model` fails where `refuses`."""

    def __init__(self, refuses: bool = False, unset: bool = False) -> None:
        self.values, self.calls = {"model_file": "old", "terms_file": "mine.py"}, []
        self.refuses, self.unset = refuses, unset

    def get(self, name: str) -> Any:
        return SimpleNamespace(string_value=self.values[name])

    def set(self, values: dict[str, str]) -> None:
        if self.unset:
            raise InputError("no parameter")
        self.calls.append(dict(values))
        self.values |= values

    def trigger(self, service: str) -> str:
        self.calls.append(service)
        if self.refuses:
            raise InputError("no model")
        return f"in use: {self.values['model_file']}"


@pytest.mark.parametrize(
    ("terms", "wanted"), [("", {"model_file": "new"}), ("new.py", {"model_file": "new", "terms_file": "new.py"})]
)
def test_a_model_is_loaded_after_it_was_named_and_the_terms_only_where_some_are(
    terms: str, wanted: dict[str, str]
) -> None:
    node = Parameters()
    assert handed_over(node, "new", terms) == "in use: new"
    assert node.calls == [wanted, "load_model"]
    assert node.values["terms_file"] == (terms or "mine.py")


def test_a_refused_model_leaves_every_parameter_as_it_was() -> None:
    for terms in ("", "new.py"):
        node = Parameters(refuses=True)
        with pytest.raises(InputError, match="no model"):
            handed_over(node, "new", terms)
        assert node.values == {"model_file": "old", "terms_file": "mine.py"}
    node = Parameters(unset=True)
    with pytest.raises(InputError, match="no parameter"):
        handed_over(node, "new")
    assert node.calls == []


# -- the doctor
@pytest.mark.parametrize(("heard", "said", "status"), [(0.25, "0.25", 0), (0.0, "0.0", 0), (None, "nothing", 1)])
def test_the_doctor_says_the_seconds_or_that_nothing_was_heard(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], heard: float | None, said: str, status: int
) -> None:
    monkeypatch.setattr(doctor, "seconds_to_hear", lambda: heard)
    assert doctor.main() == status
    assert capsys.readouterr().out.strip() == said


@pytest.mark.parametrize(
    ("refusal", "out", "err", "status"), [(None, "in use", "", 0), ("no model", "", "no model", 2)]
)
def test_a_model_that_is_loaded_is_said_and_a_refused_one_is_status_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], refusal: str | None, out: str, err: str,
    status: int,
) -> None:  # fmt: skip
    ended: list[str] = []

    def hand_over(remote: RemoteNode, model: str, terms_file: str) -> str:
        assert (remote.name, remote._patience, model, terms_file) == ("other", of_load.PATIENCE, "m.yaml", "t.py")
        if refusal:
            raise InputError(refusal)
        return "in use"

    executor = SimpleNamespace(add_node=lambda node: None, shutdown=lambda: ended.append("executor"))
    node = SimpleNamespace(destroy_node=lambda: ended.append("node"))
    monkeypatch.setattr(of_load, "looking_on", lambda name, namespace: ended.append(namespace) or node)
    monkeypatch.setattr(of_load, "SingleThreadedExecutor", lambda: executor)
    monkeypatch.setattr(of_load.rclpy, "try_shutdown", lambda: ended.append("context"))
    monkeypatch.setattr(of_load, "handed_over", hand_over)
    given = ["load", "m.yaml", "--terms-file", "t.py", "--namespace", "port", "--node", "other"]
    monkeypatch.setattr("sys.argv", given)
    assert of_load.main() == status
    said = capsys.readouterr()
    assert (said.out.strip(), said.err.strip()) == (out, err)
    assert ended == ["port", "executor", "node", "context"]


@pytest.mark.parametrize(("namespace", "looked"), [("", "/"), ("port", "/port"), ("/port", "/port")])
def test_a_namespace_is_looked_at_as_a_whole_before_anything_begins(
    monkeypatch: pytest.MonkeyPatch, namespace: str, looked: str
) -> None:
    calls: list[Any] = []
    monkeypatch.setattr(of_remote, "validate_namespace", lambda name: calls.append(name))
    monkeypatch.setattr(of_remote.rclpy, "init", lambda args: calls.append("init"))
    monkeypatch.setattr(of_remote.rclpy, "create_node", lambda name, **given: calls.append((name, given)) or "a node")
    assert of_remote.looking_on("watch", namespace) == "a node"
    assert calls == [looked, "init", ("watch", {"namespace": namespace, "start_parameter_services": False})]


def test_what_rclpy_refuses_is_one_line_and_a_defect_of_ours_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[int] = []
    monkeypatch.setattr(of_remote.rclpy, "try_shutdown", lambda: ended.append(1))
    with pytest.raises(InputError, match="Invalid namespace") as refused:
        of_remote.looking_on("watch", "a b")
    assert "\n" not in str(refused.value)
    assert not str(refused.value).endswith("^")
    assert ended == [1]

    def defect(name: str) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(of_remote, "validate_namespace", defect)
    with pytest.raises(ZeroDivisionError):
        of_remote.looking_on("watch", "")
    assert ended == [1]
