"""How fast the inputs come, how old they are, how many were refused."""

from collections import Counter
from collections.abc import Callable

from winch_friction.nodes.base import OK, WARN, Health
from winch_friction.nodes.inputs import Inputs


class InputHealth:
    """Rates between two reports on the node's own clock; a report is due at every diagnostics tick."""

    def __init__(self, inputs: Inputs, now: Callable[[], float]) -> None:
        self._inputs, self._now = inputs, now
        self._counts: Counter[str] = Counter()
        self._time = now()

    def report(self) -> Health:
        """Rate, age, number and refusals of every input that was ever seen."""
        now, counts = self._now(), Counter(self._inputs.counts)
        elapsed = now - self._time
        values: dict[str, float] = {"silence": self._inputs.silence()}
        for topic, count in counts.items():
            values[f"{topic} rate"] = (count - self._counts[topic]) / elapsed if elapsed > 0.0 else float("nan")
            values[f"{topic} messages"] = count
            values[f"{topic} refused"] = self._inputs.rejected[topic]
        values |= {f"{column} age": age for column, age in self._inputs.ages().items()}
        self._counts, self._time = counts, now
        heard = bool(counts)
        return Health("inputs", OK if heard else WARN, "inputs arrive" if heard else "no input yet", values)
