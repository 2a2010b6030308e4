"""What is done already: one line of JSON per finished piece of work, so that a killed run goes on where it was."""

import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Outcome:
    """What one piece of work gave: exit status, seconds, the verb's own JSON (or its error line)."""

    key: str
    crane: str
    recording: str
    status: int
    seconds: float
    result: Any
    message: str


def work_key(verb: str, version: str, address: str, options: Mapping[str, Any]) -> str:
    """Name of a piece of work: the same inputs and options give the same, any change another."""
    text = json.dumps([verb, address, version, sorted(options.items())], default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


class Ledger:
    """The outcomes in a file that only grows; a line cut short by a kill is dropped and its work done again."""

    def __init__(self, path: Path) -> None:
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self._end_the_last_line()

    def outcomes(self) -> Iterator[Outcome]:
        """Every whole line."""
        if not self.path.exists():
            return
        with self.path.open(encoding="utf-8") as lines:
            for line in lines:
                try:
                    yield Outcome(**json.loads(line))
                except (ValueError, TypeError):
                    continue

    def latest(self) -> dict[str, Outcome]:
        """The last outcome of every piece of work."""
        return {each.key: each for each in self.outcomes()}

    def add(self, outcome: Outcome) -> None:
        """Append one outcome; on the disk when this returns."""
        with self.path.open("a", encoding="utf-8") as out:
            out.write(json.dumps(asdict(outcome), default=str) + "\n")
            out.flush()
            os.fsync(out.fileno())

    def _end_the_last_line(self) -> None:
        """What a kill left unfinished must not swallow the next line."""
        if self.path.exists() and self.path.stat().st_size:
            with self.path.open("rb+") as file:
                file.seek(-1, os.SEEK_END)
                if file.read(1) != b"\n":
                    file.write(b"\n")


def verdict_of(outcome: Outcome) -> str:
    """The verb's own answer in a few words, for tables."""
    verb = outcome.result.get("verb") if isinstance(outcome.result, dict) else None
    if outcome.status != 0 or not isinstance(verb, dict):
        return outcome.message or "done"
    if "verdict" in verb:
        names = " + ".join(
            " or ".join([each["name"], *each.get("indistinguishable_from", [])]) for each in verb.get("effects", [])
        )
        return f"{verb['verdict']}: {names}" if names else str(verb["verdict"])
    if "active_share" in verb:
        return f"active {100 * verb['active_share']:.0f} %, peak {verb['feedforward_peak_Nm']:.0f} N m"
    return "plausible" if verb.get("plausible") else "done"
