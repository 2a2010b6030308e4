"""Wrong teachers: the estimator learns from a sensor that is wrong, or from another crane, while a compensator follows.

How far the feedforward goes from that of the seed, what is declared meanwhile, and whether the seed comes back.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from campaign.faults.voyages import voyage
from winch_friction.compensation import CompensatorConfig
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.friction.scaled import scaled_system
from winch_friction.records.model_file import load_model
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

SECONDS, PERIOD = 600, 0.02  # s
ORIGIN = 1.7e9  # s
SAIL = 60.0  # s of sea that repeats
STUCK_AFTER = 100.0  # s


@dataclass
class Lesson:
    """What one wrong teacher did. Torques N m, times s."""

    name: str
    largest: float = 0.0  # published at worst
    excursion: float = 0.0  # from the seed's feedforward at the same instant, at worst
    share: float = 0.0  # ... of the largest feedforward of the seed
    states: dict[str, int] = field(default_factory=dict)
    invalid: dict[str, float] = field(default_factory=dict)  # parameter -> when it was first declared
    doubted: dict[str, float] = field(
        default_factory=dict
    )  # what else was said of the seed or the inputs -> when first
    refused: int = 0
    back: float = 0.0  # parameters off the seed after ~/reset, relative, the worst
    bump: float = 0.0  # off the seed's feedforward a ramp time after the seed was loaded


def spoilt(name: str) -> Callable[[Any, float], None]:
    """What happens to the active group's sensors of a sample, t s after the beginning."""
    held: dict[str, float] = {}

    def pressure(drift: float) -> Callable[[Any, float], None]:
        def spoil(sample: Any, time: float) -> None:
            sample.groups["active"].pressure_a += drift * time / SECONDS

        return spoil

    def stuck(channel: str) -> Callable[[Any, float], None]:
        def spoil(sample: Any, time: float) -> None:
            if time > STUCK_AFTER:
                active = sample.groups["active"]
                setattr(active, channel, held.setdefault(channel, getattr(active, channel)))

        return spoil

    def displacement(sample: Any, time: float) -> None:
        sample.groups["active"].displacement *= 1.0 - 0.2 * time / SECONDS

    def load(sample: Any, time: float) -> None:
        sample.hook_load *= 1.0 + 0.3 * time / SECONDS

    return {
        "pressure drifts 10 bar": pressure(1e6), "pressure drifts 60 bar": pressure(6e6),
        "valve stuck: pressure A held": stuck("pressure_a"), "displacement drifts 20 %": displacement,
        "load cell drifts 30 %": load,
    }.get(name, lambda *_: None)  # fmt: skip


NAMES = (
    "healthy", "pressure drifts 10 bar", "pressure drifts 60 bar", "valve stuck: pressure A held",
    "displacement drifts 20 %", "load cell drifts 30 %", "data of another crane", "friction tripled",
)  # fmt: skip


def samples_of(name: str) -> tuple[Any, ...]:
    """A minute of sea: of this crane, of one with other friction, or of another crane's motors and drum."""
    sea = voyage("ahc_irregular", 1)
    truth = {"data of another crane": load_model("a6vm215_crane1"), "friction tripled": scaled_system(sea.model, 3.0)}
    if name not in truth:
        return sea.samples
    run = simulate(load_scenario("ahc_irregular").override({"duration": SAIL}), sea.crane, truth[name], seed=1).run
    return tuple(each for each in run.samples() if each.motor_speed == each.motor_speed)


def lesson(name: str, seconds: float = SECONDS) -> Lesson:
    """Ten minutes of learning from one teacher, with a compensator that follows and one that stays with the seed."""
    sea, said, spoil = voyage("ahc_irregular", 1), Lesson(name), spoilt(name)
    samples = samples_of(name)
    estimator = EstimatorService(sea.crane, sea.model, sea.topics)
    config = CompensatorConfig(scale=1.0)
    follows, stays = (CompensatorService(sea.crane, sea.model, sea.topics, config) for _ in range(2))
    largest_seed = 0.0
    steps = int(seconds / PERIOD)
    for k in range(steps + int(2.0 * config.ramp_time / PERIOD)):
        if k == steps:
            estimator.reset()
            follows.load_model(sea.model)
        time = PERIOD * k
        sample = samples[k % len(samples)]
        fed = replace(sample, time=ORIGIN + time, groups={n: replace(g) for n, g in sample.groups.items()})
        spoil(fed, time)
        one, other = (each.take_row(_copy(fed), ORIGIN + time) for each in (follows, stays))
        apart = abs(one.friction_torque - other.friction_torque)
        if k >= steps:
            said.bump = apart
            continue
        estimator.take_row(fed, ORIGIN + time)
        said.largest = max(said.largest, abs(one.friction_torque))
        said.excursion, largest_seed = max(said.excursion, apart), max(largest_seed, abs(other.friction_torque))
        model = estimator.model_due(ORIGIN + time)
        if model is not None:
            follows.offer(model)
        if k % 50 == 0:
            state = str(estimator.status(ORIGIN + time)["state"])
            said.states[state] = said.states.get(state, 0) + 1
            if estimator.contradiction:
                said.doubted.setdefault("inputs contradict", time)
            if estimator.law.status()["seed"] == "refuted":
                said.doubted.setdefault("seed refuted", time)
            for each in estimator.parameters():
                if each.status == "invalid":
                    said.invalid.setdefault(each.name, time)
    said.share, said.refused = said.excursion / max(largest_seed, 1e-9), len(follows.refused_models)
    learned = zip(estimator.law.model().values, sea.model.values, strict=True)
    said.back = max(abs(a / b - 1.0) for a, b in learned if b)
    return said


def _copy(sample: Any) -> Any:
    return replace(sample, groups={name: replace(each) for name, each in sample.groups.items()})


def lessons() -> list[Lesson]:
    """All of them."""
    return [lesson(name) for name in NAMES]


def table(said: list[Lesson]) -> str:
    """The page's part."""
    head = (
        "| teacher | largest feedforward N m | furthest from the seed's N m | of its largest | estimator | declared "
        "invalid, after s | said besides, after s | off the seed after reset | feedforward off the seed's N m |\n"
        "|---|---|---|---|---|---|---|---|---|\n"
    )
    return head + "\n".join(
        f"| {each.name} | {each.largest:.0f} | {each.excursion:.0f} | {100 * each.share:.0f} % | {_states(each)} | "
        f"{_first(each.invalid)} | {_first(each.doubted)} | {100 * each.back:.1g} % | "
        f"{each.bump:.1f} |"
        for each in said
    )


def _first(said: dict[str, float]) -> str:
    return ", ".join(f"{name} {time:.0f}" for name, time in said.items()) or "none"


def _states(said: Lesson) -> str:
    total = max(sum(said.states.values()), 1)
    return ", ".join(f"{name} {100 * count / total:.0f} %" for name, count in sorted(said.states.items()))
