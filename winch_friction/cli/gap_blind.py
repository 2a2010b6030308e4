"""`winch-friction gap --blind N`: hide an effect without telling, search for it, then open the seal."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import progress, refuse_existing, show_warnings
from winch_friction.physics.errors import InputError

NOTHING = "nothing"  # drawn as well: a search that always finds something is worth nothing
SIZES = (0.5, 2.0)  # of the typical size


def blind_trials(
    count: int, crane: str, model: str, out: Path, seed: int, as_json: bool, overwrite: bool = False
) -> None:
    """Run `count` trials and say what was hidden only after each verdict stands in its file."""
    if count < 1:
        raise InputError(f"--blind {count}: give a number of trials, 1 or more")
    folders = [out / f"trial_{k + 1:02d}" for k in range(count)]
    refuse_existing(overwrite, *(folder / name for folder in folders for name in ("gap.json", "seal.json")))
    plant = _plant_of(crane, out / "plant.yaml", overwrite)
    rng = np.random.default_rng([seed, 271])
    rows = [_trial(k, crane, model, plant, folders[k], rng) for k in progress(range(count), "blind trials")]
    right = sum(row["right"] for row in rows)
    if as_json:
        show_json({"trials": rows, "right": right, "of": count})
        return
    show_table("blind trials", list(rows[0]), [[_text(value) for value in row.values()] for row in rows])
    print(f"right: {right} of {count}; every seal and verdict is in {out}")


def _text(value: Any) -> str:
    return ", ".join(value) if isinstance(value, list) else str(value)


def _plant_of(crane: str, path: Path, overwrite: bool) -> str:
    """The shipped plant of the crane that the runs are planned for; of any other one that is scaled from it, written
    beside the trials, where none is lost by it."""
    from winch_friction.cli.init_texts import plant_text
    from winch_friction.records.atomic import write_text
    from winch_friction.records.crane_file import load_crane
    from winch_friction.simulation.campaigns import ITS_PLANT, PLANNED_FOR
    from winch_friction.simulation.plant_file import refuse_others

    winch = load_crane(crane)
    refuse_others(winch)
    if winch.name == PLANNED_FOR:
        return ITS_PLANT
    refuse_existing(overwrite, path)
    write_text(path, plant_text(winch, f"plant_{winch.name}"))
    show_warnings([f"simulated with {path}, scaled from {ITS_PLANT}"])
    return str(path)


def _trial(number: int, crane: str, model: str, plant: str, folder: Path, rng: np.random.Generator) -> dict[str, Any]:
    from winch_friction.discrepancy.answer import GapOptions
    from winch_friction.discrepancy.workflow import find_gap
    from winch_friction.records.atomic import write_text
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model

    winch, seed_model = load_crane(crane), load_model(model)
    secret = _draw(rng)
    sealed = json.dumps(secret, sort_keys=True)
    write_text(folder / "seal.sha256", hashlib.sha256(sealed.encode()).hexdigest() + "\n")
    runs = _simulated(secret, winch, seed_model, plant, int(rng.integers(1 << 30)))
    content = find_gap(runs, winch, seed_model, GapOptions(seed=number, plan=False)).content()
    write_text(folder / "gap.json", json.dumps(content, indent=2) + "\n")
    write_text(folder / "seal.json", sealed + "\n")
    found = [name for effect in content["effects"] for name in (effect["name"], *effect["indistinguishable_from"])]
    return {
        "hidden": secret["effect"],
        "size": secret["size"],
        "verdict": content["verdict"],
        "found": found,
        "right": _right(secret["effect"], content["verdict"], found),
    }


def _draw(rng: np.random.Generator) -> dict[str, Any]:
    from winch_friction.simulation.hidden.catalogue import effect_names

    names = [NOTHING, *sorted(effect_names())]
    name = names[int(rng.integers(len(names)))]
    size = 0.0 if name == NOTHING else round(float(np.exp(rng.uniform(*np.log(SIZES)))), 2)
    return {"effect": name, "size": size, "salt": int(rng.integers(1 << 60))}


def _simulated(secret: Mapping[str, Any], crane: Any, model: Any, plant: str, seed: int) -> Sequence[Any]:
    from winch_friction.simulation import simulate
    from winch_friction.simulation.campaigns import fitted, gap_campaign
    from winch_friction.simulation.plant_file import load_plant

    truth = _true_model(model, np.random.default_rng([seed, 5]))
    hidden = [] if secret["effect"] == NOTHING else [(secret["effect"], secret["size"])]
    planned = fitted([each.override({"plant": plant}) for each in gap_campaign(seed)], crane, load_plant(plant))
    return [simulate(each, crane, truth, seed + k, hidden).run for k, each in enumerate(planned)]


def _true_model(model: Any, rng: np.random.Generator) -> Any:
    """The crane's own parameters: within one and a half deviations of the model's, and never told either."""
    bounds = np.array([model.bounds_of(name) for name in model.parameter_names])
    values = np.array(model.values) + model.std * rng.uniform(-1.5, 1.5, len(model.values))
    return model.with_values(list(np.clip(values, bounds[:, 0], bounds[:, 1])))


def _right(hidden: str, verdict: str, found: Sequence[str]) -> bool:
    return verdict == "nothing_missing" if hidden == NOTHING else hidden in found
