"""The filter with its step compiled, where numba is installed and can keep what it compiled."""

from collections.abc import Sequence
from functools import lru_cache
from struct import Struct

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.dynamics import ACTING, ENCODER_CHANGE, LOAD, SPEED, Step, fading, noise_variances
from winch_friction.estimation.filter import StateFilter
from winch_friction.estimation.kernels import GIVEN_GRADIENT, kernels
from winch_friction.estimation.parameters import ScaledParameters


class CompiledFilter(StateFilter):
    """`StateFilter` with both halves of a step in one compiled call each; the numbers differ by rounding."""

    def __init__(self, config: EstimatorConfig, parameters: ScaledParameters, sensors: Sequence[float] = ()) -> None:
        super().__init__(config, parameters, sensors)
        self._kernel_ahead, self._kernel_in = kernels()
        self._scale, self._free = parameters.scale, parameters.free.astype(np.int64)
        self._wire, self._by, self._rows = np.zeros((LOAD, ACTING)), np.zeros(self.size), np.zeros((LOAD, self.size))
        # a step's numbers go to arrays through their bytes: NumPy takes three times as long to read a tuple
        self._wire_bytes = Struct(f"{LOAD * ACTING}d")
        self._given_bytes = Struct(f"{GIVEN_GRADIENT + len(parameters.center) + len(sensors) + 1}d")
        self._given = np.zeros(self._given_bytes.size // 8)
        self._wire_at, self._given_at = self._wire.data, self._given.data

    def _predict(self, step: Step, load_known: bool) -> None:
        top, middle, bottom = step.wire
        self._wire_bytes.pack_into(self._wire_at, 0, *top, *middle, *bottom)
        noises = noise_variances(step, self.config, self._factor.value, load_known)
        self._given_bytes.pack_into(
            self._given_at, 0, step.torque - step.friction, step.heave, fading(step.duration, self.config), *noises,
            *step.by_parameters, *step.by_sensors, 0.0,  # nothing acts on what the range has moved
        )  # fmt: skip
        self._kernel_ahead(
            self._now,
            self._ahead,
            self._seen,
            self._wire,
            self._given,
            self._free,
            self._scale,
            self._damping,
            self._by,
            self._rows,
        )

    def _see(self) -> tuple[float, float]:
        seen = self._seen.item
        return seen(-1), seen(SPEED) + seen(ENCODER_CHANGE)

    def _take_in(self, innovation: float, variance: float, learning: bool, stick: bool) -> bool:
        parameters = self.parameters
        return bool(
            self._kernel_in(
                self._now,
                self._ahead,
                self._seen,
                innovation,
                variance,
                learning,
                stick,
                parameters.lower,
                parameters.upper,
            )  # fmt: skip
        )


@lru_cache(maxsize=1)
def filter_class() -> type[StateFilter]:
    """The compiled filter, or NumPy's without numba or a place to keep what it compiled: it takes seconds."""
    try:
        kernels()
    except (ImportError, RuntimeError, OSError):
        return StateFilter
    return CompiledFilter
