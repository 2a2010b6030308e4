"""The friction feedforward over a recorded run: the same `step`, the same samples."""

from array import array
from operator import attrgetter

import numpy as np

from winch_friction.compensation import Feedforward, FeedforwardCompensator
from winch_friction.physics.signals import Run
from winch_friction.records.sample_stream import InputHold

COLUMNS = ("friction_torque", "pressure", "speed", "drum_torque", "fade")
_numbers = attrgetter("time", *COLUMNS)


def replay_compensator(run: Run, compensator: FeedforwardCompensator) -> Run:
    """What the compensator says along a run, one row per sample.

    Columns: `time` s, `friction_torque` N m (total, at the motor shaft), `pressure` Pa, `speed` rad/s at which it was
    taken, `drum_torque` N m, `fade` 0 ... 1; `aside['state']` in words. NaN entries of the run are bridged by the last
    value up to the compensator's maximum ages, as in the node.
    """
    config = compensator.config
    hold = InputHold(run.groups, config.max_age, dict(config.max_ages))
    record = FeedforwardRecord()
    for sample in hold.samples(run):
        record.take(compensator.step(sample))
    return record.run(run.name)


class FeedforwardRecord:
    """Collects feedforwards as rows of numbers: as objects, those of a day would not fit beside their bag."""

    def __init__(self) -> None:
        self._rows, self._states = array("d"), list[str]()
        self._valid, self._numbers = bytearray(), array("q")

    def __len__(self) -> int:
        return len(self._states)

    def take(self, given: Feedforward) -> None:
        """Add one."""
        self._rows.extend(_numbers(given))
        self._states.append(given.state)
        self._valid.append(given.valid)
        self._numbers.append(given.sequence)

    def run(self, name: str) -> Run:
        """All of them as columns over time."""
        table = np.array(self._rows).reshape(-1, 1 + len(COLUMNS))
        columns = {column: table[:, k].copy() for k, column in enumerate(("time", *COLUMNS))}
        said = {"valid": np.array(self._valid, dtype=bool), "number": np.array(self._numbers)}
        return Run(name=name, columns=columns, aside={"state": np.array(self._states, dtype=object), **said})
