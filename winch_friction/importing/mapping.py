"""The map: which column of a log is which channel, in which unit and sign, and what is still open. A YAML file."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from winch_friction.importing.own_clocks import CLOCKS
from winch_friction.importing.time_base import FORMS, ORDERS, TimeBase
from winch_friction.physics.errors import InputError, unknown_key
from winch_friction.records.strict_yaml import Section, read_yaml

SCHEMA = "winch_friction.map/1"
LARGEST = 1 << 18  # bytes: a map of a thousand columns has a quarter of it
BAD_CELLS = ("missing", "refuse")
PLACES = ("motor", "drum", "rope")
OF_CRANE = "crane: "  # how a question begins that is of no channel: what in the logs cannot be the crane's
_NUMBERS = ("names_row", "unit_row", "first_row")
_TEXTS = ("kind", "encoding", "delimiter", "decimal", "thousands", "sheet", "namespace", "clocks")


@dataclass(frozen=True)
class Entry:
    """One channel: `source` is the column's name in the log (for a bag `topic:field`), `unit` as people write it.

    `sign` +1 or -1, `factor` a further multiplier, `add` what is added to the log's number before (1 to layers counted
    from 0), `of` what a share is of (`215 cm^3/rev`), `at` where a speed or
    torque is measured; `differentiate` Hz: the column is a position in `unit`, its speed is taken behind a zero-phase
    low-pass of this frequency; `constant`: no column but one value with its unit (`96 kg`), known from elsewhere;
    `confidence` 0 ... 1 and `because` are the proposal's, nobody needs them.
    """

    source: str
    unit: str = ""
    sign: int = 1
    factor: float = 1.0
    add: float = 0.0
    of: str = ""
    at: str = "motor"
    differentiate: float = 0.0
    constant: str = ""
    confidence: float = 1.0
    because: str = ""


@dataclass(frozen=True)
class LogMap:
    """A whole map; `questions` must be answered (removed, or with --accept) before anything is imported."""

    columns: Mapping[str, Entry]
    time_from: tuple[str, ...] = ()
    time: TimeBase = field(default_factory=lambda: TimeBase("seconds"))
    crane: str = ""
    log: Mapping[str, Any] = field(default_factory=dict)
    bad_cells: str = "missing"
    unused: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()
    time_confidence: float = 1.0
    time_because: str = ""


def load_map(path: Path) -> LogMap:
    """A map from its YAML file; raises `InputError` in one line for whatever is wrong with it."""
    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"{path}: no such map; make one with: winch-friction import LOG --propose --crane CRANE --map {path}"
        )
    if path.stat().st_size > LARGEST:
        raise InputError(f"{path}: {path.stat().st_size >> 10} kB is no map; the largest is {LARGEST >> 10} kB")
    return map_from_content(read_yaml(path), str(path))


def map_from_content(content: Any, where: str) -> LogMap:
    """A map from parsed YAML."""
    top = Section(content, where)
    if top.text("schema") != SCHEMA:
        raise InputError(f"{where}: schema '{top.text('schema')}' is not '{SCHEMA}'")
    time = top.section("time") if "time" in top else Section({}, f"{where}: time")
    columns = top.section("columns")
    loaded = LogMap(
        columns={str(name): _entry(columns.section(name)) for name in columns.content},
        time_from=_names(time, "from"),
        time=_time(time),
        crane=top.text("crane", ""),
        log=_log(top),
        bad_cells=_choice(top, "bad_cells", BAD_CELLS, "missing"),
        unused=_names(top, "unused"),
        questions=_names(top, "questions"),
        time_confidence=time.number("confidence", 1.0),
        time_because=time.text("because", ""),
    )
    time.close()
    top.close()
    if not loaded.columns:
        raise InputError(f"{where}: columns: no channel is mapped; write e.g. motor_speed: {{from: NAME, unit: rpm}}")
    return loaded


def _entry(section: Section) -> Entry:
    sign = section.number("sign", 1.0)
    if sign not in (1.0, -1.0):
        raise InputError(f"{section.where}: sign must be 1 or -1, found {sign:g}")
    factor = section.number("factor", 1.0)
    if factor == 0.0:
        raise InputError(f"{section.where}: factor must not be 0")
    cutoff = section.number("differentiate", 0.0)
    if cutoff < 0.0:
        raise InputError(f"{section.where}: differentiate must be a frequency in Hz, or 0 for none, found {cutoff:g}")
    constant = section.text("constant", "")
    entry = Entry(
        source=section.text("from", "") if constant else section.text("from"),
        constant=constant,
        unit=section.text("unit", ""),
        sign=int(sign),
        factor=factor,
        add=section.number("add", 0.0),
        of=section.text("of", ""),
        at=_choice(section, "at", PLACES, "motor"),
        differentiate=cutoff,
        confidence=section.number("confidence", 1.0),
        because=section.text("because", ""),
    )
    section.close()
    return entry


def _time(section: Section) -> TimeBase:
    return TimeBase(
        form=_choice(section, "form", FORMS, "seconds"),
        unit=section.text("unit", "s"),
        order=_choice(section, "order", ("", *ORDERS), ""),
        zone=section.text("zone", ""),
        spread=_yes(section, "spread"),
        fraction=section.text("fraction", ""),
    )


def _yes(section: Section, key: str) -> bool:
    """Whether a switch is on; from the command line it comes as a word."""
    value = {"true": True, "false": False}.get(str(section.get(key, False)).lower())
    if value is None:
        raise InputError(f"{section.where}: {key} must be true or false, found {section.get(key)!r}")
    return value


def _log(top: Section) -> dict[str, Any]:
    section = top.section("log") if "log" in top else Section({}, f"{top.where}: log")
    found: dict[str, Any] = {key: section.text(key) for key in _TEXTS if key in section}
    found |= {key: int(section.number(key)) for key in _NUMBERS if key in section}
    section.close()
    if "clocks" in found:
        _choice(section, "clocks", CLOCKS, "one")
    for key in ("delimiter", "decimal"):
        if len(found.get(key, ".")) != 1:
            raise InputError(f"{section.where}: {key} must be one character, found {found[key]!r}")
    return found


def _names(section: Section, key: str) -> tuple[str, ...]:
    value = section.get(key, [])
    if isinstance(value, str):
        return (value,)
    if not isinstance(value, list) or not all(isinstance(each, str) for each in value):
        raise InputError(f"{section.where}: {key} must be a list of texts")
    return tuple(value)


def _choice(section: Section, key: str, known: tuple[str, ...], default: str) -> str:
    value = section.get(key, default)
    if value not in known:
        raise InputError(f"{section.where}: {key} must be one of {', '.join(k for k in known if k)}; found {value!r}")
    return str(value)


def with_settings(log_map: LogMap, settings: list[str]) -> LogMap:
    """A map changed from the command line: `hook_load.unit=t`, `time.zone=Europe/Oslo`, `motor_speed.sign=-1`.

    A question about the column that is set counts as answered.
    """
    for setting in settings:
        key, equals, value = setting.partition("=")
        name, dot, attribute = key.strip().rpartition(".")
        if not equals or not dot:
            raise InputError(f"--set '{setting}': write CHANNEL.FIELD=VALUE, e.g. hook_load.unit=t or time.zone=UTC")
        if name == "log":
            raise InputError(
                f"--set '{setting}': how a log is read stands in the map file: write it under log: there (log.clocks "
                "with --propose)"
            )
        log_map = _changed(log_map, name, attribute, value.strip(), setting)
        kept = tuple(each for each in log_map.questions if not each.startswith(f"{name}:"))
        log_map = replace(log_map, questions=kept)
    return log_map


def _changed(log_map: LogMap, name: str, attribute: str, value: str, setting: str) -> LogMap:
    if name == "time":
        fields: dict[str, Any] = {**vars(log_map.time), "from": list(log_map.time_from)}
        section = Section(fields | {attribute: value}, f"--set '{setting}'")
        changed = replace(log_map, time=_time(section), time_from=_names(section, "from"))
        section.close()
        return changed
    old = log_map.columns.get(name)
    known = _content(old or Entry(""))
    if attribute not in known:
        raise InputError(f"--set '{setting}': {unknown_key(attribute, tuple(known))}")
    if old is None and attribute not in ("from", "constant"):
        raise InputError(
            f"--set '{setting}': the map has no channel '{name}'; say its column first: --set {name}.from=COLUMN"
        )
    entry = _entry(Section(({} if old is None else known) | {attribute: value}, f"--set '{setting}'"))
    return replace(log_map, columns={**log_map.columns, name: entry})


def _content(entry: Entry) -> dict[str, Any]:
    """A channel's part of a map file."""
    own = dict(vars(entry))
    return {"from": own.pop("source"), **own}


def refuse_if_open(log_map: LogMap, where: str) -> None:
    """Raise `InputError` with every open question of a map; not what contradicted the crane when it was proposed, which
    is judged anew of what is imported, by the map, the settings and the crane file as they are by then."""
    if still_open := [each for each in log_map.questions if not each.startswith(OF_CRANE)]:
        raise InputError(
            f"{where}: {' | '.join(still_open)} (answer by --set CHANNEL.FIELD=VALUE, or in the map and "
            "remove the question; --accept imports as it stands)"
        )
