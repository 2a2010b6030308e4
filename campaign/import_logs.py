"""`make campaign-import`: spoilt logs through `import --propose` and `import`; written to docs/campaign_import.md.

Every log must come back as the run it was made from, or be answered with the cause of what was done to it.
"""

import argparse
import contextlib
import io
import re
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from campaign.import_variants import Variant, draw, write
from winch_friction.cli.main import run as command
from winch_friction.importing.carry_out import import_log
from winch_friction.importing.mapping import load_map
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run

EXAMPLES = Path(__file__).parents[1] / "config" / "examples" / "practice_150t"
REAL = {
    "real/winch_100kw/cycle_13": "winch_100kw", "real/winch_100kw/cycle_37": "winch_100kw",
    "real/worm_drive/60": "worm_drive", "real/worm_drive/n120": "worm_drive",
}  # fmt: skip
BASES = ("test_02", "test_03", "test_08", "test_09", "ahc_160", "ahc_215", *REAL)
SLOWEST = 5.0  # s for an answer
_ROUNDING = 5e-3  # of a channel's largest value: the digits that a log keeps

SMALL_CRANE = """\
schema: winch_friction.crane/1
name: crane_50t
drive: hydraulic
gear_ratio: 110
max_displacement: {value: 160, unit: cm^3/rev}
drum: {layer_radii: [0.45, 0.49, 0.53]}
groups: {main: 6, active: 2, passive: 4}
inertia: {value: 0.6, unit: kg*m^2}
absolute_torque_limit: {value: 900, unit: N*m}
"""


@dataclass(frozen=True)
class Outcome:
    """What became of a variant: `kind` is imported, answered, wrong (written, but not the run's), missed or crashed."""

    variant: Variant
    kind: str
    seconds: float
    said: str

    @property
    def good(self) -> bool:
        """Whether it was imported as it was, or answered with the cause."""
        return self.kind in ("imported", "answered")


def trial(variant: Variant, folder: Path, seed: int) -> Outcome:
    """Write a variant's log, propose, import, compare."""
    base = base_run(variant.base)
    log = write(variant, base, folder, seed)
    crane = REAL.get(variant.base, "crane_150t")
    if variant.mistake.name == "wrong crane":
        small = folder / "crane_50t.yaml"
        small.write_text(SMALL_CRANE, encoding="utf-8")
        crane = str(small)
    mapped, out = folder / f"map_{variant.number:03d}.yaml", folder / f"runs_{variant.number:03d}"
    first = _timed("import", str(log), "--propose", "--crane", crane, "--map", str(mapped))
    second = _timed("import", str(log), "--map", str(mapped), "--out", str(out)) if first[0] == 0 else first
    slowest = max(first[1], second[1])
    said = second[2]
    if second[0] == 1 or "Traceback" in first[2] + second[2]:
        return Outcome(variant, "crashed", slowest, said)
    if second[0] == 0:
        written = read_run(next(out.glob("*.csv")), load_crane(crane))
        kind = "imported" if _same(written, base, variant) and not variant.mistake.said else "wrong"
        return Outcome(variant, kind, slowest, said)
    lead = said.partition("needs an answer:")[2] or said
    first_cause = lead.partition(" | ")[0]
    said_so = (*variant.mistake.said, *(("no unit",) if variant.units == "none" else ()))
    named = any(word in first_cause for word in said_so)
    return Outcome(variant, "answered" if named else "missed", slowest, said)


def base_run(name: str) -> Run:
    """The run that a log is made from: simulated, or a real one by its shipped map."""
    if name not in REAL:
        return read_run(EXAMPLES / f"{name}.parquet")
    _, folder, log = name.split("/")
    place = EXAMPLES.parent / folder
    given = load_map(place / "map.yaml")
    logged = {channel: entry for channel, entry in given.columns.items() if not entry.constant}
    return import_log(place / f"{log}.csv", replace(given, columns=logged), load_crane(REAL[name]))


