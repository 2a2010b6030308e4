"""Run files in and out by their kind: .csv, .parquet, or a rosbag2 folder (.mcap and .db3 files as well). And what of
them nobody measured: the silence between records that were merged into one file, and samples of a channel that stands
still while others live, or jumps: a transmitter or a bus that hangs, a lost telegram. They are made missing, and said.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.channels import GROUP_CHANNELS, SLOW_INPUTS
from winch_friction.physics.errors import InputError, Problems, counted, said_of
from winch_friction.physics.signals import FloatArray, Run, cut_off, ends_of_range, held
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.run_checks import rows_between

BAG_SUFFIXES = (".mcap", ".db3")
KINDS = ".csv, .parquet, a rosbag2 folder, .mcap or .db3"


def is_bag(path: Path) -> bool:
    """Whether a recording is one of ROS 2; a logger under Windows writes RUN.MCAP."""
    return path.is_dir() or path.suffix.lower() in BAG_SUFFIXES


def read_run(path: Path | str, crane: Crane | None = None, *, complete: bool = True, **bag_options: Any) -> Run:
    """A run in SI from a CSV, a Parquet file or a bag.

    The crane is needed where the file speaks of the drum or of displacement fractions; `complete=False` asks for `time`
    alone (truth files); `bag_options` go to `records.bags.read_bag`. What was noticed is in the run's `warnings`.
    Raises `InputError` in one line for whatever cannot be used.
    """
    if not ((path := Path(path)).is_file() or path.is_dir()):  # a pipe would be waited for
        raise InputError(f"{path}: {'neither a file nor a folder' if path.exists() else 'no such file or folder'}")
    suffix = path.suffix.lower()  # a logger under Windows writes LOG.CSV
    with said_of(path, path.name):
        if is_bag(path):
            from winch_friction.records.bags import read_bag

            return read_bag(path, crane, complete=complete, **bag_options)
        if suffix == ".csv":
            from winch_friction.records.csv_file import read_csv_run

            return read_csv_run(path, crane, complete)
        if suffix in (".parquet", ".pq"):
            from winch_friction.records.parquet_file import read_parquet_run

            return read_parquet_run(path, crane, complete)
    raise InputError(f"{path}: not a kind of run file that is known; use {KINDS} (winch-friction import reads others)")


def read_runs(paths: Sequence[Path | str], crane: Crane | None = None, **options: Any) -> list[Run]:
    """Several runs; two of the same name raise `InputError`, since the name is a run's identity."""
    runs, problems = [], Problems()
    for path in paths:
        with problems:
            runs.append(read_run(path, crane, **options))
    problems.say()
    refuse_same_names(runs, paths)
    return runs


def refuse_same_names(runs: Sequence[Run], paths: Sequence[Path | str] = ()) -> None:
    """Raise `InputError` where two runs have the same name; of the `paths` those are told that end so."""
    names = [run.name for run in runs]
    for name in names:
        if names.count(name) > 1:
            of = ", ".join(str(path) for path in paths if Path(path).name == name)
            said = f"{name}: two runs have this name{of and f' ({of})'}"
            raise InputError(f"{said}; a run's identity is its file name, so rename one")


def write_run(run: Run, path: Path | str, **bag_options: Any) -> Path:
    """Write a run by suffix: .csv, .parquet, or a rosbag2 folder (.mcap or .db3 in the name choose the storage)."""
    path = refuse_unknown_kind(Path(path))
    if path.suffix == ".csv":
        from winch_friction.records.csv_file import write_csv_run

        return write_csv_run(run, path)
    if path.suffix in (".parquet", ".pq"):
        from winch_friction.records.parquet_file import write_parquet_run

        return write_parquet_run(run, path)
    from winch_friction.records.bag_write import write_bag

    return write_bag(run, path, **bag_options)


