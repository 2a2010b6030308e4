"""A user's own term in a file, and a repaired model file that names it: nothing of it is registered in this process."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import yaml

from winch_friction.physics.friction import term as registry
from winch_friction.records.model_file import load_model, model_to_text

DECLARATION = """
from winch_friction.physics.friction import Parameter, Scope, Term, register
from winch_friction.physics.friction.symbols import w

k = Parameter("{parameter}", "N*m*s/rad", 1.0, lower=0.0, upper=10.0, doc="drag by speed")
register(Term("{term}", k.symbol * w, (k,), Scope.SHAFT, "a test", "gear and drum"))
"""
TERM, PARAMETER = "own_drag", "k_own"


def own_terms(folder: Path, term: str = TERM, parameter: str = PARAMETER) -> Path:
    """The file that declares the term k w at the shaft."""
    path = folder / f"{term}.py"
    path.write_text(DECLARATION.format(term=term, parameter=parameter))
    return path


def own_model(folder: Path, term: str = TERM, parameter: str = PARAMETER, value: float = 1.0, std: float = 0.3) -> Path:
    """The seed a6vm215_crane2 with that term: `value` and `std` in N m s/rad."""
    content = yaml.safe_load(model_to_text(load_model("a6vm215_crane2")))
    content.pop("correlation", None)
    content["terms"].append(term)
    content["parameters"][parameter] = {"value": value, "unit": "N*m*s/rad", "std": std}
    content["name"] = "repaired"
    path = folder / "repaired.yaml"
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return path


@contextmanager
def forgotten(term: str) -> Iterator[None]:
    """Take a term out of this process's registry at the end."""
    try:
        yield
    finally:
        registry._TERMS.pop(term, None)
