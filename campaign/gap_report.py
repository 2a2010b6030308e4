"""The gap campaign's table: issue bars, then every effect, then what went wrong."""

import json
from collections import Counter, defaultdict
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

from campaign.gap_cases import Counts, all_cases
from campaign.gap_report_drawn import drawn_worlds

Row = dict[str, Any]
COST = Path("out/campaign_gap/cost.json")  # written by campaign.gap_cost

READING = """## Reading the table

* Nulls and effects rotate through nine flavours of data: rigid and elastic wires, regular and irregular seas, crane
  still or heaving, encoders of 1024 to 8192 pulses, white and coloured noise, with and without optional channels.
* At 0.3 of the size some effects are inside what is ordinary, and are rightly not called missing: `brake_drag`,
  `high_pressure_mixed` and `port_turbulence` move a base parameter (K4, K5, K2) by less than two standard deviations of
  its prior, as the nulls do (the arithmetic of each set stands under "Small effects and the prior"); `slip_leakage` is
  then within a motor's ordinary leakage.
* `entrained_air` (1 %) leaves the torque balance closed and is found in the flow, against the commanded speed;
  `dwell_stiction` shows for a radian of travel after a rest, where friction at rest is undetermined.
* The drives of the elastic cranes: one has a rope's light damping, one is damped as strongly as 0.2 MN s/m."""


