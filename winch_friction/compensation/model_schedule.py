"""When a model that was learned elsewhere takes effect: at a sample that a replay finds again."""

from dataclasses import dataclass, field

from winch_friction.physics.friction import FrictionModel

LEARNED_AT = "learned_at"  # provenance key: stamp in s of the last measurement behind the model


@dataclass
class ModelSchedule:
    """Holds models back until `delay` s after the measurement they were learned from.

    A model travels from estimator to compensator in its own time, and one sample earlier or later is another output.
    Within the delay the journey does not matter. A model without a date takes effect at once.
    """

    delay: float = 0.5  # s
    _waiting: list[tuple[float, FrictionModel]] = field(default_factory=list)

    def offer(self, model: FrictionModel) -> None:
        """Take a model in."""
        due = float(model.provenance.get(LEARNED_AT, float("-inf"))) + self.delay
        self._waiting = sorted([*self._waiting, (due, model)], key=lambda each: each[0])

    def due(self, time: float) -> FrictionModel | None:
        """The newest model that takes effect by `time` s; older ones are dropped with it."""
        ready = [model for due, model in self._waiting if due <= time]
        self._waiting = self._waiting[len(ready) :]
        return ready[-1] if ready else None

    def clear(self) -> None:
        """Forget what is waiting, after a jump of time."""
        self._waiting = []