def refuse_unknown_kind(path: Path) -> Path:
    """The path, when a run can be written under its name; else `InputError`."""
    if path.suffix not in (".csv", ".parquet", ".pq", "", ".bag", *BAG_SUFFIXES):
        raise InputError(f"{path}: cannot write this kind of file; use {KINDS}")
    return path


# -- columns of a slower logger
# A logger of several rates leaves cells empty in between. What changes slowly (a load, a temperature, a setting) is
# held at its latest value, as the nodes hold their inputs; what follows the motion (a pressure, a force) is taken
# between its neighbours in time, for held ones come late. The speed says which rows are looked at.
SPEED = "motor_speed"
HELD = (*SLOW_INPUTS, "displacement")  # all others follow the motion
SCATTERED = 0.5  # of a channel's values, whose next row has one too: of fewer no noise can be told, and no balance made
OF_BALANCE = (*GROUP_CHANNELS, "motor_speed", "motor_torque", "motor_current", "mechanical_power")


def scattered(run: Run) -> str:
    """Which channel of the balance has values that stand alone between rows without one: not a slower channel, whose
    values come in a rhythm (`filled`), but cells lost at random. Nothing of a sound run."""
    for name in (each for each in run.columns if each.rpartition(".")[2] in OF_BALANCE):
        known = np.isfinite(run[name])
        if np.sum(known[1:] & known[:-1]) < SCATTERED * np.sum(known):
            share = 100.0 * float(np.mean(known))
            return (
                f"{name} has a value in {share:.3g} % of the rows, and those stand alone: log it in every row, or hold "
                "each value until the next one where a logger writes changes alone"
            )
    return ""


def filled(run: Run) -> tuple[Run, list[str]]:
    """A run whose slower columns have values in every row that has a speed, and what is said of it."""
    slow = {name: usual for name, values in run.columns.items() if (usual := rows_between(values))}
    if not slow:
        return run, []
    kept = np.isfinite(run[SPEED]) if SPEED in slow else np.ones(len(run), bool)
    columns, notes = {name: values[kept] for name, values in run.columns.items()}, []
    for name, usual in slow.items():
        how = f"{run.name}: {name} has a value in every {usual:g} rows"
        if name == SPEED:
            notes.append(f"{how}: only these rows are looked at")
        elif name.rpartition(".")[2] in HELD:
            columns[name] = held(run[name])[kept]
            notes.append(f"{how}: held at its latest value")
        else:
            known = np.isfinite(run[name])
            columns[name] = np.interp(run.time[kept], run.time[known], run[name][known])
            notes.append(f"{how}: taken between them")
    aside = {name: values[kept] if len(values) == len(run) else values for name, values in run.aside.items()}
    return replace(run, columns=columns, aside=aside), notes


# -- records that were merged into one file
NO_PAUSE = 1e9  # s, thirty years: a clock that is wrong, which `check` says
SLOW = 10.0  # usual steps; a time in ms under [s] has steps of 20 s, and no hole where one is lost
NO_RECORD = 1.0  # s; less is no record of a winch at work
LONGEST_HOLE = 30.0  # s without a sample, after which a record is another run: half the time a swing takes


def apart(runs: Sequence[Run]) -> tuple[list[Run], list[str]]:
    """The records, those with long holes as a run for each part, and what is said of these and of slower columns: after
    minutes of silence wire, load and oil are others, and what the winch did meanwhile nobody knows."""
    found, notes = list[Run](), list[str]()
    for run in runs:
        steps = np.diff(run.time)
        ends = np.flatnonzero(steps > max(LONGEST_HOLE, SLOW * float(np.median(steps)) if len(steps) else 0.0)) + 1
        bounds = itertools.pairwise([0, *ends.tolist(), len(run)])
        whole = [(a, b) for a, b in bounds if run.time[b - 1] - run.time[a] >= NO_RECORD]
        # a log of a sample a minute is a slow one, and not full of holes
        if not len(ends) or not whole or steps.max() > NO_PAUSE:
            found.append(run)
            continue
        found += [_part(run, f"{run.name}, part {k}", a, b) for k, (a, b) in enumerate(whole, start=1)]
        notes.append(f"{run.name}: nothing was logged for up to {steps.max():.3g} s; looked at as {len(whole)} runs")
    whole_rows = [filled(run) for run in found]
    return [run for run, _ in whole_rows], notes + [note for _, said in whole_rows for note in said]


