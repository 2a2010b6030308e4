"""A bag as a run: one row per speed message, every other input held as in the nodes."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.errors import InputError
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import GROUP_CHANNELS, SAMPLE_SCALARS, FloatArray, Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.bag_file import Bag, open_bag
from winch_friction.records.run_checks import Place, checked_run
from winch_friction.records.sample_stream import SampleStream

METADATA_KEY = "winch_friction"


def read_bag(
    path: Path | str,
    crane: Crane | None = None,
    *,
    max_age: float = 0.1,
    max_ages: dict[str, float] | None = None,
    complete: bool = True,
    **options: Any,
) -> Run:
    """A run from a bag, sampled at the speed topic by latest-sample hold with age limits in s.

    `complete=False` asks for the speed alone; `options` go to `open_bag`. Raises `InputError`; times that go back (a
    bag of two recordings) are refused.
    """
    path = Path(path)
    with open_bag(path, crane, **options) as bag:
        samples = bag_samples(bag, InputHold(bag.topics.groups, max_age, {**SLOW_INPUTS, **(max_ages or {})}))
        warnings, speed = list(bag.warnings), bag.actual[bag.topics.speed_topic]
        groups = bag.topics.groups
    if not samples:
        raise InputError(f"{path}: topic '{speed}' has no finite speed of the winch's joint")
    place: Place = lambda row: f"sample {row + 1} of '{speed}'"
    columns = _columns(samples, groups)
    return checked_run(
        path.name, columns, place=place, crane=crane, complete=complete, warnings=warnings, metadata=bag_metadata(path)
    )


def bag_samples(bag: Bag, hold: InputHold) -> list[Sample]:
    """The samples that a node would have made of a bag's messages."""
    stream = SampleStream(bag.topics, hold)
    taken = (stream.take(each.source, each.message, each.receipt) for each in bag.inputs())
    return [sample for sample in taken if sample is not None]


def _columns(samples: Sequence[Sample], groups: Sequence[str]) -> dict[str, FloatArray]:
    columns = {"time": np.array([sample.time for sample in samples])}
    for name in SAMPLE_SCALARS:
        columns[name] = np.array([getattr(sample, name) for sample in samples])
    for group in groups:
        for channel in GROUP_CHANNELS:
            columns[f"{group}.{channel}"] = np.array([getattr(s.groups[group], channel) for s in samples])
    # a channel that no message ever carried is absent, not lost
    return {name: values for name, values in columns.items() if name == "motor_speed" or not np.isnan(values).all()}


def bag_metadata(path: Path) -> dict[str, Any]:
    """What this package wrote about a recording beside its messages; empty for a recording of another origin."""
    file = path / "metadata.yaml"
    if not file.is_file():
        return {}
    custom = (yaml.safe_load(file.read_text(encoding="utf-8")) or {}).get("rosbag2_bagfile_information", {})
    return dict(json.loads((custom.get("custom_data") or {}).get(METADATA_KEY, "{}")))
