"""The third winch's table."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from campaign.second_report import answer_of, cell_of, outcome_in, share_line, wrong_single
from campaign.third_rig.sets import NULL, OUTSIDE, PAIR, SETS, SINGLE

Row = dict[str, Any]

HEAD = """# A third independent winch, through the command line

Data from `campaign/third_rig`, which an outside examiner wrote: prescribed motion, a load that swings on its wire, an
inverse balance of torques, sensors of its own. It shares no equation, no simulator and no constant with the package
or with the other two generators, and draws another winch for every set. Every effect of the
catalogue has one to two laws of its own; each is given a size at which it changes the balance by 3 to 10 noise floors
and at which, as far as a larger trace and a better known seed can bring it there, about two are left beyond what the
seed's standard deviations may claim. Each set is written as CSV files with a crane and a model file, and
`winch-friction gap` runs on it as a process; where it named or proposed something, runs that came later are searched
with the model that it wrote."""

FIRST_SEARCH = """## Every set

The trace is what the hidden effect changes in the balance, in noise floors, and in brackets what of it lies beyond the
seed's standard deviations. The gap of the locked runs before and after what was named, and its noise floor, in bar of
the motors that balance; `again`: the verdict on the fresh runs with the written model; seconds of the first search."""


def write_table(path: Path, rows: Sequence[Row], draw: int, note: str = "") -> None:
    """Markdown: command and commit, the summary, one line per set."""
    order = list(SETS)
    rows = sorted(rows, key=lambda row: order.index(row["set"]))
    commits = Counter(row.get("commit", "unknown") for row in rows)
    missing = [key for key in order if key not in {row["set"] for row in rows}]
    facts = [
        "* Command: `make campaign-third` (`python -m campaign.third`; resumable)",
        f"* Commit: {', '.join(f'{name} ({n} data sets)' for name, n in commits.items())}",
        f"* Data sets: {len(rows)} of {len(order)} planned"
        f" ({', '.join(f'{n} {kind}' for kind, n in Counter(row['kind'] for row in rows).items())}), draw {draw};"
        " draws 0 to 6 were seen in development",
        *([f"* {note}"] if note else []),
        *([f"* Not run: {', '.join(missing)}"] if missing else []),
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n\n".join([HEAD, "\n".join(facts), _summary(rows), _sets(rows)]) + "\n")


def _summary(rows: Sequence[Row]) -> str:
    put = [row for row in rows if row["outcome"] != "not drawn"]
    of = {kind: [row for row in put if row["kind"] == kind] for kind in (NULL, SINGLE, PAIR, OUTSIDE)}
    answered = [row for row in put if row.get("again") and row["sets"]]
    lines = [
        "| what | measured |",
        "|---|---|",
        share_line("nulls: `nothing_missing`", of[NULL], outcome_in("quiet")),
        share_line("one effect: right, alone or in a set of at most three", of[SINGLE], outcome_in("right")),
        share_line("one effect: right, and another name beside it", of[SINGLE], outcome_in("right+extra")),
        share_line("one effect: left unexplained, without a name", of[SINGLE], outcome_in("unexplained")),
        share_line("one effect: another name instead", of[SINGLE], outcome_in("wrong")),
        share_line("one effect: missed", of[SINGLE], outcome_in("missed")),
        share_line("wrong single names, all sets but those outside", [*of[NULL], *of[SINGLE], *of[PAIR]], wrong_single),
        share_line("two at once: both found, and nothing else", of[PAIR], outcome_in("both")),
        share_line("two at once: one found, and nothing else", of[PAIR], outcome_in("one")),
        share_line("two at once: a name of neither", of[PAIR], outcome_in("wrong", "both+extra", "one+extra")),
        share_line("outside the catalogue: named", of[OUTSIDE], outcome_in("named")),
        share_line("outside the catalogue: a proposal, without a name", of[OUTSIDE], outcome_in("proposal")),
        share_line("outside the catalogue: missed", of[OUTSIDE], outcome_in("missed")),
        share_line("named: `nothing_missing` on fresh runs", answered, lambda row: row["again"] == "nothing_missing"),
        share_line("`insufficient`", put, outcome_in("insufficient")),
        share_line("refused, or ended with an error", put, lambda row: "error" in row or "again_error" in row),
        share_line("not drawn: the effect leaves no trace", rows, outcome_in("not drawn")),
    ]
    return "\n".join(lines)


def _sets(rows: Sequence[Row]) -> str:
    lines = [
        FIRST_SEARCH,
        "",
        "| set | hidden | trace | rate, Hz | answer | | locked gap | floor | again | s |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    return "\n".join([*lines, *(_of_set(row) for row in rows)])


def _of_set(row: Row) -> str:
    rate = f"{row['rate']:g}" if "rate" in row else "–"
    first = f"| `{row['set']}` | {cell_of(SETS[row['set']].hidden)} | {_traces(row)} | {rate} |"
    if "verdict" not in row:
        return f"{first} {cell_of(row['error'])[-200:]} | {row['outcome']} | – | – | – | – |"
    gap = f"{_bar(row['before'])} → {_bar(row['after'])} | {_bar(row['floor'])}"
    return f"{first} {answer_of(row)} | {row['outcome']} | {gap} | {row.get('again', '–')} | {row['seconds']:.0f} |"


def _traces(row: Row) -> str:
    pairs = zip(row.get("traces", []), row.get("beyond", []), strict=True)
    return ", ".join(f"{trace:.1f} ({beyond:.1f})" if trace else "speed" for trace, beyond in pairs) or "–"


def _bar(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"
