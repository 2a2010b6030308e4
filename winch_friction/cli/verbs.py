"""The verbs of the command line by name: each is a module of its own, imported only when it is called."""

import importlib
from dataclasses import dataclass
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup


@dataclass(frozen=True)
class Verb:
    """A verb: its module in `winch_friction.cli` (`app`, a Typer, or `command`, a function), its help line."""

    name: str
    module: str
    summary: str

    def load(self) -> Any:
        """Its command."""
        module = importlib.import_module(f"winch_friction.cli.{self.module}")
        app = getattr(module, "app", None) or self._app_of(module.command)
        command = typer.main.get_command(app)
        command.name = self.name
        return command

    def _app_of(self, function: Any) -> typer.Typer:
        app = typer.Typer(add_completion=False, rich_markup_mode="rich")
        app.command(self.name)(function)
        return app


VERBS = (
    Verb("demo", "demo", "The whole loop on a simulated sea: three nodes over DDS, a bag, a report."),
    Verb("init", "init", "Commented crane, plant, model, scenario and map files to begin with; JSON Schemas."),
    Verb("simulate", "simulate", "A scenario becomes run files."),
    Verb("check", "check", "Can these runs be this crane's? Names the most likely mistake; commissioning page."),
    Verb("identify", "identify", "Supplier tables and logged tests become a friction model."),
    Verb("replay", "replay", "A bag or run through the nodes' own step: table or bag, and a picture."),
    Verb("gap", "gap", "Where model and runs disagree, the missing effect's name, the repaired model."),
    Verb("fleet", "fleet", "The same verbs over many bags, on Dask."),
    Verb("bench", "bench", "Speed as ratios against what one would use instead."),
    Verb("list", "list", "What there is by name: models, cranes, scenarios, terms, effects, units."),
    Verb("show", "show", "A model as a friction curve; a crane, scenario, effect or term with its physics."),
    Verb("plot", "plot", "Runs as a page: every channel, zoomed together."),
    Verb("compare", "compare", "Two models against each other, on a grid or on runs."),
    Verb("doctor", "doctor", "Whether this machine has what it takes: libraries, ROS, DDS, clock, configuration."),
    Verb("load", "load", "A repaired model into the running compensator."),
    Verb("watch", "watch", "The running nodes in the terminal: state, torque, estimates, rates, faults."),
    Verb("dashboard", "dashboard", "The running nodes, or a bag, as a live page on this machine."),
    Verb("foxglove", "foxglove", "The running nodes, or a bag, for the Foxglove app; or as an MCAP file."),
    Verb("terms", "terms", "The declared friction terms: equations, parameters, sources."),
    Verb("import", "import_", "Logs of any origin become run files, by a map that is proposed and read."),
    Verb("convert", "convert", "Run files from one format to another; the EMPS benchmark to a run."),
)


class VerbGroup(TyperGroup):
    """The group of verbs: names are known at once, a module is imported when its verb is called."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self._verbs = {verb.name: verb for verb in VERBS}
        self._listing = False
        for verb in VERBS:
            self.commands[verb.name] = TyperCommand(verb.name, help=verb.summary)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The loaded verb; while help is listed, a stand-in with its summary."""
        if self._listing or cmd_name not in self._verbs:
            return super().get_command(ctx, cmd_name)
        return self._verbs[cmd_name].load()

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Help without importing a single verb."""
        self._listing = True
        try:
            super().format_help(ctx, formatter)
        finally:
            self._listing = False
