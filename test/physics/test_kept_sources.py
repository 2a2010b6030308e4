"""What SymPy makes of the equations is kept on disk, and a start that reads it computes the same."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from winch_friction.physics.friction import sources
from winch_friction.physics.friction.compiled import CompiledTerms, layout
from winch_friction.physics.friction.term import registered_terms
from winch_friction.records.model_file import load_model

PARTS = ("scalar_torque", "scalar_torque_and_gradient", "scalar_contributions", "scalar_state_rates",
         "vector_torque", "vector_gradient", "vector_contributions", "vector_state_rates")  # fmt: skip
LENGTH = len(layout(2))  # of an operating point with two groups
CONSTANTS = (("density", 870.0), ("gear_ratio", 20.0), ("max_displacement", 3e-5), ("viscosity", 0.04))
POINT = [0.9, 60.0, 54.0, 5e5, 0.3, 41.0, 12.0, 700.0, 2.0, 50.0, 11.0,
         6, 1e7, 2e7, 3e-5, 1.0, 1.0, 5, 1.5e7, 2e7, 2e-5, -1.0, -1.0]  # fmt: skip


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    sources._folder.cache_clear()
    yield tmp_path / "winch_friction" / "equations"
    monkeypatch.undo()
    sources._folder.cache_clear()


def crane2() -> CompiledTerms:
    return CompiledTerms(load_model("a6vm215_crane2").terms, 2, CONSTANTS)


# all of them are compiled once more in `make test-long`; those with states, which are written otherwise, in each run
SOME = [
    pytest.param(name, marks=pytest.mark.long if k % 8 and not term.state else [])
    for k, (name, term) in enumerate(sorted(registered_terms().items()))
]


def without_sympy(monkeypatch):
    def never(*_, **__):
        raise AssertionError("made again, though it was kept")

    monkeypatch.setattr("sympy.lambdify", never)


@pytest.mark.parametrize("name", SOME)
def test_every_term_is_read_as_it_was_made(name, folder, monkeypatch):
    made = CompiledTerms((registered_terms()[name],), 2, CONSTANTS)
    own = [getattr(made, part) for part in PARTS]
    without_sympy(monkeypatch)
    read = CompiledTerms((registered_terms()[name],), 2, CONSTANTS)
    point = POINT
    theta, z = [each.typical for each in made.parameters], [0.3] * len(made.initial_states)
    arrays = [np.linspace(each, 1.1 * each, 7) for each in point]
    for part, function in zip(PARTS, own, strict=True):
        x = point if part.startswith("scalar") else arrays
        expected, found = function(x, theta, z), getattr(read, part)(x, theta, z)
        for a, b in zip(*(each if isinstance(each, tuple) else (each,) for each in (expected, found)), strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("name", sorted(registered_terms()))
def test_columns_are_made_once_for_every_machine(name, folder, monkeypatch):
    term = registered_terms()[name]
    _ = CompiledTerms((term,), 2, CONSTANTS).vector_columns
    other = CompiledTerms((term,), 2, tuple((key, 1.3 * value) for key, value in CONSTANTS))
    own, torque = tuple(p for p in term.parameters if not p.shape), other.vector_torque
    without_sympy(monkeypatch)
    rng = np.random.default_rng(5)
    x = [rng.uniform(0.5, 1.5, 7) * each for each in POINT]
    theta, z = [each.typical for each in other.parameters], [0.3] * len(other.initial_states)
    found = np.array([np.broadcast_to(each, 7) for each in other.vector_columns(x, theta, z)])
    still = [0.0 if each in own else value for each, value in zip(other.parameters, theta, strict=True)]
    for row, parameter in zip(found, own, strict=True):
        k = other.parameters.index(parameter)
        alone = [*still[:k], theta[k], *still[k + 1 :]]
        change = np.broadcast_to(torque(x, alone, z) - torque(x, still, z), 7)
        np.testing.assert_allclose(row * theta[k], change, rtol=1e-9, atol=1e-12)


def test_another_equation_or_constant_is_another_file(folder):
    _ = crane2().scalar_torque
    assert len(list(folder.iterdir())) == 1
    _ = CompiledTerms(load_model("a6vm215_crane2").terms, 1, CONSTANTS).scalar_torque
    _ = CompiledTerms(load_model("a6vm215_crane2").terms[:-1], 2, CONSTANTS).scalar_torque
    _ = CompiledTerms(load_model("a6vm215_crane2").terms, 2, (("density", 900.0),)).scalar_torque
    assert len(list(folder.iterdir())) == 4


@pytest.mark.parametrize("damage", ["", "# wrong\nraise SystemExit\n", "half", b"\xff\xfe\x00"])
def test_a_damaged_file_is_made_anew(damage, folder):
    point, model = [1.0] * LENGTH, load_model("a6vm215_crane2")
    expected = crane2().scalar_torque(point, model.values, ())
    (file,) = folder.iterdir()
    whole = file.read_text()
    content = whole[: len(whole) // 2] if damage == "half" else damage
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert crane2().scalar_torque(point, model.values, ()) == expected
    assert file.read_text() == whole


def test_without_a_place_to_write_it_works(tmp_path, monkeypatch):
    monkeypatch.setattr(sources, "cache_root", lambda kind: tmp_path / "file" / kind)
    (tmp_path / "file").write_text("in the way")
    sources._folder.cache_clear()
    try:
        assert np.isfinite(crane2().scalar_torque([1.0] * LENGTH, load_model("a6vm215_crane2").values, ()))
    finally:
        sources._folder.cache_clear()
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


def test_a_full_folder_makes_room(folder, monkeypatch):
    folder.mkdir(parents=True)
    monkeypatch.setattr(sources, "MOST_FILES", 3)
    for k in range(5):
        (folder / f"{k}.py").write_text("old")
    sources._make_room.cache_clear()
    _ = crane2().scalar_torque
    assert len(list(folder.iterdir())) == 4  # three of the five old ones, and the new one


def test_two_processes_agree(tmp_path):
    """What one process has made is what the next computes with, to the last bit."""
    code = (
        "from winch_friction.records.model_file import load_model; m = load_model('a6vm215_crane2'); "
        f"x = [0.3 + 0.7 * k for k in range({LENGTH})]; "
        "print(repr(m.compile(2).scalar_torque_and_gradient(x, m.values, ())))"
    )
    environment = {"XDG_CACHE_HOME": str(tmp_path), "PATH": "", "PYTHONPATH": str(Path(__file__).parents[2])}
    said = {
        subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    }
    assert len(said) == 1
    assert len(list((tmp_path / "winch_friction" / "equations").iterdir())) == 1


@pytest.mark.parametrize(
    ("power", "product"),
    [
        ("K2*x**2", "K2*(x*x)"),
        ("1/C4**2 - w**3", "1/(C4*C4) - (w*w*w)"),
        ("-x**2*y", "-(x*x)*y"),
        ("x**4 + x**20 + x**2.0 + x**2**y + 2.5**2 + (a + b)**2 + exp(x)**3", None),
    ],
)
def test_small_powers_of_names_alone_are_products(power, product):
    assert sources._multiplied(power) == (product or power)