def _part(run: Run, name: str, start: int, end: int) -> Run:
    columns = {each: values[start:end] for each, values in run.columns.items()}
    aside = {each: values[start:end] if len(values) == len(run) else values for each, values in run.aside.items()}
    return replace(run, name=name, columns=columns, aside=aside)


# -- samples that no sensor measured
# what has noise whatever the winch does; a speed in counts of an encoder is the same for seconds, and hangs if it leaps
LIVING = (
    "pressure_a", "pressure_b", "motor_torque", "mechanical_power", "motor_current", "rope_force", "load_torque",
)  # fmt: skip
MEASURED, PRESSURES = ("motor_speed", *LIVING), ("pressure_a", "pressure_b")
STILL, FEWEST = 1.0, 20  # s and samples that a channel must repeat; slow loggers repeat a value for some samples
LIVES = 0.5  # of the steps between samples, in which a channel changes that has noise, and so does not stand by chance
LEAST_ALIVE = 0.25  # of a record, that says how the channel lives; a coarse digit stands still for most of it
JUMPS = 20.0  # usual steps between samples, from the median of three
ALONE = 3.0  # times the steps beside it: a winch that sticks and slips within some samples rises to its peaks and falls
LEAPS, QUICK = 3.0, 99.0  # times a step of this percentile: those of the hardest ramps, hangs themselves are rarer
_Spells = list[tuple[int, int]]
MOST = 0.01  # of the samples; what jumps oftener is how the sensor is, and no lost telegram


@dataclass(frozen=True)
class Broken:
    """Samples of one channel of a run that no sensor measured, and what they do."""

    run: str
    channel: str
    what: str

    @property
    def sentence(self) -> str:
        """In words, with run and channel."""
        return f"{self.run}: {self.channel} {self.what}"


def without_broken(runs: Sequence[Run]) -> tuple[list[Run], list[Broken]]:
    """The runs with what nobody measured as NaN, and what is said of these."""
    found, told = list[Run](), list[Broken]()
    ends = {end for run in runs if SPEED in run for end in ends_of_range(run[SPEED])}  # one sensor's, in all of them
    for run in runs:
        own = {name: run[name] for name in run.columns if name.rpartition(".")[2] in MEASURED}
        changes = {name: np.abs(np.diff(values)) > 0.0 for name, values in own.items()}
        turning = _turning(own[SPEED]) if SPEED in own else np.zeros(len(run), bool)
        mended = dict(run.columns)
        for name, values in own.items():
            others = [each for other, each in changes.items() if other != name]
            find = _standing if name.rpartition(".")[2] in LIVING else _hanging
            still, jumping = find(run.time, values, changes[name], others), _jumping(values)
            jumping &= ~turning | (find is _hanging)
            dropped = _dropped(values) if name.endswith(PRESSURES) else np.zeros(len(values), bool)
            cut = cut_off(values, ends if name == SPEED else ())
            spells = {"stands still": still, "drops to zero": dropped, "is cut off at an end of its range": cut}
            told += [Broken(run.name, name, f"{what} for {np.diff(run.time)[each[1:]].sum():.3g} s")
                     for what, each in spells.items() if each.any()]  # fmt: skip
            if jumping.any():
                samples = counted(int(jumping.sum()), "single sample", "single samples")
                told.append(Broken(run.name, name, f"jumps in {samples}"))
            if (lost := still | jumping | dropped | cut).any():
                mended[name] = np.where(lost, np.nan, values)
        found.append(replace(run, columns=mended))
    return found, told


