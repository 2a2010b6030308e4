"""Files that take long to read hold up no torque: a real compensator over DDS, in mid-wave."""

import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from dds_bench import Bench, diagnostics, efforts
from diagnostic_msgs.msg import DiagnosticArray
from own_term_files import own_model, own_terms
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

# s between two outputs: a thread that parses has the interpreter now and then, on a machine that tests share; the
# reading takes seconds, and on a machine with much else to do both take longer
LONGEST_PAUSE, LONGEST_SHARE = 0.5, 0.25


def asked(bench: Bench, name: str, kind: type, request: object) -> Callable[[], object]:
    """A service that was asked; its answer once it is there."""
    client = bench.node.create_client(kind, f"compensator/{name}")
    assert client.wait_for_service(10.0)
    future = client.call_async(request)
    return lambda: future.result() if future.done() else None


def set_files(bench: Bench, **files: Path) -> None:
    parameters = [Parameter(name, value=str(path)).to_parameter_msg() for name, path in files.items()]
    answer = asked(bench, "set_parameters", SetParameters, SetParameters.Request(parameters=parameters))
    bench.drive(0.5)
    assert all(each.successful for each in answer().results)


@pytest.mark.parametrize("slow", ["terms that import for seconds", "a model of megabytes"])
def test_the_torque_goes_on_while_a_file_is_read(bench: Bench, tmp_path: Path, slow: str) -> None:
    bench.start("compensator", ramp_time=0.3)
    heard: list[tuple[float, float]] = []
    torque = bench.listen("compensator/friction_torque")
    said = bench.listen("/diagnostics", DiagnosticArray, 10)
    bench.announce()
    bench.drive(1.0)
    if slow == "terms that import for seconds":
        terms, model = own_terms(tmp_path), own_model(tmp_path)
        terms.write_text("import time\ntime.sleep(1.5)\n" + terms.read_text())
        set_files(bench, terms_file=terms, model_file=model)
    else:
        large = tmp_path / "large.yaml"
        large.write_text("terms: [" + "1, " * 60_000 + "1]\n")
        set_files(bench, model_file=large)
    answer = asked(bench, "load_model", Trigger, Trigger.Request())
    began, count = time.monotonic(), len(torque)
    while answer() is None and time.monotonic() - began < 12.0:
        bench.drive(0.02)
        heard += [(time.monotonic(), each) for each in efforts(torque)[count:]]
        count = len(torque)
    lasted = time.monotonic() - began
    assert answer() is not None
    assert lasted > 1.0  # what it is about
    times = [began, *(each for each, _ in heard)]
    assert max(b - a for a, b in zip(times[:-1], times[1:], strict=True)) < max(LONGEST_PAUSE, LONGEST_SHARE * lasted)
    assert len({each for _, each in heard}) > 0.5 * lasted / 0.02  # it followed the wave
    bench.drive(1.2)
    accepted = answer().success
    assert accepted == (slow == "terms that import for seconds"), answer().message
    assert diagnostics(said, "feedforward")["model"] == ("repaired" if accepted else "a6vm215_crane2")


def test_the_last_ramp_waits_for_no_file(bench: Bench, tmp_path: Path) -> None:
    """SIGTERM while a model was read: the torque was followed for up to 4 s more; whoever ends a process waits 5."""
    bench.start("compensator", ramp_time=0.3)
    torque = bench.listen("compensator/friction_torque")
    bench.announce()
    bench.drive(1.0)
    terms, model = own_terms(tmp_path), own_model(tmp_path)
    terms.write_text("import time\ntime.sleep(3.5)\n" + terms.read_text())
    set_files(bench, terms_file=terms, model_file=model)
    asked(bench, "load_model", Trigger, Trigger.Request())
    bench.drive(0.5)
    assert abs(efforts(torque)[-1]) > 0.0
    process, told = bench.processes["compensator"], time.monotonic()
    process.send_signal(signal.SIGTERM)
    while process.poll() is None and time.monotonic() - told < 6.0:
        bench.drive(0.05)
    assert time.monotonic() - told < 2.5  # the reading takes 3 s more
    assert process.poll() == 0
    assert efforts(torque)[-1] == 0.0
    assert "Traceback" not in bench.log("compensator")
