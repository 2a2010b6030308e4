"""The whole commissioning check: quick part, every channel, what the runs can teach, what to log next."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from winch_friction.commissioning.balance import Closure
from winch_friction.commissioning.channels import SEVERITIES, Finding, first_contradiction
from winch_friction.commissioning.check import Others, diagnosed, same_recordings
from winch_friction.commissioning.diagnose import Diagnosis
from winch_friction.commissioning.excitation import Taught, log_next, taught
from winch_friction.commissioning.kinematics import CONTRADICTS, Agreement, agreements
from winch_friction.commissioning.other_cranes import known_cranes
from winch_friction.commissioning.summaries import ChannelSummary, channel_findings, summaries
from winch_friction.commissioning.view import views_of
from winch_friction.physics.errors import counted
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import WORTH_SAYING, Run, layer_changes
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.runs import apart, scattered, without_broken

SCHEMA = "winch_friction.check/1"


@dataclass(frozen=True)
class RunBalance:
    """How one run closes: its misfit and the residual before and after ordinary errors, N m at the shaft."""

    run: str
    score: float
    before: float
    after: float
    level: float
    needed: Mapping[str, float]
    agreements: tuple[Agreement, ...]


@dataclass(frozen=True)
class CheckResult:
    """Everything that was found; `findings` from the gravest on, `sentence` is the first line for a person."""

    crane: Crane
    model: str
    runs: tuple[Run, ...]
    findings: tuple[Finding, ...]
    balance: tuple[RunBalance, ...]
    closures: tuple[Closure, ...]
    channels: Mapping[str, Sequence[ChannelSummary]]
    diagnosis: Diagnosis
    identifiable: tuple[Taught, ...]
    log_next: tuple[str, ...]
    limit: float = CONTRADICTS

    @property
    def plausible(self) -> bool:
        """Whether the runs can be the crane's."""
        return first_contradiction(self.findings) is None

    @property
    def sentence(self) -> str:
        """The verdict in one line: the most likely mistake, or that there is none."""
        first = first_contradiction(self.findings)
        if first is not None:
            return first.sentence
        count, whose = len(self.runs), f"of crane '{self.crane.name}'"
        runs = f"{count} run{'s' if count > 1 else ''}"
        open_ = sum(each.score > self.limit for each in self.closures)  # without what other channels tell of the speed
        if open_:
            some = "it leaves" if count == 1 else counted(open_, "of them leaves", "of them leave")
            return (
                f"plausible, not confirmed: nothing contradicts {runs} {whose}, but {some} more of the "
                "torque balance open than ordinary errors do, which may be this drive's own friction and inertia"
            )
        if all(each.before != each.before for each in self.balance):
            lost = next((f"in {run.name} {said}" for run in self.runs if (said := scattered(run))), "")
            still = "the winch does not move long enough in them to compare torques; log hoisting and lowering"
            return f"plausible, not confirmed: nothing contradicts {runs} {whose}, but {lost or still}"
        wrong = next((each.sentence.partition("; ")[0] for each in self.findings if each.cause == "companion"), "")
        but = f", but {wrong}" if wrong else ""
        return f"plausible: {runs} {whose} close{'s' if count == 1 else ''} the torque balance{but}"

    def content(self) -> dict[str, Any]:
        """Plain types, for check.json."""
        return {
            "schema": SCHEMA,
            "plausible": self.plausible,
            "sentence": self.sentence,
            "crane": self.crane.name,
            "model": self.model,
            "findings": [each.content() for each in self.findings],
            "balance": [_finite(asdict(each)) for each in self.balance],
            "limit": self.limit,
            "channels": {run: [_finite(asdict(c)) for c in each] for run, each in self.channels.items()},
            "identifiable": [{**asdict(each), "tells": each.words} for each in self.identifiable],
            "log_next": list(self.log_next),
        }


def check(
    runs: Sequence[Run], crane: Crane, model: FrictionModel | None = None, others: Others = known_cranes
) -> CheckResult:
    """Everything that can be said of runs before they are used; raises `InputError` for runs without a drive."""
    runs, holes = apart(runs)  # block means over days would each be one of minutes, in which nothing moves
    findings, diagnosis = diagnosed(runs, crane, model, others, ranked=True)
    assert isinstance(diagnosis, Diagnosis)
    broken = [
        Finding("warning", "broken", f"{each.sentence}: nobody measured that", each.channel, (each.run,))
        for each in without_broken(runs)[1]
    ]
    told = {(each.runs, each.channel) for each in broken}
    per_channel = [
        *broken,
        *(
            finding
            for run in runs
            for finding in channel_findings(run)
            if finding.cause != "stuck" or (finding.runs, finding.channel) not in told
        ),
    ]
    per_channel += [each for run in runs for each in _of_changing_layers(run, crane)]
    per_channel += [Finding("note", "gaps", said, "time") for said in holes]
    per_channel += [Finding("warning", "copy", said, "time") for said in same_recordings(runs)]
    # a stable sort: the diagnosis stays first among what is equally grave
    findings = sorted([*findings, *per_channel], key=lambda finding: SEVERITIES.index(finding.severity))
    views = views_of([(run, crane) for run in runs if run.name in diagnosis.names])
    balance = [
        RunBalance(c.run, s, c.before, c.after, c.level, c.needed, tuple(agreements(view)))
        for c, s, view in zip(diagnosis.closures, diagnosis.scores, views, strict=True)
    ]
    lessons: tuple[list[Taught], list[str]] = ([], [])
    if model is not None and model.parameters and first_contradiction(findings) is None:
        parameters, information = taught(views, model)
        lessons = parameters, log_next(crane, views, model, information) if crane.drive.hydraulic else []
    return CheckResult(
        crane=crane,
        model=model.name if model is not None else "",
        runs=tuple(runs),
        findings=tuple(findings),
        balance=tuple(balance),
        closures=diagnosis.closures,
        channels={run.name: summaries(run) for run in runs},
        diagnosis=diagnosis,
        identifiable=tuple(lessons[0]),
        log_next=tuple(lessons[1]),
    )


def _finite(content: dict[str, Any]) -> dict[str, Any]:
    """Not-a-number as null, as JSON wants it."""
    return {key: _plain(value) for key, value in content.items()}


def _plain(value: Any) -> Any:
    if isinstance(value, float) and value != value:
        return None
    if isinstance(value, dict):
        return _finite(value)
    return [_plain(each) for each in value] if isinstance(value, (list, tuple)) else value


def _of_changing_layers(run: Run, crane: Crane) -> Iterator[Finding]:
    """A `wire_layer` around whose changes `gap` uses nothing; one that flips took whole runs away without a word."""
    found = layer_changes(run, crane.gear_ratio, crane.speed_scale)
    if found.near >= WORTH_SAYING:
        severity = "warning" if found.changes > found.most else "note"
        evidence = {"changes": found.changes, "share": found.near}
        yield Finding(severity, "layer_changes", found.lost(run.name), "wire_layer", (run.name,), evidence)
