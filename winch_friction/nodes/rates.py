"""How fast the inputs come, how old they are, who sends them, and what was not believed."""

import math
from collections import Counter
from collections.abc import Callable
from typing import Any

from winch_friction.nodes.base import ERROR, OK, WARN, Health
from winch_friction.nodes.inputs import Inputs
from winch_friction.online.inputs import Arrivals, InputGate
from winch_friction.records.topics import FLOAT64

SELDOM = 0.5  # s
MOST_AFTER = 0.5  # of a topic's messages: a network now and then lets one overtake another
BEHIND = "comes after the speed of its own instant, so that each sample holds the one before: publish the speed last"
STILL = ": send 0 where the crane stands still"  # what came once is lost when it is silent, not absent
MISMATCH = "publishers do not match its quality of service"


class InputHealth:
    """Every expected input by name, between two reports on the steady clock.

    `needed` are topics without which the node does not work; silence of one of them is an error, of another one that
    was heard before a warning.
    """

    def __init__(
        self, gate: InputGate, inputs: Inputs, needed: Callable[[], set[str]], now: Callable[[], float], patience: float
    ) -> None:
        self._gate, self._inputs, self._needed, self._now, self._patience = gate, inputs, needed, now, patience
        self._messages: Counter[str] = Counter()
        self._refused: Counter[str] = Counter()
        self._after: Counter[str] = Counter()
        self._time = now()

    def report(self) -> Health:
        """Rate, age, number, refusals, publishers and match of every input that there should be."""
        now, elapsed = self._now(), max(self._now() - self._time, 1e-9)
        subscriptions, needed = self._inputs.subscriptions(), self._needed()
        values: dict[str, Any] = {"silence": self._gate.silence(now), "late": self._inputs.late}
        problems: list[tuple[int, str]] = []
        for topic, arrivals in self._gate.arrivals.items():
            matched, publishers = self._publishers(subscriptions.get(topic))
            rate = (arrivals.messages - self._messages[topic]) / elapsed
            refused = arrivals.refused - self._refused[topic]
            said = {
                "rate": rate, "age": now - arrivals.arrived, "publishers": publishers, "matched": matched,
                "messages": arrivals.messages, "refused": arrivals.refused, "plausible": not refused,
            }  # fmt: skip
            values |= {f"{topic} {key}": value for key, value in said.items()}
            if arrivals.reason:
                values[f"{topic} reason"] = arrivals.reason
            problems += self._problems(topic, arrivals, topic in needed, (matched, publishers), refused, now)
            if publishers > matched:
                unlike = self._mismatch(topic, subscriptions.get(topic), publishers - matched, publishers)
                problems.append((ERROR if topic in needed else WARN, unlike))
            after, came = arrivals.after - self._after[topic], arrivals.messages - self._messages[topic]
            if after > MOST_AFTER * came:
                problems.append((WARN, f"{topic}: {BEHIND}"))
            self._messages[topic], self._refused[topic] = arrivals.messages, arrivals.refused
            self._after[topic] = arrivals.after
        values |= {f"{column} age": age for column, age in self._gate.ages().items()}
        self._time = now
        level = max((each for each, _ in problems), default=OK)
        summary = "; ".join(text for each, text in sorted(problems, reverse=True))
        return Health("inputs", level, summary or "inputs arrive", values)

    def silent(self) -> frozenset[str]:
        """Needed inputs that were heard and are not any more."""
        now, arrivals = self._now(), self._gate.arrivals
        return frozenset(t for t in self._needed() if now - arrivals[t].arrived > self._limit(t, True))

    def _problems(
        self, topic: str, arrivals: Arrivals, needed: bool, senders: tuple[int, int], refused: int, now: float
    ) -> list[tuple[int, str]]:
        problems, (matched, publishers) = [], senders
        if arrivals.messages == 0 and needed:
            problems.append((ERROR if self._gate_was_heard() else WARN, f"{topic}: never heard, {matched} publishers"))
        elif arrivals.messages and now - arrivals.arrived > (limit := self._limit(topic, needed)):
            still = STILL if "heave_velocity" in self._gate.topics.inputs[topic].channels else ""
            problems.append((ERROR if needed else WARN, f"{topic}: silent for more than {limit:g} s{still}"))
        elif refused:
            problems.append((ERROR if needed else WARN, f"{topic}: {refused} refused, {arrivals.reason}"))
        elif gone := self._without(topic):
            problems.append((WARN, f"{topic}: comes without {gone} now"))
        elif lag := self._lag(topic):
            problems.append((ERROR if needed else WARN, f"{topic}: its stamps are {lag:.1f} s behind the speed's"))
        elif ahead := self._ahead(topic, arrivals.arrived):
            problems.append((WARN, f"{topic}: its stamps are {ahead:.1f} s ahead of the speed's: set the clocks"))
        if publishers > 1:
            problems.append((ERROR if needed else WARN, f"{topic}: {publishers} publishers"))
        return problems

    def _mismatch(self, topic: str, subscription: Any, unlike: int, publishers: int) -> str:
        """Why publishers are not heard: another type, which a plain bridge sends, or another quality of service."""
        source = self._gate.topics.inputs[topic]
        infos = self._inputs.node.get_publishers_info_by_topic(subscription.topic_name)
        others = sorted({each.topic_type for each in infos} - {source.type_name})
        if not others:
            return f"{topic}: {unlike} of {publishers} {MISMATCH}"
        hint = f"; or name '{source.channels[0]}' in float64_inputs" if FLOAT64 in others and source.stamped else ""
        return f"{topic}: {unlike} of {publishers} publishers send {', '.join(others)}, not {source.type_name}{hint}"

    def _without(self, topic: str) -> str:
        """The columns that a topic's messages brought and do not any more, while another of theirs is young."""
        old, ages = self._old(topic), self._gate.ages()
        held = [each for each in self._gate.topics.inputs[topic].channels if each in ages]
        return ", ".join(old) if len(old) < len(held) else ""

    def _lag(self, topic: str) -> float:
        """s by which what a topic says is too old by its stamps, although it comes; 0 when it is young enough."""
        return max(self._old(topic).values(), default=0.0)

    def _old(self, topic: str) -> dict[str, float]:
        """The ages in s of a topic's columns that are too old."""
        hold, ages = self._gate.hold, self._gate.ages()
        channels = self._gate.topics.inputs[topic].channels
        return {each: ages[each] for each in channels if ages.get(each, 0.0) > hold.limit(each)}

    def _ahead(self, topic: str, arrived: float) -> float:
        """s by which the latest stamps of a topic were ahead of the speed's when it arrived, where that is more than
        its age limit: its values are taken so much later than they come."""
        hold, passed = self._gate.hold, max(arrived - self._gate.last_arrival, 0.0)
        found = [
            (hold.stamp(each, math.inf) - self._gate.last_stamp - passed, hold.limit(each))
            for each in self._gate.topics.inputs[topic].channels
        ]
        return max((ahead for ahead, limit in found if limit < ahead < math.inf), default=0.0)

    def _gate_was_heard(self) -> bool:
        return math.isfinite(self._gate.last_arrival)

    def _limit(self, topic: str, needed: bool) -> float:
        """s of silence that are said: the hold's age limit, the watchdog's, and more for what is not needed."""
        hold, channels = self._gate.hold, self._gate.topics.inputs[topic].channels
        return max(self._patience, 0.0 if needed else SELDOM, *(hold.limit(each) for each in channels))

    def _publishers(self, subscription: Any) -> tuple[int, int]:
        """Publishers that match the subscription, and all that there are on its topic."""
        if subscription is None:
            return 0, 0
        return int(subscription.get_publisher_count()), int(self._inputs.node.count_publishers(subscription.topic_name))
