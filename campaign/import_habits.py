"""Strangers' habits through `import --propose` and `import`: what became of each kind of `import_kinds`."""

import argparse
import contextlib
import io
import re
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from campaign.import_foreign import kinds as foreign
from campaign.import_kinds import kinds as first
from campaign.import_logs import SMALL_CRANE, base_run
from campaign.import_writers import Kind
from winch_friction.cli.main import run as command
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run

SLOWEST = 5.0  # s of processor time for an answer
ROUNDING = 5e-3  # of a channel's largest value: the digits that a log keeps


@dataclass(frozen=True)
class Became:
    """What became of a kind: `outcome` is imported, answered, wrong (written, but not the run's), missed or crashed."""

    kind: Kind
    outcome: str
    seconds: float
    said: str

    @property
    def good(self) -> bool:
        """Whether it was imported as it was, or answered with the cause."""
        return self.outcome in ("imported", "answered")


def kinds() -> list[Kind]:
    """Both sets."""
    return [*first(), *foreign()]


def became(kind: Kind, folder: Path) -> Became:
    """Write a kind's log, propose, import, compare."""
    base = base_run(kind.base)
    logs = [str(path) for path in kind.write(base, folder)]
    crane = kind.crane
    if crane == "wrong":
        (folder / "crane_50t.yaml").write_text(SMALL_CRANE, encoding="utf-8")
        crane = str(folder / "crane_50t.yaml")
    mapped, out = str(folder / "map.yaml"), folder / "runs"
    settings = [each for said in kind.settings for each in ("--set", said)]
    answers = [_answer("import", *logs, "--propose", "--crane", crane, "--map", mapped, *settings)]
    if answers[0][0] == 0:
        answers.append(_answer("import", *logs, "--map", mapped, "--out", str(out)))
    status, _, said = answers[-1]
    slowest = max(seconds for _, seconds, _ in answers)
    if status not in (0, 2) or any("Traceback" in text for _, _, text in answers):
        return Became(kind, "crashed", slowest, said)
    if status == 0:
        written = [read_run(path, load_crane(crane)) for path in sorted(out.glob("*.csv"))]
        right = bool(written) and all(_same(run, base, kind) for run in written) and not kind.said
        return Became(kind, "imported" if right else "wrong", slowest, said)
    cause = (said.partition("needs an answer:")[2] or said).partition(" | ")[0]
    return Became(kind, "answered" if any(word in cause for word in kind.said) else "missed", slowest, said)


def _answer(*arguments: str) -> tuple[int, float, str]:
    began, errors = time.process_time(), io.StringIO()
    with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
        status = command(list(arguments))
    lines = [line for line in errors.getvalue().splitlines() if not line.startswith("warning:")]
    return status, time.process_time() - began, "\n".join(lines)


def _same(written: Run, base: Run, kind: Kind) -> bool:
    """Whether the written run is the one that the log was made from, at the log's rows or on its own grid."""
    needed = {name for name in base.columns if "." in name or name == "motor_speed"}
    if "drum_speed" in written.columns or "rope_speed" in written.columns:
        needed.discard("motor_speed")
    if not needed <= set(written.columns):
        return False
    time_ = written.time - written.time[0]
    if kind.step:
        wanted = base.time[:: kind.step] - base.time[0]
        if len(time_) != len(wanted) or not np.allclose(time_, wanted, atol=2.1e-3):
            return False
    for name, values in base.columns.items():
        if name == "time" or name not in written.columns:
            continue
        wanted = values[:: kind.step] if kind.step else np.interp(time_, base.time - base.time[0], values)
        off = np.abs(written[name] - wanted)
        allowed = kind.loose.get(name, ROUNDING) * max(float(np.nanmax(np.abs(values))), 1e-12)
        if np.isfinite(off).mean() < 0.95 or np.nanmax(off) > allowed:  # a stray cell is missing, as it should be
            return False
    return True


def section(outcomes: list[Became]) -> str:
    """The part of the page that tells of the habits."""
    counts = {name: sum(each.outcome == name for each in outcomes) for name in
              ("imported", "answered", "wrong", "missed", "crashed")}  # fmt: skip
    slowest = max(each.seconds for each in outcomes)
    good = counts["imported"] + counts["answered"]
    bad = [each for each in outcomes if not each.good]
    return "\n".join([
        "## Strangers' habits", "",
        f"{len(outcomes)} kinds, each written out by hand (`campaign/import_kinds.py`, and later "
        "`campaign/import_foreign.py`, `campaign/import_programs.py`): languages, clocks, encodings, file formats, "
        "exports of measuring programs, units, mistakes. When the first 99 were written, 79.6 % were good, five were "
        "written and not the run, and two ended in a traceback; of the next 64, written against the mended code, 64 % "
        "were good, four were written and not the run (ticks of .NET, fractions of a second in a column of their own, "
        "slower channels with blanks), none ended in a traceback. What failed was mended, so this is no held-out "
        "rate.", "",
        f"Imported as they were {counts['imported']}, answered with the cause {counts['answered']}, data written that "
        f"are not the run {counts['wrong']}, missed {counts['missed']}, tracebacks {counts['crashed']}; good "
        f"{100.0 * good / len(outcomes):.1f} %; slowest answer {slowest:.1f} s of processor time.", "",
        *(f"* {each.kind.name}: {each.outcome}; said: {shown(each.said)}" for each in bad), "",
    ])  # fmt: skip


def shown(said: str) -> str:
    """An answer without the campaign's own temporary paths."""
    return re.sub(r"\S*/(?=[\w.]+)", "", said)[:300] or "nothing"


def every(only: str = "") -> list[Became]:
    """What became of every kind whose name holds `only`."""
    outcomes = []
    for kind in kinds():
        if only in kind.name:
            with tempfile.TemporaryDirectory() as folder:
                outcomes.append(became(kind, Path(folder)))
    return outcomes


def main() -> None:
    """The section, and what each kind said."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="part of a kind's name")
    outcomes = every(parser.parse_args().only)
    for each in outcomes:
        print(f"{each.outcome:9s} {each.seconds:5.1f} s  {each.kind.name}: {'' if each.good else shown(each.said)}")
    print(section(outcomes))


if __name__ == "__main__":
    main()
