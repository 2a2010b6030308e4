"""Tables in which each signal, or each of several tables side by side, has a column of times of its own.

Scopes, trends of controllers and historians write them so: `Time; Speed; Time; Pressure`, each pair as long as it is. A
row then is no instant. Such signals are put on one clock; columns of times that all say the same are one.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from winch_friction.importing.log import Log, LogColumn, listed, own_name
from winch_friction.importing.one_clock import Signal, column_of, draws_lines, on_one_clock
from winch_friction.importing.time_base import TimeBase, guess_time, to_seconds
from winch_friction.importing.time_names import is_clock_of
from winch_friction.physics.errors import InputError, counted
from winch_friction.physics.signals import FloatArray

CLOCKS = ("one", "held", "lines")  # what the map says of them: rows are instants; else what stands between two values
_PAIRS = 3  # clocks with as many columns behind each, from which they are each column's own


@dataclass(frozen=True)
class _Clock:
    """A column of times at `at`, the `seconds` of its rows (NaN where it is empty), and what stands behind it."""

    at: int
    seconds: FloatArray
    base: TimeBase
    signals: Sequence[LogColumn]

    @property
    def known(self) -> np.ndarray:
        """Rows (rows,) that have a time."""
        return np.asarray(np.isfinite(self.seconds))


def with_own_clocks(log: Log, said: str = "") -> Log:
    """The log on one clock where its columns have several.

    `said`: one of CLOCKS, as the map has it, also of a log of changes, whose columns have one clock and a value where
    it changed; '' to find out, and to put into the log's settings what was found.
    Raises `InputError` where the map says so of a log that does not begin with a column of times.
    """
    if said == "one":
        return log
    clocks = _clocks(log, 1 if said else 2)
    if said and not clocks:
        raise InputError(f"{log.path}: log.clocks is '{said}', but no column of times begins it")
    if not said and not _are_own(clocks):
        return log
    times = [log.columns[each.at].name for each in clocks]
    if len(clocks) > 1 and all(np.array_equal(each.seconds, clocks[0].seconds, equal_nan=True) for each in clocks):
        again = [column for k, column in enumerate(log.columns) if k not in {each.at for each in clocks[1:]}]
        note = f"{len(clocks)} columns of times say the same: '{times[0]}' is taken"
        return replace(log, columns=tuple(again), settings=_with(log, said or "held"), notes=(*log.notes, note))
    signals = [_signal(column, clock) for clock in clocks for column in clock.signals]
    signals = [each for each in signals if len(each.values)]
    lines = said == "lines" or (not said and draws_lines(signals))
    rows = np.sort(clocks[0].seconds[clocks[0].known]) if len(clocks) == 1 else None  # of a log of changes
    columns, notes = on_one_clock(signals, lines, rows is None, rows)
    if lines and not said:
        notes.append(
            "a compressed record: values leap behind silences; if it holds changes, write clocks: held in the map"
        )
    notes += [
        f"column '{each.name}': {counted(len(each.bad), 'cell is no number', 'cells are no numbers')}, first "
        f"{log.place(each.bad[0][0])} '{each.bad[0][1]}': left out"
        for clock in clocks
        for each in clock.signals
        if each.bad
    ]
    if len(clocks) > 1:
        notes.append(f"{len(clocks)} columns of times, each of the columns behind it: {listed(times)}")
    if clocks[0].base.form == "datetime":
        zone = f", {clocks[0].base.zone} where no zone is given" if clocks[0].base.zone else ""
        notes.append(f"dates of the order {clocks[0].base.order}{zone}")
    return replace(
        log, columns=tuple(columns), settings=_with(log, "lines" if lines else "held"),
        place=lambda row: f"sample {row + 1}", notes=(*log.notes, *notes),
    )  # fmt: skip


def with_times_of_their_structs(signals: Sequence[Signal]) -> tuple[list[Signal], list[str]]:
    """The signals of structs that hold their own time, with it (`speed.Time`, `speed.Data`, as of a timeseries), and
    the names of the others; none where there are not two such structs of different times.
    """
    structs: dict[str, list[Signal]] = {}
    for each in signals:
        structs.setdefault(each.name.rpartition(".")[0], []).append(each)
    found: list[tuple[str, Signal, LogColumn, TimeBase]] = []
    for name, members in structs.items():
        for each in members if name else ():
            column = column_of(each.name.rpartition(".")[2], each)
            named, unit = is_clock_of(column)
            guess = guess_time([column], unit) if named else None
            if guess is not None and not guess.question:
                found.append((name, each, column, replace(guess.base, spread=False)))
                break
    base = _common_base([(column, own) for _, _, column, own in found])
    if base is None or all(np.array_equal(each.values, found[0][1].values) for _, each, _, _ in found[1:]):
        return [], []
    timed, left = [], {id(each): each.name for each in signals}
    for name, clock, column, _ in found:
        seconds = to_seconds([column], base, "time", lambda row: f"sample {row + 1}", strict=False)
        others = [each for each in structs[name] if each is not clock and len(each.values) == len(seconds)]
        timed += [replace(each, name=name if len(others) == 1 else each.name, times=seconds) for each in others]
        left = {key: told for key, told in left.items() if key not in map(id, (clock, *others))}
    return timed, list(left.values())


def _with(log: Log, clocks: str) -> Mapping[str, object]:
    return {**log.settings, "clocks": clocks}


def _clocks(log: Log, fewest: int) -> list[_Clock]:
    """The columns of times from the first column on, signals behind each; none where it is not a table of such."""
    columns = [each for each in log.columns if not _is_hollow(each)]
    borne = Counter(own_name(each.name) for each in columns)
    found: list[tuple[int, TimeBase]] = []
    for k, column in enumerate(columns):
        named, unit = is_clock_of(column)
        again = borne[own_name(column.name)] >= _PAIRS
        if not named and not again:
            continue
        guess = guess_time([column], unit)
        base = replace(guess.base, spread=False) if guess is not None and not guess.question else None
        if base is None and again and found and _of_one_value(column):
            base = found[0][1]  # of a signal that never changed
        if base is not None:
            found.append((k, base))
    ends = [*(k for k, _ in found), len(columns)]
    base = _common_base([(columns[k], base) for k, base in found])
    if len(found) < fewest or base is None or ends[0] or any(b - a < 2 for a, b in pairwise(ends)):
        return []
    clocks = [
        _Clock(
            log.columns.index(columns[k]), to_seconds([columns[k]], base, "time", log.place, strict=False), base,
            columns[k + 1 : end],
        )
        for (k, _), end in zip(found, ends[1:], strict=True)
    ]  # fmt: skip
    return clocks if _overlap(clocks) else []


def _common_base(found: Sequence[tuple[LogColumn, TimeBase]]) -> TimeBase | None:
    """The time base of all clocks, None where they have several.

    Without a unit the step tells it, and of a slow clock's steps of whole seconds it tells ms; then fractions tell s.
    """
    bases = [base for _, base in found]
    if len(set(bases)) == 1:
        return bases[0]
    seconds = next((base for base in bases if base == TimeBase("seconds", "s")), None)
    bare = all(base.form == "seconds" and not is_clock_of(column)[1] for column, base in found)
    whole = all(np.all(column.values[np.isfinite(column.values)] % 1.0 == 0.0) for column, _ in found if column.numeric)
    return seconds if bare and not whole else None


def _of_one_value(column: LogColumn) -> bool:
    cells = np.isfinite(column.values) if column.numeric else [bool(str(cell or "").strip()) for cell in column.text]
    return int(np.sum(cells)) == 1


def _is_hollow(column: LogColumn) -> bool:
    return column.numeric and not np.isfinite(column.values).any()


def _overlap(clocks: Sequence[_Clock]) -> bool:
    begins, ends = zip(*((np.nanmin(each.seconds), np.nanmax(each.seconds)) for each in clocks), strict=True)
    return bool(max(begins) <= min(ends))


def _are_own(clocks: Sequence[_Clock]) -> bool:
    """Whether nothing else can be meant: the same times again, tables that end early, or a pair for each signal."""
    if not clocks:
        return False
    if any(_ends_early(one, other) for one, other in pairwise(clocks)):
        return all(_fills_its_rows(each) for each in clocks)
    return len(clocks) >= _PAIRS and len({len(each.signals) for each in clocks}) == 1


def _ends_early(one: _Clock, other: _Clock) -> bool:
    return abs(int(one.known.sum()) - int(other.known.sum())) > 1


def _fills_its_rows(clock: _Clock) -> bool:
    """Whether the rows of a table begin with the first and end where its clock does."""
    count = int(clock.known.sum())
    beyond = [each for each in clock.signals if each.numeric and np.isfinite(each.values[count:]).any()]
    return bool(clock.known[:count].all()) and not beyond


def _signal(column: LogColumn, clock: _Clock) -> Signal:
    """A column as a signal of its clock's times, which rise; rows without a number say nothing."""
    cells = column.values if column.numeric else np.array([str(each) for each in column.text], dtype=object)
    used = clock.known & (np.isfinite(column.values) if column.numeric else cells != "")
    order = np.argsort(clock.seconds[used], kind="stable")
    return Signal(column.name, cells[used][order], column.unit, clock.seconds[used][order], column.note)
