"""The page of the identification campaign, from its results."""

from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np
from scipy.stats import chi2

from campaign.identification_crane import NORMAL_95
from winch_friction.identification.motor_models import MOTOR_MODELS


def page(results: dict[str, Any]) -> str:
    """The whole page as Markdown."""
    parts = [
        "# Identification campaign",
        f"`{results['command']}` · commit {results['commit']} · {datetime.now(UTC):%Y-%m-%d} · "
        f"{results['seconds']:.0f} s of one core ({results['wall']:.0f} s on a shared machine) · "
        f"{len(results['cranes'])} cranes, seeds {results['cranes'][0]['seed']} and following, not used in development",
        "A crane of its own per seed: every parameter of crane 2 "
        "moved by the spread between units, sensors with systematic errors (displacement 1 %, pressure 0.25 % and "
        "0.75 bar, one sigma), noise, quantisation. Supplier's table: generated, with a low-displacement loss that MJ4 "
        "lacks.",
        "## Bars",
        _table(("bar", "required", "found", "met"), _bars(results)),
        "## MJ4 on tables whose truth is Table 1 of paper 2",
        _recovery(results["recovery"]),
        "## Thirteen models, two fitters",
        _ranking(results),
        "## Ranking beside paper 1's figures",
        _claims(results),
        "## Cranes",
        _cranes(results["cranes"]),
    ]
    return "\n\n".join(parts) + "\n"


def _table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return "\n".join([*lines, *("| " + " | ".join(_shown(cell) for cell in row) + " |" for row in rows)])


def _shown(cell: Any) -> str:
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)


def _bars(results: dict[str, Any]) -> list[list[Any]]:
    rows = results["fitters"]
    cranes = results["cranes"]
    worst = max(row["cost"] / max(row["cost_complex"], 1e-30) for row in rows)
    ratio = min(row["evaluations_complex"] / row["evaluations"] for row in rows)
    system = [
        (c["fits"][f"{eq}, least squares"], c["fits"][f"{eq}, complex"]) for c in cranes for eq in ("eq 8", "eq 10")
    ]
    worst_system = max(exact[0] / searched[0] for exact, searched in system)
    ratio_system = min(searched[1] / exact[1] for exact, searched in system)
    recovered = [abs(r["deviation"][n]) for r in results["recovery"] for n in ("K2", "K3", "K4", "K5")]
    k1 = [abs(r["sigmas"]["K1"]) for r in results["recovery"]]
    high = [r["worst_high_displacement"] for r in results["recovery"]]
    above, below = (_held(cranes, "joint fit", f"truth, {side}") for side in ("above", "below"))
    measured_above, measured_below = (_held(cranes, "joint fit", f"measured, {side}") for side in ("above", "below"))
    share, count = _coverage_share(cranes)
    ahc = [c["ahc"][test]["joint fit"] for c in cranes for test in c["ahc"]]
    turning, whole = max(a[0] for a in ahc), max(a[1] for a in ahc)
    lines = [
        ["least squares cost / complex cost, motor tables", "<= 1", worst, worst <= 1.0 + 1e-9],
        ["evaluations complex / least squares, motor tables", ">= 100", ratio, ratio >= 100],
        ["least squares cost / complex cost, crane tests", "<= 1", worst_system, worst_system <= 1.0 + 1e-9],
        ["evaluations complex / least squares, crane tests", ">= 100", ratio_system, ratio_system >= 100],
        ["K2, K3, K4, K5 of three motors, worst deviation %", "<= 2", max(recovered), max(recovered) <= 2.0],
        ["K1, worst deviation in its own sigma", "<= 2", max(k1), max(k1) <= 2.0],
        ["MJ4 error above 54 % of D_max, % of nominal", "<= 1", max(high), max(high) <= 1.0],
        ["held-out T_ft above 250 rpm against truth, worst seed, % of nominal", "<= 1", above, above <= 1.0],
        ["held-out T_ft below 250 rpm against truth, worst seed, %", "<= 2", below, below <= 2.0],
        ["the same against the measured T_ft, above", "<= 1", measured_above, measured_above <= 1.0],
        ["the same against the measured T_ft, below", "<= 2", measured_below, measured_below <= 2.0],
        [
            f"truth inside 95 % intervals, identifiable combinations ({count} cases), %",
            "90-99",
            share,
            90 <= share <= 99,
        ],
        ["AHC pressure RMS while turning, worst, bar", "<= 5", turning, turning <= 5.0],
        ["AHC pressure RMS, standstill included, worst, bar", "<= 5", whole, whole <= 5.0],
        *_consistency_bars(cranes),
    ]
    return [[a, b, c, "yes" if d else "**no**"] for a, b, c, d in lines]