def _timed(*arguments: str) -> tuple[int, float, str]:
    began = time.process_time()
    errors = io.StringIO()
    with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
        status = command(arguments)
    lines = [line for line in errors.getvalue().splitlines() if not line.startswith("warning:")]
    return status, time.process_time() - began, "\n".join(lines)


def _same(written: Run, base: Run, variant: Variant) -> bool:
    step = 2 if variant.mistake.name == "every second row" else 1
    wanted = {k: v[::step] for k, v in base.columns.items() if k in written.columns and k != "time"}
    needed = {k for k in base.columns if "." in k or k == "motor_speed"}
    if not needed <= set(written.columns) or len(written) != len(base.time[::step]):
        return False
    if variant.mistake.name == "speed late by 0.1 s":
        wanted.pop("motor_speed")
    for name, values in wanted.items():
        off = np.abs(written[name] - values)
        off[~np.isfinite(off)] = 0.0  # a stray cell is missing, which is what should become of it
        if np.max(off) > _ROUNDING * max(np.nanmax(np.abs(values)), 1e-12):
            return False
    span = written.time - written.time[0]
    return bool(np.allclose(span, base.time[::step] - base.time[0], atol=2.1e-3))


def table(outcomes: list[Outcome], seed: int) -> str:
    """The page."""
    from campaign.commit import commit

    lines = [
        "# Spoilt logs through `import`", "",
        f"`make campaign-import` (seed {seed}, {len(outcomes)} logs, commit {commit()}).", "",
        "| logs | number | imported as they were | answered with the cause | data written that are not the run's "
        "| missed | tracebacks | slowest answer, processor time |",
        "|---|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    parts = {
        "all": outcomes,
        "without a mistake": [o for o in outcomes if not o.variant.mistake.said],
        "with a mistake": [o for o in outcomes if o.variant.mistake.said],
        "names held out from the word list": [o for o in outcomes if o.variant.held_out],
        "real winches and drives": [o for o in outcomes if o.variant.base in REAL],
        "no units": [o for o in outcomes if o.variant.units == "none"],
    }
    for name, part in parts.items():
        counts = [sum(o.kind == kind for o in part) for kind in ("imported", "answered", "wrong", "missed", "crashed")]
        slowest = max((o.seconds for o in part), default=0.0)
        lines.append(f"| {name} | {len(part)} | {' | '.join(map(str, counts))} | {slowest:.1f} s |")
    good = sum(o.good for o in outcomes) / max(1, len(outcomes))
    lines += [
        "",
        f"Good: {100 * good:.1f} %. Bars: 95 % imported or answered, 0 wrong, 0 tracebacks, {SLOWEST:g} s.",
        "",
    ]
    bad = [o for o in outcomes if not o.good]
    if bad:
        lines += [
            "## What was not",
            "",
            *(f"* {o.variant}: {o.kind}; said: {_shown(o.said)}" for o in bad),
            "",
        ]
    return "\n".join(lines)


def _shown(said: str) -> str:
    """An answer without the campaign's own temporary paths."""
    return re.sub(r"\S*/(?=[\w.]+)", "", said)[:300] or "nothing"


def main() -> None:
    """The campaign."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=120)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, default=-1, help="one variant, with what it says")
    parser.add_argument("--out", type=Path, default=Path("docs/campaign_import.md"))
    options = parser.parse_args()
    numbers = [options.only] if options.only >= 0 else range(options.logs)
    outcomes = []
    with tempfile.TemporaryDirectory() as folder:
        for number in numbers:
            outcomes.append(trial(draw(number, BASES, options.seed), Path(folder), options.seed))
            last = outcomes[-1]
            print(
                f"{number:3d} {last.kind:9s} {last.seconds:4.1f} s {last.variant}"
                + ("" if last.good else f"\n      {last.said[:400]}"),
                flush=True,
            )
    if options.only < 0:
        from campaign.import_habits import every, section

        page = table(outcomes, options.seed) + "\n" + section(every())
        options.out.write_text(page, encoding="utf-8")
        print(f"good {sum(o.good for o in outcomes)} of {len(outcomes)}; written {options.out}")


if __name__ == "__main__":
    main()
