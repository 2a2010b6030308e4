"""`winch-friction <verb>`: exit 0 done, 2 bad input (one clear line a problem), 1 a defect of this program.

Each verb is a module of its own, imported only when it is called.
"""

import importlib
import os
import sys
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from winch_friction import __version__
from winch_friction.cli import Modes
from winch_friction.cli.interrupts import asked
from winch_friction.physics.errors import InputError


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


# -- the program
QUIET, PLAIN = ("--quiet", "-q"), ("--plain",)
DONE, DEFECT, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
# matrices here are small: threads of BLAS would only wait for each other, on every core of the machine
SERIAL = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
HELP = """Friction of a hydraulic winch: compensated and learned online, identified offline, questioned always.

Examples, each with more under [bold]--help[/bold]:

  [cyan]winch-friction demo[/cyan]

  [cyan]winch-friction replay bag/ --crane crane_150t --model a6vm215_crane2 --out replay.csv[/cyan]

  [cyan]winch-friction gap runs/*.csv --crane crane_150t --model a6vm215_crane2 --out gap/[/cyan]

Exit status: 0 done, 2 bad input (one line a problem says what, where and what to do), 1 a defect.
"""

app = typer.Typer(cls=VerbGroup, help=HELP, rich_markup_mode="rich", add_completion=True)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"winch-friction {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: bool = typer.Option(
        False, "--version", is_eager=True, callback=_show_version, help="Print the version and exit."
    ),
    quiet: bool = typer.Option(False, "--quiet", "-q", help="Only results and errors; before or behind the verb."),
    plain: bool = typer.Option(False, "--plain", help="Tables between tabs, no frames, no colour, no progress."),
) -> None:
    """Options before the verb."""


def without_modes(arguments: Sequence[str]) -> list[str]:
    """The words without --quiet and --plain, which are taken wherever they stand (not behind `--`)."""
    words = list(arguments)
    end = words.index("--") if "--" in words else len(words)
    Modes.quiet = any(word in QUIET for word in words[:end])
    Modes.plain = any(word in PLAIN for word in words[:end])
    return [word for k, word in enumerate(words) if k >= end or word not in (*QUIET, *PLAIN)]


def run(arguments: Sequence[str]) -> int:
    """Carry out one command line; returns the exit status and writes errors to stderr."""
    words = without_modes(arguments)
    try:
        result = typer.main.get_command(app).main(words or ["--help"], "winch-friction", standalone_mode=False)
        if result == INTERRUPTED:  # Typer takes the interrupt for itself and says nothing
            return _said("interrupted", INTERRUPTED)
        return result if isinstance(result, int) else DONE
    except InputError as error:
        return _bad_input(*error.problems)
    except (KeyboardInterrupt, typer.Abort):
        return _said("interrupted", INTERRUPTED)
    except BrokenPipeError:
        return _nobody_reads()
    except SystemExit as end:  # Typer ends so where `print` finds nobody to read it
        if not isinstance(end.__context__, BrokenPipeError):
            raise
        return _nobody_reads()
    except OSError as error:
        return _bad_input(f"{error.filename or 'input or output'}: {error.strerror or error}")
    except ModuleNotFoundError as error:
        return _missing_library(error)
    except Exception as error:
        if hasattr(error, "format_message"):  # a usage error of Typer's, from whichever click it carries
            return _bad_input(error.format_message() + _usage_hint(error))
        return _said("interrupted", INTERRUPTED) if asked() else _defect(error)


def _nobody_reads() -> int:
    """The pipe's reader has gone: nothing to say, not even what is still buffered."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return DONE


def _missing_library(error: ModuleNotFoundError) -> int:
    if (error.name or "").startswith("winch_friction"):
        return _defect(error)
    extras = "pip install 'winch_friction[desk]' (or [fleet], [ros])"
    return _bad_input(f"the library '{error.name}' is not installed: {extras}")


def _defect(error: Exception) -> int:
    traceback.print_exception(error)
    return _said(f"defect: {type(error).__name__}: {error}; please report it with the lines above", DEFECT)


def _usage_hint(error: Exception) -> str:
    context = getattr(error, "ctx", None)
    return f" (see '{context.command_path} --help')" if context is not None else ""


def _bad_input(*problems: str) -> int:
    for each in problems:
        _said(" ".join(each.split()), BAD_INPUT)
    return BAD_INPUT


def _said(message: str, status: int) -> int:
    try:
        print(f"winch-friction: {message}", file=sys.stderr, flush=True)
    except BrokenPipeError:  # `2>&1 | head`: the status is still what it is
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    return status


def main() -> None:
    """Entry point of the console script; whoever sets a number of threads keeps it."""
    for name in SERIAL:  # before anything loads NumPy
        os.environ.setdefault(name, "1")
    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
