"""Replayed outputs as one table or as the topics that the nodes would have published."""

import math
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from winch_friction.online.compensator import mark
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.model_file import model_to_text
from winch_friction.records.runs import write_run
from winch_friction.records.topics import FLUID_PRESSURE, joint_state, stamp_header

STRING = "std_msgs/msg/String"


def write_outputs(
    path: Path | str, compensator: Run, estimator: Run, model: FrictionModel, watchdog: Run | None = None
) -> Path:
    """Write by suffix: .csv or .parquet a table, else a bag with the nodes' topics, in silences the watchdog's too."""
    path = Path(path)
    if path.suffix in (".csv", ".parquet", ".pq"):
        return write_run(output_table(compensator, estimator), path)
    with BagWriter(path) as writer:
        _write_topics(writer, compensator, estimator, model, watchdog)
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


def _write_topics(
    writer: BagWriter, compensator: Run, estimator: Run, model: FrictionModel, watchdog: Run | None
) -> None:
    def say(topic: str, time: float, text: str, speed: float, torque: float) -> None:
        message = joint_state(
            MESSAGES, stamp_header(time, MESSAGES, text), "winch_motor", velocity=speed, effort=torque
        )
        writer.write(topic, message, time)

    learned = dict(zip(estimator.time.tolist(), _learned(estimator), strict=True))
    for _, time, text, speed, torque, pressure in _in_order(_said(compensator), _said(watchdog)):
        say("/compensator/friction_torque", time, text, speed, torque)
        if math.isfinite(pressure):
            header = stamp_header(time, MESSAGES, text)
            message = MESSAGES.make(FLUID_PRESSURE, header=header, fluid_pressure=pressure, variance=0.0)
            writer.write("/compensator/pressure_feedforward", message, time)
        if time in learned:
            say("/estimator/friction_torque", time, *learned[time])
    writer.write("/friction_model", MESSAGES.make(STRING, data=model_to_text(model)), float(compensator.time[-1]))


Said = tuple[int, float, str, float, float, float]  # number, time, mark, speed, torque, pressure


def _said(run: Run | None) -> list[Said]:
    """What a compensator published; a run without numbers is counted through."""
    if run is None or not len(run):
        return []
    numbers = run.aside.get("number", np.arange(1, len(run) + 1)).tolist()
    marks = map(mark, run.aside.get("valid", np.ones(len(run), bool)).tolist(), numbers)
    columns = (run[name].tolist() for name in ("speed", "friction_torque", "pressure"))
    return list(zip(numbers, run.time.tolist(), marks, *columns, strict=True))


def _in_order(*voices: list[Said]) -> Iterator[Said]:
    """All that one compensator published, by its numbers, which begin anew with each phase."""
    waiting, last = [deque(each) for each in voices], 0
    while left := [each for each in waiting if each]:
        place = next((each for each in left if each[0][0] == last + 1), None)
        said = (place or min(left, key=lambda each: each[0][0])).popleft()
        last = said[0]
        yield said


def _learned(run: Run) -> list[tuple[str, float, float]]:
    """Mark, speed and torque of every answer of the estimator, as its node publishes them."""
    valid = run.aside.get("valid", np.ones(len(run), bool)).tolist()
    numbers = run.aside.get("number", np.arange(1, len(run) + 1)).tolist()
    values = (np.nan_to_num(run[name]).tolist() for name in ("speed", "friction_torque"))
    return [(mark(known, number), *rest) for known, number, *rest in zip(valid, numbers, *values, strict=True)]
