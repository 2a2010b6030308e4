"""The public surface: frozen, small, lazy, documented with examples that run."""

import doctest
import importlib
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import winch_friction as wf

PUBLIC = {
    "Crane", "FeedforwardCompensator", "FrictionEstimator", "FrictionModel", "GroupSample", "InputError", "Run",
    "Sample", "check", "contributions",
    "fit", "friction_curve", "from_frame", "gap", "jacobian", "load_crane", "load_model",
    "read_run", "replay", "save_model", "simulate", "terms", "torque", "write_run",
}  # fmt: skip
NO_LOAD = {"time": [0, 1], "motor_speed": [1, 1], "motor_torque": [0, 0]}
EXAMPLES = (
    "api.files", "api.runs", "api.evaluate", "api.work", "api.results", "terms", "physics.signals", "physics.errors",
    "physics.friction.model", "physics.winch.crane", "compensation.compensator", "estimation.estimator",
)  # fmt: skip
RESULTS = ("Check", "Fit", "Gap", "Replay")  # what the jobs return


def test_the_surface_is_what_was_promised():
    """A name more or less is a decision: change it here, in the stub, in the docs and in the changelog."""
    assert set(wf.__all__) == PUBLIC
    assert len(PUBLIC) <= 25
    stub = Path(wf.__file__).with_suffix(".pyi").read_text()
    assert set(re.findall(r" as (\w+)$", stub, re.MULTILINE)) == PUBLIC


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_every_public_name_is_there_and_documented(name):
    assert (getattr(wf, name).__doc__ or "").strip()
    assert name in dir(wf)


def test_a_subpackage_does_not_take_a_public_name_away():
    importlib.import_module("winch_friction.replay.recording")
    assert callable(wf.replay)


def test_a_private_name_is_refused_with_the_public_ones():
    with pytest.raises(AttributeError, match="no public name 'records_'"):
        wf.records_  # noqa: B018


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda c, m, r: wf.replay(r, "my.yaml", m),
         "replay: crane must be a Crane, found the text 'my.yaml': wf.load_crane('my.yaml')"),
        (lambda c, m, r: wf.check([r], c, Path("a")),
         "check: model must be a FrictionModel, found a PosixPath: wf.load_model('a')"),
        (lambda c, m, r: wf.friction_curve(c, m), "friction_curve: model must be a FrictionModel, found a Crane"),
        (lambda c, m, r: wf.torque(m, "a.csv", c),
         "torque: run must be a Run, found the text 'a.csv': wf.read_run('a.csv', crane)"),
        (lambda c, m, r: wf.gap("runs", c, m), "gap: runs must be a list of runs or files, found the text 'runs'"),
        (lambda c, m, r: wf.gap(r, c, m), "gap: runs must be a list of runs or files, found a Run"),
        (lambda c, m, r: wf.gap(None, c, m), "gap: runs must be a list of runs or files, found a NoneType"),
        (lambda c, m, r: wf.check([r, 3], c), "check: runs: each must be a run, a run file or a bag, found a int"),
        (lambda c, m, r: wf.fit(r, c, motor=m), "fit: data must be a list of runs or files, found a Run"),
        (lambda c, m, r: wf.load_model(m), "load_model: name must be a file or a shipped name, found a FrictionModel"),
        (lambda c, m, r: wf.write_run(r, None), "write_run: path must be a file, found a NoneType"),
        (lambda c, m, r: wf.FeedforwardCompensator(m, c),
         "crane must be a Crane (wf.load_crane reads one), found a FrictionModel"),
        (lambda c, m, r: wf.FrictionEstimator(c, "a6vm215"),
         "model must be a FrictionModel (wf.load_model reads one), found a str"),
        (lambda c, m, r: m.only("moter"), "'moter' is no place of a term; did you mean motor?"),
        (lambda c, m, r: wf.simulate("ahc_55t_215", c, m, seed=1.5),
         "simulate: seed 1.5: give a whole number, 0 or more"),
        (lambda c, m, r: wf.save_model(c, "a.yaml"), "save_model: model must be a FrictionModel, found a Crane"),
    ],
)  # fmt: skip
def test_an_argument_of_another_kind_is_refused_with_what_to_give(call, said):
    """`'str' object has no attribute 'speed_scale'`, and "r: no such file" of the folder "runs"."""
    with pytest.raises(wf.InputError) as refused:
        call(wf.load_crane("emps"), wf.load_model("emps_viscous"), wf.from_frame(NO_LOAD))
    assert str(refused.value) == said


