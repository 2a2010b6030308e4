"""A simulated sea that can be sailed again and again while the time goes on, and the answers that it waits for."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.simulation.scenario import Scenario
from winch_friction.simulation.simulator import Simulator

GAP = 2.0  # s of time between one voyage and the next


def hidden_effects(names: Sequence[str]) -> list[tuple[str, float]]:
    """`name` or `name=size` as pairs; the size 1 is the typical one."""
    pairs = []
    for each in names:
        name, _, size = each.partition("=")
        try:
            pairs.append((name, float(size or 1.0)))
        except ValueError:
            raise InputError(f"hidden effect '{each}': the size after = must be a number") from None
    return pairs


def adjusted(scenario: Scenario, sensor_rate: float, duration: float) -> Scenario:
    """The scenario with another sensor rate in Hz or duration in s where these are above 0."""
    changes: dict[str, float] = {"duration": duration} if duration else {}
    if sensor_rate:
        scans = 1.0 / sensor_rate
        changes |= {"sensors.rate": sensor_rate, "control_period": scans / max(1, round(scans / 0.01))}
    return scenario.override(changes)


class Voyage:
    """Sails one scenario, or one leg after the other, again and again; stamps only grow.

    They are the time since a leg's start plus an origin. `scenario` is the leg being sailed.
    """

    def __init__(
        self,
        scenario: Scenario,
        crane: Crane,
        truth_model: FrictionModel,
        seed: int,
        hidden: Sequence[tuple[str, float]] = (),
        legs: Sequence[Scenario] = (),
    ) -> None:
        self.scenario, self.crane, self.truth_model, self.seed, self.hidden = scenario, crane, truth_model, seed, hidden
        self._legs, self._begun = (scenario, *legs), 0
        self.samples = 0
        self._origin: float | None = None
        self._simulator = self._fresh()
        self._simulator.step(0.0)  # compiles now, not while the nodes wait

    def _fresh(self) -> Simulator:
        return Simulator(self.scenario, self.crane, self.truth_model, seed=self.seed, hidden=self.hidden)

    def begin(self, origin: float, gap: float = GAP) -> None:
        """The next leg, from its start, dated `origin` s or, after another, at least `gap` s after its end."""
        self._origin = origin if self._origin is None else max(self.now + gap, origin)
        self.scenario = self._legs[self._begun % len(self._legs)]
        self._begun += 1
        del self._simulator  # 10 MB of history and noise: not twice at a time
        self._simulator = self._fresh()
        self.samples = 0

    @property
    def elapsed(self) -> float:
        """Time since this voyage began, s."""
        return self._simulator.time

    @property
    def now(self) -> float:
        """What the clock says, s."""
        return (self._origin or 0.0) + self._simulator.time

    @property
    def progress(self) -> float:
        """Share of the voyage that is over."""
        return self._simulator.time / self.scenario.duration

    @property
    def finished(self) -> bool:
        """Whether it is over."""
        return self._simulator.finished

    @property
    def sample(self) -> Sample:
        """The latest scan, dated by the clock."""
        latest = self._simulator.sample
        return replace(latest, time=latest.time - self.scenario.start_time + (self._origin or 0.0))

    def advance(self, torque: float) -> bool:
        """Go on to the next scan with this feedforward in N m; False when the voyage ended before one came."""
        while not self._simulator.finished:
            self._simulator.step(torque)
            if self._simulator.fresh:
                self.samples += 1
                return True
        return False

    def truth(self) -> dict[str, float]:
        """The plant now."""
        return self._simulator.truth()


@dataclass
class Answers:
    """Which of the awaited topics have answered the latest sample."""

    topics: tuple[str, ...]
    unanswered: int = 0
    _stamps: dict[str, float] = field(default_factory=dict)
    _awaited: float = float("-inf")
    _since: float = float("inf")

    def expect(self, stamp: float, now: float) -> None:
        """A sample with this stamp went out at steady time `now`."""
        self._awaited, self._since = stamp, now

    def take(self, topic: str, stamp: float) -> None:
        """An answer came."""
        self._stamps[topic] = max(stamp, self._stamps.get(topic, float("-inf")))

    @property
    def complete(self) -> bool:
        """Whether every topic has answered."""
        return all(self._stamps.get(topic, float("-inf")) >= self._awaited for topic in self.topics)

    def overdue(self, now: float, patience: float) -> bool:
        """Whether it was waited long enough; counted."""
        late = now - self._since > patience
        self.unanswered += late
        return late

    def clear(self) -> None:
        """Before another voyage."""
        self._awaited = float("-inf")
        self._stamps.clear()
