"""What may be said about a parameter: seed, learning, learned, frozen or invalid, with hysteresis."""

from winch_friction.estimation.config import EstimatorConfig


class ParameterStatus:
    """Status of one parameter.

    `seed`: the data have not said anything about it; `learning`, `learned`: its sigma has fallen below a share of the
    seed's;
    `frozen`: it was learning, but learning rests; `invalid`: it stands at the edge of its range around the seed.
    A level is left only when the sigma has risen a hysteresis beyond it; frozen and invalid need to last.
    """

    def __init__(self, config: EstimatorConfig) -> None:
        self._config = config
        self.level = "seed"
        self.frozen_for = 0.0
        self.limit_for = 0.0

    def step(self, share: float, frozen: bool, at_limit: bool, dt: float) -> None:
        """Take the sigma as a share of the seed's, and what was the case for the last `dt` s."""
        self.level = self._level(share)
        settle = self._config.settle_time
        self.frozen_for = min(self.frozen_for + dt, settle) if frozen else 0.0
        moved = dt if at_limit else -dt
        self.limit_for = min(max(self.limit_for + moved, 0.0), 2.0 * settle)

    @property
    def text(self) -> str:
        """The status to say."""
        if self.limit_for >= self._config.settle_time > 0.0:
            return "invalid"
        if self.level != "seed" and self.frozen_for >= self._config.settle_time > 0.0:
            return "frozen"
        return self.level

    def _level(self, share: float) -> str:
        config = self._config
        learned = config.learned_below + (config.hysteresis if self.level == "learned" else 0.0)
        learning = config.learning_below + (config.hysteresis if self.level != "seed" else 0.0)
        if share < learned:
            return "learned"
        return "learning" if share < learning else "seed"
