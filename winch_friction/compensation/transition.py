"""Getting from one feedforward to another without a bump: fading in and out, and over to another model."""

from dataclasses import dataclass


@dataclass
class Fade:
    """A factor between 0 and 1 that moves at 1/`duration` per second."""

    duration: float  # s
    value: float = 0.0

    def step(self, up: bool, dt: float, down: float | None = None) -> float:
        """Move for `dt` s; on the way down within `down` s where that is less than the duration."""
        if up:
            self.value = min(1.0, self.value + dt / self.duration)
        else:
            self.value = max(0.0, self.value - dt / min(self.duration, down or self.duration))
        return self.value


@dataclass
class Bridge:
    """A difference that is carried along and let go over `duration` s, so that the sum starts where the old value
    ended."""

    duration: float  # s
    _height: float = 0.0
    _left: float = 0.0

    def start(self, difference: float) -> None:
        """Carry `difference` (old minus new) from now on, on top of nothing else."""
        self._height, self._left = difference, self.duration

    def drop(self) -> None:
        """Carry nothing any more."""
        self._height = self._left = 0.0

    def start_again(self, difference: float) -> None:
        """Carry `difference` from now on, for as long as was left."""
        self._height = difference * self.duration / self._left if self._left else 0.0

    def stretch(self, duration: float) -> None:
        """Let go over another duration, from what is still carried."""
        self._left *= duration / self.duration
        self.duration = duration

    def value(self) -> float:
        """What is still carried."""
        return self._height * self._left / self.duration

    def step(self, dt: float) -> float:
        """Let go for `dt` s."""
        self._left = max(0.0, self._left - dt)
        return self.value()
