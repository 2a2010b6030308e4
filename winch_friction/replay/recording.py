"""A recording through both objects as the nodes took it: live equals replay."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from typing import Any

from winch_friction.estimation import ParameterEstimate
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.bag_file import Other, open_bag
from winch_friction.records.bag_storage import lost_of
from winch_friction.records.bags import bag_metadata
from winch_friction.records.runs import is_bag, read_run
from winch_friction.records.topics import TopicMap
from winch_friction.replay.clock import ReplayClock
from winch_friction.replay.live import Comparison, compare_live
from winch_friction.replay.settings import ReplaySettings, settings_from_metadata
from winch_friction.replay.voices import CompensatorVoice, EstimatorVoice

MODEL_TOPIC = "/friction_model"
Told = Callable[[int], object]  # hears how many whole seconds of a recording are done: for a progress bar
MUCH = 0.1  # of the samples; a start, and single lost messages, are less


def _silent(seconds: int) -> None:
    """Nobody listens."""


@dataclass(frozen=True)
class Replayed:
    """The outputs along a recording, as from `replay_compensator` and `replay_estimator`, and what was learned.

    `compensator` has a row for each sample, `watchdog` one for each message that was published in a silence.
    """

    compensator: Run
    estimator: Run
    model: FrictionModel
    parameters: tuple[ParameterEstimate, ...]
    status: Mapping[str, Any]
    warnings: tuple[str, ...] = ()
    live: tuple[Comparison, ...] = field(default=())
    watchdog: Run | None = None


def replay_recording(
    path: Path | str,
    crane: Crane,
    seed: FrictionModel,
    settings: ReplaySettings | None = None,
    *,
    learn: bool = True,
    told: Told = _silent,
    **bag_options: Any,
) -> Replayed:
    """Replay a bag or a run file through compensator and estimator.

    The compensator takes over the models recorded on `friction_model`; without any, and with `learn`, those that the
    estimator learns here, at the times at which the node would have published them. `settings` default to what the
    recording says of itself, else to the nodes' defaults. `told` hears each second that is done.
    `bag_options` go to `open_bag`. Raises `InputError`.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file or folder")
    if is_bag(path):
        return _replay_bag(path, crane, seed, settings, learn, told, bag_options)
    return replay_run(read_run(path, crane), crane, seed, settings or ReplaySettings(), learn=learn, told=told)


def replay_run(
    run: Run, crane: Crane, seed: FrictionModel, settings: ReplaySettings, *, learn: bool = True, told: Told = _silent
) -> Replayed:
    """Replay a run; NaN entries are bridged up to the maximum ages, as in the nodes. `told` hears each second."""
    topics = TopicMap(groups=run.groups)
    begin = float(run.time[0])
    compensator = CompensatorVoice(crane, seed, topics, settings, begin)
    estimator = EstimatorVoice(crane, seed, topics, settings, begin)
    done = 0
    for now, _, learned in zip(run.time, compensator.take_rows(run), estimator.take_rows(run), strict=True):
        if now >= begin + done + 1:
            told(done := int(now - begin))
        if learned is not None and learn:
            compensator.offer(learned)
    return _replayed(run.name, compensator, estimator, run.warnings)


def _replay_bag(
    path: Path,
    crane: Crane,
    seed: FrictionModel,
    settings: ReplaySettings | None,
    learn: bool,
    told: Told,
    options: dict[str, Any],
) -> Replayed:
    metadata, spoilt = bag_metadata(path)
    settings = settings or settings_from_metadata(metadata, str(path)) or ReplaySettings()
    with open_bag(path, crane, **options) as bag:
        begin = next((each.stamp for each in bag.inputs()), -inf)
        compensator = CompensatorVoice(crane, seed, bag.topics, settings, begin)
        estimator, clock = EstimatorVoice(crane, seed, bag.topics, settings, begin), ReplayClock()
        recorded, done = bag.topics_ending(MODEL_TOPIC), 0
        for each in bag.events(*recorded):
            if isinstance(each, Other):
                compensator.offer_text(each.message.data, each.topic)
                continue
            now = clock.read(each.stamp, each.receipt)
            if done + 1 <= each.stamp - begin < inf:
                told(done := int(each.stamp - begin))
            compensator.take(each, now)
            learned = estimator.take(each, now)
            if learned is not None and learn and not recorded:
                compensator.offer(learned)
        warnings = (*spoilt, *bag.warnings)
        if not len(compensator.steps):
            raise InputError(f"{path}: nothing to replay: {bag.no_speed()}", *lost_of(warnings))
    replayed = _replayed(path.name, compensator, estimator, warnings)
    runs = {name: getattr(replayed, name) for name in ("compensator", "estimator", "watchdog")}
    return replace(replayed, live=tuple(compare_live(path, runs, crane=crane, **options)))


def _replayed(
    name: str, compensator: CompensatorVoice, estimator: EstimatorVoice, warnings: tuple[str, ...]
) -> Replayed:
    refused = tuple(dict.fromkeys(f"{name}: model refused: {each}" for each in compensator.refused))
    lacking = (
        *_lacking(f"{name}: the compensator", compensator.lacked, len(compensator.steps)),
        *_lacking(f"{name}: the estimator", estimator.lacked, len(compensator.steps)),
    )
    return Replayed(
        compensator=compensator.steps.run(name),
        estimator=estimator.record.run(name),
        model=estimator.service.law.model(),
        parameters=tuple(estimator.service.law.parameters()),
        status=estimator.service.law.status(),
        warnings=(*warnings, *refused, *lacking),
        watchdog=compensator.watchdog.run(name),
    )


def _lacking(where: str, lacked: Mapping[str, int], samples: int) -> list[str]:
    """What a node of a replay did without, or doubted, for a while that counts."""
    shares = {what: count / max(samples, 1) for what, count in lacked.items()}
    said = [f"{what} ({100.0 * share:.0f} % of the samples)" for what, share in shares.items() if share > MUCH]
    return [f"{where} lacked or doubted {', '.join(said)}"] if said else []
