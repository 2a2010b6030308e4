"""What is measured: a `Sample` is one instant, a `Run` is equally long columns over time (docs/interfaces.md).

Everything is SI. An absent scalar is NaN in a `Sample` and a missing key in a `Run`.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from itertools import repeat
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from winch_friction.physics.channels import GROUP_CHANNELS, SAMPLE_SCALARS, column_unit, limits_of
from winch_friction.physics.errors import InputError, counted

__all__ = [
    "ASSUMED", "GROUP_CHANNELS", "LOST", "NAN", "SAMPLE_SCALARS", "FloatArray", "GroupSample", "Run", "Sample",
    "LARGEST", "column_unit", "readable",
]  # fmt: skip

FloatArray = NDArray[np.float64]
NAN = float("nan")
# where these are absent something is assumed: a crane that stands still, the outer layer, a usual length of wire.
# What was there and is not any more is LOST, which no sensor shows: nothing is known then
ASSUMED, LOST = ("heave_velocity", "wire_layer", "wire_out"), float("inf")
LARGEST = 1e100  # SI; no sensor says it in any unit, and squares and sums of what is less are numbers


def readable(values: FloatArray) -> FloatArray:
    """A column, (samples,), without what is infinite or beyond `LARGEST` (NaN); itself where there is none."""
    beyond = np.abs(values) >= LARGEST
    return np.where(beyond, NAN, values) if beyond.any() else values


@dataclass(slots=True)
class GroupSample:
    """One motor group at one instant: pressures in Pa, displacement in m^3/rad per motor.

    >>> import winch_friction as wf
    >>> wf.GroupSample(pressure_a=180e5, pressure_b=25e5, displacement=3.4e-5).pressure_a
    18000000.0
    """

    pressure_a: float = NAN
    pressure_b: float = NAN
    displacement: float = NAN


@dataclass(slots=True)
class Sample:
    """One instant of the winch, SI units; NaN where a channel is absent. Its fields are those of `channels`.

    >>> import winch_friction as wf
    >>> sample = wf.Sample(time=0.0, motor_speed=50.0, groups={"main": wf.GroupSample(180e5, 25e5, 3.4e-5)})
    >>> sample.groups["main"].pressure_b, sample.hook_load
    (2500000.0, nan)
    """

    time: float
    motor_speed: float
    speed_reference: float = NAN
    groups: dict[str, GroupSample] = field(default_factory=dict)
    motor_torque: float = NAN
    hook_load: float = NAN
    heave_velocity: float = NAN
    oil_temperature: float = NAN
    wire_layer: float = NAN
    wire_out: float = NAN
    shaft_angle: float = NAN
    load_torque: float = NAN
    rope_force: float = NAN
    mechanical_power: float = NAN
    motor_current: float = NAN


_SAMPLE_FIELDS = tuple(each.name for each in fields(Sample))


@dataclass(frozen=True)
class Run:
    """Equally long columns over `time`.

    Parameters: `name` is the run's identity (its file name), `columns` maps contract names to float arrays of one
    length in SI, `aside` keeps unknown columns untouched, `warnings` says what was noticed while reading,
    `metadata` carries provenance (scenario, seed, source). Raises `InputError` for unequal lengths.

    >>> import winch_friction as wf
    >>> group = {"main.pressure_a [bar]": [100, 120], "main.pressure_b": [2e6, 2e6], "main.displacement": [3e-5, 3e-5]}
    >>> run = wf.from_frame({"time": [0.0, 0.5], "motor_speed [rpm]": [0.0, 600.0], **group}, "start")
    >>> len(run), run.time.tolist(), run.groups, run.units["main.pressure_a"]
    (2, [0.0, 0.5], ('main',), 'Pa')
    >>> run["motor_speed"].round(1).tolist(), "hook_load" in run, run.column("hook_load", 55e3).tolist()
    ([0.0, 62.8], False, [55000.0, 55000.0])
    >>> run.to_frame().shape, run.to_xarray()["motor_speed"].attrs["units"]
    ((2, 4), 'rad/s')
    >>> [round(sample.groups["main"].pressure_a / 1e5) for sample in run.samples()]
    [100, 120]
    """

    name: str
    columns: Mapping[str, FloatArray]
    aside: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    metadata: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        lengths = {column: len(values) for column, values in self.columns.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"{self.name}: columns differ in length: {lengths}; every column needs one value per time")

    def __len__(self) -> int:
        return len(self.columns["time"])

    def __contains__(self, column: str) -> bool:
        return column in self.columns

    def __getitem__(self, column: str) -> FloatArray:
        if column not in self.columns:
            raise InputError(f"{self.name}: column '{column}' is missing; the run has {', '.join(self.columns)}")
        return self.columns[column]

    @property
    def time(self) -> FloatArray:
        """Time in s."""
        return self["time"]

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the motor groups, in the order of their columns."""
        found = (column.rpartition(".") for column in self.columns if "." in column)
        return tuple(dict.fromkeys(group for group, _, channel in found if channel in GROUP_CHANNELS))

    def column(self, name: str, default: float = NAN) -> FloatArray:
        """A column, or `default` throughout when it is absent."""
        return self.columns[name] if name in self.columns else np.full(len(self), default)

    @property
    def units(self) -> dict[str, str]:
        """SI unit of every column; '1' for a plain number."""
        return {name: column_unit(name) or "1" for name in self.columns}

    def to_frame(self) -> Any:
        """The run as a pandas DataFrame over `time`, SI; `frame.attrs["units"]` names the units."""
        from winch_friction.physics.frames import run_frame

        return run_frame(self, self.units)

    def to_xarray(self) -> Any:
        """The run as an xarray Dataset over `time`, SI, the unit in each variable's attributes."""
        from winch_friction.physics.frames import run_dataset

        return run_dataset(self, self.units)

    def __repr__(self) -> str:
        span = f"{self.time[0]:.6g} ... {self.time[-1]:.6g} s" if len(self) else "empty"
        return f"Run '{self.name}': {len(self)} samples, {span}, columns {', '.join(self.columns)}"

    def _repr_html_(self) -> str:
        from winch_friction.physics.frames import html_table

        rows = [(n, self.units[n], float(np.nanmin(v)), float(np.nanmax(v)), int(np.isnan(v).sum()))
                for n, v in self.columns.items() if np.isfinite(v).any()]  # fmt: skip
        return html_table(repr(self).partition(", columns")[0], ("column", "unit", "least", "largest", "missing"), rows)

    def samples(self) -> Iterator[Sample]:
        """The run as samples, in order: what a node would have been given."""
        groups = self.groups
        members = [map(GroupSample, *(self._values(f"{g}.{channel}") for channel in GROUP_CHANNELS)) for g in groups]
        by_group = zip(*members, strict=True) if members else repeat((), len(self))
        named = (dict(zip(groups, each, strict=True)) for each in by_group)
        yield from map(Sample, *(named if each == "groups" else self._values(each) for each in _SAMPLE_FIELDS))

    def _values(self, column: str) -> Iterator[float]:
        """A column's values as floats, one by one: lists of all of them take four times the run's memory."""
        if column not in self.columns:
            return repeat(NAN)
        return iter(np.ascontiguousarray(self.columns[column], np.float64).data)


