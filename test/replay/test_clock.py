"""The clock of a replay: the stamps within a recorder's lateness, the receipts beyond it, and never back."""

import math

import numpy as np
import pytest

from winch_friction.records.bag_file import open_bag
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.runs import read_run
from winch_friction.records.topics import crane_topics
from winch_friction.replay.clock import JITTER, ReplayClock
from winch_friction.replay.recording import replay_recording
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate


@pytest.mark.parametrize(
    ("stamp", "receipt", "now"),
    [
        (10.0, 10.0, 10.0),
        (10.0, 10.4, 10.0),  # a recorder that was late
        (10.0, 12.0, 12.0 - JITTER),  # stamps that stand still
        (14.0, 12.0, 12.0 + JITTER),  # stamps that jump ahead
        (math.nan, 12.0, 12.0),
    ],
)
def test_the_stamps_are_believed_as_far_as_a_recorder_may_be_late(stamp, receipt, now):
    assert ReplayClock().read(stamp, receipt) == pytest.approx(now)


def test_stamps_of_0_before_a_simulations_clock_do_not_set_it(tmp_path, crane_150t, crane2_model):
    """The recorder's clock was brought to the stamps' by the first of them, which was none."""
    run = simulate(load_scenario("ahc_55t_215").override({"duration": 6.0}), crane_150t, crane2_model).run
    topics = crane_topics(crane_150t, run.groups)
    for name, timeless in (("set", 0), ("unset", 20)):
        with BagWriter(tmp_path / name) as writer:
            for k, sample in enumerate(run.samples()):
                sample.time = 500.0 + 0.02 * k if k >= 20 else 0.0
                for topic, message in topics.encode(sample, MESSAGES) if k >= 20 - timeless else ():
                    writer.write(f"/{topic}", message, 1.7e9 + 0.02 * k)
    read, unset = (read_run(tmp_path / name, crane_150t) for name in ("set", "unset"))
    assert unset.time[0] == pytest.approx(500.4)
    assert np.array_equal(unset.time, read.time)
    (said,) = unset.warnings
    assert f"topic '/winch/joint_states': 20 of {len(run)} messages are left out" in said
    with open_bag(tmp_path / "unset", crane_150t) as bag:
        assert all(each.receipt == pytest.approx(each.stamp, abs=1e-3) for each in bag.inputs() if each.source.stamped)
    there, here = (replay_recording(tmp_path / n, crane_150t, crane2_model).compensator for n in ("set", "unset"))
    assert np.array_equal(there["friction_torque"], here["friction_torque"])


def test_the_clock_never_goes_back():
    clock = ReplayClock()
    clock.read(10.0, 10.0)
    assert clock.read(9.8, 10.0) == 10.0
    assert clock.read(3.0, 3.0) == 10.0
    assert clock.read(10.1, 10.1) == pytest.approx(10.1)


@pytest.mark.parametrize("step", [2.0, -2.0, 3600.0, -0.7])
def test_a_senders_clock_that_is_set_takes_no_time_and_gives_none(step):
    """Set ahead by 2 s it skipped half a second, a silence that nobody heard; set back it stood still for as long."""
    clock = ReplayClock()
    read = [clock.read(10.0 + 0.02 * k + (step if k >= 50 else 0.0), 10.0 + 0.02 * k + 1e-3) for k in range(100)]
    assert np.diff(read) == pytest.approx(0.02, abs=2e-3)


def test_a_stray_stamp_sets_no_clock():
    clock = ReplayClock()
    read = [clock.read(10.0 + 0.02 * k + (40.0 if k == 50 else 0.0), 10.0 + 0.02 * k) for k in range(100)]
    assert np.diff(read) == pytest.approx(0.02)


def test_a_recorder_that_stalls_is_no_clock_that_was_set():
    """Its receipts come late, and those behind it in a burst: the stamps go on as they did."""
    clock, late = ReplayClock(), 0.4
    receipts = [10.0 + 0.02 * k + max(0.0, late - 0.02 * (k - 50)) * (k >= 50) for k in range(100)]
    read = [clock.read(10.0 + 0.02 * k, receipt) for k, receipt in enumerate(receipts)]
    assert np.diff(read) == pytest.approx(0.02)


def test_replay_bridges_a_clock_that_was_set_as_the_node_does(tmp_path, crane_150t, crane2_model):
    """Live five messages confirm the new time, and the torque goes on; replayed it began at zero again."""
    run = simulate(load_scenario("ahc_55t_215").override({"duration": 12.0}), crane_150t, crane2_model).run
    topics = crane_topics(crane_150t, run.groups)
    with BagWriter(tmp_path / "bag") as writer:
        for k, sample in enumerate(run.samples()):
            sample.time = 500.0 + 0.02 * k + (2.0 if k >= 300 else 0.0)
            for topic, message in topics.encode(sample, MESSAGES):
                writer.write(f"/{topic}", message, 500.0 + 0.02 * k)
    replayed = replay_recording(tmp_path / "bag", crane_150t, crane2_model)
    assert len(replayed.watchdog) <= 1  # five messages take as long as the watchdog waits
    torque, time = replayed.compensator["friction_torque"], replayed.compensator.time
    after = int(np.searchsorted(time, 507.0))
    assert abs(torque[after] - torque[after - 1]) < 0.3 * abs(torque[after - 1]) + 30.0
