"""With which settings a recording is replayed: from a ROS parameter file, or from what the recording itself says."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from winch_friction.compensation import CompensatorConfig
from winch_friction.compensation.config import ReplayConfig
from winch_friction.estimation import EstimatorConfig
from winch_friction.physics.errors import InputError, from_mapping, limits_of
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.term import load_file
from winch_friction.records.input_mapping import NODES, parameters_of, refuse_without_nodes
from winch_friction.records.model_file import load_model
from winch_friction.records.strict_yaml import finite, read_yaml

OF_THE_ESTIMATOR = (("model_period", "model_period"), ("max_age", "estimator_max_age"))  # and what they are here
OF_THE_COMPENSATOR = ("model_delay", "watchdog_timeout", "stamp_window")


@dataclass(frozen=True)
class Phase:
    """A part of a recording in which the compensator ran unchanged, begun afresh.

    It begins at `start` s, or, where that is NaN, after the next pause of the recording; `seed` replaces the model that
    the replay is given.
    """

    start: float = float("-inf")
    config: CompensatorConfig = field(default_factory=CompensatorConfig)
    enabled: bool = True
    follow_models: bool = True
    name: str = ""
    seed: FrictionModel | None = None


@dataclass(frozen=True)
class ReplaySettings:
    """The settings of both services; what is in s are the nodes' own."""

    phases: tuple[Phase, ...] = (Phase(),)
    estimator: EstimatorConfig = field(default_factory=EstimatorConfig)
    model_delay: float = 0.5
    model_period: float = 5.0
    estimator_max_age: float = 0.1
    watchdog_timeout: float = 0.1
    stamp_window: float = 0.5


def settings_for_rate(max_age: float) -> ReplaySettings:
    """The nodes' defaults with another age limit (s), for a log that is slower than they allow."""
    phase = Phase(config=ReplayConfig(max_age=max_age))
    return ReplaySettings((phase,), estimator_max_age=max_age)


def longest_held() -> float:
    """The largest age limit, s, that `settings_for_rate` takes."""
    return limits_of(ReplayConfig.__dataclass_fields__["max_age"]).upper


def settings_from_metadata(metadata: Mapping[str, Any], where: str) -> ReplaySettings | None:
    """What a recording says of itself under `phases`: each with name, enabled and the compensator node's parameters.

    A phase without `start` begins after a pause. Raises `InputError` for settings and models that are not there.
    """
    if not metadata.get("phases"):
        return None
    phases = [_phase(each, k, f"{where}: phases[{k + 1}]") for k, each in enumerate(metadata["phases"])]
    estimator = from_mapping(EstimatorConfig, metadata.get("estimator", {}), f"{where}: estimator")
    return ReplaySettings(tuple(phases), estimator)


def _phase(content: Mapping[str, Any], index: int, where: str) -> Phase:
    parameters = dict(content.get("parameters", {}))
    model, follow = parameters.pop("model_file", ""), bool(parameters.pop("follow_model_topic", True))
    if terms_file := parameters.pop("terms_file", ""):
        load_file(terms_file)
    return Phase(
        start=float(content.get("start", "nan" if index else "-inf")),
        config=from_mapping(ReplayConfig, parameters, where),
        enabled=bool(content.get("enabled", True)),
        follow_models=follow,
        name=str(content.get("name", "")),
        seed=load_model(model) if model else None,
    )


def settings_from_file(path: Path, namespace: str = "") -> ReplaySettings:
    """The nodes' ROS parameter file (config/nodes/*.yaml), of several winches' that in `namespace`; what belongs to the
    nodes alone is passed over.

    Terms of a `terms_file` are registered, so read the settings before the models.
    """
    content = read_yaml(path)
    refuse_without_nodes(content, str(path))
    compensator, estimator = (parameters_of(content, node, str(path), namespace) for node in NODES)
    for each in (compensator, estimator):
        if terms_file := each.get("terms_file"):
            load_file(terms_file)
    wanted = (*((compensator, key, key) for key in OF_THE_COMPENSATOR), *((estimator, *k) for k in OF_THE_ESTIMATOR))
    own = {name: finite(of[key], f"{path}: {key}") for of, key, name in wanted if key in of}
    for name in ("model_period", "estimator_max_age"):  # the others have their ranges where they are used
        if own.get(name, 1.0) <= 0.0:
            raise InputError(f"{path}: estimator: {name.removeprefix('estimator_')} must be above 0 s")
    follow = compensator.get("follow_model_topic", True)
    if not isinstance(follow, bool):
        raise InputError(f"{path}: follow_model_topic must be true or false, found {follow!r}")
    config = from_mapping(ReplayConfig, _of(ReplayConfig, compensator), f"{path}: compensator")
    phase = Phase(config=config, follow_models=follow)
    return ReplaySettings((phase,), from_mapping(EstimatorConfig, _of(EstimatorConfig, estimator), str(path)), **own)


def _of(kind: type, parameters: Mapping[str, Any]) -> dict[str, Any]:
    names = {each.name for each in fields(kind)}
    return {key: value for key, value in parameters.items() if key in names}
