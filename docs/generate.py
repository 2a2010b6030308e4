"""Reference pages from the code: command line, API, channels, nodes, file schemas, corrections, effects."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any


def write_reference(folder: Path) -> None:
    """Write every generated page; a page that did not change keeps its time, so that a second build is quick."""
    folder.mkdir(exist_ok=True)
    for name, text in {
        "api": _api(), "cli": _cli(), "channels": _channels(), "parameters": _parameters(), "effects": _effects(),
        "corrections": _corrections(), "nodes": _nodes(), "schemas": _schemas(),
    }.items():  # fmt: skip
        path = folder / f"{name}.md"
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    line = lambda cells: "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
    return "\n".join([line(head), "|" + "---|" * len(head), *(line(row) for row in rows)]) + "\n"


_OBJECTS = ("Run", "Sample", "GroupSample", "FrictionModel", "Crane", "InputError")


def _api() -> str:
    import winch_friction as wf

    functions = [name for name in wf.__all__ if name[0].islower() and name != "terms"]
    lines = ["# Python", "", "`import winch_friction as wf`: these names are stable, everything else is private.", ""]
    for name in functions:
        lines += [
            f"## `{name}`",
            "",
            f"```{{eval-rst}}\n.. autofunction:: {getattr(wf, name).__module__}.{name}\n```",
            "",
        ]
    lines += ["## Objects", ""]
    for name in (*_OBJECTS, "FeedforwardCompensator", "FrictionEstimator"):
        module = getattr(wf, name).__module__
        lines += [f"```{{eval-rst}}\n.. autoclass:: {module}.{name}\n   :members:\n```", ""]
    lines += ["## Results", ""]
    for name in ("Check", "Fit", "Replay", "Gap"):
        lines += [f"```{{eval-rst}}\n.. autoclass:: winch_friction.api.results.{name}\n   :members:\n```", ""]
    lines += ["## `terms`", "", "```{eval-rst}\n.. automodule:: winch_friction.terms\n```", ""]
    return "\n".join(lines)


def _cli() -> str:
    from winch_friction.cli.main import VERBS

    lines = [
        "# Command line",
        "",
        "Exit status: 0 done, 2 bad input (one line says what, where and what to do), 1 a defect.",
        "",
    ]
    for verb in VERBS:
        lines += [f"## `{verb.name}`", "", verb.summary, ""]
        lines += _command(verb.load(), f"winch-friction {verb.name}")
    return "\n".join(lines)


def _command(command: Any, name: str) -> list[str]:
    if getattr(command, "commands", None):
        return [line for sub in command.commands.values() for line in _command(sub, f"{name} {sub.name}")]
    words = (
        (command.help or "").replace("[bold]", "").replace("[/bold]", "").replace("[cyan]", "").replace("[/cyan]", "")
    )
    rows = []
    for each in command.params:
        if each.name in ("help", "install_completion", "show_completion"):
            continue
        flag = " ".join(f"`{option}`" for option in getattr(each, "opts", [each.name]))
        default = "" if each.default in (None, "", False) or callable(each.default) else f"`{each.default}`"
        rows.append((flag, (getattr(each, "help", "") or "").replace("[bold]", "").replace("[/bold]", ""), default))
    return [f"```text\n{name}\n\n{words.strip()}\n```", "", _table(("option", "meaning", "default"), rows), ""]


def _channels() -> str:
    from winch_friction.physics.channels import CHANNELS, accepted_units

    rows = []
    for c in CHANNELS:
        name = f"<group>.{c.name}" if c.of_group else c.name
        age = f"{c.max_age:g} s" if c.max_age is not None else ""
        rows.append((f"`{name}`", c.unit, c.display, ", ".join(accepted_units(c.unit)[1:]), age, c.doc))
    head = ("column", "SI", "read as", "also accepted", "holds for", "meaning")
    return (
        "# Channels\n\nThe columns of a run file and the inputs of the nodes, from the table in the code.\n\n"
        + _table(head, rows)
    )


def _parameters() -> str:
    from generate_nodes import nodes, parameters_of

    text = (
        "# Parameters of the nodes\n\nWhat `ros2 param describe` says, asked of the nodes. Besides: `gains.TERM`, a "
        "gain of each term of the compensator (1.0, 0 … 2), `use_sim_time`, and the quality of service of each topic "
        "under `qos_overrides`.\n"
    )
    with nodes() as made:
        for name, node in made.items():
            rows = [(f"`{n}`", f"`{value}`", span, doc) for n, value, span, doc in parameters_of(node)]
            text += f"\n## `{name}`\n\n" + _table(("parameter", "default", "range", "meaning"), rows)
    return text


def _nodes() -> str:
    from generate_nodes import SERVICE_TEXTS, meaning, nodes, services_of, topics_of

    text = (
        "# Topics and services of the nodes\n\nAsked of the running nodes, in their default configuration on crane "
        "`crane_150t`. Every node is a lifecycle node and has the services that come with that.\n"
    )
    with nodes() as made:
        for name, node in made.items():
            rows = [(f"`{topic}`", way, f"`{kind}`", meaning(topic)) for topic, way, kind in topics_of(node)]
            text += f"\n## `{name}`\n\n" + _table(("topic", "in or out", "type", "meaning"), rows)
            served = [(f"`{s}`", f"`{t}`", SERVICE_TEXTS.get(s.rpartition("/")[2], "")) for s, t in services_of(node)]
            text += "\n" + _table(("service", "type", "meaning"), served)
    return text


def _schemas() -> str:
    import json

    folder = Path(__file__).parents[1] / "config" / "schemas"
    text = (
        "# File schemas\n\nJSON Schemas of every file, for an editor's completion: `winch-friction init schemas` "
        "writes them. The readers decide; the schemas are generated from what they accept.\n"
    )
    for path in sorted(folder.glob("*.json")):
        content = json.loads(path.read_text())
        required = set(content.get("required", []))
        rows = [
            (f"`{key}`", "yes" if key in required else "", _said(each, content))
            for key, each in content.get("properties", {}).items()
        ]
        text += f"\n## {path.name.split('.')[0]}\n\n{content.get('description', '')}\n\n"
        text += _table(("key", "required", "what"), rows)
    return text


def _said(schema: dict[str, Any], whole: dict[str, Any]) -> str:
    """A key's type in words."""
    if "$ref" in schema:
        return _said(whole["$defs"][schema["$ref"].rpartition("/")[2]], whole)
    for key, words in (("description", "{}"), ("const", "`{}`"), ("enum", "one of {}"), ("type", "{}")):
        if key in schema:
            value = schema[key]
            return words.format(", ".join(f"`{each}`" for each in value) if isinstance(value, list) else value)
    options = schema.get("anyOf") or schema.get("oneOf") or schema.get("allOf") or []
    return " or ".join(dict.fromkeys(_said(each, whole) for each in options)) or "anything"


def _effects() -> str:
    from winch_friction.physics.effects import effect_texts

    intro = "What `gap` names, in words; the equations stand under [Terms](../terms.md)."
    text = f"# Effects that a model can lack\n\n{intro}\n"
    for each in effect_texts().values():
        size = f"\n\nUsual size: {each.size}." if each.size else ""
        text += f"\n## `{each.name}`\n\n**{each.title}.** {each.physics}{size}\n\nWhat to do: {each.look}\n"
    return text


def _corrections() -> str:
    from winch_friction.physics.friction.declared_correction import DECLARED

    rows = []
    for each in DECLARED.values():
        p = each.parameter
        rows.append((f"`{each.name}`", p.unit, f"{p.lower:g} … {p.upper:g}", "yes" if each.live else "no", p.doc))
    said = "What a model file may say is wrong with the data or the crane; readers take it out or refuse it.\n\n"
    return (
        "# Corrections\n\n"
        + said
        + _table(("correction", "unit", "bounds", "a live node can apply it", "meaning"), rows)
    )