def _standing(time: FloatArray, values: FloatArray, changes: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """Samples (samples,) that repeat the one before for long, while another channel lives; none of a winch at rest."""
    still = np.zeros(len(values), bool)
    living = [each for each in others if each.mean() >= LIVES]
    long = [(a, b) for a, b in _long_spells(time, values, _leaps(values), changes, *living) if values[a] != 0.0]
    rest = np.ones(len(changes), bool)
    for a, b in long:
        rest[a : b - 1] = False
    if not long or rest.mean() < LEAST_ALIVE or changes[rest].mean() < LIVES:
        return still
    for a, b in long:
        if any(each[a : b - 1].mean() >= LIVES for each in others):
            still[a + 1 : b] = True
    return still


def _hanging(time: FloatArray, values: FloatArray, changes: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """The same of a speed that leaps in the end: a coarse one rests on its digits, and goes on from there by steps."""
    still, leaps = np.zeros(len(values), bool), _leaps(values)
    for a, b in _long_spells(time, values, leaps[:0], changes):
        if b < len(values) and leaps[b - 1] and any(each[a : b - 1].mean() >= LIVES for each in others):
            still[a + 1 : b] = True
    return still


def _dropped(values: FloatArray) -> np.ndarray:
    """Samples (samples,) of a pressure at zero to which it leaps, and from there: a wire comes off, no oil does so."""
    lost, leaps = np.zeros(len(values), bool), _leaps(values)
    edges = np.flatnonzero(np.diff(values == 0.0)) + 1
    for a, b in zip(edges[::2], edges[1::2], strict=False) if len(values) and values[0] != 0.0 else ():
        lost[a:b] = b - a > 1 and leaps[a - 1] and leaps[b - 1]
    return lost


def _leaps(values: FloatArray) -> np.ndarray:
    """Steps (samples - 1,) that what is measured does not make by itself."""
    steps = np.abs(np.diff(values))
    moved = steps[np.isfinite(steps) & (steps > 0.0)]
    return steps > LEAPS * float(np.percentile(moved, QUICK)) if len(moved) else np.zeros(len(steps), bool)


def _long_spells(time: FloatArray, values: FloatArray, leaps: np.ndarray, *changes: np.ndarray) -> _Spells:
    """First sample and end of what is repeated to the last digit for long, until it leaps, or as another's."""
    ends = (np.r_[True, each | np.isnan(values[1:] + values[:-1]), True] for each in changes)
    own, *others = (list(itertools.pairwise(np.flatnonzero(each).tolist())) for each in ends)
    as_one = {each for other in others for each in other}
    spells = [(a, b) for a, b in own if b - a >= FEWEST]
    return [(a, b) for a, b in spells if time[b - 1] - time[a] >= STILL or leaps[b - 1 : b].any() or (a, b) in as_one]


def _jumping(values: FloatArray) -> np.ndarray:
    """Single samples (samples,) far from both of their neighbours, one of which is near its own other one."""
    none, steps = np.zeros(len(values), bool), np.abs(np.diff(values))
    moved = steps[np.isfinite(steps) & (steps > 0.0)]  # a digit of a coarse transducer is no jump
    if len(values) < FEWEST or not len(moved):
        return none
    off = np.abs(values[1:-1] - np.median(np.stack([values[:-2], values[1:-1], values[2:]]), axis=0))
    flank = np.nan_to_num(np.fmin(np.r_[0.0, steps[:-2]], np.r_[steps[2:], 0.0]))
    none[1:-1] = (off > JUMPS * float(np.median(moved))) & (off > ALONE * flank)
    return none if none.mean() <= MOST else np.zeros(len(values), bool)


def _turning(speed: FloatArray) -> np.ndarray:
    """Two samples (samples,) on either side of a reversal: of a sparse log friction's step stands out alone there."""
    turns = np.concatenate([[False], np.sign(speed[:-1]) * np.sign(speed[1:]) < 0.0, [False]])
    return np.asarray(np.convolve(turns, np.ones(4), "same")[1 : len(speed) + 1] > 0.5)
