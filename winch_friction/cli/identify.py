"""`winch-friction identify motor | system | practice`: from supplier tables and logged tests to a friction model."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import Namespace, OptionalPath, OptionalPaths, OptionalTexts, Overwrite

app = typer.Typer(
    help="Supplier tables and logged tests become a friction model.", add_completion=False, no_args_is_help=True
)

PRACTICE = "Friction practice: "  # begins the title of its page
Json = Annotated[bool, typer.Option("--json", help="Results as JSON on stdout.")]
Force = Annotated[
    bool, typer.Option(help="Go on with data that contradict the crane, or any motor; the result says so.")
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the complex method and of the bootstrap.")]
Restarts = Annotated[int, typer.Option(min=1, help="Restarts of the complex method.")]
Evaluations = Annotated[int, typer.Option(min=100, help="Most evaluations of the complex method per restart.")]


def _range(text: str, unit: float, name: str) -> tuple[float, float]:
    from winch_friction.physics.errors import InputError

    try:
        lower, upper = (float(part) for part in text.split("-"))
    except ValueError:
        raise InputError(f"--{name} '{text}': give two numbers with a dash, e.g. 400-2500") from None
    if not 0.0 <= lower < upper:
        raise InputError(f"--{name} '{text}': the first number must be below the second")
    return lower * unit, upper * unit


def _hash(path: Path) -> str:
    import hashlib

    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


@app.command()
def motor(
    table: Annotated[Path, typer.Argument(help="Supplier's table: CSV with units in the headers.")],
    out: Annotated[Path, typer.Option(help="Model file to write.")],
    model: Annotated[
        OptionalTexts, typer.Option(help="Model of paper 1; repeat for several, or 'all'; none: that of --use.")
    ] = None,
    use: Annotated[
        str, typer.Option(help="Model that becomes the seed; 'best': the recommended one of --model, else of all.")
    ] = "mj4",
    max_displacement: Annotated[
        float, typer.Option(min=0.0, max=376991.0, help="D_max in cm^3/rev; 0: the table's largest.")
    ] = 0.0,
    speed: Annotated[str, typer.Option(help="Range in rpm; none: 400-2500, of a slower motor from 16 % on.")] = "",
    pressure: Annotated[str, typer.Option(help="Range in bar.")] = "50-350",
    displacement: Annotated[
        str, typer.Option(help="Range in cm^3/rev; none: from 50 on, of a small motor from 29 % of its stroke.")
    ] = "",
    weighting: Annotated[str, typer.Option(help="nominal, equal or column.")] = "nominal",
    use_complex: Annotated[bool, typer.Option("--complex/--no-complex", help="Box's method beside it.")] = True,
    restarts: Restarts = 3,
    evaluations: Evaluations = 20000,
    seed: Seed = 0,
    force: Force = False,
    overwrite: Overwrite = False,
    json: Json = False,
) -> None:
    """Fit the motor-loss models of paper 1 to a supplier's table and write the seed model.

    Example: winch-friction identify motor a6vm215_generated --model all --out seed.yaml
    """
    from winch_friction.cli.identify_output import show_motor
    from winch_friction.cli.inputs import (
        MODEL,
        progress,
        refuse_existing,
        refuse_input_as_output,
        refuse_other_kind,
        show_warnings,
    )
    from winch_friction.identification.motor_identification import identify_motor, motor_seed
    from winch_friction.identification.motor_models import MOTOR_MODELS
    from winch_friction.identification.supplier_file import read_supplier_table
    from winch_friction.identification.supplier_table import FitRange
    from winch_friction.identification.table_remarks import remarks_on
    from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
    from winch_friction.records.model_file import save_model
    from winch_friction.records.strict_yaml import shipped

    path = shipped("suppliers", table, ".csv")
    refuse_other_kind(out, MODEL, "a model")
    refuse_input_as_output(out, [path])
    refuse_existing(overwrite, out)
    data = read_supplier_table(path, max_displacement * CM3_PER_REV or None)
    usual = FitRange.usual(data)
    inside = FitRange(
        _range(speed, RPM, "speed") if speed else usual.speed,
        _range(pressure, BAR, "pressure"),
        _range(displacement, CM3_PER_REV, "displacement") if displacement else usual.displacement,
    )
    wanted = model or ["all" if use == "best" else use]
    names = list(MOTOR_MODELS) if "all" in wanted else wanted
    found = identify_motor(
        data,
        names,
        chosen="" if use == "best" else use,
        fit_range=inside,
        weighting=weighting,
        with_complex=use_complex,
        seed=seed,
        progress=progress,
        complex_options={"restarts": restarts, "max_evaluations": evaluations},
        force=force,
    )
    fitted = motor_seed(found, out.stem, {"data_sha256": {path.name: _hash(path)}})
    save_model(fitted, out)
    show_warnings(filter(None, [inside.left_out(data), *remarks_on(found)]))
    show_motor(found, fitted, out, json)


@app.command()
def system(
    runs: Annotated[list[Path], typer.Argument(help="Logged test cycles, one per test.")],
    out: Annotated[Path, typer.Option(help="Model file to write.")],
    motor: Annotated[str, typer.Option(help="Motor model: file or shipped name.", autocompletion=complete_model)],
    crane: Annotated[
        str, typer.Option(help="Crane: file or shipped name; none: what the runs say.", autocompletion=complete_crane)
    ] = "",
    held_out: Annotated[OptionalPaths, typer.Option(help="Test kept out of the fit; repeat.")] = None,
    resamples: Annotated[int, typer.Option(min=0, help="Bootstrap resamples over tests.")] = 40,
    restarts: Restarts = 3,
    evaluations: Evaluations = 20000,
    seed: Seed = 0,
    params_file: Annotated[OptionalPath, typer.Option(help="ROS parameter file: joints and fields of a bag.")] = None,
    namespace: Namespace = "",
    force: Force = False,
    overwrite: Overwrite = False,
    json: Json = False,
) -> None:
    """Steps 2 to 4 of paper 2, its second loop and the joint fit: from logged tests to a winch model.

    Example: winch-friction identify system test_*.parquet --motor a6vm215 --out crane.yaml
    """
    from winch_friction.cli.identify_output import show_system
    from winch_friction.cli.inputs import (
        MODEL,
        refuse_copies,
        refuse_existing,
        refuse_implausible,
        refuse_input_as_output,
        refuse_other_kind,
        run_paths,
    )
    from winch_friction.identification.prior import load_unit_spread
    from winch_friction.identification.system_identification import identify_system, winch_seed
    from winch_friction.identification.verification import test_errors
    from winch_friction.physics.errors import Problems
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.model_file import save_model

    runs, held_out = run_paths(runs), run_paths(held_out or [])
    refuse_other_kind(out, MODEL, "a model")
    refuse_input_as_output(out, [motor, crane])
    refuse_existing(overwrite, out)
    problems = Problems()
    known, supplied = _machine(crane, motor, runs, problems)
    tests, others = _read_tests(runs, held_out, known, bag_options_of(params_file, namespace), problems)
    problems.say()
    refuse_copies([*tests, *others])
    forced = refuse_implausible([*tests, *others], known, force=force, near=runs)
    found = identify_system(
        tests,
        known,
        supplied,
        load_unit_spread(),
        held_out=others,
        resamples=resamples,
        seed=seed,
        complex_options={"restarts": restarts, "max_evaluations": evaluations},
    )
    hashes = {path.name: _hash(path) for path in (*runs, *held_out) if path.is_file()}
    model = winch_seed(found, known, out.stem, {"data_sha256": hashes, "motor": motor, **forced})
    errors = test_errors(found.joint.model, [test.curve for test in (*found.tests, *found.held_out)])
    save_model(model, out)
    show_system(found, model, errors, out, json)


def _machine(crane: str, motor: str, runs: Sequence[Path], problems: Any) -> tuple[Any, Any]:
    """The crane and the motor's model; what is wrong with them is gathered."""
    from winch_friction.cli.inputs import crane_of
    from winch_friction.physics.errors import InputError
    from winch_friction.physics.friction.model import refuse_other_motor
    from winch_friction.records.model_file import load_model

    supplied, known = None, None
    with problems:
        supplied = load_model(motor).only("motor")
    if crane or supplied is not None:
        with problems:
            known = crane_of(crane, supplied, runs)
    with problems:
        if known is not None and not known.drive.hydraulic:
            raise InputError(
                f"crane '{known.name}' has a drive of kind '{known.drive.kind}': identify fits what hydraulic motors "
                "lose; for this drive winch-friction gap finds inertia, Coulomb and viscous friction and a gain of the "
                "load"
            )
        if known is not None and supplied is not None:
            refuse_other_motor(supplied, known)
    return known, supplied


