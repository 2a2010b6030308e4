"""What one sample says: whether it is usable, the drive's torque and its noise, the hanging load."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import LOST, Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque, sample_load
from winch_friction.physics.winch.operating_point import ChannelRanges

# steps of lengths within this factor of each other tell how a torque bends from one to the next
ALIKE_STEPS = 2.0


class Accepted(NamedTuple):
    """Time s, drive torque N m, measured speed rad/s, heave velocity m/s, wire layer (NaN: not measured); by how much
    the drive torque changed on the way here, N m, and in how many s (NaN: nothing came before)."""

    time: float
    drive: float
    speed: float
    heave: float
    layer: float
    change: float = math.nan
    duration: float = math.nan

    def after(self, last: "Accepted") -> "Accepted":
        """The same, with what it was accepted after."""
        return self._replace(change=self.drive - last.drive, duration=self.time - last.time)

    def bend(self, now: "Accepted") -> float:
        """The second difference of the drive torque up to the next sample, N m; 0 where the steps are too unlike."""
        ratio = (now.time - self.time) / self.duration  # NaN where nothing came before
        if not 1.0 / ALIKE_STEPS <= ratio <= ALIKE_STEPS:
            return 0.0
        return now.drive - self.drive - ratio * self.change

    def means(self, now: "Accepted", delay: float) -> tuple[float, float]:
        """Mean drive torque, N m, and heave velocity, m/s, from `delay` s before this sample to `delay` s before the
        next one, on straight lines: what acted while a speed that is late by so much went from one to the other."""
        drive, heave = 0.5 * (self.drive + now.drive), 0.5 * (self.heave + now.heave)
        if delay == 0.0:
            return drive, heave
        share = min(1.0, delay / (now.time - self.time))  # a longer one would be guessed from a single step
        drive -= share * (now.drive - self.drive - 0.5 * share * self.bend(now))
        return drive, heave - share * (now.heave - self.heave)


def accepted(sample: Sample, crane: Crane) -> Accepted:
    """What is kept of this sample."""
    drive = sample_drive_torque(sample, crane)
    return Accepted(sample.time, drive, sample.motor_speed, heave_velocity(sample), sample.wire_layer)


def heave_velocity(sample: Sample) -> float:
    """Velocity of the crane tip, m/s; a crane that does not say stands still."""
    return sample.heave_velocity if math.isfinite(sample.heave_velocity) else 0.0


def usable(sample: Sample, ranges: ChannelRanges, needed: Sequence[str] = ()) -> bool:
    """Whether the sample has a time, and a speed, drive, and wire layer, load and heave (or none) of this crane's, and
    what the model's terms `needed` beside them."""
    plausible, weight, force, heave = ranges.plausible, sample.hook_load, sample.rope_force, sample.heave_velocity
    if not (math.isfinite(sample.time) and plausible("motor_speed", sample.motor_speed)):
        return False
    if not ranges.crane.drum.has(sample.wire_layer) or absent(sample, ranges, needed):
        return False
    if weight == weight and not plausible("hook_load", weight):
        return False
    if force == force and not plausible("rope_force", force):
        return False
    if heave == heave and not plausible("heave_velocity", heave):
        return False
    if sample.wire_out == LOST:
        return False
    return not ranges.crane.drive.lacking(sample, plausible)


def absent(sample: Sample, ranges: ChannelRanges, needed: Sequence[str]) -> tuple[str, ...]:
    """Which of these channels the sample does not have, or not within what the crane can show."""
    return tuple(name for name in needed if not ranges.plausible(name, getattr(sample, name)))


def saturated(sample: Sample, crane: Crane, config: EstimatorConfig) -> bool:
    """Whether the drive is at a limit, where what is measured is not what acts."""
    if not crane.drive.hydraulic:
        return abs(crane.drive.of_sample(sample, crane)) > config.saturation_torque * crane.motor_total(())
    limit = config.saturation_pressure
    for group in sample.groups.values():  # noqa: SIM110 - a generator would be half a microsecond of every step
        if group.pressure_a > limit or group.pressure_b > limit:
            return True
    return False


def torque_variance(sample: Sample, crane: Crane, config: EstimatorConfig) -> float:
    """Variance of the drive torque in (N m)^2 from the noise of pressures and displacements, or of the motor torque."""
    if not crane.drive.hydraulic:
        return (crane.motor_total(()) * config.torque_noise) ** 2
    total = 0.0
    for name, group in sample.groups.items():
        full = crane.motor_count(name) * group.displacement
        by_displacement = full * (group.pressure_a - group.pressure_b) * config.displacement_noise
        by_pressure = full * config.pressure_noise
        total += 2.0 * by_pressure * by_pressure + by_displacement * by_displacement
    return total


LEAST_LOAD = 0.01  # of the rated one: a load cell's class; a share of less than that would be one of its zero error
PICKED_UP = 0.1  # a relative change of the measured mass beyond this is another load, not noise


class HangingLoad:
    """Low-passed hook load, or the mass that the measured rope force carries, and what follows from it."""

    def __init__(self, crane: Crane, time_constant: float) -> None:
        self._crane = crane
        self._time_constant = time_constant
        held = 0.5 * ChannelRanges(crane).load if crane.drive.hydraulic else 0.0  # where no rated load is known
        self._least = LEAST_LOAD * (crane.rated_load or held)  # kg
        self.mass = math.nan  # kg; NaN: not measured
        self.doubted = False  # another load than the measured one was found

    def following(self, sample: Sample, dt: float) -> float:
        """The mass after `dt` s more of a measured one in kg; one that is not finite leaves it, a cell whose zero is a
        little below shows an empty hook."""
        measured = max(sample_load(sample), 0.0)  # NaN stays
        if not math.isfinite(measured):
            return self.mass
        if not abs(measured - self.mass) <= PICKED_UP * self.mass:
            return measured
        return self.mass + (measured - self.mass) * dt / (dt + self._time_constant)

    @property
    def measured(self) -> bool:
        """Whether a mass is known from a load cell."""
        return math.isfinite(self.mass)

    def shaft_torque(self, layer: float) -> float:
        """T_d / i of the measured mass, N m; 0 without one."""
        return self._crane.drum_torque(self.mass, layer) / self._crane.gear_ratio if self.measured else 0.0

    def share(self, torque: float, layer: float) -> float:
        """A torque at the shaft in N m as a share of the measured load's, or of `LEAST_LOAD` where that is more: a hook
        without a load, and a load cell that is dead, show next to nothing. NaN where no load is measured."""
        least = self._crane.drum_torque(self._least, layer) / self._crane.gear_ratio
        whole = max(self.shaft_torque(layer), least)
        return torque / whole if self.measured and whole else math.nan

    def is_another(self, torque: float, sample: Sample) -> bool:
        """Whether a doubted load that is shown still lacks more than noise: a torque at the shaft in N m that is not
        small beside it. Once it does not, the doubt is over."""
        if self.doubted:
            shown = math.isfinite(sample_load(sample))
            self.doubted = shown and abs(self.share(torque, sample.wire_layer)) > PICKED_UP
        return self.doubted

    def mass_by(self, shaft_torque: float, layer: float) -> float:
        """The measured mass, else the one that a load torque at the shaft means; kg."""
        if self.measured:
            return self.mass
        return max(0.0, shaft_torque * self._crane.gear_ratio / (GRAVITY * self._crane.drum.radius(layer)))
