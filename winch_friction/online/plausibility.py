"""Which readings are obeyed: inside the crane's ranges, not changing faster than it can."""

from dataclasses import dataclass, field

from winch_friction.physics.winch.ranges import ChannelRanges

UNKNOWN_AFTER = 1.0  # s without an accepted value: then the first one in range is believed, however far it is


@dataclass
class Plausibility:
    """Judges single readings; keeps the last accepted one of each column."""

    ranges: ChannelRanges
    _last: dict[str, tuple[float, float]] = field(default_factory=dict, init=False)

    def refusal(self, column: str, stamp: float, value: float) -> str:
        """Why a reading is not believed, in a few words; empty when it is."""
        if value != value:
            return "no number"
        lower, upper = self.ranges.range(column)
        if not lower <= value <= upper:
            return f"{value:.4g} is outside {lower:.4g} ... {upper:.4g}"
        return self._too_fast(column, stamp, value)

    def _too_fast(self, column: str, stamp: float, value: float) -> str:
        last, change = self._last.get(column), self.ranges.change(column)
        if last is not None and change is not None:
            passed = stamp - last[0]
            allowed = change.at_once + change.per_second * max(passed, 0.0)
            if -UNKNOWN_AFTER < passed < UNKNOWN_AFTER and abs(value - last[1]) > allowed:
                return f"{value:.4g} is {abs(value - last[1]):.3g} from the last"
        self._last[column] = (stamp, value)
        return ""

    def forget(self) -> None:
        """Another time begins."""
        self._last.clear()