def _held(cranes: list[dict[str, Any]], model: str, key: str) -> float:
    return max(crane["held_out"][model][key] for crane in cranes)


def _coverage_share(cranes: list[dict[str, Any]]) -> tuple[float, int]:
    scores = [z for c in cranes for name, z in c["coverage"].items() if not name.startswith("parameter")]
    return 100.0 * float(np.mean(np.abs(scores) <= NORMAL_95)), len(scores)


def _consistency_bars(cranes: list[dict[str, Any]]) -> list[list[Any]]:
    rows = []
    for sensors in cranes[0]["consistency"]:
        found = [crane["consistency"][sensors] for crane in cranes]
        nis = float(np.mean([each["nis"] for each in found]))
        windows = 100.0 * float(np.mean([each["windows_inside"] for each in found]))
        freedom = len(found) * found[0]["dimension"]
        low, high = (float(chi2.ppf(q, freedom)) / len(found) for q in (0.025, 0.975))
        title = f"{sensors}: windows of 100 NIS inside their 95 % band, % (mean NIS {nis:.2f})"
        rows.append([title, ">= 90", windows, windows >= 90.0])
        for key, title in (("nees_seed", "NEES of the seed"), ("nees", "NEES after a heave run")):
            value = float(np.mean([each[key] for each in found]))
            rows.append([f"{sensors}: {title}", f"{low:.1f}-{high:.1f}", value, low <= value <= high])
    return rows


def _recovery(found: list[dict[str, Any]]) -> str:
    names = list(found[0]["deviation"])
    rows = [
        [f"{each['motor']} cm³", *(f"{each['deviation'][n]:+.2f} % ({each['sigmas'][n]:+.1f} σ)" for n in names),
         each["worst_high_displacement"], each["worst"]]
        for each in found
    ]  # fmt: skip
    return _table(("motor", *names, "worst error above 54 % D_max, % of nominal", "anywhere"), rows)


def _ranking(results: dict[str, Any]) -> str:
    last = results["fitters"][-1]["table"]
    rows = []
    for name, described in MOTOR_MODELS.items():
        mine = [row for row in results["fitters"] if row["model"] == name and row["table"] == last]
        chosen = {kind: [row for row in mine if row["kind"] == kind and row["motor"] == 280][0]
                  for kind in ("variable", "fixed")}  # fmt: skip
        out = results["held_out"][280][name][0]
        variable = chosen["variable"]
        rows.append(
            [described.title, chosen["fixed"]["parameters"], chosen["fixed"]["rms"], variable["rms"], out,
             f"{variable['cost']:.6g}", f"{variable['cost_complex']:.6g}", variable["evaluations"],
             variable["evaluations_complex"]]
        )  # fmt: skip
    columns = ("model", "parameters", "fixed: RMS N·m", "variable: RMS", "held-out displacement: RMS",
               "variable: cost LS", "cost complex", "evaluations LS", "evaluations complex")  # fmt: skip
    rows.sort(key=lambda row: row[3])
    return f"Motor of 280 cm³/rev, table {last}, equal weights (the papers' cost).\n\n" + _table(columns, rows)


def _claims(results: dict[str, Any]) -> str:
    """What paper 1 says of its figures 3-5, held against the generated tables."""
    last = results["fitters"][-1]["table"]
    rms = {(r["kind"], r["model"]): r["rms"] for r in results["fitters"] if r["motor"] == 280 and r["table"] == last}
    old, new = ("wilson", "schlosser", "thoma", "pacey"), ("mj1", "mj2", "mj3", "mj4", "mj5", "mj6")
    best_old = min(rms["fixed", name] for name in ("wilson", "schlosser", "thoma", "pacey"))
    others = min(rms["variable", name] for name in (*old, "jeong", "ortwig", "huhtala"))
    trio = max(rms["variable", name] for name in ("mj4", "mj5", "mj6"))
    rest = min(rms["variable", name] for name in ("mj1", "mj2", "mj3"))
    lines = [
        ("Fig 3 (fixed): Ortwig and Jeong improve on the older models significantly",
         max(rms["fixed", "ortwig"], rms["fixed", "jeong"]) < 0.5 * best_old,
         f"Ortwig {rms['fixed', 'ortwig']:.2g}, Jeong {rms['fixed', 'jeong']:.2g}, best older {best_old:.2g} N·m"),
        ("Fig 4 (variable): the new models are significantly better than all others",
         max(rms["variable", name] for name in new) < 0.5 * others,
         f"worst new {max(rms['variable', name] for name in new):.2g}, best other {others:.2g} N·m"),
        ("Fig 5: MJ4, MJ5, MJ6 are the best of the new ones", trio < rest, f"worst of three {trio:.2g}, "
         f"best of the others {rest:.2g} N·m"),
        ("Fig 5: MJ5 is slightly better than MJ4", rms["variable", "mj5"] <= rms["variable", "mj4"],
         f"MJ5 {rms['variable', 'mj5']:.3g}, MJ4 {rms['variable', 'mj4']:.3g} N·m"),
    ]  # fmt: skip
    rows = [[claim, "agrees" if holds else "**does not**", why] for claim, holds, why in lines]
    return _table(("paper 1", "generated tables", "RMS"), rows) + "\n\n" + _WHY


