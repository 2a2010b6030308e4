"""Configuration files: where the shipped ones lie, and YAML read strictly: every key is asked for by name, the rest is
refused in one line that says where.
"""

import contextlib
import copy
import itertools
import math
import re
import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from winch_friction.physics.channels import factor_to_si
from winch_friction.physics.errors import InputError, meant, unknown_key


def kind_said(content: Any) -> str:
    """Which kind of file a content says that it is: 'crane' of `schema: winch_friction.crane/1`; '' of no such word."""
    schema = content.get("schema") if isinstance(content, Mapping) else None
    said = re.fullmatch(r"winch_friction\.(\w+)/\d+", schema) if isinstance(schema, str) else None
    return said[1] if said else ""


def expect_kind(content: Any, kind: str, where: str) -> None:
    """Raise `InputError` where a file says of itself that it is of another kind of this package's: what else it breaks
    of the rules of `kind` is no news then."""
    said = kind_said(content)
    if said not in ("", kind):
        schema = content["schema"]
        raise InputError(f"{where}: this is a {said} file (schema '{schema}'), and a {kind} file is asked for")


class Section:
    """A mapping of a configuration file that knows where it stands and which of its keys were asked for."""

    def __init__(self, content: Any, where: str) -> None:
        if not isinstance(content, Mapping):
            raise InputError(f"{where}: expected a mapping of keys (YAML), found {_said(content)}")
        for (key, value), (after, nothing) in itertools.pairwise(content.items()):
            if type(value) is type(after) is int and nothing is None:
                raise InputError(f"{where}: '{key}: {value},' ends there in YAML; write a decimal point, not a comma")
        self.content = content
        self.where = where
        self._asked: set[str] = set()

    def __contains__(self, key: str) -> bool:
        self._asked.add(key)  # one that may be there is known
        return key in self.content

    def get(self, key: str, default: Any = None) -> Any:
        """A value as it stands, or the default."""
        self._asked.add(key)
        return self.content.get(key, default)

    def need(self, key: str) -> Any:
        """A value that must be there."""
        self._asked.add(key)
        if key not in self.content:
            raise InputError(f"{self.where}: key '{key}' is missing")
        return self.get(key)

    def section(self, key: str) -> "Section":
        """A mapping that must be there."""
        return Section(self.need(key), f"{self.where}: {key}")

    def text(self, key: str, default: str | None = None) -> str:
        """A string."""
        value = self.get(key, default) if default is not None else self.need(key)
        if not isinstance(value, str):
            kept = "" if isinstance(value, (list, Mapping)) else "; put it in quotes, as it was meant"
            raise InputError(f"{self.where}: {key} must be a string, found {_said(value)}{kept}")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number."""
        value = self.get(key, default) if default is not None else self.need(key)
        return finite(value, f"{self.where}: {key}")

    def quantity(self, key: str, si_unit: str) -> float:
        """`{value: 215, unit: cm^3/rev}` in SI; a bare number is SI already."""
        return as_quantity(self.need(key), si_unit, f"{self.where}: {key}")

    def close(self) -> None:
        """Refuse the keys that nobody asked for."""
        problems = [
            f"{self.where}: {unknown_key(str(key), sorted(self._asked))}"
            for key in self.content
            if key not in self._asked
        ]
        if problems:
            raise InputError(*problems)


def finite(value: Any, where: str) -> float:
    """A finite float, or `InputError`."""
    if isinstance(value, (str, int)) and not isinstance(value, bool):  # YAML 1.1 reads 1e-3 as a string
        with contextlib.suppress(ValueError, OverflowError):
            value = float(value)
    if not isinstance(value, float) or not math.isfinite(value):
        comma = isinstance(value, str) and re.fullmatch(r"\s*[-+]?\d+,\d+\s*", value)
        advice = f"; write a decimal point: {value.strip().replace(',', '.')}" if comma else ""
        raise InputError(f"{where} must be a finite number, found {_said(value)}{advice}")
    return float(value)


def spread(section: Section, key: str = "std") -> float:
    """A standard deviation, as it stands: finite, and not below 0."""
    value = section.number(key)
    if value < 0.0:
        raise InputError(f"{section.where}: {key} must be 0 or above (a standard deviation), found {value:g}")
    return value


def as_quantity(content: Any, si_unit: str, where: str) -> float:
    """A number in SI or a mapping with value and unit, converted to `si_unit`."""
    if isinstance(content, str) and (behind := re.fullmatch(r"\s*([-+\d.eE]+)\s+([^\s\d]\S*)\s*", content)):
        raise InputError(f"{where}: '{content}' is one text; write {{value: {behind[1]}, unit: {behind[2]}}}")
    if not isinstance(content, Mapping):
        return finite(content, where)
    section = Section(content, where)
    value = section.number("value")
    factor = factor_to_si(section.text("unit", si_unit), si_unit, where)
    section.close()
    return value * factor


LARGEST_FILE = 1_000_000  # bytes, which take two seconds; 30 MB took 40, and what is beside it lost its pace


def read_yaml(path: Path) -> Any:
    """The content of a YAML file; syntax errors and missing files as one line."""
    if path.is_file() and (size := path.stat().st_size) > LARGEST_FILE:
        raise InputError(
            f"{path}: {size / 1e6:.3g} MB are no model, crane or scenario (the largest has {LARGEST_FILE / 1e6:g} MB); "
            "is it the right file?"
        )
    return parse_yaml(utf_8_text(path), str(path))


def utf_8_text(path: Path) -> str:
    """What a text file says; raises `InputError` for one that is not there, or in another encoding."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.__class__.__name__}: {error.strerror})") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text (byte {error.start + 1}); save it as UTF-8") from error
    if "\0" in text:
        raise InputError(f"{path}: not UTF-8 text (byte {text.index(chr(0)) + 1} is zero); save it as UTF-8")
    return text


