"""The package builds as a ROS workspace package and registers itself and its executables."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
COLCON = Path(sys.executable).with_name("colcon")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """A scratch workspace with the tracked files of this checkout, built once."""
    scratch = tmp_path_factory.mktemp("workspace")
    tracked = ["ls-files", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(["git", *tracked], cwd=ROOT, capture_output=True, text=True, check=False)
    if listing.returncode != 0:
        pytest.skip("not a git checkout: the files to build cannot be listed")
    for name in listing.stdout.splitlines():
        source = ROOT / name
        if source.is_file():
            target = scratch / "src/winch_friction" / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target)
    command = [str(COLCON), "build", "--event-handlers", "console_direct-"]
    built = subprocess.run(command, cwd=scratch, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout + built.stderr
    return scratch / "install/winch_friction"


def test_registers_in_the_ament_index(workspace):
    assert (workspace / "share/ament_index/resource_index/packages/winch_friction").is_file()
    assert (workspace / "share/winch_friction/package.xml").is_file()


@pytest.mark.parametrize("name", ["compensator", "estimator", "simulator"])
def test_registers_the_executables_where_ros2_run_looks(workspace, name):
    assert (workspace / "lib/winch_friction" / name).is_file()


@pytest.mark.parametrize("folder", ["launch", "config/cranes", "config/models", "config/nodes", "config/scenarios"])
def test_installs_what_the_nodes_read(workspace, folder):
    assert any((workspace / "share/winch_friction" / folder).iterdir())
