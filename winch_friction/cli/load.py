"""`winch-friction load`: a repaired or newly identified model into the running compensator."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import typer

from winch_friction.cli.console import show_json, stderr
from winch_friction.cli.names import complete_model
from winch_friction.cli.optional import OptionalPath
from winch_friction.physics.errors import InputError


def command(
    model: Annotated[str, typer.Argument(help="Model file or shipped name.", autocompletion=complete_model)],
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file of your own terms in the model.")] = None,
    namespace: Annotated[str, typer.Option(help="Namespace of the winch's nodes.")] = "",
    node: Annotated[str, typer.Option(help="Name of the node.")] = "compensator",
    as_json: Annotated[bool, typer.Option("--json", help="The node's answer as JSON.")] = False,
) -> None:
    """Load a model into the running compensator, without a bump; what it refuses leaves the old model at work.

    The same as: ros2 param set /compensator model_file FILE; ros2 service call /compensator/load_model
    std_srvs/srv/Trigger. The estimator keeps its own seed: give it the file when it is started.

    Example: winch-friction load gap/model.yaml
    """
    if importlib.util.find_spec("rclpy") is None:
        raise InputError("running nodes are reached with rclpy: source ROS 2, or pip install 'winch_friction[ros]'")
    given = str(Path(model).resolve()) if Path(model).exists() else model
    terms = ["--terms-file", str(_existing(terms_file))] if terms_file else []
    if not terms:
        from winch_friction.records.model_file import load_model

        load_model(given)  # what cannot be read is said here, before the node is asked
    call = [sys.executable, "-m", "winch_friction.nodes.load", given, *terms]
    with stderr.status(f"asking {node} ..."):
        done = subprocess.run(
            [*call, "--namespace", namespace, "--node", node], capture_output=True, text=True, check=False
        )
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        raise InputError(lines[-1] if lines else f"{node}: no answer")
    said = done.stdout.strip()
    if as_json:
        show_json({"node": node, "namespace": namespace, "model": given, "said": said})
    else:
        print(said)


def _existing(path: Path) -> Path:
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    return path.resolve()
