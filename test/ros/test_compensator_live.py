"""The compensator node against a probe that publishes a swell."""

import math
from pathlib import Path

import pytest
from dds_bench import Bench, diagnostics, efforts, stamps
from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from winch_friction.nodes.inputs import clock_message
from winch_friction.nodes.qos import LATCHED
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.signals import Sample
from winch_friction.records.model_file import load_model, model_to_text, save_model
from winch_friction.records.topics import stamp_time

NAN = float("nan")


@pytest.fixture
def fed(bench: Bench) -> tuple[Bench, list]:
    """A compensator that has faded in."""
    bench.start("compensator", ramp_time=0.3, diagnostics_period=0.2)
    torque = bench.listen("compensator/friction_torque")
    bench.announce()
    bench.drive(1.0)
    return bench, torque


def test_stale_inputs_ramp_to_zero_and_back_without_a_bump(fed: tuple[Bench, list]) -> None:
    bench, torque = fed
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    assert abs(efforts(torque)[-1]) > 100.0
    bench.spin(0.8)
    bench.time += 0.8
    silent = efforts(torque)
    assert silent[-1] == 0.0
    assert diagnostics(seen, "feedforward")["state"] == "stale"
    largest = max(abs(b - a) for a, b in zip(silent[-20:-1], silent[-19:], strict=True))
    assert largest < 0.6 * max(map(abs, silent))  # a ramp, not a step
    before = len(torque)
    bench.drive(1.0)
    back = efforts(torque)[before:]
    assert abs(back[-1]) > 100.0
    # a reversal alone changes the torque by 20 of its peak a second (the sign is spread over 0.05 s of acceleration),
    # the ramp by 3.3 of it: 0.47 of the peak a sample; a bump would be the whole of it
    assert max(abs(b - a) for a, b in zip(back[:-1], back[1:], strict=True)) < 0.5 * max(map(abs, back))
    assert diagnostics(seen, "feedforward")["state"] in ("active", "fading")


def test_a_lost_pressure_alone_ramps_to_zero(fed: tuple[Bench, list]) -> None:
    bench, torque = fed

    def lose(sample: Sample) -> None:
        sample.groups["active"].pressure_a = NAN  # NaN stays out: the topic falls silent

    bench.drive(0.8, lose)
    assert efforts(torque)[-1] == 0.0
    bench.drive(0.8)
    assert abs(efforts(torque)[-1]) > 0.0


def test_nan_never_leaves_the_node(fed: tuple[Bench, list]) -> None:
    bench, torque = fed

    def poison(sample: Sample) -> None:
        sample.motor_speed = NAN

    bench.drive(0.2, poison)
    message = bench.node.create_publisher(type(torque[0]), "winch/reference", 10)
    message.publish(type(torque[0])(name=["winch_motor"], velocity=[]))  # an array shorter than its names
    bench.drive(0.4)
    assert all(map(math.isfinite, efforts(torque)))
    assert abs(efforts(torque)[-1]) > 0.0


def test_outputs_are_stamped_as_their_measurement(fed: tuple[Bench, list]) -> None:
    bench, torque = fed
    before = len(torque)
    sent = bench.drive(0.2)
    bench.spin(0.2)
    # on a machine that stood still for a moment the answer to an earlier sample comes late, and the watchdog has spoken
    # too: at a time of its own, and marked invalid
    heard = [each for each in torque[before:] if stamp_time(each) > sent[0] - 1e-5]
    measured = [each for each in heard if any(abs(stamp_time(each) - stamp) < 1e-5 for stamp in sent)]
    assert stamps(measured) == pytest.approx(sent, abs=1e-5)
    assert all(each.header.frame_id.startswith("invalid") for each in heard if each not in measured)
    last = torque[-1]
    assert list(last.name) == ["winch_motor"]
    assert len(last.position) == len(last.velocity) == len(last.effort) == 1


def test_models_are_swapped_by_service_and_by_topic(fed: tuple[Bench, list], tmp_path: Path) -> None:
    bench, torque = fed
    seed = load_model("a6vm215_crane2")
    harder = seed.with_values({name: 1.3 * seed.value(name) for name in ("C1", "C5", "C6", "K4")})
    node, seen = bench.remote("compensator"), bench.listen("/diagnostics", DiagnosticArray, 10)
    node.set({"model_file": str(save_model(harder, tmp_path / "harder.yaml"))})
    assert "in use" in node.trigger("load_model")
    bench.drive(0.5)
    softer = seed.with_values({name: 0.7 * seed.value(name) for name in ("C1", "C5", "C6", "K4")})
    models = bench.node.create_publisher(String, "friction_model", LATCHED)
    models.publish(String(data=model_to_text(softer)))
    bench.drive(0.8)
    assert diagnostics(seen, "feedforward")["accepted_models"] == "2"
    assert max(map(abs, efforts(torque)[-20:])) > 0.0


