"""The list of faults: what is changed, in which file, and which tests should notice."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
LIST = Path(__file__).with_name("faults.yaml")


@dataclass(frozen=True)
class Fault:
    """One change of meaning: `old` stands once in `file` and becomes `new`; `tests` are the paths to run."""

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def changed(self, source: str) -> str:
        """The file's text with the fault; raises `ValueError` unless `old` stands in it exactly once."""
        count = source.count(self.old)
        if count != 1:
            raise ValueError(f"{self.name}: {self.old!r} stands {count} times in {self.file}, not once")
        if self.new == self.old:
            raise ValueError(f"{self.name}: changes nothing")
        return source.replace(self.old, self.new)


def all_faults(path: Path = LIST) -> list[Fault]:
    """Every fault of the list, in its order; raises `ValueError` for a name used twice."""
    # libyaml's reader where it is there: without, 5000 lines take a second of every worker that looks at the tests
    entries = yaml.load(path.read_text(), Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    faults = [
        Fault(each["name"], f"winch_friction/{each['file']}", each["old"], each["new"], tuple(each["tests"]))
        for each in entries
    ]
    twice = sorted(name for name, count in Counter(fault.name for fault in faults).items() if count > 1)
    if twice:
        raise ValueError(f"two faults are called {twice[0]}")
    return faults