# what YAML 1.1 reads to the base 8, 60, 2 or 16: nobody who writes 014 or 1:14 means 12 or 74
_OTHER_BASE = re.compile(r"[-+]?(0[0-7_]+|0[box].*|.*:.*)")


# entries of what a text stands for with its repetitions (`*name`): ten lines of lists of lists make a billion, and
# whatever shows or looks through these holds the process
MOST_UNFOLDED = 100_000


class _Loader(yaml.SafeLoader):
    """YAML's safe types. What YAML takes without a word is gathered: a key that stands twice in one mapping, of which
    it takes the last, and numbers to another base than ten."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.repeats = False  # whether anything stands for what was written before
        self.repeated: list[tuple[int, str, int]] = []  # line, key, the line on which it stood first; lines from 1
        self.other_base: list[tuple[int, str, Any]] = []  # line, what is written, the number that YAML makes of it

    def compose_node(self, parent: Any, index: Any) -> Any:
        """As YAML has it; notes a repetition."""
        self.repeats |= self.check_event(yaml.AliasEvent)
        return super().compose_node(parent, index)

    def number(self, node: Any, value: Any) -> Any:
        """A number as YAML reads it, gathered where people read it otherwise."""
        if _OTHER_BASE.fullmatch(node.value):
            self.other_base.append((node.start_mark.line + 1, node.value, value))
        return value

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        """As YAML has it; what `<<` merges in may repeat a key, and gives way to it."""
        first: dict[tuple[str, str], int] = {}
        for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode)):
            name, line = (key.tag, key.value), key.start_mark.line + 1
            if name in first:
                self.repeated.append((line, key.value, first[name]))
            first.setdefault(name, line)
        return super().construct_mapping(node, deep)


for _kind in ("int", "float"):
    _plain = getattr(yaml.SafeLoader, f"construct_yaml_{_kind}")
    _Loader.add_constructor(
        f"tag:yaml.org,2002:{_kind}", lambda loader, node, read=_plain: loader.number(node, read(loader, node))
    )


# characters of a text whose content is kept: ten times those of the longest shipped file
_KEPT = 100_000


def parse_yaml(text: str, where: str) -> Any:
    """The content of a YAML text; a key that stands twice in one mapping is refused, and so is a number such as 014,
    which is 12 to YAML."""
    if len(text) > _KEPT:
        return _parsed(text, where)
    return copy.deepcopy(_parsed_once(text, where))  # a hundredth of the time; whoever asked may change it


def _parsed(text: str, where: str) -> Any:
    try:
        loader = _Loader(text)
        node = loader.get_single_node()
        if loader.repeats and _unfolded(node, {}) > MOST_UNFOLDED:
            raise InputError(f"{where}: its repetitions (*name) make more than {MOST_UNFOLDED} entries of it")
        content = None if node is None else loader.construct_document(node)
    except RecursionError:
        raise InputError(f"{where}: nested too deeply to be a configuration") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" line {mark.line + 1}" if mark else ""
        what = str(getattr(error, "problem", None) or "syntax error")
        instead = "; indent with spaces, not with tabs" if r"'\t'" in what else ""
        raise InputError(f"{where}{line}: not valid YAML ({what}){instead}") from error
    said = [
        (line, f"key '{key}' stands on line {before} already; keep one of them")
        for line, key, before in loader.repeated
    ]
    said += [
        (line, f"{written} is {value} to YAML; write the number that is meant to the base ten, a name between quotes")
        for line, written, value in loader.other_base
    ]
    if said:
        raise InputError(*(f"{where} line {line}: {text}" for line, text in said))
    return content


_parsed_once = lru_cache(maxsize=64)(_parsed)  # the check reads each shipped crane and model, for each log anew


def _unfolded(node: Any, sizes: dict[int, float]) -> float:
    """Entries of a node with its repetitions; infinite of one that stands in itself."""
    if id(node) not in sizes:
        sizes[id(node)] = math.inf
        inside = [] if isinstance(node, yaml.ScalarNode) else node.value
        pairs = (each if isinstance(each, tuple) else (each,) for each in inside)
        sizes[id(node)] = 1 + sum(_unfolded(each, sizes) for pair in pairs for each in pair)
    return sizes[id(node)]


def _said(value: Any) -> str:
    if value is None:
        return "nothing"
    shown = repr(value)
    shown = shown if len(shown) <= 60 else f"{shown[:60]}..."  # a log taken for YAML is one long text
    return f"{shown} ({type(value).__name__})"


# -- what is shipped
_PACKAGE = "winch_friction"


def config_directory() -> Path:
    """The directory with cranes/, models/, nodes/, scenarios/; raises `InputError` when the installation lacks it."""
    for candidate in _candidates():
        if (candidate / "models").is_dir():
            return candidate
    raise InputError("the shipped configuration was not found: reinstall the package, or give paths instead of names")


def _candidates() -> list[Path]:
    package = Path(__file__).resolve().parents[1]
    prefixes = [Path(sys.prefix), *package.parents[:5]]
    return [package.parent / "config", *(prefix / "share" / _PACKAGE / "config" for prefix in prefixes)]


def shipped(kind: str, name: str | Path, suffix: str = ".yaml") -> Path:
    """A path as given, or the shipped file of that name, e.g. ('cranes', 'crane_150t')."""
    path = Path(name)
    if path.is_file():
        return path
    folder = config_directory() / kind
    candidate = folder / f"{name}{suffix}"
    if candidate.is_file():
        return candidate
    known, own = sorted(each.stem for each in folder.glob(f"*{suffix}")), Path(f"{name}{suffix}")
    near = f" did you mean the file {own}?" if own.is_file() else meant(str(name), known)
    raise InputError(f"'{name}' is neither a file nor a shipped name in {kind};{near} shipped: {', '.join(known)}")