def write_table(path: Path, rows: Sequence[Row], counts: Counts, note: str = "") -> None:
    """Markdown with the bars, each effect's line and the wrong answers."""
    failed = [row for row in rows if "error" in row]
    good = [row for row in rows if "error" not in row]
    parts = [
        _head(rows, failed, counts, note),
        _bars(good, failed),
        _cost(),
        _effects(good),
        _small(good),
        _outside(good),
        _pairs(good),
        drawn_worlds(good, share),
        _wrong(good),
        READING,
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n\n".join(part for part in parts if part) + "\n")


def _head(rows: Sequence[Row], failed: Sequence[Row], counts: Counts, note: str) -> str:
    commits = Counter(row.get("commit", "unknown") for row in rows)
    seeds = [row["seed"] for row in rows]
    kinds = Counter(row["kind"] for row in rows)
    return "\n".join(
        [
            "# Naming a missing effect: the gap campaign",
            "",
            "Data from `campaign/rig`, a generator that shares no code with the package; 12 runs of 170–240 s at 50 Hz",
            "per data set; sizes relative to the typical size of each effect.",
            "",
            "* Command: `make campaign-gap` (`python -m campaign.gap`; resumable)",
            f"* Commit: {', '.join(f'{name} ({n} data sets)' for name, n in commits.items())}",
            f"* Data sets: {len(rows)} of {len(all_cases(counts, 0))} planned"
            f" ({', '.join(f'{n} {k}' for k, n in kinds.items())}), seeds"
            f" {min(seeds, default=0)}–{max(seeds, default=0)}, flavours in turn",
            f"* Ended with an error: {len(failed)}",
            *([f"* {note}"] if note else []),
        ]
    )


def share(rows: Sequence[Row], key: str) -> str:
    """'k of n (p %)'."""
    k = sum(bool(row[key]) for row in rows)
    return f"{k} of {len(rows)} ({100 * k / len(rows):.1f} %)" if rows else "–"


def _size(row: Row) -> float:
    return float(row["effects"][0][1]) if row["effects"] else 0.0


def _bars(good: Sequence[Row], failed: Sequence[Row]) -> str:
    singles = [row for row in good if row["kind"] == "single"]
    lines = ["| what | bar | measured |", "|---|---|---|"]
    lines.append(
        f"| null data sets that got anything but `nothing_missing` | ≤ 2 % | {share(_kind(good, 'null'), 'detected')} |"
    )
    for size, bar in ((1.0, "≥ 90 %"), (0.3, "≥ 80 %"), (0.1, "shown")):
        rows = [row for row in singles if _size(row) == size]
        detected = [row for row in rows if row["detected"]]
        named, wrong = ("≥ 95 %", "≤ 1 %") if size > 0.2 else ("shown", "shown")
        lines.append(f"| detected at {size:g} of the size | {bar} | {share(rows, 'detected')} |")
        lines.append(
            f"| right name, or set of at most 3, of the detected at {size:g} | {named} | {share(detected, 'right')} |"
        )
        lines.append(f"| wrong single name at {size:g} | {wrong} | {share(detected, 'wrong_single')} |")
        large = [row for row in rows if row.get("beyond", {}).get("exceeds")]
        if large:
            lines.append(
                f"| detected at {size:g} of those beyond the prior's two deviations | ≥ 80 % |"
                f" {share(large, 'detected')} |"
            )
    pairs = [row | {"both": row["found"] == 2} for row in _kind(good, "pair")]
    lines.append(f"| pairs: both found | ≥ 70 % | {share(pairs, 'both')} |")
    lines.append(f"| pairs: a wrong one | ≤ 5 % | {share(pairs, 'wrong_entry')} |")
    outside = [
        row | {"named": row["verdict"] in ("missing_effect", "ambiguous"), "known": _known(row)}
        for row in _kind(good, "outside")
    ]
    lines.append(f"| outside the library: named | ≤ 10 % | {share(outside, 'named')} |")
    lines.append(f"| outside the library: `unexplained`, right signal first | ≥ 70 % | {share(outside, 'known')} |")
    lines.append(
        f"| held-out gap above the noise floor reduced, median of the correctly named at size 1 | ≥ 80 % |"
        f" {_reduction(singles)} |"
    )
    lines.append(
        f"| time per data set on one core, median and longest | ≤ 60 s on two | {_spread(good, 'seconds', 's')} |"
    )
    lines.append(f"| peak memory of the process | < 1.5 GB | {_spread(good, 'megabytes', 'MB')} |")
    lines.append(f"| data sets that ended with an error | 0 | {len(failed)} |")
    return "\n".join(lines)


def _kind(rows: Sequence[Row], kind: str) -> list[Row]:
    return [row for row in rows if row["kind"] == kind]


def _known(row: Row) -> bool:
    return row["verdict"] == "unexplained" and row["right_signal"]


def _reduction(singles: Sequence[Row]) -> str:
    values = [r["reduction"] for r in singles if r["right"] and _size(r) == 1.0 and r["reduction"] is not None]
    return f"{100 * median(values):.0f} % ({len(values)} data sets)" if values else "–"


def _spread(rows: Sequence[Row], key: str, unit: str) -> str:
    values = [row[key] for row in rows]
    return f"{median(values):.0f} and {max(values):.0f} {unit}" if values else "–"


def _cost() -> str:
    """The figures of `campaign.gap_cost`, where it has run."""
    if not COST.is_file():
        return ""
    found = json.loads(COST.read_text())
    cold, rows = found["cold"], found["growth"]
    return "\n".join(
        [
            "## Cost",
            "",
            f"`python -m campaign.gap_cost` on {found['cores']} cores:",
            "",
            "| what | bar | measured |",
            "|---|---|---|",
            f"| `winch-friction gap` on twelve CSV files, cold start | ≤ 60 s |"
            f" {cold['seconds']:.0f} s, of them {cold['cpu_seconds']:.0f} s of processor (load {cold['load']:.0f}) |",
            f"| its peak memory | < 1.5 GB | {cold['megabytes'] / 1024:.2f} GB |",
            *_longest(found.get("longest", [])),
            f"| exponent of time over {rows[-1][0] / rows[0][0]:.0f} × the samples | ≤ 1.1 | {found['exponent']:.2f} |",
            "",
            "Samples and processor seconds of the workflow: " + ", ".join(f"{n}: {t:.1f} s" for n, t in rows) + ".",
        ]
    )


def _longest(alone: Sequence[Row]) -> list[str]:
    if not alone:
        return []
    row = max(alone, key=lambda each: each["seconds"])
    return [
        f"| the {len(alone)} longest searches of the campaign, again, alone and cold: the longest | ≤ 60 s |"
        f" {row['seconds']:.0f} s, of them {row['cpu_seconds']:.0f} s of processor"
        f" ({max(each['megabytes'] for each in alone) / 1024:.2f} GB at most) |"
    ]


def _effects(good: Sequence[Row]) -> str:
    table: dict[str, list[Row]] = defaultdict(list)
    for row in _kind(good, "single"):
        table[row["effects"][0][0]].append(row)
    if not table:
        return ""
    lines = [
        "## Every effect",
        "",
        "Detected / right (name, or set of at most 3) / wrong single name, of the data sets.",
        "",
        "| effect | size 1 | 0.3 | 0.1 | the usual answer at size 1 |",
        "|---|---|---|---|---|",
    ]
    for effect, rows in table.items():
        cells = [_cell([row for row in rows if _size(row) == size]) for size in (1.0, 0.3, 0.1)]
        answers = Counter(_answer(row) for row in rows if _size(row) == 1.0).most_common(2)
        lines.append(f"| `{effect}` | {' | '.join(cells)} | {'; '.join(f'{n}× {a}' for a, n in answers)} |")
    return "\n".join(lines)


def _small(good: Sequence[Row]) -> str:
    """What the prior alone can take of small effects (`campaign.gap_small`)."""
    rows = [row for row in _kind(good, "single") if "beyond" in row]
    if not rows:
        return ""
    lines = [
        "## Small effects and the prior",
        "",
        "The trace of the effect (bar of the balancing motors, with it less without it), what the seed model's",
        "parameters and the measurement's tolerances cannot take of it within two of their standard deviations, and",
        "the noise floor.",
        "An effect counts where that is more than the floor.",
        "",
        "| data set | trace | left | floor | counts | answer |",
        "|---|---|---|---|---|---|",
    ]
    for row in sorted(rows, key=lambda r: (-_size(r), not r["beyond"]["exceeds"], r["key"])):
        trace, left = (f"{row['beyond'][key]:.2f}" for key in ("trace", "left"))
        counts = "yes" if row["beyond"]["exceeds"] else "no"
        name = f"{row['effects'][0][0]} × {_size(row):g}, {row['flavour']}"
        lines.append(f"| {name} | {trace} | {left} | {row['floor']:.2f} | {counts} | {_answer(row)} |")
    return "\n".join(lines)


def _cell(rows: Sequence[Row]) -> str:
    if not rows:
        return "–"
    detected, right, wrong = (sum(bool(row[key]) for row in rows) for key in ("detected", "right", "wrong_single"))
    return f"{detected} / {right} / {wrong} of {len(rows)}"


def _answer(row: Row) -> str:
    sets = " + ".join("{" + ", ".join(each) + "}" if len(each) > 1 else each[0] for each in row["sets"])
    return f"{row['verdict']}: {sets}" if sets else row["verdict"]


def _outside(good: Sequence[Row]) -> str:
    rows = _kind(good, "outside")
    if not rows:
        return ""
    lines = [
        "## Outside the library",
        "",
        "| hidden | flavour | verdict | signals, first to last |",
        "|---|---|---|---|",
    ]
    for row in sorted(rows, key=lambda r: r["effects"][0][0]):
        signals = ", ".join(row["signals"][:3])
        lines.append(f"| {row['effects'][0][0]} | {row['flavour']} | {_answer(row)} | {signals} |")
    return "\n".join(lines)


def _pairs(good: Sequence[Row]) -> str:
    table: dict[str, list[Row]] = defaultdict(list)
    for row in _kind(good, "pair"):
        table[" + ".join(name for name, _ in row["effects"])].append(row)
    if not table:
        return ""
    lines = ["## Pairs", "", "| hidden | both found | one found | with a wrong one | of |", "|---|---|---|---|---|"]
    for pair, rows in table.items():
        found = Counter(row["found"] for row in rows)
        lines.append(f"| {pair} | {found[2]} | {found[1]} | {sum(r['wrong_entry'] for r in rows)} | {len(rows)} |")
    return "\n".join(lines)


def _wrong(good: Sequence[Row]) -> str:
    rows = [r for r in good if (r["kind"] == "null" and r["detected"]) or (r["kind"] == "single" and r["wrong_single"])]
    if not rows:
        return ""
    lines = ["## Wrong answers", "", "| data set | answer |", "|---|---|"]
    return "\n".join(lines + [f"| {row['key']} | {_answer(row)} |" for row in rows])
