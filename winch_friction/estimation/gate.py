"""Which innovations are believed, and when a run of refusals says that the filter was wrong instead of the sensor."""

import math

from winch_friction.estimation.config import EstimatorConfig

RESTART_AFTER = 10  # rejections in a row that mean the filter was wrong, not the sensor
WIDE_GATE, WIDE_FOR = 3.0, 2.0  # the gate is so many times wider for so long, s, after it shut out a run of samples


class InnovationGate:
    """Admits innovations within so many sigma; counts those in a row that it did not admit."""

    def __init__(self, config: EstimatorConfig) -> None:
        self._config = config
        self._rejected_in_a_row = 0
        self._wide_until = -math.inf

    @property
    def exhausted(self) -> bool:
        """Whether so many were rejected in a row that the speed must be taken as measured."""
        return self._rejected_in_a_row >= RESTART_AFTER

    def admits(self, time: float, innovation: float, variance: float) -> bool:
        """Whether an innovation in rad/s of this variance is believed at `time` s; NaN is not."""
        return variance > 0.0 and abs(innovation) <= self._width(time) * math.sqrt(variance)

    def _width(self, time: float) -> float:
        """How many sigma an innovation may have.

        A seed far outside its own sigma is first blamed on the load and then, at the first reversal, contradicted by
        every sample of that direction. A gate that goes on rejecting them would learn one direction for good.
        """
        wide = self._wide_until - WIDE_FOR <= time <= self._wide_until
        return self._config.gate * (WIDE_GATE if wide else 1.0)

    def rejected(self, innovation: float) -> None:
        """A sample was rejected; one without an innovation (NaN) says nothing about the filter."""
        self._rejected_in_a_row += math.isfinite(innovation)

    def accepted(self) -> None:
        """A sample was accepted."""
        self._rejected_in_a_row = 0

    def restarted(self, time: float) -> None:
        """The speed was taken as measured at `time` s."""
        if self.exhausted:
            self._wide_until = time + WIDE_FOR
        self._rejected_in_a_row = 0
