"""The part of the gap campaign's table that is about drawn cranes: laws, far seeds, proposals."""

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from statistics import median
from typing import Any

Row = dict[str, Any]
Share = Callable[[Sequence[Row], str], str]


def drawn_worlds(good: Sequence[Row], share: Share) -> str:
    """Bars, every law, and every outside effect; empty where none of them has run."""
    rows = [row for row in good if row["flavour"] == "drawn"]
    if not rows:
        return ""
    kinds: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        kinds[row["kind"]].append(row)
    laws, held, outside = kinds["law"], kinds["held_out"], kinds["drawn_outside"]
    exponents = kinds["drawn_law"]
    proposed = [row for row in outside if row["proposed"]]
    closed = [row["closed"] for row in proposed]
    lines = [
        "## Over drawn cranes",
        "",
        "Gear, drum, rope, motors, groups, seed model, test plan, sensors, noise and rate (10 to 200 Hz) are drawn per",
        "data set. A held-out law is one of which the package has no member (a test enforces it); of every cause one",
        "more law has exponents, thresholds and companions drawn per data set (`cause:drawn`).",
        "",
        "| what | bar | measured |",
        "|---|---|---|",
        f"| nulls with anything but `nothing_missing` | ≤ 1 % | {share(kinds['drawn_null'], 'detected')} |",
        f"| nulls with a proposal | 0 | {share(kinds['drawn_null'], 'proposed')} |",
        f"| seeds 2 to 3 σ off: `seed_refuted` and no name | ≥ 95 % | {share(kinds['far_seed'], 'seed_refuted')} |",
        f"| the package's laws: right or in a set of at most 3 | ≥ 95 % | {share(laws, 'right')} |",
        *_beyond(laws, share),
        f"| the package's laws: wrong single name | ≤ 0.5 % | {share(laws, 'wrong_single')} |",
        f"| held-out laws: detected | ≥ 90 % | {share(held, 'detected')} |",
        f"| held-out laws: right or in a set of at most 3 | ≥ 85 % | {share(held, 'right')} |",
        *_beyond(held, share),
        f"| held-out laws: wrong single name | ≤ 2 % | {share(held, 'wrong_single')} |",
        f"| laws with drawn exponents: detected | ≥ 90 % | {share(exponents, 'detected')} |",
        f"| laws with drawn exponents: right or in a set of at most 3 | ≥ 85 % | {share(exponents, 'right')} |",
        *_beyond(exponents, share),
        f"| laws with drawn exponents: wrong single name | ≤ 2 % | {share(exponents, 'wrong_single')} |",
        f"| outside effects: named | ≤ 5 % | {share(outside, 'named')} |",
        f"| outside effects: a proposal | ≥ 70 % | {share(outside, 'proposed')} |",
        f"| of these, the first on the right signals | ≥ 80 % | {share(proposed, 'proposed_right')} |",
        f"| of these, share of the locked gap closed, median | ≥ 80 % | {_percent(closed)} |",
        "",
    ]
    missed = [row for row in (*laws, *held, *exponents) if not row["right"]]
    return "\n".join([*lines, *_every_law([*laws, *exponents], held), "", *_missed(missed), *_every_outside(outside)])


def _beyond(rows: Sequence[Row], share: Share) -> list[str]:
    """The same of those whose trace is more than the prior's two deviations and the noise (`campaign.gap_small`)."""
    more = [row for row in rows if row.get("beyond", {}).get("exceeds")]
    return (
        [f"| … of those whose trace the prior's two σ cannot take | shown | {share(more, 'right')} |"] if more else []
    )


def _missed(rows: Sequence[Row]) -> list[str]:
    """What was not named rightly, with the arithmetic of its size."""
    rows = [row for row in rows if "beyond" in row]
    if not rows:
        return []
    lines = [
        "What was not named rightly, with its trace in the moving samples, what the prior's two σ and the",
        "measurement's tolerances cannot take of it, and the noise floor (bar). What shows beside the balance (a leak,",
        "a ripple, a reversal) has little or no trace there.",
        "",
        "| law | seed | trace | left | floor | more than the floor | answer |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in sorted(rows, key=lambda each: (not each["beyond"]["exceeds"], each["effects"][0][0], each["seed"])):
        size, more = row["beyond"], "yes" if row["beyond"]["exceeds"] else "no"
        figures = f"{size['trace']:.2f} | {size['left']:.2f} | {row['floor']:.2f}"
        lines.append(f"| `{row['effects'][0][0]}` | {row['seed']} | {figures} | {more} | {_answer(row)} |")
    return [*lines, ""]


def _percent(values: Sequence[float]) -> str:
    return f"{100 * median(values):.0f} %" if values else "–"


def _every_law(laws: Sequence[Row], held: Sequence[Row]) -> list[str]:
    found: dict[str, list[Row]] = defaultdict(list)
    for row in (*laws, *held):
        found[row["effects"][0][0]].append(row)
    lines = ["| law | held out | detected / right / wrong single | answers |", "|---|---|---|---|"]
    for name, rows in sorted(found.items()):
        counts = " / ".join(str(sum(bool(row[key]) for row in rows)) for key in ("detected", "right", "wrong_single"))
        answers = Counter(_answer(row) for row in rows).most_common(2)
        own = "yes" if rows[0]["kind"] == "held_out" else ""
        lines.append(f"| `{name}` | {own} | {counts} of {len(rows)} | {'; '.join(f'{n}× {a}' for a, n in answers)} |")
    return lines


def _every_outside(rows: Sequence[Row]) -> list[str]:
    lines = ["| outside effect | verdict | proposal | right signals | closed |", "|---|---|---|---|---|"]
    for row in sorted(rows, key=lambda each: each["effects"][0][0]):
        said = (row["answer"].get("proposals") or [{}])[0].get("equation", "–")
        closed = f"{100 * row['closed']:.0f} %" if row["proposed"] else "–"
        right = "yes" if row["proposed_right"] else "no"
        lines.append(f"| {row['effects'][0][0]} | {_answer(row)} | `{said}` | {right} | {closed} |")
    return lines


def _answer(row: Row) -> str:
    return f"{row['verdict']} {' + '.join('{' + ', '.join(each) + '}' for each in row['sets'])}".strip()
