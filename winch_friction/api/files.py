"""Models and cranes from files or by shipped name."""

from pathlib import Path

from winch_friction.api.arguments import checked, vacant
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.winch.crane import Crane


@checked
def load_crane(name: str | Path) -> Crane:
    """A crane from a YAML file, or by shipped name (`winch-friction list cranes`).

    Raises `InputError` with file and key for whatever cannot be used.

    >>> import winch_friction as wf
    >>> crane = wf.load_crane("crane_150t")
    >>> dict(crane.groups), crane.gear_ratio
    ({'main': 11, 'active': 3, 'passive': 8}, 250.0)
    """
    from winch_friction.records.crane_file import load_crane as load

    return load(name)


@checked
def load_model(name: str | Path) -> FrictionModel:
    """A friction model from a YAML file, or by shipped name (`winch-friction list models`).

    Values are SI, in the order of `model.parameter_names`; `model.covariance` is (n, n) or None. Raises `InputError`.

    >>> import winch_friction as wf
    >>> model = wf.load_model("a6vm215_crane2")
    >>> model.value("C3"), model.to_frame().loc["C3", "unit"]
    (0.562, 'N*m')
    """
    from winch_friction.records.model_file import load_model as load

    return load(name)


@checked
def save_model(model: FrictionModel, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write a model file, atomically; nodes, simulator and every verb read it. Returns its path.

    A file that is there, with what somebody has noted in it, is replaced with `overwrite` alone. Raises `InputError`.

    >>> import tempfile, winch_friction as wf
    >>> model = wf.load_model("a6vm215_crane2").with_values({"C3": 80.0})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     wf.load_model(wf.save_model(model, f"{folder}/mine.yaml")).value("C3")
    80.0
    """
    from winch_friction.records.model_file import save_model as save

    return save(model, vacant(path, overwrite))
