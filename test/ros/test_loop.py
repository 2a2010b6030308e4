"""The whole loop over DDS on a short sea: learned, latched, recorded, replayed, kept."""

import os
import shutil
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dds_bench import Bench
from std_msgs.msg import String

from winch_friction.cli.demo.legs import voyage_legs
from winch_friction.cli.demo.measures import measure, of_leg
from winch_friction.cli.demo.plan import DemoPlan, make_plan
from winch_friction.cli.demo.processes import events, running_nodes, running_stage
from winch_friction.cli.demo.recording import Recording, read_recording
from winch_friction.nodes.qos import LATCHED
from winch_friction.records.model_file import model_from_text
from winch_friction.replay.recording import replay_recording

pytestmark = pytest.mark.slow
POLICIES = Path(__file__).resolve().parents[2] / "config" / "sros2" / "policies.xml"
SECONDS = 30  # of every phase
LAST_RAMP = 51  # messages of 0.02 s in a ramp of 1 s
NODES = ("compensator", "estimator", "simulator")
# a policy may allow it although this loop shows it nowhere: the group of normal winch mode, a time that others make
NOT_IN_THIS_LOOP = {"/clock", *(f"/winch/main/{channel}" for channel in ("pressure_a", "pressure_b", "displacement"))}


@dataclass(frozen=True)
class Voyage:
    """What a run of two legs left: with the seed model, then with the learned one."""

    plan: DemoPlan
    recording: Recording
    recorded: dict[str, int]
    late_models: list[Any]
    names: dict[str, dict[str, set[str]]]


@pytest.fixture(scope="module")
def voyage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Voyage]:
    out = tmp_path_factory.mktemp("voyage")
    bench = Bench(out)
    os.environ["ROS_DOMAIN_ID"] = str(bench.domain)
    try:
        plan = make_plan(out, "ahc_irregular", voyage_legs("ahc_irregular")[:2], 0.82, float(SECONDS), 11, 1.3)
        plan = replace(plan, feedforwards=plan.feedforwards[2:])
        parameter_file, plan_file = plan.write()
        with running_nodes(parameter_file, out / "logs") as nodes, running_stage(plan_file, out / "logs") as stage:
            said = list(events(stage, nodes, out / "logs"))
            models = bench.listen("friction_model", String, LATCHED)
            assert bench.spin(10.0, lambda: bool(models)), "the late joiner got no model"
            names = {name: _names(bench, name) for name in NODES}
        yield Voyage(plan, read_recording(plan), said[-1]["messages"], models, names)
    finally:
        del os.environ["ROS_DOMAIN_ID"]
        bench.close()


def _names(bench: Bench, node: str) -> dict[str, set[str]]:
    """What a running node publishes, subscribes to and serves."""
    ask = {
        "publish": bench.node.get_publisher_names_and_types_by_node,
        "subscribe": bench.node.get_subscriber_names_and_types_by_node,
        "reply": bench.node.get_service_names_and_types_by_node,
        "request": bench.node.get_client_names_and_types_by_node,
    }
    return {kind: {name for name, _ in get(node, "/")} for kind, get in ask.items()}


def test_no_sample_is_lost(voyage: Voyage) -> None:
    samples = voyage.recorded["/winch/joint_states"]
    phases = len(voyage.plan.phases)
    assert samples == phases * (50 * SECONDS + 1)
    # between two phases the compensator is deactivated, and says its torque's way to zero
    assert samples <= voyage.recorded["/compensator/friction_torque"] <= samples + (phases - 1) * LAST_RAMP
    assert voyage.recorded["/estimator/friction_torque"] == samples


def test_live_equals_replay(voyage: Voyage) -> None:
    agreements = replay_recording(voyage.plan.bag, voyage.plan.crane, voyage.plan.seed).live
    assert {each.node for each in agreements} == {"compensator", "estimator"}
    for each in agreements:
        assert each.compared == voyage.recorded["/winch/joint_states"]
        assert each.missing == 0
        assert each.largest <= 1e-9


def test_the_learned_model_compensates_better(voyage: Voyage) -> None:
    rows = measure(voyage.plan, voyage.recording)
    for leg in voyage.plan.legs:
        seed, learned = of_leg(rows, leg.name)
        assert learned.residual < seed.residual
        visited = [share for share in learned.friction_error_share[1:] if np.isfinite(share)]
        assert len(visited) >= 2
        assert max(visited) < 0.05


def test_a_late_joiner_gets_the_latest_model(voyage: Voyage) -> None:
    (message,) = voyage.late_models
    late, last = model_from_text(message.data), voyage.recording.models[-1]
    assert late.values == last.values
    assert late.provenance["learned_at"] == last.provenance["learned_at"]
    assert late.provenance["seed"] == voyage.plan.seed.name


def test_the_estimator_continues_from_its_checkpoint(voyage: Voyage, bench: Bench) -> None:
    checkpoint = voyage.plan.out / "estimator.json"
    bench.start("estimator", checkpoint=checkpoint, model_period=1.0)
    models = bench.listen("friction_model", String, LATCHED)
    bench.announce()
    bench.drive(0.5)
    assert bench.spin(5.0, lambda: bool(models))
    assert bench.says("estimator", "continues from")
    kept, learned = model_from_text(models[0].data), voyage.recording.models[-1]
    assert kept.value("C6") != voyage.plan.seed.value("C6")
    assert kept.value("C6") == pytest.approx(learned.value("C6"), rel=0.02)
    assert bench.stop("estimator") == 0


def test_a_checkpoint_of_another_seed_is_refused(voyage: Voyage, bench: Bench, tmp_path: Path) -> None:
    checkpoint = Path(shutil.copy(voyage.plan.out / "estimator.json", tmp_path))
    bench.start("estimator", checkpoint=checkpoint, model_file="a6vm215_crane1")
    assert bench.remote("estimator").state() == "active"
    bench.spin(0.5)
    assert bench.says("estimator", "starts from the seed")


@pytest.mark.parametrize("node", NODES)
def test_the_security_policies_cover_every_name(voyage: Voyage, node: str) -> None:
    profile = next(p for p in ElementTree.parse(POLICIES).iter("profile") if p.get("node") == node)
    for kind, used in voyage.names[node].items():
        allowed = {_absolute(each.text, node) for group in profile if group.get(kind) == "ALLOW" for each in group}
        assert used <= allowed, f"{kind}: not covered"


def test_the_security_policies_allow_nothing_that_no_node_uses(bench: Bench) -> None:
    for node in NODES:
        bench.start(
            node, **({"lockstep": True, "wait_for": "[estimator/friction_torque]"} if node == "simulator" else {})
        )
    for remote in map(bench.remote, NODES):
        assert bench.spin(60.0, lambda of=remote: of.state() == "active")
    bench.spin(1.0)
    for profile in ElementTree.parse(POLICIES).iter("profile"):
        node = profile.get("node") or ""
        for kind, used in _names(bench, node).items():
            allowed = {_absolute(each.text, node) for group in profile if group.get(kind) == "ALLOW" for each in group}
            assert used <= allowed, f"{node}: {kind}: not covered"
            assert allowed - used <= NOT_IN_THIS_LOOP, f"{node}: {kind}: more than the node needs"


def _absolute(name: str | None, node: str) -> str:
    name = name or ""
    return name.replace("~", f"/{node}") if name.startswith("~") else f"/{name.lstrip('/')}"
