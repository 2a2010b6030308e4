"""`winch-friction show`: one model, crane, scenario, effect or term, in the terminal and as a page."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import PAGE, load_terms, refuse_existing, refuse_other_kind, show_warnings
from winch_friction.cli.names import KINDS, SHOWN, complete_crane, complete_shown, kind_of, names_of
from winch_friction.cli.optional import OptionalFloat, OptionalPath, Overwrite
from winch_friction.physics.errors import InputError, meant


def command(
    name: Annotated[
        str,
        typer.Argument(help="Model, crane, scenario, effect or term; a name or a file.", autocompletion=complete_shown),
    ],
    kind: Annotated[str, typer.Option(help=f"What it is, when a name stands for several: {', '.join(SHOWN)}.")] = "",
    crane: Annotated[str, typer.Option(help="Crane on which a model is drawn.", autocompletion=complete_crane)] = "",
    load: Annotated[
        OptionalFloat, typer.Option(help="Hanging mass for a model's curve, t; none: a third of the rated one.")
    ] = None,
    out: Annotated[OptionalPath, typer.Option(help="Also write a page (.html), for a model or a term.")] = None,
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file with friction terms of your own.")] = None,
    overwrite: Overwrite = False,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """Show what a name stands for: a model as a friction curve, a crane, a scenario, an effect or term.

    Examples:

      winch-friction show a6vm215_crane2

      winch-friction show a6vm215_crane2 --load 100 --out model.html

      winch-friction show churning
    """
    load_terms(terms_file)
    refuse_other_kind(out, PAGE, "a page")
    refuse_existing(overwrite, out)
    what = kind or kind_of(name) or _of_file(name)
    if what not in SHOWN:
        raise InputError(f"show: --kind '{what}' is none of {', '.join(SHOWN)}")
    if out is not None and what not in ("model", "term", "effect"):
        raise InputError(f"show: a page is drawn of models, terms and effects, not of a {what}; leave out --out")
    if what != "model" and (load is not None or crane):
        raise InputError(f"show: --load and --crane are for the curve of a model, not for a {what}; leave them out")
    if what == "model":
        _model(name, crane, load, out, as_json)
    elif what in ("effect", "term"):
        show_physics(name, out, as_json)
    else:
        _content(name, what, as_json)


def _of_file(name: str) -> str:
    path = Path(name)
    if not path.is_file():
        for kind in ("units", "suppliers"):  # they have names, and nothing to draw
            if name in KINDS[kind].names():
                raise InputError(f"show: all that is known of '{name}' stands in winch-friction list {kind}")
        near = meant(name, (each for kind in SHOWN for each in names_of(kind)))
        raise InputError(
            f"show: '{name}' is neither a file nor a known name;{near} 'winch-friction list' says what there is"
        )
    from winch_friction.fleet.recordings import RUN_SUFFIXES
    from winch_friction.records.strict_yaml import kind_said, read_yaml

    if path.suffix.lower() in RUN_SUFFIXES:
        raise InputError(f"show: {name} is a run file by its name; winch-friction plot draws runs")
    content = read_yaml(path)
    if not isinstance(content, dict):
        raise InputError(f"show: {name} holds no model, crane or scenario: these are mappings of keys (YAML)")
    said = kind_said(content) or "scenario"
    if said not in SHOWN:
        raise InputError(f"show: {name} is a {said} file, and show knows files of models, cranes and scenarios")
    return said


def curve_crane(model: Any, crane: str, where: str = "") -> Any:
    """The crane that a model is drawn on: the given one, the model's own, else what fits its drive.

    `where`: the model's file or name, for what is said of it.
    """
    from winch_friction.physics.friction.model import refuse_other_crane
    from winch_friction.records.crane_file import load_crane

    if crane:
        refuse_other_crane(model, load_crane(crane))
    electric = not any({"pressure", "displacement"} & set(term.reads) for term in model.terms)
    own = getattr(model, "crane", "")
    if not crane and not own:
        taken = "emps" if electric and "emps" in model.name else "crane_150t"
        show_warnings([f"no --crane, and model '{model.name}' names none: drawn on '{taken}'"])
        return load_crane(taken)
    if crane:
        return load_crane(crane)
    try:
        return load_crane(own)
    except InputError as error:
        said = f"{where or model.name}: key 'crane' names '{own}': give its file with --crane FILE"
        raise InputError(f"{said} ({error})") from None


def say_beyond(option: str, loads: Sequence[float], crane: Any) -> None:
    """One line on masses in t that the crane cannot hold: what a model says of them is extrapolated."""
    from winch_friction.importing.expectations import most_held

    most = most_held(crane) / 1e3
    beyond = [f"{each:g}" for each in loads if each > most]
    if beyond:
        held = f"{most:.0f}" if most >= 10.0 else f"{most:.2g}"
        drive = "its rated load" if crane.rated_load else "its torque limit"
        show_warnings([
            f"{option} {','.join(beyond)}: beyond what crane '{crane.name}' holds by its file (0 to {held} t: "
            f"{'all motors at 450 bar' if crane.drive.hydraulic else drive}); what the models say there is extrapolated"
        ])  # fmt: skip


def _model(name: str, crane: str, load: float | None, out: Path | None, as_json: bool) -> None:
    from winch_friction.physics.channels import RPM
    from winch_friction.physics.winch.model_curve import model_curve, usual_loads
    from winch_friction.records.corrections import corrections_content
    from winch_friction.records.model_file import load_model

    model = load_model(name)
    machine = curve_crane(model, crane, name)
    if load is None:
        lifts = machine.drive.hydraulic or machine.rated_load  # a drive may lift nothing
        load = usual_loads(machine)[1] / 1e3 if lifts else 0.0
    if load < 0.0:
        raise InputError(f"show: --load {load:g} t: a hanging mass is a number from 0 on")
    curve = model_curve(model, machine, load=1e3 * load)
    say_beyond("--load", [load], machine)
    rpm = curve.speed / RPM
    if out is not None:  # before a word is printed: whoever reads along may close the pipe
        from winch_friction.report.curves import write_model_page

        drawn = (each / 1e3 for each in usual_loads(machine))
        curves = [model_curve(model, machine, load=1e3 * each) for each in sorted({*drawn, load})]
        write_model_page(out, model, curves, machine.name)
    if as_json:
        parameters = {
            p.name: {"value": v, "std": s, "unit": p.unit, "meaning": p.doc}
            for p, v, s in zip(model.parameters, model.values, model.std.tolist(), strict=True)
        }
        show_json(
            {
                "name": model.name,
                "crane": machine.name,
                "load_t": load,
                "terms": model.term_names,
                "parameters": parameters,
                "corrections": corrections_content(model.corrections),
                "curve": {"speed_rpm": rpm, "torque_Nm": curve.torque, "std_Nm": curve.std, "terms_Nm": curve.parts},
            }
        )
    else:
        _draw_model(model, machine, curve, rpm)
        if out is not None:
            print(f"wrote {out}")


def _draw_model(model: Any, machine: Any, curve: Any, rpm: Any) -> None:
    from winch_friction.cli.chart import chart
    from winch_friction.physics.channels import beside
    from winch_friction.report.corrections import CORRECTIONS, correction_rows
    from winch_friction.report.tables import for_people, value_for_people

    largest = sorted(curve.parts, key=lambda name: -float(abs(curve.parts[name]).max()))[:3]
    lines = {"total": curve.torque, **{name: curve.parts[name] for name in largest}}
    head = f"{model.name} on {machine.name}, {curve.load / 1e3:g} t: friction torque at the motor shaft [N*m]"
    print(chart(rpm, lines, "rpm", head))
    rows = [
        [
            p.name,
            f"{value_for_people(beside(v, s) if model.covariance is not None else v, p.unit):.4g}",
            f"{value_for_people(s, p.unit):.2g}" if model.covariance is not None else "-",
            for_people(p.unit),
            p.doc,
        ]
        for p, v, s in zip(model.parameters, model.values, model.std.tolist(), strict=True)
    ]
    show_table(f"parameters of {', '.join(model.term_names)}", ("parameter", "value", "sigma", "unit", "meaning"), rows)
    if model.corrections:
        wrong = [
            [correction, f"{value:.4g}", "-" if std is None else f"{std:.2g}", *more]
            for correction, value, std, *more in correction_rows(model.corrections)
        ]
        titles = ["sigma" if title == "σ" else title for title in CORRECTIONS]
        show_table("corrections: what its logs or its crane file have wrong", titles, wrong)


def show_physics(name: str, out: Path | None, as_json: bool) -> None:
    from winch_friction.physics.effects import effect_text
    from winch_friction.physics.friction import registered_terms

    text, term = effect_text(name), registered_terms().get(name)
    if out is not None:
        _write_page(text, term, out)
    if as_json:
        show_json(
            {
                "name": name,
                "title": text.title,
                "physics": text.physics,
                "usual_size": text.size,
                "next": text.look,
                "latex": term.latex if term else None,
                "parameters": [
                    {
                        "name": p.name,
                        "unit": p.unit,
                        "typical": p.typical,
                        "lower": p.lower,
                        "upper": p.upper,
                        "meaning": p.doc,
                    }
                    for p in (term.parameters if term else ())
                ],
            }
        )
        return
    print(f"{name}: {text.title}\n\n{text.physics}")
    if text.size:
        print(f"usual size: {text.size}")
    print(f"what to do: {text.look}")
    if term is not None:
        from winch_friction.report.equations import written

        print(f"\n    T = {written(term)}\n")
        print(f"reads {', '.join(term.reads) or 'nothing'}; {term.scope.value}; {term.source}")
        rows = [[p.name, p.unit, p.typical, f"{p.lower:g} ... {p.upper:g}", p.doc] for p in term.parameters]
        show_table("parameters, SI", ("parameter", "unit", "typical", "bounds", "meaning"), rows)
    if out is not None:
        print(f"wrote {out}")


def _write_page(text: Any, term: Any, out: Path) -> None:
    from winch_friction.report.base import TextSection, write_report
    from winch_friction.report.equations import term_html
    from winch_friction.report.tables import paragraph

    sections = [TextSection("What it is", paragraph(text.physics) + paragraph(f"What to do: {text.look}"))]
    if term is not None:
        sections.append(TextSection("Equation", term_html(term)))
    write_report(out, text.title, sections, text.name)


def _content(name: str, what: str, as_json: bool) -> None:
    from winch_friction.records.strict_yaml import read_yaml, shipped

    path = shipped({"crane": "cranes", "scenario": "scenarios"}[what], name)
    if what == "crane":
        from winch_friction.records.crane_file import load_crane

        radii = load_crane(path).drum.layer_radii  # refused here rather than shown wrong
    else:
        from winch_friction.simulation import load_scenario

        load_scenario(str(path))
    content = read_yaml(path)
    if as_json:
        show_json(content)
        return
    if what == "crane":
        content["drum"] = f"layer_radii: {', '.join(f'{each:g}' for each in radii)} m"
    show_table(f"{what} {name} ({path})", ("key", "value"), [[key, _plain(value)] for key, value in content.items()])


def _plain(value: Any) -> str:
    if isinstance(value, dict) and set(value) == {"value", "unit"}:
        size = value["value"]
        return f"{size:g} {value['unit']}" if isinstance(size, float) else f"{size} {value['unit']}"
    if isinstance(value, dict):
        return ", ".join(f"{key}: {_plain(each)}" for key, each in value.items())
    return ", ".join(_plain(each) for each in value) if isinstance(value, list) else str(value)
