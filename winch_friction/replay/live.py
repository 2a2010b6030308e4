"""Whether the replay of a recording gives what the nodes gave live."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from winch_friction.physics.signals import FloatArray, Run
from winch_friction.records.bag_file import open_bag
from winch_friction.records.topics import stamp_time

LIVE_TOPICS = {"compensator": "/compensator/friction_torque", "estimator": "/estimator/friction_torque"}
SMALLEST = 1e-3  # N m; below it two torques are compared absolutely
AGREEMENT = 1e-9  # relative


@dataclass(frozen=True)
class Comparison:
    """Live against replayed torque of one node: samples compared, missing, largest relative difference and its time."""

    node: str
    compared: int
    missing: int
    largest: float
    at: float

    @property
    def equal(self) -> bool:
        """Whether they agree to 1e-9 relative."""
        return self.compared > 0 and self.largest <= AGREEMENT


def compare_live(path: Path | str, replayed: dict[str, Run], **bag_options: object) -> list[Comparison]:
    """Compare replayed runs (by node name) with the node outputs recorded in the bag, where there are any."""
    found = []
    with open_bag(Path(path), **bag_options) as bag:  # type: ignore[arg-type]
        for node, ending in LIVE_TOPICS.items():
            topics = bag.topics_ending(ending)
            if node in replayed and topics:
                live: dict[float, float] = {}
                for _, _, message in bag.messages(*topics):
                    live.setdefault(stamp_time(message), float(message.effort[0]))
                found.append(_compared(node, live, replayed[node], replayed.get("watchdog")))
    return found


def _compared(node: str, live: dict[float, float], replayed: Run, silences: Run | None = None) -> Comparison:
    """A node's answers to samples, and for the compensator also what its watchdog said in silences."""
    torque = _published(replayed["friction_torque"]) if node == "estimator" else replayed["friction_torque"]
    # nanoseconds: live stamps went through a message, replayed times through a float
    stamps = np.array([round(time * 1e9) for time in live])
    order = dict(zip(stamps.tolist(), live.values(), strict=True))
    pairs = [
        (time, order[key], value)
        for time, value in zip(replayed.time.tolist(), torque.tolist(), strict=True)
        if (key := round(time * 1e9)) in order
    ]
    if not pairs:
        return Comparison(node, 0, len(replayed), float("nan"), float("nan"))
    missing = len(replayed) - len(pairs)
    if node == "compensator" and silences is not None:
        said = zip(silences.time.tolist(), silences["friction_torque"].tolist(), strict=True)
        pairs += [(time, order[key], value) for time, value in said if (key := round(time * 1e9)) in order]
    times, live_values, values = (np.array(each) for each in zip(*pairs, strict=True))
    difference = np.abs(live_values - values) / np.maximum(np.abs(live_values), SMALLEST)
    worst = int(np.argmax(difference))
    return Comparison(node, len(pairs), missing, float(difference[worst]), float(times[worst]))


def _published(values: FloatArray) -> FloatArray:
    """The estimator node says zero where a sample shows no friction."""
    return np.where(np.isnan(values), 0.0, values)
