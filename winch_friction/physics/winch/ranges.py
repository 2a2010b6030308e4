"""What this crane's channels can show: the physical range and the largest rate of each, from the crane itself.

Tighter than `physics.plausible`, which asks only whether any winch's sensor could say such a number. A value outside
is a broken sensor, a wrong unit or somebody else's message.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from winch_friction.physics.plausible import LIMITS
from winch_friction.physics.units import BAR, CM3_PER_REV, GRAVITY, RPM
from winch_friction.physics.winch.crane import Crane

# where the crane file does not say (docs/safety.md)
RATED_PRESSURE = 450.0 * BAR  # peak of the usual axial-piston motors (nominal 400 bar)
RATED_SPEED, RATED_SIZE = 4800.0 * RPM, 215.0 * CM3_PER_REV  # a 215 cm^3 motor swung back; smaller ones turn faster
SIZE_EXPONENT = -1.0 / 3.0  # of a motor series: the same velocity of its pistons
# factors over the rated value
PRESSURE_MARGIN = 4.0 / 3.0  # 600 bar, the usual transducer's full scale
LOWEST_PRESSURE = -100.0 * BAR  # a zero error is far above; a broken 4 ... 20 mA loop says -150 bar
SPEED_MARGIN = 1.25
LOAD_MARGIN = 2.0  # dynamic amplification of a lift through the splash zone
LIGHTEST_LOAD = -0.05  # of the rated one: a load cell's zero error
DISPLACEMENT_MARGIN = 0.05  # of D_max: feedback of 1-3 %
MOST_HEAVE = 10.0  # m/s, crane tip


@dataclass(frozen=True, slots=True)
class Change:
    """The most that a channel changes: `per_second`, and `at_once` for noise, quantisation and skew."""

    per_second: float
    at_once: float


class ChannelRanges:
    """Ranges and rates of a crane's channels, SI; `groups` are the motor groups on the shaft (default: all)."""

    def __init__(self, crane: Crane, groups: Sequence[str] = ()) -> None:
        self.crane = crane
        self.pressure = (crane.rated_pressure or RATED_PRESSURE) * PRESSURE_MARGIN
        self.speed = self._speed()
        self.load = self._load(groups)
        self._ranges = {**LIMITS, **self._of_crane()}
        self._changes = self._largest_changes()

    def _speed(self) -> float:
        if self.crane.rated_speed:
            return self.crane.rated_speed * SPEED_MARGIN
        if not self.crane.max_displacement:
            return LIMITS["motor_speed"][1]
        return RATED_SPEED * SPEED_MARGIN * (self.crane.max_displacement / RATED_SIZE) ** SIZE_EXPONENT

    def _load(self, groups: Sequence[str]) -> float:
        """kg: the rated load with its margin, else what the motors can hold at all."""
        crane = self.crane
        if crane.rated_load:
            return crane.rated_load * LOAD_MARGIN
        torque = crane.motor_total(tuple(groups)) * crane.max_displacement * (crane.rated_pressure or RATED_PRESSURE)
        held = torque * crane.gear_ratio / (GRAVITY * crane.drum.layer_radii[0])
        return held or LIMITS["hook_load"][1]

    def _of_crane(self) -> dict[str, tuple[float, float]]:
        ranges = {
            "motor_speed": (-self.speed, self.speed),
            "speed_reference": (-self.speed, self.speed),
            "hook_load": (LIGHTEST_LOAD * self.load, self.load),
            "rope_force": (LIGHTEST_LOAD * self.load * GRAVITY, self.load * GRAVITY),
            "heave_velocity": (-MOST_HEAVE, MOST_HEAVE),
            "wire_layer": (0.5, len(self.crane.drum.layer_radii) + 0.5),
            "pressure_a": (LOWEST_PRESSURE, self.pressure),
            "pressure_b": (LOWEST_PRESSURE, self.pressure),
        }
        if self.crane.max_displacement:
            tolerance = DISPLACEMENT_MARGIN * self.crane.max_displacement
            ranges["displacement"] = (-tolerance, self.crane.max_displacement + tolerance)
        return ranges

    def range(self, channel: str) -> tuple[float, float]:
        """Smallest and largest value of a channel (a run's column or its short name)."""
        return self._ranges.get(channel.rpartition(".")[2], (-1.0e300, 1.0e300))

    def plausible(self, channel: str, value: float) -> bool:
        """Whether this crane's channel can show this value; False for NaN."""
        lower, upper = self._ranges.get(channel) or self.range(channel)
        return lower <= value <= upper

    def change(self, channel: str) -> Change | None:
        """The largest change of a channel; None where none is known."""
        return self._changes.get(channel.rpartition(".")[2])

    def _largest_changes(self) -> dict[str, Change]:
        # speed: ten times what heave asks for (130 rad/s^2), and an encoder's step; a command may step, a pressure
        # rises at most as fast as relief valves and waves make it (1e4 bar/s); a swash plate needs 0.1 s for its stroke
        pressure = Change(1.0e4 * BAR, 0.1 * self.pressure)
        changes = {
            "motor_speed": Change(4.0 * self.speed, 0.05 * self.speed),
            "speed_reference": Change(20.0 * self.speed, 0.2 * self.speed),
            "hook_load": Change(10.0 * self.load, 0.1 * self.load),
            "heave_velocity": Change(30.0, 1.0),
            "oil_temperature": Change(5.0, 5.0),
            "pressure_a": pressure,
            "pressure_b": pressure,
        }
        if self.crane.max_displacement:
            full = self.crane.max_displacement
            changes["displacement"] = Change(10.0 * full, 0.1 * full)
        return changes