# -- a channel that is cut off at an end of its sensor's range
AT_END, SPELLS = 5, 3  # samples in a row at an end, and how often: a crest rests there once or twice
ENTERED = 3  # steps before a spell and after it, by which it is entered and left
SLOPE = 0.5  # of the usual step: a crest of coarse digits is entered by a fifth of it, a ramp that is cut off by most
CHANGES = 0.8  # of the other steps, in which a channel of fine digits changes; an ideal ramp rests elsewhere as well
MOST_AT_END = 0.5  # of the samples that are not zero; more are a plateau, and no end of a range


def ends_of_range(values: FloatArray) -> tuple[float, ...]:
    """The ends of a sensor's range that what is measured has passed: the channel comes there by the steps that it
    usually makes, stays there to the last digit again and again, and never goes beyond; none of any other channel."""
    known = values[np.isfinite(values)]
    if not len(known):
        return ()
    at = np.isin(values, [each for each in (known.min(), known.max()) if each != 0.0])  # at zero a winch stands
    spells = _spells(at)
    inside = [(a, b) for a, b in spells if a > ENTERED and b + ENTERED < len(values)]
    steps = np.abs(np.diff(values))
    others = steps[~(at[1:] | at[:-1]) & (values[1:] != 0.0) & np.isfinite(steps)]
    if len(inside) < SPELLS or not len(others) or at.sum() > MOST_AT_END * np.sum(known != 0.0):
        return ()
    ways = [(values[a - 1] - values[a - 1 - ENTERED], values[b] - values[b + ENTERED]) for a, b in inside]
    slopes = np.array([min(map(abs, way)) for way in ways]) / ENTERED
    ramps = np.nanmedian(slopes) >= SLOPE * np.median(others)
    rests = {float(values[a]) for a, _ in spells}
    return tuple(sorted(rests)) if ramps and np.mean(others > 0.0) >= CHANGES else ()


