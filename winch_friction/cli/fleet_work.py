"""One piece of a fleet's work: a verb on a recording or on all recordings of a crane, in whichever process it runs."""

import contextlib
import hashlib
import io
import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from winch_friction.fleet.ledger import Outcome, work_key
from winch_friction.fleet.recordings import Recording, at_hand
from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import config_directory

UNIX = 1e8  # s; a time below it counts from some origin of its own and has no date


@dataclass(frozen=True)
class FleetVerb:
    """How a verb is called: its words, where its result goes, whether one crane's recordings go in together.

    `own_file`: the result is what the verb replaces only when told so; a fleet makes its own anew.
    """

    words: tuple[str, ...]
    target: str
    together: bool
    takes_out: bool = True
    own_file: bool = False


VERBS = {
    "replay": FleetVerb(("replay",), "replay/{crane}/{name}.parquet", together=False, own_file=True),
    "check": FleetVerb(("check",), "check/{crane}/{name}", together=False),
    "gap": FleetVerb(("gap",), "gap/{crane}", together=True, own_file=True),
    "identify": FleetVerb(("identify", "system"), "identify/{crane}.yaml", together=True, own_file=True),
}


@dataclass(frozen=True)
class Task:
    """What one worker is handed; plain data, so that it travels."""

    verb: str
    recordings: tuple[Recording, ...]
    options: tuple[str, ...]
    crane_file: str
    model_file: str
    target: str
    storage: tuple[tuple[str, Any], ...] = ()
    contents: str = ""  # of the files that it names, where it was planned: a worker may not have them all

    @property
    def crane(self) -> str:
        """The crane that it is about."""
        return self.recordings[0].crane

    @property
    def name(self) -> str:
        """As it stands in tables."""
        only = len(self.recordings) == 1 and not VERBS[self.verb].together
        return self.recordings[0].address if only else f"{self.crane} ({len(self.recordings)} recordings)"

    @property
    def key(self) -> str:
        """Names this work in the ledger."""
        inputs = " ".join(f"{each.address}={each.version}" for each in self.recordings)
        options = {
            "options": self.options, "crane": self.crane_file, "model": self.model_file, "contents": self.contents,
        }  # fmt: skip
        return work_key(self.verb, inputs, self.target, options)


def plan(
    verb: str,
    recordings: Sequence[Recording],
    out: Path,
    crane: str,
    model: str,
    options: Sequence[str],
    storage: Mapping[str, Any],
) -> list[Task]:
    """The tasks of a verb; `{crane}` in `crane` and `model` stands for the recording's crane.

    Raises `InputError` for a verb that fleets do not know.
    """  # fmt: skip
    if verb not in VERBS:
        raise InputError(f"fleet knows the verbs {', '.join(VERBS)}, not '{verb}'")
    how = VERBS[verb]
    if how.together:
        named = sorted({each.crane for each in recordings})
        pieces = [tuple(each for each in recordings if each.crane == name) for name in named]
    else:
        pieces = [(each,) for each in recordings]
    tasks = []
    for piece in pieces:
        own = {"crane": piece[0].crane, "name": piece[0].name}
        files = crane.replace("{crane}", own["crane"]), model.replace("{crane}", own["crane"])
        target = str(out / how.target.format(**own))
        contents = _contents(*files, *options)
        tasks.append(Task(verb, piece, tuple(options), *files, target, tuple(sorted(storage.items())), contents))
    return tasks


def own_folders(out: Path) -> list[Path]:
    """Where an earlier call has written its results, which are no recordings; none before the first call."""
    parts = [*(Path(how.target).parts[0] for how in VERBS.values()), "store"]
    return [out / part for part in parts] if (out / "fleet.jsonl").exists() else []


def _contents(*names: str) -> str:
    """What stands in the files among these words: a crane or a model that was mended is other work."""
    digest = hashlib.sha256()
    for name in names:
        for path in (Path(name), *(config_directory() / kind / f"{name}.yaml" for kind in ("cranes", "models"))):
            if path.is_file():
                digest.update(path.read_bytes())
    return digest.hexdigest()


def carry_out(task: Task) -> Outcome:
    """One task; whatever goes wrong is its outcome and stops nobody else."""
    begin = time.monotonic()
    try:
        with contextlib.ExitStack() as stack:
            paths = [stack.enter_context(at_hand(each, dict(task.storage))) for each in task.recordings]
            status, result, message = _called(task, paths)
            traits = _traits(task, paths) if status == 0 else []
    except InputError as error:
        status, result, message, traits = 2, None, str(error), []
    except Exception as error:  # a worker must answer for its task, not die of it
        status, result, message, traits = 1, None, f"{type(error).__name__}: {error}", []
    content = {"verb": result, "traits": traits}
    return Outcome(task.key, task.crane, task.name, status, time.monotonic() - begin, content, message)


def _called(task: Task, paths: Sequence[Path]) -> tuple[int, Any, str]:
    """The verb as from the command line, with what it printed."""
    from winch_friction.cli.main import run

    how = VERBS[task.verb]
    model = ("--motor" if task.verb == "identify" else "--model", task.model_file)
    Path(task.target).parent.mkdir(parents=True, exist_ok=True)
    arguments = [*how.words, *map(str, paths), "--crane", task.crane_file, *model, *task.options]
    said, complained = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
        anew = ["--overwrite"] if how.own_file else []
        status = run([*arguments, "--out", task.target, *anew, "--json"])
    result = _parsed(said.getvalue())
    return (status, result, "") if status == 0 else (status, None, _message(result, complained.getvalue()))


def _message(result: Any, complained: str) -> str:
    """Why a verb did not end well: its own sentence, as of runs that contradict their crane, else its last words."""
    if isinstance(result, dict) and result.get("sentence"):
        return str(result["sentence"])
    lines = [line for line in complained.splitlines() if line.strip()]
    return (lines or ["no message"])[-1]


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text.strip()


def _traits(task: Task, paths: Sequence[Path]) -> list[dict[str, Any]]:
    """What each dated recording says of its crane; a recording that cannot say keeps silent."""
    if task.verb == "identify":
        return []
    from winch_friction.fleet.fingerprint import fingerprint
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model
    from winch_friction.records.runs import read_run

    crane, model, rows = load_crane(task.crane_file), load_model(task.model_file), []
    for recording, path in zip(task.recordings, paths, strict=True):
        try:
            run = read_run(path, crane)
            found = fingerprint(run, crane, model)
        except InputError:
            continue
        rows += [
            {"recording": recording.name, "time": float(run.time[0]), "name": each.name, "value": each.value,
             "std": each.std, "unit": each.unit} for each in found
        ]  # fmt: skip
    return rows


def dated_rows(outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """Rows for the store: traits, and learned parameters of a replay, of every recording that has a date."""
    rows = []
    for each in outcomes:
        if each.status != 0 or not isinstance(each.result, dict):
            continue
        traits = [row for row in each.result.get("traits", []) if row["time"] > UNIX]
        rows += [{"crane": each.crane, "kind": "trait", **row} for row in traits]
        verb = each.result.get("verb")
        learned = verb.get("parameters", []) if isinstance(verb, dict) else []
        if traits:
            rows += [
                {"crane": each.crane, "kind": "learned", "recording": traits[0]["recording"], "time": traits[0]["time"],
                 "name": p["parameter"], "value": p["learned"], "std": p["sigma"], "unit": p["unit"]}
                for p in learned if isinstance(p, dict) and p.get("learned") is not None
            ]  # fmt: skip
    return rows
