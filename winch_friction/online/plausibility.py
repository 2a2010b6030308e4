"""Which readings are obeyed: inside the crane's ranges, not changing faster than it can."""

from dataclasses import dataclass, field

from winch_friction.physics.winch.ranges import Change, ChannelRanges

UNKNOWN_AFTER = 1.0  # s without an accepted value: then the first one in range is believed, however far it is


@dataclass
class Plausibility:
    """Judges single readings; keeps the last accepted one of each column."""

    ranges: ChannelRanges
    _last: dict[str, tuple[float, float]] = field(default_factory=dict, init=False)
    _known: dict[str, tuple[float, float, Change | None]] = field(default_factory=dict, init=False)

    def refusal(self, column: str, stamp: float, value: float) -> str:
        """Why a reading is not believed, in a few words; empty when it is."""
        if value != value:
            return "no number"
        known = self._known.get(column)
        if known is None:
            known = self._known[column] = (*self.ranges.range(column), self.ranges.change(column))
        lower, upper, change = known
        if not lower <= value <= upper:
            return f"{value:.4g} is outside {lower:.4g} ... {upper:.4g}"
        if change is not None:
            last = self._last.get(column)
            if last is not None and self._too_fast(change, stamp - last[0], value - last[1]):
                return f"{value:.4g} is {abs(value - last[1]):.3g} from the last"
            self._last[column] = (stamp, value)
        return ""

    def _too_fast(self, change: Change, passed: float, difference: float) -> bool:
        if not -UNKNOWN_AFTER < passed < UNKNOWN_AFTER:
            return False
        return abs(difference) > change.at_once + change.per_second * max(passed, 0.0)

    def forget(self) -> None:
        """Another time begins."""
        self._last.clear()
