"""What the commissioning check says: findings, each with its cause, its sentence and its evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

SEVERITIES = ("error", "warning", "note")  # what contradicts the crane, what deserves a look, what is only said


@dataclass(frozen=True)
class Finding:
    """One thing that was found.

    `cause` is a stable identifier (`unit`, `sign`, `ports`, `groups`, `scale`, `crane`, `delay`, `tare`, `cell`, ...),
    `channel` the column it concerns (empty: none), `sentence` one line for a person, `runs` the runs it holds for,
    `evidence` plain numbers: residual before and after in N m at the shaft, scores, ratios.
    """

    severity: str
    cause: str
    sentence: str
    channel: str = ""
    runs: tuple[str, ...] = ()
    evidence: Mapping[str, Any] = field(default_factory=dict)

    @property
    def contradicts(self) -> bool:
        """Whether data with this finding cannot be this crane's, so that no result may be written from them."""
        return self.severity == "error"

    def content(self) -> dict[str, Any]:
        """Plain types."""
        return {
            "severity": self.severity,
            "cause": self.cause,
            "channel": self.channel,
            "sentence": self.sentence,
            "runs": list(self.runs),
            "evidence": dict(self.evidence),
        }


def first_contradiction(findings: Sequence[Finding]) -> Finding | None:
    """The most likely mistake, or None when the data may be this crane's; findings come in order of likelihood."""
    return next((each for each in findings if each.contradicts), None)


def run_words(names: Sequence[str], total: int) -> str:
    """'all 12 runs', '3 of 12 runs (a, b, c)', or the run's name where there is one."""
    if total == 1:
        return f"run {names[0]}"
    if len(names) == total:
        return f"all {total} runs"
    shown = ", ".join(names[:3]) + (" and more" if len(names) > 3 else "")
    return f"{len(names)} of {total} runs ({shown})"
