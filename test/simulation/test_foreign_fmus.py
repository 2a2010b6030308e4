"""FMUs that no one here wrote: the four that crane-fmu of PyPI ships, driven by a log or refused in one line."""

from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.simulation.fmu import load_fmu_map, simulate_fmu

# file, an input and an output of it
SHIPPED = [
    ("DrivingForce.fmu", "v_osc[2]", "f[2]"),
    ("HarmonicOscillator6D.fmu", "f[2]", "x[2]"),
    ("MobileCrane.fmu", "d_velocity[0]", "force[2]"),
    ("MobileCraneStraight.fmu", "d_velocity[0]", "fixation.end[2]"),
]


def shipped(name):
    """An FMU of the installed crane-fmu; the test is skipped without it."""
    pytest.importorskip("fmpy")
    try:
        found = [each for each in files("crane-fmu") or () if each.name == name]
    except PackageNotFoundError:
        found = []
    if not found:
        pytest.skip("crane-fmu is not installed: pip install crane-fmu")
    return Path(str(found[0].locate()))


@pytest.mark.parametrize(("name", "variable", "output"), SHIPPED)
def test_a_foreign_fmu_is_driven_by_a_log_or_refused_in_its_own_words(tmp_path, name, variable, output):
    (tmp_path / "map.yaml").write_text(
        f'schema: winch_friction.fmu/1\ninputs:\n  "{variable}": {{column: motor_speed, unit: rad/s}}\n'
        f'outputs:\n  "{output}": {{column: rope_force_simulated, unit: N}}\n'
    )
    time = np.arange(0.0, 2.0, 0.02)
    run = Run("run", {"time": time, "motor_speed": np.sin(time), "rope_force": np.zeros(len(time))})
    said, path, links = "", shipped(name), load_fmu_map(tmp_path / "map.yaml")
    try:
        simulated = simulate_fmu(path, links, run)
    except InputError as error:
        said = str(error)
    if said:  # it wants packages of its own that are not installed here
        assert "the FMU failed on run" in said
        assert "\n" not in said
        pytest.skip(f"{name} does not run here: {said}")
    assert np.isfinite(simulated["rope_force_simulated"]).all()
    assert len(simulated) == len(run)
    assert simulated.metadata["fmu"] == name


@pytest.mark.parametrize("name", [each[0] for each in SHIPPED])
def test_a_variable_that_it_does_not_have_is_refused_with_those_that_it_has(tmp_path, name):
    (tmp_path / "map.yaml").write_text(
        "schema: winch_friction.fmu/1\ninputs:\n  omega: {column: motor_speed}\n"
        "outputs:\n  dp: {column: rope_force_simulated}\n"
    )
    run = Run("run", {"time": np.arange(3.0), "motor_speed": np.zeros(3)})
    with pytest.raises(InputError, match="no variable dp, omega; it has"):
        simulate_fmu(shipped(name), load_fmu_map(tmp_path / "map.yaml"), run)
