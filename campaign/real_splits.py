"""Other splits of the 100 kW winch's cycles: what gap makes of a few of them, beside least squares on the same ones."""

import json
from pathlib import Path

import numpy as np

from campaign.real import power_error, said_of
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane
from winch_friction.records.runs import read_run

SEED, SIZES, DRAWS = 11, (3, 5, 7, 10), 3
BAR = 0.26
_WHOLE = {"inertia_error", "coulomb", "viscous", "layer_radius"}  # the last stands for the gain's set


def splits(count: int) -> list[tuple[str, tuple[int, ...]]]:
    """The first cycles, and draws of so many of `count`."""
    rng = np.random.default_rng(SEED)
    drawn = [
        ("drawn", tuple(int(k) for k in np.sort(rng.choice(count, size, replace=False))))
        for _ in range(DRAWS)
        for size in SIZES
        if size < count
    ]
    return [(f"first {size}", tuple(range(size))) for size in (6, 7) if size < count] + drawn


def table(runs: list[Path], crane: Crane, model: str, folder: Path) -> list[str]:
    """A row per split."""
    logged = [_logged(path, crane) for path in runs]
    lines = [
        "| cycles used | verdict | effects named | error of the power on the others | least squares, same cycles "
        "| least squares with hindsight |",
        "|---|---|---|---|---|---|",
    ]  # fmt: skip
    for number, (name, used) in enumerate(splits(len(runs))):
        others = [k for k in range(len(runs)) if k not in used]
        out = folder / f"split_{number:02d}"
        named = ["--crane", crane.name, "--model", model, "--out", str(out), "--overwrite"]
        said_of(["gap", *(str(runs[k]) for k in used), *named])
        found = json.loads((out / "gap.json").read_text(encoding="utf-8"))
        effects = [each["name"] for each in found["effects"]]
        error = power_error([runs[k] for k in others], crane, out / "model.yaml")
        same, best = (_left(others, _fitted(which, logged), logged) for which in (used, others))
        whole = "inertia, Coulomb, viscous, gain" if set(effects) == _WHOLE else ", ".join(effects) or "none"
        shown = f"{error:.3f}" if error <= BAR else f"**{error:.3f}**"
        lines.append(
            f"| {name} {', '.join(runs[k].stem.removeprefix('cycle_') for k in used)} | {found['verdict']} | {whole} "
            f"| {shown} | {same:.3f} | {best:.3f} |"
        )
    return lines


def _logged(path: Path, crane: Crane) -> tuple[FloatArray, FloatArray]:
    """Regressors of the power (gain, Coulomb, viscous, inertia) and the power in W, at the log's own samples."""
    run = read_run(path, crane)
    speed, power = run["motor_speed"], run["mechanical_power"]
    change = np.gradient(speed, run.time)
    matrix = np.column_stack([speed * run["rope_force"], np.abs(speed), speed**2, speed * change])
    good = np.isfinite(matrix).all(axis=1) & np.isfinite(power)
    return matrix[good], power[good]


def _fitted(which: tuple[int, ...] | list[int], logged: list[tuple[FloatArray, FloatArray]]) -> FloatArray:
    matrix, power = (np.concatenate([logged[k][part] for k in which]) for part in (0, 1))
    return np.asarray(np.linalg.lstsq(matrix, power, rcond=None)[0])


def _left(which: list[int], fit: FloatArray, logged: list[tuple[FloatArray, FloatArray]]) -> float:
    matrix, power = (np.concatenate([logged[k][part] for k in which]) for part in (0, 1))
    return float(np.sqrt(np.mean((power - matrix @ fit) ** 2) / np.mean(power**2)))
