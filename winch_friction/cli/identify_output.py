"""What the `identify` verbs print: tables for people, JSON for machines."""

from pathlib import Path
from typing import Any

from winch_friction.cli.console import show_json, show_table
from winch_friction.physics.channels import beside


def show_motor(found: Any, fitted: Any, out: Path, json: bool) -> None:

    rows = []
    for score in found.scores:
        other = found.by_complex.get(score.name)
        rows.append(
            [score.name, score.fitted.parameter_count, score.fitted.rms, score.held_out, score.bic, score.fitted.cost,
             other.cost if other else float("nan"), score.fitted.evaluations, other.evaluations if other else 0]
        )  # fmt: skip
    if json:
        keys = ("model", "parameters", "rms", "held_out", "bic", "cost", "cost_complex", "evaluations",
                "evaluations_complex")  # fmt: skip
        scores = [dict(zip(keys, row, strict=True)) for row in rows]
        return show_json({"scores": scores, "recommended": found.recommended,
                          "recommended_by": found.recommended_by, "seed": seed_json(fitted, out),
                          "condition": found.chosen.fitted.condition})  # fmt: skip
    columns = ["model", "parameters", "RMS N·m", "held-out RMS", "BIC", "cost LS", "cost complex", "evaluations LS",
               "evaluations complex"]  # fmt: skip
    told = [k for k, name in enumerate(columns) if found.by_complex or "complex" not in name]
    told = [k for k in told if any(row[k] == row[k] for row in rows)]  # with one displacement none is held out
    shown = [[row[k] for k in told] for row in rows]
    show_table(f"{found.table.name}: {len(found.table)} rows", [columns[k] for k in told], shown)
    show_parameters(fitted, f"{found.chosen.name}, condition {found.chosen.fitted.condition:.3g}")
    if len(rows) > 1:
        other = "" if found.recommended == found.chosen.name else f" (--use {found.recommended} writes it)"
        print(f"recommended by {found.recommended_by}: {found.recommended}{other}")
    print(f"wrote {found.chosen.name} to {out}")
    return None


def seed_json(model: Any, out: Path) -> dict[str, Any]:
    values = zip(model.parameters, model.values, model.std, strict=True)
    return {"file": str(out), "parameters": {p.name: {"value": v, "std": s, "unit": p.unit} for p, v, s in values}}


def show_parameters(model: Any, title: str) -> None:

    rows = [
        [p.name, f"{beside(value, std):.5g}", f"{std:.2g}", p.unit, p.doc]
        for p, value, std in zip(model.parameters, model.values, model.std, strict=True)
    ]
    show_table(title, ("parameter", "value", "std", "unit", "meaning"), rows)


def show_system(found: Any, model: Any, errors: Any, out: Path, json: bool) -> None:

    unseen = [str(direction) for direction in found.unseen]
    tied = [f"{tie.first} = {tie.second}" for tie in found.ties]
    if json:
        return show_json(
            {
                "seed": seed_json(model, out),
                "loops": [{"number": loop.number, "cost": loop.cost} for loop in found.loops],
                "held_out_costs": found.held_out_costs,
                "fits": {k: {"cost": r.cost, "evaluations": r.evaluations, **r.model.as_dict()}
                         for k, r in found.fits.items()},
                "bootstrap_std": bootstrap_std(found),
                "tied": tied,
                "not_determined": unseen,
                "errors_percent_of_nominal": {
                    e.test: {"above_250_rpm": e.worst(True), "below_250_rpm": e.worst(False)} for e in errors},
            }
        )  # fmt: skip
    show_table("eq 7-10", ("fit", "E", "evaluations"), [[k, r.cost, r.evaluations] for k, r in found.fits.items()])
    held = list(found.held_out_costs) or [float("nan")] * len(found.loops)
    show_table(
        "loops",
        ("loop", "E", "E held out"),
        [[x.number, x.cost, h] for x, h in zip(found.loops, held, strict=True)],
    )
    show_parameters(model, "joint fit")
    spread = bootstrap_std(found)
    rows = [[name, std, spread[name]] for name, std in zip(model.parameter_names, model.std, strict=True) if spread]
    show_table("uncertainty", ("parameter", "std, linearised", "std, bootstrap over tests"), rows)
    rows = [[e.test, e.worst(True), e.worst(False)] for e in errors]
    show_table("error, % of nominal torque", ("test", "above 250 rpm", "below 250 rpm"), rows)
    print(f"act alike: {'; '.join(tied) or 'none'}")
    print(f"not determined by these tests: {'; '.join(unseen) or 'nothing'}; wrote {out}")
    return None


def bootstrap_std(found: Any) -> dict[str, float]:
    if found.bootstrap is None:
        return {}
    return dict(zip(found.bootstrap.names, found.bootstrap.std.tolist(), strict=True))
