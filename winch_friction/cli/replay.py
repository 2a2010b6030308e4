"""`winch-friction replay`: a recording through the nodes' own step."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import bar_of_work, show_warnings
from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import Namespace, OptionalPath, OptionalTexts, Overwrite
from winch_friction.physics.channels import beside

SLACK = 2.5  # usual steps that an input may be late before it counts as lost: one lost sample is no loss
PICTURES = (".html", ".png", ".svg", ".pdf", ".eps", ".jpg", ".jpeg", "")  # without a suffix: a png
MOSTLY = 0.5  # share of active samples below which the reasons are told


def command(
    recording: Annotated[Path, typer.Argument(help="Bag folder, .mcap, .db3, or a run file (.csv, .parquet).")],
    model: Annotated[str, typer.Option(help="Seed model: file or shipped name.", autocompletion=complete_model)],
    crane: Annotated[
        str, typer.Option(help="Crane file or shipped name; none: the model's.", autocompletion=complete_crane)
    ] = "",
    out: Annotated[OptionalPath, typer.Option(help="Where to: .csv or .parquet for a table, else a bag.")] = None,
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file with friction terms of your own.")] = None,
    params_file: Annotated[OptionalPath, typer.Option(help="ROS parameter file of the nodes.")] = None,
    picture: Annotated[OptionalPath, typer.Option(help="Report of it: .html, or a still picture: .png, .svg.")] = None,
    learn: Annotated[bool, typer.Option(help="Let the compensator take over what the estimator learns.")] = True,
    remap: Annotated[OptionalTexts, typer.Option(help="TOPIC=NAME_IN_THE_BAG; repeatable.")] = None,
    joint: Annotated[str, typer.Option(help="Joint of the speed; none: params-file's, or winch_motor.")] = "",
    pressure_reference: Annotated[str, typer.Option(help="Pressures in the bag: gauge or absolute.")] = "",
    namespace: Namespace = "",
    force: Annotated[bool, typer.Option(help="Go on with data that contradict the crane; the result says so.")] = False,
    overwrite: Overwrite = False,
    as_json: Annotated[bool, typer.Option("--json", help="Summary as JSON.")] = False,
) -> None:
    """Run compensator and estimator over a recording.

    The same step as in the nodes, so the outputs equal the live ones; where the recording holds those, they are
    compared.

    Examples:

      winch-friction replay bag/ --crane crane_150t --model a6vm215_crane2 --out replay.csv --picture replay.png

      winch-friction replay run.csv --crane crane_150t --model learned.yaml --params-file config/nodes/crane.yaml
    """
    from winch_friction.cli.inputs import (
        load_terms,
        machine_of,
        refuse_existing,
        refuse_implausible,
        refuse_input_as_output,
    )
    from winch_friction.cli.provenance import provenance_of
    from winch_friction.physics.errors import InputError, Problems
    from winch_friction.physics.friction.model import ASSUMED_STD, unstated
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.runs import is_bag, refuse_unknown_kind
    from winch_friction.replay.recording import replay_recording, replay_run
    from winch_friction.replay.settings import ReplaySettings, settings_from_file
    from winch_friction.replay.summary import summary

    if recording.is_dir() and any(each.suffix.lower() in (".csv", ".parquet", ".pq") for each in recording.iterdir()):
        raise InputError(f"{recording}: a folder of runs; replay takes one recording: name one file of it, or a bag")
    if picture is not None and picture.suffix.lower() not in PICTURES:
        raise InputError(
            f"--picture {picture}: a report is written as .html, a still picture as .png, .svg, .pdf or .jpg; give a "
            "name that ends so"
        )
    problems = Problems()
    with problems:
        if not model:
            raise InputError("--model: give a model file or a shipped name; list has them")
    for written in (out, picture):
        with problems:
            refuse_input_as_output(written, [recording, model, crane])
            refuse_existing(overwrite, written)
    if out is not None:
        with problems:
            refuse_unknown_kind(out)
    asked = bag_options(remap or [], joint, pressure_reference, namespace)
    _refuse_bag_options(recording, {"remap": remap, "joint": joint, "pressure-reference": pressure_reference,
                                    "namespace": "" if params_file else namespace})  # fmt: skip
    options = asked
    with problems:
        options = bag_options_of(params_file, namespace) | asked
    load_terms(terms_file)
    settings = None
    with problems:
        settings = settings_from_file(params_file, namespace) if params_file else None
    inputs = Problems()
    winch, seed = machine_of(crane, model, [recording], inputs)
    with inputs:
        if problems.found or inputs.found:
            _read(recording, winch, options, complete=False)
    inputs.say(*problems.found)
    show_warnings(unstated(seed, settings.estimator.default_std if settings else ASSUMED_STD))
    run = _run_of(recording, winch, options)
    forced = refuse_implausible([run], winch, seed, force, [recording]) if run is not None else {}
    settings = _settings_for(recording, run, settings)
    with bar_of_work() as bar:
        task = bar.add_task("replaying, s", total=None if run is None else float(run.time[-1] - run.time[0]))
        told = lambda seconds: bar.update(task, completed=seconds)
        if run is None or is_bag(recording):
            result = replay_recording(recording, winch, seed, settings, learn=learn, told=told, **options)
        else:
            result = replay_run(run, winch, seed, settings or ReplaySettings(), learn=learn, told=told)
    show_warnings(result.warnings)
    if out is not None:
        from winch_friction.replay.outputs import write_outputs

        said = replace(result.model, provenance={**result.model.provenance, **forced})
        write_outputs(out, replace(result.compensator, metadata=forced), result.estimator, said, result.watchdog)
    if picture is not None:
        said_of = {**provenance_of([recording], winch.name, model), "learned": learn, **forced}
        _draw(picture, result, seed, said_of)
    content = {**summary(result), **forced}
    if content["active_share"] < MOSTLY:
        show_warnings([_why_silent(result.compensator.aside["state"], run, settings)])
    if as_json:
        show_json(content)
        return
    _show(content)


def _refuse_bag_options(recording: Path, given: Mapping[str, Any]) -> None:
    """Raise `InputError` for options of a bag with a run file, whose header alone says what its columns are."""
    from winch_friction.physics.errors import InputError
    from winch_friction.records.runs import is_bag

    said = ", ".join(f"--{name}" for name, value in given.items() if value)
    if said and recording.is_file() and not is_bag(recording):
        raise InputError(
            f"{recording}: {said}: of a bag's topics alone; a run file says in its header what its columns are, such "
            "as 'main.pressure_a [bara]' for absolute pressures: leave it out"
        )


def _run_of(recording: Path, crane: Any, options: dict[str, Any]) -> Any:
    """The recording as a run, or None where it lacks what a run needs: a replay needs less, and says what it lacks."""
    from winch_friction.physics.errors import InputError

    try:
        return _read(recording, crane, options)
    except InputError:
        return None


def _read(recording: Path, crane: Any, options: Mapping[str, Any], complete: bool = True) -> Any:
    from winch_friction.records.runs import is_bag, read_run

    return read_run(recording, crane, complete=complete, **(options if is_bag(recording) else {}))


def _settings_for(recording: Path, run: Any, settings: Any) -> Any:
    """Settings whose age limits a slow log can meet; those of a file or of the recording itself are only questioned."""
    from winch_friction.physics.errors import InputError
    from winch_friction.replay.settings import ReplaySettings, longest_held, settings_for_rate

    if run is None:
        return settings
    step = float(np.median(np.diff(run.time)))
    known = settings or (ReplaySettings() if not run.metadata.get("phases") else None)
    limit = min((phase.config.max_age for phase in known.phases), default=math.inf) if known else math.inf
    if step * SLACK <= limit:
        return settings
    if settings is None and SLACK * step > longest_held():
        raise InputError(
            f"{recording}: column 'time': a sample every {step:.4g} s is too slow for a replay, which takes one every "
            f"{longest_held() / SLACK:.3g} s at least; is the time in ms? (10 Hz or more show reversals)"
        )
    said = f"{recording.name}: logged at {1.0 / step:.3g} Hz; inputs count as lost after {limit:.3g} s"
    if settings is not None:
        show_warnings([f"{said}, as --params-file says: raise max_age there if the compensator falls silent"])
        return settings
    show_warnings([f"{said} by default: replayed with {SLACK * step:.3g} s instead (max_age in --params-file)"])
    return settings_for_rate(SLACK * step)


def _why_silent(states: Any, run: Any, settings: Any) -> str:
    names, counts = np.unique(np.asarray(states, str), return_counts=True)
    shares = ", ".join(
        f"{name} {100.0 * count / len(states):.0f} %"
        for name, count in sorted(zip(names, counts, strict=True), key=lambda pair: -pair[1])
    )
    said = f"the compensator was active in less than {100 * MOSTLY:.0f} % of the samples; its states: {shares}"
    source = settings.phases[0].config.velocity_source if settings else "reference"
    if run is not None and "speed_reference" not in run and source == "reference":
        said += (
            "; the recording has no speed_reference, which velocity_source 'reference' needs: set velocity_source: "
            "measured (and acceleration_filter) in a --params-file"
        )
    return said


def bag_options(remap: list[str], joint: str, pressure_reference: str, namespace: str) -> dict[str, Any]:
    """Options of `open_bag` from those of the command line."""
    from winch_friction.physics.errors import InputError

    pairs = dict(each.split("=", 1) for each in remap if "=" in each)
    if len(pairs) != len(remap):
        raise InputError("--remap: write TOPIC=NAME_IN_THE_BAG, e.g. winch/joint_states=/joint_states")
    options: dict[str, Any] = {"speed_joint": joint} if joint else {}
    if joint not in ("", "winch_motor", "winch_drum"):
        options["motor_joint"] = joint
    if pressure_reference:
        options["pressure_reference"] = pressure_reference
    return {**options, **({"remap": pairs} if pairs else {}), **({"namespace": namespace} if namespace else {})}


def _draw(path: Path, result: Any, seed: Any, provenance: dict[str, Any]) -> None:
    if path.suffix.lower() == ".html":
        from winch_friction.report.replay_page import write_replay_page

        write_replay_page(path, result, seed, provenance)
        return
    from winch_friction.report.figures import save_figure
    from winch_friction.report.replay_picture import replay_figure

    save_figure(replay_figure(result.compensator, result.estimator, seed), path)


# key of the summary -> what people read
_WORDS = {
    "recording": "recording", "samples": "samples", "duration_s": "duration [s]",
    "active_share": "share of time in action [-]", "feedforward_rms_Nm": "feedforward RMS [N*m]",
    "feedforward_peak_Nm": "feedforward, largest [N*m]", "accepted_share": "share of samples taken [-]",
    "nis_share_inside": "innovations inside their band [-]",
}  # fmt: skip


def _show(content: dict[str, Any]) -> None:
    rows = [(_WORDS.get(name, name), _text(value)) for name, value in content.items() if not isinstance(value, list)]
    show_table("Replay", ("what", "value"), rows)
    learned = [{**each, "learned": beside(each["learned"], each["sigma"])} for each in content["parameters"]]
    _list("Learned", ("parameter", "unit", "seed", "learned", "sigma", "status"), learned)
    if content["live"]:
        _list("Live against replay, relative", ("node", "compared", "missing", "largest", "equal"), content["live"])


def _list(title: str, columns: tuple[str, ...], entries: list[dict[str, Any]]) -> None:
    show_table(title, columns, [[each[column] for column in columns] for each in entries])


def _text(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
