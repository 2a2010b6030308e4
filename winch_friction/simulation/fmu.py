"""A user's simulation as an FMU (co-simulation 2.0 or 3.0, FMPy): driven by the log, it fills the simulated columns."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.channels import column_unit, factor_to_si
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.records.strict_yaml import Section, read_yaml

SCHEMA = "winch_friction.fmu/1"
# s; an FMU answers one communication step late, which must stay far below the 12 ms that a log's timing is trusted to
LONGEST_STEP = 0.002
OUTPUTS = ("pressure_drop_simulated", "motor_torque_simulated", "rope_force_simulated")


@dataclass(frozen=True)
class Link:
    """One variable of the FMU and the run column that it is tied to; `factor` times the variable's unit is SI."""

    variable: str
    column: str
    factor: float


@dataclass(frozen=True)
class FmuMap:
    """What goes into an FMU and what comes out; `parameters` are start values in the FMU's own units."""

    inputs: tuple[Link, ...]
    outputs: tuple[Link, ...]
    parameters: Mapping[str, float]


def load_fmu_map(path: Path | str) -> FmuMap:
    """A mapping file (docs/own_simulation.md); raises `InputError` for unknown columns, units and keys."""
    top = Section(read_yaml(Path(path)), str(path))
    if top.text("schema") != SCHEMA:
        raise InputError(f"{path}: schema '{top.text('schema')}' is not '{SCHEMA}'")
    inputs, outputs = _links(top, "inputs"), _links(top, "outputs")
    for link in outputs:
        if link.column.rpartition(".")[2] not in OUTPUTS:
            raise InputError(f"{path}: outputs: '{link.column}' is not a simulated column; use {', '.join(OUTPUTS)}")
    given = top.section("parameters") if top.get("parameters") else Section({}, f"{path}: parameters")
    parameters = {str(name): given.number(name) for name in given.content}
    top.close()
    return FmuMap(inputs, outputs, parameters)


def _links(top: Section, key: str) -> tuple[Link, ...]:
    """`variable: {column: motor_speed, unit: rpm}` for each."""
    section, links = top.section(key), []
    for variable in section.content:
        own = section.section(str(variable))
        column = own.text("column")
        unit = column_unit(column)
        if unit is None:
            raise InputError(f"{own.where}: '{column}' is no column of a run file; see docs/run_files.md")
        links.append(Link(str(variable), column, factor_to_si(own.text("unit", unit), unit, own.where)))
        own.close()
    if not links:
        raise InputError(f"{section.where}: empty; name at least one variable")
    return tuple(links)


def simulate_fmu(path: Path | str, links: FmuMap, run: Run) -> Run:
    """The run with the columns that the FMU simulates for it.

    Raises `InputError` without FMPy, for a file that is no co-simulation FMU, for variables that it does not have, for
    input columns that the run does not have, and with the FMU's own words when it fails.
    """
    fmpy = _fmpy()
    description = _described(fmpy, Path(path))
    known = {variable.name for variable in description.modelVariables}
    wanted = [link.variable for link in (*links.inputs, *links.outputs)] + list(links.parameters)
    missing = sorted(set(wanted) - known)
    if missing:
        raise InputError(f"{path}: no variable {', '.join(missing)}; it has {', '.join(sorted(known)[:40])}")
    time = run.time - run.time[0]
    entry = [("time", float), *((link.variable, float) for link in links.inputs)]
    signals = np.zeros(len(time), dtype=entry)
    signals["time"] = time
    for link in links.inputs:
        signals[link.variable] = _without_holes(run[link.column]) / link.factor
    found = _simulated(fmpy, Path(path), links, signals, run.name)
    columns = {
        link.column: np.interp(time, found["time"], found[link.variable]) * link.factor for link in links.outputs
    }
    return replace(run, columns={**run.columns, **columns}, metadata={**run.metadata, "fmu": Path(path).name})


def _simulated(fmpy: Any, path: Path, links: FmuMap, signals: np.ndarray, name: str) -> Any:
    step = float(np.median(np.diff(signals["time"])))
    step /= max(int(np.ceil(step / LONGEST_STEP)), 1)
    try:
        return fmpy.simulate_fmu(
            str(path), start_time=0.0, stop_time=float(signals["time"][-1]), output_interval=step, input=signals,
            output=[link.variable for link in links.outputs], start_values=dict(links.parameters),
            fmi_type="CoSimulation",
        )  # fmt: skip
    except Exception as error:  # whatever a foreign binary raises
        raise InputError(f"{path}: the FMU failed on {name}: {_words(error)}") from None


def _described(fmpy: Any, path: Path) -> Any:
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        description = fmpy.read_model_description(str(path), validate=False)
    except Exception as error:  # a file that is no archive, or an archive that is no FMU
        raise InputError(f"{path}: not an FMU that can be read ({_words(error)})") from None
    if description.coSimulation is None:
        raise InputError(f"{path}: an FMU for model exchange alone; export it for co-simulation")
    return description


def _words(error: Exception) -> str:
    """The first line of what a foreign program says; its kind where it says nothing."""
    return (str(error).splitlines() or [type(error).__name__])[0]


def _fmpy() -> Any:
    try:
        import fmpy
    except ImportError:
        raise InputError("an FMU needs FMPy; pip install 'winch_friction[fmu]'") from None
    return fmpy


def _without_holes(values: FloatArray) -> FloatArray:
    good = np.isfinite(values)
    if not good.any():
        return np.zeros(len(values))
    samples = np.arange(len(values))
    return np.interp(samples, samples[good], values[good])
