"""What is known while a map is being made: the logs, the crane, the map so far, what is open."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from winch_friction.importing.carry_out import Converted, convert
from winch_friction.importing.log import Log
from winch_friction.importing.mapping import LogMap, with_settings
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane


@dataclass
class Draft:
    """What is known while a map is being made."""

    logs: Sequence[Log]
    crane: Crane | None
    log_map: LogMap
    questions: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    _times: dict[int, dict[Any, FloatArray]] = field(default_factory=dict, repr=False)  # of the log of this number

    def change(self, name: str, confidence: float | None = None, because: str = "", **fields: object) -> None:
        """Change a channel's entry, adding to its reason."""
        old = self.log_map.columns[name]
        reason = f"{old.because}; {because}" if because and old.because else (because or old.because)
        sure = old.confidence if confidence is None else confidence
        entry = replace(old, confidence=sure, because=reason, **fields)  # type: ignore[arg-type]
        self.log_map = replace(self.log_map, columns={**self.log_map.columns, name: entry})

    def apply(self, settings: Sequence[str]) -> None:
        """What the person says of the map; it answers the questions about that channel."""
        changed = with_settings(replace(self.log_map, questions=tuple(self.questions)), list(settings))
        self.log_map, self.questions = replace(changed, questions=()), list(changed.questions)

    def converted(self) -> list[Converted]:
        """Every log in SI as the map stands."""
        return [
            convert(log, self.log_map, self.crane, strict=False, times=self._times.setdefault(k, {}))
            for k, log in enumerate(self.logs)
        ]
