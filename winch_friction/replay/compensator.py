"""The friction feedforward over a recorded run: the same `step`, the same samples."""

from collections.abc import Sequence

import numpy as np

from winch_friction.compensation import Feedforward, FeedforwardCompensator
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Run

COLUMNS = ("friction_torque", "pressure", "speed", "drum_torque", "fade")


def replay_compensator(run: Run, compensator: FeedforwardCompensator) -> Run:
    """What the compensator says along a run, one row per sample.

    Columns: `time` s, `friction_torque` N m (total, at the motor shaft), `pressure` Pa, `speed` rad/s at which it was
    taken, `drum_torque` N m, `fade` 0 ... 1; `aside['state']` in words. NaN entries of the run are bridged by the last
    value up to the compensator's maximum ages, as in the node.
    """
    config = compensator.config
    hold = InputHold(run.groups, config.max_age, dict(config.max_ages))
    return feedforward_run(run.name, [compensator.step(sample) for sample in hold.samples(run)])


def feedforward_run(name: str, steps: Sequence[Feedforward]) -> Run:
    """Feedforwards as columns over time."""
    columns = {"time": np.array([each.time for each in steps])}
    columns |= {column: np.array([getattr(each, column) for each in steps]) for column in COLUMNS}
    return Run(name=name, columns=columns, aside={"state": np.array([each.state for each in steps], dtype=object)})
