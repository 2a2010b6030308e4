"""The hard gap campaign's table."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

Row = dict[str, Any]
NAMED = ("missing_effect", "ambiguous")


def write_table(path: Path, rows: Sequence[Row], planned: int) -> None:
    """Markdown with the bars and every case that misses one."""
    commits = Counter(row.get("commit", "unknown") for row in rows)
    first = min((row["seed"] for row in rows), default="nowhere")
    parts = [
        "# The hard gap campaign: poor logs, other rates, far seeds, and the written file on fresh runs",
        f"Data from `campaign/rig`, cut, thinned and resampled; seeds from {first}.",
        "* Command: `make campaign-gap-hard` (`python -m campaign.gap_hard`; resumable)\n"
        f"* Commit: {', '.join(f'{name} ({n} data sets)' for name, n in commits.items())}\n"
        f"* Data sets: {len(rows)} of {planned} planned"
        f" ({', '.join(f'{n} {kind}' for kind, n in Counter(row['kind'] for row in rows).items())})",
        _bars(rows),
        _verdicts(rows),
        _missed(rows),
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n\n".join(part for part in parts if part) + "\n")


def named(row: Row) -> bool:
    """Whether the moving samples gave a name; what shows elsewhere is proven there, not by their gap."""
    return row.get("first_verdict") in NAMED and "moving" in row["first_where"]


def unproven(row: Row) -> bool:
    """A name though the locked gap did not fall below its former interval."""
    return named(row) and not row["first_after"] < row["first_before_low"]


def wrong_single(row: Row) -> bool:
    """One name alone, and not what was hidden."""
    return any(len(each) == 1 and row["hidden"] not in each for each in row.get("first_sets", []))


def alarmed(row: Row) -> bool:
    """Nothing was hidden, and something was named or left unexplained."""
    return not row["hidden"] and row.get("first_verdict") not in ("nothing_missing", "insufficient")


def left(row: Row) -> bool:
    """The written file leaves more than it may on fresh runs, or the same name comes again, and nothing says so."""
    if row["kind"] != "proof" or "again_verdict" not in row:
        return False
    if any(row["hidden"] in each for each in row["again_sets"]):
        return True
    return row["again_verdict"] == "nothing_missing" and row["again_before"] > 1.5 * row["again_floor"]


def right(row: Row) -> bool:
    """What was hidden is named, alone or in a set."""
    return any(row["hidden"] in each for each in row.get("first_sets", []))


def _bars(rows: Sequence[Row]) -> str:
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in ("poor", "rate", "far", "proof")}
    hidden = [row for row in kinds["rate"] if row["hidden"]]
    lines = ["| what | bar | measured |", "|---|---|---|"]
    lines += [
        _line("poor logs: names without a lower locked gap", "0", kinds["poor"], unproven),
        _line("poor logs: wrong single names", "0", kinds["poor"], wrong_single),
        _line("poor logs: nulls alarmed", "≤ 1 %", [r for r in kinds["poor"] if not r["hidden"]], alarmed),
        _line("defects in all kinds", "0", rows, lambda row: "error" in row),
        _line("10 and 200 Hz: right name or set", "≥ 95 %", hidden, right),
        _line("10 and 200 Hz: wrong single names", "≤ 0.5 %", kinds["rate"], wrong_single),
        _line("10 and 200 Hz: nulls alarmed", "≤ 1 %", [r for r in kinds["rate"] if not r["hidden"]], alarmed),
        _line("seeds 1.5 to 1.8 sigma away: nulls alarmed", "≤ 1 %", kinds["far"], alarmed),
        _line("written file on fresh runs: same name again, or more than 1.5 × the noise unsaid", "0",
              kinds["proof"], left),
    ]  # fmt: skip
    return "\n".join(lines)


def _line(what: str, bar: str, rows: Sequence[Row], test) -> str:  # type: ignore[no-untyped-def]
    k = sum(bool(test(row)) for row in rows)
    measured = f"{k} of {len(rows)} ({100 * k / len(rows):.1f} %)" if rows else "–"
    return f"| {what} | {bar} | {measured} |"


def _verdicts(rows: Sequence[Row]) -> str:
    lines = ["## Verdicts", "", "| kind | " + "verdicts |", "|---|---|"]
    for kind in dict.fromkeys(row["kind"] for row in rows):
        own = Counter(_outcome(row) for row in rows if row["kind"] == kind)
        lines.append(f"| {kind} | {', '.join(f'{name} {n}' for name, n in own.most_common())} |")
    return "\n".join(lines)


def _outcome(row: Row) -> str:
    return "defect" if "error" in row else "refused" if "refused" in row else str(row["first_verdict"])


def _missed(rows: Sequence[Row]) -> str:
    tests = {"unproven": unproven, "wrong single": wrong_single, "alarmed": alarmed, "left": left,
             "defect": lambda row: "error" in row}  # fmt: skip
    found = [(row, [name for name, test in tests.items() if test(row)]) for row in rows]
    found = [(row, names) for row, names in found if names]
    if not found:
        return ""
    lines = ["## Every case that misses a bar", "", "| data set | what | answer |", "|---|---|---|"]
    for row, names in found:
        answer = row.get("error") or f"{row['first_verdict']} {row['first_sets']}"
        if row["kind"] == "proof" and "again_verdict" in row:
            answer += f"; again {row['again_verdict']} {row['again_sets']}"
            answer += f" {row['again_before']:.3g} of {row['again_floor']:.3g}"
        lines.append(f"| {row['key']} | {', '.join(names)} | {answer} |")
    return "\n".join(lines)
