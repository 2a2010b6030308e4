"""The demo's bag as arrays: what was true, what was fed forward, what was learned, phase by phase."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.cli.demo.plan import DemoPlan
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.records.bag_file import open_bag
from winch_friction.records.model_file import model_from_text
from winch_friction.records.topics import stamp_time

LONGEST_STEP = 1.0  # s; a longer one lies between two phases
TRUTH, COMPENSATOR, ESTIMATOR, MODEL = (
    "/simulator/truth", "/compensator/friction_torque", "/estimator/friction_torque", "/friction_model",
)  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """Rows over time: `truth` (time, position error m, speed rad/s, friction N m, applied N m), `fed` and `learned`
    (time, torque N m, speed rad/s); `models` in order of appearance."""

    truth: FloatArray
    fed: FloatArray
    learned: FloatArray
    models: list[FrictionModel]

    def phases(self, count: int) -> list["Recording"]:
        """The recording cut at the pauses; `InputError` when there are not `count` phases."""
        times = self.truth[:, 0]
        starts = [-np.inf, *times[1:][np.diff(times) > LONGEST_STEP], np.inf]
        if len(starts) != count + 1:
            raise InputError(f"the bag has {len(starts) - 1} phases, expected {count}: was the demo interrupted?")
        edges = [start - 0.5 * LONGEST_STEP for start in starts]
        return [self._between(a, b) for a, b in zip(edges[:-1], edges[1:], strict=True)]

    def _between(self, start: float, end: float) -> "Recording":
        def cut(rows: FloatArray) -> FloatArray:
            return rows[(rows[:, 0] >= start) & (rows[:, 0] < end)]

        return Recording(cut(self.truth), cut(self.fed), cut(self.learned), self.models)


def read_recording(plan: DemoPlan) -> Recording:
    """The bag in one pass."""
    rows: dict[str, list[Any]] = {TRUTH: [], COMPENSATOR: [], ESTIMATOR: [], MODEL: []}
    with open_bag(plan.bag, plan.crane, displacement_unit="fraction") as bag:
        for topic, _, message in bag.messages(*rows):
            rows[topic].append(_row(topic, message))
    truth, fed, learned = (np.array(rows[topic]) for topic in (TRUTH, COMPENSATOR, ESTIMATOR))
    return Recording(truth, fed, learned, rows[MODEL])


def _row(topic: str, message: Any) -> Any:
    if topic == MODEL:
        return model_from_text(message.data, topic)
    time = stamp_time(message)
    if topic == TRUTH:
        return time, message.position[1], message.velocity[0], message.effort[0], message.effort[1]
    return time, message.effort[0], message.velocity[0]