def test_a_file_that_is_there_is_replaced_where_that_is_said_alone(tmp_path):
    """`write_run` of a log that was read, under its own name, took the columns that the contract does not know."""
    log, model = tmp_path / "log.csv", tmp_path / "my_crane.yaml"
    run, seed = wf.from_frame(NO_LOAD), wf.load_model("emps_viscous")
    for path, write in (
        (log, lambda **o: wf.write_run(run, log, **o)),
        (model, lambda **o: wf.save_model(seed, model, **o)),
    ):
        path.write_text("somebody's")
        with pytest.raises(wf.InputError, match=f"{path.name}: exists already; give another name, or overwrite=True"):
            write()
        assert path.read_text() == "somebody's"
        assert write(overwrite=True).read_text() != "somebody's"


def test_a_default_is_none_and_what_lacks_is_said_by_python():
    assert wf.check([], wf.load_crane("emps"), None).plausible
    with pytest.raises(TypeError, match="torque.* missing 2 required positional arguments"):
        wf.torque(wf.load_model("emps_viscous"))


def test_importing_the_package_costs_nothing():
    code = "import sys, winch_friction; print(sorted({'numpy', 'sympy', 'scipy', 'pandas'} & set(sys.modules)))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.parametrize("module", EXAMPLES)
def test_the_examples_in_the_docstrings_run(module):
    found = doctest.testmod(importlib.import_module(f"winch_friction.{module}"))
    assert found.attempted
    assert not found.failed


def classes():
    results = importlib.import_module("winch_friction.api.results")
    public = [getattr(wf, name) for name in wf.__all__ if name[0].isupper()]
    return [*public, *(getattr(results, name) for name in RESULTS)]


def test_every_public_name_has_an_example_that_is_run():
    """Functions and classes in their own docstring, every public method in its own or its class's."""
    modules = {f"winch_friction.{name}" for name in EXAMPLES}
    finder = doctest.DocTestParser()

    def shown(documented):
        return "".join(each.source for each in finder.get_examples(documented.__doc__ or ""))

    for name in sorted(PUBLIC - {"terms"}):
        assert shown(getattr(wf, name)), name
        assert getattr(wf, name).__module__ in modules, name
    for kind in classes():
        for name, method in vars(kind).items():
            if name.startswith("_") or not (callable(method) or isinstance(method, property)):
                continue
            assert re.search(rf"\.{name}\b", shown(kind) + shown(method)), f"{kind.__name__}.{name}"


def test_runs_survive_pandas_and_xarray():
    run = wf.from_frame({"time": [0.0, 0.5], "motor_speed [rpm]": [60.0, 120.0], "motor_torque": [1.0, 2.0]}, "a")
    for table in (run.to_frame(), run.to_xarray()):
        back = wf.from_frame(table, "a")
        assert set(back.columns) == set(run.columns)
        assert np.array_equal(back["motor_speed"], run["motor_speed"])
    assert run.to_xarray()["motor_speed"].attrs["units"] == "rad/s"


def test_what_is_shown_in_a_notebook_says_something():
    crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    assert "gear ratio" in crane._repr_html_()
    shown = [
        " ".join(re.sub("<[^>]*>", " ", each._repr_html_()).split()) for each in (crane, replace(crane, groups={}))
    ]
    motors = " ".join(f"{name} {count}" for name, count in crane.groups.items())
    assert f"motors by group {motors}" in shown[0].replace(",", "")
    assert "motors by group 1 gear ratio" in shown[1]  # that no group names
    assert "stribeck" in repr(model)
    assert "Coulomb" in model._repr_html_()


def test_a_friction_curve_adds_up_and_balances_the_load():
    crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    curve = wf.friction_curve(model, crane, load=55e3)
    parts = curve[list(model.term_names)].sum(axis=1)
    assert np.allclose(parts, curve["torque"])
    carried = curve["pressure"] * crane.max_displacement * crane.groups["main"]
    assert np.allclose(carried, crane.drum_torque(55e3) / crane.gear_ratio + curve["torque"], rtol=1e-4)
    assert (curve["std"] > 0.0).all()


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda m, c: wf.friction_curve(m, c, load=-1.0), "hanging mass"),
        (lambda m, c: wf.friction_curve(m, c, displacement=1.0), "outside"),
        (lambda m, c: wf.torque(m, wf.from_frame(NO_LOAD), c), "load="),
        (lambda m, c: wf.from_frame([1, 2]), "no table"),
        (lambda m, c: wf.fit([]), "crane"),
    ],
)  # fmt: skip
def test_bad_input_is_said_in_one_line(call, said):
    with pytest.raises(wf.InputError, match=said):
        call(wf.load_model("a6vm215_crane2"), wf.load_crane("crane_150t"))
