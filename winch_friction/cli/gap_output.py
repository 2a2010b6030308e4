"""What `winch-friction gap` writes and prints of a result."""

import json
from collections.abc import Collection
from pathlib import Path
from typing import Any

from winch_friction.cli.console import show_table

REPLACED = ("model.yaml", "report.html", "addition.csv", "proposal_*.py", "proposal_*.yaml")


def write_result(out: Path, result: Any, content: dict[str, Any], runs: list[Any]) -> None:
    """All files but the page, at once; those of an earlier call go: beside new ones they would be read as theirs."""
    from winch_friction.records.atomic import together, write_text
    from winch_friction.records.model_file import save_model

    planned = _earlier_plan(out)
    with together(out, "gap.json") as place:
        _write_addition(place, result, runs)
        save_model(result.model, place / "model.yaml")
        if content["next_experiment"] and result.next_scenario:
            write_text(place / content["next_experiment"]["scenario"], result.next_scenario)
        _write_proposals(place, result)
        write_text(place / "gap.json", json.dumps(content, indent=2, allow_nan=False) + "\n")
        new = {each.name for each in place.iterdir()}
    for old in (each for name in (*REPLACED, *planned) for each in out.glob(name) if each.name not in new):
        old.unlink()


def _earlier_plan(out: Path) -> tuple[str, ...]:
    """The scenario that an earlier call has written, as long as nobody has made it his own."""
    from winch_friction.records.strict_yaml import shipped

    try:
        name = json.loads((out / "gap.json").read_text(encoding="utf-8"))["next_experiment"]["scenario"]
        own = (out / name).read_text(encoding="utf-8")
        return (name,) if own == shipped("scenarios", Path(name).stem).read_text(encoding="utf-8") else ()
    except (OSError, ValueError, LookupError, TypeError):  # no earlier call, or none that planned
        return ()


def _write_proposals(out: Path, result: Any) -> None:
    """Of each proposed law its file of terms and the model with it."""
    from winch_friction.records.atomic import write_text
    from winch_friction.records.model_file import save_model

    for number, proposal in enumerate(result.proposals, start=1):
        write_text(out / f"proposal_{number}.py", proposal.text)
        save_model(proposal.model, out / f"proposal_{number}.yaml")


def _write_addition(out: Path, result: Any, runs: list[Any]) -> None:
    """For a user's own simulation: what it has to add, as a table."""
    from winch_friction.discrepancy.addition import write_addition
    from winch_friction.discrepancy.preparation.own_simulation import simulated_column

    if runs and simulated_column(runs[0]):
        sides = [*result.train.runs, *result.holdout.runs]
        write_addition(out / "addition.csv", sides, result.seed_model, result.model)


def _parameters(effect: dict[str, Any]) -> str:
    """Values with deviations, in the units that people read them in; of a curve that the data drew only that it is one:
    its rises by themselves say little."""
    from winch_friction.report.gap_words import amount_in_units
    from winch_friction.report.tables import number

    def amount(name: str, found: dict[str, Any]) -> str:
        value, std, unit = amount_in_units(name, found["value"], found["std"], found["unit"])
        shown = value if isinstance(value, str) else number(value, 3)
        sure = f" ± {number(std, 2)} {unit}" if std > 0.0 else "" if isinstance(value, str) else f" {unit}"
        return f"{shown}{sure}".removesuffix(" –")

    of_curve = {k for k in effect["parameters"] if effect["law_kind"] == "free" and k.startswith("free_")}
    said = [f"{k} = {amount(k, found)}" for k, found in effect["parameters"].items() if k not in of_curve]
    return ", ".join([*said, *(["a curve (in the page and in model.yaml)"] if of_curve else [])])


def _found_as(effect: dict[str, Any]) -> str:
    """The name, and in which signals, layers or runs it was found, where no parameter says so."""
    said = [part for part in effect.get("variant", "").split(", ") if part and "=" not in part]
    return f"{effect['name']} ({', '.join(said)})" if said else effect["name"]


def _unexplained(depends_on: list[str], reason: str, **_: Any) -> str:
    return f"it depends on: {', '.join(depends_on)} ({reason})" if depends_on else f"no effect is named: {reason}"


def show_result(content: dict[str, Any], out: Path, said: Collection[str] = ()) -> None:
    """The verdict for a person; what was `said` as a warning is not said again."""
    from winch_friction.discrepancy.adequacy import Check

    gap, unit = content["gap"]["holdout"], content["gap"]["unit"]
    rows = [
        [
            _found_as(effect),
            ", ".join(effect["indistinguishable_from"]) or "-",
            _parameters(effect),
            f"{100 * effect['evidence']['cv_gain']:.0f} %",
        ]
        for effect in content["effects"]
    ]
    print(f"verdict: {content['verdict']}")
    if rows:
        show_table("missing effects", ["effect", "or", "parameters ± σ", "error lower by"], rows)
    if content["verdict"] == "unexplained":
        print(_unexplained(**content["unexplained"]))
    for check in content["adequacy"] if content["verdict"] == "insufficient" else []:
        if not check["met"]:
            print(f"lacking: {Check(**check).sentence}")
    if gap["before"] is not None:
        print(
            f"locked runs: {gap['before']:.3g} {unit} before, {gap['after']:.3g} {unit} after, "
            f"noise floor {gap['noise_floor']:.3g} {unit}"
        )
    for note in content["notes"]:
        if note not in said:
            print(f"note: {note}")
    blind: dict[str, list[str]] = {}
    for each in content.get("untestable", ()):
        blind.setdefault(f"needs {each['needs']}: {each['because']}", []).append(each["name"])
    for reason, names in blind.items():
        print(f"not looked for: {', '.join(names)} ({reason})")
    for proposal in content.get("proposals", ()):
        print(f"proposal: {proposal['sentence']} ({out / proposal['terms_file']}, {out / proposal['model_file']})")
    if plan := content["next_experiment"]:
        far = f" ({plan['note']})" if plan["note"] else ""
        print(f"next experiment: {plan['scenario']}{far}")
    elif content["verdict"] == "ambiguous":
        print("next experiment: no scenario at hand tells these apart; measure what only one of them changes")
    written = [out / name for name in ("gap.json", "model.yaml", "report.html") if (out / name).exists()]
    print("written:", ", ".join(map(str, written)))
