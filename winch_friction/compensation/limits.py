"""The bounds of the feedforward (docs/physics.md §4), each with a count of how often it was needed."""

from dataclasses import dataclass, field


@dataclass
class TorqueLimits:
    """Absolute, envelope and slew limit of a torque; N m and N m/s."""

    absolute: float
    slew: float
    counts: dict[str, int] = field(default_factory=lambda: {"absolute": 0, "envelope": 0, "slew": 0})

    def bound(self, torque: float, envelope: float) -> float:
        """The torque inside the absolute limit and +- `envelope`."""
        if abs(torque) <= envelope and abs(torque) <= self.absolute:
            return torque
        torque = self._clamped("envelope", torque, envelope)
        return self._clamped("absolute", torque, self.absolute)

    def slewed(self, torque: float, previous: float, dt: float, slew: float = 0.0) -> float:
        """The torque no further from the previous one than the slew limit, or `slew` where more, allows in `dt` s."""
        return previous + self._clamped("slew", torque - previous, max(self.slew, slew) * dt)

    def _clamped(self, name: str, value: float, bound: float) -> float:
        if abs(value) <= bound:
            return value
        self.counts[name] += 1
        return bound if value > 0.0 else -bound
