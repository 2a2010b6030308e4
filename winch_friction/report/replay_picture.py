"""A replay as a picture: friction, speed, and what was learned with its uncertainty."""

from typing import Any

import numpy as np

from winch_friction.physics.channels import RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.report.figures import COLOURS, legend_above, new_figure

_MOST_PARAMETERS = 4


def replay_figure(compensator: Run, estimator: Run, seed: FrictionModel) -> Any:
    """Friction torque and speed over time above, the parameters learned best below, in σ of their seed."""
    figure, axes = new_figure(3, 1, height=2.5, sharex=True)
    start = compensator.time[0]
    _torque(axes[0], compensator, estimator, start)
    axes[1].plot(compensator.time - start, compensator["speed"] / RPM, color=COLOURS[0], alpha=0.5)
    axes[1].plot(estimator.time - start, estimator["speed"] / RPM, color="0.2", linewidth=0.8)
    axes[1].set_ylabel("motor speed, rpm")
    _parameters(axes[2], estimator, seed, start)
    axes[2].set_xlabel("time, s")
    return figure


def _torque(axes: Any, compensator: Run, estimator: Run, start: float) -> None:
    axes.plot(compensator.time - start, compensator["friction_torque"], label="feedforward")
    axes.plot(estimator.time - start, estimator["friction_torque"], label="learned friction", alpha=0.8)
    axes.set_ylabel("torque at the shaft, N m")
    legend_above(axes, 2)


def _parameters(axes: Any, estimator: Run, seed: FrictionModel, start: float) -> None:
    shown = most_learned(estimator, seed)
    meaning = {each.name: each.doc for each in seed.parameters}
    for colour, name in zip(COLOURS, shown, strict=False):
        scale = estimator[f"{name}_std"][0]
        value, std = (estimator[name] - seed.value(name)) / scale, estimator[f"{name}_std"] / scale
        axes.plot(estimator.time - start, value, color=colour, label=f"{meaning[name]} ({name})")
        axes.fill_between(estimator.time - start, value - std, value + std, color=colour, alpha=0.15, linewidth=0)
    axes.set_ylabel("parameter − seed,\nin σ of the seed, ±1 σ")
    if shown:
        legend_above(axes, 2)


def most_learned(estimator: Run, seed: FrictionModel) -> list[str]:
    """The parameters whose standard deviation shrank most, best first."""
    names = [name for name in seed.parameter_names if f"{name}_std" in estimator]
    shares = {name: _share(estimator[f"{name}_std"]) for name in names}
    return sorted(names, key=lambda name: shares[name])[:_MOST_PARAMETERS]


def _share(std: Any) -> float:
    return float(std[-1] / std[0]) if len(std) and np.isfinite(std[0]) and std[0] > 0.0 else 1.0
