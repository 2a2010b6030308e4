"""ament's own linters, as far as they are installable, with what this code does otherwise named one by one."""

import configparser
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LINTED = ("winch_friction", "launch")
# the layout of this code's formatter and its line length, which ament's defaults do not share
OTHER_LAYOUT = ("E128", "E203", "E731")
# docstrings here begin on the first line, may state a fact instead of a command, and put examples for the command line
# below a plain heading: the rules for a summary of one imperative sentence and for numpy's and google's sections
OTHER_DOCSTRINGS = ("D205", "D209", "D213", "D400", "D401", "D403", "D406", "D407", "D412", "D413", "D415")


def lint(module, *arguments):
    """What a linter prints; it must find nothing."""
    pytest.importorskip(module, reason="needs the extra 'test'")
    done = subprocess.run([sys.executable, "-m", f"{module}.main", *map(str, arguments)], cwd=ROOT, text=True,
                          capture_output=True, check=False)  # fmt: skip
    said = [line for line in (done.stdout + done.stderr).splitlines() if not line.startswith(("checking", "* "))]
    assert done.returncode == 0, "\n".join(said)
    return done.stdout


@pytest.mark.long  # ruff's same rules run in every `make lint`
def test_ament_flake8(tmp_path):
    module = pytest.importorskip("ament_flake8", reason="needs the extra 'test'")
    rules = configparser.ConfigParser()
    rules.read(Path(module.__file__).parent / "configuration" / "ament_flake8.ini")
    rules["flake8"]["extend-ignore"] += "," + ",".join(OTHER_LAYOUT)
    with (tmp_path / "flake8.ini").open("w") as file:
        rules.write(file)
    assert "No problems found" in lint(
        "ament_flake8", "--config", tmp_path / "flake8.ini", "--linelength", 120, *LINTED
    )


@pytest.mark.long
def test_ament_pep257():
    assert "No problems found" in lint("ament_pep257", "--add-ignore", *OTHER_DOCSTRINGS, "--", *LINTED)


def test_ament_xmllint(tmp_path):
    """Well formed; the schema of package.xml is on a server, so its rules are held by `catkin_pkg` below."""
    if shutil.which("xmllint") is None:
        pytest.skip("no xmllint on this machine (Ubuntu's libxml2-utils has it)")
    text = (ROOT / "package.xml").read_text()
    (tmp_path / "package.xml").write_text("\n".join(each for each in text.splitlines() if "<?xml-model" not in each))
    shutil.copy(ROOT / "config" / "layouts" / "plotjuggler.xml", tmp_path)
    assert lint("ament_xmllint", tmp_path).count("is valid") == 2


def test_package_xml_is_what_ament_reads(tmp_path):
    """The parser of colcon and bloom, warnings included; and it notices what is wrong."""
    package = pytest.importorskip("catkin_pkg.package", reason="needs the extra 'test'")
    warnings = []
    read = package.parse_package(str(ROOT / "package.xml"), warnings=warnings)
    read.validate(warnings=warnings)
    assert warnings == []
    assert (read.package_format, read.get_build_type()) == (3, "ament_python")
    tree = ET.parse(ROOT / "package.xml")
    tree.getroot().remove(tree.getroot().find("maintainer"))
    tree.write(tmp_path / "package.xml")
    with pytest.raises(package.InvalidPackage, match="maintainer"):
        package.parse_package(str(tmp_path / "package.xml"))
