"""`winch-friction init crane | plant | model | scenario | map`: commented files, from flags or questions."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import show_json
from winch_friction.cli.inputs import refuse_unwritable
from winch_friction.cli.names import complete_crane
from winch_friction.cli.optional import OptionalFloat, OptionalInt, OptionalPath
from winch_friction.physics.errors import InputError

app = typer.Typer(
    help="Commented files to begin with, from flags or questions.", add_completion=False, no_args_is_help=True
)

Out = Annotated[OptionalPath, typer.Option(help="File to write; NAME.yaml without it.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", "--force", help="Replace a file that exists.")]
OfCrane = Annotated[
    str, typer.Option(help="Crane file or shipped name that it belongs to.", autocompletion=complete_crane)
]
Json = Annotated[bool, typer.Option("--json", help="Say what was written as JSON.")]
FileName = Annotated[str, typer.Option(help="Name in the file.")]


@app.command()
def crane(
    name: Annotated[str, typer.Option(help="Name of the crane.")] = "",
    load: Annotated[OptionalFloat, typer.Option(help="Rated load in t.")] = None,
    motors: Annotated[OptionalInt, typer.Option(help="Motors on the winch.")] = None,
    displacement: Annotated[OptionalFloat, typer.Option(help="Largest displacement per motor, cm^3/rev.")] = None,
    gear_ratio: Annotated[OptionalFloat, typer.Option(help="Motor revolutions per drum revolution.")] = None,
    radius: Annotated[OptionalFloat, typer.Option(help="Rope radius of the innermost layer, m.")] = None,
    layers: Annotated[OptionalInt, typer.Option(help="Wire layers.")] = None,
    active: Annotated[OptionalInt, typer.Option(help="Active motors in heave compensation; 0: none.")] = None,
    wire: Annotated[OptionalFloat, typer.Option(help="Wire diameter in mm.")] = None,
    falls: Annotated[int, typer.Option(help="Parts of rope that the hook hangs in.")] = 1,
    inertia: Annotated[
        OptionalFloat,
        typer.Option(help="Inertia at the motor shaft, kg m^2; of a hydraulic drive estimated if absent."),
    ] = None,
    drive: Annotated[
        str, typer.Option(help="How the motors' torque is known: hydraulic, electric (a torque), power or current.")
    ] = "hydraulic",
    torque_constant: Annotated[
        OptionalFloat, typer.Option(help="Of --drive current: N m at the motor shaft per A.")
    ] = None,
    rated_speed: Annotated[
        OptionalFloat, typer.Option(help="Of the motor shaft, rpm; of slow motors it tells motion from rest.")
    ] = None,
    rated_pressure: Annotated[OptionalFloat, typer.Option(help="Of hydraulic motors, bar.")] = None,
    out: Out = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """A crane file.

    Example: winch-friction init crane --name crane_50t --load 50 --motors 5 --displacement 160 --gear-ratio 180
    --radius 0.6 --layers 5 --active 2 --wire 44

    An electric one: winch-friction init crane --drive electric --name winch_5t --load 5 --motors 1 --gear-ratio 90
    --radius 0.3 --layers 4 --wire 20 --inertia 0.4
    """
    from winch_friction.cli.init_crane import CraneFacts, crane_text, wanted_of

    asked = {
        "name": (name or None, str, "name of the crane"),
        "load": (load, float, "rated load, t"),
        "motors": (motors, int, "motors on the winch"),
        "displacement": (displacement, float, "largest displacement per motor, cm^3/rev"),
        "gear_ratio": (gear_ratio, float, "gear ratio, motor revolutions per drum revolution"),
        "radius": (radius, float, "rope radius of the innermost layer, m"),
        "layers": (layers, int, "wire layers"),
        "active": (active, int, "active motors in heave compensation (0: none)"),
        "wire": (wire, float, "wire diameter, mm"),
        "inertia": (inertia, float, "inertia at the motor shaft, kg m^2: rotors, gear and drum"),
        "torque_constant": (torque_constant, float, "N m at the motor shaft per A"),
    }
    wanted, given = wanted_of(drive), {name: value for name, (value, *_) in asked.items() if value is not None}
    facts = CraneFacts(
        drive=drive, falls=falls, rated_speed=rated_speed, rated_pressure=rated_pressure,
        **{**given, **_answered({name: asked[name] for name in wanted})},
    )  # fmt: skip
    _write(out or _file_of(facts.name), crane_text(facts), overwrite, as_json)


@app.command()
def plant(
    crane: OfCrane, name: FileName = "", out: Out = None, overwrite: Overwrite = False, as_json: Json = False
) -> None:
    """A plant file (pump, loop, accumulator), sized for a crane.

    Example: winch-friction init plant --crane crane_50t.yaml
    """
    from winch_friction.cli.init_texts import plant_text

    known = _hydraulic(crane, "a plant")
    name = name or f"plant_{known.name}"
    _write(out or _file_of(name), plant_text(known, name), overwrite, as_json)


@app.command()
def model(
    crane: OfCrane, name: FileName = "", out: Out = None, overwrite: Overwrite = False, as_json: Json = False
) -> None:
    """A rough seed model, scaled from paper 2's cranes to this one; identify replaces it.

    Of a crane that is not hydraulic a model without a term: nothing is assumed, `gap` finds what there is.

    Example: winch-friction init model --crane crane_50t.yaml
    """
    from winch_friction.cli.init_texts import bare_model_text, model_text
    from winch_friction.records.crane_file import load_crane

    known = load_crane(crane)
    name = name or f"seed_{known.name}"
    text = model_text if known.drive.hydraulic else bare_model_text
    _write(out or _file_of(name), text(known, name), overwrite, as_json)


@app.command()
def scenario(
    crane: OfCrane,
    plant: Annotated[str, typer.Option(help="Plant file or shipped name.")] = "",
    mode: Annotated[str, typer.Option(help="normal or ahc (heave compensation).")] = "ahc",
    load: Annotated[
        OptionalFloat, typer.Option(help="Hanging mass in t; a third of the rated load without it.")
    ] = None,
    name: FileName = "",
    out: Out = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """A scenario for the simulator, for a crane and its plant.

    Example: winch-friction init scenario --crane crane_50t.yaml --plant plant_crane_50t.yaml
    """
    from winch_friction.cli.init_texts import scenario_text

    known = _hydraulic(crane, "a scenario")
    if mode not in ("normal", "ahc"):
        raise InputError(f"--mode {mode}: use normal or ahc")
    if mode == "ahc" and not {"active", "passive"} <= set(known.groups):
        raise InputError(f"--mode ahc: crane '{known.name}' has no groups active and passive; use --mode normal")
    name = name or f"{mode}_{known.name}"
    text = scenario_text(known, name, plant or f"plant_{known.name}.yaml", mode, load)
    _write(out or _file_of(name), text, overwrite, as_json)


@app.command("map")
def map_(crane: OfCrane = "", out: Out = None, overwrite: Overwrite = False, as_json: Json = False) -> None:
    """A map for `import`, to be filled in by hand; better: let `import LOG --propose` write it from the log.

    Example: winch-friction init map --crane crane_50t.yaml --out log_map.yaml
    """
    from winch_friction.cli.init_texts import map_text
    from winch_friction.records.crane_file import load_crane

    known = load_crane(crane) if crane else None
    _write(out or Path("log_map.yaml"), map_text(known), overwrite, as_json)


@app.command()
def schemas(
    out: Annotated[Path, typer.Option(help="Folder for the JSON Schemas.")] = Path("schemas"),
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """The JSON Schemas of all files, for an editor's completion.

    Example: winch-friction init schemas --out .vscode/schemas
    """
    import json

    from winch_friction.importing.map_schema import map_schema
    from winch_friction.records.schemas import titled
    from winch_friction.simulation.file_schemas import all_schemas

    every = {**all_schemas(), "map": titled("map", map_schema())}
    texts = {out / f"{name}.schema.json": json.dumps(each, indent=2) + "\n" for name, each in every.items()}
    _write_all(texts, overwrite, as_json)


def _answered(asked: dict[str, tuple[Any, type, str]]) -> dict[str, Any]:
    """The given answers, and those to questions where a person sits there; else all missing flags in one line."""
    missing = [name for name, (value, _, _) in asked.items() if value is None]
    if missing and not sys.stdin.isatty():
        words = ", ".join(f"--{name.replace('_', '-')} ({asked[name][2]})" for name in missing)
        raise InputError(f"init crane needs {words}")
    return {
        name: typer.prompt(words, type=kind) if value is None else value for name, (value, kind, words) in asked.items()
    }


def _hydraulic(name: str, what: str) -> Any:
    from winch_friction.records.crane_file import load_crane

    crane = load_crane(name)
    if not crane.drive.hydraulic:
        raise InputError(
            f"crane '{crane.name}' has a drive of kind '{crane.drive.kind}': {what} is for the simulator, whose cranes "
            "are hydraulic; of yours import the logs"
        )
    return crane


def _file_of(name: str) -> Path:
    """The file of a name, here; raises `InputError` for a name that would lead elsewhere."""
    if Path(name).name != name:
        raise InputError(f"--name {name}: a name without '/', which stands in the file; --out says where that goes")
    return Path(f"{name}.yaml")


def _write(path: Path, text: str, overwrite: bool, as_json: bool) -> None:
    _write_all({path: text}, overwrite, as_json)


def _write_all(texts: dict[Path, str], overwrite: bool, as_json: bool) -> None:
    """All files or, when one of them exists, none."""
    from winch_friction.records.atomic import taken, write_text

    there = [str(path) for path in texts if taken(path, overwrite)]
    if there and not overwrite:
        raise InputError(f"{', '.join(there)}: exists already; give another --out, or --overwrite to replace it")
    refuse_unwritable(*texts)
    written = [str(write_text(path, text)) for path, text in texts.items()]
    if as_json:
        show_json({"written": written})
        return
    for each in written:
        print(f"written: {each}")
