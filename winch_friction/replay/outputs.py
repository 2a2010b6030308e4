"""Replayed outputs as one table or as the topics that the nodes would have published."""

import math
from pathlib import Path

import numpy as np

from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.model_file import model_to_text
from winch_friction.records.runs import write_run
from winch_friction.records.topics import FLUID_PRESSURE, joint_state, stamp_header

STRING = "std_msgs/msg/String"


def write_outputs(path: Path | str, compensator: Run, estimator: Run, model: FrictionModel) -> Path:
    """Write by suffix: .csv or .parquet a table, else a bag with the nodes' topics."""
    path = Path(path)
    if path.suffix in (".csv", ".parquet", ".pq"):
        return write_run(output_table(compensator, estimator), path)
    with BagWriter(path) as writer:
        _write_topics(writer, compensator, estimator, model)
    return path


def output_table(compensator: Run, estimator: Run) -> Run:
    """Both outputs over one time: the estimator's columns with the prefix `estimator.`."""
    if len(compensator) != len(estimator) or not np.array_equal(compensator.time, estimator.time):
        estimator = _on_times(estimator, compensator)
    columns = dict(compensator.columns) | {
        f"estimator.{name}": values for name, values in estimator.columns.items() if name != "time"
    }
    aside = {"state": compensator.aside["state"], "estimator.state": estimator.aside["state"]}
    return Run(name=compensator.name, columns=columns, aside=aside, metadata=compensator.metadata)


def _on_times(run: Run, other: Run) -> Run:
    """The rows of a run that belong to another's times: the last at or before each."""
    rows = np.clip(np.searchsorted(run.time, other.time, side="right") - 1, 0, None)
    columns = {name: values[rows] for name, values in run.columns.items()}
    return Run(run.name, columns | {"time": other.time}, aside={"state": run.aside["state"][rows]})


def _write_topics(writer: BagWriter, compensator: Run, estimator: Run, model: FrictionModel) -> None:
    def torque(time: float, speed: float, value: float) -> object:
        return joint_state(MESSAGES, stamp_header(time, MESSAGES), "winch_motor", velocity=speed, effort=value)

    learned = dict(zip(estimator.time.tolist(), _pairs(estimator, "speed"), strict=True))
    pressures = compensator["pressure"].tolist()
    for (time, speed, value), pressure in zip(_rows(compensator, "speed"), pressures, strict=True):
        writer.write("/compensator/friction_torque", torque(time, speed, value), time)
        if math.isfinite(pressure):
            header = stamp_header(time, MESSAGES)
            message = MESSAGES.make(FLUID_PRESSURE, header=header, fluid_pressure=pressure, variance=0.0)
            writer.write("/compensator/pressure_feedforward", message, time)
        if time in learned:
            writer.write("/estimator/friction_torque", torque(time, *learned[time]), time)
    writer.write("/friction_model", MESSAGES.make(STRING, data=model_to_text(model)), float(compensator.time[-1]))


def _rows(run: Run, speed: str) -> list[tuple[float, float, float]]:
    return list(zip(run.time.tolist(), run[speed].tolist(), run["friction_torque"].tolist(), strict=True))


def _pairs(run: Run, speed: str) -> list[tuple[float, float]]:
    return [(each[1], each[2]) for each in _rows(run, speed)]
