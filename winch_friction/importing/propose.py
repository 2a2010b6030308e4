"""From logs to a proposed map: time, columns, units, ports and signs, each guess with its reason and confidence."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from winch_friction.importing.contradiction import contradictions
from winch_friction.importing.draft import Draft
from winch_friction.importing.guess import Match, group_sets, matches
from winch_friction.importing.layers import ask_layers
from winch_friction.importing.log import Log, listed
from winch_friction.importing.mapping import OF_CRANE, Entry, LogMap
from winch_friction.importing.names import NAMED, name_concepts, name_score
from winch_friction.importing.orientation import settle_orientation, speed_by_motion
from winch_friction.importing.own_clocks import CLOCKS
from winch_friction.importing.reading import read_log
from winch_friction.importing.rows_of_values import names_of_signals
from winch_friction.importing.time_base import to_seconds
from winch_friction.importing.time_columns import settle_time
from winch_friction.importing.twins import ask_twins
from winch_friction.importing.unit_guess import settle_units
from winch_friction.importing.units import (
    ambiguity,
    fitting_si_unit,
    header_readings,
    is_share,
    usual_units,
)
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError, Problems, counted
from winch_friction.physics.signals import column_unit
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.run_checks import SPARSE, rows_between

_CLOCKS_SAID = "log.clocks="
_SHIP = 0.5  # Hz; a ship's motion has a thousandth of its power above it
_POOLED = 20_000  # values of each log that are looked at together


@dataclass(frozen=True)
class Proposal:
    """A proposed map; `problems` keep it from being imported (its questions are among them), `notes` do not."""

    log_map: LogMap
    problems: tuple[str, ...]
    notes: tuple[str, ...]


def propose(
    paths: Sequence[Path],
    crane: Crane | None,
    crane_name: str = "",
    settings: Sequence[str] = (),
    watched: Callable[[Sequence[Path]], Iterable[Path]] = iter,
) -> Proposal:
    """A map for logs of one kind, with what the person already says of it (`settings`, as `with_settings` takes them).

    `watched` hands the paths on while somebody looks how far the reading is.
    Raises `InputError` only for logs that cannot be read at all and for settings that say nothing.
    """
    clocks, settings = _said_clocks(settings)
    logs, unread = list[Log](), Problems()
    for path in watched(paths):
        with unread:
            logs.append(read_log(path, clocks))
    unread.say()
    draft = Draft(logs, crane, LogMap({}, crane=crane_name, log=dict(logs[0].settings)))
    _refuse_different_names(draft)
    _refuse_rows_of_values(draft)
    pooled = _pooled(logs)
    settle_time(draft)
    found = matches(pooled, crane, draft.log_map.time_from)
    _settle_columns(draft, found, pooled)
    ask_twins(draft)
    if crane is not None and not {"motor_speed", "drum_speed"} & set(draft.log_map.columns):
        speed_by_motion(draft, crane)
    settle_units(draft, found, pooled)
    draft.apply(settings)
    settle_orientation(draft, _said_signs(settings))
    ask_layers(draft)
    _settle_missing(draft, pooled)
    if not (draft.problems or draft.questions):  # else what is open may be the cause
        draft.problems += [f"{log.path.name}: {each}" for log, done in zip(draft.logs, draft.converted(), strict=True)
                           for each in done.problems]  # fmt: skip
    if crane is not None:
        _settle_contradictions(draft)
    used = {*draft.log_map.time_from, *(e.source for e in draft.log_map.columns.values())}
    unused = tuple(c.name for c in logs[0].columns if c.name not in used)
    log_map = replace(draft.log_map, unused=unused, questions=tuple(dict.fromkeys(draft.questions)))
    notes = tuple(f"{log.path.name}: {note}" for log in logs for note in log.notes) + tuple(draft.notes)
    notes += tuple(_say_of_changes(draft))
    problems = tuple(dict.fromkeys([*draft.problems, *log_map.questions]))
    return Proposal(log_map, problems, notes + tuple(_bad_cells(logs, log_map)))


def _say_of_changes(draft: Draft) -> list[str]:
    """What to do with columns that have a value in some rows only, at no rhythm: a logger writes what has changed."""
    log = draft.logs[0]
    used = [log.column(each.source) for each in draft.log_map.columns.values() if not each.constant]
    shares = {c.name: float(np.isfinite(c.values).mean()) for c in used if c.numeric and not rows_between(c.values)}
    sparse = [f"'{name}' ({100.0 * share:.2g} %)" for name, share in shares.items() if share < SPARSE]
    told = (
        f"a value in some rows only: {', '.join(sparse)}; the others stay empty; of a log of changes, where each holds "
    )
    return [f"{log.path.name}: {told}until the next, --propose --set log.clocks=held"] if sparse else []


def _said_clocks(settings: Sequence[str]) -> tuple[dict[str, str] | None, list[str]]:
    """What the person says of columns with times of their own, as settings of the reader, and the other settings."""
    said = [each.removeprefix(_CLOCKS_SAID).strip() for each in settings if each.startswith(_CLOCKS_SAID)]
    if said and said[-1] not in CLOCKS:
        raise InputError(f"--set '{_CLOCKS_SAID}{said[-1]}': write one of {', '.join(CLOCKS)}")
    others = [each for each in settings if not each.startswith(_CLOCKS_SAID)]
    return {"clocks": said[-1]} if said else None, others


def _said_signs(settings: Sequence[str]) -> frozenset[str]:
    """The channels whose sign the person has said."""
    return frozenset(s.partition(".sign=")[0].strip() for s in settings if ".sign=" in s)


def _refuse_different_names(draft: Draft) -> None:
    first, *others = draft.logs
    names = {c.name for c in first.columns}
    for log in others:
        missing = names - {c.name for c in log.columns}
        if missing:
            draft.problems.append(
                f"{log.path.name} has other columns than {first.path.name}: {listed(sorted(missing))} are not in it; "
                "propose a map for each kind of log; if they hold different signals of one run, join them by time into "
                "one file first"
            )


def _refuse_rows_of_values(draft: Draft) -> None:
    """A controller's archive or a database that writes a row per value, with the signal's name beside it."""
    log = draft.logs[0]
    found = names_of_signals(log)
    if found is not None:
        draft.problems.append(
            f"{log.path.name} has a row per value, of the signals that '{found[0].name}' names "
            f"({listed(found[1][:5])}), and no surely told times and values: export or pivot it to a column per signal"
        )


def _pooled(logs: Sequence[Log]) -> Log:
    """The logs' columns put together, thinned."""
    columns = []
    for column in logs[0].columns:
        same = [c for log in logs for c in log.columns if c.name == column.name and c.numeric == column.numeric]
        thin = [c.values[:: max(1, len(c.values) // _POOLED)] for c in same]
        columns.append(replace(column, values=np.concatenate(thin)))
    return replace(logs[0], columns=tuple(columns))


def _settle_columns(draft: Draft, found: Mapping[str, Match], pooled: Log) -> None:
    entries = {}
    for name, match in found.items():
        target, at = ("motor_speed", "rope") if name == "rope_speed" else (name, "motor")
        if name == "rope_speed" and ({"motor_speed", "drum_speed"} & set(found) or draft.crane is None):
            if draft.crane is None and "motor_speed" not in found:
                draft.questions.append(
                    f"motor_speed: '{match.column.name}' is a speed of the rope; give --crane for drum and gear"
                )
            continue
        cutoff = _position_cutoff(draft, match)
        why = f"{match.why}; a position: its speed is taken" if cutoff else match.why
        entries[target] = Entry(
            match.column.name, match.unit, at=at, differentiate=cutoff, confidence=match.confidence, because=why
        )
        choices = ambiguity(match.slot.channel, match.unit) if match.unit else ""
        if choices:
            draft.questions.append(
                f"{target}: the unit '{match.unit}' of '{match.column.name}' is ambiguous; "
                f"set {target}.unit to {choices}"
            )
    draft.log_map = replace(draft.log_map, columns=entries)


def _position_cutoff(draft: Draft, match: Match) -> float:
    """The low-pass in Hz of a heave that is logged as a position: above a ship's motion, below half the log's rate."""
    if match.slot.channel != "heave_velocity" or not match.unit or fitting_si_unit("heave_velocity", match.unit) != "m":
        return 0.0
    columns = [draft.logs[0].column(name) for name in draft.log_map.time_from]
    time = (
        to_seconds(columns, draft.log_map.time, "time", draft.logs[0].place, strict=False) if columns else np.zeros(2)
    )
    period = max(float(np.median(np.diff(time))), 1e-3)
    return round(min(_SHIP, 0.25 / period), 3)


def _is_motion(names: set[str]) -> bool:
    """Whether a log is a ship's motion alone, for a scenario rather than for a run of a winch."""
    return "heave_velocity" in names and not names & {"motor_speed", "drum_speed", "hook_load", "motor_torque"}


def _settle_missing(draft: Draft, pooled: Log) -> None:
    """Say at once every channel that a run needs and no column gives, beside what was found."""
    names, crane = set(draft.log_map.columns), draft.crane
    if _is_motion(names):
        return
    lacking = [] if {"motor_speed", "drum_speed"} & names else ["motor_speed (or drum_speed)"]
    groups = dict.fromkeys(n.rpartition(".")[0] for n in names if "." in n)
    for group in groups:
        lacking += [f"{group}.{c}" for c in ("pressure_a", "pressure_b", "displacement") if f"{group}.{c}" not in names]
    electric = not crane.drive.hydraulic if crane is not None else not groups
    if electric and not names & {"motor_torque", "rope_force", "mechanical_power", "motor_current"}:
        lacking.append("motor_torque (or rope_force with mechanical_power)")
    if not electric and not groups:
        lacking.append("pressures and displacement of a motor group")
    if lacking:
        free = [
            c.name
            for c in pooled.columns
            if c.name not in {e.source for e in draft.log_map.columns.values()}
            and c.name not in draft.log_map.time_from
        ]
        left = f"not used are {listed(free)}" if free else "none is left over"
        hollow = [c.name for c in pooled.columns if c.name in free and c.numeric and not np.isfinite(c.values).any()]
        left += f" ({listed(hollow)} without a number in it)" if hollow else ""
        draft.problems.append(
            f"{', '.join(lacking)}: no column found; {left}; "
            f"name one by --set {_first_channel(lacking[0], crane)}.from=COLUMN{_instead(lacking, free, crane)}"
        )
    for name, entry in draft.log_map.columns.items():
        channel = name.rpartition(".")[2]
        if entry.unit and channel != "displacement" and not entry.of and is_share(channel, entry.unit):
            own = usual_units(channel)[0]
            draft.questions.append(
                f"{name}: '{entry.source}' is in {entry.unit}; of what? --set '{name}.of=NUMBER {own}'"
            )


def _instead(lacking: Sequence[str], free: Sequence[str], crane: Crane | None) -> str:
    """What to do where the log has something else in the place of what lacks: an angle, a difference of pressures, or
    nothing, as of what never changes."""
    swept = [each for each in lacking if each.endswith(".displacement")]
    largest = (
        f"{crane.max_displacement / CM3_PER_REV:.6g}" if crane is not None and crane.max_displacement else "NUMBER"
    )
    said = "".join(f"; motors of constant displacement: --set '{e}.constant={largest} cm^3/rev'" for e in swept)
    for name in free if any(each.endswith("displacement") for each in lacking) else ():
        readings = [
            (bare, unit) for bare, unit in header_readings(name) if unit and fitting_si_unit("shaft_angle", unit)
        ]
        if any(name_score("displacement", name_concepts(bare)) > NAMED for bare, _ in readings):
            said += (
                f"; '{name}' is an angle: add a column of the displacement that it sets, in % of the largest (bent "
                "axis: its sine over that of the largest angle; swash plate: its tangent)"
            )
    if [each.rpartition(".")[2] for each in lacking] == ["pressure_b"]:
        said += f"; where the log holds the pressure drop A - B alone: --set '{lacking[0]}.constant=0 bar'"
    return said


def _first_channel(lacking: str, crane: Crane | None) -> str:
    """A channel's own name of what lacks, for the command line."""
    first = lacking.split()[0]
    return first if column_unit(first) is not None else f"{next(iter(group_sets(crane)[0]), 'main')}.pressure_a"


def _settle_contradictions(draft: Draft) -> None:
    assert draft.crane is not None
    if draft.questions or draft.problems:
        return  # what is open already may be the cause
    logs = {log.path.name: done.columns for log, done in zip(draft.logs, draft.converted(), strict=True)}
    draft.questions += [f"{OF_CRANE}{text}" for text in contradictions(logs, draft.crane)]


def _bad_cells(logs: Sequence[Log], log_map: LogMap) -> list[str]:
    used = {e.source: name for name, e in log_map.columns.items()}
    return [
        f"{log.path.name}: {used[c.name]}: "
        f"{counted(len(c.bad), f'cell of {c.name!r} is no number', f'cells of {c.name!r} are no numbers')}: "
        f"{log.place(c.bad[0][0])} '{c.bad[0][1]}'"
        for log in logs
        for c in log.columns
        if c.bad and c.name in used
    ]
