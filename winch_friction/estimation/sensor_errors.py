"""What constant errors of the sensors do to the torque that is left for friction to explain; and which of them, beside
what a wire is not damped by as it is said to be, the filter considers."""

from collections.abc import Callable, Sequence

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import ORDER
from winch_friction.physics.friction.symbols import GROUP_SIGNALS
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, driving_group

Point = tuple[float, ...]  # an operating point in the order of `compiled.layout`
FIRST_GROUP, GROUP_SIZE = len(ORDER), len(GROUP_SIGNALS)
PRESSURE, DISPLACEMENT = (
    tuple(k for k, signal in enumerate(GROUP_SIGNALS) if signal.name in names)
    for names in (("pressure", "pressure_sum"), ("displacement",))
)


class SensorErrors:
    """Constant errors of pressures and displacements, which the filter considers and never estimates.

    A relative error of the displacements and one of the pressures make the same of the drive torque, n D dp, from which
    friction cannot be told, but not of what the model's terms say of that friction: a loss that goes with D^3 takes
    three times a displacement's error. An offset between the two pressure lines of the driving group is a constant
    torque. A speed that is late sees the torque of before, by a share of what it changes by from one sample to the
    next. `std`: standard deviations of what there is, of a sample, relative (twice) and Pa: from the seed's corrections
    where it has them, else from the configuration; and the wire's damping, relative, which is no sensor's and acts
    where the wire opens (`dynamics.DAMPING`).
    """

    def __init__(self, crane: Crane, seed: FrictionModel, config: EstimatorConfig) -> None:
        self._crane = crane
        known = {
            "displacement_scale": config.displacement_scale_std,
            "pressure_scale": config.pressure_scale_std,
            "pressure_offset": config.pressure_offset_std,
        }
        for name in known:
            stated = [each.std for each in seed.corrections if each.name == name and each.std is not None]
            known[name] = max(stated, default=known[name]) if crane.drive.hydraulic else 0.0
        self._late, self._damping = config.speed_delay_std, config.wire_damping_std
        self._displacement, self._pressure, self._offset = known.values()
        self.std: Sequence[float] = tuple(each for each in (self._late, *known.values(), self._damping) if each > 0.0)

    def by(
        self, sample: Sample, drive: float, change: float, point: Point, friction: float, at: Callable[[Point], float]
    ) -> Sequence[float]:
        """Derivatives of what drives the shaft, the true drive torque less the friction of the true readings, by the
        errors.

        `drive` N m is measured, `change` N m more than at the sample before; `friction` N m is what `at` says of the
        operating `point` that is measured.
        """
        found: tuple[float, ...] = (-change,) if self._late else ()
        if self._displacement:
            found += (-drive - (at(_shifted(point, DISPLACEMENT, self._displacement)) - friction) / self._displacement,)
        if self._pressure:
            found += (-drive - (at(_shifted(point, PRESSURE, self._pressure)) - friction) / self._pressure,)
        if self._offset:
            found += (self._by_offset(sample, point, friction, at),)
        if self._damping:
            found += (0.0,)
        return found

    def _by_offset(self, sample: Sample, point: Point, friction: float, at: Callable[[Point], float]) -> float:
        groups = tuple(sample.groups)
        name = driving_group(groups)
        shown, member = list(point), sample.groups[name]
        shown[FIRST_GROUP + groups.index(name) * GROUP_SIZE + PRESSURE[0]] = abs(
            member.pressure_a - member.pressure_b - self._offset
        )
        torque = self._crane.motor_count(name) * member.displacement
        return -torque - (at(tuple(shown)) - friction) / self._offset


def _shifted(point: Point, which: Sequence[int], share: float) -> Point:
    """The operating point where these signals of every motor group are less by a share than what they show."""
    shown = list(point)
    for group in range(FIRST_GROUP, len(point), GROUP_SIZE):
        for each in which:
            shown[group + each] *= 1.0 - share
    return tuple(shown)