def test_a_repaired_model_with_a_new_term_takes_over_while_running(fed: tuple[Bench, list], tmp_path: Path) -> None:
    """What `gap` writes: the seed's terms and the effect that was missing."""
    bench, torque = fed
    seed, missing = load_model("a6vm215_crane2"), term_named("low_displacement_loss")
    terms, values = (*seed.terms, missing), (*seed.values, *(p.typical / 3 for p in missing.parameters))
    repaired = FrictionModel("repaired", terms, values, constants=seed.constants)
    bench.drive(1.0)
    before = max(map(abs, efforts(torque)[-40:]))
    node = bench.remote("compensator")
    node.set({"model_file": str(save_model(repaired, tmp_path / "model.yaml"))})
    assert "in use" in node.trigger("load_model")
    bench.drive(4.0)
    assert max(map(abs, efforts(torque)[-40:])) > before


def test_a_wrong_model_is_refused_and_the_last_good_one_kept(fed: tuple[Bench, list], tmp_path: Path) -> None:
    bench, _ = fed
    seed = load_model("a6vm215_crane2")
    node, seen = bench.remote("compensator"), bench.listen("/diagnostics", DiagnosticArray, 10)
    node.set({"model_file": str(save_model(seed.with_values({"C6": 2 * seed.value("C6")}), tmp_path / "wrong.yaml"))})
    with pytest.raises(InputError, match="outside"):
        node.trigger("load_model")
    models = bench.node.create_publisher(String, "friction_model", LATCHED)
    models.publish(String(data="schema: nonsense"))
    bench.drive(0.5)
    status = diagnostics(seen, "feedforward")
    assert status["model"] == seed.name
    assert status["accepted_models"] == "0"
    assert bench.says("compensator", "model refused")


def test_time_that_falls_back_begins_anew(bench: Bench) -> None:
    bench.start("compensator", ramp_time=0.3, use_sim_time=True)
    torque, clock = bench.listen("compensator/friction_torque"), bench.node.create_publisher(Clock, "/clock", 10)
    bench.announce()
    clock.publish(clock_message(bench.time))
    bench.drive(0.8)
    assert abs(efforts(torque)[-1]) > 100.0
    bench.time -= 1000.0
    clock.publish(clock_message(bench.time))
    before = len(torque)
    bench.drive(0.8)
    last, *again = efforts(torque)[before - 1 :]
    assert bench.says("compensator", "time jumped")
    assert abs(again[0] - last) < 0.1 * abs(last)  # what was published goes on from where it was, by a ramp
    assert abs(again[-1]) > 100.0


def test_enable_and_reset(fed: tuple[Bench, list]) -> None:
    bench, torque = fed
    node = bench.remote("compensator")
    node.switch("enable", False)
    bench.drive(0.6)
    assert efforts(torque)[-1] == 0.0
    node.switch("enable", True)
    bench.drive(0.6)
    assert abs(efforts(torque)[-1]) > 0.0
    assert "anew" in node.trigger("reset")


def test_two_cranes_in_two_namespaces(bench: Bench) -> None:
    for crane in ("north", "south"):
        bench.start("compensator", "-r", f"__ns:=/{crane}", name=crane, ramp_time=0.1)
    north, south = (bench.listen(f"{crane}/compensator/friction_torque") for crane in ("north", "south"))
    for crane in ("north", "south"):
        bench.announce(crane)
    sent = bench.drive(0.5, namespace="north")
    bench.spin(0.2)
    assert len(north) >= 0.8 * len(sent)
    assert south == []


def test_what_the_slew_limit_withholds_of_a_large_winch_is_said_at_the_start(bench: Bench, tmp_path: Path) -> None:
    shipped = Path(__file__).parents[2] / "config" / "cranes" / "crane_150t.yaml"
    large = shipped.read_text().replace("value: 2000, unit: N*m", "value: 60, unit: kN*m")
    (tmp_path / "large.yaml").write_text(large)
    bench.start("compensator", crane=tmp_path / "large.yaml")
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    assert bench.spin(30.0, lambda: bool(seen))
    assert bench.says("compensator", "leaves 3000 of 60000 N*m")
    assert float(diagnostics(seen, "feedforward")["torque_limit"]) == 3000.0