def _read_tests(
    runs: Sequence[Path], held_out: Sequence[Path], crane: Any, options: Any, problems: Any
) -> tuple[list[Any], list[Any]]:
    """The tests and those held out; what is wrong with them is gathered."""
    from winch_friction.cli.inputs import read_all
    from winch_friction.records.runs import refuse_same_names

    read: list[list[Any]] = [[], []]
    for own, paths in zip(read, (runs, held_out), strict=True):
        with problems:
            own += read_all(paths, crane, complete=crane is not None, **options)
    with problems:
        refuse_same_names([*read[0], *read[1]], [*runs, *held_out])
    return read[0], read[1]


@app.command()
def practice(
    example: Annotated[Path, typer.Argument(help="Folder with practice.yaml, or a shipped example's name.")],
    out: Annotated[Path, typer.Option(help="Folder for report.html, seed.yaml and motor.yaml.")],
    resamples: Annotated[int, typer.Option(min=0, help="Bootstrap resamples over tests.")] = 40,
    restarts: Restarts = 2,
    evaluations: Evaluations = 20000,
    seed: Seed = 0,
    force: Force = False,
    overwrite: Overwrite = False,
    json: Json = False,
) -> None:
    """All four steps, the second loop, the joint fit and the verification of paper 2, from one folder into one report.

    Example: winch-friction identify practice practice_150t --out practice/
    """
    from winch_friction.cli.console import show_json
    from winch_friction.cli.identify_output import seed_json, show_parameters
    from winch_friction.cli.inputs import (
        progress,
        refuse_copies,
        refuse_foreign,
        refuse_implausible,
        refuse_unwritable,
        show_warnings,
    )
    from winch_friction.cli.provenance import provenance_of
    from winch_friction.identification.practice import read_practice, run_practice
    from winch_friction.identification.supplier_table import FitRange
    from winch_friction.identification.table_remarks import remarks_on
    from winch_friction.records.atomic import together
    from winch_friction.records.model_file import save_model
    from winch_friction.report.practice import summary_lines, write_practice_report

    refuse_unwritable(out / "report.html")
    refuse_foreign(out, ("report.html", "motor.yaml", "seed.yaml"), "report.html", PRACTICE, overwrite)
    folder = read_practice(_example(example))
    refuse_copies([*folder.tests, *folder.held_out, *folder.ahc])
    forced = refuse_implausible([*folder.tests, *folder.held_out, *folder.ahc], folder.crane, force=force)
    done = run_practice(
        folder,
        resamples=resamples,
        seed=seed,
        progress=progress,
        complex_options={"restarts": restarts, "max_evaluations": evaluations},
        force=force,
    )
    show_warnings(filter(None, [FitRange.usual(folder.table).left_out(folder.table), *remarks_on(done.motor)]))
    files = sorted(each for each in _example(example).iterdir() if each.is_file())
    with together(out, "report.html") as place:
        write_practice_report(done, place / "report.html", provenance_of(files, folder.crane.name, seed=seed) | forced)
        save_model(done.motor_seed, place / "motor.yaml")
        save_model(replace(done.seed, provenance={**done.seed.provenance, **forced}), place / "seed.yaml")
    if json:
        return show_json({"summary": summary_lines(done), "seed": seed_json(done.seed, out / "seed.yaml")})
    show_parameters(done.seed, "seed (joint fit)")
    for line in summary_lines(done):
        print(line)
    print(f"wrote {out / 'report.html'}, {out / 'motor.yaml'}, {out / 'seed.yaml'}")
    return None


def _example(path: Path) -> Path:
    from winch_friction.records.strict_yaml import config_directory

    shipped = config_directory() / "examples" / path
    return shipped if not path.exists() and shipped.is_dir() else path
