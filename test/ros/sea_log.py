"""Seas of a simulator node, one after the other into bags over DDS; and what a bag without a hole holds."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import yaml
from dds_bench import CRANE, Bench
from std_msgs.msg import Float64

from winch_friction.nodes.qos import LATCHED
from winch_friction.nodes.recorder import Recorder, winch_topics
from winch_friction.nodes.simulator import SLOW_CHANNELS, UNMEASURED
from winch_friction.records.bag_write import BagWriter
from winch_friction.records.topics import TopicMap, crane_topics

LONGEST = 60.0  # s that a sea may take
WHOLE_SEA = 10_000  # messages that a publisher keeps until they are acknowledged: more than a sea has samples


def nothing_overwritten(folder: Path, groups: Sequence[str]) -> Path:
    """A parameter file by which the inputs' publishers keep a whole sea: what is not acknowledged is sent again."""
    keep = {f"/{topic}": {"publisher": {"depth": WHOLE_SEA}} for topic in crane_topics(CRANE, groups).inputs}
    path = folder / f"keep_{'_'.join(groups)}.yaml"
    path.write_text(yaml.safe_dump({"/**": {"ros__parameters": {"qos_overrides": keep}}}))
    return path


def complete_log(topics: TopicMap, samples: int) -> Counter[str]:
    """Messages of each input when `samples` scans were published and none was lost."""
    silent = () if "active" in topics.groups else ("heave_velocity",)
    sent = [each for each in topics.inputs.values() if not UNMEASURED.issuperset(each.channels)]
    slow = {each.topic: SLOW_CHANNELS.get(each.channels[0], 1) for each in sent}
    return Counter({f"/{t}": 1 + (samples - 1) // every for t, every in slow.items() if not t.endswith(silent)})


class SeaLog:
    """A simulator node of these motor groups, conducted from the bench."""

    def __init__(self, bench: Bench, name: str, groups: Sequence[str]) -> None:
        self.topics = crane_topics(CRANE, groups)
        self.node = bench.remote(name)
        self._bench, self._name = bench, name
        self._progress = bench.listen(f"{name}/progress", Float64, LATCHED)

    def configure(self, **parameters: object) -> None:
        """Another sea."""
        if self.node.state() == "active":
            self.node.change("deactivate")
        if self.node.state() == "inactive":
            self.node.change("cleanup")
        self.node.set(parameters)
        self.node.change("configure")

    @contextmanager
    def recorder(self, bag: Path) -> Iterator[Recorder]:
        """A recorder that hears the node; the bag is there at the end."""
        with BagWriter(bag) as writer:
            made = Recorder(self._bench.node, writer, winch_topics(self.topics))
            try:
                inputs = tuple(t for t, own in self.topics.inputs.items() if not UNMEASURED.issuperset(own.channels))
                assert self._bench.spin(20.0, lambda: made.hears("/clock", *inputs)), f"'{self._name}' is not heard"
                yield made
                made.finish()
            finally:
                made.close()

    def sail(self, recorder: Recorder, begin: Callable[[], object], expected: Counter[str]) -> None:
        """From `begin` until the sea is over and everything expected has come; the recorder says what has not."""
        self._progress.clear()
        begin()

        def complete() -> bool:
            recorder.collect()
            return bool(self._progress) and self._progress[-1].data >= 1.0 and expected <= recorder.taken

        self._bench.spin(LONGEST, complete)
