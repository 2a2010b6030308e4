"""The map as a text that a person reads: what was guessed, how surely, and why, beside what may be changed."""

import json
from collections.abc import Iterable

from winch_friction.importing.mapping import SCHEMA, Entry, LogMap
from winch_friction.physics.channels import column_unit

_HEAD = """\
# How this log becomes run files. Proposed by `winch-friction import --propose`; read it, change what is wrong, then run
#   winch-friction import LOG... --map THIS_FILE --out DIR
# confidence: how sure the guess is, 0 ... 1. because: why. Both are for the reader; nothing depends on them.
"""
_COLUMNS = """\
# channel of the run: {from: column of the log, unit: the log's unit}; where needed also
#   sign: -1        the log counts the other way        factor: a further multiplier
#   add: 1          to the log's number before, as to layers counted from 0
#   of: 215 cm^3/rev   what a share (%) is of           at: motor | drum | rope   where a speed or torque is measured
#   constant: 96 kg in place of from and unit, for what is known and not logged
"""
_SAID_OF = {"clocks": "   # held or lines: what is between two values of columns with times of their own; one: no such"}


def map_text(log_map: LogMap) -> str:
    """A map as commented YAML."""
    lines = [_HEAD + f"schema: {SCHEMA}"]
    if log_map.crane:
        lines.append(f"crane: {_quoted(log_map.crane)}")
    if log_map.questions:
        lines.append("\n# Answer each one by a change below (or on the command line by --set) and remove it here.")
        lines += ["questions:", *(f"  - {_quoted(each)}" for each in log_map.questions)]
    if log_map.log:
        lines.append("\n# How the file is read.\nlog:")
        lines += [f"  {key}: {_quoted(value)}{_SAID_OF.get(key, '')}" for key, value in log_map.log.items()]
    if log_map.time_from:
        lines.append("\ntime:")
        lines += _time_lines(log_map)
    lines.append(f"\n{_COLUMNS}columns:{'' if log_map.columns else ' {}   # none was found: write them here'}")
    for name, entry in log_map.columns.items():
        unit = column_unit(name)
        lines.append(f"  {name}:{f'   # becomes {unit}' if unit not in (None, '1') else ''}")
        lines += [f"    {line}" for line in _entry_lines(entry)]
    lines.append(
        "\n# Cells that hold no number although their column does: missing (named, then left empty) or refuse."
    )
    lines.append(f"bad_cells: {log_map.bad_cells}")
    if log_map.unused:
        lines.append("\n# Columns of the log that no channel takes; they are not imported.")
        lines.append("unused:")
        lines += [f"  - {_quoted(each)}" for each in log_map.unused]
    return "\n".join(lines) + "\n"


def _time_lines(log_map: LogMap) -> Iterable[str]:
    time = log_map.time
    yield f"  from: [{', '.join(_quoted(each) for each in log_map.time_from)}]"
    yield f"  form: {time.form}   # seconds, unix, excel, matlab, filetime, dotnet, datetime or clock"
    if time.form in ("seconds", "unix"):
        yield f"  unit: {_quoted(time.unit)}"
    if time.form == "datetime":
        yield f"  order: {time.order or 'ymd'}   # ymd, dmy or mdy"
        yield f"  zone: {_quoted(time.zone)}   # of dates without an offset of their own, e.g. Europe/Oslo"
    if time.fraction:
        yield f"  fraction: {_quoted(time.fraction)}   # unit of the last column: what is beyond the whole seconds"
    if time.spread:
        yield "  spread: true   # rows of one tick lie evenly between this tick and the next"
    yield f"  confidence: {log_map.time_confidence:.2f}"
    yield f"  because: {_quoted(log_map.time_because)}"


def _entry_lines(entry: Entry) -> Iterable[str]:
    if entry.constant:
        yield f"constant: {_quoted(entry.constant)}"
    else:
        yield f"from: {_quoted(entry.source)}"
        yield f"unit: {_quoted(entry.unit)}"
    if entry.sign != 1:
        yield f"sign: {entry.sign}"
    if entry.factor != 1.0:
        yield f"factor: {entry.factor:.12g}"
    if entry.add:
        yield f"add: {entry.add:.12g}"
    if entry.of:
        yield f"of: {_quoted(entry.of)}"
    if entry.differentiate:
        yield f"differentiate: {entry.differentiate:g}   # Hz; a position becomes a speed behind a low-pass"
    if entry.at != "motor":
        yield f"at: {entry.at}"
    yield f"confidence: {entry.confidence:.2f}"
    yield f"because: {_quoted(entry.because)}"


def _quoted(value: object) -> str:
    """A value as YAML; JSON strings are YAML strings."""
    return json.dumps(value, ensure_ascii=False)
