"""Whether this machine's middleware carries a message, as `winch-friction doctor` asks."""

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import doctor
from winch_friction.records.domain import unused_domain


def test_a_machine_that_carries_messages_hears_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(unused_domain()))
    heard = doctor.seconds_to_hear()
    assert heard is not None
    assert 0.0 < heard < 5.0


@pytest.mark.parametrize(("heard", "printed", "status"), [(0.25, "0.25", 0), (0.0, "0.0", 0), (None, "nothing", 1)])
def test_what_is_heard_is_printed_and_silence_is_a_failure(
    heard: float | None, printed: str, status: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(doctor, "seconds_to_hear", lambda: heard)
    assert doctor.main() == status
    assert capsys.readouterr().out == f"{printed}\n"
