"""The whole practice from one folder: supplier's table, logged tests, AHC tests; nothing is written here."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from winch_friction.identification.black_box import BlackBoxMap
from winch_friction.identification.motor_identification import (
    MotorIdentification,
    Progress,
    identify_motor,
    motor_seed,
    silent,
)
from winch_friction.identification.motor_models import MOTOR_MODELS
from winch_friction.identification.one_group import as_main, run_as_main
from winch_friction.identification.prior import UnitSpread, load_unit_spread
from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.identification.supplier_table import SupplierTable
from winch_friction.identification.system_identification import (
    SystemIdentification,
    identify_system,
    read_test,
    winch_seed,
)
from winch_friction.identification.verification import (
    PressureCheck,
    TestError,
    pressure_check,
    refuse_unusable,
    test_errors,
)
from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run
from winch_friction.records.strict_yaml import Section, read_yaml

SCHEMA = "winch_friction.practice/1"


@dataclass(frozen=True)
class PracticeFolder:
    """What `practice.yaml` names, read: `tests` are fitted, `held_out` only verified, `ahc` heave-compensated runs."""

    name: str
    crane: Crane
    table: SupplierTable
    motor_model: str
    tests: tuple[Run, ...]
    held_out: tuple[Run, ...]
    ahc: tuple[Run, ...]
    hashes: Mapping[str, str]
    note: str


def read_practice(folder: Path) -> PracticeFolder:
    """Read a practice folder; raises `InputError` for anything that is missing or cannot be read."""
    folder = Path(folder)
    path = folder / "practice.yaml"
    if not folder.exists():
        raise InputError(f"{folder}: no such folder, and no shipped example; a practice is a folder with practice.yaml")
    if not path.is_file():
        raise InputError(f"{folder}: 'practice.yaml' is missing; it names crane, supplier table and tests")
    top = Section(read_yaml(path), str(path))
    if top.text("schema") != SCHEMA:
        raise InputError(f"{path}: schema '{top.text('schema')}' is not '{SCHEMA}'")
    names = {key: _names(top, key) for key in ("tests", "held_out_tests", "ahc_tests")}
    supplier, motor_model = folder / top.text("supplier_table"), top.text("motor_model", "mj4")
    name, named, note, problems = top.text("name"), top.text("crane"), top.text("note", ""), Problems()
    with problems:
        top.close()
    crane: Crane | None = None
    with problems:
        beside = (folder / named, folder / f"{named}.yaml")  # as every file that it names
        crane = load_crane(next((each for each in beside if each.is_file()), named))
    runs: dict[str, list[Run]] = {key: [] for key in names}
    for key, own in runs.items():
        for each in names[key]:
            with problems:
                run = read_run(folder / each, crane, complete=crane is not None)
                own.append(run_as_main(run, crane) if crane is not None else run)
    with problems:
        table = read_supplier_table(supplier, (crane.max_displacement if crane else 0.0) or None)
    problems.say()
    return PracticeFolder(
        name=name,
        crane=as_main(cast(Crane, crane)),
        table=table,
        motor_model=motor_model,
        tests=tuple(runs["tests"]),
        held_out=tuple(runs["held_out_tests"]),
        ahc=tuple(runs["ahc_tests"]),
        hashes={
            each.name: _hash(each)
            for each in (supplier, *(folder / n for group in names.values() for n in group))
            if each.is_file()  # a bag is a folder
        },
        note=note,
    )


def _names(top: Section, key: str) -> list[str]:
    names = top.get(key) or []
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{top.where}: {key} must be a list of file names")
    if key == "tests" and not names:
        raise InputError(f"{top.where}: tests must name at least one logged test")
    return names


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


@dataclass(frozen=True)
class Practice:
    """The practice's results: motor, system, seeds, and the verification of three winch models.

    `errors` by model name: on all tests, fitted first; `normal_mode` and `ahc` pressure checks by model name.
    """

    folder: PracticeFolder
    motor: MotorIdentification
    motor_seed: FrictionModel
    system: SystemIdentification
    seed: FrictionModel
    map: BlackBoxMap
    errors: dict[str, list[TestError]]
    normal_mode: dict[str, PressureCheck]
    ahc: dict[str, list[PressureCheck]]

    @property
    def models(self) -> dict[str, FrictionModel]:
        """The winch models that are compared."""
        return {
            "first loop": self.system.first_loop,
            "second loop": self.system.last_loop,
            "joint fit": self.system.joint.model,
        }


def run_practice(
    folder: PracticeFolder,
    *,
    spread: UnitSpread | None = None,
    resamples: int = 40,
    seed: int = 0,
    progress: Progress = silent,
    complex_options: Mapping[str, int] | None = None,
    force: bool = False,
) -> Practice:
    """All four steps, the second loop, the joint fit and the verification."""
    spread = spread or load_unit_spread()
    for run in (*folder.tests, *folder.held_out):
        read_test(run, folder.crane)  # an unusable log is said before the long fits
    for run in (*folder.tests, *folder.ahc):
        refuse_unusable(run)
    provenance: dict[str, Any] = {"data_sha256": dict(folder.hashes)}
    motor = identify_motor(
        folder.table,
        list(MOTOR_MODELS),
        chosen=folder.motor_model,
        seed=seed,
        progress=progress,
        complex_options=complex_options,
        force=force,
    )
    fitted = motor_seed(motor, f"{folder.name}_motor", provenance)
    system = identify_system(
        folder.tests,
        folder.crane,
        fitted,
        spread,
        held_out=folder.held_out,
        resamples=resamples,
        seed=seed,
        complex_options=complex_options,
    )
    models = {"first loop": system.first_loop, "second loop": system.last_loop, "joint fit": system.joint.model}
    scales = {"joint fit": system.joint.sensor_errors["displacement_scale"][0]}
    curves = [test.curve for test in (*system.tests, *system.held_out)]
    heaviest = max(system.tests, key=lambda test: (test.curve.load_torque * test.curve.displacement, test.run.name))
    return Practice(
        folder=folder,
        motor=motor,
        motor_seed=fitted,
        system=system,
        seed=winch_seed(system, folder.crane, folder.name, provenance),
        map=BlackBoxMap(motor.table),
        errors={name: test_errors(model, curves) for name, model in models.items()},
        normal_mode={
            name: pressure_check(heaviest.run, folder.crane, model, scales.get(name, 0.0))
            for name, model in models.items()
        },
        ahc={
            name: [pressure_check(run, folder.crane, model, scales.get(name, 0.0)) for run in folder.ahc]
            for name, model in models.items()
        },
    )