_WHY = """\
Why they agree, and what cannot be compared. The generated tables are MJ4 plus a small low-displacement loss, so MJ4
and its supersets MJ5 and MJ6 must lead: that Figs 4 and 5 agree is no independent confirmation of paper 1. What the
tables do test: Wilson, Schlösser and Jeong read no displacement and fail for variable displacement whatever the
truth; Thoma is the best of the old ones because its inertia term has the right D³ω²; Ortwig and the reconstructed
Huhtala are at most bilinear in displacement and speed and miss D³ω², with 8 and 28 parameters. At fixed displacement
MJ1 equals Jeong, MJ2, MJ4 and MJ6 nearly coincide, Pacey is Wilson and Thoma is Schlösser, so that only groups can be
ranked. The notch term (Jeong, MJ1, MJ6) gains nothing: the truth has none. Paper 1 prints no numbers with its
figures, so that only the order and its words can be compared."""


def _cranes(cranes: list[dict[str, Any]]) -> str:
    return "\n\n".join([_held_out_table(cranes), _coverage_table(cranes), _loop_text(cranes), _ahc_table(cranes)])


def _held_out_table(cranes: list[dict[str, Any]]) -> str:
    rows = []
    for model in cranes[0]["held_out"]:
        for key in cranes[0]["held_out"][model]:
            values = [crane["held_out"][model][key] for crane in cranes]
            rows.append([model, key, float(np.median(values)), float(np.max(values))])
    return "Largest |error| on held-out tests 8-12, % of nominal torque, per seed:\n\n" + _table(
        ("model", "against, at 250 rpm and", "median seed", "worst seed"), rows
    )


def _coverage_table(cranes: list[dict[str, Any]]) -> str:
    rows = []
    for name in cranes[0]["coverage"]:
        scores = np.array([crane["coverage"][name] for crane in cranes])
        inside = 100.0 * float(np.mean(np.abs(scores) <= NORMAL_95))
        rows.append([name, float(scores.mean()), float(scores.std(ddof=1)), inside])
    return "Joint fit, (estimate − truth)/σ over the seeds:\n\n" + _table(
        ("combination", "mean", "spread (1 expected)", "inside 95 %"), rows
    )


def _loop_text(cranes: list[dict[str, Any]]) -> str:
    gains = [1.0 - c["loops"]["fitted"][-1] / c["loops"]["fitted"][0] for c in cranes]
    changes = [1.0 - c["loops"]["held_out"][-1] / c["loops"]["held_out"][0] for c in cranes]
    counts = [len(c["loops"]["fitted"]) for c in cranes]
    return (
        f"Second loop: E on the fitted tests falls by {100 * np.median(gains):.0f} % (median; paper 2: 30 %) in "
        f"{np.median(counts):.0f} loops. On the held-out tests it falls by {100 * np.median(changes):.0f} % (median) "
        f"and rises, an over-fit, in {sum(change < 0 for change in changes)} of {len(changes)} seeds (worst: "
        f"{-100 * min(changes):+.0f} %)."
    )


def _ahc_table(cranes: list[dict[str, Any]]) -> str:
    rows = []
    for test in cranes[0]["ahc"]:
        for model in cranes[0]["ahc"][test]:
            values = np.array([crane["ahc"][test][model] for crane in cranes])
            rows.append([test, model, *np.median(values, axis=0).tolist(), *values.max(axis=0).tolist()])
    columns = ("test", "model", "RMS turning, bar, median", "whole run, median", "turning, worst", "whole run, worst")
    return "Predicted AHC pressure:\n\n" + _table(columns, rows)
