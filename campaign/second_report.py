"""The second winch's table."""

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from campaign.second_rig.sets import EFFECT, LOAD_CELL, NULL, OUTSIDE, PAIR, SETS

Row = dict[str, Any]

QUIET_AGAIN = "nothing_missing"

HEAD = """# A second independent winch, through the command line

Data from `campaign/second_rig`: a crane whose motion is prescribed, a rope on a spring, an inverse balance of torques
and sensors of its own. It shares no equation, no simulator and no constant with the package or with `campaign/rig`.
Every effect of the catalogue has a law of its own. Each set is written as CSV files with a crane and a model file, and
`winch-friction gap` runs on it as a process; where it named something it runs again with the model that it wrote."""


def write_table(path: Path, rows: Sequence[Row], draw: int, note: str = "") -> None:
    """Markdown: command and commit, the summary, one line per set."""
    order = list(SETS)
    rows = sorted(rows, key=lambda row: order.index(row["set"]))
    commits = Counter(row.get("commit", "unknown") for row in rows)
    facts = [
        "* Command: `make campaign-second` (`python -m campaign.second`; resumable)",
        f"* Commit: {', '.join(f'{name} ({n} data sets)' for name, n in commits.items())}",
        f"* Data sets: {len(rows)} of {len(SETS)} planned"
        f" ({', '.join(f'{n} {kind}' for kind, n in Counter(row['kind'] for row in rows).items())}), draw {draw};"
        " draws 0 to 3, 27, 31 and 33 to 37 were seen in development",
        *([f"* {note}"] if note else []),
        *([f"* Not run: {', '.join(key for key in order if key not in {r['set'] for r in rows})}"]
          if len(rows) < len(order) else []),
    ]  # fmt: skip
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n\n".join([HEAD, "\n".join(facts), _summary(rows), _sets(rows)]) + "\n")


def _summary(rows: Sequence[Row]) -> str:
    of = {kind: [row for row in rows if row["kind"] == kind] for kind in (NULL, EFFECT, OUTSIDE, PAIR, LOAD_CELL)}
    answered = [row for row in rows if row.get("again")]
    inside = [row for row in rows if row["kind"] != OUTSIDE]
    lines = [
        "| what | measured |",
        "|---|---|",
        share_line("nulls: `nothing_missing`", of[NULL], outcome_in("quiet")),
        share_line("one effect: right, alone or in a set of at most three", of[EFFECT], outcome_in("right")),
        share_line("one effect: left unexplained, without a name", of[EFFECT], outcome_in("unnamed")),
        share_line("one effect: a set of names without it, beside or instead", of[EFFECT], outcome_in("wrong")),
        share_line("one effect: missed", of[EFFECT], outcome_in("missed")),
        share_line("wrong single names, all sets but those outside", inside, wrong_single),
        share_line("outside the catalogue: named", of[OUTSIDE], outcome_in("named")),
        share_line("two at once: both found, and nothing else", of[PAIR], outcome_in("right")),
        share_line("load cell's gain: a name that it cannot be told from", of[LOAD_CELL], outcome_in("right")),
        share_line(
            "named: `nothing_missing` with the written model", answered, lambda r: r["again"] == "nothing_missing"
        ),
        share_line("ended with an error", rows, lambda row: "error" in row),
    ]
    return "\n".join(lines)


def outcome_in(*outcomes: str) -> Callable[[Row], bool]:
    """Whether a row's outcome is one of these."""
    return lambda row: row.get("outcome") in outcomes


def wrong_single(row: Row) -> bool:
    """Whether one of its names stands alone and is wrong."""
    return bool(row.get("wrong_single"))


def share_line(what: str, rows: Sequence[Row], test: Callable[[Row], bool]) -> str:
    """A line of the summary: how many of the rows pass."""
    return f"| {what} | {sum(map(test, rows))} of {len(rows)} |" if rows else f"| {what} | – |"


def _sets(rows: Sequence[Row]) -> str:
    lines = [
        "## Every set",
        "",
        "The gap of the locked runs before and after what was named, and its noise floor, in bar of the motors that",
        "balance; `again`: the verdict with the written model; seconds of the first search.",
        "",
        "| set | hidden | rate, Hz | answer | | locked gap | floor | again | s |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    return "\n".join([*lines, *(_of_set(row) for row in rows)])


def _of_set(row: Row) -> str:
    first = f"| `{row['set']}` | {_hidden(row['set'])} | {row['rate']:g} |"
    if "verdict" not in row:
        return f"{first} {cell_of(row['error'])[-200:]} | error | – | – | – | – |"
    gap = f"{row['before']:.2f} → {row['after']:.2f} | {row['floor']:.2f}"
    again = row.get("again") or ("error" if "error" in row else "–")
    return f"{first} {answer_of(row)} | {row['outcome']} | {gap} | {again} | {row.get('seconds', 0):.0f} |"


def _hidden(key: str) -> str:
    chosen = SETS[key]
    if chosen.kind in (NULL, OUTSIDE):
        told = (chosen.law.__doc__ or "").splitlines()[0].rstrip(".")
        return told.removeprefix("Outside the catalogue: ").removeprefix("Outside: ").lower()
    return " + ".join(" or ".join(sorted(cause)) for cause in chosen.causes)


def answer_of(row: Row) -> str:
    """Verdict and names."""
    names = " + ".join(each[0] if len(each) == 1 else "{" + ", ".join(each) + "}" for each in row["sets"])
    return f"{row['verdict']}: {names}" if names else row["verdict"]


def cell_of(text: str) -> str:
    """Text that a table's cell can hold."""
    return " ".join(text.replace("|", "/").split())
