"""Write config/examples/practice_150t: generated supplier table, simulated cycles of Tables 2 and 5, two AHC tests.

The truth is crane 2 of paper 2 (model a6vm215_crane2) on the simulator with its sensors, which carry small
systematic errors (displacement +0.6 %, pressure scale +0.1 %, one zero error of 0.4 bar).
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from campaign.practice_logs import AHC, TABLE_2, TABLE_5, SensorErrors, drive_ahc, drive_tests
from campaign.supplier_generator import LOW_DISPLACEMENT_LOSS, write_supplier_table
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.signals import Run
from winch_friction.records.atomic import write_text
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import write_run

SEED = 4711
ERRORS = SensorErrors(displacement_scale=1.006, pressure_scale=1.001, pressure_offset=0.4e5)
_KEPT = ("time", "motor_speed", "hook_load", "heave_velocity", "wire_out", "wire_layer")
# what a PLC's log resolves; rounding makes the files small
_STEPS = {"time": 1e-4, "motor_speed": 0.01 * RPM, "hook_load": 1.0, "heave_velocity": 1e-3, "wire_out": 0.01,
          "pressure_a": 0.01 * BAR, "pressure_b": 0.01 * BAR, "displacement": 0.01 * CM3_PER_REV}  # fmt: skip
YAML = """# The practice of paper 2 on an example: `winch-friction identify practice practice_150t --out DIR`.
schema: winch_friction.practice/1
name: practice_150t
note: >-
  GENERATED, not measured: supplier table by campaign/supplier_generator.py, logs from this package's simulator with its
  sensors (campaign/make_practice_example.py). The truth is model a6vm215_crane2.
crane: crane_150t
supplier_table: supplier.csv
motor_model: mj4
tests: [{tests}]            # paper 2 Table 2
held_out_tests: [{held_out}]   # paper 2 Table 5
ahc_tests: [{ahc}]
"""


def small(run: Run) -> Run:
    """The columns that the practice reads, at the resolution of a log."""
    kept = {name: values for name, values in run.columns.items() if name in _KEPT or "." in name}
    if "active.displacement" not in run.columns:
        kept.pop("heave_velocity", None)
    columns = {name: _rounded(name, values) for name, values in kept.items()}
    return replace(run, columns=columns, aside={})


def _rounded(name: str, values: np.ndarray) -> np.ndarray:
    step = _STEPS.get(name.rpartition(".")[2], 0.0)
    return np.round(values / step) * step if step else values


def main() -> None:
    """Write the folder."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "config/examples/practice_150t")
    crane, truth = load_crane("crane_150t"), load_model("a6vm215_crane2")
    driven = drive_tests({**TABLE_2, **TABLE_5}, crane, truth, SEED, ERRORS, rate=10.0)
    runs = {name: result.run for name, result in driven.items()} | drive_ahc(crane, truth, SEED, ERRORS)
    for name, run in runs.items():
        write_run(small(run), folder / f"{name}.parquet")
    write_supplier_table(folder / "supplier.csv", 215, LOW_DISPLACEMENT_LOSS)
    files = {key: ", ".join(f"{name}.parquet" for name in group) for key, group in
             (("tests", TABLE_2), ("held_out", TABLE_5), ("ahc", AHC))}  # fmt: skip
    write_text(folder / "practice.yaml", YAML.format(**files))


if __name__ == "__main__":
    main()
