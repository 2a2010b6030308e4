"""The mutation campaign (`make mutants`): how many of a list of small semantic faults the tests notice.

    python -m campaign.mutants [--processes 2] [--draw N --seed S] [--only NAME ...] [--out docs/campaign_mutants.md]

A run draws anew from the list, whose whole takes hours (`--draw 0`). Each fault is put into a copy of the working tree,
and the tests named beside it run there until the first failure: the one that noticed it last time, by the page, before
the others. A fault is caught when a test fails; a time-out counts as caught. Tests that fail without any fault would
catch everything, so all of them run once on an unchanged copy first.
"""

import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

from campaign.commit import commit
from campaign.mutants.fault import ROOT, Fault, all_faults

LONGEST = 420.0  # s for the tests of one fault; a fault that makes them hang is noticed by that
KEPT_OUT = shutil.ignore_patterns(".git", ".venv*", "out", "__pycache__", ".*_cache", ".hypothesis", "build", "install")
OUT = Path("docs/campaign_mutants.md")
BAR = 0.85
DRAWN = 60  # faults: a share of 85 % is then known to 5 %
ROW = re.compile(r"^\| (?P<name>.+?) \| (`[^`]*` )?\| `(?P<test>[^`:]+::[^`\[]+)[^`]*` \|$", re.MULTILINE)
LONGEST_OF_ALL = 3600.0  # s for all of the tests at once, without a fault


@dataclass(frozen=True)
class Outcome:
    """Whether a fault was noticed, by which test, and in how many seconds."""

    fault: Fault
    caught: bool
    by: str
    seconds: float


def copy_tree(into: Path) -> Path:
    """A copy of the working tree, where faults can be put without harm."""
    return Path(shutil.copytree(ROOT, into / "tree", ignore=KEPT_OUT, symlinks=True))


def noticed_before(page: Path) -> dict[str, str]:
    """The test that noticed each fault when this page was written; none for a page that is not there."""
    if not page.is_file():
        return {}
    return {row["name"]: row["test"] for row in ROW.finditer(page.read_text())}


def run_tests(tree: Path, tests: Sequence[str], *more: str, longest: float = LONGEST) -> tuple[bool, str]:
    """Whether these tests pass in that tree, and else the first that fails."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-m", "not browser", *more, *tests]
    try:
        done = subprocess.run(
            command, cwd=tree, env=environment, capture_output=True, text=True, timeout=longest, check=False
        )
    except subprocess.TimeoutExpired:
        return False, "no answer in time"
    failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return done.returncode == 0, failed[0].split(" - ")[0] if failed else (done.stdout.strip().splitlines() or [""])[-1]


def try_fault(tree: Path, fault: Fault, before: str = "") -> Outcome:
    """Put one fault in, run its tests, the one that noticed it before first, take it out again."""
    path = tree / fault.file
    source = path.read_text()
    began = time.monotonic()
    path.write_text(fault.changed(source))
    try:
        passed, by = run_tests(tree, [before]) if stands(tree, before) else (True, "")
        if passed:
            passed, by = run_tests(tree, fault.tests)
    finally:
        path.write_text(source)
    return Outcome(fault, not passed, "" if passed else by, time.monotonic() - began)


def stands(tree: Path, test: str) -> bool:
    """Whether a test that a page names is still there: what pytest cannot find would look like a failure."""
    file, _, name = test.partition("::")
    return bool(name) and (tree / file).is_file() and f"def {name}(" in (tree / file).read_text()


def try_all(faults: Sequence[Fault], processes: int, before: dict[str, str]) -> list[Outcome]:
    """Every fault, several trees at a time; stops when tests fail without a fault."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        trees: Queue[Path] = Queue()
        for k in range(processes):
            trees.put(copy_tree(Path(folder) / str(k)))
        first = trees.queue[0]
        tests = sorted({test for fault in faults for test in fault.tests})
        tests += sorted({before[fault.name] for fault in faults if stands(first, before.get(fault.name, ""))})
        spread = ("-n", str(processes), "--dist", "loadfile")
        passed, by = run_tests(first, tests, *spread, longest=LONGEST_OF_ALL)
        if not passed:
            raise SystemExit(f"without any fault a test fails: {by}")

        def one(fault: Fault) -> Outcome:
            tree = trees.get()
            try:
                return try_fault(tree, fault, before.get(fault.name, ""))
            finally:
                trees.put(tree)

        with ThreadPoolExecutor(processes) as pool:
            waiting = [pool.submit(one, fault) for fault in faults]
            for k, done in enumerate(as_completed(waiting)):
                outcome = done.result()
                said = f"caught by {outcome.by}" if outcome.caught else "SURVIVED"
                print(f"{k + 1}/{len(faults)} {outcome.fault.name}: {said} ({outcome.seconds:.0f} s)", flush=True)
            return [each.result() for each in waiting]


def page(
    outcomes: Sequence[Outcome], measured: str, listed: int = 0, before: Mapping[str, str] | None = None, how: str = ""
) -> str:
    """The campaign's page: a draw of those that are `listed`, `how` it was drawn, and by which test the others were
    noticed `before`."""
    caught = sum(each.caught for each in outcomes)
    rows = "\n".join(
        f"| {each.fault.name} | `{each.fault.file.removeprefix('winch_friction/')}` | "
        f"{'`' + each.by.removeprefix('FAILED ') + '`' if each.caught else '**survived**'} |"
        for each in outcomes
    )
    run = {each.fault.name for each in outcomes}
    others = "\n".join(f"| {name} | | `{test}` |" for name, test in (before or {}).items() if name not in run)
    rest = (
        f"\n## Noticed before, not drawn this time\n\n| fault | | noticed by |\n|---|---|---|\n{others}\n"
        if others
        else ""
    )
    drawn = f", drawn of {listed} that are listed{how}" if listed > len(outcomes) else ""
    return f"""# Do the tests hold the guards: the mutation campaign

Small faults of meaning, one at a time, in a copy of the package; the tests named beside each fault in
`campaign/mutants/faults.yaml` run until one fails.

* Command: `make mutants` (`python -m campaign.mutants`)
* Commit: {measured}
* Caught: {caught} of {len(outcomes)} ({100.0 * caught / len(outcomes):.0f} %; bar {100 * BAR:.0f} %){drawn}

| fault | file | noticed by |
|---|---|---|
{rows}
{rest}"""


def main() -> int:
    """Run the campaign and write its page; 1 below the bar."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--only", nargs="*", default=[], help="names of faults, for a closer look; writes no page")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--draw", type=int, default=DRAWN, help="so many faults, drawn by --seed; 0: all of them")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="left out: another one in each run")
    options = parser.parse_args()
    listed, before = all_faults(), noticed_before(options.out)
    faults = [fault for fault in listed if not options.only or fault.name in options.only]
    if 0 < options.draw < len(faults) and not options.only:
        faults = random.Random(options.seed).sample(faults, options.draw)
        print(f"{len(faults)} of {len(listed)} faults, by --draw {options.draw} --seed {options.seed}", flush=True)
    outcomes = try_all(faults, options.processes, before)
    caught = sum(each.caught for each in outcomes)
    print(f"{caught} of {len(outcomes)} caught")
    if not options.only:
        how = f" by `--draw {options.draw} --seed {options.seed}`" if len(faults) < len(listed) else ""
        options.out.write_text(page(outcomes, commit(), len(listed), before, how))
    return 0 if caught >= BAR * len(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
