"""A bag as a run: one row per speed message, every other input held as in the nodes."""

import re
from array import array
from collections.abc import Iterable, Iterator, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GROUP_CHANNELS, SAMPLE_SCALARS, FloatArray, Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.bag_file import Bag, open_bag
from winch_friction.records.bag_storage import lost_of
from winch_friction.records.plain import own_metadata
from winch_friction.records.run_checks import Place, checked_run
from winch_friction.records.sample_stream import InputHold, SampleStream

METADATA_KEY = "winch_friction"
_LEFT_OUT = "messages are left out"
_ALL_LEFT_OUT = re.compile(rf"\b(\d+) of \1 {_LEFT_OUT}")


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
        groups = bag.topics.groups
        hold = InputHold(groups, max_age, {**SLOW_INPUTS, **(max_ages or {})})
        columns = _columns(bag_samples(bag, hold), groups)
        warnings, speed = list(bag.warnings), bag.actual[bag.topics.speed_topic]
        if not len(columns["time"]):
            raise InputError(f"{path}: {bag.no_speed()}", *lost_of(warnings))
    if len(columns["time"]) > 1 and not np.ptp(columns["time"]):
        raise InputError(
            f"{path}: every message on '{speed}' is stamped {columns['time'][0]:g} s: its sender knows no time; "
            "winch-friction import takes the times of receipt"
        )
    place: Place = lambda row: f"sample {row + 1} of '{speed}'"
    metadata, spoilt = bag_metadata(path)
    try:
        return checked_run(
            path.name, columns, place=place, crane=crane, complete=complete, warnings=[*warnings, *spoilt],
            metadata=metadata,
        )  # fmt: skip
    except InputError as refused:  # a column that is missing may be one of which nothing was believed
        raise InputError(*refused.problems, *filter(_ALL_LEFT_OUT.search, warnings)) from None


def bag_samples(bag: Bag, hold: InputHold) -> Iterator[Sample]:
    """The samples that a node would have made of a bag; its warnings tell at the end what was not believed."""
    stream = SampleStream(bag.topics, hold)
    for each in bag.inputs():
        sample = stream.take(each.source, each.message, each.receipt)
        if sample is not None:
            yield sample
    bag.warnings += [
        f"{bag.name}: topic '{bag.actual[topic]}': {count} of {stream.counts[topic]} {_LEFT_OUT}: without a finite "
        "value of the winch's joint, out of order, or beyond what any sensor gives"
        for topic, count in stream.rejected.items()
    ]


def _columns(samples: Iterable[Sample], groups: Sequence[str]) -> dict[str, FloatArray]:
    """Samples as columns; only their numbers are kept: an hour at 50 Hz as objects takes 200 MB."""
    scalars, values = attrgetter("time", *SAMPLE_SCALARS), attrgetter(*GROUP_CHANNELS)
    rows = array("d")
    for sample in samples:
        rows.extend(scalars(sample))
        for group in groups:
            rows.extend(values(sample.groups[group]))
    names = ["time", *SAMPLE_SCALARS, *(f"{group}.{channel}" for group in groups for channel in GROUP_CHANNELS)]
    table = np.frombuffer(rows).reshape(-1, len(names))
    # a channel that no message ever carried is absent, not lost
    kept = [k for k, name in enumerate(names) if name in ("time", "motor_speed") or not np.isnan(table[:, k]).all()]
    return {names[k]: table[:, k].copy() for k in kept}


def bag_metadata(path: Path) -> tuple[dict[str, Any], list[str]]:
    """What this package wrote about a recording beside its messages, and what is to be said where it cannot be read.

    Empty for a recording of another origin, and for a metadata.yaml that is none: whoever opens the bag says that.
    """
    file = path / "metadata.yaml"
    if not file.is_file():
        return {}, []
    try:
        written = yaml.safe_load(file.read_text(encoding="utf-8"))
        own = written["rosbag2_bagfile_information"]["custom_data"][METADATA_KEY]
    except (yaml.YAMLError, UnicodeDecodeError, KeyError, TypeError):
        return {}, []
    return own_metadata(own, path.name)
