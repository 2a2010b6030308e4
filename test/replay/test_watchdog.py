"""Live equals replay with the watchdog: a live service and the replay of its bag publish the same in a silence."""

from pathlib import Path

import pytest

from winch_friction.compensation import CompensatorConfig, Feedforward
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.inputs import ServiceOptions
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.topics import crane_topics, joint_state, stamp_header
from winch_friction.replay.recording import replay_recording
from winch_friction.replay.settings import Phase, ReplaySettings
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

CONFIG = CompensatorConfig(ramp_time=0.4)
GAPS = ((3.0, 3.3), (4.0, 5.5), (7.0, 7.15))  # s without any message
LATENCY = 0.0013  # s from sending to hearing
WATCH = 0.005  # s between two looks of the live watchdog


@pytest.fixture(scope="module")
def run(crane_150t: Crane, crane2_model: FrictionModel) -> Run:
    scenario = load_scenario("ahc_irregular").override({"duration": 10.0})
    return simulate(scenario, crane_150t, crane2_model, seed=5).run


def _live(path: Path, run: Run, crane: Crane, model: FrictionModel, frozen: bool) -> list[Feedforward]:
    """A service beside the sea in its own time, its inputs and outputs recorded; `frozen`: in the gaps the stamps stand
    still and messages come."""
    service, topics = (
        CompensatorService(crane, model, crane_topics(crane), CONFIG, ServiceOptions()),
        crane_topics(crane),
    )
    said: list[Feedforward] = []
    events = []
    for sample in run.samples():
        sent, stopped = sample.time, next((gap for gap in GAPS if gap[0] < sample.time < gap[1]), None)
        if stopped is None or frozen:
            sample.time = stopped[0] if stopped else sample.time
            events += [(sent, topic, message) for topic, message in topics.encode(sample, MESSAGES)]
    with BagWriter(path) as bag:
        clock = 0.0
        for sent, topic, message in events:
            while clock < sent + LATENCY:
                said += [each for each in (service.tick(clock),) if each is not None]
                clock += WATCH
            bag.write(f"/{topic}", message, sent + LATENCY)
            answer = service.take(topics.inputs[topic], message, sent + LATENCY, sent + LATENCY)
            said += [answer] if answer is not None else []
        for each in said:
            header = stamp_header(each.time, MESSAGES)
            torque = joint_state(MESSAGES, header, "winch_motor", effort=each.friction_torque)
            bag.write("/compensator/friction_torque", torque, run.time[-1])
    return said


@pytest.mark.parametrize("frozen", [False, True])
def test_silences_are_replayed(
    tmp_path: Path, run: Run, crane_150t: Crane, crane2_model: FrictionModel, frozen: bool
) -> None:
    said = _live(tmp_path / "bag", run, crane_150t, crane2_model, frozen)
    stale = [each for each in said if each.state == "stale"]
    assert len(stale) > 20
    assert any(each.friction_torque == 0.0 for each in stale)
    settings = ReplaySettings((Phase(config=CONFIG),))
    replayed = replay_recording(tmp_path / "bag", crane_150t, crane2_model, settings, learn=False)
    (live,) = replayed.live
    assert live.missing == 0
    if not frozen:
        assert live.compared >= len(said) - 2 * len(GAPS)  # the last look before the speed came back
        assert live.equal
    else:  # the moment of the freeze is known to the recorder's jitter alone; what follows is the same again
        assert len(replayed.watchdog) > 0
        late = {round(each.time * 1e9): each.friction_torque for each in said if each.time > GAPS[-1][1] + 1.0}
        same = [(late[key], value) for t, value in _pairs(replayed.compensator) if (key := round(t * 1e9)) in late]
        assert len(same) > 50
        assert max(abs(a - b) for a, b in same) < 1e-6


def _pairs(run: Run) -> list[tuple[float, float]]:
    return list(zip(run.time.tolist(), run["friction_torque"].tolist(), strict=True))
