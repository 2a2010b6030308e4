"""The demo's bag as arrays: what was true, what was fed forward, what was learned, phase by phase."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.cli.demo.plan import GROUPS, DemoPlan
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import FloatArray, Sample
from winch_friction.records.bag_file import open_bag
from winch_friction.records.model_file import model_from_text
from winch_friction.records.sample_stream import SampleStream
from winch_friction.records.topics import stamp_time

PAUSE = 1.0  # s without a sample between one phase and the next
TRUTH, COMPENSATOR, ESTIMATOR, MODEL = (
    "/simulator/truth", "/compensator/friction_torque", "/estimator/friction_torque", "/friction_model",
)  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """`samples` as the nodes saw them; rows over time: `truth` (time, position error m, speed rad/s, friction N m,
    applied N m), `fed` and `learned` (time, torque N m, speed rad/s); `models` in order of appearance."""

    samples: list[Sample]
    truth: FloatArray
    fed: FloatArray
    learned: FloatArray
    models: list[FrictionModel]

    def phases(self, count: int) -> list["Recording"]:
        """The recording cut at the pauses; `InputError` when there are not `count` phases."""
        times = self.truth[:, 0]
        starts = [-np.inf, *times[1:][np.diff(times) > PAUSE], np.inf]
        if len(starts) != count + 1:
            raise InputError(f"the bag has {len(starts) - 1} phases, expected {count}: was the demo interrupted?")
        return [self._between(a - 0.5 * PAUSE, b - 0.5 * PAUSE) for a, b in zip(starts[:-1], starts[1:], strict=True)]

    def _between(self, start: float, end: float) -> "Recording":
        def cut(rows: FloatArray) -> FloatArray:
            return rows[(rows[:, 0] >= start) & (rows[:, 0] < end)]

        samples = [each for each in self.samples if start <= each.time < end]
        return Recording(samples, cut(self.truth), cut(self.fed), cut(self.learned), self.models)


def read_recording(plan: DemoPlan) -> Recording:
    """The bag in one pass."""
    rows: dict[str, list[Any]] = {TRUTH: [], COMPENSATOR: [], ESTIMATOR: [], MODEL: []}
    samples: list[Sample] = []
    with open_bag(plan.bag, plan.crane, displacement_unit="fraction") as bag:
        stream = SampleStream(bag.topics, InputHold(GROUPS))
        sources = {actual: bag.topics.inputs[contract] for contract, actual in bag.actual.items()}
        for topic, receipt, message in bag.messages(*sources, *rows):
            if topic in rows:
                rows[topic].append(_row(topic, message))
            elif (sample := stream.take(sources[topic], message, receipt)) is not None:
                samples.append(sample)
    truth, fed, learned = (np.array(rows[topic]) for topic in (TRUTH, COMPENSATOR, ESTIMATOR))
    return Recording(samples, truth, fed, learned, rows[MODEL])


def _row(topic: str, message: Any) -> Any:
    if topic == MODEL:
        return model_from_text(message.data, topic)
    time = stamp_time(message)
    if topic == TRUTH:
        return time, message.position[1], message.velocity[0], message.effort[0], message.effort[1]
    return time, message.effort[0], message.velocity[0]


def matched(times: Sequence[float], rows: FloatArray) -> FloatArray:
    """The rows with these times, in their order; the first of a time where there are several; NaN without one."""
    index = {time: k for k, time in reversed(list(enumerate(rows[:, 0].tolist())))}
    missing = np.full(rows.shape[1], np.nan)
    return np.array([rows[index[time]] if time in index else missing for time in times])