def cut_off(values: FloatArray, ends: Iterable[float]) -> NDArray[np.bool_]:
    """Samples (samples,) that stay at one of the ends of a range, which says nothing but that it was passed."""
    cut = np.zeros(len(values), bool)
    for a, b in _spells(np.isin(values, list(ends))):
        cut[a:b] = True
    return cut


def _spells(at: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], at, [False]])))
    return [(a, b) for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True) if b - a >= AT_END]


# -- where a rope climbs onto its next layer: at one place of the drum, which a log's `wire_layer` should show
WORTH_SAYING = 0.2  # of a run's samples; a rope that climbs once in a long hoist costs less
MOVING = 1.0  # rad/s of a fast motor; noise of an encoder at rest turns nothing back
CLIMBS = np.pi  # rad of the drum, half a turn, in which a rope is on its next layer, along the flange


def away_from(angle: FloatArray, changes: FloatArray, gear_ratio: float) -> np.ndarray:
    """Samples that are half a turn of the drum and more, by the shaft's angle in rad, away from any change of layer."""
    changes = np.sort(changes)
    if not len(changes):
        return np.ones(len(angle), bool)
    after = np.searchsorted(changes, angle)
    around = (changes[np.clip(after - one, 0, len(changes) - 1)] for one in (0, 1))
    return np.min([np.abs(angle - each) for each in around], axis=0) > CLIMBS * gear_ratio


class LayerChanges(NamedTuple):
    """How often a run's `wire_layer` changes; `near`: the share of its samples within half a turn of the drum of a
    change; `most`: how often it can change, once at each place where a rope climbs before the drum turns back."""

    changes: int = 0
    near: float = 0.0
    most: int = 0

    def lost(self, name: str) -> str:
        """In words, what the run of this name loses by them, and whether it can change so often."""
        often, flips = counted(self.changes, "time", "times"), ""
        if self.changes > self.most:
            flips = f", where the winch can pass such a place {self.most} times: a counter that flips?"
        return (
            f"{name}: wire_layer changes {often}{flips}; "
            f"{self.near:.0%} of the samples lie within half a turn of the drum of a change, and tell gap nothing"
        )


def layer_changes(run: Run, gear_ratio: float, speed_scale: float) -> LayerChanges:
    """What the changes of `wire_layer` of a run say beside its `motor_speed`; zeros without a change."""
    if "wire_layer" not in run or "motor_speed" not in run:
        return LayerChanges()
    layer, speed, time = np.rint(run["wire_layer"]), run["motor_speed"], run.time
    known = np.isfinite(layer) & np.isfinite(speed) & np.isfinite(time)
    layer, speed, time = layer[known], speed[known], time[known]
    changed = np.flatnonzero(np.diff(layer)) + 1
    if not len(changed):
        return LayerChanges()
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    near = 1.0 - float(np.mean(away_from(angle, angle[changed], gear_ratio)))
    moving = np.sign(speed[np.abs(speed) > MOVING * speed_scale])
    turns = int(np.count_nonzero(np.diff(moving)))
    return LayerChanges(len(changed), near, (turns + 1) * int(np.ptp(layer)))


def held(values: FloatArray) -> FloatArray:
    """Values of which each holds over what is no number behind it, the first one before it too."""
    known = np.isfinite(values)
    if known.all() or not known.any():
        return values
    last = np.maximum.accumulate(np.where(known, np.arange(len(values)), 0))
    return values[np.maximum(last, known.argmax())]


def shown_columns(run: Run) -> list[str]:
    """The columns of a run that its samples show; of a motor group all, whether they are there or not."""
    return [name for name in SAMPLE_SCALARS if name in run] + [f"{g}.{c}" for g in run.groups for c in GROUP_CHANNELS]


def without_holes(run: Run) -> bool:
    """Whether every channel of a run that is there says something plausible at every row: nothing is held then."""
    return all(
        name in run and bool(((run[name] >= limits_of(name)[0]) & (run[name] <= limits_of(name)[1])).all())
        for name in shown_columns(run)
    )
